//! All bodies of a monitor, for searches from nothing.

use super::bodies::BodyTable;
use crate::broad_phase::Method;
use crate::count::short;
use crate::parallel;
use crate::pool::Pool;
use crate::search::{
    Lifetimes, Limits, SceneStatistics, SearchScratch, SliceTrials, TimeSlices, WindowSearch,
};
use crate::simd::InstructionSet;
use crate::window::Window;

/// All bodies by slot, and the intervals in which they exist; a slot without a body never does.
#[derive(Debug)]
pub(super) struct PreparedBodies<'m> {
    table: BodyTable<'m>,
    lifetimes: Lifetimes,
}

impl<'m> PreparedBodies<'m> {
    /// Lists when all bodies exist, in memory that is given back with [`forget`](Self::forget).
    pub(super) fn of(table: BodyTable<'m>, memory: &mut Lifetimes) -> Self {
        let mut lifetimes = std::mem::take(memory);
        lifetimes.fill(table.monitored.lives());
        Self { table, lifetimes }
    }

    /// Lists when all bodies exist, and returns the statistics of a window (s): the bodies are read once.
    pub(super) fn in_window(
        table: BodyTable<'m>,
        memory: &mut Lifetimes,
        window: (f64, f64),
    ) -> (Self, SceneStatistics) {
        /// Slots that one thread goes through together.
        const SHARE: usize = 1024;
        let mut statistics = SceneStatistics::default();
        let mut lifetimes = std::mem::take(memory);
        let (monitored, count) = (table.monitored, table.monitored.len());
        if parallel::threads() > 1 && count > 2 * SHARE {
            let mut shares = vec![SceneStatistics::default(); count.div_ceil(SHARE)];
            // One list alone is shared; the other one is empty.
            let lists = (lifetimes.room(count), &mut vec![(); count][..]);
            parallel::for_each_share(
                lists,
                &mut shares,
                SHARE,
                |share, (lives, _), statistics| {
                    let slots = share * SHARE..share * SHARE + lives.len();
                    for (life, body) in lives.iter_mut().zip(monitored.present(slots)) {
                        add(statistics, body, window);
                        *life = body.0;
                    }
                },
            );
            for share in shares {
                statistics.body_time += share.body_time;
                statistics.segments += share.segments;
            }
        } else {
            lifetimes.fill(monitored.present(0..count).map(|body| {
                add(&mut statistics, body, window);
                body.0
            }));
        }
        (Self { table, lifetimes }, statistics)
    }

    /// Leaves the memory for other ones.
    pub(super) fn forget(self, memory: &mut Lifetimes) {
        *memory = self.lifetimes;
    }

    /// Returns the number of slots.
    pub(super) const fn len(&self) -> usize {
        self.lifetimes.len()
    }

    /// Returns a search over some time (s) on so many threads.
    pub(super) fn search<'s>(
        &'s self,
        window: Window,
        limits: Limits,
        (pool, threads): (&'s Pool<SearchScratch>, usize),
    ) -> WindowSearch<'s, BodyTable<'m>> {
        WindowSearch {
            bodies: self.table,
            lifetimes: &self.lifetimes,
            frame: self.table.frame,
            window,
            margin: self.table.margin,
            limits,
            method: Method::Sweep,
            instructions: InstructionSet::best(),
            pool,
            threads,
        }
    }

    /// Returns a window (s) in slices of the grid's `search_length`, which suits the whole lookahead.
    pub(super) fn slices_of_search_length(&self, (from, to): (f64, f64)) -> TimeSlices {
        TimeSlices::whole(from, to).with_count(((to - from) / self.table.search_length).round())
    }

    /// Returns a window (s) in slices of the length that suits the bodies there, searched from a length (s).
    pub(super) fn cheapest_slices(
        &self,
        (from, to): (f64, f64),
        length: f64,
        pool: &Pool<SearchScratch>,
    ) -> TimeSlices {
        let statistics = self.statistics((from, to));
        let count = ((to - from) / length).min(statistics.most_slices((from, to)));
        let trials = SliceTrials {
            lifetimes: &self.lifetimes,
            frame: self.table.frame,
            instructions: InstructionSet::best(),
            pool,
        };
        let some = |slots: &[usize]| {
            let slots = slots.iter().map(|&slot| short(slot));
            slots.map(|slot| self.table.source_of(slot)).collect()
        };
        let slices = TimeSlices::whole(from, to).with_count(count);
        trials.cheapest(slices, &statistics, &some)
    }

    /// Returns the statistics of a window (s) on which the number of slices depends.
    pub(super) fn statistics(&self, window: (f64, f64)) -> SceneStatistics {
        let mut statistics = SceneStatistics::default();
        let bodies = self.table.monitored.cubics();
        for (&life, cubics) in self.lifetimes.lives().iter().zip(bodies) {
            add(&mut statistics, (life, cubics), window);
        }
        statistics
    }
}

/// Adds what a body with so many cubics does in a window (s), given when it exists (s).
#[inline]
fn add(
    statistics: &mut SceneStatistics,
    (life, cubics): ((f64, f64), u32),
    (from, to): (f64, f64),
) {
    let (first, last) = life;
    let time = (last.min(to) - first.max(from)).max(0.0);
    statistics.body_time += time;
    if last > first {
        statistics.segments += f64::from(cubics) * (time / (last - first));
    }
}
