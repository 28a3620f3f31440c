//! The instants that a tick works with, and what is known then.

use super::bodies::BodyTable;
use super::revision_threshold::RevisionThreshold;
use super::solved_spans::SolvedSpans;

/// The instants that a tick works with, and what is known then.
#[derive(Clone, Copy, Debug)]
pub(super) struct TickContext<'s> {
    /// The clock, s.
    pub(super) now: f64,
    /// Instant up to which clock events may be reported, s: the clock, or the end of the known time if sooner.
    pub(super) reported: f64,
    /// Instant up to which the last tick reported, s.
    pub(super) before: f64,
    /// End of the known time, s.
    pub(super) known: f64,
    pub(super) lookahead: f64,
    pub(super) revision_threshold: RevisionThreshold,
    pub(super) solved: &'s SolvedSpans,
    pub(super) bodies: BodyTable<'s>,
}
