//! A cubic between two knots, relative to the position at the first one.

mod restriction;

pub(crate) use restriction::Restriction;

use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::rounding::{
    UNDERFLOW, UNIT_ROUNDOFF, largest_norm, norm, scale_to_one, without_negative_zero,
};
use crate::trajectory::state::State;
use glam::DVec3;

/// A cubic over [`start`](Self::start)..[`end`](Self::end), as Bézier control points relative
/// to its first position.
///
/// Neither the absolute time nor the absolute position enters the rounding of the control points:
/// they come from differences of the user's own numbers.
///
/// ```
/// use nearmiss::{State, Trajectory};
///
/// let states = [0.0, 3.0].map(|t| State::new(t, [t + 5.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
/// let plan = Trajectory::from_states(&states)?;
/// let segment = &plan.segments()[0];
/// assert_eq!((segment.start(), segment.end(), segment.origin().x), (0.0, 3.0, 5.0));
/// assert_eq!(segment.control_points().map(|point| point.x), [0.0, 1.0, 2.0, 3.0]);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    start: f64,
    end: f64,
    /// Position at `start`, m: the user's own number if states were given.
    origin: DVec3,
    /// Bézier control points 1, 2, 3 relative to `origin` (point 0 is zero), m. In [power
    /// form](Self::is_power_form): coefficients of x, x², x³, with x the time since `start` in thirds
    /// of the duration.
    control_points: [DVec3; 3],
    /// Upper bound of the control points' distance from the origin, m.
    extent: f64,
    /// Bound on the error of each point `origin + control`, m; with a minus sign in [power
    /// form](Self::is_power_form).
    error: f64,
}

impl Segment {
    /// Builds the cubic Hermite segment between two states; `knot` is the second one's number.
    ///
    /// The states must be finite and their times increase.
    pub(super) fn hermite(first: &State, second: &State, knot: usize) -> Result<Self, Error> {
        let duration = second.time - first.time;
        let end = second.position - first.position;
        let leave = first.velocity * duration / 3.0;
        let arrive = second.velocity * duration / 3.0;
        let longest = norm(leave).max(norm(arrive));
        let extent = (norm(end) + longest) * (1.0 + 8.0 * UNIT_ROUNDOFF);
        // With u half a unit in the last place, S the length of `end` and W = `longest`: u S for point 3 (one
        // difference), 3 u W for point 1 (difference of times, product, quotient), u (2 S + 4 W) for point 2 (both,
        // and their difference). Each is at most 4 u (S + W).
        let error = 4.0 * UNIT_ROUNDOFF * extent + UNDERFLOW;
        let (interval, points) = ((first.time, second.time), [leave, end - arrive, end]);
        Self::from_parts(interval, first.position, points, (extent, error), knot)
    }

    /// Builds the straight segment of constant velocity between two instants and positions (s, m); `knot` is the
    /// second one's number. The segment is exactly straight, and of exactly constant velocity.
    ///
    /// The numbers must be finite and the times increase.
    pub(super) fn leg(
        first: (f64, DVec3),
        second: (f64, DVec3),
        knot: usize,
    ) -> Result<Self, Error> {
        // Three times the third of a number is that number again (W. Kahan): point 3 has only the
        // rounding of the difference.
        let step = (second.1 - first.1) / 3.0;
        let extent = norm(3.0 * step) * (1.0 + 8.0 * UNIT_ROUNDOFF);
        // A rounding of the difference, one of the step; underflow of the step, three times.
        let error = -(2.0 * UNIT_ROUNDOFF * extent + UNDERFLOW);
        let (interval, points) = ((first.0, second.0), [step, DVec3::ZERO, DVec3::ZERO]);
        Self::from_parts(interval, first.1, points, (extent, error), knot)
    }

    /// Builds straight motion through `state`, in both directions of time: `Coast` and rest.
    ///
    /// `duration` (s) is only the unit of its parameter, rounded to three times a power of two. Control
    /// points 1 and 2 are then exact, unless the end is rounded. `error` (m) is that of the state's position; it
    /// must be positive if its velocity is rounded.
    pub(super) fn line(
        state: &State,
        duration: f64,
        error: f64,
        knot: usize,
    ) -> Result<Self, Error> {
        // At least an ulp of the knot's time, so that there is an end.
        let third = (duration / 3.0)
            .max(2.0 * f64::EPSILON * state.time.abs())
            .max(f64::MIN_POSITIVE / f64::EPSILON);
        let third = 1.0 / scale_to_one(third.min(MAX_MAGNITUDE));
        Self::through(state, state.time + 3.0 * third, error).checked(knot)
    }

    /// Returns straight motion through a state, with a duration up to `end` (s) as [`line`](Self::line) rounds it.
    pub(super) fn through(state: &State, end: f64, error: f64) -> Self {
        // The unit of the parameter is the rounded end minus the start. A third of it may have a rounding.
        let duration = end - state.time;
        let third = duration / 3.0;
        let is_exact = is_power_of_two(third) && (duration - 3.0 * third).abs() <= 0.0;
        let step = state.velocity * third;
        let extent = norm(3.0 * step) * (1.0 + 8.0 * UNIT_ROUNDOFF);
        Self {
            start: state.time,
            end,
            origin: state.position,
            control_points: [step, DVec3::ZERO, DVec3::ZERO],
            extent,
            // A third of the duration, and its products.
            error: if is_exact {
                -error
            } else {
                -(error + 4.0 * UNIT_ROUNDOFF * extent)
            },
        }
    }

    /// Adds the quadratic and cubic coefficient of a cubic through the same state, in units of
    /// `duration` (s). [`straight`](Self::straight) drops them again,
    /// [`extended`](Self::extended) includes them in the bounds.
    pub(super) fn with_higher_terms(self, [quadratic, cubic]: [DVec3; 2], duration: f64) -> Self {
        let ratio = (self.end - self.start) / 3.0 / duration;
        self.with_coefficients([quadratic * ratio * ratio, cubic * ratio * ratio * ratio])
    }

    /// Sets the quadratic and cubic coefficient, in thirds of the segment's own duration.
    pub(super) const fn with_coefficients(mut self, [quadratic, cubic]: [DVec3; 2]) -> Self {
        self.control_points[1] = quadratic;
        self.control_points[2] = cubic;
        self
    }

    /// Returns the straight motion from the knot on.
    pub(super) const fn straight(self) -> Self {
        self.with_coefficients([DVec3::ZERO; 2])
    }

    /// Returns the straight motion that has the position and velocity of this cubic at an instant (s).
    pub(super) fn line_at(&self, time: f64) -> Self {
        let (position, velocity, _) = self.motion_at(time);
        let state = State::new(time, position, velocity);
        let scale = self.rounding_scale(time, time);
        // The position is rounded once more than its displacement from the origin. The cubic's error counts once for
        // the position, and six times for the velocity; an evaluation's is below 128 roundings for each.
        let error = 2.0 * Self::EVALUATION * scale + UNIT_ROUNDOFF * norm(position);
        let lasting = self.end - self.start;
        // So that there is an end.
        let duration = lasting.max(6.0 * f64::EPSILON * time.abs());
        let mut line = Self::through(&state, time + duration, error);
        // The velocity's error, up to 224 roundings of the scale in the cubic's duration, grows with time. It is
        // relative to the cubic, not to the velocity, which may vanish: 20 roundings of the extent are counted.
        line.extent += 12.0 * scale * (duration / lasting);
        line
    }

    /// Returns the cubic motion from the knot on.
    pub(super) fn extended(mut self) -> Self {
        let [linear, quadratic, cubic] = self.powers().map(norm);
        self.extent = (linear + quadratic + cubic) * (1.0 + 8.0 * UNIT_ROUNDOFF);
        self.error -= 32.0 * UNIT_ROUNDOFF * self.extent + UNDERFLOW;
        self
    }

    /// Builds a segment from Bézier points relative to `origin`, each good to `error` (m); `knot`
    /// is the number of its end knot.
    pub(super) fn from_control_points(
        interval: (f64, f64),
        origin: DVec3,
        control_points: [DVec3; 3],
        error: f64,
        knot: usize,
    ) -> Result<Self, Error> {
        let extent = largest_norm(&control_points) * (1.0 + 8.0 * UNIT_ROUNDOFF);
        let bounds = (extent, error + UNDERFLOW);
        Self::from_parts(interval, origin, control_points, bounds, knot)
    }

    /// Builds a segment from its fields: start and end, origin, control points, extent and error.
    pub(super) fn from_parts(
        (start, end): (f64, f64),
        origin: DVec3,
        control_points: [DVec3; 3],
        (extent, error): (f64, f64),
        knot: usize,
    ) -> Result<Self, Error> {
        Self {
            start,
            end,
            origin,
            control_points,
            extent,
            error,
        }
        .checked(knot)
    }

    /// Returns an error where a later computation could overflow: positions, velocities or
    /// accelerations beyond 1e300.
    fn checked(mut self, knot: usize) -> Result<Self, Error> {
        (self.start, self.end) = (
            without_negative_zero(self.start),
            without_negative_zero(self.end),
        );
        let duration = self.end - self.start;
        // The largest acceleration of a cubic with these control points is 6 · 4 extents.
        let acceleration = 24.0 * (self.extent / duration / duration);
        let out_of_range = |quantity, value| {
            Err(Error::OutOfRange {
                knot,
                quantity,
                value,
            })
        };
        if duration.is_infinite() {
            return out_of_range(Quantity::Time, duration);
        }
        if self.extent.is_nan() || self.extent > MAX_MAGNITUDE {
            // NaN: a number that it follows from has left the range of f64.
            let reached = Some(self.extent).filter(|extent| !extent.is_nan());
            return out_of_range(Quantity::Distance, reached.unwrap_or(f64::INFINITY));
        }
        if self.error.is_nan() || self.error() > MAX_MAGNITUDE {
            // Terms that cancel are larger than that.
            return out_of_range(Quantity::Distance, f64::INFINITY);
        }
        if self.extent > 0.0 && (acceleration.is_nan() || acceleration > MAX_MAGNITUDE) {
            return out_of_range(Quantity::Acceleration, acceleration);
        }
        if 6.0 * (self.extent / duration) > MAX_MAGNITUDE {
            return out_of_range(Quantity::Speed, 6.0 * (self.extent / duration));
        }
        Ok(self)
    }

    /// Returns the time of the first knot, s.
    #[must_use]
    pub const fn start(&self) -> f64 {
        self.start
    }

    /// Returns the time of the second knot, s.
    #[must_use]
    pub const fn end(&self) -> f64 {
        self.end
    }

    /// Returns the position at [`start`](Self::start), m: the user's number if states were given.
    #[must_use]
    pub const fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Returns the four Bézier control points relative to [`origin`](Self::origin), m.
    #[must_use]
    pub fn control_points(&self) -> [DVec3; 4] {
        let [first, second, third] = self.control_points;
        if self.is_power_form() {
            let end = 3.0 * first + (9.0 * second + 27.0 * third);
            [DVec3::ZERO, first, 2.0 * first + 3.0 * second, end]
        } else {
            [DVec3::ZERO, first, second, third]
        }
    }

    /// Returns the coefficients of s, s², s³ around the start.
    fn powers(&self) -> [DVec3; 3] {
        let [first, second, third] = self.control_points;
        if self.is_power_form() {
            [3.0 * first, 9.0 * second, 27.0 * third]
        } else {
            power_form(first, second, third)
        }
    }

    /// Returns an upper bound of the control points' distance from the origin, m. Below 1e-308 m it
    /// may be 1e-323 m too small.
    #[must_use]
    pub const fn extent(&self) -> f64 {
        self.extent
    }

    /// Returns a bound on the error of each point `origin + control`, m.
    pub(crate) const fn error(&self) -> f64 {
        self.error.abs()
    }

    /// Returns the numbers that define the control points, and the signed error.
    #[cfg(feature = "serde")]
    pub(super) const fn parts(&self) -> ([DVec3; 3], f64) {
        (self.control_points, self.error)
    }

    /// Rounding of a position between the knots, relative to the extent: 80 roundings in the worst case, by the count
    /// of those in [`motion_at`](Self::motion_at).
    pub(super) const EVALUATION: f64 = 128.0 * UNIT_ROUNDOFF;

    /// Returns position, velocity and acceleration at `time` (m, m/s, m/s²), also beyond the knots.
    ///
    /// Between the knots the position has an error of at most one rounding of itself, and 2e-14 of the
    /// [`extent`](Self::extent). Beyond them no bound is given: [`Outside`](crate::Outside) has that of
    /// [`Trajectory::position`](crate::Trajectory::position).
    #[must_use]
    pub fn motion_at(&self, time: f64) -> (DVec3, DVec3, DVec3) {
        let duration = self.end - self.start;
        // Power form around the nearer knot, so that the states themselves are met exactly. An end motion has
        // its state at the start: far from there, powers around its other end would cancel and lose the state.
        if self.is_curved() {
            // A third of the duration: a power of two, unless the end is rounded (see `line`).
            let unit = duration / 3.0;
            let (offset, rate, curve) = powers_at(&self.control_points, (time - self.start) / unit);
            (self.origin + offset, rate / unit, curve / unit / unit)
        } else if self.is_power_form() || time - self.start <= self.end - time {
            let (offset, rate, curve) = powers_at(&self.powers(), (time - self.start) / duration);
            let (velocity, acceleration) = (rate / duration, curve / duration / duration);
            (self.origin + offset, velocity, acceleration)
        } else {
            let [first, second, third] = self.control_points;
            let back = power_form(second - third, first - third, DVec3::ZERO - third);
            let (offset, rate, curve) = powers_at(&back, (self.end - time) / duration);
            let (velocity, acceleration) = (-rate / duration, curve / duration / duration);
            (self.origin + (third + offset), velocity, acceleration)
        }
    }

    /// Returns true if an interval lies between the segment's knots.
    pub(crate) fn covers(&self, from: f64, to: f64) -> bool {
        from >= self.start && to <= self.end
    }

    /// Returns true for a segment in power form around `start`: an end motion, which goes on outwards from a
    /// knot there, or a [`leg`](Self::leg). Only such segments have an error of zero or less.
    pub(super) fn is_power_form(&self) -> bool {
        self.error <= 0.0
    }

    /// Returns true for a segment in power form that is not straight: a cubic end motion.
    fn is_curved(&self) -> bool {
        self.is_power_form() && !self.has_no_higher_terms()
    }

    /// Returns true for a segment in power form that is straight: of exactly constant velocity.
    pub(crate) fn is_straight(&self) -> bool {
        self.is_power_form() && self.has_no_higher_terms()
    }

    fn has_no_higher_terms(&self) -> bool {
        let higher = self.control_points[1]
            .abs()
            .max(self.control_points[2].abs());
        higher.max_element() <= 0.0
    }

    /// Returns the velocity of a straight motion, m/s.
    pub(super) fn straight_velocity(&self) -> DVec3 {
        self.control_points[0] / ((self.end - self.start) / 3.0)
    }
}

/// Returns true for a normal power of two.
fn is_power_of_two(number: f64) -> bool {
    number.is_normal() && number.to_bits().trailing_zeros() >= f64::MANTISSA_DIGITS - 1
}

/// Returns the coefficients of s, s², s³ of the cubic with Bézier points 0, first, second, third.
fn power_form(first: DVec3, second: DVec3, third: DVec3) -> [DVec3; 3] {
    [
        3.0 * first,
        3.0 * (second - 2.0 * first),
        third - 3.0 * (second - first),
    ]
}

/// Returns c1 x + c2 x² + c3 x³ with its first and second derivative.
fn powers_at(&[linear, quadratic, cubic]: &[DVec3; 3], x: f64) -> (DVec3, DVec3, DVec3) {
    (
        x * (linear + x * (quadratic + x * cubic)),
        linear + x * (2.0 * quadratic + x * 3.0 * cubic),
        2.0 * quadratic + x * 6.0 * cubic,
    )
}

#[cfg(test)]
mod tests;
