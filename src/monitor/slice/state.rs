//! The state of a slice of the lookahead.

use crate::bounds::FatLine;
use crate::broad_phase::{BodyBox, Candidate, Sweep};
use crate::monitor::bodies::{BodyTable, ChangedBounds};
use crate::monitor::boxes::{BoxTree, TreeSearch};
use crate::pool::Pool;
use crate::search::{CandidateRefiner, Limits, SliceBlock};
use crate::spans::SpanKey;
use crate::stats::Stats;
use std::sync::OnceLock;

/// A slice of the lookahead.
#[derive(Clone, Debug, Default)]
pub(in crate::monitor) struct LookaheadSlice {
    /// Place on the monitor's grid of time.
    pub(in crate::monitor) number: i64,
    pub(super) interval: (f64, f64),
    pub(super) index: BoxIndex,
    /// Boxes for questions about a slice that has no boxes yet.
    pub(super) query_index: OnceLock<BoxIndex>,
    pub(super) stage: BuildStage,
    /// Share of the slice that is to be compared now, 0 to 1: all of it if it is needed.
    pub(super) due: f64,
    /// Bodies that changed since they were boxed.
    pub(super) changed: Vec<u32>,
    pub(super) is_changed: Vec<bool>,
    /// Boxes, until all are there.
    pub(super) boxed: Vec<BodyBox>,
    pub(super) candidates: Vec<Candidate>,
    /// Candidates before this one have been looked at.
    pub(super) refined: usize,
    /// Spans that were found and not taken yet.
    pub(in crate::monitor) survivors: Vec<SpanKey>,
    /// Instant from which on all bodies are to be searched from nothing, s: boxes of the whole slice overlap
    /// too many others.
    pub(super) unsearched_from: Option<f64>,
    /// True if the slice was given up for lack of room.
    pub(super) is_crowded: bool,
    /// Set while no work is done before the slice is needed.
    pub(super) is_put_off: bool,
    pub(in crate::monitor) stats: Stats,
}

/// Boxes and fat lines of the bodies in a slice.
#[derive(Clone, Debug, Default)]
pub(super) struct BoxIndex {
    pub(super) boxes: BoxTree,
    /// Fat lines by slot: nearer to the body than its box, as long as it has one.
    pub(super) fat_lines: Vec<FatLine>,
}

/// Memory that one thread reuses from slice to slice.
#[derive(Debug, Default)]
pub(in crate::monitor) struct SliceScratch {
    /// Boxes of some bodies.
    pub(super) listed: Vec<BodyBox>,
    /// Boxes of a plan that is asked for.
    pub(in crate::monitor) block: SliceBlock,
    pub(super) search: TreeSearch,
    pub(super) refiner: CandidateRefiner,
    /// Slots whose boxes overlap one.
    pub(super) met: Vec<u32>,
    /// Memory of searches from nothing.
    pub(super) pool: Pool<crate::search::SearchScratch>,
    pub(super) sweep: Sweep,
}

/// The bodies that a slice compares, and how.
#[derive(Debug)]
pub(in crate::monitor) struct SliceTask<'a, F> {
    pub(in crate::monitor) bodies: &'a BodyTable<'a>,
    pub(in crate::monitor) filter: &'a F,
    /// Boxes of changed bodies formed for several slices, and the slice's number among these; `None`:
    /// the slice forms its own.
    pub(in crate::monitor) moved: Option<(&'a ChangedBounds, usize)>,
    pub(in crate::monitor) limits: Limits,
}

impl<'a, F> SliceTask<'a, F> {
    /// Returns the same with another filter.
    pub(super) const fn with_filter<'b, G>(&'b self, filter: &'b G) -> SliceTask<'b, G>
    where
        'a: 'b,
    {
        SliceTask {
            bodies: self.bodies,
            filter,
            moved: self.moved,
            limits: self.limits,
        }
    }
}

/// Stage of the work on a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BuildStage {
    /// All bodies were compared with each other, but for changed ones; slots below this number have their
    /// boxes in `boxed`.
    Compared(usize),
    /// Slots below this have their boxes in `boxed`.
    Listing(usize),
    /// Slots below this have their boxes in `boxes`, in the order of the slice before.
    Placing(usize),
    /// All boxes are there. The bodies in leaves below this were compared with all others; leaves
    /// are counted in this order of the tree.
    Joining(usize, u32),
    /// All bodies were compared with each other, but for changed ones.
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
