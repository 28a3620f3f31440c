//! A fine surface as a search sees it: some points of it, the triangles between them, and the ball
//! that serves each point best.
//!
//! All of this is for the search alone: proofs look at the surface itself.

use super::surface::Surface;
use glam::DVec3;
use std::collections::HashMap;

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
    triangles: Vec<[usize; 3]>,
    /// All surfaces are closed: points behind them are inside.
    is_volume: bool,
}

/// For each point the ball of the least overshoot that contains it.
#[derive(Clone, Debug, Default)]
pub(super) struct Nearest {
    pub(super) balls: Vec<usize>,
    /// The least overshoot, and the second.
    first: Vec<f64>,
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

    /// Returns the largest number below which no square of a distance from a place lies.
    fn least_square(&self, at: DVec3) -> f64 {
        let count = self.x.len();
        let (x, y, z) = (&self.x[..count], &self.y[..count], &self.z[..count]);
        let mut least = f64::INFINITY;
        for i in 0..count {
            let (dx, dy, dz) = (x[i] - at.x, y[i] - at.y, z[i] - at.z);
            let square = dx * dx + dy * dy + dz * dz;
            least = if square < least { square } else { least };
        }
        least
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
                    samples.normals.len() - 1
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
        let least = self.points.least_square(at);
        let most = least * (1.0 + 6.0 * BLUR);
        let (mut plane, mut slope, mut total) = (0.0, DVec3::ZERO, 0.0);
        for (number, &normal) in self.normals.iter().enumerate() {
            let way = at - self.points.at(number);
            let square = way.length_squared();
            if square > most {
                continue;
            }
            if square <= least {
                plane = normal.dot(way);
            }
            let weight = (-(square - least) / (2.0 * BLUR * least).max(f64::MIN_POSITIVE)).exp();
            slope += normal * weight;
            total += weight;
        }
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
    /// Finds the best ball for each point, given the height of each centre.
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
