//! Boxes and fat lines of bodies in lists, or of each body from where it lies.

use super::form::{FormBounds, SliceBlock, SliceBounds, short};
use crate::bounds::{BoundingCubic, CubicSource, FatLine, MovingFrame};
use crate::broad_phase::BodyBox;
use crate::parallel;
use crate::simd::{InstructionSet, Task};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bodies whose boxes are formed at a time where they lie: their sources stay in the caches.
pub(crate) const BATCH: usize = 64;

/// Their places: 0, 1, and so on.
pub(crate) const PLACES: [u32; BATCH] = {
    let mut places = [0; BATCH];
    let mut place = 1;
    while place < BATCH {
        places[place] = places[place - 1] + 1;
        place += 1;
    }
    places
};

/// A few slices whose boxes and fat lines are to be formed.
pub(crate) struct SlicesToForm<'a> {
    pub(crate) block: &'a mut SliceBlock,
    /// Memory for the boxes of a few bodies: one for each share of the work.
    pub(crate) batches: &'a mut Vec<SliceBlock>,
    pub(crate) frame: &'a MovingFrame,
    /// Bodies, ascending: includes each body that exists in one of the slices.
    pub(crate) present: &'a [u32],
    /// Ends of the slices, s: one more than there are slices.
    pub(crate) ends: &'a [f64],
    pub(crate) instructions: InstructionSet,
    /// Threads that may share the work.
    pub(crate) threads: usize,
}

impl SlicesToForm<'_> {
    /// Bodies in a share of the work. Fewer than two shares stay on this thread.
    const SHARE: usize = 32 * BATCH;

    /// Forms them from a list of all bodies.
    pub(crate) fn form_listed<C: BoundingCubic>(self, sources: &[CubicSource<'_, C>]) {
        self.instructions.run(FormBounds {
            block: self.block,
            frame: self.frame,
            sources,
            present: self.present,
            ends: self.ends,
        });
    }

    /// Forms them of each body from where it lies. `fetch` prefetches a body.
    pub(crate) fn form_in_place<'s, C: BoundingCubic + Copy + 's>(
        mut self,
        fetch: impl Fn(u32) + Sync,
        source: impl Fn(u32) -> CubicSource<'s, C> + Sync,
    ) {
        let count = self.ends.len() - 1;
        let shares = self.present.len().div_ceil(Self::SHARE).max(1);
        if self.batches.len() < shares {
            self.batches.resize_with(shares, SliceBlock::default);
        }
        // Slices are shared by threads where there are several.
        let is_shared = count == 1 && self.threads > 1;
        if is_shared && self.form_shared(&fetch, &source) {
            return;
        }
        self.block.clear(count, self.present.len());
        for (number, bodies) in self.present.chunks(BATCH).enumerate() {
            self.instructions.run(FormBatch {
                batch: &mut self.batches[0],
                frame: self.frame,
                bodies: &self.present[number * BATCH..],
                count: bodies.len(),
                ends: self.ends,
                fetch: &fetch,
                source: &source,
            });
            let formed = &self.batches[0].slices[..count];
            for (slice, formed) in self.block.slices.iter_mut().zip(formed) {
                append(slice, formed, bodies);
            }
        }
    }

    /// Forms those of one slice on several threads. Returns false if not all bodies exist in it.
    fn form_shared<'s, C: BoundingCubic + Copy + 's>(
        &mut self,
        fetch: &(impl Fn(u32) + Sync),
        source: &(impl Fn(u32) -> CubicSource<'s, C> + Sync),
    ) -> bool {
        let (present, ends, frame) = (self.present, self.ends, self.frame);
        let instructions = self.instructions;
        if self.block.slices.is_empty() {
            self.block.slices.push(SliceBounds::default());
        }
        let slice = &mut self.block.slices[0];
        // What they held is overwritten.
        let any = BodyBox {
            aabb: Aabb::new(Vector::ZERO, Vector::ZERO),
            body: 0,
        };
        slice.boxes.resize(present.len(), any);
        slice.fat_lines.resize(present.len(), FatLine::default());
        let lacks_some = AtomicBool::new(false);
        let lists = (&mut slice.boxes[..], &mut slice.fat_lines[..]);
        let work =
            |share: usize, (boxes, lines): (&mut [BodyBox], &mut [FatLine]), batch: &mut _| {
                let first = share * Self::SHARE;
                let places = (0..boxes.len()).step_by(BATCH);
                let parts = boxes.chunks_mut(BATCH).zip(lines.chunks_mut(BATCH));
                for (place, (boxes, lines)) in places.zip(parts) {
                    let batch: &mut SliceBlock = batch;
                    let first = first + place;
                    instructions.run(FormBatch {
                        batch: &mut *batch,
                        frame,
                        bodies: &present[first..],
                        count: boxes.len(),
                        ends,
                        fetch,
                        source,
                    });
                    let formed = &batch.slices[0];
                    if formed.boxes.len() < boxes.len() {
                        lacks_some.store(true, Ordering::Relaxed);
                        return;
                    }
                    for (one, formed) in boxes.iter_mut().zip(&formed.boxes) {
                        *one = at_place(formed, first);
                    }
                    lines.copy_from_slice(&formed.fat_lines);
                }
            };
        parallel::for_each_share(lists, self.batches, Self::SHARE, work);
        slice.bodies.clear();
        slice.bodies.extend_from_slice(present);
        !lacks_some.into_inner()
    }
}

/// Forms the bounds of the first few bodies of a list, in a block of their own.
struct FormBatch<'a, F, S> {
    batch: &'a mut SliceBlock,
    frame: &'a MovingFrame,
    bodies: &'a [u32],
    count: usize,
    ends: &'a [f64],
    fetch: &'a F,
    source: &'a S,
}

impl<'s, C, F, S> Task for FormBatch<'_, F, S>
where
    C: BoundingCubic + Copy + 's,
    F: Fn(u32),
    S: Fn(u32) -> CubicSource<'s, C>,
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        /// Prefetch distance in bodies.
        const AHEAD: usize = 4;
        let mut sources = [CubicSource::NONE; BATCH];
        let places = sources.iter_mut().zip(self.bodies).take(self.count);
        for (place, (of_body, &body)) in places.enumerate() {
            if let Some(&later) = self.bodies.get(place + AHEAD) {
                (self.fetch)(later);
            }
            *of_body = (self.source)(body);
        }
        FormBounds {
            block: self.batch,
            frame: self.frame,
            sources: &sources[..self.count],
            present: &PLACES[..self.count],
            ends: self.ends,
        }
        .run();
    }
}

/// Appends the bounds of a batch, given the bodies at its places.
fn append(slice: &mut SliceBounds, batch: &SliceBounds, bodies: &[u32]) {
    let first = slice.bodies.len();
    let boxes = batch.boxes.iter().map(|one| at_place(one, first));
    slice.boxes.extend(boxes);
    slice.fat_lines.extend_from_slice(&batch.fat_lines);
    let bodies = batch.bodies.iter().map(|&place| bodies[place as usize]);
    slice.bodies.extend(bodies);
}

/// Returns a box of a batch whose first one has this place in its slice.
fn at_place(one: &BodyBox, first: usize) -> BodyBox {
    BodyBox {
        aabb: one.aabb,
        body: short(first) + one.body,
    }
}
