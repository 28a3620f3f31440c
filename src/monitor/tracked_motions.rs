//! Changes of the bodies whose states are given in one call.

use super::monitored_bodies::MonitoredBody;
use crate::error::Error;
use crate::id::BodyId;
use crate::orientation::TrackedSpin;
use crate::scene::BodyState;
use crate::trajectory::{StraightMotion, Trajectory};

/// Changes of the bodies of one call. Their memory is reused.
#[derive(Debug, Default)]
pub(super) struct TrackedMotions {
    /// One for each body.
    pub(super) motions: Vec<TrackedMotion>,
    /// Spins of some of them.
    pub(super) spins: Vec<TrackedSpin>,
    /// By slot: the place of its motion in `motions`, if that is of this slot.
    place_of: Vec<usize>,
}

impl TrackedMotions {
    /// Takes a motion in. It replaces that of the same body, if there is one.
    pub(super) fn put(&mut self, motion: TrackedMotion) {
        let slot = motion.id.slot as usize;
        if self.place_of.len() <= slot {
            self.place_of.resize(slot + 1, 0);
        }
        let place = &mut self.place_of[slot];
        match self.motions.get_mut(*place) {
            Some(known) if known.id == motion.id => *known = motion,
            _ => {
                *place = self.motions.len();
                self.motions.push(motion);
            }
        }
    }

    /// Takes the spin of a state in, and returns its place in the list; `None` if there is no spin.
    ///
    /// # Errors
    ///
    /// As [`Orientation::spin`](crate::Orientation::spin).
    pub(super) fn add_spin(&mut self, state: &BodyState) -> Result<Option<usize>, Error> {
        let Some(spin) = &state.spin else {
            return Ok(None);
        };
        let (time, place) = (state.state.time, self.spins.len());
        let spin = TrackedSpin::new(time, spin.rotation, spin.angular_velocity)?;
        self.spins.push(spin);
        Ok(Some(place))
    }

    /// Returns the motion of the body in a slot, if it is turned in place.
    pub(super) fn in_place(&self, slot: usize) -> Option<&TrackedMotion> {
        let motion = self.motions.get(*self.place_of.get(slot)?)?;
        let is_in_place = matches!(motion.change, TrackedChange::TurnInPlace);
        (motion.id.slot as usize == slot && is_in_place).then_some(motion)
    }
}

/// The change of one body.
#[derive(Debug)]
pub(super) struct TrackedMotion {
    pub(super) id: BodyId,
    /// From when on, s.
    pub(super) from: f64,
    /// Straight motion from then on.
    pub(super) motion: StraightMotion,
    /// The place of its spin in the list of spins, if it was given one.
    pub(super) spin: Option<usize>,
    pub(super) change: TrackedChange,
}

/// The way in which a body comes to follow a straight motion.
#[derive(Debug)]
pub(super) enum TrackedChange {
    /// None: it follows it already.
    Same,
    /// Its plan is turned.
    Turn,
    /// The few straight motions that it follows are turned in place: several threads can share that.
    TurnInPlace,
    /// The body takes another plan.
    Replan(Box<(Trajectory, MonitoredBody)>),
    /// None: it is refused.
    Refused(Box<Error>),
}
