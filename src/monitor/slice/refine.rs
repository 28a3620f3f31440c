//! From the candidates of a slice to spans; or, if there are too many candidates, by searches of shorter slices.

use super::state::{BoxIndex, LookaheadSlice, SliceScratch, SliceTask};
use crate::broad_phase::{Candidate, PairFilter};
use crate::monitor::search_from_nothing::SearchFromNothing;
use crate::narrow_phase::approaching;
use crate::search::RefineContext;
use crate::stats::Stats;
use crate::window::Window;

impl LookaheadSlice {
    /// Searches all bodies from nothing in the next part of the slice; returns how many boxes were formed.
    pub(super) fn search_next_part(&mut self, from: f64, task: &SliceTask<'_>) -> usize {
        /// Slices that are searched between two looks at a budget.
        const SLICES: f64 = 8.0;
        let SliceTask { bodies, filter, .. } = *task;
        // Late on the clock they may be shorter than the way to the next instant.
        let end = (from + SLICES * bodies.grid.search_length).max(from.next_up());
        let end = end.min(self.interval.1);
        let search = SearchFromNothing {
            table: *bodies,
            limits: task.limits,
            pool: task.pool,
            threads: 1,
        };
        let (window, mut counted) = ((from, end), Stats::default());
        let found = (&mut self.survivors, &mut counted);
        let done = search.list_spans(window, None, filter, found);
        let boxes = counted.boxes;
        // The slice is counted as one.
        counted.slices = 0;
        self.stats += counted;
        self.has_exceeded_limit |= done.is_err();
        if !filter.gives_up() {
            self.search_from = Some(end).filter(|&end| end < self.interval.1);
        }
        usize::try_from(boxes).unwrap_or(usize::MAX)
    }

    /// Keeps the spans of some more candidates that cheap tests cannot rule out. Bodies that have
    /// changed since are compared anew.
    pub(super) fn refine(&mut self, task: &SliceTask<'_>, scratch: &mut SliceScratch) -> usize {
        let SliceTask { bodies, filter, .. } = *task;
        let first = self.refined;
        self.refined = self.candidates.len().min(first + Self::STEP);
        let context = RefineContext {
            bodies,
            fat_lines: &self.index.fat_lines,
            interval: self.interval,
            window: Window::ALL,
            margin: bodies.grid.margin,
            max_spans: usize::MAX,
        };
        let (changed, index, interval) = (&self.changed, &self.index, self.interval);
        let pair = |Candidate { a, b }| {
            let is_wanted = !changed.has(a) && !changed.has(b) && filter.admits(a, b);
            (is_wanted && index.may_be_near([a, b], interval)).then_some([a, b])
        };
        let some = &self.candidates[first..self.refined];
        let found = &mut self.survivors;
        self.stats.spans += scratch.refiner.refine(&context, some, pair, found);
        self.refined - first
    }
}

impl BoxIndex {
    /// Returns true if two bodies whose fat lines approach each other in an interval (s) do so at one of their places each, too.
    fn may_be_near(&self, pair: [u32; 2], interval: (f64, f64)) -> bool {
        let places = pair.map(|slot| self.places.of(slot));
        if let [None, None] = places {
            return true;
        }
        let [a, b] = [0, 1].map(|one| {
            let whole = &self.fat_lines[pair[one] as usize];
            let lines = places[one].into_iter().flatten().map(|(line, _)| line);
            lines.chain(places[one].is_none().then_some(whole))
        });
        a.into_iter()
            .any(|a| b.clone().any(|b| approaching(a, b, interval).is_some()))
    }
}
