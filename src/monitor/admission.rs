//! The pairs that a monitor looks at.

use super::interrupt::Interrupt;
use crate::broad_phase::{CandidateLimit, Groups, PairFilter};
use crate::scene::{LayerGroups, Scene};

/// The filter of pairs of slots, by layers and ignored pairs.
#[derive(Debug)]
pub(super) struct SlotAdmission<'s> {
    pub(super) scene: &'s Scene,
    /// The widest margin, m.
    margin: f64,
    /// True if each two bodies may be a pair.
    admits_all: bool,
    groups: LayerGroups,
    /// The filter gives up if this is requested.
    interrupt: Option<&'s Interrupt>,
}

/// The filter of pairs of slots, with a limit of candidates.
pub(super) type LimitedAdmission<'s> = CandidateLimit<'s, SlotAdmission<'s>>;

impl<'s> SlotAdmission<'s> {
    pub(super) fn of(scene: &'s Scene, margin: f64, interrupt: Option<&'s Interrupt>) -> Self {
        let admits_all = scene.admits_all(margin);
        Self {
            scene,
            margin,
            admits_all,
            groups: if admits_all {
                LayerGroups::ONE
            } else {
                scene.layer_groups()
            },
            interrupt,
        }
    }
}

impl PairFilter for SlotAdmission<'_> {
    fn admits(&self, a: u32, b: u32) -> bool {
        self.admits_all || self.scene.admits(a, b, self.margin)
    }

    fn groups(&self) -> Groups {
        self.groups.groups
    }

    fn group(&self, slot: u32) -> u8 {
        let layers = self.scene.layers(slot);
        layers.map_or(0, |layers| self.groups.of_layers(layers))
    }

    fn gives_up(&self) -> bool {
        self.interrupt.is_some_and(Interrupt::is_requested)
    }
}
