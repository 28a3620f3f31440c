//! Cubic B-splines, by their blossoms.
//!
//! L. Ramshaw, "Blossoms are polar forms", 1989: the Bézier points of a cubic between u and w are its blossom at
//! (u, u, u), (u, u, w), (u, w, w) and (w, w, w). De Boor's algorithm finds each of them from four control points.

use super::bezier::BezierPoints;
use crate::error::{Error, Quantity};
use crate::rounding::{norm, without_negative_zero};
use crate::trajectory::Trajectory;
use crate::trajectory::build::{check_number, check_times, check_vector};
use crate::trajectory::double_double::DoubleDouble;
use glam::DVec3;
use std::iter::{once, successors};

impl Trajectory {
    /// Builds the cubic B-spline with a knot vector (s) and control points (m), one segment per interval between
    /// different knots.
    ///
    /// n control points need n + 4 knots, not decreasing. The body moves from knot 3 to knot n (counted from 0). For a
    /// curve that begins or ends at a control point, give that knot four times, as usual ("clamped").
    ///
    /// Inside, a knot that occurs once leaves the acceleration continuous, twice the velocity, three times the
    /// position. Four times is accepted if the two control points there are the same.
    ///
    /// The Bézier points of each segment are computed with twice the precision of f64. So a position is good to two
    /// roundings of itself, and 2e-14 of the segment's extent for its evaluation. Position, velocity and acceleration
    /// at both ends are those of the curve, to a few roundings of their own and 1e-27 of the largest coordinate. From
    /// these a body goes on beyond its knots if [`Outside`](crate::Outside) says so. Answers there speak of the motion
    /// with these coefficients. Their error grows with the third power of the time gone, in units of the last interval.
    /// It is not part of a certificate.
    ///
    /// ```
    /// use nearmiss::Trajectory;
    /// use nearmiss::glam::DVec3;
    ///
    /// let points = [[0.0, 0.0, 0.0], [3.0, 6.0, 0.0], [9.0, 6.0, 0.0], [12.0, 0.0, 0.0], [15.0, 0.0, 0.0]];
    /// let points = points.map(DVec3::from_array);
    /// let knots = [0.0, 0.0, 0.0, 0.0, 4.0, 5.0, 5.0, 5.0, 5.0];
    /// let plan = Trajectory::from_b_spline(&knots, &points)?;
    /// assert_eq!(plan.knots(), [0.0, 4.0, 5.0]);
    /// assert_eq!(plan.position(0.0), Some(points[0]));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::TooFewControlPoints`], [`Error::KnotCount`]; [`Error::TimeNotIncreasing`] if a knot is earlier than the
    /// one before, occurs more than four times, or if no time passes; [`Error::Discontinuous`] where a knot that occurs
    /// four times breaks the curve; [`Error::NotFinite`] and [`Error::OutOfRange`] with the value and the knot (of a
    /// control point, the first one of those that it depends on).
    #[doc(alias("NURBS", "de Boor", "control points"))]
    pub fn from_b_spline<P: Copy + Into<DVec3>>(
        knots: &[f64],
        control_points: &[P],
    ) -> Result<Self, Error> {
        let control_points: Vec<_> = control_points.iter().map(|&point| point.into()).collect();
        Self::of_b_spline(knots, &control_points)
    }

    fn of_b_spline(knots: &[f64], control_points: &[DVec3]) -> Result<Self, Error> {
        let count = check_control_points(control_points, 0)?;
        if knots.len() != count + 4 {
            return Err(Error::KnotCount {
                knots: knots.len(),
                control_points: count,
            });
        }
        check_knot_vector(knots, control_points)?;
        let mut times = vec![without_negative_zero(knots[3])];
        let mut pieces = Vec::new();
        for (first, around) in knots.windows(6).enumerate().skip(1) {
            // From knot `last` on; the four points from `last - 3` on are those that count.
            let last = first + 2;
            if last >= count || around[2] >= around[3] {
                continue;
            }
            pieces.push(piece(&control_points[last - 3..=last], around));
            times.push(without_negative_zero(around[3]));
        }
        Self::of_control_points(&times, &pieces)
    }

    /// Builds the uniform cubic B-spline with control points (m): knots at `start`, `start + interval`, and so on (s),
    /// each rounded to f64.
    ///
    /// n control points make n - 3 segments. The curve passes near its control points, not through them: it begins at
    /// a sixth of the first, four of the second and one of the third, and ends likewise. Position, velocity and
    /// acceleration are continuous, but for what times are rounded by. Rounding is as in
    /// [`from_b_spline`](Self::from_b_spline).
    ///
    /// ```
    /// use nearmiss::Trajectory;
    /// use nearmiss::glam::DVec3;
    ///
    /// let points = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| x * DVec3::X);
    /// let plan = Trajectory::from_uniform_b_spline(20.0, 0.5, &points)?;
    /// assert_eq!(plan.knots(), [20.0, 20.5, 21.0]);
    /// assert_eq!(plan.position(20.25), Some(1.5 * DVec3::X));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::TooFewControlPoints`]; [`Error::TimeNotIncreasing`] if the interval is not positive, or vanishes beside
    /// `start`; [`Error::NotFinite`] and [`Error::OutOfRange`] with the value and the knot (of a control point, the
    /// first one of those of its segments).
    #[doc(alias("de Boor", "control points"))]
    pub fn from_uniform_b_spline<P: Copy + Into<DVec3>>(
        start: f64,
        interval: f64,
        control_points: &[P],
    ) -> Result<Self, Error> {
        let control_points: Vec<_> = control_points.iter().map(|&point| point.into()).collect();
        Self::of_uniform_b_spline((start, interval), &control_points)
    }

    fn of_uniform_b_spline(
        (start, interval): (f64, f64),
        control_points: &[DVec3],
    ) -> Result<Self, Error> {
        let count = check_control_points(control_points, 3)?;
        // Counted in f64, which is exact for any number of points in memory.
        let steps = successors(Some(1.0), |step| Some(step + 1.0));
        let later = steps.map(|step: f64| step.mul_add(interval, start));
        let times = once(start).chain(later).take(count - 2);
        let times: Vec<f64> = times.map(without_negative_zero).collect();
        check_times(times.iter().copied())?;
        let even = [-2.0, -1.0, 0.0, 1.0, 2.0, 3.0];
        let pieces = control_points.windows(4).map(|points| piece(points, &even));
        Self::of_control_points(&times, &pieces.collect::<Vec<_>>())
    }
}

/// Checks the control points, and returns their number. `before` is the number of knots before the first instant that
/// counts in errors.
fn check_control_points(control_points: &[DVec3], before: usize) -> Result<usize, Error> {
    let count = control_points.len();
    if count < 4 {
        return Err(Error::TooFewControlPoints { count });
    }
    for (point, position) in control_points.iter().enumerate() {
        let knot = point.saturating_sub(before);
        check_vector(
            knot,
            |axis| Quantity::ControlPoint { point, axis },
            *position,
        )?;
    }
    Ok(count)
}

/// Checks that knots do not decrease, nor break the curve, and that time passes.
fn check_knot_vector(knots: &[f64], control_points: &[DVec3]) -> Result<(), Error> {
    for (knot, &time) in knots.iter().enumerate() {
        check_number(knot, Quantity::Time, time)?;
        // No earlier than the one before, and later than the fourth before.
        let before = |steps: usize| knot.checked_sub(steps).map(|earlier| knots[earlier]);
        let previous = before(1).filter(|&previous| time < previous);
        if let Some(previous) = previous.or(before(4).filter(|&fourth| time <= fourth)) {
            return Err(Error::TimeNotIncreasing {
                knot,
                previous,
                time,
            });
        }
    }
    let count = control_points.len();
    let (start, end) = (knots[3], knots[count]);
    if start >= end {
        return Err(Error::TimeNotIncreasing {
            knot: count,
            previous: start,
            time: end,
        });
    }
    for (knot, four) in knots.windows(4).enumerate() {
        if four[0] >= four[3] && start < four[0] && four[0] < end {
            // Before it the curve ends at one control point, after it begins at the next one.
            let apart = control_points[knot] - control_points[knot - 1];
            if apart != DVec3::ZERO {
                let distance = norm(apart);
                return Err(Error::Discontinuous { knot, distance });
            }
        }
    }
    Ok(())
}

/// Returns the cubic of four control points between the third and the fourth of six knots.
///
/// Each of three steps loses less than 2^-100 of the largest coordinate on an axis.
fn piece(points: &[DVec3], knots: &[f64]) -> BezierPoints {
    let [u, w] = [knots[2], knots[3]];
    let instants = [[u, u, u], [u, u, w], [u, w, w], [w, w, w]];
    let of_axis = |axis: usize| {
        let points = [0, 1, 2, 3].map(|k| DoubleDouble::from(points[k][axis]));
        instants.map(|instants| blossom(points, knots, instants))
    };
    let sizes = points.iter().map(|point| point.abs());
    let lost = 2f64.powi(-96) * norm(sizes.fold(DVec3::ZERO, DVec3::max));
    BezierPoints::new([0, 1, 2].map(of_axis), lost)
}

/// Returns the blossom, at three instants, of the cubic between the third and the fourth of six knots.
fn blossom(mut points: [DoubleDouble; 4], knots: &[f64], instants: [f64; 3]) -> DoubleDouble {
    for (step, instant) in (1..).zip(instants) {
        for place in (step..4).rev() {
            let (low, high) = (knots[place - 1], knots[place + 3 - step]);
            let lasting = DoubleDouble::difference(high, low);
            let share = |from: f64, to: f64| DoubleDouble::difference(to, from).quotient(lasting);
            points[place] =
                points[place - 1] * share(instant, high) + points[place] * share(low, instant);
        }
    }
    points[3]
}
