//! Sets of slots.

/// Slots, each once, in the order in which they were added.
#[derive(Clone, Debug, Default)]
pub(super) struct SlotSet {
    list: Vec<u32>,
    is_in: Vec<bool>,
}

impl SlotSet {
    /// Adds a slot, if it is not there.
    pub(super) fn insert(&mut self, slot: u32) {
        let place = slot as usize;
        if self.is_in.len() <= place {
            self.is_in.resize(place + 1, false);
        }
        if !std::mem::replace(&mut self.is_in[place], true) {
            self.list.push(slot);
        }
    }

    pub(super) fn has(&self, slot: u32) -> bool {
        self.is_in.get(slot as usize) == Some(&true)
    }

    pub(super) const fn slots(&self) -> &[u32] {
        self.list.as_slice()
    }

    pub(super) fn clear(&mut self) {
        for slot in self.list.drain(..) {
            self.is_in[slot as usize] = false;
        }
    }
}
