//! Bézier pieces.

use super::bezier_points::BezierPoints;
use crate::error::{Error, Quantity};
use crate::rounding::norm;
use crate::trajectory::Trajectory;
use crate::trajectory::build::{check_number, checked_knots};
use crate::trajectory::double_double::DoubleDouble;
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
    /// [`Outside`](crate::Outside) says so, are those of the curve, rounded once or twice.
    ///
    /// ```
    /// use nearmiss::Trajectory;
    ///
    /// let curve = [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0], [4.0, 0.0, 0.0]];
    /// let plan = Trajectory::from_bezier(&[10.0, 12.0], &[curve.map(Into::into)])?;
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
    pub fn from_bezier(knots: &[f64], pieces: &[[DVec3; 4]]) -> Result<Self, Error> {
        let knots = checked_knots(knots, pieces.len())?;
        for (knot, piece) in pieces.iter().enumerate() {
            for (point, position) in piece.iter().enumerate() {
                for axis in 0..3 {
                    let quantity = Quantity::ControlPoint { point, axis };
                    check_number(knot, quantity, position[axis])?;
                }
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
        let interval = |piece: usize| (knots[piece], knots[piece + 1]);
        let segments = pieces
            .iter()
            .enumerate()
            .map(|(piece, points)| points.segment(interval(piece), piece + 1))
            .collect::<Result<Vec<_>, _>>()?;
        let last = pieces.len() - 1;
        let ends = [
            pieces[0].leaving(interval(0), 0)?,
            pieces[last].arriving(interval(last), last + 1)?,
        ];
        Ok(Self::of_cubics(knots, &segments, &ends))
    }
}
