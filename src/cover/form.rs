//! The forms of which shapes are made, in f64.

use glam::{DQuat, DVec3};
use std::slice::from_mut;

/// A convex body of revolution with a straight side: a cylinder, or a cone whose upper radius is 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub(super) middle: DVec3,
    /// Unit vector, upward.
    pub(super) axis: DVec3,
    /// Lower and upper radius; the lower one is not the smaller.
    pub(super) radii: [f64; 2],
    pub(super) half_height: f64,
}

impl Round {
    /// Returns both ends: places along the axis, and the radii there.
    pub(super) fn ends(&self) -> [(f64, f64); 2] {
        let [lower, upper] = self.radii;
        [(-self.half_height, lower), (self.half_height, upper)]
    }
}

/// The form of a solid, in f64: what a shape of parry3d is read into.
#[derive(Clone, Debug)]
pub(super) enum SolidForm {
    /// The convex hull of some points, with the polygons of its surface, seen from outside
    /// anticlockwise.
    Hull {
        points: Vec<DVec3>,
        polygons: Vec<Vec<usize>>,
    },
    Round(Round),
    /// A capsule; a ball where both ends are one point.
    Capsule {
        ends: [DVec3; 2],
        radius: f64,
    },
    Mesh {
        points: Vec<DVec3>,
        triangles: Vec<[usize; 3]>,
    },
}

impl SolidForm {
    pub(super) fn cuboid(half_extents: DVec3) -> Self {
        let corner = |number: usize| {
            let sign = |bit: usize| if number >> bit & 1 == 1 { 1.0 } else { -1.0 };
            half_extents * DVec3::new(sign(0), sign(1), sign(2))
        };
        Self::Hull {
            points: (0..8).map(corner).collect(),
            polygons: [
                [0, 4, 6, 2],
                [1, 3, 7, 5],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 2, 3, 1],
                [4, 5, 7, 6],
            ]
            .map(Vec::from)
            .to_vec(),
        }
    }

    /// Returns points with radii. The balls around them lie within the form and reach as far as it
    /// does in every direction, except for arcs between the points of a circle.
    pub(super) fn extremes(&self) -> Vec<(DVec3, f64)> {
        const AROUND: i32 = 64;
        let circle = |round: &Round, (height, radius): (f64, f64)| {
            let (right, up) = round.axis.any_orthonormal_pair();
            let middle = round.middle + round.axis * height;
            (0..AROUND).map(move |step| {
                let (sin, cos) =
                    (std::f64::consts::TAU * f64::from(step) / f64::from(AROUND)).sin_cos();
                (middle + (right * cos + up * sin) * radius, 0.0)
            })
        };
        match self {
            Self::Hull { points, .. } | Self::Mesh { points, .. } => {
                points.iter().map(|&point| (point, 0.0)).collect()
            }
            Self::Round(round) => {
                let circles = round.ends().map(|end| circle(round, end));
                circles.into_iter().flatten().collect()
            }
            Self::Capsule { ends, radius } => ends.map(|end| (end, *radius)).to_vec(),
        }
    }

    /// Returns the diameter if it is that of a simple formula.
    pub(super) fn diameter(&self) -> Option<f64> {
        match self {
            Self::Hull { .. } | Self::Mesh { .. } => None,
            Self::Round(round) => {
                let [lower, upper] = round.radii;
                let across = (lower + upper).hypot(2.0 * round.half_height);
                Some(across.max(2.0 * lower))
            }
            Self::Capsule { ends, radius } => Some(ends[0].distance(ends[1]) + 2.0 * radius),
        }
    }

    /// Returns the corners of a box around the form.
    pub(super) fn corners(&self) -> (DVec3, DVec3) {
        let around = |middle: DVec3, reach: DVec3| (middle - reach, middle + reach);
        let join = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        match self {
            Self::Hull { points, .. } | Self::Mesh { points, .. } => {
                let each = points.iter().map(|&point| (point, point));
                each.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), join)
            }
            Self::Round(round) => {
                let DVec3 { x, y, z } = round.axis;
                let sideways = DVec3::new(y.hypot(z), z.hypot(x), x.hypot(y));
                let reach = round.axis.abs() * round.half_height + sideways * round.radii[0];
                around(round.middle, reach)
            }
            Self::Capsule { ends, radius } => {
                let reach = DVec3::splat(*radius);
                join(around(ends[0], reach), around(ends[1], reach))
            }
        }
    }

    /// Turns and moves the form. Returns a bound of the sums that were rounded, 0 if none was.
    pub(super) fn place(&mut self, rotation: DQuat, translation: DVec3) -> f64 {
        // A ball at its own origin only moves.
        let local = match self {
            Self::Capsule { ends, .. } => ends[0].length().max(ends[1].length()),
            _ => {
                let (low, high) = self.corners();
                low.abs().max(high.abs()).length()
            }
        };
        for point in self.points_mut() {
            *point = rotation * *point + translation;
        }
        if let Self::Round(round) = self {
            round.axis = (rotation * round.axis).normalize();
        }
        if local > 0.0 {
            local + translation.length()
        } else {
            0.0
        }
    }

    /// Moves `origin` to 0 and divides all lengths by `unit`.
    pub(super) fn normalise(&mut self, origin: DVec3, unit: f64) {
        for point in self.points_mut() {
            *point = (*point - origin) / unit;
        }
        match self {
            Self::Hull { .. } | Self::Mesh { .. } => {}
            Self::Round(round) => {
                round.radii = round.radii.map(|radius| radius / unit);
                round.half_height /= unit;
            }
            Self::Capsule { radius, .. } => *radius /= unit,
        }
    }

    fn points_mut(&mut self) -> &mut [DVec3] {
        match self {
            Self::Hull { points, .. } | Self::Mesh { points, .. } => points,
            Self::Round(round) => from_mut(&mut round.middle),
            Self::Capsule { ends, .. } => ends,
        }
    }

    /// Returns the volume if it is that of a simple formula.
    pub(super) fn volume(&self) -> Option<f64> {
        use std::f64::consts::PI;
        match self {
            Self::Hull { .. } | Self::Mesh { .. } => None,
            Self::Round(round) => {
                let [lower, upper] = round.radii;
                let squares = lower * lower + lower * upper + upper * upper;
                Some(2.0 / 3.0 * PI * squares * round.half_height)
            }
            Self::Capsule { ends, radius } => {
                Some(PI * radius.powi(2) * (ends[0].distance(ends[1]) + 4.0 / 3.0 * radius))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis nearly along y, whose square is 1 to rounding.
    #[test]
    fn boxes_contain_discs_at_a_slant() {
        for slant in [1e-9, 3e-8, 1e-4, 0.3] {
            let axis = DVec3::new(slant, 1.0, -slant).normalize();
            let disc = SolidForm::Round(Round {
                middle: DVec3::ZERO,
                axis,
                radii: [1.0; 2],
                half_height: 0.0,
            });
            let (low, high) = disc.corners();
            // The disc's highest point is as high as the axis leans.
            let highest = axis.x.hypot(axis.z);
            for (end, of_box) in [(-highest, low.y), (highest, high.y)] {
                assert!((end - of_box).abs() <= 1e-15 * highest, "{slant}: {of_box}");
            }
        }
    }
}
