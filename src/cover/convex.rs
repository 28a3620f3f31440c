//! Convex forms: how deep a point lies in them, and polyhedra around them.

use super::form::{Round, SolidForm};
use super::hull::convex_hull;
use super::nearest_point::{nearest_on_segment, nearest_on_triangle};
use super::point_tree::PointTree;
use super::surface::{OrientedPlane, Surface, fan, is_closed};
use crate::count::as_f64;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A convex form with what its depth needs.
#[derive(Clone, Debug)]
pub(super) struct Convex {
    form: SolidForm,
    /// The faces of a hull; of no other form.
    faces: Vec<Face>,
    /// A point inside, and its depth.
    inner: (DVec3, f64),
    /// No point of a hull is farther from what its polygons bound.
    pub(super) unevenness: f64,
}

/// A polygon of a hull, and the half-space behind it.
#[derive(Clone, Debug)]
struct Face {
    plane: OrientedPlane,
    /// Number of the polygon.
    polygon: usize,
}

/// Polygons of a hull stay as they are up to this unevenness, in the unit of solids: f32 bends them by
/// less.
const EVEN: f64 = 5e-7;

/// Returns the faces of a hull, and its unevenness.
///
/// The plane of each polygon is moved inward until the polygon lies outside of it. The polygon is then in a
/// layer of a thickness t, beyond which there is no point of the hull. Take a point of the hull that is not
/// within what the polygons bound. On its way to the inner point it meets one of them after a share t / (t + d)
/// at most, where d is the depth of the inner point below the layer.
///
/// A hull without depth is all surface, and no point is farther from it than its layers are thick.
fn faces(points: &[DVec3], polygons: &[Vec<usize>], inner: DVec3) -> (Vec<Face>, f64) {
    const NO_DEPTH: f64 = 1e-10;
    let farthest = points.iter().map(|point| point.distance(inner));
    let farthest = farthest.fold(0.0, f64::max);
    let tree = PointTree::of_points(points.to_vec());
    let (mut faces, mut unevenness) = (Vec::new(), 0.0_f64);
    for (number, polygon) in polygons.iter().enumerate() {
        let Some((plane, layer)) = half_space(&tree, polygon) else {
            continue;
        };
        let depth = (-plane.height(inner)).max(0.0);
        let beyond = if depth > NO_DEPTH {
            farthest * layer / (layer + depth)
        } else {
            layer
        };
        unevenness = unevenness.max(beyond);
        faces.push(Face {
            plane,
            polygon: number,
        });
    }
    (faces, unevenness)
}

impl Convex {
    pub(super) fn new(form: SolidForm) -> Self {
        let mut convex = Self {
            form,
            faces: Vec::new(),
            inner: (DVec3::ZERO, 0.0),
            unevenness: 0.0,
        };
        let inner = match &mut convex.form {
            SolidForm::Hull { points, polygons } => {
                let count = as_f64(points.len().max(1));
                let inner = points.iter().sum::<DVec3>() / count;
                let mut found = faces(points, polygons, inner);
                // parry3d joins triangles that are nearly in one plane, and their neighbours to these.
                let is_even = found.1 <= EVEN;
                if !(is_even && is_closed(polygons.iter().map(Vec::as_slice)))
                    && let Some(triangles) = convex_hull(points)
                {
                    found = faces(points, &triangles, inner);
                    *polygons = triangles;
                }
                (convex.faces, convex.unevenness) = found;
                inner
            }
            SolidForm::Round(round) => {
                // The middle of the largest ball within lies on the axis: of a cone, it touches the lower end.
                let (outward, upward) = round.slope();
                let depth = round.radii[0] * outward / (1.0 + upward);
                let along = if upward > 0.0 {
                    depth - round.half_height
                } else {
                    0.0
                };
                round.middle + round.axis * along
            }
            SolidForm::Capsule { ends, .. } => ends[0].midpoint(ends[1]),
            SolidForm::Mesh { .. } => DVec3::ZERO,
        };
        convex.inner = (inner, (-convex.height(inner).0).max(0.0));
        convex
    }

    /// Returns the triangles of a hull that has no depth to rounding, with its points.
    pub(super) fn flat_triangles(&self) -> Option<(Vec<DVec3>, Vec<[usize; 3]>)> {
        const NO_DEPTH: f64 = 1e-12;
        let SolidForm::Hull { points, polygons } = &self.form else {
            return None;
        };
        let triangles = polygons.iter().flat_map(|polygon| fan(polygon));
        let is_flat = self.inner.1 <= NO_DEPTH;
        is_flat.then(|| (points.clone(), triangles.collect()))
    }

    pub(super) const fn form(&self) -> &SolidForm {
        &self.form
    }

    /// Returns a lower bound of the signed distance, with its gradient. Inside it is the signed distance to rounding.
    fn height(&self, at: DVec3) -> (f64, DVec3) {
        let higher = |a: (f64, DVec3), b: (f64, DVec3)| if b.0 > a.0 { b } else { a };
        match &self.form {
            SolidForm::Hull { .. } | SolidForm::Mesh { .. } => {
                let planes = self.faces.iter().map(|face| face.plane);
                let heights = planes.map(|plane| (plane.height(at), plane.normal));
                let from_inner = at - self.inner.0;
                let flat = (from_inner.length(), from_inner.normalize_or_zero());
                heights.reduce(higher).unwrap_or(flat)
            }
            SolidForm::Round(round) => {
                let (along, out, away) = round.split(at);
                let (outward, upward) = round.slope();
                let Round {
                    axis, half_height, ..
                } = *round;
                let side = (away - round.radii[1]) * outward + (along - half_height) * upward;
                let ends = higher((-half_height - along, -axis), (along - half_height, axis));
                let ends_and_side = higher((side, out * outward + axis * upward), ends);
                // The side of a flat cone does not tell what is beside the cone.
                higher(ends_and_side, (away - round.radii[0], out))
            }
            SolidForm::Capsule { ends, radius } => {
                let away = at - nearest_on_segment(*ends, at);
                (away.length() - radius, away.normalize_or_zero())
            }
        }
    }

    /// Returns true if the signed distance is not positive.
    pub(super) fn contains(&self, at: DVec3) -> bool {
        self.height(at).0 <= 0.0
    }

    /// Returns the signed distance to rounding, and its gradient. Between the polygons of a hull and the half-spaces
    /// behind them it is the distance from a polygon.
    pub(super) fn signed_distance(&self, at: DVec3) -> (f64, DVec3) {
        let (height, gradient) = self.height(at);
        if height <= 0.0 {
            return (height, gradient);
        }
        let way = match &self.form {
            SolidForm::Capsule { .. } | SolidForm::Mesh { .. } => return (height, gradient),
            SolidForm::Round(round) => round.way_from(at),
            SolidForm::Hull { points, polygons } => at - self.nearest_of_hull(points, polygons, at),
        };
        (way.length(), way.try_normalize().unwrap_or(gradient))
    }

    /// Returns the nearest point of a hull to a point outside: it is on a face that is seen from there.
    fn nearest_of_hull(&self, points: &[DVec3], polygons: &[Vec<usize>], at: DVec3) -> DVec3 {
        let seen = self.faces.iter().filter(|face| face.plane.height(at) > 0.0);
        let triangles = seen.flat_map(|face| fan(&polygons[face.polygon]));
        let nearest = triangles
            .map(|corners| nearest_on_triangle(corners.map(|corner| points[corner]), at))
            .map(|point| (point.distance_squared(at), point));
        let nearer = |a: (f64, DVec3), b: (f64, DVec3)| if b.0 < a.0 { b } else { a };
        nearest
            .reduce(nearer)
            .map_or(self.inner.0, |(_, point)| point)
    }

    /// Returns a closed polyhedron that contains the form. For a round form it has `around` sides,
    /// a multiple of 4.
    pub(super) fn polyhedron(&self, around: u32) -> Surface {
        match &self.form {
            SolidForm::Hull { points, polygons } => {
                let mut surface = Surface::new(points.clone(), true);
                for polygon in polygons {
                    surface.push_polygon(polygon.iter().copied());
                }
                surface
            }
            SolidForm::Mesh { .. } => Surface::default(),
            SolidForm::Round(round) => revolve(round.middle, round.axis, &round.ends(), around),
            SolidForm::Capsule { ends, radius } => {
                let axis = (ends[1] - ends[0]).try_normalize().unwrap_or(DVec3::Z);
                let half = ends[0].distance(ends[1]) / 2.0;
                let profile = capsule_profile(half, *radius, around / 4);
                revolve(ends[0].midpoint(ends[1]), axis, &profile, around)
            }
        }
    }
}

impl Round {
    /// Returns the parts of the side's normal away from the axis and along it.
    fn slope(&self) -> (f64, f64) {
        let (up, inward) = (2.0 * self.half_height, self.radii[0] - self.radii[1]);
        let slant = inward.hypot(up);
        if slant > 0.0 {
            (up / slant, inward / slant)
        } else {
            (1.0, 0.0)
        }
    }

    /// Returns the way from the nearest point of the surface.
    fn way_from(&self, at: DVec3) -> DVec3 {
        let (along, out, away) = self.split(at);
        let place = DVec3::new(along, away, 0.0);
        let [lower, upper] = self.ends().map(|(height, radius)| {
            let centre = DVec3::new(height, 0.0, 0.0);
            (centre, DVec3::new(height, radius, 0.0))
        });
        let lines = [[lower.0, lower.1], [lower.1, upper.1], [upper.1, upper.0]];
        let ways = lines.map(|line| place - nearest_on_segment(line, place));
        let shorter = |a: DVec3, b: DVec3| {
            if b.length_squared() < a.length_squared() {
                b
            } else {
                a
            }
        };
        let way = ways.into_iter().fold(DVec3::INFINITY, shorter);
        self.axis * way.x + out * way.y
    }

    /// Returns the place along the axis, the unit vector away from it, and the distance from it.
    pub(super) fn split(&self, at: DVec3) -> (f64, DVec3, f64) {
        let from_middle = at - self.middle;
        let along = from_middle.dot(self.axis);
        let out = from_middle - self.axis * along;
        (along, out.normalize_or_zero(), out.length())
    }
}

/// Returns the half-space behind a polygon of a hull, moved inward until the whole polygon lies
/// outside; and how far the hull reaches beyond the polygon. No half-space has a polygon without
/// area.
fn half_space(tree: &PointTree<1>, polygon: &[usize]) -> Option<(OrientedPlane, f64)> {
    let points = &tree.points;
    let first = points[*polygon.first()?];
    let fan = polygon.windows(2).map(|pair| {
        let (a, b) = (points[pair[0]] - first, points[pair[1]] - first);
        a.cross(b)
    });
    let normal = fan.sum::<DVec3>().try_normalize()?;
    let seen_from = |normal: DVec3| {
        let highest = tree.highest(normal);
        let own = polygon.iter().map(|&corner| normal.dot(points[corner]));
        let lowest = own.fold(f64::INFINITY, f64::min);
        let plane = OrientedPlane {
            normal,
            offset: lowest,
        };
        (plane, highest - lowest)
    };
    // Whichever way round the polygon is.
    let sides = (seen_from(normal), seen_from(-normal));
    Some(if sides.0.1 <= sides.1.1 {
        sides.0
    } else {
        sides.1
    })
}

/// Returns a polyhedron around a body of revolution, whose profile (place along the axis, radius)
/// goes up the axis and is convex.
fn revolve(middle: DVec3, axis: DVec3, profile: &[(f64, f64)], around: u32) -> Surface {
    let (right, up) = axis.any_orthonormal_pair();
    // The sides touch the circles between the corners.
    let beyond = (1.0 + 1e-15) / (PI / f64::from(around)).cos();
    let directions: Vec<DVec3> = (0..around)
        .map(|step| {
            let (sin, cos) = (TAU * f64::from(step) / f64::from(around)).sin_cos();
            (right * cos + up * sin) * beyond
        })
        .collect();
    let sides = directions.len();
    let mut points = Vec::with_capacity(profile.len() * sides);
    for &(along, radius) in profile {
        let at = |direction: &DVec3| middle + axis * along + *direction * radius;
        points.extend(directions.iter().map(at));
    }
    let mut surface = Surface::new(points, true);
    surface.push_polygon((0..sides).rev());
    for ring in 0..profile.len() - 1 {
        let base = ring * sides;
        for side in 0..sides {
            let next = (side + 1) % sides;
            surface.push_polygon([
                base + side,
                base + next,
                base + sides + next,
                base + sides + side,
            ]);
        }
    }
    let top = (profile.len() - 1) * sides;
    surface.push_polygon(top..top + sides);
    surface
}

/// Returns the profile of a polyhedron around a capsule: tangents at `quarter + 1` points of
/// each quarter of a circle, and where they meet.
fn capsule_profile(half: f64, radius: f64, quarter: u32) -> Vec<(f64, f64)> {
    let step = PI / 2.0 / f64::from(quarter);
    let beyond = radius * (1.0 + 1e-15) / (step / 2.0).cos();
    let cap = |number: u32| {
        // From the pole to the equator.
        let (sin, cos) = ((f64::from(number) + 0.5) * step).sin_cos();
        (half + beyond * cos, beyond * sin)
    };
    let lower = (0..quarter).map(|number| {
        let (along, away) = cap(number);
        (-along, away)
    });
    lower.chain((0..quarter).rev().map(cap)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles of the hull take the place of polygons that leave a gap.
    #[test]
    fn polygons_of_hulls_leave_no_gap() {
        let SolidForm::Hull { points, polygons } = SolidForm::cuboid(DVec3::ONE) else {
            unreachable!()
        };
        let whole = polygons.clone();
        for (polygons, expected) in [(whole, 6), (polygons[1..].to_vec(), 12)] {
            let points = points.clone();
            let cube = Convex::new(SolidForm::Hull { points, polygons });
            let surface = cube.polyhedron(4);
            assert_eq!(surface.polygons().count(), expected);
            assert!(is_closed(surface.polygons()));
            assert!((surface.volume() - 8.0).abs() < 1e-14);
            assert!(cube.unevenness <= 0.0);
        }
    }

    /// No point of a round form is beyond a polygon of its polyhedron.
    #[test]
    fn polyhedra_contain_round_forms() {
        let (middle, axis) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.6, 0.0, 0.8));
        let round = |radii| {
            SolidForm::Round(Round {
                middle,
                axis,
                radii,
                half_height: 0.7,
            })
        };
        let ends = [middle - axis, middle + axis];
        let capsule = SolidForm::Capsule { ends, radius: 0.5 };
        for form in [round([1.0; 2]), round([1.0, 0.0]), capsule] {
            // The farthest place in a direction.
            let reach = |direction: DVec3| match &form {
                SolidForm::Round(round) => {
                    let away = direction.reject_from_normalized(axis).length();
                    let of_end =
                        |(along, radius)| direction.dot(middle + axis * along) + radius * away;
                    round
                        .ends()
                        .map(of_end)
                        .into_iter()
                        .fold(f64::MIN, f64::max)
                }
                _ => {
                    ends.map(|end| direction.dot(end))
                        .into_iter()
                        .fold(f64::MIN, f64::max)
                        + 0.5
                }
            };
            for around in [4, 16, 64] {
                let surface = Convex::new(form.clone()).polyhedron(around);
                let mut count = 0;
                for polygon in surface.polygons() {
                    let at = |corner: usize| surface.points[corner];
                    let area = |[a, b, c]: [usize; 3]| (at(b) - at(a)).cross(at(c) - at(a));
                    let Some(normal) = fan(polygon).map(area).sum::<DVec3>().try_normalize() else {
                        continue;
                    };
                    let beyond = reach(normal) - normal.dot(at(polygon[0]));
                    assert!(beyond <= 1e-14, "{form:?}, {around}: {beyond:e}");
                    count += 1;
                }
                assert!(count > around);
            }
        }
    }

    /// The nearest point is in the form, and no point of the form is nearer: all are behind the plane through it.
    #[test]
    fn distances_outside_are_exact() {
        use super::super::random::Random;
        let round = |radii, half_height| {
            SolidForm::Round(Round {
                middle: DVec3::new(0.1, 0.2, 0.3),
                axis: DVec3::new(0.6, 0.0, 0.8),
                radii,
                half_height,
            })
        };
        let mut random = Random::new(5, 0);
        for form in [
            round([1.0; 2], 0.7),
            round([1.0, 0.0], 0.7),
            round([1.0; 2], 0.0),
            round([1.0, 0.0], 0.0),
            round([1.0, 0.0], 1e-9),
            round([0.0; 2], 1.0),
            SolidForm::cuboid(DVec3::new(0.3, 0.6, 0.9)),
            SolidForm::cuboid(DVec3::new(1e-6, 1.0, 1e-6)),
        ] {
            let extremes = form.extremes();
            let convex = Convex::new(form);
            for _ in 0..500 {
                let at = random.point(DVec3::splat(-2.0), DVec3::splat(2.0));
                let (distance, gradient) = convex.signed_distance(at);
                if distance <= 1e-9 {
                    continue;
                }
                let nearest = at - gradient * distance;
                let is_in = convex.height(nearest).0 <= 1e-14;
                assert!(is_in, "{:?} {at}", convex.form);
                for &(point, _) in &extremes {
                    let above = gradient.dot(point - nearest);
                    assert!(above <= 1e-14, "{:?} {at} {above:e}", convex.form);
                }
            }
        }
    }
}
