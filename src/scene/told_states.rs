//! States of many bodies, told in one call.

use crate::id::BodyId;
use crate::orientation::ToldSpin;
use crate::trajectory::StraightMotion;

/// The last states of bodies in one call. Their memory is reused.
#[derive(Debug, Default)]
pub(crate) struct ToldStates {
    /// The bodies, each once.
    pub(crate) ids: Vec<BodyId>,
    /// Straight motions, one for each body.
    pub(crate) motions: Vec<StraightMotion>,
    /// Spins, up to the last body of which one was given.
    pub(crate) spins: Vec<Option<ToldSpin>>,
    /// Place in these lists of each slot's body, valid if that entry is of this slot.
    place_of: Vec<usize>,
}

impl ToldStates {
    pub(crate) fn clear(&mut self) {
        self.ids.clear();
        self.motions.clear();
        self.spins.clear();
    }

    /// Takes a motion in, and a spin if it was given. They replace those of the same body, if there are any.
    #[inline]
    pub(crate) fn put(&mut self, (id, motion): (BodyId, StraightMotion), spin: Option<ToldSpin>) {
        let slot = id.slot as usize;
        if self.place_of.len() <= slot {
            self.place_of.resize(slot + 1, 0);
        }
        let mut place = self.place_of[slot];
        if self.ids.get(place) == Some(&id) {
            self.motions[place] = motion;
        } else {
            place = self.ids.len();
            self.place_of[slot] = place;
            self.ids.push(id);
            self.motions.push(motion);
        }
        if let Some(own) = self.spins.get_mut(place) {
            *own = spin;
        } else if spin.is_some() {
            self.spins.resize(place, None);
            self.spins.push(spin);
        }
    }

    /// Returns the place of the body in a slot, if it is told a state.
    pub(crate) fn place(&self, slot: usize) -> Option<usize> {
        let place = *self.place_of.get(slot)?;
        (self.ids.get(place)?.slot as usize == slot).then_some(place)
    }

    /// Returns the bodies that are told a spin.
    pub(crate) fn spins(&self) -> impl Iterator<Item = (BodyId, &ToldSpin)> {
        let spins = self.ids.iter().zip(&self.spins);
        spins.filter_map(|(id, spin)| Some((*id, spin.as_ref()?)))
    }
}
