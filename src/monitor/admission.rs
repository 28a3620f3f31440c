//! The pairs that a monitor looks at.

use super::interrupt::Interrupt;
use crate::broad_phase::{CandidateLimit, PairFilter};
use crate::scene::Scene;

/// The filter of pairs of slots, by layers and ignored pairs.
#[derive(Debug)]
pub(super) struct SlotAdmission<'s> {
    pub(super) scene: &'s Scene,
    /// The widest margin, m.
    margin: f64,
    /// True if each two bodies may be a pair.
    admits_all: bool,
    /// The filter gives up if this is requested.
    interrupt: Option<&'s Interrupt>,
}

/// The filter of pairs of slots, with a limit of candidates.
pub(super) type LimitedAdmission<'s> = CandidateLimit<'s, SlotAdmission<'s>>;

impl<'s> SlotAdmission<'s> {
    pub(super) fn of(scene: &'s Scene, margin: f64, interrupt: Option<&'s Interrupt>) -> Self {
        Self {
            scene,
            margin,
            admits_all: scene.admits_all(margin),
            interrupt,
        }
    }
}

impl PairFilter for SlotAdmission<'_> {
    fn admits(&self, a: u32, b: u32) -> bool {
        self.admits_all || self.scene.admits(a, b, self.margin)
    }

    fn gives_up(&self) -> bool {
        self.interrupt.is_some_and(Interrupt::is_requested)
    }
}
