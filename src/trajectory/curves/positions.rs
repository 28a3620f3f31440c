//! Positions only: velocities by a rule.

use super::waypoints::{check_positions, positions_of};
use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::trajectory::build::check_vector;
use crate::trajectory::{State, Trajectory};
use glam::DVec3;

/// The rule by which positions get velocities: see [`Trajectory::from_positions_with`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[doc(alias("tangent", "Catmull-Rom", "PCHIP"))]
pub struct PositionOptions {
    first_velocity: Option<DVec3>,
    last_velocity: Option<DVec3>,
    has_limit: bool,
}

impl PositionOptions {
    /// Returns the rule of [`Trajectory::from_positions`].
    #[must_use]
    pub const fn new() -> Self {
        Self {
            first_velocity: None,
            last_velocity: None,
            has_limit: false,
        }
    }

    /// Returns the rule with a velocity at the first position, m/s: zero for a start from rest.
    #[must_use]
    pub fn with_first_velocity(mut self, velocity: impl Into<DVec3>) -> Self {
        self.first_velocity = Some(velocity.into());
        self
    }

    /// Returns the rule with a velocity at the last position, m/s.
    #[must_use]
    pub fn with_last_velocity(mut self, velocity: impl Into<DVec3>) -> Self {
        self.last_velocity = Some(velocity.into());
        self
    }

    /// Returns the rule with limited velocities, so that no coordinate overshoots: between two positions x stays
    /// between theirs, and so do y and z, to some roundings.
    ///
    /// Each component is limited by itself. It is zero where the coordinate turns back or rests. Elsewhere
    /// it is at most three times the smaller one of the mean velocities before and after. Given end velocities are
    /// not limited: beside them a coordinate may overshoot.
    ///
    /// This is the region of F. N. Fritsch and R. E. Carlson, "Monotone piecewise cubic interpolation" (PCHIP), 1980,
    /// as a square.
    #[doc(alias("PCHIP", "Fritsch-Carlson", "monotone"))]
    #[must_use]
    pub const fn with_limited_velocities(mut self) -> Self {
        self.has_limit = true;
        self
    }

    /// Returns the velocity at the first position, m/s, if one is given.
    #[must_use]
    pub const fn first_velocity(&self) -> Option<DVec3> {
        self.first_velocity
    }

    /// Returns the velocity at the last position, m/s, if one is given.
    #[must_use]
    pub const fn last_velocity(&self) -> Option<DVec3> {
        self.last_velocity
    }

    /// Returns true if velocities are [limited](Self::with_limited_velocities).
    #[must_use]
    pub const fn has_limited_velocities(&self) -> bool {
        self.has_limit
    }
}

impl Trajectory {
    /// Builds cubic Hermite segments through positions only, `(time, position)` (s, m); velocities follow the
    /// non-uniform Catmull-Rom rule.
    ///
    /// The velocity at an inner position is that of the parabola through it and its two neighbours. At an end it is
    /// that of the parabola through the three positions there; with two positions, the chord's.
    ///
    /// This suits samples of a smooth motion. **It does not suit waypoints with straight legs**: the body leaves a leg
    /// near its ends, swings out beside corners, overshoots where it should stop, and never is at constant velocity.
    /// With a velocity off by v from the leg's at its ends, it strays from a leg of T seconds by up to v T / 4.
    ///
    /// In 2,000 delivery missions (climb, cruise, descend, wait, return) half of all places are more than 101 m from
    /// the legs at that time. Such plans find 8 % of the conflicts within 8 m that the legs have, and one false
    /// conflict for every two of the legs'. (`cargo test --test missions -- --nocapture`)
    ///
    /// | you have | use |
    /// |---|---|
    /// | legs that are flown straight | [`from_waypoints`](Self::from_waypoints) |
    /// | velocities, too | [`from_states`](Self::from_states) |
    /// | a start or a stop at rest; coordinates that must not overshoot | [`from_positions_with`](Self::from_positions_with) |
    ///
    /// ```
    /// use nearmiss::Trajectory;
    /// use nearmiss::glam::DVec3;
    ///
    /// // 1000 m in 100 s, then a stop of 20 s.
    /// let end = 1000.0 * DVec3::X;
    /// let places = [(0.0, DVec3::ZERO), (100.0, end), (120.0, end)];
    /// let smooth = Trajectory::from_positions(&places)?;
    /// let legs = Trajectory::from_waypoints(&places)?;
    /// let apart = |t| smooth.position(t).zip(legs.position(t)).map_or(f64::NAN, |(a, b)| a.distance(b));
    /// assert!(apart(50.0) > 200.0 && apart(110.0) > 5.0);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`from_states`](Self::from_states).
    #[doc(alias("Catmull-Rom", "interpolate"))]
    pub fn from_positions<P: Copy + Into<DVec3>>(positions: &[(f64, P)]) -> Result<Self, Error> {
        Self::from_positions_with(positions, &PositionOptions::new())
    }

    /// Builds cubic Hermite segments through positions only, as [`from_positions`](Self::from_positions), with given
    /// velocities at the ends or with limited ones.
    ///
    /// A given end velocity leaves the others as they are by the rule. Limited velocities keep a body inside the box
    /// between two positions, but not on the straight line: of the missions on the page of
    /// [`from_positions`](Self::from_positions) they find 15 % of the conflicts.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{PositionOptions, Trajectory};
    ///
    /// // A lift starts from rest, and stops at the third floor without going beyond it.
    /// let heights = [(0.0, 0.0), (4.0, 9.0), (6.0, 9.0)].map(|(time, z)| (time, z * DVec3::Z));
    /// let rule = PositionOptions::new().with_first_velocity(DVec3::ZERO).with_limited_velocities();
    /// let lift = Trajectory::from_positions_with(&heights, &rule)?;
    /// assert_eq!(lift.velocity(0.0), Some(DVec3::ZERO));
    /// assert_eq!(lift.position(5.0), Some(9.0 * DVec3::Z));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`from_states`](Self::from_states).
    pub fn from_positions_with<P: Copy + Into<DVec3>>(
        positions: &[(f64, P)],
        options: &PositionOptions,
    ) -> Result<Self, Error> {
        Self::of_positions(&positions_of(positions), options)
    }

    fn of_positions(positions: &[(f64, DVec3)], options: &PositionOptions) -> Result<Self, Error> {
        let count = positions.len();
        if count < 2 {
            return Err(Error::TooFewStates { count });
        }
        check_positions(positions)?;
        let last = count - 1;
        let given = [(0, options.first_velocity), (last, options.last_velocity)];
        for (knot, velocity) in given {
            check_vector(knot, Quantity::Velocity, velocity.unwrap_or_default())?;
        }
        let chords = chords(positions);
        let mut velocities = catmull_rom(&chords);
        if options.has_limit {
            for (knot, velocity) in velocities.iter_mut().enumerate() {
                // At the ends there is one chord.
                let [arriving, leaving] =
                    [knot.saturating_sub(1), knot.min(last - 1)].map(|leg| chords[leg].1);
                *velocity = limited(*velocity, arriving, leaving);
            }
        }
        for (knot, velocity) in given {
            velocities[knot] = velocity.unwrap_or(velocities[knot]);
        }
        let mut states = Vec::with_capacity(count);
        for (knot, (&(time, position), velocity)) in positions.iter().zip(velocities).enumerate() {
            let value = velocity.abs().max_element();
            // The velocity was not given: it follows from the positions.
            if velocity.is_nan() || value > MAX_MAGNITUDE {
                return Err(Error::OutOfRange {
                    knot,
                    quantity: Quantity::Speed,
                    value: if value.is_nan() { f64::INFINITY } else { value },
                });
            }
            states.push(State::new(time, position, velocity));
        }
        Self::from_states(&states)
    }
}

/// Returns duration and mean velocity between consecutive positions (s, m/s).
fn chords(positions: &[(f64, DVec3)]) -> Vec<(f64, DVec3)> {
    let chord = |pair: &[(f64, DVec3)]| {
        let duration = pair[1].0 - pair[0].0;
        (duration, (pair[1].1 - pair[0].1) / duration)
    };
    positions.windows(2).map(chord).collect()
}

/// Returns the velocities at positions by the rule of [`Trajectory::from_positions`], m/s.
fn catmull_rom(chords: &[(f64, DVec3)]) -> Vec<DVec3> {
    let last = chords.len();
    let inner = |k: usize| {
        let ((before, arriving), (after, leaving)) = (chords[k - 1], chords[k]);
        let share = before / (before + after);
        arriving * (1.0 - share) + leaving * share
    };
    let velocity = |k: usize| match k {
        _ if last == 1 => chords[0].1,
        0 => 2.0 * chords[0].1 - inner(1),
        _ if k == last => 2.0 * chords[last - 1].1 - inner(last - 1),
        _ => inner(k),
    };
    (0..=last).map(velocity).collect()
}

/// Returns a velocity whose components keep coordinates from overshooting between positions with these mean
/// velocities before and after.
fn limited(velocity: DVec3, arriving: DVec3, leaving: DVec3) -> DVec3 {
    let component = |axis: usize| {
        let (before, after) = (arriving[axis], leaving[axis]);
        let turns_back = before.signum() * after.signum() < 0.0;
        let most = if turns_back {
            0.0
        } else {
            3.0 * before.abs().min(after.abs())
        };
        // Towards the next position, or not at all.
        let along = if before < 0.0 || after < 0.0 {
            -1.0
        } else {
            1.0
        };
        along * (along * velocity[axis]).clamp(0.0, most)
    };
    DVec3::from_array([0, 1, 2].map(component))
}
