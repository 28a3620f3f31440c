//! The search from nothing: boxes of all bodies of a monitor are formed for it, and none is kept.

use super::bodies::BodyTable;
use crate::broad_phase::Method;
use crate::count::short;
use crate::pool::Pool;
use crate::scene::PairAdmission;
use crate::search::{
    Bodies, LimitExceeded, Limits, SceneStatistics, SearchScratch, SliceTrials, SourcesInPlace,
    TimeSlices, WindowSearch,
};
use crate::simd::InstructionSet;
use crate::spans::SpanKey;
use crate::stats::Stats;
use crate::wall_clock::Instant;
use crate::window::Window;

/// All bodies by slot, and how they are searched from nothing.
pub(super) struct SearchFromNothing<'m> {
    pub(super) table: BodyTable<'m>,
    pub(super) limits: Limits,
    pub(super) pool: &'m Pool<SearchScratch>,
    /// Threads that share the work.
    pub(super) threads: usize,
}

impl SearchFromNothing<'_> {
    /// Appends the spans in a window (s) to a list, as [`WindowSearch::spans`] does. Slices are as long as suits the bodies
    /// there, tried from a length (s); without one as long as suits the whole lookahead. Returns their length, s.
    pub(super) fn list_spans(
        &self,
        window: (f64, f64),
        tried: Option<f64>,
        filter: &PairAdmission<'_>,
        (found, stats): (&mut Vec<SpanKey>, &mut Stats),
    ) -> Result<f64, LimitExceeded> {
        let begin = Instant::now();
        let monitored = self.table.monitored;
        let mut statistics = SceneStatistics::default();
        let mut memory = self.pool.take();
        memory.lifetimes.clear();
        let lives = monitored.present(0..monitored.len()).map(|(life, cubics)| {
            statistics.add(life, window, (0.0, cubics));
            life
        });
        memory.lifetimes.extend(lives);
        let (whole, duration) = (TimeSlices::whole(window.0, window.1), window.1 - window.0);
        let slices = match tried {
            None => whole.with_count((duration / self.table.grid.search_length).round()),
            Some(length) => {
                let count = (duration / length).min(statistics.most_slices(window));
                let frame = &self.table.grid.frame;
                let trials = SliceTrials {
                    lifetimes: &memory.lifetimes,
                    frame,
                    limits: self.limits,
                    instructions: InstructionSet::best(),
                    pool: self.pool,
                    is_in_place: true,
                };
                let sources = |slots: &[usize]| {
                    let slots = slots.iter().map(|&slot| short(slot));
                    slots.map(|slot| self.table.source(slot, frame)).collect()
                };
                trials.cheapest(
                    whole.with_count(count),
                    (&statistics, filter),
                    &sources,
                    &|slot| self.table.long_arms(slot),
                )
            }
        };
        stats.bounds_time += begin.elapsed();
        stats.slices += u64::from(slices.count());
        let search = WindowSearch {
            bodies: self.table,
            lifetimes: &memory.lifetimes,
            frame: &self.table.grid.frame,
            window: Window::ALL,
            margin: self.table.grid.margin,
            limits: self.limits,
            method: Method::Sweep,
            instructions: InstructionSet::best(),
            pool: self.pool,
            threads: self.threads,
        };
        search.spans((&slices, &statistics), filter, &|_| {}, (found, stats))?;
        Ok(slices.length())
    }
}
