//! A fine surface as a search sees it: some points of it, the triangles between them, and the ball
//! that serves each point best.
//!
//! All of this is for the search alone: proofs look at the surface itself.

use super::surface::Surface;
use crate::simd::{InstructionSet, Task};
use glam::DVec3;
use std::collections::HashMap;
use std::ops::Range;

/// Points, each coordinate in a list of its own: loops over them are vectorised.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

/// A surface of fewer points than another one, all of them points of that one.
#[derive(Clone, Debug, Default)]
pub(super) struct Samples {
    pub(super) points: Points,
    /// Outward unit vectors.
    normals: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// True if all surfaces are closed: points behind them are inside.
    is_volume: bool,
}

/// The ball of the least overshoot that contains each point.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearest {
    pub(super) balls: Vec<usize>,
    /// The least overshoot, and the second.
    pub(super) first: Vec<f64>,
    second: Vec<f64>,
}

impl Extend<DVec3> for Points {
    fn extend<I: IntoIterator<Item = DVec3>>(&mut self, points: I) {
        for point in points {
            self.x.push(point.x);
            self.y.push(point.y);
            self.z.push(point.z);
        }
    }
}

impl Points {
    pub(super) fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }

    pub(super) fn at(&self, number: usize) -> DVec3 {
        DVec3::new(self.x[number], self.y[number], self.z[number])
    }

    /// Returns the points of a group.
    fn group(&self, group: usize) -> Range<usize> {
        let count = self.x.len();
        let size = count.div_ceil(GROUPS).next_multiple_of(BLOCK);
        (group * size).min(count)..((group + 1) * size).min(count)
    }

    /// Returns the largest numbers below which no square of a distance from a place lies, for each group.
    fn least_squares(&self, at: DVec3) -> [f64; GROUPS] {
        InstructionSet::best().run(LeastSquares { points: self, at })
    }
}

/// The work of [`Points::least_squares`].
struct LeastSquares<'a> {
    points: &'a Points,
    at: DVec3,
}

impl Task for LeastSquares<'_> {
    type Output = [f64; GROUPS];

    #[inline(always)]
    fn run(self) -> Self::Output {
        let (Points { x, y, z }, at) = (self.points, self.at);
        let count = x.len();
        let (x, y, z) = (&x[..count], &y[..count], &z[..count]);
        let square = |i: usize| {
            let (dx, dy, dz) = (x[i] - at.x, y[i] - at.y, z[i] - at.z);
            dx * dx + dy * dy + dz * dz
        };
        let mut of_groups = [f64::INFINITY; GROUPS];
        for (group, of_group) in of_groups.iter_mut().enumerate() {
            let Range { start, end } = self.points.group(group);
            // One for each lane: the minimum does not depend on the order.
            let mut least = [f64::INFINITY; BLOCK];
            let whole = end - (end - start) % BLOCK;
            for start in (start..whole).step_by(BLOCK) {
                for (lane, least) in least.iter_mut().enumerate() {
                    let square = square(start + lane);
                    *least = if square < *least { square } else { *least };
                }
            }
            let rest = (whole..end).map(square);
            *of_group = rest.chain(least).fold(f64::INFINITY, f64::min);
        }
        of_groups
    }
}

/// The work of [`Samples::signed_distance`]: adds up what is within the largest square.
struct WeighNearest<'a> {
    samples: &'a Samples,
    at: DVec3,
    of_groups: [f64; GROUPS],
    least: f64,
    most: f64,
    /// Twice the variance of the weights.
    blur: f64,
}

impl Task for WeighNearest<'_> {
    type Output = (f64, DVec3, f64);

    #[inline(always)]
    fn run(self) -> Self::Output {
        let (Points { x, y, z }, at) = (&self.samples.points, self.at);
        let (mut plane, mut slope, mut total) = (0.0, DVec3::ZERO, 0.0);
        let count = x.len();
        let (x, y, z) = (&x[..count], &y[..count], &z[..count]);
        let of_groups = self.of_groups.iter().enumerate();
        let near = of_groups.filter(|(_, least)| **least <= self.most);
        let groups = near.map(|(group, _)| self.samples.points.group(group));
        for start in groups.flat_map(|group| group.step_by(BLOCK)) {
            let end = count.min(start + BLOCK);
            let mut has_some = false;
            for i in start..end {
                let (dx, dy, dz) = (x[i] - at.x, y[i] - at.y, z[i] - at.z);
                has_some |= dx * dx + dy * dy + dz * dz <= self.most;
            }
            if !has_some {
                continue;
            }
            for number in start..end {
                let way = at - self.samples.points.at(number);
                let square = way.length_squared();
                if square > self.most {
                    continue;
                }
                let normal = self.samples.normals[number];
                if square <= self.least {
                    plane = normal.dot(way);
                }
                let weight = (-(square - self.least) / self.blur).exp();
                slope += normal * weight;
                total += weight;
            }
        }
        (plane, slope, total)
    }
}

impl Samples {
    /// Takes at most about `most` points of some surfaces: one for each cube of a lattice.
    pub(super) fn new(surfaces: &[Surface], most: usize) -> Self {
        let points = || surfaces.iter().flat_map(|surface| &surface.points);
        let low = points().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let mut cube = (high - low).max_element() / 256.0;
        loop {
            let samples = Self::of_cubes(surfaces, low, cube);
            if samples.normals.len() <= most || cube > (high - low).max_element() {
                return samples;
            }
            cube *= 1.2;
        }
    }

    fn of_cubes(surfaces: &[Surface], low: DVec3, cube: f64) -> Self {
        let mut samples = Self {
            is_volume: surfaces.iter().all(Surface::is_closed),
            ..Self::default()
        };
        for surface in surfaces {
            let normals = surface.normals();
            let mut numbers = HashMap::new();
            let mut number_of = Vec::with_capacity(surface.points.len());
            for (&point, normal) in surface.points.iter().zip(normals) {
                let place = ((point - low) / cube).floor().to_array().map(f64::to_bits);
                let number = *numbers.entry(place).or_insert_with(|| {
                    samples.points.extend([point]);
                    samples.normals.push(normal);
                    u32::try_from(samples.normals.len() - 1).unwrap_or(u32::MAX)
                });
                number_of.push(number);
            }
            for polygon in surface.polygons() {
                for pair in polygon[1..].windows(2) {
                    let corners = [polygon[0], pair[0], pair[1]].map(|corner| number_of[corner]);
                    let [a, b, c] = corners;
                    if a != b && b != c && c != a {
                        samples.triangles.push(corners);
                    }
                }
            }
        }
        samples
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.normals.is_empty()
    }

    /// Returns about the signed distance from the surface: the plane through the nearest point is
    /// taken for the surface. The gradient is a mean over the points that are about as near, so it
    /// vanishes on ridges.
    pub(super) fn signed_distance(&self, at: DVec3) -> (f64, DVec3) {
        /// Distances that differ by less count as equal, relative to the distance.
        const BLUR: f64 = 0.01;
        let of_groups = self.points.least_squares(at);
        let least = of_groups.into_iter().fold(f64::INFINITY, f64::min);
        let (plane, slope, total) = InstructionSet::best().run(WeighNearest {
            samples: self,
            at,
            of_groups,
            least,
            most: least * (1.0 + 6.0 * BLUR),
            blur: (2.0 * BLUR * least).max(f64::MIN_POSITIVE),
        });
        let side = if self.is_volume || plane >= 0.0 {
            1.0
        } else {
            -1.0
        };
        (
            side * plane,
            slope * (side / f64::max(total, f64::MIN_POSITIVE)),
        )
    }

    /// Finds where the shares of balls meet on the surface: on edges between points of different
    /// balls, and in triangles of three.
    pub(super) fn find_meetings(
        &self,
        nearest: &Nearest,
        balls: &[(DVec3, f64)],
        meetings: &mut Points,
    ) {
        meetings.clear();
        let power = |ball: usize, point: DVec3| {
            let (centre, radius) = balls[ball];
            point.distance_squared(centre) - radius * radius
        };
        for corners in &self.triangles {
            let corners = corners.map(|corner| corner as usize);
            let of = corners.map(|corner| nearest.balls[corner]);
            if of[0] == of[1] && of[1] == of[2] {
                continue;
            }
            let points = corners.map(|corner| self.points.at(corner));
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                // Each edge of a closed surface has another triangle that passes it the other way.
                if of[a] < of[b] {
                    let before = power(of[a], points[a]) - power(of[b], points[a]);
                    let after = power(of[a], points[b]) - power(of[b], points[b]);
                    if before < after {
                        let share = (before / (before - after)).clamp(0.0, 1.0);
                        meetings.extend([points[a].lerp(points[b], share)]);
                    }
                }
            }
            if of[0] != of[1] && of[1] != of[2] && of[2] != of[0] {
                let differences = points.map(|point| {
                    let first = power(of[0], point);
                    (first - power(of[1], point), first - power(of[2], point))
                });
                meetings.extend(zero_of(points, differences));
            }
        }
    }
}

/// Points that are looked at together.
const BLOCK: usize = 16;

/// Groups of points of which the nearest one is known: most need not be looked at again.
const GROUPS: usize = 16;

/// The work of [`Nearest::find`].
///
/// A ball is tried on a block of points by squares first: most are farther from all of them than the
/// best one so far. The best ball of the block before is tried first.
struct FindBest<'a> {
    points: &'a Points,
    balls: &'a [(DVec3, f64)],
    heights: &'a [(f64, DVec3)],
    best: &'a mut [usize],
    first: &'a mut [f64],
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
            let each = self.balls.iter().zip(self.heights).enumerate();
            for (ball, (&(centre, _), &(height, _))) in each {
                if ball != guess {
                    block.try_ball(ball, centre, height);
                }
            }
            self.best[start..end].copy_from_slice(&block.best[..end - start]);
            self.first[start..end].copy_from_slice(&block.first[..end - start]);
            guess = block.best[0];
        }
    }
}

/// A few points, and the best ball so far for each. Those beyond the number of points are never read.
struct BestOfBlock {
    x: [f64; BLOCK],
    y: [f64; BLOCK],
    z: [f64; BLOCK],
    best: [usize; BLOCK],
    first: [f64; BLOCK],
}

impl BestOfBlock {
    #[inline(always)]
    fn new(points: &Points, range: Range<usize>) -> Self {
        let some = |values: &[f64]| {
            let mut block = [0.0; BLOCK];
            block[..range.len()].copy_from_slice(&values[range.clone()]);
            block
        };
        Self {
            x: some(&points.x),
            y: some(&points.y),
            z: some(&points.z),
            best: [0; BLOCK],
            first: [f64::INFINITY; BLOCK],
        }
    }

    /// Compares a ball with the best one so far; of equally good ones the first stays.
    #[inline(always)]
    fn try_ball(&mut self, ball: usize, centre: DVec3, height: f64) {
        /// Bound above all rounding: lengths are of the order of one.
        const SPARE: f64 = 1e-12;
        let mut squares = [0.0; BLOCK];
        let mut is_near = false;
        for (i, square) in squares.iter_mut().enumerate() {
            let (dx, dy, dz) = (
                self.x[i] - centre.x,
                self.y[i] - centre.y,
                self.z[i] - centre.z,
            );
            *square = dx * dx + dy * dy + dz * dz;
            let most = (self.first[i] - height + SPARE).max(0.0);
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
    }
}

/// Returns the point of a triangle where two linear functions, given at its corners, vanish.
fn zero_of([a, b, c]: [DVec3; 3], values: [(f64, f64); 3]) -> Option<DVec3> {
    let [(f0, g0), (f1, g1), (f2, g2)] = values;
    let (f1, g1, f2, g2) = (f1 - f0, g1 - g0, f2 - f0, g2 - g0);
    let below = f1 * g2 - f2 * g1;
    let u = (f2 * g0 - f0 * g2) / below;
    let v = (f0 * g1 - f1 * g0) / below;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| a + (b - a) * u + (c - a) * v)
}

impl Nearest {
    /// Finds the best ball for each point and the overshoot there, given the height of each centre.
    pub(super) fn find(
        &mut self,
        points: &Points,
        balls: &[(DVec3, f64)],
        heights: &[(f64, DVec3)],
    ) {
        let count = points.x.len();
        self.balls.clear();
        self.balls.resize(count, 0);
        self.first.clear();
        self.first.resize(count, f64::INFINITY);
        InstructionSet::best().run(FindBest {
            points,
            balls,
            heights,
            best: &mut self.balls,
            first: &mut self.first,
        });
    }

    /// Returns the largest overshoot at any point, at least 0.
    pub(super) fn most(&self) -> f64 {
        self.first.iter().copied().fold(0.0, f64::max)
    }

    /// Finds the least overshoot at each point, and the second, given the height of each centre.
    pub(super) fn find_two(
        &mut self,
        points: &Points,
        balls: &[(DVec3, f64)],
        heights: &[(f64, DVec3)],
    ) {
        let count = points.x.len();
        self.balls.clear();
        self.balls.resize(count, 0);
        self.first.clear();
        self.first.resize(count, f64::INFINITY);
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
