//! All spheres of two bodies over a part of a span, each on a cubic.
//!
//! Most pairs of spheres that come within the margin are never the nearest ones, and need not be
//! solved: over the whole part, another pair is nearer by more than the solver's rounding. What
//! remains suffices for contacts within any margin, and for the closest approach, in any window.

use crate::accuracy::Accuracy;
use crate::enclosure::squared_distance;
use crate::hitbox::Sphere;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::contact_radius;
use crate::narrow_phase::relative::{RelativeMotion, rejection_threshold};
use crate::narrow_phase::sphere_pair::{SpherePair, difference_of_squares};
use crate::orientation::BakedRotation;
use crate::rounding::{norm, normalising_power};
use glam::DVec3;

/// Two bodies over a part of a span in which both rotations are cubics.
pub(super) struct SpheresOverPart<'a> {
    views: [&'a BodyView<'a>; 2],
    accuracy: Accuracy,
    rotations: [Option<BakedRotation>; 2],
    motion: RelativeMotion,
    /// Control points of the bodies' relative position, m.
    base: [DVec3; 4],
    /// Magnitude to which all rounding is relative, m.
    scale: f64,
}

/// Buffers that one part leaves to the next.
#[derive(Debug, Default)]
pub(super) struct PartScratch {
    /// Reach of each sphere of both bodies along a direction, m.
    reaches: [Vec<f64>; 2],
    /// Spheres of b that may be near some of a's, by number.
    near_b: Vec<(u32, SphereWay)>,
    candidates: Vec<SphereCandidate>,
}

/// A sphere's centre over the part.
#[derive(Clone, Copy, Debug)]
struct SphereWay {
    /// Control points relative to the body's position, m.
    points: [DVec3; 4],
    /// Radius for the separation, m.
    radius: f64,
    /// Bound on the error of the points that the radius does not contain, m.
    error: f64,
}

/// Two spheres that may come within the margin.
#[derive(Clone, Copy, Debug)]
struct SphereCandidate {
    a: u32,
    b: u32,
    /// Control points of the centres' relative position, in the unit of lengths.
    points: [DVec3; 4],
    /// Control heights of the squared distance, in the square of that unit.
    heights: [f64; 7],
    /// Lower bound of the separation, without errors, to rounding; sum of the radii and of the errors:
    /// all in that unit.
    least: f64,
    radii: f64,
    error: f64,
}

impl PartScratch {
    /// Returns two spheres that reach far towards each other's bodies: probably among the nearest.
    fn facing(&self) -> (u32, u32) {
        let smallest = |reaches: &[f64], sign: f64| {
            let mut least = (f64::INFINITY, 0);
            for (number, reach) in (0..).zip(reaches) {
                if sign * reach < least.0 {
                    least = (sign * reach, number);
                }
            }
            least.1
        };
        let [reaches_a, reaches_b] = &self.reaches;
        (smallest(reaches_a, 1.0), smallest(reaches_b, -1.0))
    }
}

impl SphereWay {
    #[inline]
    fn of(sphere: &Sphere, rotation: Option<&BakedRotation>, accuracy: Accuracy) -> Self {
        let Some(rotation) = rotation else {
            return Self {
                points: [sphere.offset; 4],
                radius: sphere.radius,
                error: 0.0,
            };
        };
        let (radius, error) = rotation.radius_and_error((sphere.offset, sphere.radius), accuracy);
        Self {
            points: rotation.way(sphere.offset),
            radius,
            error,
        }
    }
}

impl SphereCandidate {
    /// Returns the separation at the start, in the middle and at the end of the part, in the unit
    /// of lengths.
    fn separations(&self) -> [f64; 3] {
        let [p0, p1, p2, p3] = self.points;
        let middle = 0.125 * ((p0 + p3) + 3.0 * (p1 + p2));
        [p0, middle, p3].map(|place| place.length() - self.radii)
    }

    /// Returns true if another pair is nearer by more than `slack` over the whole part.
    fn is_behind(&self, near: &Self, slack: f64) -> bool {
        let excess = (self.radii - near.radii).max(0.0) + slack + (self.error + near.error);
        let squares = near.points.map(DVec3::length_squared);
        let reach = squares.into_iter().fold(0.0, f64::max).sqrt();
        let least = difference_of_squares(reach, excess);
        let mut heights = self.heights.iter().zip(&near.heights);
        heights.all(|(far, near)| far - near > least)
    }
}

impl<'a> SpheresOverPart<'a> {
    /// Largest number of candidates of which all are solved.
    const FEW: usize = 2;

    pub(super) fn new(
        views: [&'a BodyView<'a>; 2],
        accuracy: Accuracy,
        (motion, scale): (RelativeMotion, f64),
        rotations: [Option<BakedRotation>; 2],
    ) -> Self {
        Self {
            views,
            accuracy,
            rotations,
            base: motion.points(DVec3::ZERO),
            motion,
            scale,
        }
    }

    #[inline]
    fn way(&self, body: usize, sphere: &Sphere) -> SphereWay {
        SphereWay::of(sphere, self.rotations[body].as_ref(), self.accuracy)
    }

    /// Calls `visit` with each pair of spheres that may come within `margin` and be the nearest one
    /// then, in the order of their numbers.
    pub(super) fn each_within(
        &self,
        margin: f64,
        scratch: &mut PartScratch,
        mut visit: impl FnMut(&SpherePair),
    ) {
        self.find_reaches(scratch);
        self.find_candidates(margin, scratch);
        let candidates = &scratch.candidates;
        if candidates.len() <= Self::FEW {
            for candidate in candidates {
                visit(&self.pair((candidate.a, candidate.b)));
            }
            return;
        }
        // Those that are nearest at three instants.
        let mut nearest = [(f64::INFINITY, 0); 3];
        for (number, candidate) in candidates.iter().enumerate() {
            for (nearest, separation) in nearest.iter_mut().zip(candidate.separations()) {
                if separation < nearest.0 {
                    *nearest = (separation, number);
                }
            }
        }
        let power = normalising_power(self.scale);
        let slack = 2.0 * rejection_threshold(0.0, self.scale) * power;
        for candidate in candidates {
            let is_behind =
                |&(_, near): &(f64, usize)| candidate.is_behind(&candidates[near], slack);
            if !nearest.iter().any(is_behind) {
                visit(&self.pair((candidate.a, candidate.b)));
            }
        }
    }

    /// Solves the pairs of spheres that may come nearer than `reached` (m); `solve` returns the new
    /// value of `reached`. Returns the last one.
    pub(super) fn each_for_nearest(
        &self,
        mut reached: f64,
        scratch: &mut PartScratch,
        mut solve: impl FnMut(&SpherePair) -> f64,
    ) -> f64 {
        self.find_reaches(scratch);
        // Compared with one of the nearest pairs of spheres, few others are near.
        let facing = reached.is_infinite().then(|| scratch.facing());
        if let Some(pair) = facing {
            reached = reached.min(solve(&self.pair(pair)));
        }
        self.find_candidates(reached, scratch);
        let power = normalising_power(self.scale);
        let candidates = &scratch.candidates;
        let first = candidates.iter().min_by(|x, y| x.least.total_cmp(&y.least));
        let (first, mut solved) = (first.into_iter(), [facing, None]);
        for candidate in first.chain(candidates) {
            let pair = (candidate.a, candidate.b);
            let near = rejection_threshold(reached, self.scale + reached.abs()) * power;
            if candidate.least - candidate.error > near || solved.contains(&Some(pair)) {
                continue;
            }
            solved[1] = solved[1].or(Some(pair));
            reached = reached.min(solve(&self.pair(pair)));
        }
        reached
    }

    /// Finds the pairs of spheres that cheap tests cannot rule out to come within `margin`, in the
    /// order of their numbers.
    fn find_candidates(&self, margin: f64, scratch: &mut PartScratch) {
        let PartScratch {
            reaches: [reaches_a, reaches_b],
            near_b,
            candidates,
        } = scratch;
        candidates.clear();
        near_b.clear();
        // Infinite, or a distance: rounding of the reaches and of the sums is that of a rejection.
        let bound = rejection_threshold(margin, self.scale + margin.abs());
        let nearest = reaches_a.iter().copied().fold(f64::INFINITY, f64::min);
        let [spheres_a, spheres_b] = self.views.map(|view| view.spheres);
        for (number, (sphere, most)) in (0..).zip(spheres_b.iter().zip(&*reaches_b)) {
            if nearest - most <= bound {
                near_b.push((number, self.way(1, sphere)));
            }
        }
        let power = normalising_power(self.scale);
        let farthest = reaches_b.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (number_a, (sphere, least)) in (0..).zip(spheres_a.iter().zip(&*reaches_a)) {
            if least - farthest > bound {
                continue;
            }
            let way_a = self.way(0, sphere);
            let places = [0, 1, 2, 3].map(|k| self.base[k] + way_a.points[k]);
            for (number_b, way_b) in &*near_b {
                if least - reaches_b[*number_b as usize] > bound {
                    continue;
                }
                let error = way_a.error + way_b.error;
                let radius = if margin < f64::INFINITY {
                    contact_radius(way_a.radius, way_b.radius, margin) + error
                } else {
                    margin
                };
                if radius < 0.0 {
                    continue;
                }
                let points = [0, 1, 2, 3].map(|k| (places[k] - way_b.points[k]) * power);
                let heights = squared_distance(&points);
                let lowest = heights.into_iter().fold(f64::INFINITY, f64::min);
                // The clearance contains their rounding: see the rejection by coefficients.
                let threshold = rejection_threshold(radius, self.scale) * power;
                if lowest > threshold * threshold {
                    continue;
                }
                let radii = (way_a.radius + way_b.radius) * power;
                candidates.push(SphereCandidate {
                    a: number_a,
                    b: *number_b,
                    points,
                    heights,
                    least: lowest.max(0.0).sqrt() - radii,
                    radii,
                    error: error * power,
                });
            }
        }
    }

    /// Finds how far each sphere reaches along the direction from body b to body a, m: those of a at
    /// least, from b's position, and those of b at most. The separation of two spheres is never
    /// below the difference.
    fn find_reaches(&self, scratch: &mut PartScratch) {
        let direction = self.direction();
        let base = self.base.map(|point| point.dot(direction));
        let [reaches_a, reaches_b] = &mut scratch.reaches;
        let still = [direction; 4];
        let along = |body: usize| {
            let rotation = self.rotations[body].as_ref();
            rotation.map_or(still, |rotation| rotation.seen_along(direction))
        };
        let error = |body: usize| {
            let farthest = DVec3::new(self.views[body].bounding.radius, 0.0, 0.0);
            let rotation = self.rotations[body].as_ref();
            rotation.map_or(0.0, |rotation| rotation.error_of(farthest))
        };
        let (axes, excess) = (along(0), error(0));
        reaches_a.clear();
        reaches_a.extend(self.views[0].spheres.iter().map(|sphere| {
            let places = [0, 1, 2, 3].map(|k| base[k] + axes[k].dot(sphere.offset));
            places.into_iter().fold(f64::INFINITY, f64::min) - (sphere.radius + excess)
        }));
        let (axes, excess) = (along(1), error(1));
        reaches_b.clear();
        reaches_b.extend(self.views[1].spheres.iter().map(|sphere| {
            let places = axes.map(|axis| axis.dot(sphere.offset));
            places.into_iter().fold(f64::NEG_INFINITY, f64::max) + (sphere.radius + excess)
        }));
    }

    /// Returns a direction in which body a lies from body b in this part: a unit vector, up to
    /// rounding, or zero.
    fn direction(&self) -> DVec3 {
        let [p0, p1, p2, p3] = self.base;
        let sum = (p0 + p3) + (p1 + p2);
        let length = norm(sum);
        if length > f64::MIN_POSITIVE {
            sum / length
        } else {
            DVec3::ZERO
        }
    }

    /// Returns two spheres over the part.
    pub(super) fn pair(&self, (a, b): (u32, u32)) -> SpherePair {
        let sphere = |body: usize, number: u32| &self.views[body].spheres[number as usize];
        let (way_a, way_b) = (self.way(0, sphere(0, a)), self.way(1, sphere(1, b)));
        let ways = [0, 1, 2, 3].map(|k| way_a.points[k] - way_b.points[k]);
        SpherePair {
            a,
            b,
            radius_a: way_a.radius,
            radius_b: way_b.radius,
            baking: way_a.error + way_b.error,
            cubic: self.motion.along(&ways),
        }
    }
}
