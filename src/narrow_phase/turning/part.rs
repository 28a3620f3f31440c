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
use crate::narrow_phase::relative::{RelativeMotion, filter_threshold};
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::orientation::BakedRotation;
use crate::rounding::{norm, normalising_power};
use crate::spans::Span;
use glam::DVec3;

/// Two bodies over a part of a span in which both rotations are cubics.
pub(super) struct SpheresOverPart {
    pub(super) span: Span,
    motion: RelativeMotion,
    /// Control points of the bodies' relative position, m.
    base: [DVec3; 4],
    /// Magnitude to which all rounding is relative, m.
    scale: f64,
    ways: [Vec<SphereWay>; 2],
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
struct Candidate {
    a: u32,
    b: u32,
    /// Control points of the centres' relative position, in the unit of lengths.
    points: [DVec3; 4],
    /// Control heights of the squared distance, in the square of that unit.
    heights: [f64; 7],
    /// Sum of the radii and of the errors, in that unit.
    radii: f64,
    error: f64,
}

impl SphereWay {
    fn of(sphere: &Sphere, rotation: Option<&BakedRotation>, accuracy: Accuracy) -> Self {
        let Some(rotation) = rotation else {
            return Self {
                points: [sphere.offset; 4],
                radius: sphere.radius,
                error: 0.0,
            };
        };
        let error = rotation.error_of(sphere.offset);
        let points = rotation.way(sphere.offset);
        match accuracy {
            Accuracy::Exact => Self {
                points,
                radius: (sphere.radius + error).next_up(),
                error: 0.0,
            },
            Accuracy::Certified => Self {
                points,
                radius: sphere.radius,
                error,
            },
        }
    }
}

impl Candidate {
    /// Returns the separation at the start, in the middle and at the end of the part, in the unit
    /// of lengths.
    fn separations(&self) -> [f64; 3] {
        let [p0, p1, p2, p3] = self.points;
        let middle = 0.125 * ((p0 + p3) + 3.0 * (p1 + p2));
        [p0, middle, p3].map(|place| place.length() - self.radii)
    }

    /// Returns true if another pair is nearer by more than `slack` over the whole part.
    ///
    /// With f and n the centre distances and e the excess of the own radii plus slack, f > n + e
    /// follows from f² - n² > e (2 n + e).
    fn is_behind(&self, near: &Self, slack: f64) -> bool {
        let excess = (self.radii - near.radii).max(0.0) + slack + (self.error + near.error);
        let squares = near.points.map(DVec3::length_squared);
        let reach = squares.into_iter().fold(0.0, f64::max).sqrt();
        let least = excess * (2.0 * reach + excess);
        let mut heights = self.heights.iter().zip(&near.heights);
        heights.all(|(far, near)| far - near > least)
    }
}

impl SpheresOverPart {
    /// Up to this number all candidates are solved.
    const FEW: usize = 2;

    pub(super) fn new(
        (a, b): (&BodyView<'_>, &BodyView<'_>),
        span: Span,
        accuracy: Accuracy,
        (motion, scale): (RelativeMotion, f64),
        rotations: &[Option<BakedRotation>; 2],
    ) -> Self {
        let ways = |view: &BodyView<'_>, rotation: Option<&BakedRotation>| {
            let spheres = view.spheres.iter();
            let ways = spheres.map(|sphere| SphereWay::of(sphere, rotation, accuracy));
            ways.collect::<Vec<_>>()
        };
        Self {
            span,
            base: motion.points(DVec3::ZERO),
            motion,
            scale: scale + 4.0 * (a.bounding.radius + b.bounding.radius),
            ways: [
                ways(a, rotations[0].as_ref()),
                ways(b, rotations[1].as_ref()),
            ],
        }
    }

    /// Returns the distance below which two spheres, given by radius and error, may come within
    /// `margin`, or `None` if none is small enough.
    #[inline]
    fn threshold(&self, a: (f64, f64), b: (f64, f64), margin: f64) -> Option<f64> {
        if margin >= f64::INFINITY {
            return Some(margin);
        }
        let radius = contact_radius(a.0, b.0, margin) + (a.1 + b.1);
        (radius >= 0.0).then(|| filter_threshold(radius, self.scale))
    }

    /// Calls `visit` with each pair of spheres that may come within `margin` and be the nearest one
    /// then, in the order of their numbers.
    pub(super) fn each_within(&self, margin: f64, mut visit: impl FnMut(&SpherePair)) {
        let candidates = self.candidates(margin);
        if candidates.len() <= Self::FEW {
            for candidate in &candidates {
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
        let slack = 2.0 * filter_threshold(0.0, self.scale) * power;
        for candidate in &candidates {
            let is_behind =
                |&(_, near): &(f64, usize)| candidate.is_behind(&candidates[near], slack);
            if !nearest.iter().any(is_behind) {
                visit(&self.pair((candidate.a, candidate.b)));
            }
        }
    }

    /// Returns the pairs of spheres that cheap tests cannot rule out to come within `margin`, in the
    /// order of their numbers.
    fn candidates(&self, margin: f64) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        let reaches = self.reaches();
        // Infinite, or a distance: rounding of the reaches and of the sums is that of a filter.
        let bound = filter_threshold(margin, self.scale + margin.abs());
        let farthest = reaches[1].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let power = normalising_power(self.scale);
        let [ways_a, ways_b] = &self.ways;
        for (number_a, (way_a, least)) in (0..).zip(ways_a.iter().zip(&reaches[0])) {
            if least - farthest > bound {
                continue;
            }
            let places = [0, 1, 2, 3].map(|k| self.base[k] + way_a.points[k]);
            for (number_b, (way_b, most)) in (0..).zip(ways_b.iter().zip(&reaches[1])) {
                if least - most > bound {
                    continue;
                }
                let own = (way_a.radius, way_a.error);
                let Some(threshold) = self.threshold(own, (way_b.radius, way_b.error), margin)
                else {
                    continue;
                };
                let points = [0, 1, 2, 3].map(|k| (places[k] - way_b.points[k]) * power);
                let heights = squared_distance(&points);
                let lowest = heights.into_iter().fold(f64::INFINITY, f64::min);
                let radius = threshold * power;
                if lowest > radius * radius {
                    continue;
                }
                candidates.push(Candidate {
                    a: number_a,
                    b: number_b,
                    points,
                    heights,
                    radii: (way_a.radius + way_b.radius) * power,
                    error: (way_a.error + way_b.error) * power,
                });
            }
        }
        candidates
    }

    /// Returns how far each sphere reaches along the direction from body b to body a, m: those of a
    /// at least, from b's position, and those of b at most. The separation of two spheres is never
    /// below the difference.
    fn reaches(&self) -> [Vec<f64>; 2] {
        let direction = self.direction();
        let [ways_a, ways_b] = &self.ways;
        let base = self.base.map(|point| point.dot(direction));
        let least = |way: &SphereWay| {
            let places = [0, 1, 2, 3].map(|k| base[k] + way.points[k].dot(direction));
            places.into_iter().fold(f64::INFINITY, f64::min) - (way.radius + way.error)
        };
        let most = |way: &SphereWay| {
            let places = way.points.map(|point| point.dot(direction));
            places.into_iter().fold(f64::NEG_INFINITY, f64::max) + (way.radius + way.error)
        };
        [
            ways_a.iter().map(least).collect(),
            ways_b.iter().map(most).collect(),
        ]
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

    /// Returns two spheres that reach far towards each other's bodies: probably among the nearest.
    pub(super) fn facing(&self) -> (u32, u32) {
        let [reaches_a, reaches_b] = self.reaches();
        let smallest = |reaches: &[f64], sign: f64| {
            let mut least = (f64::INFINITY, 0);
            for (number, reach) in (0..).zip(reaches) {
                if sign * reach < least.0 {
                    least = (sign * reach, number);
                }
            }
            least.1
        };
        (smallest(&reaches_a, 1.0), smallest(&reaches_b, -1.0))
    }

    /// Returns two spheres over the part.
    pub(super) fn pair(&self, (a, b): (u32, u32)) -> SpherePair {
        let (way_a, way_b) = (&self.ways[0][a as usize], &self.ways[1][b as usize]);
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
