//! Straight motion through a state.

use super::segment::Segment;
use super::state::State;
use crate::error::{Error, MAX_MAGNITUDE};
use crate::rounding::without_negative_zero;
use glam::DVec3;

/// Straight motion through a state, in both directions of time. Its cubic is formed from this when it is needed.
///
/// Four numbers are read at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StraightMotion {
    /// The position, m, and the end of the motion's cubic, s: the duration from the state's time on is the unit of the
    /// cubic's parameter.
    origin: [f64; 4],
    /// The velocity, m/s, and the time of the state, s. (Not the end, which is as far as numbers go where bodies rest:
    /// the fourth number is multiplied as well.)
    velocity: [f64; 4],
}

impl StraightMotion {
    pub(super) const NONE: Self = Self::until(DVec3::ZERO, DVec3::ZERO, [0.0, 1.0]);

    /// Returns the motion from a position (m) with a velocity (m/s), between two instants (s).
    const fn until(position: DVec3, velocity: DVec3, [start, end]: [f64; 2]) -> Self {
        Self {
            origin: [position.x, position.y, position.z, end],
            velocity: [velocity.x, velocity.y, velocity.z, start],
        }
    }

    /// Returns the motion through a state whose cubic was made by [`Segment::line`] without an error of its own.
    pub(super) const fn new(state: &State, line: &Segment) -> Self {
        Self::until(state.position, state.velocity, [line.start(), line.end()])
    }

    /// Returns the motion through a state that was checked.
    ///
    /// # Errors
    ///
    /// As [`Segment::line`].
    pub(super) fn through(state: &State) -> Result<Self, Error> {
        Ok(Self::new(state, &Self::line(state)?))
    }

    /// Returns the cubic of the motion through a state that was checked.
    ///
    /// # Errors
    ///
    /// As [`Segment::line`].
    fn line(state: &State) -> Result<Segment, Error> {
        let duration = if state.velocity == DVec3::ZERO {
            MAX_MAGNITUDE
        } else {
            Self::DURATION
        };
        Segment::line(state, duration, 0.0, 0)
    }

    /// Returns true if the numbers of a state are finite and far below the limits.
    #[inline(always)]
    pub(crate) fn is_ordinary(state: &State) -> bool {
        /// Time up to which neighbouring f64 instants are far closer than 6 s, s.
        const LATEST: f64 = (1_u64 << 40) as f64;
        /// m, m/s.
        const FAR: f64 = 1e200;
        let is_ordinary =
            |vector: DVec3| vector.x.abs() <= FAR && vector.y.abs() <= FAR && vector.z.abs() <= FAR;
        state.time.abs() <= LATEST && is_ordinary(state.position) && is_ordinary(state.velocity)
    }

    /// Returns the motion through an [ordinary](Self::is_ordinary) state, without forming its cubic.
    #[inline(always)]
    pub(crate) fn through_ordinary(state: &State) -> Self {
        let end = if state.velocity == DVec3::ZERO {
            Self::END_OF_REST
        } else {
            state.time + Self::DURATION
        };
        let ends = [state.time, end].map(without_negative_zero);
        Self::until(state.position, state.velocity, ends)
    }

    /// Duration of the cubic of a motion that leaves its position, s. It spans many lookaheads, so that one or two pieces
    /// suffice. A longer one would make boxes worse: f32 resolves the distance covered in that time. A body at rest
    /// has one that lasts as long as times go, so that none of its conflicts is solved anew with a further piece.
    pub(super) const DURATION: f64 = 6.0;

    /// End of the cubic of a body at rest, s, for all times of [ordinary](Self::is_ordinary) states: three times the largest
    /// power of two that is at most a third of 1e300.
    const END_OF_REST: f64 = 3.0 * f64::from_bits((1023 + 994) << 52);

    /// Returns true if the motion can certainly be followed between two instants (s): all numbers are far below
    /// the limits of [`Segment::check_followable`].
    #[inline]
    pub(super) fn is_near(&self, from: f64, to: f64) -> bool {
        const LONG: f64 = 1e12;
        const FAST: f64 = 1e200;
        let is_slow = self.velocity().abs().cmple(DVec3::splat(FAST)).all();
        let (start, long) = (self.start(), LONG * self.duration().min(1.0));
        is_slow && (from - start).abs() <= long && (to - start).abs() <= long && start.abs() <= FAST
    }

    /// Checks that the motion can be followed between two instants (s) beyond knot number `knot`.
    ///
    /// # Errors
    ///
    /// As [`Segment::check_followable`].
    pub(super) fn check_followable(
        &self,
        (from, to): (f64, f64),
        knot: usize,
    ) -> Result<(), Error> {
        if self.is_near(from, to) {
            return Ok(());
        }
        self.segment().check_followable((from, to), knot)
    }

    /// Returns the motion whose cubic this is, if there is one.
    pub(super) fn of(line: &Segment) -> Option<Self> {
        let state = State {
            time: line.start(),
            position: line.origin(),
            velocity: line.straight_velocity(),
        };
        let motion = Self::new(&state, line);
        (motion.segment() == *line).then_some(motion)
    }

    /// Returns true if another motion is this very one, or rests in the same place.
    #[inline]
    pub(super) fn is_same_as(&self, other: &Self) -> bool {
        let is_still = !self.moves() && !other.moves();
        (is_still && self.origin() == other.origin()) || self == other
    }

    /// Returns true if the motion leaves its position.
    #[inline]
    pub(super) fn moves(&self) -> bool {
        self.velocity() != DVec3::ZERO
    }

    /// Returns the cubic.
    #[inline]
    pub(crate) fn segment(&self) -> Segment {
        let state = State {
            time: self.start(),
            position: self.origin(),
            velocity: self.velocity(),
        };
        Segment::through(&state, self.origin[3], 0.0)
    }

    /// Returns the time of the state, s.
    pub(crate) const fn start(&self) -> f64 {
        self.velocity[3]
    }

    pub(super) const fn start_ref(&self) -> &f64 {
        &self.velocity[3]
    }

    /// Returns the duration of the cubic, s.
    pub(crate) fn duration(&self) -> f64 {
        self.origin[3] - self.velocity[3]
    }

    /// Returns the position at the time of the state, m.
    pub(crate) const fn origin(&self) -> DVec3 {
        let [x, y, z, _] = self.origin;
        DVec3::new(x, y, z)
    }

    /// Returns the velocity, m/s.
    pub(crate) const fn velocity(&self) -> DVec3 {
        let [x, y, z, _] = self.velocity;
        DVec3::new(x, y, z)
    }

    /// Returns the position at the time of the state (m) and the velocity (m/s), each followed by any finite number.
    #[inline(always)]
    pub(crate) const fn numbers(&self) -> [[f64; 4]; 2] {
        [self.origin, self.velocity]
    }

    /// Returns the displacement from the origin to the position at an instant (s), m. Each coordinate has
    /// two roundings.
    #[inline(always)]
    pub(crate) fn displacement_to(&self, time: f64) -> DVec3 {
        self.velocity() * (time - self.start())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Returns a number of any size, to beyond the limits.
    fn number(rng: &mut ChaCha8Rng) -> f64 {
        let size = 10_f64.powf(rng.random_range(-330.0..330.0));
        match rng.random_range(0..8) {
            0 => f64::NAN,
            1 => -0.0,
            2 => 1.0 - 2.0 * rng.random::<f64>(),
            _ => size * (1.0 - 2.0 * rng.random::<f64>()),
        }
    }

    #[test]
    fn the_short_ways_agree_with_the_long_ones() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (mut ordinary, mut rests, mut near, mut same) = (0, 0, 0, 0);
        for round in 0..200_000 {
            let mut vector = || DVec3::from_array([0; 3].map(|_| number(&mut rng)));
            let (position, velocity) = (vector(), vector());
            let time = number(&mut rng) * [1.0, 1e12][round % 2];
            let state = State::new(time, position, velocity);
            let is_usable = time.is_finite() && position.is_finite() && velocity.is_finite();
            let slow = StraightMotion::through(&state);
            if StraightMotion::is_ordinary(&state) {
                let fast = StraightMotion::through_ordinary(&state);
                ordinary += 1;
                rests += usize::from(!fast.moves());
                assert!(is_usable, "{state:?}");
                assert_eq!(slow.as_ref().ok(), Some(&fast), "{state:?}");
            }
            let Some(motion) = slow.ok().filter(|_| is_usable) else {
                continue;
            };
            let Ok(line) = StraightMotion::line(&state) else {
                unreachable!("it is the same")
            };
            // Bit for bit, also the signs of zeros.
            assert_eq!(format!("{:?}", motion.segment()), format!("{line:?}"));
            same += usize::from(StraightMotion::of(&line) == Some(motion));
            let [from, to] = [0; 2].map(|_| time + number(&mut rng));
            if motion.is_near(from, to) {
                near += 1;
                assert!(
                    line.check_followable((from, to), 0).is_ok(),
                    "{state:?} {from} {to}"
                );
            }
        }
        assert!(
            ordinary > 2_000 && rests > 20 && near > 500 && same > 5_000,
            "{ordinary} {rests} {near} {same}"
        );
    }
}
