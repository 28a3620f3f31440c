//! Bézier points to twice the precision of f64, and the segments and end motions that follow from them.

use crate::error::Error;
use crate::rounding::{UNIT_ROUNDOFF, largest_norm, norm};
use crate::trajectory::double_double::{DoubleDouble, Expansion};
use crate::trajectory::{Segment, State};
use glam::DVec3;

/// Bézier points of a cubic, in space.
pub(super) struct BezierPoints {
    /// Points 0 to 3, by axis, m.
    points: [[DoubleDouble; 4]; 3],
    /// Bound on the distance of each from the one meant, m.
    error: f64,
}

impl BezierPoints {
    pub(super) const fn new(points: [[DoubleDouble; 4]; 3], error: f64) -> Self {
        Self { points, error }
    }

    /// Returns the segment; `knot` is the number of its end knot.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`].
    pub(super) fn segment(&self, interval: (f64, f64), knot: usize) -> Result<Segment, Error> {
        let (mut origin, mut control_points) = (DVec3::ZERO, [DVec3::ZERO; 3]);
        // What is lost by rounding: of the origin, then of the ways from it.
        let mut lost = [DVec3::ZERO; 4];
        for (axis, [first, others @ ..]) in self.points.into_iter().enumerate() {
            [origin[axis], lost[0][axis]] = first.parts();
            for (place, point) in others.into_iter().enumerate() {
                let way = point + first.negated();
                [control_points[place][axis], lost[place + 1][axis]] = way.parts();
            }
        }
        // The ways themselves have an error of 3 u², far below 2^-100.
        let of_ways = largest_norm(&lost[1..]) + 2f64.powi(-100) * largest_norm(&control_points);
        let error = (norm(lost[0]) + of_ways + self.error) * (1.0 + 16.0 * UNIT_ROUNDOFF);
        Segment::from_control_points(interval, origin, control_points, error, knot)
    }

    /// Returns the end motion from the first point; `knot` is that point's number.
    pub(super) fn leaving(&self, interval: (f64, f64), knot: usize) -> Result<Segment, Error> {
        let derivatives = [
            [-3.0, 3.0, 0.0, 0.0],
            [3.0, -6.0, 3.0, 0.0],
            [-1.0, 3.0, -3.0, 1.0],
        ];
        self.end_motion(0, interval, interval.0, derivatives, knot)
    }

    /// Returns the end motion from the last point; `knot` is that point's number.
    pub(super) fn arriving(&self, interval: (f64, f64), knot: usize) -> Result<Segment, Error> {
        let derivatives = [
            [0.0, 0.0, -3.0, 3.0],
            [0.0, 3.0, -6.0, 3.0],
            [-1.0, 3.0, -3.0, 1.0],
        ];
        self.end_motion(3, interval, interval.1, derivatives, knot)
    }

    /// Returns the motion from a point on at an instant `time` (s); `weights` of the points make the coefficients of
    /// s, s², s³.
    fn end_motion(
        &self,
        point: usize,
        (start, end): (f64, f64),
        time: f64,
        weights: [[f64; 4]; 3],
        knot: usize,
    ) -> Result<Segment, Error> {
        let (mut position, mut lost) = (DVec3::ZERO, DVec3::ZERO);
        let mut coefficients = [DVec3::ZERO; 3];
        for (axis, points) in self.points.iter().enumerate() {
            [position[axis], lost[axis]] = points[point].parts();
            for (coefficient, weights) in coefficients.iter_mut().zip(weights) {
                coefficient[axis] = combination(points, weights);
            }
        }
        let [linear, quadratic, cubic] = coefficients;
        let duration = end - start;
        // The position is rounded, and the velocity. The error of each point counts once for the position, and six
        // times for the velocity.
        let error = norm(lost) + 8.0 * UNIT_ROUNDOFF * norm(linear) + 8.0 * self.error;
        let state = State::new(time, position, linear / duration);
        let line = Segment::line(&state, duration, error, knot)?;
        Ok(line.with_bend([quadratic, cubic], duration))
    }
}

/// Returns the sum of points by small whole weights, with one rounding or two.
fn combination(points: &[DoubleDouble; 4], weights: [f64; 4]) -> f64 {
    let mut sum = Expansion::from(0.0);
    for (&point, weight) in points.iter().zip(weights) {
        sum = sum + Expansion::from(point).times(DoubleDouble::from(weight));
    }
    sum.rounded()
}
