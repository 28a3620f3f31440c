//! Half-spaces against all other bodies: no box contains them, so no broad phase can find them.
//!
//! Each body is compared with each half-space: first by the box of its plan or the ends of its
//! straight motion, then span by span. What is left goes to the solver like any other survivor.

use super::prepared::PreparedScene;
use crate::broad_phase::PairFilter;
use crate::count::short;
use crate::narrow_phase::{BodyView, may_touch};
use crate::parallel;
use crate::scene::HeightRange;
use crate::search::{Bodies, LimitExceeded};
use crate::spans::{SpanKey, common_window, in_order, spans};
use glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A half-space of a scene.
#[derive(Debug)]
struct Plane<'p> {
    place: u32,
    view: BodyView<'p>,
    normal: DVec3,
    /// Heights of its position along the normal, if they are known without its cubics.
    range: Option<HeightRange>,
}

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
        /// Bodies that one thread compares at a time.
        const CHUNK: usize = 1024;
        let planes: Vec<Plane<'_>> = self.planes(bodies).collect();
        let places: Vec<u32> = (0..short(self.entries.len())).collect();
        let chunks: Vec<&[u32]> = places.chunks(CHUNK).collect();
        // Spans of all threads: an endless list would take all memory.
        let count = AtomicUsize::new(found.len());
        let compared = parallel::map(
            chunks.len(),
            || (),
            |(), chunk| {
                let (mut near, mut examined) = (Vec::new(), 0);
                for &body in chunks[chunk] {
                    for plane in &planes {
                        if filter.gives_up() {
                            return Ok((near, examined));
                        }
                        let before = near.len();
                        examined += self.compare_half_space(body, plane, bodies, filter, &mut near);
                        let more = near.len() - before;
                        if more > 0 {
                            self.limits
                                .check(count.fetch_add(more, Ordering::Relaxed) + more)?;
                        }
                    }
                }
                Ok((near, examined))
            },
        );
        let mut examined = 0;
        for of_chunk in compared {
            let (near, count) = of_chunk?;
            found.extend(near);
            examined += count;
        }
        found.sort_unstable();
        Ok(examined)
    }

    fn planes<'p>(&'p self, bodies: &'p impl Bodies) -> impl Iterator<Item = Plane<'p>> {
        self.half_spaces.iter().map(|&place| {
            let entry = self.entries[place as usize];
            let normal = entry.body.hitbox.normal().unwrap_or_default();
            Plane {
                place,
                view: bodies.view(place),
                normal,
                range: self.heights(place, normal),
            }
        })
    }

    /// Lists the spans of the body at a place with a half-space. Returns the number of spans
    /// examined.
    fn compare_half_space(
        &self,
        body: u32,
        plane: &Plane<'_>,
        bodies: &impl Bodies,
        filter: &dyn PairFilter,
        near: &mut Vec<SpanKey>,
    ) -> u64 {
        let place = body as usize;
        let (first, second) = (body.min(plane.place), body.max(plane.place));
        if self.entries[place].body.hitbox.is_half_space()
            || self.is_clear(body, plane)
            || !filter.admits(first, second)
        {
            return 0;
        }
        let view = bodies.view(body);
        let [(_, a), (_, b)] = in_order((body, &view), (plane.place, &plane.view));
        let Some((from, to)) = common_window(&a.knots, &b.knots, self.searched()) else {
            return 0;
        };
        let mut examined = 0;
        for span in spans(&a.knots, &b.knots, from, to) {
            examined += 1;
            if may_touch(a, b, span, self.margin, (from, to)) {
                near.push(SpanKey::of((first, second), span));
            }
        }
        examined
    }

    fn heights(&self, place: u32, normal: DVec3) -> Option<HeightRange> {
        let place = place as usize;
        let is_extended = self.extension(place).is_some();
        HeightRange::of(self.entries[place], is_extended, self.searched(), normal)
    }

    /// Returns true if the body at a place is certainly above a half-space in the whole window.
    fn is_clear(&self, place: u32, plane: &Plane<'_>) -> bool {
        let Some(ground) = &plane.range else {
            return false;
        };
        // The reach contains the model error of the body, not that of the half-space.
        let shape = self.entries[place as usize].body.shape();
        let reach = shape.reach() + plane.view.model_error;
        let heights = self.heights(place, plane.normal);
        heights.is_some_and(|heights| heights.is_above(ground, reach, self.margin))
    }
}
