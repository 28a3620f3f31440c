//! Searches from nothing: boxes of all bodies are formed for one search, and none is kept. Here is that of
//! the whole lookahead. (That of the time that the clock passed over is in `jump.rs`, that of one slice in
//! `slice/refine.rs`.)

use super::super::bodies::BodyTable;
use super::super::budget::TickWork;
use super::super::grid::Grid;
use super::super::prepared::PreparedBodies;
use super::affordable::FEW_TICKS;
use super::{LookaheadSearch, LookaheadSlice};
use crate::broad_phase::PairFilter;
use crate::count::{are_most, as_f64};
use crate::rounding::{earliest_exact, latest_exact};
use crate::scene::Scene;
use crate::search::{LimitExceeded, Limits};
use crate::stats::Stats;
use crate::wall_clock::Instant;

impl LookaheadSearch {
    /// Survivors for each span that there is room for: a survivor takes a fiftieth of the memory of a solved span.
    const SURVIVORS: usize = 8;

    /// Returns the limits of spans and candidates before they are solved.
    pub(super) const fn limits(&self) -> Limits {
        Limits {
            spans: self.max_spans.saturating_mul(Self::SURVIVORS),
            ..Limits::of_spans(self.max_spans)
        }
    }

    /// Returns true if so much is to be compared that a search of a lookahead (first and last instant, s) from nothing takes
    /// less time than kept boxes: many bodies have changed, or the clock, which goes on by `step` (s), reaches a large share of
    /// a slice, in which all bodies are new.
    ///
    /// Measured with 10,000 and 100,000 balls, 2 and 10 s ahead, and with plans: a changed body takes as long for a kept slice
    /// as about four bodies take for a slice from nothing, or for a cubic of their plans.
    pub(super) fn is_cheaper_from_nothing(
        &self,
        scene: &Scene,
        (from, to): (f64, f64),
        step: f64,
    ) -> bool {
        const FROM_NOTHING: f64 = 0.25;
        const CUBIC: f64 = 1.2;
        /// Kept slices may be longer than those of a search from nothing. Then bodies are compared with more others than
        /// this tells.
        const MOST: f64 = 0.75;
        // Of two it has parts.
        let slices = (to - from) / self.grid.length + 1.0;
        let search_slices = ((to - from) / self.grid.search_length).round().max(1.0);
        let (changed, all) = (self.changed.slots().len(), self.monitored.bodies());
        let new = as_f64(all) * (step / self.grid.length / slices);
        let is_more = |boxes: f64| {
            let least = (FROM_NOTHING * boxes / slices).min(MOST);
            as_f64(changed) + new > least * as_f64(all)
        };
        is_more(search_slices)
            && is_more(search_slices + CUBIC * scene.cubics_of_a_plan((from, to)))
    }

    /// Returns a search on a grid that knows nothing, and goes on as this one would.
    pub(in crate::monitor) fn anew(&self, grid: Grid) -> Self {
        Self {
            since_unknown: self.since_unknown,
            affordable: self.affordable,
            ..Self::new(grid, self.max_spans)
        }
    }

    /// Returns true if most was unknown in one of the last few ticks.
    pub(in crate::monitor) const fn was_unknown(&self) -> bool {
        self.since_unknown < FEW_TICKS
    }

    /// Notes that most was unknown in the last tick.
    pub(in crate::monitor) const fn note_unknown(&mut self) {
        self.since_unknown = 0;
    }

    /// Returns true if a lookahead is to be searched from nothing: [it is cheaper](Self::is_cheaper_from_nothing), or
    /// [most is unknown](Self::is_mostly_unknown), and so it was a few ticks before, so that kept boxes would not pay; or so
    /// it was a few ticks before, something has changed, and none of the needed slices has boxes. (All is unknown at the
    /// first tick of a monitor. That tick forms the boxes of slices.)
    pub(super) fn is_unknown_again(&mut self, is_from_nothing: bool, needed: usize) -> bool {
        let is_soon = self.was_unknown();
        if is_from_nothing || self.is_mostly_unknown(needed) {
            self.note_unknown();
            return is_soon;
        }
        self.since_unknown = self.since_unknown.saturating_add(1);
        let has_boxes = || {
            self.slices
                .iter()
                .take(needed)
                .any(LookaheadSlice::is_placed)
        };
        is_soon && !self.changed.slots().is_empty() && !has_boxes()
    }

    /// Returns true if more than three quarters of the bodies are to be compared with all others, in the
    /// mean of the slices that are needed: most slices are new.
    fn is_mostly_unknown(&self, needed: usize) -> bool {
        let (changed, all) = (self.changed.slots().len(), self.monitored.bodies());
        let slices = self.slices.iter().take(needed);
        let unknown = slices.map(|slice| slice.unknown(changed, all)).sum();
        are_most(unknown, all * needed)
    }

    /// Returns the window in which a lookahead (first and last instant, s) is searched, within the needed slices. It
    /// reaches just far enough that the last instant is [known](crate::rounding::last_known).
    fn window_of(&self, (from, to): (f64, f64)) -> (f64, f64) {
        let end = latest_exact(latest_exact(to)).next_up();
        let ends = &self.ends;
        (
            earliest_exact(from).max(ends[0]),
            end.min(ends[ends.len() - 1]),
        )
    }

    /// Searches a lookahead (first and last instant, s) from nothing. The last of the needed slices is searched as far
    /// as the lookahead goes: the next tick searches all of it, and more of the time after it.
    pub(super) fn screen(
        &mut self,
        lookahead: (f64, f64),
        needed: usize,
        work: &mut TickWork<'_>,
    ) -> Result<(), LimitExceeded> {
        let (admission, meter) = (&work.admission, &mut work.meter);
        let limits = self.limits();
        let window = self.window_of(lookahead);
        let table = BodyTable::of(admission.scene, &self.monitored, &self.grid);
        let begin = Instant::now();
        let pool = &self.search_pool;
        let (bodies, statistics) =
            PreparedBodies::in_window(table, limits, pool, (window, meter.threads()));
        let slicing = (&bodies.slices_of_search_length(window), &statistics);
        work.stats.bounds_time += begin.elapsed();
        let mut counted = Stats::default();
        let found = (&mut self.survivors, &mut counted);
        bodies.list_spans(slicing, admission, found)?;
        if admission.gives_up() {
            return Ok(());
        }
        meter.count(usize::try_from(counted.boxes + counted.candidates).unwrap_or(0));
        work.stats += counted;
        for (number, slice) in self.slices.iter_mut().enumerate() {
            if number >= needed {
                slice.note(self.changed.slots());
                continue;
            }
            slice.set_compared(window.1);
            work.stats += std::mem::take(&mut slice.stats);
        }
        Ok(())
    }
}
