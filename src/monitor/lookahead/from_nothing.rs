//! Searches from nothing: boxes of all bodies are formed for one search, and none is kept. Here is that of
//! the whole lookahead. (That of the time that the clock passed over is in `jump.rs`, that of one slice in
//! `slice/refine.rs`.)

use super::super::bodies::BodyTable;
use super::super::budget::TickWork;
use super::super::grid::Grid;
use super::super::search_from_nothing::SearchFromNothing;
use super::LookaheadSearch;
use crate::broad_phase::PairFilter;
use crate::count::as_f64;
use crate::rounding::{earliest_exact, latest_exact};
use crate::scene::Scene;
use crate::search::{LimitExceeded, Limits};
use crate::stats::Stats;

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

    /// Returns how long a search of a lookahead (first and last instant, s) from nothing takes, of plans with so many cubics
    /// in it, in times that it takes to compare all bodies with kept boxes.
    ///
    /// Measured with 10,000 and 100,000 balls, 2 and 10 s ahead, and with plans: a changed body takes as long for a kept slice
    /// as about four bodies take for a slice from nothing, or for a cubic of their plans.
    fn cost_from_nothing(&self, (from, to): (f64, f64), cubics: f64) -> f64 {
        const FROM_NOTHING: f64 = 0.25;
        const CUBIC: f64 = 1.2;
        /// Kept slices may be longer than those of a search from nothing. Then bodies are compared with more others than
        /// this tells.
        const MOST: f64 = 0.75;
        // Of two it has parts.
        let slices = (to - from) / self.grid.length + 1.0;
        let search_slices = ((to - from) / self.grid.search_length).round().max(1.0);
        (FROM_NOTHING * (search_slices + CUBIC * cubics) / slices).min(MOST)
    }

    /// Returns true if so much is to be compared that a search of a lookahead (first and last instant, s) from nothing takes
    /// less time than kept boxes: many bodies have changed, or the clock, which goes on from an instant to the beginning of
    /// its slice (s), reaches a large share of a slice, in which all bodies are new.
    fn is_cheaper_from_nothing(
        &self,
        scene: &Scene,
        lookahead: (f64, f64),
        (from, clock_slice): (f64, f64),
    ) -> bool {
        let (changed, all) = (self.changed.slots().len(), self.monitored.bodies());
        let step = (lookahead.0 - from) / (lookahead.1 - lookahead.0 + self.grid.length);
        let is_new = self.is_jump((self.laid_until(from), clock_slice));
        let new = as_f64(all) * if is_new { 1.0 } else { step };
        let is_more = |cubics: f64| {
            as_f64(changed) + new > self.cost_from_nothing(lookahead, cubics) * as_f64(all)
        };
        is_more(0.0) && is_more(scene.cubics_of_a_plan(lookahead))
    }

    /// Returns a search on a grid that knows nothing, and goes on as this one would.
    pub(in crate::monitor) fn anew(&self, grid: Grid) -> Self {
        Self {
            since_unknown: self.since_unknown,
            affordable: self.affordable,
            ..self.emptied(grid)
        }
    }

    /// Returns true if most was unknown so few ticks before that boxes of all bodies would not have paid: forming them takes
    /// longer than it would to search the lookahead (first and last instant, s) from nothing in all these ticks.
    fn was_unknown(&self, scene: &Scene, lookahead: (f64, f64)) -> bool {
        /// Time in which the boxes of all bodies are formed, sorted and compared, in times that it takes to compare all
        /// bodies with kept ones. (Measured with 10,000 balls, 2 s ahead.)
        const FORM: f64 = 2.0;
        self.since_unknown.is_some_and(|ticks| {
            ticks <= 0.0 || {
                let cubics = scene.cubics_of_a_plan(lookahead);
                ticks * self.cost_from_nothing(lookahead, cubics) < FORM
            }
        })
    }

    /// Returns true if something has changed, and no slice that begins before an instant (s) has boxes to compare it with.
    fn has_no_boxes(&self, to: f64) -> bool {
        let mut slices = self.slices.iter();
        let has_boxes = slices.any(|slice| slice.is_placed() && slice.interval.0 <= to);
        !(self.changed.slots().is_empty() || has_boxes)
    }

    /// Returns true if a lookahead (first and last instant, s) is to be searched from nothing: [it is
    /// cheaper](Self::is_cheaper_from_nothing), or [there are no boxes](Self::has_no_boxes) and the budget suffices for all
    /// of it; and [most was unknown](Self::was_unknown) a few ticks before. (All is unknown at the first tick of a monitor.
    /// That tick forms the boxes of slices.)
    pub(super) fn is_unknown_again(
        &mut self,
        scene: &Scene,
        lookahead: (f64, f64),
        clock: (f64, f64),
        work: &TickWork<'_>,
    ) -> bool {
        /// Ticks that a tick before which nothing changed counts as: only new time is searched in it, and boxes would save
        /// little.
        const IDLE: f64 = 1.0 / 16.0;
        let is_from_nothing = self.is_cheaper_from_nothing(scene, lookahead, clock);
        let is_all_affordable = !work.meter.has_limit() || self.affordable.is_all();
        let is_unknown = is_from_nothing || is_all_affordable && self.has_no_boxes(lookahead.1);
        let is_again = is_unknown && self.was_unknown(scene, lookahead);
        let tick = if self.changed.slots().is_empty() {
            IDLE
        } else {
            1.0
        };
        self.since_unknown = if is_from_nothing {
            Some(0.0)
        } else {
            self.since_unknown.map(|ticks| ticks + tick)
        };
        is_again
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
        let window = self.window_of(lookahead);
        let search = SearchFromNothing {
            limits: self.limits(),
            table: BodyTable::of(admission.scene, &self.monitored, &self.grid),
            pool: &self.search_pool,
            threads: meter.threads(),
        };
        let mut counted = Stats::default();
        let found = (&mut self.survivors, &mut counted);
        search.list_spans(window, None, admission, found)?;
        if admission.gives_up() {
            return Ok(());
        }
        // The slices of the lookahead are counted.
        counted.slices = 0;
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
