//! The places of bodies that teleport in a slice.

use crate::bounds::{FatLine, MAX_PLACES};
use crate::count::short;
use arrayvec::ArrayVec;
use parry3d::bounding_volume::Aabb;

/// The bounds of a body at each of its places before and after it teleports.
pub(super) type PlaceBounds = ArrayVec<(FatLine, Aabb), MAX_PLACES>;

/// The bounds of the bodies that teleport in a slice, by slot.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    /// One more than the number of a list; 0 for a body that does not teleport. Slots beyond the end have none.
    numbers: Vec<u32>,
    lists: Vec<PlaceBounds>,
    /// Numbers of unused lists.
    unused: Vec<u32>,
}

impl Places {
    pub(super) fn clear(&mut self) {
        self.numbers.clear();
        self.lists.clear();
        self.unused.clear();
    }

    /// Returns the bounds of the body in a slot, if it teleports.
    pub(super) fn of(&self, slot: u32) -> Option<&PlaceBounds> {
        let number = self.numbers.get(slot as usize)?.checked_sub(1)?;
        self.lists.get(number as usize)
    }

    /// Replaces the bounds of the body in a slot; empty ones if it does not teleport.
    pub(super) fn set(&mut self, slot: u32, bounds: PlaceBounds) {
        let slot = slot as usize;
        if self.numbers.len() <= slot {
            if bounds.is_empty() {
                return;
            }
            self.numbers.resize(slot + 1, 0);
        }
        let number = &mut self.numbers[slot];
        match (number.checked_sub(1), bounds.is_empty()) {
            (None, true) => {}
            (Some(used), true) => {
                self.unused.push(used);
                *number = 0;
            }
            (Some(used), false) => self.lists[used as usize] = bounds,
            (None, false) => {
                let used = self.unused.pop().unwrap_or(short(self.lists.len()));
                if used as usize == self.lists.len() {
                    self.lists.push(bounds);
                } else {
                    self.lists[used as usize] = bounds;
                }
                *number = used + 1;
            }
        }
    }
}
