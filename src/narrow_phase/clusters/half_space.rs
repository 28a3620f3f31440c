//! A cluster or a turning body above a half-space.
//!
//! As with two bodies, the bounding sphere shows when the body may be near the plane, and the
//! span is cut there where the rotation's cubic ends. In each part every sphere's height is a cubic
//! of its own. A sphere need not be solved while another one is lower, by more than rounding, over
//! the whole part.

use super::sections::{Rotations, Section, Sections, each_near, nearest_first};
use crate::accuracy::Accuracy;
use crate::hitbox::Sphere;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::half_space::{PlanePair, SphereAlong};
use crate::narrow_phase::relative::rejection_threshold;
use crate::narrow_phase::sphere_pair::SpherePair;
use crate::orientation::BakedRotation;
use crate::real::least_of;
use crate::spans::Span;

/// A body that is a cluster or turns, and a half-space over a span.
pub(super) struct ClusterOverPlane<'a> {
    views: [&'a BodyView<'a>; 2],
    pair: PlanePair<'a>,
    accuracy: Accuracy,
}

impl<'a> ClusterOverPlane<'a> {
    /// Returns the pair, or `None` if neither is a half-space.
    pub(super) fn of(
        a: &'a BodyView<'a>,
        b: &'a BodyView<'a>,
        span: Span,
        accuracy: Accuracy,
    ) -> Option<Self> {
        Some(Self {
            views: [a, b],
            pair: PlanePair::of(a, b, span)?,
            accuracy,
        })
    }

    /// Solves the spheres that may come within `margin` in a part of the span that meets an interval (s)
    /// and does not begin before `after` (s).
    pub(super) fn each_near(
        &self,
        margin: f64,
        (from, to): (f64, f64),
        after: f64,
        mut solve: impl FnMut(&SpherePair, Span),
    ) {
        let span = self.pair.span;
        let interval = (from.max(span.start), to.min(span.end));
        let near = || {
            let whole = self.bounding();
            let radius = whole.radius(margin);
            let scale = self.pair.rounding_scale(span) + whole.cubic.size + margin.abs();
            let threshold = rejection_threshold(radius, scale);
            (radius >= 0.0).then(|| (whole.cubic, whole.uncertain(), threshold))
        };
        let (mut rotations, mut ways) = (Rotations::default(), Vec::new());
        let sections = |interval| self.sections(interval);
        each_near(&sections, (interval, after), &near, &mut |section| {
            self.each_lowest(section, margin, (&mut rotations, &mut ways), |pair| {
                solve(pair, section.span)
            });
        });
    }

    /// Solves the spheres that may come nearer in `window` than `reached` (m); `solve` gets the part of the
    /// span as well, and returns the new value of `reached`.
    pub(super) fn each_for_nearest(
        &self,
        window: (f64, f64),
        mut reached: f64,
        mut solve: impl FnMut(&SpherePair, Span) -> f64,
    ) {
        let span = self.pair.span;
        let window = (window.0.max(span.start), window.1.min(span.end));
        let whole = self.bounding();
        let height = |section: &Section| {
            let middle = whole.cubic.parameter(section.middle(window)?);
            Some(whole.cubic.at(middle).0.x)
        };
        let (mut rotations, mut ways) = (Rotations::default(), Vec::new());
        nearest_first(self.sections(window), &height, &mut |section| {
            let mut least = reached;
            self.each_lowest(section, reached, (&mut rotations, &mut ways), |pair| {
                least = least.min(solve(pair, section.span));
            });
            reached = least;
        });
    }

    /// Calls `visit` with the spheres that may come within `margin`, which may be infinite, in a
    /// part of the span and be the lowest ones then.
    fn each_lowest(
        &self,
        section: &Section,
        margin: f64,
        (rotations, ways): (&mut Rotations, &mut Vec<SphereAlong>),
        mut visit: impl FnMut(&SpherePair),
    ) {
        let heights = self.pair.heights(section.span);
        let least = least_of(heights.points);
        if margin < f64::INFINITY && least > self.pair.bound(margin, section.span) {
            return;
        }
        self.list_spheres(section, (rotations, ways));
        // Those that are lowest at a control point.
        let mut lowest_ones = [(f64::INFINITY, [0.0; 4]); 4];
        for sphere in &*ways {
            let ceiling = sphere
                .way
                .map(|way| way - sphere.radius + sphere.path_error);
            for (place, found) in lowest_ones.iter_mut().enumerate() {
                if ceiling[place] < found.0 {
                    *found = (ceiling[place], ceiling);
                }
            }
        }
        let scale = self.pair.rounding_scale(section.span);
        let slack = 2.0 * rejection_threshold(0.0, scale);
        let margin = rejection_threshold(margin, scale + margin.abs());
        ways.retain(|sphere| {
            let floor = sphere
                .way
                .map(|way| way - sphere.radius - sphere.path_error);
            let sum = [0, 1, 2, 3].map(|place| heights.points[place] + floor[place]);
            let is_above = |(_, other): &(f64, [f64; 4])| {
                (0..4).all(|place| floor[place] > other[place] + slack)
            };
            least_of(sum) <= margin && !lowest_ones.iter().any(is_above)
        });
        for sphere in &*ways {
            visit(&self.pair.sphere_pair(section.span, &heights, sphere));
        }
    }

    /// Lists all spheres of the body over a part of the span.
    fn list_spheres(
        &self,
        section: &Section,
        (rotations, ways): (&mut Rotations, &mut Vec<SphereAlong>),
    ) {
        let rotations = rotations.over(self.views, section, self.accuracy);
        let rotation = rotations[usize::from(self.pair.is_first)];
        let spheres = (0..).zip(self.pair.body.spheres);
        ways.clear();
        ways.extend(spheres.map(|(number, sphere)| self.sphere(number, sphere, rotation)));
    }

    fn sections(&self, interval: (f64, f64)) -> Sections<'a> {
        let [a, b] = self.views;
        Sections::of((a, b), self.pair.span, self.accuracy, interval)
    }

    /// Returns the bounding sphere over the whole span.
    fn bounding(&self) -> SpherePair {
        let sphere = SphereAlong::resting(0, self.pair.body.bounding.radius, 0.0, 0.0);
        let span = self.pair.span;
        self.pair
            .sphere_pair(span, &self.pair.heights(span), &sphere)
    }

    /// Returns a sphere of the body over a part of the span.
    fn sphere(
        &self,
        number: u32,
        sphere: &Sphere,
        rotation: Option<&BakedRotation>,
    ) -> SphereAlong {
        let (centre, radius) = (sphere.offset, sphere.radius);
        let Some(rotation) = rotation else {
            let (along, rounding) = (self.pair.along(centre), self.pair.rounding_along(centre));
            return SphereAlong::resting(number, radius, along, rounding);
        };
        let way = rotation.way(centre);
        let rounding = way.map(|point| self.pair.rounding_along(point));
        let (radius, path_error) = rotation.radius_and_error((centre, radius), self.accuracy);
        SphereAlong {
            number,
            radius,
            way: way.map(|point| self.pair.along(point)),
            rounding: rounding.into_iter().fold(0.0, f64::max),
            path_error,
        }
    }
}

#[cfg(test)]
impl ClusterOverPlane<'_> {
    /// Calls `visit` with every sphere in each part of the span.
    pub(super) fn each_sphere(&self, mut visit: impl FnMut(&SpherePair, Span)) {
        let span = self.pair.span;
        let (mut rotations, mut ways) = (Rotations::default(), Vec::new());
        for section in self.sections((span.start, span.end)) {
            let (span, heights) = (section.span, self.pair.heights(section.span));
            self.list_spheres(&section, (&mut rotations, &mut ways));
            for sphere in &ways {
                visit(&self.pair.sphere_pair(span, &heights, sphere), span);
            }
        }
    }
}
