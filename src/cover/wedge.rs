//! Pieces of round forms: from the axis to a part of the surface.

use super::form::SolidForm;
use super::surface::Surface;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// One side of a round form's profile.
#[derive(Clone, Copy, Debug)]
enum WedgeSide {
    /// Straight, between two places along the axis, with the radii there.
    Straight([(f64, f64); 2]),
    /// A quarter of a circle around a point of the axis, up (1) or down (-1), between two angles
    /// from the equator.
    Cap {
        middle: f64,
        radius: f64,
        sign: f64,
        angles: [f64; 2],
    },
}

/// A piece of a round form: all points of some places along the axis, within two half-planes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wedge {
    middle: DVec3,
    axis: DVec3,
    side: WedgeSide,
    angles: [f64; 2],
}

/// Returns the pieces of a round form with which a search begins; none for other forms.
pub(super) fn wedges(form: &SolidForm) -> Vec<Wedge> {
    let (middle, axis, sides) = match form {
        SolidForm::Hull { .. } | SolidForm::Mesh { .. } => return Vec::new(),
        SolidForm::Round(round) => {
            let side = WedgeSide::Straight(round.ends());
            (round.middle, round.axis, vec![side])
        }
        SolidForm::Capsule { ends, radius } => {
            let half = ends[0].distance(ends[1]) / 2.0;
            let cap = |sign: f64| WedgeSide::Cap {
                middle: sign * half,
                radius: *radius,
                sign,
                angles: [0.0, FRAC_PI_2],
            };
            let between = WedgeSide::Straight([(-half, *radius), (half, *radius)]);
            let axis = (ends[1] - ends[0]).try_normalize().unwrap_or(DVec3::Z);
            (
                ends[0].midpoint(ends[1]),
                axis,
                vec![cap(-1.0), between, cap(1.0)],
            )
        }
    };
    let quarters = [0.0, 0.5, 1.0, 1.5].map(|start| [start * PI, (start + 0.5) * PI]);
    let wedge = |side| {
        quarters.map(|angles| Wedge {
            middle,
            axis,
            side,
            angles,
        })
    };
    sides.into_iter().flat_map(wedge).collect()
}

/// Returns 1 / cos of half the angle between two directions, less 1: the distance by which, relative to the radius,
/// the tangents there meet beyond the circle.
fn excess([from, to]: [f64; 2]) -> f64 {
    1.0 / ((to - from) / 2.0).cos() - 1.0
}

fn halves([from, to]: [f64; 2]) -> [[f64; 2]; 2] {
    let middle = f64::midpoint(from, to);
    [[from, middle], [middle, to]]
}

impl Wedge {
    /// Returns two places along the axis, and radii there: a straight side outside of the piece.
    fn trapezium(&self) -> [(f64, f64); 2] {
        match self.side {
            WedgeSide::Straight(ends) => ends,
            WedgeSide::Cap {
                middle,
                radius,
                sign,
                angles,
            } => {
                let (sin, cos) = f64::midpoint(angles[0], angles[1]).sin_cos();
                // The tangent halfway.
                let ends = angles.map(|angle| {
                    let up = radius * angle.sin();
                    (middle + sign * up, ((radius - up * sin) / cos).max(0.0))
                });
                if sign > 0.0 { ends } else { [ends[1], ends[0]] }
            }
        }
    }

    /// Returns a closed polyhedron that contains the piece, rounding apart.
    pub(super) fn polyhedron(&self) -> Surface {
        let (right, up) = self.axis.any_orthonormal_pair();
        let direction = |angle: f64, length: f64| {
            let (sin, cos) = angle.sin_cos();
            (right * cos + up * sin) * length
        };
        let [from, to] = self.angles;
        let corners = [
            DVec3::ZERO,
            direction(from, 1.0),
            direction(f64::midpoint(from, to), 1.0 + excess(self.angles)),
            direction(to, 1.0),
        ];
        let ring = |(along, radius): (f64, f64)| {
            let middle = self.middle + self.axis * along;
            corners.map(|corner| middle + corner * radius)
        };
        let points = self.trapezium().map(ring).concat();
        let mut surface = Surface::new(points, true);
        for corners in [
            [0, 3, 2, 1],
            [4, 5, 6, 7],
            [0, 1, 5, 4],
            [1, 2, 6, 5],
            [2, 3, 7, 6],
            [3, 0, 4, 7],
        ] {
            surface.push_polygon(corners);
        }
        surface
    }

    /// Returns about how far the polyhedron reaches beyond the piece.
    pub(super) fn slack(&self) -> f64 {
        let [(_, lower), (_, upper)] = self.trapezium();
        lower.max(upper) * excess(self.angles) + self.profile_slack()
    }

    fn profile_slack(&self) -> f64 {
        match self.side {
            WedgeSide::Straight(_) => 0.0,
            WedgeSide::Cap { radius, angles, .. } => radius * excess(angles),
        }
    }

    /// Returns the two halves, cut so that the slack falls.
    pub(super) fn halves(&self) -> [Self; 2] {
        match self.side {
            WedgeSide::Cap {
                middle,
                radius,
                sign,
                angles,
            } if self.profile_slack() > self.slack() / 2.0 => halves(angles).map(|angles| Self {
                side: WedgeSide::Cap {
                    middle,
                    radius,
                    sign,
                    angles,
                },
                ..*self
            }),
            WedgeSide::Cap { .. } | WedgeSide::Straight(_) => {
                halves(self.angles).map(|angles| Self { angles, ..*self })
            }
        }
    }
}
