//! Places for bodies.

use super::entry::SceneEntry;
use crate::id::BodyId;
use crate::trajectory::{LastMotion, StraightMotion, Trajectory};

/// A place for a body: three cache lines.
#[derive(Debug, Default)]
#[repr(align(64))]
pub(crate) struct Slot {
    pub(super) entry: Option<SceneEntry>,
}

/// The generation of a slot, and whether a body is in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SlotKey {
    pub(super) generation: u32,
    pub(super) is_taken: bool,
}

impl SlotKey {
    /// Returns the id of the body in the slot of this number.
    pub(super) const fn id(&self, slot: u32) -> BodyId {
        BodyId {
            slot,
            generation: self.generation,
        }
    }
}

impl Slot {
    /// Replaces the motion of the body, if there is one: see [`Trajectory::replace_checked`].
    #[inline]
    pub(crate) fn replace_checked(
        &mut self,
        (from, motion, since): (f64, &StraightMotion, f64),
    ) -> Option<(&Trajectory, LastMotion)> {
        // It has no summary that could be out of date: it follows straight motions.
        let trajectory = &mut self.entry.as_mut()?.body.trajectory;
        let last = trajectory.replace_checked(from, motion, since);
        Some((trajectory, last))
    }

    /// Prefetches what the body's motion has beside the first cache line of the record.
    pub(crate) fn prefetch_motion(&self) {
        if let Some(entry) = &self.entry {
            entry.body.trajectory.prefetch();
        }
    }
}
