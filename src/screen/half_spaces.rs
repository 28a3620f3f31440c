//! Half-spaces against all other bodies: no box contains them, so no broad phase can find them.
//!
//! Each body is compared with each half-space: first by the box of its plan or the ends of its
//! straight motion, then span by span. What is left goes to the solver like any other survivor.

use super::prepared::PreparedScene;
use crate::broad_phase::PairFilter;
use crate::narrow_phase::{BodyView, may_touch};
use crate::parallel;
use crate::rounding::{seen_from, seen_until};
use crate::scene::SceneEntry;
use crate::search::{Bodies, LimitExceeded};
use crate::spans::{SpanKey, common_domain, spans};
use crate::window::Window;
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

/// The lowest and the highest coordinate of a motion along a normal, m.
#[derive(Clone, Copy, Debug)]
struct HeightRange {
    low: f64,
    high: f64,
    /// Magnitude of the coordinates, m.
    size: f64,
}

impl HeightRange {
    /// Returns the heights of a body in a window along a normal, if they are known without its
    /// cubics: it follows one straight motion, or its plan alone.
    fn of(entry: &SceneEntry, is_extended: bool, window: Window, normal: DVec3) -> Option<Self> {
        let plan = &entry.body.trajectory;
        match plan.straight_motions() {
            [] if is_extended => None,
            [] => {
                let plan = entry.summary().extremes;
                let (along, across) = (normal.max(DVec3::ZERO), normal.min(DVec3::ZERO));
                Some(Self {
                    low: plan.low.dot(along) + plan.high.dot(across),
                    high: plan.high.dot(along) + plan.low.dot(across),
                    size: plan.low.abs().max(plan.high.abs()).element_sum(),
                })
            }
            [motion] => {
                // Instants are rounded: what is reported in the window may lie just outside.
                let (from, to) = (seen_from(window.start()), seen_until(window.end()));
                let ways = [from, to].map(|time| motion.way_to(time));
                let ends = ways.map(|way| (motion.origin() + way).dot(normal));
                let size = |vector: DVec3| vector.abs().element_sum();
                Some(Self {
                    low: ends[0].min(ends[1]),
                    high: ends[0].max(ends[1]),
                    size: size(motion.origin()) + size(ways[0]) + size(ways[1]),
                })
            }
            _ => None,
        }
    }
}

impl PreparedScene<'_> {
    /// Appends every span in which a half-space and another body may be in contact to `found`;
    /// returns the number of spans examined. The list is sorted afterwards.
    ///
    /// # Errors
    ///
    /// If there are more spans in the list than the limit allows.
    pub(super) fn meet_half_spaces<F: PairFilter>(
        &self,
        bodies: &impl Bodies,
        filter: &F,
        found: &mut Vec<SpanKey>,
    ) -> Result<u64, LimitExceeded> {
        /// Bodies that one thread compares at a time.
        const CHUNK: u32 = 1024;
        let planes: Vec<Plane<'_>> = self.planes(bodies).collect();
        // Places are counted in 32 bits.
        let bodies_in_all = u32::try_from(self.entries.len()).unwrap_or(u32::MAX);
        let chunks = bodies_in_all.div_ceil(CHUNK);
        // Spans of all threads: an endless list would take all memory.
        let count = AtomicUsize::new(found.len());
        let compared = parallel::map(
            chunks,
            1,
            || (),
            |(), chunk| {
                let (mut near, mut looked_at) = (Vec::new(), 0);
                let first = chunk * CHUNK;
                for body in first..bodies_in_all.min(first.saturating_add(CHUNK)) {
                    for plane in &planes {
                        if filter.gives_up() {
                            return Ok((near, looked_at));
                        }
                        let before = near.len();
                        looked_at += self.meet_plane(body, plane, bodies, filter, &mut near);
                        let more = near.len() - before;
                        if more > 0 {
                            self.limits
                                .check(count.fetch_add(more, Ordering::Relaxed) + more)?;
                        }
                    }
                }
                Ok((near, looked_at))
            },
        );
        let mut looked_at = 0;
        for of_chunk in compared {
            let (near, count) = of_chunk?;
            found.extend(near);
            looked_at += count;
        }
        found.sort_unstable();
        Ok(looked_at)
    }

    fn planes<'p>(&'p self, bodies: &'p impl Bodies) -> impl Iterator<Item = Plane<'p>> {
        self.half_spaces.iter().map(|&place| {
            let entry = self.entries[place as usize];
            let normal = entry.body.hitbox.normal().unwrap_or_default();
            let is_extended = self.extension(place as usize).is_some();
            Plane {
                place,
                view: bodies.view(place),
                normal,
                range: HeightRange::of(entry, is_extended, self.window, normal),
            }
        })
    }

    /// Lists the spans of the body at a place with a half-space. Returns the number of spans
    /// examined.
    fn meet_plane<F: PairFilter>(
        &self,
        body: u32,
        plane: &Plane<'_>,
        bodies: &impl Bodies,
        filter: &F,
        near: &mut Vec<SpanKey>,
    ) -> u64 {
        let place = body as usize;
        let (first, second) = (body.min(plane.place), body.max(plane.place));
        if self.entries[place].body.hitbox.is_half_space()
            || self.is_clear(place, plane)
            || !filter.admits(first, second)
        {
            return 0;
        }
        let view = bodies.view(body);
        let (a, b) = if body == first {
            (&view, &plane.view)
        } else {
            (&plane.view, &view)
        };
        let Some((start, end)) = common_domain(&a.knots, &b.knots) else {
            return 0;
        };
        // Instants are rounded: what is reported in the window may lie just outside.
        let from = start.max(seen_from(self.window.start()));
        let to = end.min(seen_until(self.window.end()));
        let mut looked_at = 0;
        for span in spans(&a.knots, &b.knots, from, to) {
            looked_at += 1;
            if may_touch(a, b, span, self.margin, (from, to)) {
                near.push(SpanKey {
                    a: first,
                    b: second,
                    cubic_a: span.a,
                    cubic_b: span.b,
                });
            }
        }
        looked_at
    }

    /// Returns true if the body at a place is certainly above a half-space in the whole window.
    fn is_clear(&self, place: usize, plane: &Plane<'_>) -> bool {
        /// Far more than the rounding of the boxes, relative to their coordinates.
        const CLEARANCE: f64 = 1e-9;
        let Some(ground) = plane.range else {
            return false;
        };
        let entry = self.entries[place];
        let is_extended = self.extension(place).is_some();
        let heights = HeightRange::of(entry, is_extended, self.window, plane.normal);
        heights.is_some_and(|heights| {
            // The reach contains the model error of the body, not that of the half-space.
            let reach = entry.body.shape().reach() + plane.view.model_error;
            let size = heights.size + ground.size + reach + self.margin.abs();
            // The normal's length is 1 within 1e-9, and the heights within their size.
            heights.low - ground.high > reach + self.margin + 4.0 * CLEARANCE * size
        })
    }
}
