//! All spheres of two bodies over a part of a span, each on a cubic.
//!
//! A part with many pairs is halved, and its halves are halved again: in a short time, distances of spheres along one
//! direction tell most pairs apart. Then the spheres of a body are halved: those at either side have another such
//! direction. Each pair is solved over the whole part.

use super::candidates::SphereCandidate;
use super::near::{ListedSphere, NearSpheres, SpherePath, deviation};
use crate::accuracy::Accuracy;
use crate::hitbox::Sphere;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::approach::retain_from;
use crate::narrow_phase::contact_radius;
use crate::narrow_phase::relative::{RelativeMotion, rejection_threshold};
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::orientation::BakedRotation;
use crate::real::least_of;
use crate::rounding::{norm, scale_to_one};
use glam::DVec3;
use std::collections::BTreeMap;

/// Two bodies over a part of a span in which both rotations are cubics.
pub(super) struct SpheresOverPart<'a> {
    pub(super) views: [&'a BodyView<'a>; 2],
    accuracy: Accuracy,
    pub(super) motion: RelativeMotion,
    pub(super) whole: Interval,
    /// Magnitude to which all rounding is relative, m.
    pub(super) scale: f64,
    /// Factor from metres to the unit of lengths, in which that is near one.
    pub(super) power: f64,
    /// Bound of both centres' errors, for any two spheres, m.
    pub(super) error: f64,
}

/// The control points of two bodies' motions over the part, over a stretch of it, or over an interval of that.
pub(super) struct Interval {
    /// Its ends as shares of the stretch.
    pub(super) ends: (f64, f64),
    /// Those of the bodies' relative position, m.
    pub(super) base: [DVec3; 4],
    pub(super) rotations: [Option<BakedRotation>; 2],
}

/// Buffers that one part leaves to the next.
#[derive(Debug, Default)]
pub(super) struct PartScratch {
    /// Buffers for the part, for a half of it or of its spheres, and so on.
    pub(super) near: [NearSpheres; SpheresOverPart::DEPTH],
    pub(super) buffers: CandidateBuffers,
    /// Motions that are solved, and the first spheres of which they are.
    pub(super) solved: BTreeMap<MotionKey, (u32, u32)>,
}

/// Buffers for the pairs of spheres in an interval.
#[derive(Debug, Default)]
pub(super) struct CandidateBuffers {
    /// Ways of b's listed spheres.
    paths_b: Vec<SpherePath>,
    pub(super) candidates: Vec<SphereCandidate>,
    /// Candidates that may be the nearest ones at some time.
    pub(super) nearest: Vec<(u32, u32)>,
}

/// Relative motion of two spheres in an interval.
pub(super) struct RelativePath {
    /// Bound of their separation, without the errors of their centres, m.
    pub(super) most: f64,
    /// Length of the path, in sums of radii.
    pub(super) length: f64,
    /// Deviation of the path from its chord, in sums of radii.
    pub(super) bend: f64,
}

/// Bits that tell motions of pairs of spheres apart: pairs with the same key have the same distance all the time.
pub(super) type MotionKey = [u64; 5];

impl Interval {
    /// Returns true if a body turns.
    pub(super) fn turns(&self) -> bool {
        self.rotations.iter().any(Option::is_some)
    }

    /// Returns true if this is not the result of so many halvings of the stretch.
    pub(super) fn is_divisible(&self, halvings: i32) -> bool {
        self.ends.1 - self.ends.0 > 0.5_f64.powi(halvings)
    }

    /// Returns the square of a bound of the way that the bodies get from their relative position at the start, m².
    pub(super) fn square_reach(&self) -> f64 {
        let [p0, rest @ ..] = self.base;
        let squares = rest.map(|point| (point - p0).length_squared());
        squares.into_iter().fold(0.0, f64::max)
    }

    /// Returns the first half or the second one. Halves have three roundings: other weights than a half are 0 and 1.
    pub(super) fn half(&self, number: usize) -> Self {
        let middle = 0.5 * (self.ends.0 + self.ends.1);
        let ends = [(self.ends.0, middle), (middle, self.ends.1)][number];
        let half = self.stretch([(0.0, 0.5), (0.5, 1.0)][number]);
        Self { ends, ..half }
    }

    /// Returns the control points of a point of a body relative to the body's position, m.
    #[inline]
    fn way(&self, body: usize, offset: DVec3) -> [DVec3; 4] {
        match &self.rotations[body] {
            Some(rotation) => rotation.way(offset),
            None => [offset; 4],
        }
    }
}

/// Returns four times the mean of some control points.
fn four_means(&[p0, p1, p2, p3]: &[DVec3; 4]) -> DVec3 {
    (p0 + p3) + (p1 + p2)
}

impl<'a> SpheresOverPart<'a> {
    /// Length of a [relative path](RelativePath) from which on halving an interval tells enough pairs apart, if they are many.
    pub(super) const LONG: f64 = 2.0;
    /// Bend from which on halving an interval tells enough pairs apart.
    pub(super) const BENT: f64 = 0.25;
    /// Largest number of times that a stretch, or the spheres of one body, are halved, and one more.
    const DEPTH: usize = 12;
    /// Largest number of pairs of spheres that are looked at one by one in a short interval. Less in tests.
    pub(super) const CROWDED: usize = if cfg!(test) { 12 } else { 256 };
    /// Largest number of pairs of spheres that are looked at one by one in a part that can be halved. Less in
    /// tests, whose clusters are small.
    pub(super) const MANY: usize = if cfg!(test) { 6 } else { 64 };

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
                ends: (0.0, 1.0),
                base: motion.points(DVec3::ZERO),
                rotations: rotations.map(|rotation| rotation.copied()),
            },
            motion,
            scale,
            power: scale_to_one(scale),
            error: error(0) + error(1),
        }
    }

    pub(super) fn sphere(&self, body: usize, number: u32) -> &'a Sphere {
        &self.views[body].spheres[number as usize]
    }

    /// Returns the key of the motion of two spheres: offset and radii if neither body turns, else their numbers.
    pub(super) fn motion_key(&self, (a, b): (u32, u32)) -> MotionKey {
        if self.whole.turns() {
            return [a.into(), b.into(), 0, 0, 0];
        }
        let (a, b) = (self.sphere(0, a), self.sphere(1, b));
        // Of two zeros, one.
        let [x, y, z] = (a.offset - b.offset + DVec3::ZERO).to_array();
        [x, y, z, a.radius, b.radius].map(f64::to_bits)
    }

    /// Copies a list twice, each time with a part of the spheres of the body that has more, and calls `visit` with
    /// either. Those of a part are neighbours, if that leaves either of them enough.
    pub(super) fn each_half(
        &self,
        near: &NearSpheres,
        half: &mut NearSpheres,
        mut visit: impl FnMut(&mut NearSpheres),
    ) {
        let body = usize::from(near.listed[1].len() > near.listed[0].len());
        let listed = &near.listed[body];
        let offset = |one: &ListedSphere| self.sphere(body, one.number).offset;
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for one in listed {
            let offset = offset(one);
            (low, high) = (low.min(offset), high.max(offset));
        }
        let axis = (high - low).max_position();
        let middle = low[axis].midpoint(high[axis]);
        let is_low = |one: &ListedSphere| offset(one)[axis] < middle;
        let count = listed.iter().filter(|one| is_low(one)).count();
        let is_uneven = 8 * count.min(listed.len() - count) < listed.len();
        let is_first = |place: usize, one: ListedSphere| {
            if is_uneven {
                place < listed.len() / 2
            } else {
                is_low(&one)
            }
        };
        for first in [true, false] {
            half.listed[body].clone_from(listed);
            retain_from(0, &mut half.listed[body], |place, one| {
                is_first(place, one) == first
            });
            half.listed[1 - body].clone_from(&near.listed[1 - body]);
            visit(half);
        }
    }

    pub(super) fn list_all(&self, near: &mut NearSpheres) {
        for (listed, view) in near.listed.iter_mut().zip(self.views) {
            listed.clear();
            let numbers = (0..).zip(view.spheres).map(|(number, _)| number);
            listed.extend(numbers.map(|number| ListedSphere {
                number,
                support: 0.0,
            }));
        }
    }

    /// Returns the path of a sphere's centre in an interval, from b's position.
    #[inline(always)]
    fn sphere_path(&self, interval: &Interval, body: usize, number: u32) -> SpherePath {
        let power = self.power;
        let sphere = self.sphere(body, number);
        let [p0, p1, p2, p3] = interval.way(body, sphere.offset);
        let points = if body == 0 {
            let [b0, b1, b2, b3] = interval.base;
            [b0 + p0, b1 + p1, b2 + p2, b3 + p3]
        } else {
            [p0, p1, p2, p3]
        };
        SpherePath::new(points.map(|point| point * power), sphere.radius * power)
    }

    /// Returns two spheres in an interval.
    pub(super) fn candidate(&self, interval: &Interval, (a, b): (u32, u32)) -> SphereCandidate {
        let (path_a, path_b) = (
            self.sphere_path(interval, 0, a),
            self.sphere_path(interval, 1, b),
        );
        let radii = (self.sphere(0, a).radius + self.sphere(1, b).radius) * self.power;
        SphereCandidate::new((a, b), &path_a.relative_to(&path_b), radii, 0.0)
    }

    /// Returns the least separation (m) that one of b's spheres and any of a's listed ones come within in an interval, without
    /// the errors of their centres.
    pub(super) fn least_reached(&self, interval: &Interval, near: &NearSpheres, b: u32) -> f64 {
        let path_b = self.sphere_path(interval, 1, b);
        let numbers = near.listed[0].iter().map(|one| one.number);
        let all = numbers.map(|number| {
            self.sphere_path(interval, 0, number)
                .separation_reached(&path_b)
        });
        all.fold(f64::INFINITY, f64::min) / self.power
    }

    /// Returns the relative motion of two spheres in an interval.
    pub(super) fn relative_path(&self, interval: &Interval, (a, b): (u32, u32)) -> RelativePath {
        let (sphere_a, sphere_b) = (self.sphere(0, a), self.sphere(1, b));
        let (p, q) = (
            interval.way(0, sphere_a.offset),
            interval.way(1, sphere_b.offset),
        );
        let points = [0, 1, 2, 3].map(|place| interval.base[place] + (p[place] - q[place]));
        let farthest = points.map(norm).into_iter().fold(0.0, f64::max);
        let length: f64 = points.windows(2).map(|two| norm(two[1] - two[0])).sum();
        let radii = sphere_a.radius + sphere_b.radius;
        RelativePath {
            most: farthest - radii,
            length: length / radii,
            bend: deviation(&points) / radii,
        }
    }

    /// Returns a separation along a direction beyond which two spheres are certainly farther apart than `bound`, m.
    pub(super) fn threshold(&self, bound: f64) -> f64 {
        rejection_threshold(bound, self.scale + bound.abs())
    }

    /// Returns the difference of separations below which it is not certain which pair of spheres is nearer, m.
    pub(super) fn slack(&self) -> f64 {
        // One is farther by the errors of its centres, the other one is nearer by its own. A window may begin
        // between an instant and what that is rounded to.
        2.0 * (rejection_threshold(0.0, self.scale) + self.blur() + self.error)
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

    /// Lists the pairs of listed spheres that cheap tests cannot rule out to come within `margin` (m) in an interval.
    #[inline]
    pub(super) fn list_candidates(
        &self,
        interval: &Interval,
        (margin, support): (f64, f64),
        near: &NearSpheres,
        buffers: &mut CandidateBuffers,
    ) {
        let CandidateBuffers {
            paths_b,
            candidates,
            ..
        } = buffers;
        let [listed_a, listed_b] = &near.listed;
        let power = self.power;
        candidates.clear();
        paths_b.clear();
        paths_b.extend(
            listed_b
                .iter()
                .map(|one| self.sphere_path(interval, 1, one.number)),
        );
        let bound = self.threshold(margin);
        let within = (bound + self.error) * power;
        for one in listed_a {
            let radius_a = self.sphere(0, one.number).radius;
            let path_a = self.sphere_path(interval, 0, one.number);
            for (other, path_b) in listed_b.iter().zip(&*paths_b) {
                if one.support - other.support > support {
                    continue;
                }
                let Some(distance) = path_a.distance_within(path_b, within) else {
                    continue;
                };
                let radius_b = self.sphere(1, other.number).radius;
                let radius = if margin < f64::INFINITY {
                    contact_radius(radius_a, radius_b, margin) + self.error
                } else {
                    margin
                };
                // The clearance contains all rounding: see the rejection by coefficients.
                let threshold = rejection_threshold(radius, self.scale) * power;
                let radii = (radius_a + radius_b) * power;
                let points = path_a.relative_to(path_b);
                let spheres = (one.number, other.number);
                let candidate = SphereCandidate::new(spheres, &points, radii, distance);
                if radius >= 0.0 && candidate.distance <= threshold {
                    candidates.push(candidate);
                }
            }
        }
    }

    /// Returns the direction from b's listed spheres to a's: a unit vector, up to rounding, or zero.
    fn direction(&self, interval: &Interval, near: &NearSpheres) -> DVec3 {
        let middle = |body: usize| {
            let (listed, view) = (&near.listed[body], self.views[body]);
            let offset = if listed.len() == view.spheres.len() {
                view.bounding.offset
            } else {
                let numbers = listed.iter().map(|one| one.number);
                let offsets = numbers.map(|number| self.sphere(body, number).offset);
                offsets.sum::<DVec3>() / listed.len() as f64
            };
            four_means(&interval.way(body, offset))
        };
        let sum = four_means(&interval.base) + (middle(0) - middle(1));
        let length = norm(sum);
        if length > f64::MIN_POSITIVE && length < f64::INFINITY {
            sum / length
        } else {
            DVec3::ZERO
        }
    }

    /// Finds how far each listed sphere reaches in an interval along the direction from b's to a's, m: those
    /// of a at least, from b's position, and those of b at most. The separation of two spheres is never
    /// below the difference. Finds the two foremost ones as well.
    pub(super) fn find_supports(&self, interval: &Interval, near: &mut NearSpheres) {
        let direction = self.direction(interval, near);
        let base = interval.base.map(|point| point.dot(direction));
        let axes = [0, 1].map(|body: usize| {
            let rotation = interval.rotations[body].as_ref();
            rotation.map(|rotation| rotation.projected_onto(direction))
        });
        let [listed_a, listed_b] = &mut near.listed;
        let first = |listed: &[ListedSphere], support: f64| ListedSphere {
            number: listed.first().map_or(0, |one| one.number),
            support,
        };
        let mut nearest = first(listed_a, f64::INFINITY);
        let mut farthest = first(listed_b, f64::NEG_INFINITY);
        let least = least_of(base);
        for one in listed_a {
            let sphere = self.sphere(0, one.number);
            let height = match &axes[0] {
                Some(axes) => {
                    let [m0, m1, m2, m3] = axes.map(|axis| axis.dot(sphere.offset));
                    least_of([base[0] + m0, base[1] + m1, base[2] + m2, base[3] + m3])
                }
                None => least + direction.dot(sphere.offset),
            };
            one.support = height - (sphere.radius + self.error);
            if one.support < nearest.support {
                nearest = *one;
            }
        }
        for one in listed_b {
            let sphere = self.sphere(1, one.number);
            let height = match &axes[1] {
                Some(axes) => -least_of(axes.map(|axis| -axis.dot(sphere.offset))),
                None => direction.dot(sphere.offset),
            };
            one.support = sphere.radius + height;
            if one.support > farthest.support {
                farthest = *one;
            }
        }
        near.foremost = [nearest, farthest];
        near.direction = direction;
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
        let cubic = if self.whole.turns() {
            let [p0, p1, p2, p3] = self.whole.way(0, sphere_a.offset);
            let [q0, q1, q2, q3] = self.whole.way(1, sphere_b.offset);
            self.motion.along(&[p0 - q0, p1 - q1, p2 - q2, p3 - q3])
        } else {
            self.motion.of_spheres(sphere_a.offset - sphere_b.offset)
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
