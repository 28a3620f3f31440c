//! The pairs that a monitor looks at.

use super::interrupt::Interrupt;
use crate::broad_phase::{CandidateLimit, Groups, PairFilter};
use crate::scene::{PairAdmission, Scene};

/// The filter of pairs of slots, by layers and ignored pairs.
#[derive(Debug)]
pub(super) struct SlotAdmission<'s> {
    pub(super) pairs: PairAdmission<'s>,
    /// The filter gives up if this is requested.
    interrupt: Option<&'s Interrupt>,
}

/// The filter of pairs of slots, with a limit of candidates.
pub(super) type LimitedAdmission<'s> = CandidateLimit<'s, SlotAdmission<'s>>;

impl<'s> SlotAdmission<'s> {
    /// Returns the filter of pairs within the widest margin, m.
    pub(super) fn of(scene: &'s Scene, margin: f64, interrupt: Option<&'s Interrupt>) -> Self {
        Self {
            pairs: PairAdmission::of(scene, margin),
            interrupt,
        }
    }
}

impl PairFilter for SlotAdmission<'_> {
    fn admits(&self, a: u32, b: u32) -> bool {
        self.pairs.admits(a, b)
    }

    fn admits_all(&self) -> bool {
        self.pairs.admits_all()
    }

    fn groups(&self) -> Groups {
        self.pairs.groups()
    }

    fn group(&self, slot: u32) -> u8 {
        self.pairs.group(slot)
    }

    fn gives_up(&self) -> bool {
        self.interrupt.is_some_and(Interrupt::is_requested)
    }
}
