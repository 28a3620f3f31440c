//! What is known of one slice, and how far it is.

use crate::bounds::Course;
use crate::broad_phase::{BodyBox, Candidate, Sweep};
use crate::monitor::boxes::{Boxes, Search};
use crate::search::Block;
use crate::spans::{Span, SpanKey};
use crate::stats::Stats;

/// One slice of the lookahead.
#[derive(Clone, Debug, Default)]
pub(in crate::monitor) struct Slice {
    /// Place on the monitor's grid of time.
    pub(in crate::monitor) index: i64,
    pub(super) interval: (f64, f64),
    pub(super) boxes: Boxes,
    pub(super) stage: Stage,
    /// What share of the slice is to be compared now, 0 to 1: all of it if it is needed.
    pub(super) due: f64,
    /// By slot: nearer to the body than its box, as long as it has one.
    pub(super) courses: Vec<Course>,
    /// Bodies that changed since they were boxed.
    pub(super) changed: Vec<u32>,
    pub(super) is_changed: Vec<bool>,
    /// Boxes, until all are there.
    pub(super) boxed: Vec<BodyBox>,
    pub(super) candidates: Vec<Candidate>,
    /// Candidates before this one have been looked at.
    pub(super) sifted: usize,
    /// What was found and not taken yet.
    pub(in crate::monitor) survivors: Vec<SpanKey>,
    /// Parts of its time in which pairs are still to be looked for: boxes of the whole slice meet too
    /// many others.
    pub(super) parts: Vec<Part>,
    /// There was too little room for what is in it: it was given up.
    pub(super) is_crowded: bool,
    /// Nothing is done for it before it is needed.
    pub(super) is_put_off: bool,
    pub(in crate::monitor) stats: Stats,
}

/// What one thread reuses from slice to slice.
#[derive(Debug, Default)]
pub(in crate::monitor) struct Scratch {
    /// Boxes of some bodies.
    pub(super) listed: Vec<BodyBox>,
    pub(super) block: Block,
    pub(super) search: Search,
    /// Candidates that may be near from their courses.
    pub(super) near: Vec<Near>,
    /// Spans of some of them, these by number.
    pub(super) pieces: Vec<(usize, Span)>,
    pub(super) sweep: Sweep,
}

/// What there is room for in a slice.
#[derive(Clone, Copy, Debug)]
pub(in crate::monitor) struct Limits {
    /// Candidates at a time. With more, the slice is divided.
    pub(in crate::monitor) candidates: u64,
    /// Spans that cheap tests cannot rule out, before they are solved.
    pub(in crate::monitor) survivors: usize,
}

impl Limits {
    /// 32 MiB of candidates, unless there is room for more spans.
    const CANDIDATES: u64 = 1 << 22;

    /// Survivors for each span that there is room for: they take a fiftieth of what is kept of it.
    const SURVIVORS: usize = 8;

    /// Where there is room for so many spans in all.
    pub(in crate::monitor) const fn of(spans: usize) -> Self {
        Self {
            candidates: if spans as u64 > Self::CANDIDATES {
                spans as u64
            } else {
                Self::CANDIDATES
            },
            survivors: spans.saturating_mul(Self::SURVIVORS),
        }
    }
}

/// How far a slice is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// Slots below this have their boxes in `listed`.
    Listing(usize),
    /// Slots below this have their boxes in `boxes`, in the order of the slice before.
    Placing(usize),
    /// All boxes are there. The bodies in leaves below this were compared with all others; leaves
    /// are counted in this order of the tree.
    Joining(usize, u32),
    /// All were compared with each other, but for those that have changed.
    Built,
}

impl Default for Stage {
    fn default() -> Self {
        Self::Listing(0)
    }
}

/// A part of a slice's time in which all bodies are to be compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// First and last instant, s.
    pub(super) interval: (f64, f64),
    /// Extent and volume of a mean box in the part that it is a half of, in the frame's unit.
    pub(super) mean: (f64, f64),
    /// It is compared as a whole, as long as there is room for its candidates.
    pub(super) is_whole: bool,
}

impl Part {
    /// More candidates a box cost more than the boxes of two halves, if those have few.
    const CANDIDATES_PER_BOX: u64 = 32;

    /// How many candidates there may be at a time: so many, or fewer if halves may be cheaper.
    pub(super) fn room(part: Option<&Self>, bodies: usize, most: u64) -> u64 {
        /// Fewer are not worth a division.
        const FEW: u64 = 1 << 16;
        if part.is_some_and(|part| part.is_whole) {
            most
        } else {
            (Self::CANDIDATES_PER_BOX * bodies as u64).clamp(FEW.min(most), most)
        }
    }
}

/// When two bodies may be near each other, and a cubic of each that is not later.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub(super) pair: Candidate,
    pub(super) interval: (f64, f64),
    pub(super) hints: (u32, u32),
}
