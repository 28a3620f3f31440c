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
use crate::narrow_phase::sphere_pair::{SpherePair, difference_of_squares, farthest};
use crate::orientation::BakedRotation;
use crate::rounding::{UNIT_ROUNDOFF, norm, normalising_power};
use glam::DVec3;

/// Two bodies over a part of a span in which both rotations are cubics.
pub(super) struct SpheresOverPart<'a> {
    views: [&'a BodyView<'a>; 2],
    accuracy: Accuracy,
    rotations: [Option<&'a BakedRotation>; 2],
    motion: RelativeMotion,
    /// Control points of the bodies' relative position, m.
    base: [DVec3; 4],
    /// Magnitude to which all rounding is relative, m.
    scale: f64,
    /// Bound of both centres' errors, for any two spheres, m.
    error: f64,
}

/// Buffers that one part leaves to the next.
#[derive(Debug, Default)]
pub(super) struct PartScratch {
    /// Reach of each sphere of both bodies along a direction, m.
    reaches: [Vec<f64>; 2],
    /// Spheres of b that may be near some of a's, by number, with their control points in the unit of lengths.
    near_b: Vec<(u32, [DVec3; 4])>,
    candidates: Vec<SphereCandidate>,
    /// Candidates, each with its place among all of them, over the part, over one of its halves, and so on.
    over_halves: Vec<(usize, SphereCandidate)>,
    /// True for each candidate that may be the nearest one at some time.
    are_nearest: Vec<bool>,
    /// Lower bound of the separation of two spheres that may come near, in the unit of lengths, and their numbers.
    bounds: Vec<(f64, (u32, u32))>,
}

/// Two spheres that may come within the margin.
#[derive(Clone, Copy, Debug)]
struct SphereCandidate {
    /// Numbers of a's sphere and b's.
    spheres: (u32, u32),
    /// Control heights of the squared distance, in the square of the unit of lengths.
    heights: [f64; 7],
    /// Least height, at least 0.
    lowest: f64,
    /// Bound of the heights' rounding.
    rounding: f64,
    /// Sum of the radii, in the unit of lengths.
    radii: f64,
}

impl PartScratch {
    /// Returns two spheres that reach far towards each other's bodies: probably among the nearest.
    fn facing(&self) -> (u32, u32) {
        let [reaches_a, reaches_b] = &self.reaches;
        let toward_b = farthest(reaches_a.iter().map(|reach| -reach));
        (toward_b, farthest(reaches_b.iter().copied()))
    }
}

impl SphereCandidate {
    /// Returns the two spheres over both halves of the interval.
    fn halves(&self) -> [Self; 2] {
        let [mut first, mut second] = [*self; 2];
        let mut level = self.heights;
        for degree in (0..7).rev() {
            first.heights[6 - degree] = level[0];
            second.heights[degree] = level[degree];
            for place in 0..degree {
                level[place] = 0.5 * (level[place] + level[place + 1]);
            }
        }
        [first, second]
    }

    /// Returns what tells how near the spheres are at the start, in the middle and at the end of the part: the
    /// squared distance less the squared sum of the radii.
    fn powers(&self) -> [f64; 3] {
        let [h0, h1, h2, h3, h4, h5, h6] = self.heights;
        let middle = (((h0 + h6) + 6.0 * (h1 + h5)) + (15.0 * (h2 + h4) + 20.0 * h3)) / 64.0;
        [h0, middle, h6].map(|square| square - self.radii * self.radii)
    }

    /// Returns a bound of the distance, to rounding, in the unit of lengths.
    fn farthest(&self) -> f64 {
        self.heights.into_iter().fold(0.0, f64::max).sqrt()
    }

    /// Returns true if another pair, which stays within a distance, is nearer by more than `slack` over the
    /// whole part.
    fn is_behind(&self, (near, distance): &(Self, f64), slack: f64) -> bool {
        let excess = (self.radii - near.radii).max(0.0) + slack;
        let rounding = self.rounding + near.rounding;
        let least = difference_of_squares(*distance, excess) + rounding;
        // Without a branch: the processor cannot predict which one is behind.
        let mut lowest = f64::INFINITY;
        for (far, near) in self.heights.iter().zip(&near.heights) {
            let above = far - near;
            lowest = if above < lowest { above } else { lowest };
        }
        lowest > least
    }
}

/// Removes the candidates from `first` on in a list of which another one is nearer by more than `slack` all the time.
fn remove_behind(candidates: &mut Vec<(usize, SphereCandidate)>, first: usize, slack: f64) {
    // Those that are nearest, or nearly so, at three instants.
    let mut nearest = [(f64::INFINITY, first); 3];
    for (place, (_, candidate)) in candidates.iter().enumerate().skip(first) {
        for (nearest, power) in nearest.iter_mut().zip(candidate.powers()) {
            if power < nearest.0 {
                *nearest = (power, place);
            }
        }
    }
    let nearest = nearest.map(|(_, place)| {
        let (_, near) = candidates[place];
        (near, near.farthest())
    });
    let mut kept = first;
    for place in first..candidates.len() {
        let one = candidates[place];
        candidates[kept] = one;
        kept += usize::from(!nearest.iter().any(|near| one.1.is_behind(near, slack)));
    }
    candidates.truncate(kept);
}

/// Marks the candidates from `first` on in a list that may be the nearest ones at some time of the interval of the
/// list, and removes them from it. If they are not few, halves of the interval are looked at one by one, and halves of
/// these, so many times.
fn mark_nearest(
    candidates: &mut Vec<(usize, SphereCandidate)>,
    first: usize,
    slack: f64,
    halvings: u32,
    are_nearest: &mut [bool],
) {
    remove_behind(candidates, first, slack);
    let end = candidates.len();
    if halvings == 0 || end - first <= SpheresOverPart::FEW {
        for (number, _) in candidates.drain(first..) {
            are_nearest[number] = true;
        }
        return;
    }
    for place in first..end {
        let (number, candidate) = candidates[place];
        let [before, after] = candidate.halves();
        candidates[place].1 = before;
        candidates.push((number, after));
    }
    for first in [end, first] {
        mark_nearest(candidates, first, slack, halvings - 1, are_nearest);
    }
}

impl<'a> SpheresOverPart<'a> {
    /// Largest number of candidates of which all are solved.
    const FEW: usize = 2;
    /// Number of times that a part is halved to find the nearest candidates: rounding allows no more.
    const HALVINGS: u32 = 3;

    pub(super) fn new(
        views: [&'a BodyView<'a>; 2],
        accuracy: Accuracy,
        (motion, scale): (RelativeMotion, f64),
        rotations: [Option<&'a BakedRotation>; 2],
    ) -> Self {
        let error = |body: usize| {
            rotations[body].map_or(0.0, |one| one.error_within(views[body].bounding.radius))
        };
        Self {
            views,
            accuracy,
            rotations,
            base: motion.points(DVec3::ZERO),
            motion,
            scale,
            error: error(0) + error(1),
        }
    }

    /// Returns the control points of a sphere's centre relative to its body's position, m.
    #[inline]
    fn way(&self, body: usize, sphere: &Sphere) -> [DVec3; 4] {
        match self.rotations[body] {
            Some(rotation) => rotation.way(sphere.offset),
            None => [sphere.offset; 4],
        }
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
        let mut candidates = std::mem::take(&mut scratch.candidates);
        candidates.clear();
        self.each_candidate(margin, scratch, |candidate| candidates.push(candidate));
        self.keep_nearest(&mut candidates, scratch);
        for candidate in &candidates {
            visit(&self.pair(candidate.spheres));
        }
        scratch.candidates = candidates;
    }

    /// Keeps the candidates that may be the nearest ones at some time, unless they are few.
    fn keep_nearest(&self, candidates: &mut Vec<SphereCandidate>, scratch: &mut PartScratch) {
        if candidates.len() <= Self::FEW {
            return;
        }
        let PartScratch {
            over_halves,
            are_nearest,
            ..
        } = scratch;
        // One is farther by the errors of its centres, the other one is nearer by its own. A window may begin
        // between an instant and what that is rounded to.
        let rounding = rejection_threshold(0.0, self.scale) + self.blur();
        let slack = 2.0 * (rounding + self.error) * normalising_power(self.scale);
        are_nearest.clear();
        are_nearest.resize(candidates.len(), false);
        over_halves.clear();
        over_halves.extend(candidates.iter().copied().enumerate());
        mark_nearest(over_halves, 0, slack, Self::HALVINGS, are_nearest);
        let mut are_nearest = are_nearest.iter();
        candidates.retain(|_| are_nearest.next() == Some(&true));
    }

    /// Returns a bound on the motion of two centres between an instant and its rounded value, m; or infinity.
    fn blur(&self) -> f64 {
        let turning = |body: usize| {
            let reach = self.views[body].bounding.radius;
            self.rotations[body].map_or(0.0, |one| one.blur_within(reach))
        };
        self.motion.blur() + turning(0) + turning(1)
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
        let mut bounds = std::mem::take(&mut scratch.bounds);
        bounds.clear();
        let add = |candidate: SphereCandidate| {
            let least = candidate.lowest.sqrt() - candidate.radii;
            bounds.push((least, candidate.spheres));
        };
        if self.views[0].model_error_with(self.views[1]) > 0.0 {
            // Within it hardly a pair that is solved rules out others.
            let mut candidates = std::mem::take(&mut scratch.candidates);
            candidates.clear();
            self.each_candidate(reached, scratch, |candidate| candidates.push(candidate));
            self.keep_nearest(&mut candidates, scratch);
            candidates.drain(..).for_each(add);
            scratch.candidates = candidates;
        } else {
            self.each_candidate(reached, scratch, add);
        }
        let power = normalising_power(self.scale);
        let first = bounds.iter().min_by(|x, y| x.0.total_cmp(&y.0));
        let (first, mut solved) = (first.into_iter(), [facing, None]);
        for &(least, pair) in first.chain(&bounds) {
            let near = rejection_threshold(reached, self.scale + reached.abs()) + self.error;
            if least > near * power || solved.contains(&Some(pair)) {
                continue;
            }
            solved[1] = solved[1].or(Some(pair));
            reached = reached.min(solve(&self.pair(pair)));
        }
        scratch.bounds = bounds;
        reached
    }

    /// Calls `visit` with the pairs of spheres that cheap tests cannot rule out to come within `margin`, in
    /// the order of their numbers.
    #[inline(always)]
    fn each_candidate(
        &self,
        margin: f64,
        scratch: &mut PartScratch,
        mut visit: impl FnMut(SphereCandidate),
    ) {
        let PartScratch {
            reaches: [reaches_a, reaches_b],
            near_b,
            ..
        } = scratch;
        near_b.clear();
        // Infinite, or a distance: rounding of the reaches and of the sums is that of a rejection.
        let bound = rejection_threshold(margin, self.scale + margin.abs());
        let power = normalising_power(self.scale);
        let nearest = reaches_a.iter().copied().fold(f64::INFINITY, f64::min);
        let [spheres_a, spheres_b] = self.views.map(|view| view.spheres);
        for (number, (sphere, most)) in (0..).zip(spheres_b.iter().zip(&*reaches_b)) {
            if nearest - most <= bound {
                let [p0, p1, p2, p3] = self.way(1, sphere);
                near_b.push((number, [p0 * power, p1 * power, p2 * power, p3 * power]));
            }
        }
        let farthest = reaches_b.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [b0, b1, b2, b3] = self.base;
        for (number_a, (sphere, least)) in (0..).zip(spheres_a.iter().zip(&*reaches_a)) {
            if least - farthest > bound {
                continue;
            }
            let [p0, p1, p2, p3] = self.way(0, sphere);
            let [p0, p1, p2, p3] = [
                (b0 + p0) * power,
                (b1 + p1) * power,
                (b2 + p2) * power,
                (b3 + p3) * power,
            ];
            for &(number_b, [q0, q1, q2, q3]) in &*near_b {
                if least - reaches_b[number_b as usize] > bound {
                    continue;
                }
                let radius_b = spheres_b[number_b as usize].radius;
                let radius = if margin < f64::INFINITY {
                    contact_radius(sphere.radius, radius_b, margin) + self.error
                } else {
                    margin
                };
                if radius < 0.0 {
                    continue;
                }
                let points = [p0 - q0, p1 - q1, p2 - q2, p3 - q3];
                let heights = squared_distance(&points);
                let lowest = least_of(heights);
                // The clearance contains their rounding: see the rejection by coefficients.
                let threshold = rejection_threshold(radius, self.scale) * power;
                if lowest <= threshold * threshold {
                    visit(SphereCandidate {
                        spheres: (number_a, number_b),
                        heights,
                        lowest: lowest.max(0.0),
                        rounding: rounding_of_heights(&points),
                        radii: (sphere.radius + radius_b) * power,
                    });
                }
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
        let along = |body: usize| {
            let rotation = self.rotations[body];
            rotation.map_or([direction; 4], |rotation| {
                rotation.projected_onto(direction)
            })
        };
        let places = |[m0, m1, m2, m3]: [DVec3; 4], offset: DVec3| {
            [
                m0.dot(offset),
                m1.dot(offset),
                m2.dot(offset),
                m3.dot(offset),
            ]
        };
        let axes = along(0);
        reaches_a.clear();
        reaches_a.extend(self.views[0].spheres.iter().map(|sphere| {
            let [h0, h1, h2, h3] = places(axes, sphere.offset);
            let heights = [base[0] + h0, base[1] + h1, base[2] + h2, base[3] + h3];
            least_of(heights) - (sphere.radius + self.error)
        }));
        let axes = along(1).map(|axis| -axis);
        reaches_b.clear();
        reaches_b.extend(
            self.views[1]
                .spheres
                .iter()
                .map(|sphere| sphere.radius - least_of(places(axes, sphere.offset))),
        );
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
        let (sphere_a, sphere_b) = (sphere(0, a), sphere(1, b));
        let radius_and_error = |body: usize, sphere: &Sphere| match self.rotations[body] {
            Some(one) => one.radius_and_error((sphere.offset, sphere.radius), self.accuracy),
            None => (sphere.radius, 0.0),
        };
        let (radius_a, error_a) = radius_and_error(0, sphere_a);
        let (radius_b, error_b) = radius_and_error(1, sphere_b);
        let [p0, p1, p2, p3] = self.way(0, sphere_a);
        let [q0, q1, q2, q3] = self.way(1, sphere_b);
        SpherePair {
            a,
            b,
            radius_a,
            radius_b,
            path_error: error_a + error_b,
            cubic: self.motion.along(&[p0 - q0, p1 - q1, p2 - q2, p3 - q3]),
        }
    }
}

/// Returns a bound of the rounding of heights, of a part or of what is left of it after some
/// [halvings](SpheresOverPart::HALVINGS).
fn rounding_of_heights(points: &[DVec3; 4]) -> f64 {
    // Of the largest square: 10 of the heights of the part, 6 of their means each time.
    let squares = points.map(DVec3::length_squared);
    32.0 * UNIT_ROUNDOFF * squares.into_iter().fold(0.0, f64::max)
}

/// Returns the least of some numbers.
#[inline(always)]
fn least_of<const N: usize>(numbers: [f64; N]) -> f64 {
    let mut least = f64::INFINITY;
    for number in numbers {
        least = if number < least { number } else { least };
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Centres that meet at half time, and two spheres that stay at a tiny distance: at that instant they are
    /// farther, whatever the rounding of heights.
    #[test]
    fn spheres_that_meet_between_two_halves_are_not_behind() {
        let candidate = |points: [DVec3; 4]| SphereCandidate {
            spheres: (0, 0),
            heights: squared_distance(&points),
            lowest: 0.0,
            rounding: rounding_of_heights(&points),
            radii: 0.5,
        };
        let near = candidate([DVec3::new(0.0, 1e-10, 0.0); 4]);
        let slack = rejection_threshold(0.0, 1.0);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for round in 0..1_000 {
            let way = DVec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0)));
            let meeting = candidate([-way, way / -3.0, way / 3.0, way]);
            for half in meeting.halves() {
                let is_behind = half.is_behind(&(near, near.farthest()), slack);
                assert!(!is_behind, "{round} {way}");
            }
        }
    }
}
