//! Spins that are told each frame: a body follows them without new memory.

use super::Orientation;
use super::arc::Arc;
use super::given::{GivenRotation, spin_arc};
use super::piece::RotationPiece;
use super::turning::{OrientationPart, Turning};
use crate::error::Error;
use crate::rounding::without_negative_zero;
use crate::simd::prefetch;
use glam::{DQuat, DVec3};

/// A checked spin: a rotation at an instant, and a constant angular velocity. See [`Orientation::spin`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ToldSpin {
    time: f64,
    rotation: DQuat,
    angular_velocity: DVec3,
    arc: Arc,
}

impl ToldSpin {
    /// Returns the spin with a rotation and an angular velocity (rad/s) at `time` (s).
    ///
    /// # Errors
    ///
    /// As [`Orientation::spin`].
    pub(crate) fn new(time: f64, rotation: DQuat, angular_velocity: DVec3) -> Result<Self, Error> {
        Ok(Self {
            time,
            rotation,
            angular_velocity,
            arc: spin_arc(time, rotation, angular_velocity)?,
        })
    }

    const fn given(&self) -> GivenRotation {
        GivenRotation::Spin {
            time: self.time,
            rotation: self.rotation,
            angular_velocity: self.angular_velocity,
        }
    }
}

impl Orientation {
    /// Lets the body follow a spin from a finite instant `from` (s) on. What ends before `since` (s)
    /// is forgotten. Returns true if that changes the orientation.
    ///
    /// # Errors
    ///
    /// As [`followed_by`](Self::followed_by).
    pub(crate) fn follow_spin(
        &mut self,
        spin: &ToldSpin,
        from: f64,
        since: f64,
    ) -> Result<bool, Error> {
        let turning = self
            .turning
            .get_or_insert_with(|| Box::new(Turning::fixed()));
        turning.follow_spin(spin, without_negative_zero(from), since)
    }

    /// Replaces the whole orientation by a spin. The tolerance, if there is one, stays.
    pub(crate) fn set_spin(&mut self, spin: &ToldSpin) {
        let turning = self
            .turning
            .get_or_insert_with(|| Box::new(Turning::fixed()));
        turning.parts.clear();
        turning.pieces.clear();
        turning.append_spin(spin, None);
    }
}

impl Turning {
    /// Prefetches the parts and pieces that following a spin changes.
    pub(crate) fn prefetch_parts(&self) {
        /// The one that is left, and two before it.
        const USUAL: usize = 3;
        prefetch(&self.parts[..self.parts.len().min(USUAL)]);
        prefetch(&self.pieces[..self.pieces.len().min(USUAL)]);
    }

    /// Does the work of [`Orientation::follow_spin`].
    fn follow_spin(&mut self, spin: &ToldSpin, from: f64, since: f64) -> Result<bool, Error> {
        let is_followed = self.goes_on_as(&spin.given(), from);
        let before = self.parts.len();
        self.keep(if is_followed { f64::INFINITY } else { from }, since)?;
        let kept = self.parts.len();
        if !is_followed {
            self.append_spin(spin, (kept > 0).then_some(from));
        }
        Ok(!is_followed || kept < before)
    }

    /// Appends a spin from an instant (s) on, or from the beginning of time.
    fn append_spin(&mut self, spin: &ToldSpin, from: Option<f64>) {
        let mut piece = RotationPiece::forever(spin.arc, self.tolerances());
        piece.start = from.unwrap_or(f64::NEG_INFINITY);
        self.pieces.push(piece);
        let given = spin.given();
        self.parts.push(OrientationPart { from, given });
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn vector(rng: &mut ChaCha8Rng) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| rng.random_range(-2.0..2.0)))
    }

    /// Formats the parts, cuts and cubics of an orientation.
    fn all_of(orientation: &Orientation) -> String {
        format!("{orientation:?}")
    }

    /// Spins in time order and not, told again, for the past, with all or nothing forgotten, after
    /// orientations of all kinds: in place they lead to what replacing leads to.
    #[test]
    fn spins_are_followed_in_place() {
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let rng = &mut rng;
        let (mut in_place, mut unchanged) = (0, 0);
        for round in 0..400 {
            let turn = [0.0, 1.0, 2.5].map(|time| (time, DQuat::from_scaled_axis(vector(rng))));
            let mut orientation = match round % 4 {
                0 => Orientation::FIXED,
                1 => Orientation::slerp(&turn).unwrap(),
                2 => Orientation::normalized_cubic(&turn).unwrap(),
                _ => {
                    let spin = Orientation::spin(0.5, turn[1].1, vector(rng)).unwrap();
                    spin.with_tolerance(1e-4).unwrap()
                }
            };
            let (mut from, mut last) = (0.0, None);
            for _ in 0..12 {
                from += [0.0, -0.0, 0.3, 0.3, 1.0, -0.8][rng.random_range(0..6)];
                let since = from - [0.0, 0.1, 0.5, 9.0, -1.0][rng.random_range(0..5)];
                let time = from - [0.0, 0.01][rng.random_range(0..2)];
                let told = (time, DQuat::from_scaled_axis(vector(rng)), vector(rng));
                let again = last.filter(|_| rng.random_ratio(1, 3));
                let (time, rotation, velocity) = again.unwrap_or(told);
                last = Some((time, rotation, velocity));
                let next = Orientation::spin(time, rotation, velocity).unwrap();
                let expected = orientation.followed_by(&next, from, since).unwrap();
                let is_change = orientation != expected;
                let turning = orientation.turning.as_ref();
                let is_in_place =
                    |one: &Turning| one.parts.iter().all(|part| part.given.is_one_piece());
                in_place += usize::from(turning.is_some_and(|one| is_in_place(one)));
                let spin = ToldSpin::new(time, rotation, velocity).unwrap();
                let mut replaced = orientation.clone();
                replaced.set_spin(&spin);
                let tolerance = orientation.turning().and_then(|one| one.tolerance);
                let whole = next
                    .clone()
                    .into_turning()
                    .with_tolerance(tolerance)
                    .map(Orientation::of_turning)
                    .unwrap();
                assert_eq!(all_of(&replaced), all_of(&whole));
                let changed = orientation.follow_spin(&spin, from, since).unwrap();
                assert_eq!(all_of(&orientation), all_of(&expected));
                assert_eq!(changed, is_change, "{orientation:?}");
                unchanged += usize::from(!changed);
            }
        }
        assert!(
            in_place > 2_000 && unchanged > 100,
            "{in_place} {unchanged}"
        );
    }
}
