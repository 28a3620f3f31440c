//! All spheres of two bodies over a part of a span, each on a cubic.
//!
//! Most pairs of spheres that come within the margin are never the nearest ones, and need not be
//! solved: all the time, another pair is nearer by more than the solver's rounding. What
//! remains suffices for contacts within any margin, and for the closest approach, in any window.
//!
//! A part with many pairs is halved, and its halves are halved again: in a short time, distances of spheres along one
//! direction tell most pairs apart. Each pair is solved over the whole part.

use super::candidates::{
    HALVINGS, SphereCandidate, find_nearest, remove_behind, rounding_of_heights,
};
use crate::accuracy::Accuracy;
use crate::blossom::restrict;
use crate::enclosure::squared_distance;
use crate::hitbox::Sphere;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::contact_radius;
use crate::narrow_phase::relative::{RelativeMotion, rejection_threshold};
use crate::narrow_phase::sphere_pair::{SpherePair, farthest};
use crate::orientation::BakedRotation;
use crate::rounding::{norm, normalising_power};
use glam::DVec3;

/// Two bodies over a part of a span in which both rotations are cubics.
pub(super) struct SpheresOverPart<'a> {
    views: [&'a BodyView<'a>; 2],
    accuracy: Accuracy,
    motion: RelativeMotion,
    whole: Interval,
    /// Magnitude to which all rounding is relative, m.
    scale: f64,
    /// Bound of both centres' errors, for any two spheres, m.
    error: f64,
}

/// The control points of two bodies' motions over the part, or over an interval of it.
struct Interval {
    /// Those of the bodies' relative position, m.
    base: [DVec3; 4],
    rotations: [Option<BakedRotation>; 2],
}

/// Buffers that one part leaves to the next.
#[derive(Debug, Default)]
pub(super) struct PartScratch {
    /// Buffers for the part, for a half of it, and so on.
    near: [NearSpheres; 1 + SpheresOverPart::INTERVAL_HALVINGS],
    candidates: Vec<SphereCandidate>,
    /// Pairs of spheres that may be the nearest ones at some time.
    nearest: Vec<(u32, u32)>,
    /// Lower bound of the separation of two spheres that may come near, in the unit of lengths, and their numbers.
    bounds: Vec<(f64, (u32, u32))>,
}

/// The spheres of two bodies that may be near the other body in an interval.
#[derive(Debug, Default)]
struct NearSpheres {
    /// Numbers of each body's spheres.
    numbers: [Vec<u32>; 2],
    /// Reach of each of these along a direction, m: see [`SpheresOverPart::find_reaches`].
    reaches: [Vec<f64>; 2],
    /// Control points of b's in the unit of lengths.
    points_b: Vec<[DVec3; 4]>,
}

impl NearSpheres {
    /// Returns two spheres that reach far towards each other's bodies: probably among the nearest.
    fn facing(&self) -> (u32, u32) {
        let [reaches_a, reaches_b] = &self.reaches;
        let toward_b = farthest(reaches_a.iter().map(|reach| -reach)) as usize;
        let toward_a = farthest(reaches_b.iter().copied()) as usize;
        (self.numbers[0][toward_b], self.numbers[1][toward_a])
    }

    /// Returns the number of pairs.
    fn pairs(&self) -> usize {
        self.numbers[0].len() * self.numbers[1].len()
    }

    /// Removes the spheres that are farther than `bound` (m) from all of the other body's.
    fn remove_far(&mut self, bound: f64) {
        let [reaches_a, reaches_b] = &self.reaches;
        let nearest = reaches_a.iter().copied().fold(f64::INFINITY, f64::min);
        let farthest = reaches_b.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let is_near = [
            |reach: f64, (_, farthest): (f64, f64), bound: f64| reach - farthest <= bound,
            |reach: f64, (nearest, _): (f64, f64), bound: f64| nearest - reach <= bound,
        ];
        let lists = self.numbers.iter_mut().zip(&mut self.reaches);
        for ((numbers, reaches), is_near) in lists.zip(is_near) {
            let mut kept = 0;
            for place in 0..numbers.len() {
                let (number, reach) = (numbers[place], reaches[place]);
                (numbers[kept], reaches[kept]) = (number, reach);
                kept += usize::from(is_near(reach, (nearest, farthest), bound));
            }
            numbers.truncate(kept);
            reaches.truncate(kept);
        }
    }
}

impl Interval {
    fn halves(&self) -> [Self; 2] {
        let mean = |p: DVec3, q: DVec3| 0.5 * (p + q);
        let [a, b] = self
            .rotations
            .map(|one| one.map(|rotation| rotation.halves()));
        let over = |half: usize, base| Self {
            base,
            rotations: [a, b].map(|halves| halves.map(|halves| halves[half])),
        };
        [
            over(0, restrict(&self.base, |p, _| p, mean)),
            over(1, restrict(&self.base, mean, |_, q| q)),
        ]
    }

    /// Returns the control points of a sphere's centre relative to its body's position, m.
    #[inline]
    fn way(&self, body: usize, sphere: &Sphere) -> [DVec3; 4] {
        match &self.rotations[body] {
            Some(rotation) => rotation.way(sphere.offset),
            None => [sphere.offset; 4],
        }
    }

    /// Returns a direction in which body a lies from body b: a unit vector, up to rounding, or zero.
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
}

impl<'a> SpheresOverPart<'a> {
    /// Number of candidates from which on those that are always farther than others are removed before more are listed.
    /// Less in tests.
    const FULL: usize = if cfg!(test) { 8 } else { 1 << 16 };
    /// Way in sums of radii from which on halving an interval tells enough pairs apart.
    const LONG: f64 = 2.0;
    /// Number of times that a part is halved where there are [many](Self::MANY) pairs of spheres. With 1 and 3, pairs
    /// of 125 spheres took 1.16 and 1.21 times as long.
    const INTERVAL_HALVINGS: usize = 2;
    /// Largest number of pairs of spheres that are looked at one by one in a part that can be halved. Less in
    /// tests, whose clusters are small.
    const MANY: usize = if cfg!(test) { 6 } else { 64 };

    pub(super) fn new(
        views: [&'a BodyView<'a>; 2],
        accuracy: Accuracy,
        (motion, scale): (RelativeMotion, f64),
        rotations: [Option<&BakedRotation>; 2],
    ) -> Self {
        let error = |body: usize| {
            rotations[body].map_or(0.0, |one| one.error_within(views[body].bounding.radius))
        };
        Self {
            views,
            accuracy,
            whole: Interval {
                base: motion.points(DVec3::ZERO),
                rotations: rotations.map(|rotation| rotation.copied()),
            },
            motion,
            scale,
            error: error(0) + error(1),
        }
    }

    fn sphere(&self, body: usize, number: u32) -> &'a Sphere {
        &self.views[body].spheres[number as usize]
    }

    /// Calls `visit` with each pair of spheres that may come within `margin` and be the nearest one
    /// then, in the order of their numbers.
    pub(super) fn each_within(
        &self,
        margin: f64,
        scratch: &mut PartScratch,
        mut visit: impl FnMut(&SpherePair),
    ) {
        self.find_nearest(margin, scratch);
        for &spheres in &scratch.nearest {
            visit(&self.pair(spheres));
        }
    }

    /// Lists the pairs of spheres that may come within `margin` (m) and be the nearest ones then, sorted, each once.
    fn find_nearest(&self, margin: f64, scratch: &mut PartScratch) {
        let PartScratch {
            near,
            candidates,
            nearest,
            ..
        } = scratch;
        nearest.clear();
        let [first, deeper @ ..] = near;
        self.list_all(first);
        let lists = (candidates, &mut *nearest);
        self.find_nearest_over(&self.whole, margin, (first, deeper), lists);
        nearest.sort_unstable();
        nearest.dedup();
    }

    /// Appends the pairs of listed spheres that may come within `margin` (m) in an interval and be the nearest ones
    /// then, some several times.
    fn find_nearest_over(
        &self,
        interval: &Interval,
        margin: f64,
        (near, deeper): (&mut NearSpheres, &mut [NearSpheres]),
        (candidates, nearest): (&mut Vec<SphereCandidate>, &mut Vec<(u32, u32)>),
    ) {
        self.find_reaches(interval, near);
        // One is farther by the errors of its centres, the other one is nearer by its own. A window may begin
        // between an instant and what that is rounded to.
        let slack = 2.0 * (rejection_threshold(0.0, self.scale) + self.blur() + self.error);
        let (mut within, mut is_long) = (margin, false);
        if near.pairs() > Self::MANY {
            let (most, way) = self.most_and_way(interval, near.facing());
            // Pairs that are always farther are not the nearest ones.
            within = within.min(most + slack);
            is_long = way > Self::LONG;
        }
        let bound = rejection_threshold(within, self.scale + within.abs());
        near.remove_far(bound);
        if is_long
            && near.pairs() > Self::MANY
            && let [next, deeper @ ..] = deeper
        {
            for half in interval.halves() {
                for (numbers, all) in next.numbers.iter_mut().zip(&near.numbers) {
                    numbers.clone_from(all);
                }
                let lists = (&mut *candidates, &mut *nearest);
                self.find_nearest_over(&half, margin, (next, deeper), lists);
            }
            return;
        }
        let slack = slack * normalising_power(self.scale);
        candidates.clear();
        let mut room = Self::FULL;
        self.each_candidate(interval, (within, bound), near, |candidate| {
            if candidates.len() == room {
                remove_behind(candidates, 0, slack);
                room = Self::FULL.max(2 * candidates.len());
            }
            candidates.push(candidate);
        });
        find_nearest(candidates, 0, slack, HALVINGS, nearest);
    }

    fn list_all(&self, near: &mut NearSpheres) {
        for (numbers, view) in near.numbers.iter_mut().zip(self.views) {
            numbers.clear();
            numbers.extend((0..).zip(view.spheres).map(|(number, _)| number));
        }
    }

    /// Returns a bound of the separation of two spheres in an interval, without the errors of their centres (m), and
    /// how far one goes relative to the other, in sums of their radii.
    fn most_and_way(&self, interval: &Interval, (a, b): (u32, u32)) -> (f64, f64) {
        let (sphere_a, sphere_b) = (self.sphere(0, a), self.sphere(1, b));
        let (p, q) = (interval.way(0, sphere_a), interval.way(1, sphere_b));
        let points = [0, 1, 2, 3].map(|place| interval.base[place] + (p[place] - q[place]));
        let farthest = points.map(norm).into_iter().fold(0.0, f64::max);
        let way: f64 = points.windows(2).map(|two| norm(two[1] - two[0])).sum();
        let radii = sphere_a.radius + sphere_b.radius;
        (farthest - radii, way / radii)
    }

    /// Returns a bound on the motion of two centres between an instant and its rounded value, m; or infinity.
    fn blur(&self) -> f64 {
        let turning = |body: usize| {
            let reach = self.views[body].bounding.radius;
            let rotation = &self.whole.rotations[body];
            rotation.map_or(0.0, |one| one.blur_within(reach))
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
        let PartScratch { near, bounds, .. } = scratch;
        let near = &mut near[0];
        self.list_all(near);
        self.find_reaches(&self.whole, near);
        // Compared with one of the nearest pairs of spheres, few others are near.
        let facing = reached.is_infinite().then(|| near.facing());
        if let Some(pair) = facing {
            reached = reached.min(solve(&self.pair(pair)));
        }
        bounds.clear();
        if self.views[0].model_error_with(self.views[1]) > 0.0 {
            // Within it hardly a pair that is solved rules out others.
            self.find_nearest(reached, scratch);
            let nearest = scratch.nearest.iter();
            let unbounded = nearest.map(|&spheres| (f64::NEG_INFINITY, spheres));
            scratch.bounds.extend(unbounded);
        } else {
            // Infinite, or a distance.
            let bound = rejection_threshold(reached, self.scale + reached.abs());
            near.remove_far(bound);
            self.each_candidate(&self.whole, (reached, bound), near, |candidate| {
                let least = candidate.lowest.sqrt() - candidate.radii;
                bounds.push((least, candidate.spheres));
            });
        }
        let bounds = &scratch.bounds;
        let power = normalising_power(self.scale);
        let first = bounds.iter().min_by(|x, y| x.0.total_cmp(&y.0));
        let (first, mut solved) = (first.into_iter(), [facing, None]);
        for &(least, pair) in first.chain(bounds) {
            let near = rejection_threshold(reached, self.scale + reached.abs()) + self.error;
            if least > near * power || solved.contains(&Some(pair)) {
                continue;
            }
            solved[1] = solved[1].or(Some(pair));
            reached = reached.min(solve(&self.pair(pair)));
        }
        reached
    }

    /// Calls `visit` with the pairs of listed spheres that cheap tests cannot rule out to come within `margin` in an
    /// interval, in the order of their numbers. Their reaches tell those apart that are farther than `bound` (m).
    #[inline(always)]
    fn each_candidate(
        &self,
        interval: &Interval,
        (margin, bound): (f64, f64),
        near: &mut NearSpheres,
        mut visit: impl FnMut(SphereCandidate),
    ) {
        let NearSpheres {
            numbers: [numbers_a, numbers_b],
            reaches: [reaches_a, reaches_b],
            points_b,
        } = near;
        let power = normalising_power(self.scale);
        points_b.clear();
        points_b.extend(numbers_b.iter().map(|&number| {
            let [p0, p1, p2, p3] = interval.way(1, self.sphere(1, number));
            [p0 * power, p1 * power, p2 * power, p3 * power]
        }));
        let [b0, b1, b2, b3] = interval.base;
        for (&number_a, least) in numbers_a.iter().zip(&*reaches_a) {
            let sphere_a = self.sphere(0, number_a);
            let [p0, p1, p2, p3] = interval.way(0, sphere_a);
            let [p0, p1, p2, p3] = [
                (b0 + p0) * power,
                (b1 + p1) * power,
                (b2 + p2) * power,
                (b3 + p3) * power,
            ];
            let others = numbers_b.iter().zip(&*reaches_b).zip(&*points_b);
            for ((&number_b, most), &[q0, q1, q2, q3]) in others {
                if least - most > bound {
                    continue;
                }
                let radius_b = self.sphere(1, number_b).radius;
                let radius = if margin < f64::INFINITY {
                    contact_radius(sphere_a.radius, radius_b, margin) + self.error
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
                        radii: (sphere_a.radius + radius_b) * power,
                    });
                }
            }
        }
    }

    /// Finds how far each listed sphere reaches in an interval along the direction from body b to body a, m: those
    /// of a at least, from b's position, and those of b at most. The separation of two spheres is never
    /// below the difference.
    fn find_reaches(&self, interval: &Interval, near: &mut NearSpheres) {
        let direction = interval.direction();
        let base = interval.base.map(|point| point.dot(direction));
        let along = |body: usize| {
            let rotation = &interval.rotations[body];
            rotation.as_ref().map_or([direction; 4], |rotation| {
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
        let NearSpheres {
            numbers: [numbers_a, numbers_b],
            reaches: [reaches_a, reaches_b],
            ..
        } = near;
        let axes = along(0);
        reaches_a.clear();
        reaches_a.extend(numbers_a.iter().map(|&number| {
            let sphere = self.sphere(0, number);
            let [h0, h1, h2, h3] = places(axes, sphere.offset);
            let heights = [base[0] + h0, base[1] + h1, base[2] + h2, base[3] + h3];
            least_of(heights) - (sphere.radius + self.error)
        }));
        let axes = along(1).map(|axis| -axis);
        reaches_b.clear();
        reaches_b.extend(numbers_b.iter().map(|&number| {
            let sphere = self.sphere(1, number);
            sphere.radius - least_of(places(axes, sphere.offset))
        }));
    }

    /// Returns two spheres over the part.
    pub(super) fn pair(&self, (a, b): (u32, u32)) -> SpherePair {
        let (sphere_a, sphere_b) = (self.sphere(0, a), self.sphere(1, b));
        let radius_and_error = |body: usize, sphere: &Sphere| match &self.whole.rotations[body] {
            Some(one) => one.radius_and_error((sphere.offset, sphere.radius), self.accuracy),
            None => (sphere.radius, 0.0),
        };
        let (radius_a, error_a) = radius_and_error(0, sphere_a);
        let (radius_b, error_b) = radius_and_error(1, sphere_b);
        let cubic = if self.whole.rotations.iter().all(Option::is_none) {
            // With the bits of a screening, which finds the nearest pairs of fixed clusters in another way.
            self.motion.of_spheres(sphere_a.offset - sphere_b.offset)
        } else {
            let [p0, p1, p2, p3] = self.whole.way(0, sphere_a);
            let [q0, q1, q2, q3] = self.whole.way(1, sphere_b);
            self.motion.along(&[p0 - q0, p1 - q1, p2 - q2, p3 - q3])
        };
        SpherePair {
            a,
            b,
            radius_a,
            radius_b,
            path_error: error_a + error_b,
            cubic,
        }
    }
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
