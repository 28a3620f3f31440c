//! All bodies of a monitor side by side: for searches from nothing.

use super::bodies::BodyTable;
use crate::bounds::{CubicSource, Padding};
use crate::narrow_phase::BodyView;
use crate::parallel;
use crate::pool::Pool;
use crate::search::{
    BodyLists, Lifetimes, Limits, ListMemory, SceneStatistics, SearchScratch, SliceTrials,
    TimeSlices, WindowSearch,
};
use crate::simd::InstructionSet;
use crate::trajectory::Segment;
use crate::window::Window;

/// All bodies side by side, by slot; one that never exists where there is none.
#[derive(Debug)]
pub(super) struct PreparedBodies<'m> {
    table: BodyTable<'m>,
    views: Vec<BodyView<'m>>,
    sources: Vec<CubicSource<'m, Segment>>,
    presence: Lifetimes,
}

/// Memory for them.
#[derive(Debug, Default)]
pub(super) struct PreparedMemory {
    lists: ListMemory<Segment>,
    presence: Lifetimes,
}

impl<'m> PreparedBodies<'m> {
    /// Lays out all bodies, in memory that is given back with [`forget`](Self::forget).
    pub(super) fn of(table: BodyTable<'m>, memory: &mut PreparedMemory) -> Self {
        /// Fewer are gone through on this thread.
        const FEW: usize = 4096;
        let (mut views, mut sources) = memory.lists.take();
        let mut presence = std::mem::take(&mut memory.presence);
        let prepare = |slot: usize| {
            let body = u32::try_from(slot).ok();
            let body = body.and_then(|slot| table.flights.get(table.scene, slot));
            let Some((flight, view)) = body.filter(|(flight, _)| flight.has_partner) else {
                let source =
                    CubicSource::plain((BodyView::NONE.knots, &[]), &Padding::NONE, table.frame);
                return (BodyView::NONE, source);
            };
            let cubics = (view.knots, view.segments);
            (
                view,
                CubicSource::plain(cubics, &flight.padding, table.frame),
            )
        };
        let lists = (&mut views, &mut sources);
        parallel::map_both(table.flights.len(), FEW, lists, prepare);
        presence.fill(views.iter().map(|view| view.knots.ends()));
        Self {
            table,
            views,
            sources,
            presence,
        }
    }

    /// Leaves the memory for other ones.
    pub(super) fn forget(self, memory: &mut PreparedMemory) {
        memory.lists.put_back((self.views, self.sources));
        memory.presence = self.presence;
    }

    /// Returns the number of slots.
    pub(super) const fn len(&self) -> usize {
        self.views.len()
    }

    /// Returns a search over some time (s) on so many threads.
    pub(super) fn search<'s>(
        &'s self,
        window: Window,
        limits: Limits,
        (pool, threads): (&'s Pool<SearchScratch>, usize),
    ) -> WindowSearch<'s, Segment> {
        WindowSearch {
            bodies: BodyLists {
                views: &self.views,
                sources: &self.sources,
            },
            presence: &self.presence,
            frame: self.table.frame,
            window,
            margin: self.table.margin,
            limits,
            instructions: InstructionSet::best(),
            pool,
            threads,
        }
    }

    /// Returns a window (s) in slices of the length that suits the bodies in all of the lookahead.
    pub(super) fn usual_slices(&self, (from, to): (f64, f64)) -> TimeSlices {
        TimeSlices::whole(from, to).with_count(((to - from) / self.table.search_length).round())
    }

    /// Returns a window (s) in slices of the length that suits the bodies there, searched from a length (s).
    pub(super) fn cheapest_slices(
        &self,
        (from, to): (f64, f64),
        length: f64,
        pool: &Pool<SearchScratch>,
    ) -> TimeSlices {
        let traffic = self.traffic((from, to));
        let count = ((to - from) / length).min(traffic.most_slices((from, to)));
        let trials = SliceTrials {
            presence: &self.presence,
            frame: self.table.frame,
            instructions: InstructionSet::best(),
            pool,
        };
        let some = |slots: &[usize]| slots.iter().map(|&slot| self.sources[slot]).collect();
        let slices = TimeSlices::whole(from, to).with_count(count);
        trials.cheapest(slices, &traffic, some)
    }

    /// Returns how much moves in a window (s), as far as the number of slices depends on it.
    pub(super) fn traffic(&self, (from, to): (f64, f64)) -> SceneStatistics {
        let mut traffic = SceneStatistics::default();
        for (&(first, last), view) in self.presence.lives().iter().zip(&self.views) {
            let time = (last.min(to) - first.max(from)).max(0.0);
            traffic.body_time += time;
            if last > first {
                #[allow(clippy::cast_precision_loss, reason = "an estimate")]
                let segments = view.knots.cubics() as f64;
                traffic.segments += segments * (time / (last - first));
            }
        }
        traffic
    }
}
