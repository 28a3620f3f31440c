//! All bodies of a monitor, for searches from nothing.

use super::bodies::BodyTable;
use crate::broad_phase::Method;
use crate::count::short;
use crate::parallel;
use crate::pool::{Pool, Pooled};
use crate::scene::PairAdmission;
use crate::search::{
    LimitExceeded, Limits, SceneStatistics, SearchScratch, SliceTrials, SourcesInPlace, TimeSlices,
    WindowSearch,
};
use crate::simd::InstructionSet;
use crate::spans::SpanKey;
use crate::stats::Stats;
use crate::window::Window;

/// All bodies by slot, and the intervals in which they exist; a slot without a body never does.
#[derive(Debug)]
pub(super) struct PreparedBodies<'m> {
    table: BodyTable<'m>,
    limits: Limits,
    pool: &'m Pool<SearchScratch>,
    /// Holds the lifetimes.
    memory: Pooled<'m, SearchScratch>,
    /// Threads that share the work.
    threads: usize,
}

impl<'m> PreparedBodies<'m> {
    /// Lists when all bodies exist, in memory of a pool, and returns the statistics of a window (s): the bodies are read
    /// once. So many threads share the work.
    pub(super) fn in_window(
        table: BodyTable<'m>,
        limits: Limits,
        pool: &'m Pool<SearchScratch>,
        (window, threads): ((f64, f64), usize),
    ) -> (Self, SceneStatistics) {
        /// Slots that one thread goes through together.
        const CHUNK: usize = 1024;
        let mut statistics = SceneStatistics::default();
        let mut memory = pool.take();
        let lifetimes = &mut memory.lifetimes;
        let (monitored, count) = (table.monitored, table.monitored.len());
        if threads > 1 && count > 2 * CHUNK {
            lifetimes.resize(count, (0.0, 0.0));
            let lists = lifetimes.chunks_mut(CHUNK);
            let chunks = lists.map(|lives| (lives, SceneStatistics::default()));
            let mut chunks: Vec<_> = chunks.collect();
            parallel::for_each(&mut chunks, |number, (lives, statistics)| {
                let slots = number * CHUNK..number * CHUNK + lives.len();
                for (life, (ends, cubics)) in lives.iter_mut().zip(monitored.present(slots)) {
                    statistics.add(ends, window, (0.0, cubics));
                    *life = ends;
                }
            });
            for (_, chunk) in chunks {
                statistics.body_time += chunk.body_time;
                statistics.segments += chunk.segments;
            }
        } else {
            lifetimes.clear();
            lifetimes.extend(monitored.present(0..count).map(|(life, cubics)| {
                statistics.add(life, window, (0.0, cubics));
                life
            }));
        }
        let bodies = Self {
            table,
            limits,
            pool,
            memory,
            threads,
        };
        (bodies, statistics)
    }

    /// Returns the number of slots.
    pub(super) fn len(&self) -> usize {
        self.memory.lifetimes.len()
    }

    /// Appends the spans in some slices to a list, as [`WindowSearch::spans`] does.
    pub(super) fn list_spans(
        &self,
        slicing: (&TimeSlices<'_>, &SceneStatistics),
        filter: &PairAdmission<'_>,
        found: (&mut Vec<SpanKey>, &mut Stats),
    ) -> Result<(), LimitExceeded> {
        let search = WindowSearch {
            bodies: self.table,
            lifetimes: &self.memory.lifetimes,
            frame: &self.table.grid.frame,
            window: Window::ALL,
            margin: self.table.grid.margin,
            limits: self.limits,
            method: Method::Sweep,
            instructions: InstructionSet::best(),
            pool: self.pool,
            threads: self.threads,
        };
        search.spans(slicing, filter, &|_| {}, found)
    }

    /// Returns a window (s) in slices of the grid's `search_length`, which suits the whole lookahead.
    pub(super) fn slices_of_search_length(&self, (from, to): (f64, f64)) -> TimeSlices<'static> {
        let count = ((to - from) / self.table.grid.search_length).round();
        TimeSlices::whole(from, to).with_count(count)
    }

    /// Returns a window (s) in slices of the length that suits the bodies there, searched from a length (s); and the
    /// statistics of the window.
    pub(super) fn cheapest_slices(
        &self,
        (from, to): (f64, f64),
        length: f64,
        filter: &PairAdmission<'_>,
    ) -> (TimeSlices<'static>, SceneStatistics) {
        let statistics = self.statistics((from, to));
        let count = ((to - from) / length).min(statistics.most_slices((from, to)));
        let trials = SliceTrials {
            lifetimes: &self.memory.lifetimes,
            frame: &self.table.grid.frame,
            limits: self.limits,
            instructions: InstructionSet::best(),
            pool: self.pool,
            is_in_place: true,
        };
        let frame = &self.table.grid.frame;
        let some = |slots: &[usize]| {
            let slots = slots.iter().map(|&slot| short(slot));
            slots.map(|slot| self.table.source(slot, frame)).collect()
        };
        let slices = TimeSlices::whole(from, to).with_count(count);
        (
            trials.cheapest(slices, (&statistics, filter), &some),
            statistics,
        )
    }

    /// Returns the statistics of a window (s) on which the number of slices depends.
    fn statistics(&self, window: (f64, f64)) -> SceneStatistics {
        let mut statistics = SceneStatistics::default();
        let monitored = self.table.monitored;
        for (life, cubics) in monitored.present(0..monitored.len()) {
            statistics.add(life, window, (0.0, cubics));
        }
        statistics
    }
}
