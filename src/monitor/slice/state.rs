//! The state of a slice of the lookahead.

use super::teleport_bounds::TeleportBounds;
use crate::bounds::FatLine;
use crate::broad_phase::{BodyBox, Candidate, CandidateLimit, Sweep};
use crate::monitor::bodies::{BodyTable, ChangedBounds};
use crate::monitor::boxes::{BoxTree, TreeSearch};
use crate::monitor::slot_set::SlotSet;
use crate::pool::Pool;
use crate::scene::PairAdmission;
use crate::search::{CandidateRefiner, Limits, SearchScratch, SliceBlock};
use crate::spans::SpanKey;
use crate::stats::Stats;

/// A slice of the lookahead.
#[derive(Clone, Debug, Default)]
pub(in crate::monitor) struct LookaheadSlice {
    /// Place on the monitor's grid of time.
    pub(in crate::monitor) number: i64,
    pub(in crate::monitor) interval: (f64, f64),
    pub(in crate::monitor) index: BoxIndex,
    pub(super) stage: BuildStage,
    /// Share of the work that is to be done now, 0 to 1: 1 if the slice is needed.
    pub(super) due_share: f64,
    /// Bodies that changed since they were boxed.
    pub(super) changed: SlotSet,
    /// Boxes formed so far, until the tree is built from all of them.
    pub(super) boxed: Vec<BodyBox>,
    pub(super) candidates: Vec<Candidate>,
    /// Candidates before this one have been refined to spans.
    pub(super) refined: usize,
    /// Spans that were found and not taken yet.
    pub(in crate::monitor) survivors: Vec<SpanKey>,
    /// Set if the slice is searched from nothing, in shorter slices, from this instant (s) on: because boxes of the whole
    /// slice overlap too many others, or a search from nothing ended there.
    pub(super) search_from: Option<f64>,
    /// True if the slice was given up for lack of room.
    pub(super) has_exceeded_limit: bool,
    /// True if there was too little room: then no work is done before the slice is needed.
    pub(super) is_put_off: bool,
    pub(in crate::monitor) stats: Stats,
}

/// Boxes and fat lines of the bodies in a slice.
#[derive(Clone, Debug, Default)]
pub(in crate::monitor) struct BoxIndex {
    pub(super) boxes: BoxTree,
    /// Fat lines by slot: nearer to the body than its box, as long as it has one.
    pub(super) fat_lines: Vec<FatLine>,
    pub(super) places: TeleportBounds,
}

/// Memory that one thread reuses from slice to slice.
#[derive(Debug, Default)]
pub(in crate::monitor) struct SliceScratch {
    /// Boxes of some bodies.
    pub(super) listed: Vec<BodyBox>,
    /// Boxes of a plan in question.
    pub(in crate::monitor) block: SliceBlock,
    pub(super) search: TreeSearch,
    pub(super) refiner: CandidateRefiner,
    /// Slots of boxes that overlap one, or of bodies that exist in a slice.
    pub(super) slots: Vec<u32>,
    pub(super) sweep: Sweep,
}

/// The filter of pairs of slots, with a limit of candidates.
pub(super) type LimitedAdmission<'s> = CandidateLimit<'s, PairAdmission<'s>>;

/// The bodies that a slice compares, and how.
pub(in crate::monitor) struct SliceTask<'a> {
    pub(in crate::monitor) bodies: &'a BodyTable<'a>,
    pub(in crate::monitor) filter: &'a PairAdmission<'a>,
    /// Boxes of changed bodies formed for several slices, and the slice's number among these; `None`:
    /// the slice forms its own.
    pub(in crate::monitor) moved: Option<(&'a ChangedBounds, usize)>,
    pub(in crate::monitor) limits: Limits,
    /// Memory of searches from nothing.
    pub(in crate::monitor) pool: &'a Pool<SearchScratch>,
}

/// Stage of the work on a slice: forming boxes, building their tree, comparing them.
///
/// - A slice that is needed when it begins: `Listing`, `Built`.
/// - A slice with work ahead, once the slice before has a tree: `Placing`, `Joining`, `Built`.
/// - A slice in the time of a search from nothing: `Compared`, and `Built` when bodies change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BuildStage {
    /// A search from nothing compared all bodies with each other, but for changed ones. There is no tree. Slots below
    /// this number have their boxes in `boxed`.
    Compared(usize),
    /// Nothing was compared. Slots below this number have their boxes in `boxed`.
    Listing(usize),
    /// Nothing was compared. Slots below this number have their boxes in the tree, in the order of that of the slice
    /// before.
    Placing(usize),
    /// All boxes are in the tree. The bodies in leaves below the first number were compared with all others, if the
    /// second number is still the [number of the tree's sortings](BoxTree::resort_count).
    Joining(usize, u32),
    /// All boxes are in the tree. All bodies were compared with each other, but for changed ones.
    Built,
}

impl BuildStage {
    /// Returns true if all bodies were compared with each other, but for those that have changed.
    pub(super) const fn is_compared(self) -> bool {
        matches!(self, Self::Compared(_) | Self::Built)
    }
}

impl Default for BuildStage {
    fn default() -> Self {
        Self::Listing(0)
    }
}
