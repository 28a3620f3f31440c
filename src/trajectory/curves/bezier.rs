//! Bézier pieces: control points to twice the precision of f64, and the segments and end motions that follow from them.

use crate::error::{Error, Quantity};
use crate::rounding::{UNIT_ROUNDOFF, largest_norm, norm};
use crate::trajectory::build::{check_vector, checked_knots};
use crate::trajectory::double_double::{DoubleDouble, Expansion};
use crate::trajectory::{Outside, Segment, State, Trajectory};
use glam::DVec3;

impl Trajectory {
    /// Builds one segment per cubic Bézier piece, given by its four control points (m), between consecutive knots
    /// (s). Over each piece the Bézier parameter runs evenly with time.
    ///
    /// Each piece must begin with the very point at which the one before it ends. Its velocity may jump there. For
    /// a motion that jumps, use [`from_coefficients`](Self::from_coefficients).
    ///
    /// The control points are kept relative to the first one of their piece, each with one rounding of that distance.
    /// Position, velocity and acceleration at both ends, from which a body goes on beyond its knots if
    /// [`Outside`] says so, are those of the curve, rounded once or twice.
    ///
    /// ```
    /// use nearmiss::Trajectory;
    ///
    /// let curve = [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0], [4.0, 0.0, 0.0]];
    /// let plan = Trajectory::from_bezier(&[10.0, 12.0], &[curve])?;
    /// let middle = plan.position(11.0).map(|position| position.to_array());
    /// assert_eq!(middle, Some([2.0, 3.0, 0.0]));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Discontinuous`] with the knot where the curve is broken; [`Error::SegmentCount`],
    /// [`Error::TooFewStates`]; [`Error::TimeNotIncreasing`], [`Error::NotFinite`] and [`Error::OutOfRange`] with the
    /// value and the knot (of a control point, the one at which its piece begins).
    #[doc(alias("Bézier", "control points"))]
    pub fn from_bezier<P: Copy + Into<DVec3>>(
        knots: &[f64],
        pieces: &[[P; 4]],
    ) -> Result<Self, Error> {
        let pieces: Vec<_> = pieces.iter().map(|piece| piece.map(Into::into)).collect();
        Self::of_bezier(knots, &pieces)
    }

    fn of_bezier(knots: &[f64], pieces: &[[DVec3; 4]]) -> Result<Self, Error> {
        let knots = checked_knots(knots, pieces.len())?;
        for (knot, piece) in pieces.iter().enumerate() {
            for (point, position) in piece.iter().enumerate() {
                check_vector(
                    knot,
                    |axis| Quantity::ControlPoint { point, axis },
                    *position,
                )?;
            }
        }
        for (knot, pair) in (1..).zip(pieces.windows(2)) {
            let apart = pair[1][0] - pair[0][3];
            if apart != DVec3::ZERO {
                let distance = norm(apart);
                return Err(Error::Discontinuous { knot, distance });
            }
        }
        let exact = |piece: &[DVec3; 4]| {
            let of_axis = |axis: usize| piece.map(|point| DoubleDouble::from(point[axis]));
            BezierPoints::new([0, 1, 2].map(of_axis), 0.0)
        };
        let pieces: Vec<BezierPoints> = pieces.iter().map(exact).collect();
        Self::of_control_points(&knots, &pieces)
    }

    /// Returns the motion along cubics, given by their control points, between consecutive knots.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`].
    pub(super) fn of_control_points(knots: &[f64], pieces: &[BezierPoints]) -> Result<Self, Error> {
        let interval = |piece: usize| [knots[piece], knots[piece + 1]];
        let segments = pieces
            .iter()
            .enumerate()
            .map(|(piece, points)| points.segment(interval(piece), piece + 1))
            .collect::<Result<Vec<_>, _>>()?;
        let last = pieces.len() - 1;
        let ends = [
            pieces[0].end_motion(0, interval(0), 0)?,
            pieces[last].end_motion(1, interval(last), last + 1)?,
        ];
        Ok(Self::of_cubics(
            knots,
            &segments,
            &ends,
            [Outside::Absent; 2],
        ))
    }
}

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
    fn segment(&self, interval: [f64; 2], knot: usize) -> Result<Segment, Error> {
        let (mut origin, mut control_points) = (DVec3::ZERO, [DVec3::ZERO; 3]);
        // Losses by rounding: of the origin, then of the displacements from it.
        let mut lost = [DVec3::ZERO; 4];
        for (axis, [first, others @ ..]) in self.points.into_iter().enumerate() {
            [origin[axis], lost[0][axis]] = first.parts();
            for (place, point) in others.into_iter().enumerate() {
                let displacement = point + first.negated();
                [control_points[place][axis], lost[place + 1][axis]] = displacement.parts();
            }
        }
        // The displacements themselves have an error of 3 u², far below 2^-100.
        let of_ways = largest_norm(&lost[1..]) + 2f64.powi(-100) * largest_norm(&control_points);
        let error = (norm(lost[0]) + of_ways + self.error) * (1.0 + 16.0 * UNIT_ROUNDOFF);
        Segment::from_control_points(interval.into(), origin, control_points, error, knot)
    }

    /// Returns the end motion from the first point (`end` 0) or the last one (1); `knot` is that point's number.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`].
    fn end_motion(&self, end: usize, interval: [f64; 2], knot: usize) -> Result<Segment, Error> {
        /// Weights of the points in the coefficients of s, s², s³, around the first and around the last one.
        const WEIGHTS: [[[f64; 4]; 3]; 2] = [
            [
                [-3.0, 3.0, 0.0, 0.0],
                [3.0, -6.0, 3.0, 0.0],
                [-1.0, 3.0, -3.0, 1.0],
            ],
            [
                [0.0, 0.0, -3.0, 3.0],
                [0.0, 3.0, -6.0, 3.0],
                [-1.0, 3.0, -3.0, 1.0],
            ],
        ];
        let (mut position, mut lost) = (DVec3::ZERO, DVec3::ZERO);
        let mut coefficients = [DVec3::ZERO; 3];
        for (axis, points) in self.points.iter().enumerate() {
            [position[axis], lost[axis]] = points[3 * end].parts();
            for (coefficient, weights) in coefficients.iter_mut().zip(WEIGHTS[end]) {
                coefficient[axis] = combination(points, weights);
            }
        }
        let [linear, quadratic, cubic] = coefficients;
        let duration = interval[1] - interval[0];
        // The position is rounded, and the velocity. The error of each point counts once for the position, and six
        // times for the velocity.
        let error = norm(lost) + 8.0 * UNIT_ROUNDOFF * norm(linear) + 8.0 * self.error;
        let state = State::new(interval[end], position, linear / duration);
        let line = Segment::line(&state, duration, error, knot)?;
        Ok(line.with_higher_terms([quadratic, cubic], duration))
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
