//! All spheres of two bodies over a part of a span, each on a cubic.

use crate::accuracy::Accuracy;
use crate::hitbox::Sphere;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::contact_radius;
use crate::narrow_phase::filter::certainly_beyond;
use crate::narrow_phase::relative::{RelativeMotion, filter_threshold};
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::orientation::BakedRotation;
use crate::rounding::norm;
use crate::spans::Span;
use glam::DVec3;

/// Two bodies over a part of a span in which both rotations are cubics.
pub(super) struct SpheresOverPart<'a> {
    pub(super) span: Span,
    a: &'a BodyView<'a>,
    b: &'a BodyView<'a>,
    motion: RelativeMotion,
    /// Magnitude to which all rounding is relative, m.
    scale: f64,
    ways: [Vec<SphereWay>; 2],
}

/// A sphere's centre over the part.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphereWay {
    /// Control points relative to the body's position, m.
    points: [DVec3; 4],
    /// Radius for the separation, m.
    radius: f64,
    /// Bound on the error of the points that the radius does not contain, m.
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

impl<'a> SpheresOverPart<'a> {
    pub(super) fn new(
        (a, b): (&'a BodyView<'a>, &'a BodyView<'a>),
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
            a,
            b,
            motion,
            scale: scale + 4.0 * (a.bounding.radius + b.bounding.radius),
            ways: [
                ways(a, rotations[0].as_ref()),
                ways(b, rotations[1].as_ref()),
            ],
        }
    }

    /// Returns the distance below which two spheres may come within `margin`, or `None` if none is
    /// small enough.
    fn threshold(&self, a: (f64, f64), b: (f64, f64), margin: f64) -> Option<f64> {
        if margin >= f64::INFINITY {
            return Some(margin);
        }
        let radius = contact_radius(a.0, b.0, margin) + (a.1 + b.1);
        (radius >= 0.0).then(|| filter_threshold(radius, self.scale))
    }

    /// Calls `visit` with each pair of spheres that cheap tests cannot rule out to come within
    /// `margin`, in the order of their numbers.
    pub(super) fn each_within(&self, margin: f64, mut visit: impl FnMut(&SpherePair)) {
        let base = self.motion.points(DVec3::ZERO);
        let [ways_a, ways_b] = &self.ways;
        let offset = |view: &BodyView<'_>| view.bounding.offset;
        // Each sphere against all of the other body first.
        let is_near = |points: &[DVec3; 4], own: &SphereWay, other: &BodyView<'_>| {
            let bounding = (other.bounding.radius, 0.0);
            let threshold = self.threshold((own.radius, own.error), bounding, margin);
            threshold.is_some_and(|threshold| !certainly_beyond(points, threshold))
        };
        let near_b: Vec<(u32, &SphereWay)> = (0..)
            .zip(ways_b)
            .filter(|(_, way)| {
                let points = [0, 1, 2, 3].map(|k| base[k] + (offset(self.a) - way.points[k]));
                is_near(&points, way, self.a)
            })
            .collect();
        if near_b.is_empty() {
            return;
        }
        for (number_a, way_a) in (0..).zip(ways_a) {
            let points = [0, 1, 2, 3].map(|k| base[k] + (way_a.points[k] - offset(self.b)));
            if !is_near(&points, way_a, self.b) {
                continue;
            }
            let places = [0, 1, 2, 3].map(|k| base[k] + way_a.points[k]);
            for &(number_b, way_b) in &near_b {
                let own = (way_a.radius, way_a.error);
                let Some(threshold) = self.threshold(own, (way_b.radius, way_b.error), margin)
                else {
                    continue;
                };
                let points = [0, 1, 2, 3].map(|k| places[k] - way_b.points[k]);
                if certainly_beyond(&points, threshold) {
                    continue;
                }
                visit(&self.pair((number_a, way_a), (number_b, way_b)));
            }
        }
    }

    fn pair(&self, (a, way_a): (u32, &SphereWay), (b, way_b): (u32, &SphereWay)) -> SpherePair {
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

    /// Returns a separation that is reached at one of two instants of the part, m.
    pub(super) fn separation_at_ends(&self, (from, to): (f64, f64)) -> f64 {
        let mut least = f64::INFINITY;
        let is_whole = from <= self.span.start && to >= self.span.end;
        if !is_whole {
            return least;
        }
        let base = self.motion.points(DVec3::ZERO);
        let [ways_a, ways_b] = &self.ways;
        for way_a in ways_a {
            for way_b in ways_b {
                let radii = way_a.radius + way_b.radius;
                let slack = way_a.error + way_b.error;
                for k in [0, 3] {
                    let apart = base[k] + (way_a.points[k] - way_b.points[k]);
                    least = least.min(norm(apart) - radii + slack);
                }
            }
        }
        // Others are compared with it by filters, which have the same rounding.
        filter_threshold(least, self.scale)
    }
}
