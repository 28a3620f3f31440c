//! The closest approach of many pairs: guess, prove, try again, and finally branch and bound.

use super::batch::Lanes;
use super::loops::{
    BLOCK, EnclosureBlock, LaneBlock, enclose_block_finely, guess_block, guess_block_again,
    guess_pair, halves_of_pair,
};
use super::pending::{Places, RetryQueue, is_positive, whole_vectors};
use crate::enclosure::UncertainCubic;
use crate::guess::{
    ControlPoints, QUICK, THOROUGH, distance, in_f64, largest_coordinate, local_time, normalised,
    polygon, refined,
};
use crate::real::Real;
use crate::simd::InstructionSet;

pub(super) fn closest_approach_of<R: Real>(points: &ControlPoints<R>) -> (R, R) {
    let found = guess_pair(InstructionSet::best(), points);
    if is_positive(found.certificate) {
        return (
            local_time(found.settled.time),
            distance(found.settled.square),
        );
    }
    let (wide, unit) = normalised(&in_f64(points));
    let error = allowance::<R>(&wide);
    let mut nearest = refined(&wide, local_time(found.settled.time).to_f64(), QUICK);
    let (halves, tight) = halves_of_pair(&wide, error, nearest.0);
    if is_wide(tight) {
        nearest = searched(&wide, nearest.0, halves, error);
    }
    (R::from_f64(nearest.0), R::from_f64(nearest.1 * unit))
}

/// Returns true if an enclosure is not tight, but false if its numbers left the range: those of a polygon
/// that is [`normalised`] do only if it is all zero, or not finite.
#[inline]
fn is_wide(tight: f64) -> bool {
    tight == 0.0
}

/// Returns the closest approach of one pair by branch and bound from a good time on. `halves` are lower
/// bounds of the squared distance on the halves of both sides of that.
fn searched(points: &ControlPoints<f64>, time: f64, halves: [f64; 4], error: f64) -> (f64, f64) {
    let cubic = UncertainCubic::finite(polygon(points), error);
    refined(points, cubic.least_parameter(time, halves), THOROUGH)
}

/// Returns the error of a cubic, m, for which an enclosure is as tight as the lanes' type can tell;
/// a quarter of it may be missing (`src/enclosure`, section 5).
#[inline]
fn allowance<R: Real>(points: &ControlPoints<f64>) -> f64 {
    if R::IS_SINGLE {
        8.0 * R::ROUNDING.to_f64() * largest_coordinate(points)
    } else {
        0.0
    }
}

/// The work of one call of [`closest_approach`].
struct ClosestBatch<'a, R> {
    instructions: InstructionSet,
    lanes: Lanes<'a, R>,
    times: &'a mut [R],
    distances: &'a mut [R],
    block: LaneBlock<R>,
    /// Pairs not certified at the first try: their numbers, count, cubics and times.
    pairs: [usize; BLOCK],
    count: usize,
    second: LaneBlock<R>,
    /// Pairs not certified at the second try, [`normalised`], in f64: refined time and distance,
    /// [`allowance`], and the unit.
    third: RetryQueue<f64, 4>,
}

/// Computes the closest approach of each pair: local times in 0..=1, distances in metres.
///
/// The distance is the global minimum over the span up to rounding: some 1e-15 (f64) or 1e-6 (f32)
/// of the size of the polygon. If there are several equal minima, or the distance is constant, any one
/// of the times may be reported. At a flat minimum the time has an error of the order of the
/// square root of the rounding. The bits are the same with every instruction set.
///
/// # Panics
///
/// If the slices do not have one entry for each pair.
pub fn closest_approach<R: Real>(
    instructions: InstructionSet,
    lanes: &Lanes<'_, R>,
    times: &mut [R],
    distances: &mut [R],
) {
    assert_eq!(lanes.len(), times.len(), "one time for each pair");
    assert_eq!(lanes.len(), distances.len(), "one distance for each pair");
    let mut work = ClosestBatch {
        instructions,
        lanes: *lanes,
        times,
        distances,
        block: LaneBlock::new(),
        pairs: [0; BLOCK],
        count: 0,
        second: LaneBlock::new(),
        third: RetryQueue::new(),
    };
    for start in (0..lanes.len()).step_by(BLOCK) {
        work.guess(start, (start + BLOCK).min(lanes.len()));
    }
    work.guess_again();
    work.prove();
}

impl<R: Real> ClosestBatch<'_, R> {
    /// Makes the first try for a part of the batch.
    fn guess(&mut self, start: usize, end: usize) {
        let mut certificates = [0.0; BLOCK];
        let certificates = &mut certificates[..end - start];
        let part = self.lanes.range(start, end);
        guess_block(
            self.instructions,
            &mut self.block,
            &part,
            &mut self.times[start..end],
            &mut self.distances[start..end],
            certificates,
        );
        for place in Places::of(certificates, |&certificate| !is_positive(certificate)) {
            self.pairs[self.count] = start + place;
            self.second.take(self.count, &self.block, place);
            self.count += 1;
            if self.count == BLOCK {
                self.guess_again();
            }
        }
    }

    /// Makes the second try, against the rivals of the first guesses.
    fn guess_again(&mut self) {
        let width = whole_vectors::<R>(self.count);
        let mut found = [[R::default(); BLOCK]; 2];
        let [times, distances] = found.each_mut().map(|slot| &mut slot[..width]);
        let mut certificates = [0.0; BLOCK];
        let certificates = &mut certificates[..width];
        guess_block_again(
            self.instructions,
            &mut self.second,
            times,
            distances,
            certificates,
        );
        for i in 0..self.count {
            let pair = self.pairs[i];
            if !self.second.stays(i) {
                (self.times[pair], self.distances[pair]) = (times[i], distances[i]);
            }
            if is_positive(certificates[i]) {
                continue;
            }
            let (wide, unit) = normalised(&in_f64(&self.lanes.control_points(pair)));
            let (time, distance) = refined(&wide, self.times[pair].to_f64(), QUICK);
            self.third
                .push(pair, wide, [time, distance, allowance::<R>(&wide), unit]);
            if self.third.is_full() {
                self.prove();
            }
        }
        self.count = 0;
    }

    /// Makes the third try: quarters of both sides of the refined time, then branch and bound.
    fn prove(&mut self) {
        let mut bounds = EnclosureBlock::new();
        let lanes = self.third.lanes();
        let [times, distances, errors, units] = self.third.extras();
        enclose_block_finely(self.instructions, &lanes, errors, times, &mut bounds);
        for i in 0..self.third.len() {
            let (mut time, mut distance) = (times[i], distances[i]);
            if is_wide(bounds.tight[i]) {
                let points = self.third.control_points(i);
                (time, distance) = searched(&points, time, bounds.halves(i), errors[i]);
            }
            let pair = self.third.pair(i);
            self.times[pair] = R::from_f64(time);
            self.distances[pair] = R::from_f64(distance * units[i]);
        }
        self.third.clear();
    }
}
