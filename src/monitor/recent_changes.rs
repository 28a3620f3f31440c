//! Boxes of bodies that have changed since the last tick. The boxes of slices are out of date for them. A question
//! between ticks ([`Monitor::what_if`](crate::Monitor::what_if)) compares a plan with these boxes instead.

use super::bodies::BodyTable;
use super::slice::NearBody;
use crate::broad_phase::BodyBox;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use std::sync::{Mutex, PoisonError};

/// Bodies that have changed since the last tick, with boxes for questions.
#[derive(Debug, Default)]
pub(super) struct RecentChanges {
    /// Slots, one for each change.
    slots: Vec<u32>,
    /// Formed when they are asked for.
    boxes: Mutex<RecentBoxes>,
}

#[derive(Debug, Default)]
struct RecentBoxes {
    /// Number of slots that have been boxed. A body that has changed again has several boxes.
    boxed: usize,
    listed: Vec<BodyBox>,
}

impl RecentChanges {
    /// Notes a change of a body.
    pub(super) fn push(&mut self, slot: u32) {
        self.slots.push(slot);
    }

    /// Returns the number of changes.
    pub(super) const fn len(&self) -> usize {
        self.slots.len()
    }

    /// Forgets all changes but one of each of some bodies.
    pub(super) fn reset(&mut self, slots: &[u32]) {
        self.slots.clear();
        self.slots.extend_from_slice(slots);
        let boxes = self.boxes.get_mut();
        let boxes = boxes.unwrap_or_else(PoisonError::into_inner);
        boxes.boxed = 0;
        boxes.listed.clear();
    }

    /// Appends the bodies whose boxes over a window (s) meet one of the same window. Between two ticks, all questions are
    /// about the same window.
    pub(super) fn meeting(
        &self,
        bodies: &BodyTable<'_>,
        (from, to): (f64, f64),
        own: &Aabb,
        neighbours: &mut Vec<NearBody>,
    ) {
        let mut boxes = self.boxes.lock().unwrap_or_else(PoisonError::into_inner);
        let RecentBoxes { boxed, listed } = &mut *boxes;
        let slots = self.slots[*boxed..].iter().copied();
        bodies.boxes(slots, &[from, to], &mut |_, boxed, _| {
            listed.push(boxed);
        });
        *boxed = self.slots.len();
        let met = listed.iter().filter(|other| own.intersects(&other.aabb));
        let throughout = |slot| NearBody { slot, from, to };
        neighbours.extend(met.map(|other| throughout(other.body)));
    }
}
