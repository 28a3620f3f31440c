//! Boxes and fat lines of all bodies in a few slices.

use super::body_walk::{
    PrefetchTarget, SLICES_AT_A_TIME, cubic_at, cubic_before, ends_of, exists, likely_cubic,
    slice_intervals_of, walk,
};
use crate::bounds::{
    BoundingCubic, CubicRun, CubicSource, FatLine, Frame, MAX_PLACES, MovingFrame, SliceInterval,
    tighten,
};
use crate::broad_phase::BodyBox;
use crate::count::{as_f64, short};
use crate::shape::BodyShape;
use crate::simd::{InstructionSet, Task};
use arrayvec::ArrayVec;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use std::slice::from_ref;

/// The bounds of one slice: a box and a fat line for each body that exists in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct SliceBounds {
    /// The `body` of a box is its place in these lists.
    pub(crate) boxes: Vec<BodyBox>,
    pub(crate) fat_lines: Vec<FatLine>,
    /// Bodies by place, ascending; then those again that have [other places](Self::split_teleports).
    pub(crate) bodies: Vec<u32>,
    /// Number of other places.
    pub(super) other_places: usize,
}

impl SliceBounds {
    /// Stands for the box of a body that does not exist in the slice, until it is [dropped](Self::drop_missing).
    pub(super) const MISSING: BodyBox = BodyBox {
        aabb: Aabb {
            mins: Vector::ZERO,
            maxs: Vector::ZERO,
        },
        body: u32::MAX,
    };

    #[inline(always)]
    pub(super) fn push(&mut self, body: u32, (fat_line, aabb): (FatLine, Aabb)) {
        let place = short(self.bodies.len());
        self.boxes.push(BodyBox { aabb, body: place });
        self.fat_lines.push(fat_line);
        self.bodies.push(body);
    }

    /// Returns the lists of boxes and fat lines of so many bodies, in chunks of a size. What they held is to be overwritten.
    pub(super) fn chunks(
        &mut self,
        bodies: usize,
        size: usize,
    ) -> impl Iterator<Item = (&mut [BodyBox], &mut [FatLine])> {
        self.boxes.resize(bodies, Self::MISSING);
        self.fat_lines.resize(bodies, FatLine::default());
        let boxes = self.boxes.chunks_mut(size);
        boxes.zip(self.fat_lines.chunks_mut(size))
    }

    /// Takes over the names of bodies, each with a box.
    pub(super) fn set_bodies(&mut self, bodies: &[u32]) {
        self.bodies.clear();
        self.bodies.extend_from_slice(bodies);
        self.other_places = 0;
    }

    /// Drops the bodies whose boxes are [missing](Self::MISSING).
    pub(super) fn drop_missing(&mut self) {
        let mut kept = 0;
        for place in 0..self.boxes.len() {
            let one = self.boxes[place];
            if one.body != Self::MISSING.body {
                let body = short(kept);
                self.boxes[kept] = BodyBox { body, ..one };
                self.fat_lines[kept] = self.fat_lines[place];
                self.bodies[kept] = self.bodies[place];
                kept += 1;
            }
        }
        self.boxes.truncate(kept);
        self.fat_lines.truncate(kept);
        self.bodies.truncate(kept);
    }

    /// Gives each body that teleports in the slice, that is, is told another place, a box for each of its places. `parts`
    /// returns the bounds there.
    pub(super) fn split_teleports(
        &mut self,
        parts: impl Fn(u32) -> ArrayVec<(FatLine, Aabb), MAX_PLACES>,
    ) {
        /// Bodies that tell how large most are.
        const SAMPLED: usize = 33;
        let stride = self.bodies.len().div_ceil(SAMPLED).max(1);
        let sampled = self.fat_lines.iter().zip(&self.bodies).step_by(stride);
        let radii = sampled.map(|(line, &body)| {
            // Most may teleport in one slice.
            let parts = if line.may_teleport() {
                parts(body)
            } else {
                ArrayVec::new()
            };
            let largest = parts.iter().map(|(line, _)| line.radius).reduce(f32::max);
            largest.unwrap_or(line.radius)
        });
        let mut radii: ArrayVec<f32, SAMPLED> = radii.collect();
        radii.sort_unstable_by(f32::total_cmp);
        // Ways that are no longer than most bodies are large are not worth another place.
        let least = radii
            .get(radii.len() / 2)
            .map_or(0.0, |median| 2.0 * median);
        for place in 0..self.bodies.len() {
            let (line, body) = (&self.fat_lines[place], self.bodies[place]);
            if line.radius > least && line.may_teleport() {
                let mut parts = parts(body).into_iter();
                let Some(first) = parts.next() else {
                    continue;
                };
                (self.fat_lines[place], self.boxes[place].aabb) = first;
                for part in parts {
                    self.push(body, part);
                    self.other_places += 1;
                }
            }
        }
    }

    /// Brings the bounds of bodies that turn and have long arms closer. `long_arms` returns their shapes.
    pub(super) fn tighten<'s>(
        &mut self,
        interval: (f64, f64),
        frame: &Frame,
        long_arms: impl Fn(u32) -> Option<BodyShape<'s>>,
    ) {
        let bounds = self.fat_lines.iter_mut().zip(&mut self.boxes);
        for ((line, one), &body) in bounds.zip(&self.bodies) {
            if let Some(shape) = long_arms(body) {
                tighten(shape, interval, frame, (line, &mut one.aabb));
            }
        }
    }

    /// Returns the bodies, each once, ascending.
    pub(super) fn each_body(&self) -> &[u32] {
        &self.bodies[..self.bodies.len() - self.other_places]
    }

    /// Returns how often a span may be found: once for each two places of a pair.
    pub(super) const fn copies_of_span(&self) -> usize {
        if self.other_places > 0 {
            MAX_PLACES * MAX_PLACES
        } else {
            1
        }
    }

    /// One body of so many is part of a sample, on average.
    pub(super) const ONE_IN: u32 = 8;

    /// Returns the boxes of a sample of the bodies, the same ones in every slice, whatever their order; without fat lines.
    pub(super) fn sample(&self) -> Self {
        // Multiples of the golden ratio fill the range of numbers evenly.
        let is_sampled = |body: u32| body.wrapping_mul(0x9E37_79B9) <= u32::MAX / Self::ONE_IN;
        let mut sample = Self::default();
        for (one, &body) in self.boxes.iter().zip(&self.bodies) {
            if is_sampled(body) {
                sample.push(body, (FatLine::default(), one.aabb));
            }
        }
        sample
    }
}

/// A few consecutive slices.
///
/// Bodies are walked one by one, each through all slices at once: its segments are read once.
#[derive(Clone, Debug, Default)]
pub(crate) struct SliceBlock {
    pub(crate) slices: Vec<SliceBounds>,
    /// The number of a cubic of each body: the first one in the block until the body is walked, then the last one.
    /// In the next block the search for the first one begins there.
    cubic_numbers: Vec<u32>,
    /// The end of the block (s), if it has been walked.
    end: Option<f64>,
}

impl SliceBlock {
    /// Returns the first slices, as they were left.
    pub(super) fn first_slices(&mut self, count: usize) -> &mut [SliceBounds] {
        if self.slices.len() < count {
            self.slices.resize_with(count, SliceBounds::default);
        }
        &mut self.slices[..count]
    }

    /// Forms the boxes and fat lines of one body in some slices, given their ends (s): see [`FormBounds`].
    pub(crate) fn form_one<C: BoundingCubic>(
        &mut self,
        frame: &MovingFrame,
        source: &CubicSource<'_, C>,
        ends: &[f64],
    ) {
        InstructionSet::best().run(FormBounds {
            block: self,
            frame,
            sources: from_ref(source),
            present: &[0],
            ends,
        });
    }

    /// Empties the first slices, and makes room for so many boxes in each.
    pub(super) fn clear(&mut self, count: usize, room: usize) {
        for slice in self.first_slices(count) {
            slice.boxes.clear();
            slice.fat_lines.clear();
            slice.bodies.clear();
            slice.other_places = 0;
            // At once: growing step by step would touch twice the memory. Some bodies may teleport.
            let room = room + room / 16;
            slice.boxes.reserve(room);
            slice.fat_lines.reserve(room);
            slice.bodies.reserve(room);
        }
    }
}

/// Forms the boxes and fat lines of some slices (at most [`SLICES_AT_A_TIME`]).
pub(super) struct FormBounds<'a, C> {
    pub(super) block: &'a mut SliceBlock,
    pub(super) frame: &'a MovingFrame,
    pub(super) sources: &'a [CubicSource<'a, C>],
    /// Numbers of bodies, ascending: includes each body that exists in one of the slices.
    pub(super) present: &'a [u32],
    /// Ends of the slices, s: one more than there are slices.
    pub(super) ends: &'a [f64],
}

impl<C: BoundingCubic> Task for FormBounds<'_, C> {
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

impl<'a, C: BoundingCubic> FormBounds<'a, C> {
    /// Prefetch distance in bodies. Their segments are most of the data, and scattered; without
    /// prefetching, half of the time is waiting.
    const AHEAD: usize = 4;

    #[inline(always)]
    fn form<const MOVES: bool>(
        mut self,
        slice_interval: impl Fn(f64, f64) -> SliceInterval<MOVES>,
    ) {
        let Self { ends, present, .. } = self;
        let count = ends.len() - 1;
        self.block.clear(count, present.len());
        let mut memory = [SliceInterval::UNUSED; SLICES_AT_A_TIME];
        let slice_intervals = slice_intervals_of(ends, slice_interval, &mut memory);
        let (from, to) = ends_of(slice_intervals);
        if self.block.end.replace(to) != Some(from) {
            let likely = self
                .sources
                .iter()
                .map(|source| likely_cubic(&source.knots, from));
            self.block.cubic_numbers.clear();
            self.block.cubic_numbers.extend(likely);
        }
        self.block.cubic_numbers.resize(self.sources.len(), 0);
        for number in 0..Self::AHEAD {
            self.find_first_cubic(number, slice_intervals);
        }
        for (number, &place) in present.iter().enumerate() {
            self.prefetch_knots(number + 2 * Self::AHEAD);
            let ahead = self.find_first_cubic(number + Self::AHEAD, slice_intervals);
            let body = place as usize;
            let source = &self.sources[body];
            let SliceBlock {
                slices,
                cubic_numbers,
                ..
            } = &mut *self.block;
            let first = || cubic_numbers[body] as usize;
            let mut put = |slice: usize, bounds| slices[slice].push(place, bounds);
            if let Some(last) = walk(source, slice_intervals, (ahead, first), &mut put) {
                cubic_numbers[body] = short(last);
            }
        }
    }

    /// Prefetches the knots of a body, given its number among those present.
    #[inline(always)]
    fn prefetch_knots(&self, number: usize) {
        if let Some(&place) = self.present.get(number) {
            let first = self.block.cubic_numbers[place as usize] as usize;
            self.sources[place as usize].knots.prefetch(first, 8);
        }
    }

    /// Finds the first cubic of a body, given its number among those present. Prefetches the runs
    /// of cubics that the body will use. If it will use few runs, returns its cubics for
    /// prefetching during another body's walk.
    #[inline(always)]
    fn find_first_cubic<const MOVES: bool>(
        &mut self,
        number: usize,
        slice_intervals: &[SliceInterval<MOVES>],
    ) -> PrefetchTarget<'a, C> {
        let &place = self.present.get(number)?;
        let source = &self.sources[place as usize];
        let number_of_cubic = &mut self.block.cubic_numbers[place as usize];
        let first = cubic_before(&source.knots, slice_intervals[0].from, *number_of_cubic);
        *number_of_cubic = short(first);
        if !goes_in_runs(source, slice_intervals) {
            return Some((source, first.wrapping_sub(source.knots.before())));
        }
        if exists(source, slice_intervals) {
            fetch_route(source, slice_intervals, first);
        }
        None
    }
}

/// Returns true if a body usually passes so many cubics in a slice that they form runs.
#[inline(always)]
fn goes_in_runs<C: BoundingCubic, const MOVES: bool>(
    source: &CubicSource<'_, C>,
    slice_intervals: &[SliceInterval<MOVES>],
) -> bool {
    let (first, last) = source.knots.ends();
    let (from, to) = ends_of(slice_intervals);
    let [cubics, runs] = [
        source.knots.cubics(),
        2 * CubicRun::SIZE * slice_intervals.len(),
    ]
    .map(as_f64);
    source.is_in_runs() && cubics * (to - from) > runs * (last - first)
}

/// Prefetches the data of a walk through the slices, from a cubic on.
#[inline(always)]
fn fetch_route<C: BoundingCubic, const MOVES: bool>(
    source: &CubicSource<'_, C>,
    slice_intervals: &[SliceInterval<MOVES>],
    mut number: usize,
) {
    source.fetch(number);
    for slice_interval in slice_intervals {
        let end = cubic_at::<false>(&source.knots, slice_interval.to, number);
        let mut next = number + 1;
        while next < end {
            next = source.fetch_first(next, end);
        }
        source.fetch(end);
        number = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::{CompactTrajectory, DAabb, Frame, Padding};
    use crate::hitbox::Hitbox;
    use crate::knots::Knots;
    use crate::search::TimeSlices;
    use crate::trajectory::{State, Trajectory};
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Every box and fat line contains its body in its slice, and is not much larger.
    #[test]
    fn boxes_contain_their_bodies() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut tightest = f64::INFINITY;
        let still = Frame::around(DAabb::NOTHING, 0.0);
        let slices = TimeSlices::whole(-1.0, 12.0).with_count(19.0);
        let hitbox = Hitbox::POINT;
        let padding = Padding::of(&hitbox, 0.0, &still);
        for seed in 0..200 {
            let far = if seed % 2 == 0 { 10.0 } else { 1e6 };
            // Boxes stay, or move with some of the bodies' velocity, or faster.
            let common = match seed % 3 {
                0 => 0.0,
                1 => 20.0,
                _ => 300.0,
            };
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
            let base = vector(far);
            let common = vector(20.0).normalize() * common;
            let frame = still.moving(common);
            // Knots on cuts (0.684...), off cuts, and many in one slice.
            let gap = if seed % 3 == 0 {
                13.0 / 19.0
            } else {
                0.3 + f64::from(seed) * 0.01
            };
            // Some so many that slices hold runs of cubics of runs of cubics.
            let (gap, count) = if seed % 4 == 1 {
                (gap / 25.0, 225)
            } else {
                (gap, 9)
            };
            let states: Vec<State> = (0..count)
                .map(|k| {
                    let time = -1.0 + gap * f64::from(k);
                    State::new(time, base + vector(5.0), vector(20.0))
                })
                .collect();
            let Ok(trajectory) = Trajectory::from_states(&states) else {
                unreachable!("the states are in order")
            };
            let (compact, cache_lines) =
                CompactTrajectory::of(trajectory.knots(), trajectory.segments());
            let source = CubicSource::compact(
                Knots::of(trajectory.knots()),
                &compact.on(&cache_lines),
                &padding,
                &frame,
            );
            let mut block = SliceBlock::default();
            let mut ends = Vec::new();
            for first in (0..slices.count()).step_by(8) {
                let range = first..(first + 8).min(slices.count());
                slices.ends(range.clone(), &mut ends);
                block.form_one(&frame, &source, &ends);
                for (slice, found) in range.zip(&block.slices) {
                    let boxes = &found.boxes;
                    let (from, to) = slices.interval(slice);
                    let mut sampled = DAabb::NOTHING;
                    for step in 0..=50 {
                        let share = f64::from(step) / 50.0;
                        let time = (from + (to - from) * share).min(to);
                        if let Some(position) = trajectory.position(time) {
                            let fat_line = &found.fat_lines[0];
                            let [start, change] = [fat_line.start, fat_line.change]
                                .map(|lanes| DVec3::from_array(lanes.map(f64::from)));
                            let deviation = (position - (start + share * change)).length();
                            assert!(
                                deviation <= f64::from(fat_line.radius),
                                "{deviation} {fat_line:?}"
                            );
                            tightest = tightest.min(f64::from(fat_line.radius) - deviation);
                            let position = position - common * (time - from);
                            sampled.include(DAabb::of_point(position));
                        }
                    }
                    assert_eq!(boxes.is_empty(), sampled.low.x > sampled.high.x);
                    for found in boxes {
                        let low = DVec3::from_array(found.aabb.mins.to_array().map(f64::from));
                        let high = DVec3::from_array(found.aabb.maxs.to_array().map(f64::from));
                        assert!(low.cmplt(sampled.low).all() && high.cmpgt(sampled.high).all());
                        // The hull of a cubic's Bézier points reaches a bit beyond it.
                        let way = common.abs().max_element() * (to - from);
                        assert!((high - low).max_element() < 120.0 + way);
                    }
                }
            }
        }
        // The radius is that of the farthest control point, and seldom far from what is needed.
        assert!(tightest < 0.05, "{tightest}");
    }
}
