//! Half-spaces against all other bodies: no box contains them, so no broad phase can find them.
//!
//! Each body is compared with each half-space: first by the box of its plan or the ends of its
//! straight motion, then span by span. What is left goes to the solver like any other survivor.

use super::prepared::PreparedScene;
use crate::broad_phase::PairFilter;
use crate::count::short;
use crate::narrow_phase::{BodyView, may_touch};
use crate::parallel;
use crate::scene::{PlaneHeights, PositionBox, SceneEntry};
use crate::search::{Bodies, LimitExceeded};
use crate::spans::{SpanKey, common_window, in_order, spans};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A half-space of a scene: its heights, and its view.
type Plane<'p> = (PlaneHeights, BodyView<'p>);

impl PreparedScene<'_> {
    /// Appends every span in which a half-space and another body may be in contact to `found`;
    /// returns the number of spans examined. The list is sorted afterwards.
    ///
    /// # Errors
    ///
    /// If there are more spans in the list than the limit allows.
    pub(super) fn compare_half_spaces(
        &self,
        bodies: &impl Bodies,
        filter: &dyn PairFilter,
        found: &mut Vec<SpanKey>,
    ) -> Result<u64, LimitExceeded> {
        /// So many bodies are compared on one thread.
        const FEW: usize = 1024;
        let planes: Vec<Plane<'_>> = self.planes(bodies).collect();
        // Spans of all threads: an endless list would take all memory.
        let count = AtomicUsize::new(found.len());
        let compared = parallel::fold(self.entries.len(), FEW, Default::default, |share, body| {
            let (near, examined): &mut (Vec<SpanKey>, u64) = share;
            let body = short(body);
            let entry = self.entry(body);
            if entry.0.body.hitbox.is_half_space() {
                return;
            }
            let positions = PositionBox::of(entry, self.searched());
            for plane in &planes {
                let is_full = || self.limits.check(count.load(Ordering::Relaxed)).is_err();
                if filter.gives_up() || is_full() {
                    return;
                }
                let is_below = |positions| plane.0.is_below(positions, self.query.margin());
                if positions.as_ref().is_some_and(is_below) {
                    continue;
                }
                let before = near.len();
                *examined += self.compare_half_space(body, plane, bodies, filter, near);
                count.fetch_add(near.len() - before, Ordering::Relaxed);
            }
        });
        let mut examined = 0;
        for (near, count) in compared {
            found.extend(near);
            examined += count;
        }
        self.limits.check(found.len())?;
        found.sort_unstable();
        Ok(examined)
    }

    fn planes<'p>(&'p self, bodies: &'p impl Bodies) -> impl Iterator<Item = Plane<'p>> {
        self.half_spaces.iter().filter_map(|&place| {
            let heights = PlaneHeights::of(place, self.entry(place), self.searched());
            Some((heights?, bodies.view(place)))
        })
    }

    /// Lists the spans of the body at a place, no half-space itself, with a half-space. Returns the number of spans
    /// examined.
    fn compare_half_space(
        &self,
        body: u32,
        (plane, ground): &Plane<'_>,
        bodies: &impl Bodies,
        filter: &dyn PairFilter,
        near: &mut Vec<SpanKey>,
    ) -> u64 {
        let (first, second) = (body.min(plane.body), body.max(plane.body));
        if !filter.admits(first, second) {
            return 0;
        }
        let view = bodies.view(body);
        let [(_, a), (_, b)] = in_order((body, &view), (plane.body, ground));
        let Some((from, to)) = common_window(&a.knots, &b.knots, self.searched()) else {
            return 0;
        };
        let mut examined = 0;
        for span in spans(&a.knots, &b.knots, from, to) {
            examined += 1;
            if may_touch(a, b, span, self.query.margin(), (from, to)) {
                near.push(SpanKey::of((first, second), span));
            }
        }
        examined
    }

    /// Returns the body at a place, and true if its plan is extended in the window.
    fn entry(&self, place: u32) -> (&SceneEntry, bool) {
        let place = place as usize;
        (self.entries[place], self.extension(place).is_some())
    }
}
