//! The walk of one body through a few slices.

use crate::bounds::{BoundingCubic, BoundsBuilder, CubicSource, FatLine, SliceInterval, SubCubic};
use crate::count::{as_f64, short, whole};
use crate::knots::Knots;
use parry3d::bounding_volume::Aabb;

/// Largest number of slices that are walked together: each list may be as long as the longest.
pub(crate) const SLICES_AT_A_TIME: usize = 32;

/// Returns the intervals of some slices, given their ends (s), in the memory of an array.
#[inline(always)]
pub(super) fn slice_intervals_of<'m, const MOVES: bool>(
    ends: &[f64],
    slice_interval: impl Fn(f64, f64) -> SliceInterval<MOVES>,
    memory: &'m mut [SliceInterval<MOVES>; SLICES_AT_A_TIME],
) -> &'m [SliceInterval<MOVES>] {
    for (place, ends) in memory.iter_mut().zip(ends.windows(2)) {
        *place = slice_interval(ends[0], ends[1]);
    }
    &memory[..ends.len() - 1]
}

/// Calls `put` with each slice in which a body exists, by number, and the bounds there. Returns the body's last cubic
/// there, or `None` if it was not looked for. `first` returns the first one.
#[inline(always)]
pub(super) fn walk<'a, C: BoundingCubic, const MOVES: bool>(
    source: &'a CubicSource<'a, C>,
    slice_intervals: &'a [SliceInterval<MOVES>],
    (ahead, first): (PrefetchTarget<'a, C>, impl FnOnce() -> usize),
    put: &mut impl FnMut(usize, (FatLine, Aabb)),
) -> Option<usize> {
    if !exists(source, slice_intervals) {
        return None;
    }
    if let Some(pieces) = source.straight_from(slice_intervals[0].from) {
        for (slice, slice_interval) in slice_intervals.iter().enumerate() {
            put(slice, pieces.bounds(slice_interval));
        }
        return None;
    }
    let first = first();
    Some(if source.knots.has_unlisted_cubics() {
        BodyWalk::<_, _, true>::new(source, slice_intervals, ahead, first).through_extended(put)
    } else {
        BodyWalk::<_, _, false>::new(source, slice_intervals, ahead, first).through(put)
    })
}

/// Returns the beginning and end of a block, s.
#[inline(always)]
pub(super) fn ends_of<const MOVES: bool>(slice_intervals: &[SliceInterval<MOVES>]) -> (f64, f64) {
    (
        slice_intervals[0].from,
        slice_intervals[slice_intervals.len() - 1].to,
    )
}

/// Returns true if a body exists in a block.
#[inline(always)]
pub(super) fn exists<C, const MOVES: bool>(
    source: &CubicSource<'_, C>,
    slice_intervals: &[SliceInterval<MOVES>],
) -> bool {
    let (first, last) = source.knots.ends();
    let (from, to) = ends_of(slice_intervals);
    first <= to && last >= from
}

/// Returns the cubic that is passed at an instant (s) if all of a plan's cubics last equally long.
#[inline(always)]
pub(super) fn likely_cubic(knots: &Knots<'_>, time: f64) -> u32 {
    let (first, last) = knots.ends();
    whole((time - first) / (last - first) * as_f64(knots.cubics()))
}

/// Returns the last cubic that begins before `time` (or the first), searched from a guess.
#[inline(always)]
pub(super) fn cubic_before(knots: &Knots<'_>, time: f64, guess: u32) -> usize {
    /// Linear steps before the search halves the rest.
    const STEPS: usize = 8;
    if knots.has_unlisted_cubics() {
        return knots.count(|knot| knot < time).max(1) - 1;
    }
    let knots = knots.own();
    let mut cubic = (guess as usize).min(knots.len().saturating_sub(1));
    if knots.get(cubic).is_some_and(|&knot| knot < time) {
        for _ in 0..STEPS {
            if knots.get(cubic + 1).is_none_or(|&knot| knot >= time) {
                return cubic;
            }
            cubic += 1;
        }
        cubic + knots[cubic + 1..].partition_point(|&knot| knot < time)
    } else {
        for _ in 0..STEPS {
            cubic = cubic.saturating_sub(1);
            if cubic == 0 || knots[cubic] < time {
                return cubic;
            }
        }
        knots[..cubic].partition_point(|&knot| knot < time).max(1) - 1
    }
}

/// Returns the last cubic that begins by `time`, from one that begins before it. Slices are closed:
/// a cubic that begins at the slice's end counts with its first point.
#[inline(always)]
pub(super) fn cubic_at<const UNLISTED: bool>(knots: &Knots<'_>, time: f64, number: usize) -> usize {
    /// Knots passed at once.
    const STEP: usize = 4;
    if UNLISTED {
        let later = (number + 1..knots.cubics()).take_while(|&next| knots.at(next) <= time);
        return number + later.count();
    }
    let knots = knots.own();
    let mut rest = &knots[number + 1..knots.len() - 1];
    while let Some((step, further)) = rest.split_first_chunk::<STEP>()
        && step[STEP - 1] <= time
    {
        rest = further;
    }
    let passed = rest.iter().take_while(|&&knot| knot <= time).count();
    knots.len() - 2 - rest.len() + passed
}

/// The walk of one body through the slices of a block.
struct BodyWalk<'a, C, const MOVES: bool, const UNLISTED: bool> {
    source: &'a CubicSource<'a, C>,
    slice_intervals: &'a [SliceInterval<MOVES>],
    ahead: PrefetchTarget<'a, C>,
    begin: usize,
}

/// A later body and the first of its plan's cubics to prefetch: one for each of this body's.
/// None: nothing to prefetch.
pub(super) type PrefetchTarget<'a, C> = Option<(&'a CubicSource<'a, C>, usize)>;

impl<'a, C: BoundingCubic, const MOVES: bool, const UNLISTED: bool>
    BodyWalk<'a, C, MOVES, UNLISTED>
{
    #[inline(always)]
    const fn new(
        source: &'a CubicSource<'a, C>,
        slice_intervals: &'a [SliceInterval<MOVES>],
        ahead: PrefetchTarget<'a, C>,
        begin: usize,
    ) -> Self {
        Self {
            source,
            slice_intervals,
            ahead,
            begin,
        }
    }

    #[inline(always)]
    fn sub_cubic(&self, number: usize) -> SubCubic {
        if let Some((later, first)) = self.ahead {
            if number == self.begin {
                later.fetch(first);
            }
            // One more: it may go through more cubics than this one.
            later.fetch(first.wrapping_add(number - self.begin + 1));
        }
        self.source.sub_cubic::<UNLISTED>(number)
    }

    /// Adds the cubics from `next` to before `end` to a builder.
    #[inline(always)]
    fn follow_whole(&self, builder: &mut BoundsBuilder<MOVES>, mut next: usize, end: usize) {
        while next < end {
            if let Some(after) = self.source.pass::<MOVES, UNLISTED>(builder, (next, end)) {
                next = after;
            } else {
                builder.follow_from_start(&self.sub_cubic(next));
                next += 1;
            }
        }
    }

    #[inline(never)]
    fn through_extended(&self, put: &mut impl FnMut(usize, (FatLine, Aabb))) -> usize {
        self.through(put)
    }

    /// Calls `put` with each slice in which the body exists, and the bounds there; returns its last cubic.
    #[inline(always)]
    fn through(&self, put: &mut impl FnMut(usize, (FatLine, Aabb))) -> usize {
        let Self {
            source,
            slice_intervals,
            begin: mut number,
            ..
        } = *self;
        let knots = &source.knots;
        let (first, last) = knots.ends();
        let mut rest = self.sub_cubic(number);
        if knots.at(number) < slice_intervals[0].from {
            rest = rest.split(slice_intervals[0].from).1;
        }
        for (slice, slice_interval) in slice_intervals.iter().enumerate() {
            if first > slice_interval.to || last < slice_interval.from {
                continue;
            }
            let begin = number;
            number = cubic_at::<UNLISTED>(knots, slice_interval.to, number);
            let builder = if number == begin {
                let (piece, after) = rest.split(slice_interval.to.min(rest.end()));
                rest = after;
                if piece.fills(slice_interval) {
                    BoundsBuilder::alone(&piece, slice_interval)
                } else {
                    BoundsBuilder::between(&piece, &piece, slice_interval)
                }
            } else {
                let head = rest;
                let whole = self.sub_cubic(number);
                let (tail, after) = whole.split(slice_interval.to.min(whole.end()));
                rest = after;
                let mut builder = BoundsBuilder::between(&head, &tail, slice_interval);
                self.follow_whole(&mut builder, begin + 1, number);
                builder.follow_from_start(&tail);
                builder
            };
            put(slice, builder.finish(&source.placement, short(begin)));
        }
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn the_first_cubic_is_found_from_any_guess() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for round in 0..2_000 {
            let count = [2, 3, 9, 40, 300][round % 5];
            // Evenly spread, or nearly all at one end.
            let power = [1, 4][round % 2];
            let mut times: Vec<f64> = (0..count)
                .map(|_| rng.random_range(-1.0_f64..1.0).powi(power))
                .collect();
            times.sort_unstable_by(f64::total_cmp);
            times.dedup();
            let knots = Knots::of(&times);
            let between = rng.random_range(-1.5..1.5);
            for time in [times[rng.random_range(0..times.len())], between] {
                let before = times.partition_point(|&knot| knot < time);
                let far = [0, rng.random_range(0..400), u32::MAX];
                for guess in far.into_iter().chain([likely_cubic(&knots, time)]) {
                    let found = cubic_before(&knots, time, guess);
                    assert_eq!(found, before.max(1) - 1, "{time} {guess} {times:?}");
                }
            }
        }
    }
}
