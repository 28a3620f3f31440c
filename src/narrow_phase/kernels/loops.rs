//! The loops over the lanes of a block, in the form that the compiler turns into vectors.
//!
//! Long computations go in stages, each a loop of its own: the processor then works on several
//! short dependency chains at once instead of one long one, and loops of `f32` alone have twice
//! the lanes. The number of pairs is cut to the size of a block before each loop, so
//! that no bounds check is left in it: a check makes the last vector of every block scalar.
#![allow(
    clippy::needless_range_loop,
    reason = "many slices with one index is what is vectorised, and what is easiest to read"
)]

use super::batch::Lanes;
use super::certificate::{Guess, certify, guess};
use super::rival::{self, certify_against, choose_minimum, guess_against_rival};
use crate::blossom::ControlPolygon;
use crate::enclosure::{
    DistanceEnclosure, Minorant, enclosure, from_nearer, part_error, reversed, split, target,
};
use crate::guess::{
    CentredCubic, ControlPoints, HalleyStep, LaneSquaredDistance, Vector, arrive, coordinates,
    descend, descend_safely, distance, dot, halley_step, largest_of, local_time, lowest_sample,
    polish, polygon, settle, squared_distance,
};
use crate::real::Real;
use crate::simd::{InstructionSet, for_each_instruction_set};

/// Pairs in a block. Small enough for the first-level cache, a multiple of 16 lanes, and not a
/// power of two, which would make the columns compete for the same cache sets: 128 made the guesses
/// 5 % slower in `f64` and 13 % in `f32`.
pub(super) const BLOCK: usize = 96;

/// Results of the stages of a guess; aligned so that no vector straddles two cache lines.
#[repr(align(64))]
#[derive(Debug)]
pub(super) struct LaneBlock<R> {
    cubics: Columns<R>,
    rough: Columns<f32>,
    squares: [[f32; BLOCK]; 7],
    tolerances: [f32; BLOCK],
    times: [f32; BLOCK],
    /// Slopes, steps and errors of Halley's method.
    steps: [[R; BLOCK]; 3],
    tolerance_factors: [f32; BLOCK],
    /// Second try: the times of the first try, and the fields of [`rival::MinimumChoice`].
    firsts: [f32; BLOCK],
    rivals: [f32; BLOCK],
    stays: [f32; BLOCK],
}

impl<R: Real> LaneBlock<R> {
    pub(super) fn new() -> Self {
        Self {
            cubics: [[[R::default(); BLOCK]; 3]; 4],
            rough: [[[0.0; BLOCK]; 3]; 4],
            squares: [[0.0; BLOCK]; 7],
            tolerances: [0.0; BLOCK],
            times: [0.0; BLOCK],
            steps: [[R::default(); BLOCK]; 3],
            tolerance_factors: [0.0; BLOCK],
            firsts: [0.0; BLOCK],
            rivals: [0.0; BLOCK],
            stays: [0.0; BLOCK],
        }
    }

    #[inline(always)]
    fn squared_distance(&self, i: usize) -> LaneSquaredDistance {
        LaneSquaredDistance {
            square: self.square(i),
            tolerance: self.tolerances[i],
        }
    }

    #[inline(always)]
    fn square(&self, i: usize) -> [f32; 7] {
        let [a0, a1, a2, a3, a4, a5, a6] = &self.squares;
        [a0[i], a1[i], a2[i], a3[i], a4[i], a5[i], a6[i]]
    }

    /// First stage of a guess: fills in cubics and squared distances.
    #[inline(always)]
    fn fill(&mut self, lanes: &Lanes<'_, R>, count: usize) {
        let lanes = lanes.first(count);
        if R::IS_SINGLE {
            for i in 0..count {
                let cubic = CentredCubic::new(lanes.control_points(i));
                set(&mut self.cubics, i, &cubic.coefficients);
                self.set_square(i, &squared_distance::<R>(&cubic.rough()));
            }
            return;
        }
        for i in 0..count {
            let cubic = CentredCubic::new(lanes.control_points(i));
            set(&mut self.cubics, i, &cubic.coefficients);
        }
        self.expand_cubics(count);
    }

    /// Computes the squared distances of the cubics.
    #[inline(always)]
    fn expand_cubics(&mut self, count: usize) {
        let count = count.min(BLOCK);
        // A loop that converts and computes would be as wide as the wider type.
        for (rough, column) in self
            .rough
            .iter_mut()
            .flatten()
            .zip(self.cubics.iter().flatten())
        {
            for i in 0..count {
                rough[i] = column[i].to_f32();
            }
        }
        for i in 0..count {
            self.set_square(i, &squared_distance::<R>(&get_cubic(&self.rough, i)));
        }
    }

    /// Copies the cubic, the time and the factor on the tolerance of a pair of another block.
    #[inline(always)]
    pub(super) fn take(&mut self, i: usize, from: &Self, place: usize) {
        for (column, other) in self.cubics.iter_mut().zip(&from.cubics) {
            for (slot, other) in column.iter_mut().zip(other) {
                slot[i] = other[place];
            }
        }
        self.firsts[i] = from.times[place];
        self.tolerance_factors[i] = from.tolerance_factors[place];
    }

    /// Returns true if the second try kept the guess of the first.
    #[inline(always)]
    pub(super) fn stays(&self, i: usize) -> bool {
        self.stays[i] > 0.0
    }

    #[inline(always)]
    fn set_square(&mut self, i: usize, squared_distance: &LaneSquaredDistance) {
        let mut k = 0;
        while k < 7 {
            self.squares[k][i] = squared_distance.square[k];
            k += 1;
        }
        self.tolerances[i] = squared_distance.tolerance;
    }

    /// Second and third stage of a first guess: computes a rough time for each pair.
    #[inline(always)]
    fn descend(&mut self, count: usize) {
        let count = count.min(BLOCK);
        for i in 0..count {
            self.times[i] = lowest_sample(&self.square(i));
        }
        for i in 0..count {
            self.times[i] = descend(&self.square(i), self.times[i], R::STEPS);
        }
    }

    /// Fourth stage: turns centred `times` into times, distances, and times for the certificates.
    #[inline(always)]
    fn settle(&mut self, times: &mut [R], distances: &mut [R]) {
        let count = times.len().min(BLOCK);
        let (times, distances) = (&mut times[..count], &mut distances[..count]);
        let [slopes, lengths, errors] = &mut self.steps;
        // In two loops: what comes after the division is long, and would fill the processor's
        // queues while it waits.
        for i in 0..count {
            let found = halley_step(&get_cubic(&self.cubics, i).derivatives(times[i]));
            slopes[i] = found.slope;
            lengths[i] = found.step;
            errors[i] = found.error;
        }
        for i in 0..count {
            let step = HalleyStep {
                slope: slopes[i],
                step: lengths[i],
                error: errors[i],
            };
            let found = arrive(&get_cubic(&self.cubics, i), times[i], &step);
            self.times[i] = found.time.to_f32();
            self.tolerance_factors[i] = found.tolerance_factor;
            times[i] = local_time(found.time);
            distances[i] = found.square;
        }
        // Apart, so that the certificates need not wait for the roots, nor these for the divisions.
        for i in 0..count {
            distances[i] = distance(distances[i]);
        }
    }

    /// Returns the rough centred time of a pair.
    #[inline(always)]
    fn time(&self, i: usize) -> R {
        R::from_f64(f64::from(self.times[i]))
    }
}

/// Four vectors for each pair of a block.
type Columns<R> = [[[R; BLOCK]; 3]; 4];

#[inline(always)]
fn get<R: Real>([c0, c1, c2, c3]: &Columns<R>, i: usize) -> [Vector<R>; 4] {
    [
        [c0[0][i], c0[1][i], c0[2][i]],
        [c1[0][i], c1[1][i], c1[2][i]],
        [c2[0][i], c2[1][i], c2[2][i]],
        [c3[0][i], c3[1][i], c3[2][i]],
    ]
}

#[inline(always)]
fn get_cubic<R: Real>(columns: &Columns<R>, i: usize) -> CentredCubic<R> {
    CentredCubic {
        coefficients: get(columns, i),
    }
}

#[inline(always)]
fn set<R: Real>(columns: &mut Columns<R>, i: usize, vectors: &[Vector<R>; 4]) {
    let mut k = 0;
    while k < 4 {
        columns[k][0][i] = vectors[k][0];
        columns[k][1][i] = vectors[k][1];
        columns[k][2][i] = vectors[k][2];
        k += 1;
    }
}

#[repr(align(64))]
#[derive(Debug)]
pub(super) struct EnclosureBlock {
    pub(super) times: [f64; BLOCK],
    pub(super) lows: [f64; BLOCK],
    pub(super) highs: [f64; BLOCK],
    /// 1 if the enclosure is as tight as the error of the cubic allows, 0 if it is wider, -1 or NaN
    /// if the numbers left the range.
    pub(super) tight: [f64; BLOCK],
    /// Squared distance at the split.
    squares: [f64; BLOCK],
    /// Lower bounds of it on the halves of both sides of the split, in their order, if quarters were bounded.
    halves: [[f64; BLOCK]; 4],
}

impl EnclosureBlock {
    pub(super) fn new() -> Self {
        Self {
            times: [0.0; BLOCK],
            lows: [0.0; BLOCK],
            highs: [0.0; BLOCK],
            tight: [0.0; BLOCK],
            squares: [0.0; BLOCK],
            halves: [[0.0; BLOCK]; 4],
        }
    }

    pub(super) fn halves(&self, i: usize) -> [f64; 4] {
        self.halves.each_ref().map(|half| half[i])
    }
}

for_each_instruction_set! {
    /// Guesses the closest approach of one pair.
    fn guess_pair<R: Real>(points: &ControlPoints<R>) -> Guess<R> {
        let found = guess(*points);
        if found.certificate > 0.0 {
            return found;
        }
        guess_against_rival(*points, found)
    }
}

for_each_instruction_set! {
    /// Guesses the closest approach of each pair of a block.
    fn guess_block<R: Real>(
        block: &mut LaneBlock<R>,
        lanes: &Lanes<'_, R>,
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [f32],
    ) {
        let count = times.len().min(BLOCK);
        let certificates = &mut certificates[..count];
        block.fill(lanes, count);
        block.descend(count);
        let times = &mut times[..count];
        for i in 0..count {
            times[i] = block.time(i);
        }
        block.settle(times, distances);
        for i in 0..count {
            certificates[i] = certify(&block.squared_distance(i), block.times[i], block.tolerance_factors[i]);
        }
    }
}

for_each_instruction_set! {
    /// Guesses again from the first guesses of a block, and proves against the rival.
    fn guess_block_again<R: Real>(
        block: &mut LaneBlock<R>,
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [f32],
    ) {
        let count = times.len().min(BLOCK);
        let certificates = &mut certificates[..count];
        block.expand_cubics(count);
        for i in 0..count {
            let choice = choose_minimum(&block.squared_distance(i), block.firsts[i], block.tolerance_factors[i]);
            block.times[i] = choice.start;
            block.rivals[i] = choice.rival;
            block.stays[i] = choice.stays;
        }
        for i in 0..count {
            block.times[i] = descend_safely(&block.square(i), block.times[i], rival::STEPS);
        }
        let times = &mut times[..count];
        for i in 0..count {
            times[i] = polish(&get_cubic(&block.cubics, i), block.time(i));
        }
        block.settle(times, distances);
        for i in 0..count {
            let squared_distance = block.squared_distance(i);
            let (mut time, mut tolerance_factor) = (block.times[i], block.tolerance_factors[i]);
            if block.stays[i] > 0.0 {
                (time, tolerance_factor) = (block.firsts[i], block.stays[i]);
            }
            certificates[i] = certify_against(&squared_distance, time, block.rivals[i], tolerance_factor);
        }
    }
}

for_each_instruction_set! {
    /// Encloses the least distance of each pair of a block, from one split at the guess.
    fn enclose_block(
        block: &mut LaneBlock<f64>,
        lanes: &Lanes<'_, f64>,
        errors: &[f64],
        bounds: &mut EnclosureBlock,
    ) {
        let count = errors.len().min(BLOCK);
        let (lanes, errors) = (lanes.first(count), &errors[..count]);
        block.fill(&lanes, count);
        block.descend(count);
        for i in 0..count {
            let found = settle(&get_cubic(&block.cubics, i), block.time(i));
            bounds.times[i] = local_time(found.time);
        }
        // The cubics have served; their place takes the part after the split, which would cost more to
        // form anew.
        for i in 0..count {
            let [before, after] = split(&polygon(&lanes.control_points(i)), bounds.times[i]);
            let minorant = Minorant::of(&before);
            bounds.lows[i] = minorant.lower();
            bounds.squares[i] = minorant.base;
            set(&mut block.cubics, i, &coordinates(&after));
        }
        for i in 0..count {
            bounds.highs[i] = Minorant::of(&polygon(&get(&block.cubics, i))).lower();
        }
        finish_bounds(&lanes, errors, bounds, 0.0);
    }
}

for_each_instruction_set! {
    /// Encloses the least distance of each pair of a block, from a split at given times and
    /// quarters of both sides.
    fn enclose_block_finely(
        lanes: &Lanes<'_, f64>,
        errors: &[f64],
        times: &[f64],
        bounds: &mut EnclosureBlock,
    ) {
        let count = errors.len().min(BLOCK);
        let (lanes, errors, times) = (lanes.first(count), &errors[..count], &times[..count]);
        bounds.times[..count].copy_from_slice(times);
        // A half at a time: more than that the registers do not hold.
        for i in 0..count {
            let [before, _] = split(&polygon(&lanes.control_points(i)), times[i]);
            bounds.squares[i] = before[0].length_squared();
            bounds.halves[1][i] = lower_near(&before);
        }
        for i in 0..count {
            let [before, _] = split(&polygon(&lanes.control_points(i)), times[i]);
            bounds.halves[0][i] = lower_far(&before);
        }
        for i in 0..count {
            let [_, after] = split(&polygon(&lanes.control_points(i)), times[i]);
            bounds.halves[2][i] = lower_near(&after);
        }
        for i in 0..count {
            let [_, after] = split(&polygon(&lanes.control_points(i)), times[i]);
            bounds.halves[3][i] = lower_far(&after);
        }
        let [a, b, c, d] = &bounds.halves;
        for i in 0..count {
            bounds.lows[i] = a[i].min_or_other(b[i]);
            bounds.highs[i] = c[i].min_or_other(d[i]);
        }
        finish_bounds(&lanes, errors, bounds, 2.0);
    }
}

/// Returns a lower bound of the squared distance on the first half of a side, from its quarters.
#[inline(always)]
fn lower_near(side: &ControlPolygon) -> f64 {
    let [near, _] = split(side, 0.5);
    let [first, second] = split(&near, 0.5);
    // Counted from its own end, the near half begins in the middle of the side.
    lower_of_both(&from_nearer(&first).0, &reversed(second))
}

/// Returns a lower bound of the squared distance on the second half of a side, from its quarters.
#[inline(always)]
fn lower_far(side: &ControlPolygon) -> f64 {
    let [_, far] = split(side, 0.5);
    let [first, second] = split(&far, 0.5);
    lower_of_both(&from_nearer(&first).0, &from_nearer(&second).0)
}

/// Returns a lower bound of the squared distance on two parts.
#[inline(always)]
fn lower_of_both(first: &ControlPolygon, second: &ControlPolygon) -> f64 {
    Minorant::of(first)
        .lower()
        .min_or_other(Minorant::of(second).lower())
}

/// Turns lower bounds of the squared distance on both sides of a split, in `lows` and `highs`, into
/// enclosures of the distance. `halvings` counts the halvings after the split.
#[inline(always)]
fn finish_bounds(
    lanes: &Lanes<'_, f64>,
    errors: &[f64],
    bounds: &mut EnclosureBlock,
    halvings: f64,
) {
    let count = errors.len().min(BLOCK);
    let lanes = lanes.first(count);
    for i in 0..count {
        let bound = bounds.lows[i].min_or_other(bounds.highs[i]);
        let found = finish(
            &lanes.control_points(i),
            errors[i],
            bounds.squares[i],
            bound,
            halvings,
        );
        bounds.lows[i] = found.0.low;
        bounds.highs[i] = found.0.high;
        bounds.tight[i] = found.1;
    }
}

/// Returns the enclosure of a distance from its square at a split and a lower bound of that, and
/// [`EnclosureBlock::tight`].
#[inline(always)]
fn finish(
    [p0, p1, p2, p3]: &ControlPoints<f64>,
    error: f64,
    square: f64,
    bound: f64,
    halvings: f64,
) -> (DistanceEnclosure, f64) {
    let squares = [dot(*p0, *p0), dot(*p1, *p1), dot(*p2, *p2), dot(*p3, *p3)];
    // Not a number where one of them is none.
    let size = largest_of(squares).sqrt() * (1.0 + 4.0 * f64::ROUNDING);
    let total = part_error(error, size, halvings);
    let is_tight = bound >= target(size, total, square);
    let tight = if is_tight { 1.0 } else { 0.0 };
    // Negative errors, and those that are no numbers, prove nothing; nor do squares out of range.
    let is_served = (size > 1e-50) & (size < 1e50) & (error >= 0.0);
    (
        enclosure(bound, square, total),
        if is_served { tight } else { -1.0 },
    )
}

/// Returns bounds as [`EnclosureBlock::halves`] for a pair, and [`EnclosureBlock::tight`].
#[inline]
pub(super) fn halves_of_pair(
    points: &ControlPoints<f64>,
    error: f64,
    time: f64,
) -> ([f64; 4], f64) {
    let [before, after] = split(&polygon(points), time);
    let [a, b] = [lower_far(&before), lower_near(&before)];
    let [c, d] = [lower_near(&after), lower_far(&after)];
    let bound = (a.min_or_other(b)).min_or_other(c.min_or_other(d));
    let (_, tight) = finish(points, error, before[0].length_squared(), bound, 2.0);
    ([a, b, c, d], tight)
}
