//! States of many bodies, told in one call.

use crate::id::BodyId;
use crate::orientation::ToldSpin;
use crate::trajectory::StraightMotion;

/// The states of one call of [`Scene::update`](crate::Scene::update). Their memory is reused.
#[derive(Debug, Default)]
pub(super) struct ToldStates {
    pub(super) motions: Vec<(BodyId, StraightMotion)>,
    /// Spins, in the order of the motions, and the place of each one's motion there.
    pub(super) spins: Vec<(usize, ToldSpin)>,
    /// Place in `motions` of the last one of each slot, valid for those told in this call once it was
    /// [found](Self::find_last).
    last_of: Vec<usize>,
}

impl ToldStates {
    pub(super) fn clear(&mut self) {
        self.motions.clear();
        self.spins.clear();
    }

    /// Drops the spins that a later state of the same body replaces, also one without a spin, once the last ones were
    /// [found](Self::find_last).
    pub(super) fn keep_last_spins(&mut self) {
        let (motions, last_of) = (&self.motions, &self.last_of);
        self.spins
            .retain(|(place, _)| last_of[motions[*place].0.slot as usize] == *place);
    }

    /// Finds the last motion of each slot.
    pub(super) fn find_last(&mut self) {
        for (place, (id, _)) in self.motions.iter().enumerate() {
            let slot = id.slot as usize;
            if self.last_of.len() <= slot {
                self.last_of.resize(slot + 1, 0);
            }
            self.last_of[slot] = place;
        }
    }

    /// Returns the motion that the body in a slot was told last, once they were [found](Self::find_last).
    pub(super) fn last(&self, slot: usize) -> Option<&StraightMotion> {
        let (id, motion) = self.motions.get(*self.last_of.get(slot)?)?;
        (id.slot as usize == slot).then_some(motion)
    }
}
