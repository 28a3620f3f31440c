//! A turning motion over an interval as a cubic, which carries every point of the body.

use crate::accuracy::Accuracy;
use crate::blossom::restrict_to;
use crate::rounding::{UNIT_ROUNDOFF, latest_exact, norm};
use glam::{DMat3, DVec3};

/// The Bézier control points of a rotation over `start..end` (s), as matrices: applied to a point
/// of the body, they are those of a cubic close to its way around the body's position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BakedRotation {
    start: f64,
    end: f64,
    points: [DMat3; 4],
    /// Largest distance between a point's way and its cubic, rounding included, relative to the
    /// point's distance from the body's position.
    error: f64,
}

impl BakedRotation {
    /// Rounding of an exact rotation's matrices.
    ///
    /// A quaternion has an error of at most 75 roundings, a matrix formed of it three times that
    /// and 30 more. Control points are weighted sums of two matrices with weights below 2.5.
    pub(super) const ROUNDING: f64 = 1024.0 * UNIT_ROUNDOFF;

    /// Returns the cubic with these control points, `error` relative to a point's distance.
    pub(super) const fn new((start, end): (f64, f64), points: [DMat3; 4], error: f64) -> Self {
        Self {
            start,
            end,
            points,
            error,
        }
    }

    /// Returns a rotation that is held.
    pub(super) const fn held(ends: (f64, f64), matrix: DMat3, error: f64) -> Self {
        Self::new(ends, [matrix; 4], error)
    }

    /// Returns the cubic of a rotation of which nothing is known: points stay at the body's
    /// position, and are known to their distance from it.
    pub(super) const fn unknown(ends: (f64, f64)) -> Self {
        Self::new(ends, [DMat3::ZERO; 4], 1.0)
    }

    /// Returns the largest distance between a point's way and its cubic, relative to the point's
    /// distance from the body's position.
    pub(super) const fn error(&self) -> f64 {
        self.error
    }

    /// Returns the control points of the way of a point of the body, relative to its position, m.
    #[inline]
    pub(crate) fn way(&self, point: DVec3) -> [DVec3; 4] {
        let [m0, m1, m2, m3] = &self.points;
        [*m0 * point, *m1 * point, *m2 * point, *m3 * point]
    }

    /// Returns the vectors whose scalar products with a point of the body are those of its way's
    /// control points with a direction.
    pub(crate) fn projected_onto(&self, direction: DVec3) -> [DVec3; 4] {
        self.points.map(|matrix| matrix.transpose() * direction)
    }

    /// Returns a bound on the distance between a point's exact way and its cubic as computed, m.
    #[inline]
    pub(crate) fn error_of(&self, point: DVec3) -> f64 {
        // 3 roundings of a product with a matrix, whose magnitudes lengthen a vector by at most 4; and 8 of
        // this bound: the error is 1 at most, but for rounding.
        let error = self.error + 32.0 * UNIT_ROUNDOFF;
        error * norm(point) + f64::MIN_POSITIVE
    }

    /// Returns a bound on what a centre's error adds to a sphere's radius, or leaves out of it, for spheres
    /// within `reach` (m).
    pub(crate) fn error_within(&self, reach: f64) -> f64 {
        // Radius and error are at most twice the reach: their sum is rounded, and then up.
        self.error_of(DVec3::new(reach, 0.0, 0.0)) + 16.0 * UNIT_ROUNDOFF * reach
    }

    /// Returns a bound on the motion of points within `reach` (m) around the body's position, between an
    /// instant and its rounded value, m; or infinity.
    pub(crate) fn blur_within(&self, reach: f64) -> f64 {
        let steps = self.points.windows(2).map(|two| two[1] - two[0]);
        // A matrix lengthens a vector at most by the root of the sum of its squares.
        let length = |step: DMat3| {
            (step.x_axis.length_squared() + step.y_axis.length_squared())
                + step.z_axis.length_squared()
        };
        let speed =
            3.0 * steps.map(length).fold(0.0, f64::max).sqrt() * reach / (self.end - self.start);
        let latest = self.start.abs().max(self.end.abs());
        let blur = speed * (latest_exact(latest) - latest);
        if blur.is_nan() { f64::INFINITY } else { blur }
    }

    /// Returns the radius of a sphere for the separation, and the bound on its centre's error that the
    /// radius does not contain (m).
    #[inline]
    pub(crate) fn radius_and_error(
        &self,
        (centre, radius): (DVec3, f64),
        accuracy: Accuracy,
    ) -> (f64, f64) {
        let error = self.error_of(centre);
        match accuracy {
            Accuracy::Exact => ((radius + error).next_up(), 0.0),
            Accuracy::Certified => (radius, error),
        }
    }

    /// Returns the part between two instants of the interval (s).
    pub(crate) fn part(&self, (start, end): (f64, f64)) -> Self {
        debug_assert!(self.start <= start && end <= self.end, "a part");
        let is_whole = start <= self.start && end >= self.end;
        let [p0, p1, p2, p3] = self.points;
        // A rotation between equal ends may still move in between.
        let is_held = p0 == p1 && p1 == p2 && p2 == p3;
        if is_whole || is_held {
            return Self {
                start,
                end,
                ..*self
            };
        }
        Self {
            start,
            end,
            points: restrict_to(&self.points, (self.start, self.end), (start, end)),
            // Three steps of five roundings, of matrices whose norms are below 2.5.
            error: self.error + 64.0 * UNIT_ROUNDOFF,
        }
    }

    /// Returns the control points over a stretch, given as shares of the interval: those of the cubic, but for nine
    /// roundings.
    pub(crate) fn stretch(&self, (from, to): (f64, f64)) -> Self {
        let instant = |share: f64| self.start + share * (self.end - self.start);
        let points = restrict_to(&self.points, (0.0, 1.0), (from, to));
        Self::new((instant(from), instant(to)), points, self.error)
    }
}
