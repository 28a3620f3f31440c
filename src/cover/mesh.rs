//! Triangle meshes: the nearest point of the surface, and which side a point is on.

use super::nearest_point::{nearest_on_segment, nearest_on_triangle};
use super::point_tree::PointTree;
use super::surface::{Surface, is_closed};
use glam::DVec3;

/// A surface of triangles.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    /// The last two corners of a triangle are the same where it is a segment, or a point.
    tree: PointTree<3>,
    /// True if each edge is passed as often one way as the other.
    closed: bool,
}

impl Mesh {
    /// Takes points of one place for one point. A triangle with two of its corners there is a segment of the
    /// surface.
    pub(super) fn new(points: Vec<DVec3>, mut triangles: Vec<[usize; 3]>) -> Self {
        weld(&points, &mut triangles);
        for [a, b, c] in &mut triangles {
            if a == b {
                *b = *c;
            } else if a == c {
                *c = *b;
            }
        }
        let with_area = triangles.iter().filter(|[_, b, c]| b != c);
        let closed = is_closed(with_area.map(<[usize; 3]>::as_slice));
        Self {
            tree: PointTree::new(points, triangles),
            closed,
        }
    }

    pub(super) const fn is_closed(&self) -> bool {
        self.closed
    }

    pub(super) fn surface(&self) -> Surface {
        let mut surface = Surface::new(self.tree.points.clone(), self.closed);
        for triangle in &self.tree.items {
            let [_, b, c] = triangle;
            let corners = if b == c { 2 } else { 3 };
            surface.push_polygon(triangle[..corners].iter().copied());
        }
        surface
    }

    /// Returns a point of the surface: the nearest one to rounding, or to the height of a triangle that is a sliver.
    pub(super) fn nearest(&self, at: DVec3) -> DVec3 {
        let mut nearest = at;
        self.least_square(at, f64::INFINITY, |corners, least| {
            let point = nearest_on_triangle(corners, at);
            let square = point.distance_squared(at);
            if square < least {
                nearest = point;
            }
            square
        });
        nearest
    }

    /// Returns a distance that no point of the surface is nearer than, rounding apart.
    pub(super) fn clear_distance(&self, at: DVec3) -> f64 {
        let of_triangle = |corners, _| clear_distance(corners, at).powi(2);
        self.least_square(at, f64::INFINITY, of_triangle).sqrt()
    }

    /// Returns true if the nearest point of the surface is the place itself.
    pub(super) fn has(&self, at: DVec3) -> bool {
        let of_triangle = |corners, _| nearest_on_triangle(corners, at).distance_squared(at);
        self.least_square(at, f64::MIN_POSITIVE, of_triangle) <= 0.0
    }

    /// Returns the least square of a distance of the triangles, given by a function that gets the least one so far;
    /// of boxes farther away none is asked for. Returns `most` if no square is less.
    fn least_square(
        &self,
        at: DVec3,
        most: f64,
        of_triangle: impl FnMut([DVec3; 3], f64) -> f64,
    ) -> f64 {
        let square = |low, high| at.distance_squared(at.clamp(low, high));
        self.tree.least(most, square, of_triangle)
    }

    /// Returns the number of times that the surface winds around a point, 0 for a mesh that is not closed.
    /// Within rounding of the surface the number may be that of the other side.
    ///
    /// A. Van Oosterom and J. Strackee: The solid angle of a plane triangle, IEEE Transactions on
    /// Biomedical Engineering 30 (1983).
    pub(super) fn winding(&self, at: DVec3) -> f64 {
        if !self.closed {
            return 0.0;
        }
        let angle = |triangle: &[usize; 3]| {
            let [a, b, c] = self.tree.points_of(triangle).map(|corner| corner - at);
            let lengths = [a.length(), b.length(), c.length()];
            let below = lengths[0] * lengths[1] * lengths[2]
                + a.dot(b) * lengths[2]
                + b.dot(c) * lengths[0]
                + c.dot(a) * lengths[1];
            2.0 * a.dot(b.cross(c)).atan2(below)
        };
        let total: f64 = self.tree.items.iter().map(angle).sum();
        (total / (4.0 * std::f64::consts::PI)).round()
    }

    /// Returns the number of outward crossings of the surface, less the inward ones, on the way up from a point.
    /// The result is the winding number, except for points below an edge.
    pub(super) fn crossings(&self, at: DVec3) -> i32 {
        let mut crossings = 0;
        let may_be_above = |low: DVec3, high: DVec3| {
            let is_within = |low, high, at| low <= at && at <= high;
            is_within(low.x, high.x, at.x) && is_within(low.y, high.y, at.y) && at.z <= high.z
        };
        self.tree.each_in(may_be_above, |corners| {
            crossings += crossing(corners.map(|corner| corner - at));
        });
        crossings
    }
}

/// Returns 1, -1 or 0: the way up from 0 leaves, enters or misses what a triangle bounds.
fn crossing([a, b, c]: [DVec3; 3]) -> i32 {
    let side = |p: DVec3, q: DVec3| p.x * q.y - p.y * q.x;
    let sides = [side(a, b), side(b, c), side(c, a)];
    let sign = if sides.iter().all(|&side| side >= 0.0) {
        1
    } else if sides.iter().all(|&side| side < 0.0) {
        -1
    } else {
        return 0;
    };
    let above = a.dot((b - a).cross(c - a)) * f64::from(sign) > 0.0;
    i32::from(above) * sign
}

/// Gives points of one place one number.
fn weld(points: &[DVec3], triangles: &mut [[usize; 3]]) {
    let key = |number: usize| (points[number] + 0.0).to_array().map(f64::to_bits);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by_key(|&number| (key(number), number));
    let mut same_as: Vec<usize> = (0..points.len()).collect();
    for pair in order.windows(2) {
        if key(pair[0]) == key(pair[1]) {
            same_as[pair[1]] = same_as[pair[0]];
        }
    }
    for corner in triangles.iter_mut().flatten() {
        *corner = same_as[*corner];
    }
}

/// Returns a distance that no point of a triangle is nearer to a place than, rounding apart.
///
/// Along any direction all of the triangle is at least as far as the nearest of its corners. The direction to the
/// nearest point shows the whole distance. It is the normal of the triangle, or leads to an edge. No weights of the
/// corners are needed, which a sliver does not yield; and a normal that is wrong makes the bound less, not wrong.
fn clear_distance([a, b, c]: [DVec3; 3], at: DVec3) -> f64 {
    let ways = [a, b, c].map(|corner| corner - at);
    let normal = (b - a).cross(c - a);
    let to_edge = |from, to| nearest_on_segment([from, to], at) - at;
    let directions = [normal, -normal, to_edge(a, b), to_edge(b, c), to_edge(c, a)];
    let shown = directions.map(|direction| {
        let direction = direction.normalize_or_zero();
        let along = ways.map(|way| way.dot(direction));
        along.into_iter().fold(f64::INFINITY, f64::min)
    });
    shown.into_iter().fold(0.0, f64::max)
}
