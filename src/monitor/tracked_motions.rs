//! Changes of the bodies whose states are given in one call.

use super::monitored_bodies::MonitoredBody;
use crate::error::Error;
use crate::id::BodyId;
use crate::orientation::TrackedSpin;
use crate::trajectory::{StraightMotion, Trajectory};

/// Changes of the bodies of one call. Their memory is reused.
#[derive(Debug, Default)]
pub(super) struct TrackedMotions {
    /// Motions, one for each body.
    pub(super) motions: Vec<TrackedMotion>,
    /// Place in `motions` of each slot's motion, valid if that entry is of this slot.
    place_of: Vec<usize>,
    /// Spins that were given, with the place of the body's motion.
    spins: Vec<(usize, TrackedSpin)>,
    /// Changes of bodies whose motion is not turned in place, or to which a spin was given.
    pub(super) others: Vec<TrackedChange>,
}

impl TrackedMotions {
    pub(super) fn clear(&mut self) {
        self.motions.clear();
        self.spins.clear();
        self.others.clear();
    }

    /// Lists the other changes, once it is known which motions turn in place.
    pub(super) fn list_others(&mut self) {
        for (place, _) in &self.spins {
            self.motions[*place].turns_in_place = false;
        }
        self.spins.sort_unstable_by_key(|(place, _)| *place);
        let mut spins = self.spins.drain(..).peekable();
        let motions = self.motions.iter().enumerate();
        for (place, one) in motions.filter(|(_, one)| !one.turns_in_place) {
            let given = spins.next_if(|(other, _)| *other == place);
            self.others.push(TrackedChange {
                id: one.id,
                motion: one.motion,
                spin: given.map(|(_, spin)| spin),
                plan: TrackedPlan::Same,
            });
        }
    }

    /// Takes a motion in, and a spin if it was given. They replace those of the same body, if there are any.
    #[inline]
    pub(super) fn put(
        &mut self,
        (id, motion): (BodyId, StraightMotion),
        spin: Option<TrackedSpin>,
    ) {
        let slot = id.slot as usize;
        if self.place_of.len() <= slot {
            self.place_of.resize(slot + 1, 0);
        }
        let motion = TrackedMotion {
            id,
            motion,
            turns_in_place: false,
        };
        let place = &mut self.place_of[slot];
        match self.motions.get_mut(*place) {
            Some(known) if known.id == id => {
                *known = motion;
                self.spins.retain(|(other, _)| other != place);
            }
            _ => {
                *place = self.motions.len();
                self.motions.push(motion);
            }
        }
        self.spins.extend(spin.map(|spin| (*place, spin)));
    }

    /// Returns the motion of the body in a slot, if it is turned in place.
    pub(super) fn in_place(&self, slot: usize) -> Option<&TrackedMotion> {
        let motion = self.motions.get(*self.place_of.get(slot)?)?;
        (motion.id.slot as usize == slot && motion.turns_in_place).then_some(motion)
    }
}

/// The straight motion that a body is to follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrackedMotion {
    pub(super) id: BodyId,
    pub(super) motion: StraightMotion,
    /// The few straight motions that the body follows are turned in place, from the time of the call on: so it usually
    /// is.
    pub(super) turns_in_place: bool,
}

/// A change of another kind.
#[derive(Debug)]
pub(super) struct TrackedChange {
    pub(super) id: BodyId,
    pub(super) motion: StraightMotion,
    /// Spin that was given.
    pub(super) spin: Option<TrackedSpin>,
    pub(super) plan: TrackedPlan,
}

/// The way in which a body comes to follow a straight motion.
#[derive(Debug)]
pub(super) enum TrackedPlan {
    /// The body follows the motion already.
    Same,
    /// The body's plan is turned at an instant (s).
    Turn(f64),
    /// The body takes another plan.
    Replan(Box<(Trajectory, MonitoredBody)>),
    /// The motion is refused.
    Refused(Box<Error>),
}
