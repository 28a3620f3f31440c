//! Memory that slices share, and how much of it they may take.

use super::sift::Near;
use crate::broad_phase::fill::Block;
use crate::broad_phase::{BodyBox, Sweep};
use crate::monitor::boxes::Search;
use crate::spans::Span;

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
