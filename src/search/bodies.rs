//! The bodies of a search, under dense numbers.

use super::form_slices::SlicesToForm;
use crate::bounds::{BodyCubic, BoundingCubic, CubicSource, HullTest, hull_test};
use crate::knots::Knots;
use crate::narrow_phase::BodyView;
use crate::simd::prefetch;
use std::slice::from_ref;

/// Access to bodies under dense numbers: all that a search knows of a scene or a monitor.
pub(crate) trait Bodies: Sync {
    /// Returns the view of a body; one that never exists if there is none.
    fn view(&self, body: u32) -> BodyView<'_>;

    fn knots(&self, body: u32) -> Knots<'_> {
        self.view(body).knots
    }

    /// Returns the hull test of two bodies, each on one cubic, over a time (s).
    fn hull_test(&self, _: [(u32, u32); 2], _: (f64, f64)) -> HullTest {
        HullTest::Blurred
    }

    /// Prefetches the record of a body.
    fn fetch(&self, _: u32) {}

    /// Prefetches the data of its view.
    fn fetch_view(&self, body: u32) {
        self.fetch(body);
    }

    /// Prefetches the knots of a body, from those of a cubic on.
    fn fetch_knots(&self, _: (u32, u32)) {}

    /// Prefetches a cubic for the [hull test](Self::hull_test).
    fn fetch_cubic(&self, _: (u32, u32)) {}

    fn fetch_segment(&self, _: (u32, u32)) {}
}

/// Bodies of which boxes can be formed.
pub(crate) trait BoxedBodies: Bodies {
    /// Forms the boxes and fat lines of some bodies in a few slices.
    fn form(&self, slices: SlicesToForm<'_>);
}

/// Bodies in lists, by number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyLists<'a, C> {
    pub(crate) views: &'a [BodyView<'a>],
    pub(crate) sources: &'a [CubicSource<'a, C>],
}

/// Memory of such lists, which one search leaves to the next.
#[derive(Debug)]
pub(crate) struct ListMemory<C: 'static> {
    views: Vec<BodyView<'static>>,
    sources: Vec<CubicSource<'static, C>>,
}

impl<C> Default for ListMemory<C> {
    fn default() -> Self {
        Self {
            views: Vec::new(),
            sources: Vec::new(),
        }
    }
}

impl<C> ListMemory<C> {
    /// Returns two empty lists in this memory.
    pub(crate) fn take<'a>(&mut self) -> (Vec<BodyView<'a>>, Vec<CubicSource<'a, C>>) {
        (
            recycled(std::mem::take(&mut self.views)),
            recycled(std::mem::take(&mut self.sources)),
        )
    }

    /// Takes the memory of two lists back.
    pub(crate) fn put_back<'a>(
        &mut self,
        (views, sources): (Vec<BodyView<'a>>, Vec<CubicSource<'a, C>>),
    ) {
        (self.views, self.sources) = (recycled(views), recycled(sources));
    }
}

/// Returns the memory of a list for values of another lifetime.
fn recycled<T, U>(mut list: Vec<T>) -> Vec<U> {
    list.clear();
    list.into_iter().filter_map(|_| None).collect()
}

impl<C: BoundingCubic + Sync> Bodies for BodyLists<'_, C> {
    #[inline]
    fn view(&self, body: u32) -> BodyView<'_> {
        self.views[body as usize]
    }

    /// Reads the list that boxes are formed from: it is cached.
    #[inline]
    fn knots(&self, body: u32) -> Knots<'_> {
        self.sources[body as usize].knots
    }

    #[inline]
    fn hull_test(&self, cubics: [(u32, u32); 2], part: (f64, f64)) -> HullTest {
        if !C::IS_COMPACT {
            return HullTest::Blurred;
        }
        let [a, b] = cubics.map(|(body, cubic)| BodyCubic {
            source: &self.sources[body as usize],
            cubic: cubic as usize,
        });
        hull_test(&a, &b, part)
    }

    #[inline]
    fn fetch(&self, body: u32) {
        prefetch(from_ref(&self.sources[body as usize]));
    }

    #[inline]
    fn fetch_view(&self, body: u32) {
        prefetch(from_ref(&self.views[body as usize]));
    }

    #[inline]
    fn fetch_knots(&self, (body, first): (u32, u32)) {
        /// Two cache lines.
        const KNOTS: usize = 16;
        let knots = &self.sources[body as usize].knots;
        knots.prefetch(first as usize, KNOTS);
    }

    #[inline]
    fn fetch_cubic(&self, (body, cubic): (u32, u32)) {
        let source = &self.sources[body as usize];
        source.fetch((cubic as usize).wrapping_sub(source.knots.before()));
    }

    #[inline]
    fn fetch_segment(&self, (body, cubic): (u32, u32)) {
        self.views[body as usize].prefetch(cubic as usize);
    }
}

impl<C: BoundingCubic + Sync> BoxedBodies for BodyLists<'_, C> {
    fn form(&self, slices: SlicesToForm<'_>) {
        slices.form_listed(self.sources);
    }
}
