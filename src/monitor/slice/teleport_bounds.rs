//! The bounds of bodies that teleport in a slice.

use crate::bounds::{FatLine, MAX_PLACES};
use crate::count::short;
use arrayvec::ArrayVec;
use parry3d::bounding_volume::Aabb;

/// The bounds of a body that teleports, at each of its places.
pub(super) type PlaceBounds = ArrayVec<(FatLine, Aabb), MAX_PLACES>;

/// The bounds of the bodies that teleport in a slice, by slot.
#[derive(Clone, Debug, Default)]
pub(super) struct TeleportBounds {
    /// One more than the number of a list; 0 for a body that does not teleport. Slots beyond the end have none.
    numbers: Vec<u32>,
    lists: Vec<PlaceBounds>,
    /// Numbers of unused lists.
    unused: Vec<u32>,
}

impl TeleportBounds {
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

    /// Removes the bounds of the body in a slot: it does not teleport.
    pub(super) fn remove(&mut self, slot: u32) {
        let number = self.numbers.get_mut(slot as usize).map(std::mem::take);
        self.unused
            .extend(number.and_then(|number| number.checked_sub(1)));
    }

    /// Replaces the bounds of the body in a slot, which teleports.
    pub(super) fn set(&mut self, slot: u32, bounds: PlaceBounds) {
        self.remove(slot);
        let slot = slot as usize;
        if self.numbers.len() <= slot {
            self.numbers.resize(slot + 1, 0);
        }
        let number = match self.unused.pop() {
            Some(number) => {
                self.lists[number as usize] = bounds;
                number
            }
            None => {
                self.lists.push(bounds);
                short(self.lists.len() - 1)
            }
        };
        self.numbers[slot] = number + 1;
    }
}
