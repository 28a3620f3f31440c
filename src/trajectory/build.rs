//! Constructors of trajectories, with all validation.

use super::cuts::DoublingCuts;
use super::double_double::{DoubleDouble, largest_power, size_of_terms, taylor_shift};
use super::front_gap::FrontGapVec;
use super::straight::StraightMotion;
use super::{Outside, Segment, SegmentLists, State, Storage, Trajectory, end_cubic};
use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::rounding::{UNDERFLOW, UNIT_ROUNDOFF, largest_norm, norm, without_negative_zero};
use glam::DVec3;
use std::iter::once;
use std::slice::from_ref;

/// The variable of a segment's polynomial. Prefer [`SegmentLocal`](Self::SegmentLocal): far from 0 s coefficients
/// over absolute time describe a motion badly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TimeBase {
    /// The absolute time t of the scene (s), as in `a t³ + b t² + c t + d`.
    Absolute,
    /// The time since the segment's first knot, s.
    SegmentLocal,
}

impl Trajectory {
    /// Builds cubic Hermite segments through states at irregular, increasing times.
    ///
    /// At its knots the body has the positions and velocities given, to a few roundings. Between two states it follows
    /// the one cubic that has both.
    ///
    /// ```
    /// use nearmiss::{State, Trajectory};
    ///
    /// // It brakes from 4 m/s to a stop in three seconds.
    /// let plan = Trajectory::from_states(&[
    ///     State::new(0.0, [0.0, 0.0, 0.0], [4.0, 0.0, 0.0]),
    ///     State::new(3.0, [6.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    /// ])?;
    /// assert_eq!(plan.position(1.5).map(|position| position.x), Some(4.5));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::TooFewStates`] below two (for one there is [`coasting`](Self::coasting)),
    /// [`Error::TimeNotIncreasing`], [`Error::NotFinite`] and [`Error::OutOfRange`], each with the
    /// knot and the value.
    pub fn from_states(states: &[State]) -> Result<Self, Error> {
        Self::hermite(states, states)
    }

    /// Builds the cubics that leave and arrive at knots in these states, whose times and positions agree.
    ///
    /// # Errors
    ///
    /// As [`from_states`](Self::from_states), of the states that are left.
    pub(super) fn hermite(leaving: &[State], arriving: &[State]) -> Result<Self, Error> {
        let count = leaving.len();
        if count < 2 {
            return Err(Error::TooFewStates { count });
        }
        check_states(leaving)?;
        let mut knots = FrontGapVec::with_capacity(count);
        let times = leaving
            .iter()
            .map(|state| without_negative_zero(state.time));
        times.for_each(|time| knots.push(time));
        let mut segments = FrontGapVec::with_capacity(count - 1);
        for (knot, (from, to)) in (1..).zip(leaving.iter().zip(&arriving[1..])) {
            segments.push(Segment::hermite(from, to, knot)?);
        }
        let last = count - 1;
        let terms = |knot: usize| end_cubic::of_states(&leaving[knot - 1], &arriving[knot]);
        let first_terms = terms(1);
        let last_terms = if last == 1 { first_terms } else { terms(last) };
        let end = |state: &State, knot: usize, higher: [DVec3; 2]| {
            let piece = knot.max(1);
            let duration = leaving[piece].time - leaving[piece - 1].time;
            Ok(Segment::line(state, duration, 0.0, knot)?.with_higher_terms(higher, duration))
        };
        segments.put_extra(0, end(&leaving[0], 0, first_terms[0])?);
        segments.put_extra(1, end(&arriving[last], last, last_terms[1])?);
        let lists = SegmentLists {
            knots,
            segments,
            before: Outside::Absent,
            after: Outside::Absent,
            has_piece_after: false,
        };
        Ok(Self {
            storage: Storage::Lists(lists),
        })
    }

    /// Builds one segment per polynomial, `a t³ + b t² + c t + d` as `[a, b, c, d]`, between
    /// consecutive knots (m and s).
    ///
    /// Absolute-time polynomials are moved to local time in twice the precision of f64: the segment
    /// is exact for the given coefficients to a few roundings of its own size. The coefficients
    /// themselves, as f64, may describe the intended motion less well: at t = 1e6 s they are good
    /// to metres only. Prefer local time.
    ///
    /// Consecutive segments may be discontinuous. End positions and velocities, from which a body
    /// [coasts](super::Outside::Coast), are those of the polynomial, rounded once;
    /// from [states](Self::from_states) they are exact.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{TimeBase, Trajectory};
    ///
    /// // Thrown up at 8 m/s when the clock shows 100 s, and slowed down by 8 m/s².
    /// let throw = [DVec3::ZERO, -4.0 * DVec3::Z, 8.0 * DVec3::Z, DVec3::ZERO];
    /// let knots = [100.0, 102.0];
    /// let flight = Trajectory::from_coefficients(&knots, &[throw], TimeBase::SegmentLocal)?;
    /// let height = flight.position(101.0).map_or(f64::NAN, |position| position.z);
    /// assert!((height - 4.0).abs() < 1e-14);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::SegmentCount`], [`Error::TooFewStates`]; [`Error::TimeNotIncreasing`],
    /// [`Error::NotFinite`] and [`Error::OutOfRange`] with the value and the knot (of a segment,
    /// the one at which it begins).
    pub fn from_coefficients(
        knots: &[f64],
        coefficients: &[[DVec3; 4]],
        base: TimeBase,
    ) -> Result<Self, Error> {
        let knots = checked_knots(knots, coefficients.len())?;
        let segments = coefficients
            .iter()
            .enumerate()
            .map(|(knot, polynomial)| {
                let interval = (knots[knot], knots[knot + 1]);
                polynomial_segment(interval, polynomial, base, knot)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let end_line = |segment: usize, knot: usize| {
            let (start, end) = (knots[segment], knots[segment + 1]);
            let time = match base {
                TimeBase::Absolute => DoubleDouble::from(knots[knot]),
                TimeBase::SegmentLocal => DoubleDouble::difference(knots[knot], start),
            };
            let (around, lost) = end_cubic::of_polynomial(&coefficients[segment], time);
            let [position, velocity, quadratic, cubic] = around;
            let state = State::new(knots[knot], position, velocity);
            // The position is rounded, and the velocity.
            let error = lost + 4.0 * UNIT_ROUNDOFF * norm(velocity) * (end - start);
            let line = Segment::line(&state, end - start, error, knot)?;
            Ok(line.with_higher_terms([quadratic, cubic], 1.0))
        };
        let last = segments.len() - 1;
        let ends = [end_line(0, 0)?, end_line(last, last + 1)?];
        Ok(Self::of_cubics(
            &knots,
            &segments,
            &ends,
            [Outside::Absent; 2],
        ))
    }

    /// Returns the motion along cubics between knots, with the end motions before the first and after the last one, and
    /// the [rules](Outside) there.
    pub(super) fn of_cubics(
        knots: &[f64],
        segments: &[Segment],
        ends: &[Segment; 2],
        rules: [Outside; 2],
    ) -> Self {
        Self {
            storage: Storage::Lists(SegmentLists::new(knots, segments, ends, rules)),
        }
    }

    /// Builds a body that stays at `position` (m) for all time.
    ///
    /// The body exists at all times: it can only be screened within a closed window
    /// ([`Error::WindowNotClosed`]). Its single knot is at 0 s:
    /// [`Monitor::extend`](crate::Monitor::extend) continues from there, whatever the clock shows.
    /// To set it in motion use [`Monitor::replan`](crate::Monitor::replan). The knot at 0 s remains the first one then, and
    /// counts in [`Scene::planned`](crate::Scene::planned).
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] and [`Error::OutOfRange`] if the position is not usable.
    pub fn at_rest(position: impl Into<DVec3>) -> Result<Self, Error> {
        Self::coasting(State::new(0.0, position, DVec3::ZERO))
    }

    /// Builds a body that keeps its velocity for all time: dead reckoning from one state, such as
    /// that of a body moved by a physics engine.
    ///
    /// The body exists at all times: it can only be screened within a closed window
    /// ([`Error::WindowNotClosed`]). Its single knot is the state's time. Positions are good to a
    /// few roundings of the distance covered in 6 s, or in the time to or from the state if longer.
    ///
    /// If that distance is a million times the distance between bodies (as in a scene of
    /// microseconds), filters cannot separate them and screening is slow. Then build plans from two
    /// states, as far apart as the window is long, with [`Outside::Coast`].
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{State, Trajectory};
    ///
    /// let plan = Trajectory::coasting(State::new(2.0, DVec3::Y, 3.0 * DVec3::X))?;
    /// assert_eq!(plan.position(4.0), Some(DVec3::new(6.0, 1.0, 0.0)));
    /// assert_eq!(plan.position(1.0), Some(DVec3::new(-3.0, 1.0, 0.0)));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] and [`Error::OutOfRange`] if the state is not usable, or moves farther
    /// than 1e300 m in 6 s.
    #[doc(alias = "dead reckoning")]
    pub fn coasting(state: State) -> Result<Self, Error> {
        Ok(Self::of_straight(Self::coasting_motion(&state)?))
    }

    /// Returns the motion of a [coasting](Self::coasting) body.
    ///
    /// # Errors
    ///
    /// As [`coasting`](Self::coasting).
    pub(crate) fn coasting_motion(state: &State) -> Result<StraightMotion, Error> {
        if StraightMotion::is_ordinary(state) {
            return Ok(StraightMotion::through_ordinary(state));
        }
        check_states(from_ref(state))?;
        StraightMotion::through(state)
    }

    /// Returns the trajectory of a body that moves so, before and after.
    pub(crate) fn of_straight(motion: StraightMotion) -> Self {
        let (knot, duration) = (motion.start(), motion.duration());
        let ends = [-duration, duration].map(|step| DoublingCuts::cut(knot, step, 1));
        Self {
            storage: Storage::Straight(motion, ends),
        }
    }
}

/// Checks that a number is finite and in range.
///
/// # Errors
///
/// [`Error::NotFinite`], [`Error::OutOfRange`].
pub(crate) fn check_number(knot: usize, quantity: Quantity, value: f64) -> Result<(), Error> {
    if !value.is_finite() {
        return Err(Error::NotFinite {
            knot,
            quantity,
            value,
        });
    }
    if value.abs() > MAX_MAGNITUDE {
        return Err(Error::OutOfRange {
            knot,
            quantity,
            value,
        });
    }
    Ok(())
}

/// Checks the components of a vector.
///
/// # Errors
///
/// As [`check_number`].
pub(super) fn check_vector(
    knot: usize,
    quantity: impl Fn(usize) -> Quantity,
    vector: DVec3,
) -> Result<(), Error> {
    let mut components = vector.to_array().into_iter().enumerate();
    components.try_for_each(|(axis, value)| check_number(knot, quantity(axis), value))
}

/// Checks that times are usable numbers and increase.
///
/// # Errors
///
/// The first time that is not usable, or not later than the previous one.
pub(crate) fn check_times(times: impl Iterator<Item = f64>) -> Result<(), Error> {
    let mut previous = f64::NEG_INFINITY;
    for (knot, time) in times.enumerate() {
        check_number(knot, Quantity::Time, time)?;
        if time <= previous {
            return Err(Error::TimeNotIncreasing {
                knot,
                previous,
                time,
            });
        }
        previous = time;
    }
    Ok(())
}

/// Returns the knots of a number of cubics, checked, with one zero.
///
/// # Errors
///
/// [`Error::TooFewStates`], [`Error::SegmentCount`], and those of [`check_times`].
pub(super) fn checked_knots(knots: &[f64], segments: usize) -> Result<Vec<f64>, Error> {
    if knots.len() < 2 {
        return Err(Error::TooFewStates { count: knots.len() });
    }
    if knots.len() != segments + 1 {
        return Err(Error::SegmentCount {
            knots: knots.len(),
            segments,
        });
    }
    check_times(knots.iter().copied())?;
    Ok(knots.iter().copied().map(without_negative_zero).collect())
}

/// Checks that the times of states increase, and that all numbers can be used.
///
/// # Errors
///
/// Those of [`check_times`] and [`check_vector`].
pub(super) fn check_states(states: &[State]) -> Result<(), Error> {
    check_times(states.iter().map(|state| state.time))?;
    for (knot, state) in states.iter().enumerate() {
        check_vector(knot, Quantity::Position, state.position)?;
        check_vector(knot, Quantity::Velocity, state.velocity)?;
    }
    Ok(())
}

/// Returns the Bézier form of one polynomial over the interval that begins at knot `knot`.
fn polynomial_segment(
    (start, end): (f64, f64),
    polynomial: &[DVec3; 4],
    base: TimeBase,
    knot: usize,
) -> Result<Segment, Error> {
    for (power, coefficient) in (0..4).rev().zip(polynomial) {
        check_vector(
            knot,
            |axis| Quantity::Coefficient { power, axis },
            *coefficient,
        )?;
    }
    let [a, b, c, d] = *polynomial;
    let constant_first = [d, c, b, a];
    let size = |time: f64| size_of_terms(&constant_first, time.abs());
    let (shift, of_origin, terms, farthest) = match base {
        TimeBase::Absolute => {
            let farthest = start.abs() + (end - start);
            (start, UNIT_ROUNDOFF, size(start) + size(end), farthest)
        }
        TimeBase::SegmentLocal => (0.0, 0.0, size(end - start), end - start),
    };
    let (shift, duration) = (shift.into(), DoubleDouble::difference(end, start));
    let mut origin = DVec3::ZERO;
    let mut control_points = [DVec3::ZERO; 3];
    for axis in 0..3 {
        let given = constant_first.map(|coefficient| DoubleDouble::from(coefficient[axis]));
        // To the segment's own time, then to its own unit.
        let [position, c, b, a] = taylor_shift(given, |&term| term * shift);
        let linear = c * duration;
        let quadratic = b * duration * duration;
        let cubic = a * duration * duration * duration;
        origin[axis] = position.rounded();
        control_points[0][axis] = linear.rounded() / 3.0;
        control_points[1][axis] = (linear.twice() + quadratic).rounded() / 3.0;
        control_points[2][axis] = (linear + quadratic + cubic).rounded();
    }
    // Products of times and a coefficient multiply what another product lost by underflow.
    let underflow = UNDERFLOW * 64.0 * largest_power(&constant_first, farthest);
    // One rounding of the origin where it was computed, one (and a third's) of each point, and
    // 2^-100 of everything that was added up, which covers the double-double arithmetic.
    let of_points = 4.0 * UNIT_ROUNDOFF * largest_norm(&control_points);
    let of_terms = 2f64.powi(-100) * (32.0 * terms) + underflow;
    let error = of_origin * norm(origin) + of_points + of_terms;
    let is_usable = |point: &DVec3| point.is_finite() && point.abs().max_element() <= MAX_MAGNITUDE;
    let mut points = once(origin).chain(control_points);
    if let Some(point) = points.find(|point| !is_usable(point)) {
        return Err(Error::OutOfRange {
            knot,
            quantity: Quantity::Distance,
            // A component that is not finite is NaN, or hides behind one that is.
            value: if point.is_finite() {
                point.abs().max_element()
            } else {
                f64::INFINITY
            },
        });
    }
    Segment::from_control_points((start, end), origin, control_points, error, knot)
}
