//! A fine surface as a search sees it: some points of it, and the triangles between them.
//!
//! All of this is for the search alone: proofs look at the surface itself.

use super::surface::{Surface, fan};
use crate::count::short;
use crate::simd::{InstructionSet, Task};
use glam::DVec3;
use std::collections::HashMap;

/// Points that are looked at together.
pub(super) const BLOCK: usize = 16;

/// Points of one box. A box costs as much as two of its points.
const BOXED: usize = 4 * BLOCK;

/// Points, each coordinate in a list of its own: loops over them are vectorised.
#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) z: Vec<f64>,
}

/// A surface of fewer points than another one, all of them points of that one.
#[derive(Clone, Debug, Default)]
pub(super) struct Samples {
    pub(super) points: Points,
    /// Corners of the boxes around each few points. Points that follow each other are near each other in most
    /// meshes, so few boxes are near a place.
    low: Points,
    high: Points,
    /// Outward unit vectors.
    normals: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// True if the search takes depths from the points, not from the solid.
    pub(super) tell_depths: bool,
    /// True if all surfaces are closed: points behind them are inside.
    is_volume: bool,
}

impl Extend<DVec3> for Points {
    fn extend<I: IntoIterator<Item = DVec3>>(&mut self, points: I) {
        points.into_iter().for_each(|point| self.push(point));
    }
}

impl Points {
    fn push(&mut self, point: DVec3) {
        self.x.push(point.x);
        self.y.push(point.y);
        self.z.push(point.z);
    }

    pub(super) fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }

    pub(super) fn at(&self, number: usize) -> DVec3 {
        DVec3::new(self.x[number], self.y[number], self.z[number])
    }
}

/// Returns how far a number is beyond a range, 0 within. No number of the range differs from it by less, rounding
/// included.
#[inline(always)]
pub(super) fn beyond(low: f64, high: f64, at: f64) -> f64 {
    let (below, above) = (low - at, at - high);
    let beyond = if below > above { below } else { above };
    if beyond > 0.0 { beyond } else { 0.0 }
}

/// The work of [`Samples::signed_distance`].
struct FindSurface<'a> {
    samples: &'a Samples,
    at: DVec3,
    /// For each box a number below which no square of a distance to its points lies.
    bounds: &'a mut [f64],
}

impl FindSurface<'_> {
    #[inline(always)]
    fn find_bounds(&mut self) {
        let (low, high, at) = (&self.samples.low, &self.samples.high, self.at);
        let count = self.bounds.len();
        let (x, y, z) = (&low.x[..count], &low.y[..count], &low.z[..count]);
        let (to_x, to_y, to_z) = (&high.x[..count], &high.y[..count], &high.z[..count]);
        for (i, bound) in self.bounds.iter_mut().enumerate() {
            let dx = beyond(x[i], to_x[i], at.x);
            let dy = beyond(y[i], to_y[i], at.y);
            let dz = beyond(z[i], to_z[i], at.z);
            *bound = dx * dx + dy * dy + dz * dz;
        }
    }

    /// Returns the least square of a distance to a point of a box.
    #[inline(always)]
    fn least_of(&self, number: usize) -> f64 {
        let (Points { x, y, z }, at) = (&self.samples.points, self.at);
        let start = number * BOXED;
        let end = x.len().min(start + BOXED);
        let (x, y, z) = (&x[start..end], &y[start..end], &z[start..end]);
        // One for each lane: the minimum does not depend on the order.
        let mut least = [f64::INFINITY; BLOCK];
        let blocks = x.chunks(BLOCK).zip(y.chunks(BLOCK)).zip(z.chunks(BLOCK));
        for ((x, y), z) in blocks {
            for (((x, y), z), least) in x.iter().zip(y).zip(z).zip(&mut least) {
                let (dx, dy, dz) = (x - at.x, y - at.y, z - at.z);
                let square = dx * dx + dy * dy + dz * dz;
                *least = if square < *least { square } else { *least };
            }
        }
        least.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Returns the least square of a distance to a point.
    #[inline(always)]
    fn least(&self) -> f64 {
        let mut nearest = (f64::INFINITY, 0);
        for (number, &bound) in self.bounds.iter().enumerate() {
            if bound < nearest.0 {
                nearest = (bound, number);
            }
        }
        let mut least = self.least_of(nearest.1);
        for (number, &bound) in self.bounds.iter().enumerate() {
            if bound < least && number != nearest.1 {
                least = least.min(self.least_of(number));
            }
        }
        least
    }
}

impl Task for FindSurface<'_> {
    type Output = (f64, DVec3);

    #[inline(always)]
    fn run(mut self) -> Self::Output {
        /// Distances that differ by less count as equal, relative to the distance.
        const BLUR: f64 = 0.01;
        self.find_bounds();
        let least = self.least();
        let most = least * (1.0 + 6.0 * BLUR);
        // Twice the variance of the weights.
        let blur = (2.0 * BLUR * least).max(f64::MIN_POSITIVE);
        let (Points { x, y, z }, at) = (&self.samples.points, self.at);
        let (mut plane, mut slope, mut total) = (0.0, DVec3::ZERO, 0.0);
        let count = x.len();
        let (x, y, z) = (&x[..count], &y[..count], &z[..count]);
        let boxes = self.bounds.iter().enumerate();
        let near = boxes.filter(|(_, bound)| **bound <= most);
        let blocks = near.flat_map(|(number, _)| {
            let start = number * BOXED;
            (start..count.min(start + BOXED)).step_by(BLOCK)
        });
        for start in blocks {
            let end = count.min(start + BLOCK);
            let mut has_some = false;
            for i in start..end {
                let (dx, dy, dz) = (x[i] - at.x, y[i] - at.y, z[i] - at.z);
                has_some |= dx * dx + dy * dy + dz * dz <= most;
            }
            if !has_some {
                continue;
            }
            for number in start..end {
                let way = at - self.samples.points.at(number);
                let square = way.length_squared();
                if square > most {
                    continue;
                }
                let normal = self.samples.normals[number];
                if square <= least {
                    plane = normal.dot(way);
                }
                let weight = (-(square - least) / blur).exp();
                slope += normal * weight;
                total += weight;
            }
        }
        (plane, slope * (1.0 / f64::max(total, f64::MIN_POSITIVE)))
    }
}

impl Samples {
    /// Takes at most about `most` points of some surfaces: one for each cube of a lattice.
    pub(super) fn new(surfaces: &[Surface], most: usize) -> Self {
        let points = || surfaces.iter().flat_map(|surface| &surface.points);
        let low = points().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let extent = (high - low).max_element();
        let mut cube = extent / 256.0;
        loop {
            let mut samples = Self::of_cubes(surfaces, low, cube);
            // Each surface has a point, and all of them may be at one place.
            if samples.normals.len() <= most || cube >= extent {
                samples.find_boxes();
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
                    samples.points.push(point);
                    samples.normals.push(normal);
                    short(samples.normals.len() - 1)
                });
                number_of.push(number);
            }
            for polygon in surface.polygons() {
                for corners in fan(polygon) {
                    let corners = corners.map(|corner| number_of[corner]);
                    let [a, b, c] = corners;
                    if a != b && b != c && c != a {
                        samples.triangles.push(corners);
                    }
                }
            }
        }
        samples
    }

    fn find_boxes(&mut self) {
        let count = self.normals.len();
        for start in (0..count).step_by(BOXED) {
            let points = (start..count.min(start + BOXED)).map(|number| self.points.at(number));
            let low = points.clone().fold(DVec3::INFINITY, DVec3::min);
            let high = points.fold(DVec3::NEG_INFINITY, DVec3::max);
            self.low.push(low);
            self.high.push(high);
        }
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.normals.is_empty()
    }

    /// Returns about the signed distance from the surface: the plane through the nearest point is
    /// taken for the surface. The gradient is a mean over the points that are about as near, so it
    /// vanishes on ridges. `scratch` may hold anything.
    pub(super) fn signed_distance(&self, at: DVec3, scratch: &mut Vec<f64>) -> (f64, DVec3) {
        scratch.clear();
        scratch.resize(self.low.x.len(), 0.0);
        let (plane, slope) = InstructionSet::best().run(FindSurface {
            samples: self,
            at,
            bounds: scratch,
        });
        let side = if self.is_volume || plane >= 0.0 {
            1.0
        } else {
            -1.0
        };
        (side * plane, slope * side)
    }

    /// Finds where the shares of balls meet on the surface: on edges between points of different
    /// balls, and in triangles of three. `nearest` has the ball of each point.
    pub(super) fn find_meetings(
        &self,
        nearest: &[usize],
        balls: &[(DVec3, f64)],
        meetings: &mut Points,
    ) {
        meetings.clear();
        let power = |ball: usize, point: DVec3| {
            let (centre, radius) = balls[ball];
            point.distance_squared(centre) - radius * radius
        };
        for &[a, b, c] in &self.triangles {
            let (a, b, c) = (a as usize, b as usize, c as usize);
            let of = [nearest[a], nearest[b], nearest[c]];
            if of[0] == of[1] && of[1] == of[2] {
                continue;
            }
            let points = [self.points.at(a), self.points.at(b), self.points.at(c)];
            for a in 0..3 {
                let b = (a + 1) % 3;
                // Each edge of a closed surface has another triangle that passes it the other way.
                if of[a] < of[b] {
                    let before = power(of[a], points[a]) - power(of[b], points[a]);
                    let after = power(of[a], points[b]) - power(of[b], points[b]);
                    if before < after {
                        let share = (before / (before - after)).clamp(0.0, 1.0);
                        meetings.push(points[a].lerp(points[b], share));
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

/// Returns the point of a triangle where two linear functions, given at its corners, vanish.
fn zero_of([a, b, c]: [DVec3; 3], values: [(f64, f64); 3]) -> Option<DVec3> {
    let [(f0, g0), (f1, g1), (f2, g2)] = values;
    let (f1, g1, f2, g2) = (f1 - f0, g1 - g0, f2 - f0, g2 - g0);
    let below = f1 * g2 - f2 * g1;
    let u = (f2 * g0 - f0 * g2) / below;
    let v = (f0 * g1 - f1 * g0) / below;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| a + (b - a) * u + (c - a) * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More surfaces than points are asked for, all of them one point.
    #[test]
    fn samples_of_one_place() {
        let points = vec![Surface::new(vec![DVec3::ONE; 3], true); 9];
        let samples = Samples::new(&points, 4);
        assert_eq!(samples.normals.len(), 9);
    }
}
