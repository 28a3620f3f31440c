//! The ball that serves each point best.

use super::points::{BLOCK, Points, beyond};
use crate::simd::{InstructionSet, Task};
use glam::DVec3;
use std::ops::Range;

/// The ball of the least overshoot that contains each point.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearest {
    pub(super) balls: Vec<usize>,
    /// The least overshoot, and the second.
    first: Vec<f64>,
    second: Vec<f64>,
    /// The largest overshoot of each block.
    farthest: Vec<f64>,
    centres: Points,
    bounds: Vec<f64>,
}

/// The work of [`Nearest::find`].
///
/// A ball is tried on the box around a block of points first, and by squares then: most are farther from all of
/// them than the best one so far. The best ball of the block before is tried before all others.
struct FindBest<'a> {
    points: &'a Points,
    balls: &'a [(DVec3, f64)],
    heights: &'a [(f64, DVec3)],
    centres: &'a Points,
    /// For each ball a number below which no square of a distance from its centre to the block lies.
    bounds: &'a mut [f64],
    best: &'a mut [usize],
    first: &'a mut [f64],
    farthest: &'a mut Vec<f64>,
}

impl Task for FindBest<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let mut guess = 0;
        let count = self.best.len();
        for start in (0..count).step_by(BLOCK) {
            let end = count.min(start + BLOCK);
            let mut block = BestOfBlock::new(self.points, start..end);
            block.try_ball(guess, self.balls[guess].0, self.heights[guess].0);
            block.find_bounds(self.centres, self.bounds);
            for (ball, &bound) in self.bounds.iter().enumerate() {
                let height = self.heights[ball].0;
                let most = most(block.farthest, height);
                if ball != guess && bound <= most * most {
                    block.try_ball(ball, self.balls[ball].0, height);
                }
            }
            self.best[start..end].copy_from_slice(&block.best[..end - start]);
            self.first[start..end].copy_from_slice(&block.first[..end - start]);
            self.farthest.push(block.farthest);
            guess = block.best[0];
        }
    }
}

/// Returns the largest distance at which a ball may be better than one that leads to an overshoot.
#[inline(always)]
fn most(overshoot: f64, height: f64) -> f64 {
    /// Bound above all rounding: lengths are of the order of one.
    const SPARE: f64 = 1e-12;
    (overshoot - height + SPARE).max(0.0)
}

/// A few points, and the best ball so far for each. The last one fills the block.
struct BestOfBlock {
    x: [f64; BLOCK],
    y: [f64; BLOCK],
    z: [f64; BLOCK],
    best: [usize; BLOCK],
    first: [f64; BLOCK],
    /// The largest of these overshoots.
    farthest: f64,
}

impl BestOfBlock {
    #[inline(always)]
    fn new(points: &Points, range: Range<usize>) -> Self {
        let some = |values: &[f64]| {
            let values = &values[range.clone()];
            values.first_chunk().copied().unwrap_or_else(|| {
                let mut block = [values[values.len() - 1]; BLOCK];
                block[..values.len()].copy_from_slice(values);
                block
            })
        };
        Self {
            x: some(&points.x),
            y: some(&points.y),
            z: some(&points.z),
            best: [0; BLOCK],
            first: [f64::INFINITY; BLOCK],
            farthest: f64::INFINITY,
        }
    }

    #[inline(always)]
    fn find_bounds(&self, centres: &Points, bounds: &mut [f64]) {
        let [x, y, z] = [&self.x, &self.y, &self.z].map(range);
        let count = bounds.len();
        let (xs, ys, zs) = (
            &centres.x[..count],
            &centres.y[..count],
            &centres.z[..count],
        );
        for (i, bound) in bounds.iter_mut().enumerate() {
            let dx = beyond(x.0, x.1, xs[i]);
            let dy = beyond(y.0, y.1, ys[i]);
            let dz = beyond(z.0, z.1, zs[i]);
            *bound = dx * dx + dy * dy + dz * dz;
        }
    }

    /// Compares a ball with the best one so far; of equally good ones the first stays.
    #[inline(always)]
    fn try_ball(&mut self, ball: usize, centre: DVec3, height: f64) {
        let mut squares = [0.0; BLOCK];
        let mut is_near = false;
        for (i, square) in squares.iter_mut().enumerate() {
            let (dx, dy, dz) = (
                self.x[i] - centre.x,
                self.y[i] - centre.y,
                self.z[i] - centre.z,
            );
            *square = dx * dx + dy * dy + dz * dz;
            let most = most(self.first[i], height);
            is_near |= *square <= most * most;
        }
        if !is_near {
            return;
        }
        for (i, square) in squares.into_iter().enumerate() {
            let overshoot = square.sqrt() + height;
            let is_best =
                overshoot < self.first[i] || (overshoot <= self.first[i] && ball < self.best[i]);
            self.best[i] = if is_best { ball } else { self.best[i] };
            self.first[i] = if is_best { overshoot } else { self.first[i] };
        }
        self.farthest = range(&self.first).1;
    }
}

/// Returns the least and the largest number of a block.
#[inline(always)]
fn range(values: &[f64; BLOCK]) -> (f64, f64) {
    const LANES: usize = 4;
    // One for each lane.
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for values in values.as_chunks::<LANES>().0 {
        for (lane, &value) in values.iter().enumerate() {
            low[lane] = if value < low[lane] { value } else { low[lane] };
            high[lane] = if value > high[lane] {
                value
            } else {
                high[lane]
            };
        }
    }
    let low = low.into_iter().fold(f64::INFINITY, f64::min);
    (low, high.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

impl Nearest {
    /// Forgets what was found, for that many points.
    fn reset(&mut self, count: usize) {
        self.balls.clear();
        self.balls.resize(count, 0);
        self.first.clear();
        self.first.resize(count, f64::INFINITY);
    }

    /// Finds the best ball for each point and the overshoot there, given the height of each centre.
    pub(super) fn find(
        &mut self,
        points: &Points,
        balls: &[(DVec3, f64)],
        heights: &[(f64, DVec3)],
    ) {
        self.reset(points.x.len());
        self.centres.clear();
        self.centres.extend(balls.iter().map(|&(centre, _)| centre));
        self.farthest.clear();
        self.bounds.clear();
        self.bounds.resize(balls.len(), 0.0);
        InstructionSet::best().run(FindBest {
            points,
            balls,
            heights,
            centres: &self.centres,
            bounds: &mut self.bounds,
            farthest: &mut self.farthest,
            best: &mut self.balls,
            first: &mut self.first,
        });
    }

    /// Returns the largest overshoot at any point, at least 0.
    pub(super) fn most(&self) -> f64 {
        self.farthest.iter().copied().fold(0.0, f64::max)
    }

    /// Returns the numbers of the points with this overshoot at least.
    pub(super) fn at_least(&self, least: f64) -> impl Iterator<Item = usize> {
        let count = self.first.len();
        let blocks = self.farthest.iter().enumerate();
        let some = blocks.filter(move |(_, farthest)| **farthest >= least);
        let points = some.flat_map(move |(block, _)| {
            let start = block * BLOCK;
            start..count.min(start + BLOCK)
        });
        points.filter(move |&point| self.first[point] >= least)
    }

    /// Finds the least overshoot at each point, and the second, given the height of each centre.
    pub(super) fn find_two(
        &mut self,
        points: &Points,
        balls: &[(DVec3, f64)],
        heights: &[(f64, DVec3)],
    ) {
        let count = points.x.len();
        self.reset(count);
        self.second.clear();
        self.second.resize(count, f64::INFINITY);
        let (x, y, z) = (&points.x[..count], &points.y[..count], &points.z[..count]);
        let (best, first) = (&mut self.balls[..count], &mut self.first[..count]);
        let second = &mut self.second[..count];
        for (ball, (&(centre, _), &(height, _))) in balls.iter().zip(heights).enumerate() {
            for i in 0..count {
                let (dx, dy, dz) = (x[i] - centre.x, y[i] - centre.y, z[i] - centre.z);
                let overshoot = (dx * dx + dy * dy + dz * dz).sqrt() + height;
                let is_best = overshoot < first[i];
                let other = if is_best { first[i] } else { overshoot };
                second[i] = if other < second[i] { other } else { second[i] };
                best[i] = if is_best { ball } else { best[i] };
                first[i] = if is_best { overshoot } else { first[i] };
            }
        }
    }

    /// Returns the largest overshoot without each of the balls.
    pub(super) fn losses(&self, count: usize) -> Vec<f64> {
        let mut losses = vec![0.0_f64; count];
        let mut own = vec![0.0_f64; count];
        for ((&ball, &first), &second) in self.balls.iter().zip(&self.first).zip(&self.second) {
            own[ball] = own[ball].max(first);
            losses[ball] = losses[ball].max(second);
        }
        for (ball, loss) in losses.iter_mut().enumerate() {
            let others = own.iter().enumerate().filter(|&(other, _)| other != ball);
            *loss = others.map(|(_, &own)| own).fold(*loss, f64::max);
        }
        losses
    }
}
