//! Changes of the bodies whose states are given in one call.

use super::monitored_bodies::MonitoredBody;
use crate::error::Error;
use crate::id::BodyId;
use crate::scene::ToldStates;
use crate::trajectory::{StraightMotion, Trajectory};

/// Changes of the bodies of one call. Their memory is reused.
#[derive(Debug, Default)]
pub(super) struct ToldMotions {
    /// The bodies, with their motions and spins.
    pub(super) states: ToldStates,
    /// True for each body whose motion is replaced in place, from the time of the call on: most are.
    /// In a list of its own: motions are many times as long and do not change any more.
    pub(super) is_in_place: Vec<bool>,
    /// Places of the bodies whose motions are not replaced in place from the time of the call on, and how each comes to
    /// follow its motion, if that is not refused.
    pub(super) others: Vec<(usize, Result<ToldPlan, Error>)>,
    /// Places of the bodies that follow their motions already, in order.
    pub(super) unchanged: Vec<usize>,
    /// The bodies whose motions were late, and the instants from which they follow them, s.
    pub(super) late: Vec<(BodyId, f64)>,
}

impl ToldMotions {
    pub(super) fn clear(&mut self) {
        self.states.clear();
        self.is_in_place.clear();
        self.others.clear();
        self.unchanged.clear();
        self.late.clear();
    }

    /// Lists the other changes, once it is known which motions are replaced in place.
    pub(super) fn list_others(&mut self) {
        let places = self.is_in_place.iter().enumerate();
        let others = places.filter(|(_, is_replaced)| !**is_replaced);
        self.others
            .extend(others.map(|(place, _)| (place, Ok(ToldPlan::Same(0.0)))));
    }

    /// Returns the slots of the bodies whose motions are replaced in place.
    pub(super) fn slots_in_place(&self) -> impl Iterator<Item = u32> {
        let places = self.states.ids.iter().zip(&self.is_in_place);
        places.filter_map(|(id, is_replaced)| is_replaced.then_some(id.slot))
    }

    /// Returns the motion of the body in a slot, if it is replaced in place.
    pub(super) fn in_place(&self, slot: usize) -> Option<&StraightMotion> {
        let place = self.states.place(slot)?;
        self.is_in_place[place].then(|| &self.states.motions[place])
    }
}

/// The way in which a body comes to follow a straight motion.
#[derive(Debug)]
pub(super) enum ToldPlan {
    /// The body follows the motion already, at least from an instant (s) on.
    Same(f64),
    /// The body's motion is replaced in place, too, but from another instant (s) on.
    InPlace(f64),
    /// The body takes another plan, which it follows from an instant (s) on.
    Replan(f64, Box<(Trajectory, MonitoredBody)>),
}

impl ToldPlan {
    /// Returns the instant from which the body follows the motion, s.
    pub(super) const fn from(&self) -> f64 {
        match self {
            Self::Same(from) | Self::InPlace(from) | Self::Replan(from, _) => *from,
        }
    }
}
