//! Boxes and fat lines of bodies. Their sources are in a list, or made one by one in place: from the bodies' own
//! memory, just before they are used.

use super::body_walk::{SLICES_AT_A_TIME, cubic_before, likely_cubic, slice_intervals_of, walk};
use super::form::{FormBounds, SliceBlock, SliceBounds};
use crate::bounds::{
    BoundingCubic, CubicSource, FatLine, Frame, MovingFrame, SliceInterval, StraightPieces,
};
use crate::broad_phase::BodyBox;
use crate::count::short;
use crate::parallel;
use crate::simd::{InstructionSet, Task};
use parry3d::bounding_volume::Aabb;

/// Bodies whose sources are made in place.
pub(crate) trait SourcesInPlace: Sync {
    type Cubic: BoundingCubic;

    /// Returns the straight motions of a body, if it follows nothing else from an instant (s) on; in a frame with the unit of
    /// the search's.
    fn straight(&self, body: u32, from: f64, frame: &Frame) -> Option<StraightPieces<'_>>;

    /// Returns the source of a body's boxes, in a frame with the unit of the search's.
    fn source(&self, body: u32, frame: &Frame) -> CubicSource<'_, Self::Cubic>;

    /// Prefetches the record of a body.
    fn fetch_record(&self, _: u32) {}

    /// Prefetches what [`source`](Self::source) reads beside the record.
    fn fetch_motion(&self, _: u32) {}
}

/// A few slices whose boxes and fat lines are to be formed.
pub(crate) struct SlicesToForm<'a> {
    pub(crate) block: &'a mut SliceBlock,
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
    /// Bodies in a chunk of the work. Fewer than two chunks stay on this thread.
    pub(super) const CHUNK: usize = 2048;

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

    /// Forms them with sources made in place.
    pub(crate) fn form_in_place<B: SourcesInPlace>(mut self, bodies: &B) {
        let count = self.ends.len() - 1;
        if self.threads > 1 && self.present.len() > Self::CHUNK {
            self.form_shared(bodies);
        } else {
            self.form_alone(bodies);
        }
        let slices = &mut self.block.slices[..count];
        for (slice, ends) in slices.iter_mut().zip(self.ends.windows(2)) {
            slice.split_teleports(|body| {
                let interval = (ends[0], ends[1]);
                let pieces = bodies.straight(body, ends[0], self.frame);
                let parts = pieces.map(|pieces| pieces.bounds_by_teleport(self.frame, interval));
                parts.unwrap_or_default()
            });
        }
    }

    fn form_alone<B: SourcesInPlace>(&mut self, bodies: &B) {
        let count = self.ends.len() - 1;
        self.block.clear(count, self.present.len());
        let slices = &mut self.block.slices[..count];
        let instructions = self.instructions;
        instructions.run(FormInPlace {
            instructions,
            frame: self.frame,
            bodies,
            present: self.present.iter().copied(),
            ends: self.ends,
            put: |(_, body), slice: usize, bounds| slices[slice].push(body, bounds),
        });
    }

    /// Forms them on several threads, on each those of some bodies in all slices.
    fn form_shared<B: SourcesInPlace>(&mut self, bodies: &B) {
        let (present, ends, frame) = (self.present, self.ends, self.frame);
        let (instructions, count) = (self.instructions, ends.len() - 1);
        let slices = self.block.first_slices(count);
        let mut chunks = Vec::new();
        let count_of_chunks = present.len().div_ceil(Self::CHUNK);
        chunks.resize_with(count_of_chunks, || (Vec::new(), 0));
        for slice in &mut *slices {
            let lists = slice.chunks(present.len(), Self::CHUNK);
            for ((chunk, _), lists) in chunks.iter_mut().zip(lists) {
                chunk.push(lists);
            }
        }
        parallel::for_each(&mut chunks, |number, (lists, formed)| {
            for one in lists.iter_mut().flat_map(|(boxes, _)| &mut **boxes) {
                one.body = SliceBounds::MISSING.body;
            }
            let first = number * Self::CHUNK;
            instructions.run(FormInPlace {
                instructions,
                frame,
                bodies,
                present: present[first..].iter().copied().take(Self::CHUNK),
                ends,
                put: |(number, _), slice: usize, (fat_line, aabb)| {
                    let (boxes, lines) = &mut lists[slice];
                    let body = short(first + number);
                    boxes[number] = BodyBox { aabb, body };
                    lines[number] = fat_line;
                    *formed += 1;
                },
            });
        });
        let formed: usize = chunks.into_iter().map(|(_, formed)| formed).sum();
        for slice in slices {
            slice.set_bodies(present);
            if formed < count * present.len() {
                slice.drop_missing();
            }
        }
    }
}

/// Forms the bounds of bodies with sources made in place, in at most [`SLICES_AT_A_TIME`] slices.
pub(crate) struct FormInPlace<'a, B, I, P> {
    pub(crate) instructions: InstructionSet,
    pub(crate) frame: &'a MovingFrame,
    pub(crate) bodies: &'a B,
    pub(crate) present: I,
    /// Ends of the slices, s: one more than there are slices.
    pub(crate) ends: &'a [f64],
    /// Takes the bounds of a body, given by number and name, in a slice.
    pub(crate) put: P,
}

impl<B, I, P> Task for FormInPlace<'_, B, I, P>
where
    B: SourcesInPlace,
    I: Iterator<Item = u32> + Clone,
    P: FnMut((usize, u32), usize, (FatLine, Aabb)),
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let frame = self.frame;
        if frame.moves() {
            self.form(|from, to| frame.slice_interval(from, to));
        } else {
            self.form(SliceInterval::new);
        }
    }
}

impl<B, I, P> FormInPlace<'_, B, I, P>
where
    B: SourcesInPlace,
    I: Iterator<Item = u32> + Clone,
    P: FnMut((usize, u32), usize, (FatLine, Aabb)),
{
    /// Prefetch distance in bodies.
    const AHEAD: usize = 4;

    #[inline(always)]
    fn form<const MOVES: bool>(
        mut self,
        slice_interval: impl Fn(f64, f64) -> SliceInterval<MOVES>,
    ) {
        let mut memory = [SliceInterval::UNUSED; SLICES_AT_A_TIME];
        let slice_intervals = slice_intervals_of(self.ends, slice_interval, &mut memory);
        let mut motions = self.present.clone();
        let mut records = self.present.clone();
        for body in records.by_ref().take(2 * Self::AHEAD) {
            self.bodies.fetch_record(body);
        }
        for body in motions.by_ref().take(Self::AHEAD) {
            self.bodies.fetch_motion(body);
        }
        for (number, body) in self.present.enumerate() {
            if let Some(later) = records.next() {
                self.bodies.fetch_record(later);
            }
            if let Some(later) = motions.next() {
                self.bodies.fetch_motion(later);
            }
            let put = &mut |slice: usize, bounds| (self.put)((number, body), slice, bounds);
            if let Some(pieces) = self
                .bodies
                .straight(body, slice_intervals[0].from, self.frame)
            {
                for (slice, slice_interval) in slice_intervals.iter().enumerate() {
                    put(slice, pieces.bounds(slice_interval));
                }
            } else {
                // A call of its own: inlined here, it would take registers from the branch above.
                self.instructions.run(WalkInPlace {
                    bodies: self.bodies,
                    frame: self.frame,
                    body,
                    slice_intervals,
                    put,
                });
            }
        }
    }
}

/// Forms the bounds of one body.
struct WalkInPlace<'a, B, const MOVES: bool> {
    bodies: &'a B,
    frame: &'a Frame,
    body: u32,
    slice_intervals: &'a [SliceInterval<MOVES>],
    /// Called by address: a walk takes far longer than a call, and is compiled once for all callers.
    put: &'a mut dyn FnMut(usize, (FatLine, Aabb)),
}

impl<B: SourcesInPlace, const MOVES: bool> Task for WalkInPlace<'_, B, MOVES> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let source = self.bodies.source(self.body, self.frame);
        let from = self.slice_intervals[0].from;
        let first = || cubic_before(&source.knots, from, likely_cubic(&source.knots, from));
        walk(&source, self.slice_intervals, (None, first), &mut self.put);
    }
}
