//! Spheres above a half-space.
//!
//! The separation of a sphere from a half-space is a cubic in time: n · (p + c - w) - r, with the
//! normal n, the body's position p, the sphere's centre c, and the half-space's position w. Such a
//! pair is solved as two spheres on a line: their distance is the height above the plane. Where the
//! height may be negative, a power of two is added to it, and to the radius that stands for the
//! half-space. So the roots, the enclosures and their proofs are those of two spheres.
//!
//! The height of the body above the plane is formed first: motion along the plane does not enter
//! its rounding, but for that of the body's own cubic.

use super::relative::{
    HeightCubic, RelativeCubic, RelativeMotion, local_scale, rejection_threshold,
};
use super::sphere_pair::SpherePair;
use super::{BodyView, widened};
use crate::real::least_of;
use crate::rounding::{PLANE_CLEARANCE, UNDERFLOW, UNIT_ROUNDOFF, scale_to_one};
use crate::spans::Span;
use crate::trajectory::Segment;
use glam::DVec3;
use std::borrow::Cow;

/// A body with spheres and one with a half-space, over a span.
#[derive(Clone, Debug)]
pub(super) struct PlanePair<'a> {
    pub(super) body: &'a BodyView<'a>,
    plane: &'a BodyView<'a>,
    /// The cubics of the body and of the plane.
    segments: [Cow<'a, Segment>; 2],
    pub(super) span: Span,
    /// The half-space is body a.
    pub(super) is_first: bool,
    normal: DVec3,
    /// Inverse of the normal's length, good to 4 roundings.
    inverse_length: f64,
}

/// A sphere of the body: the way of its centre along the normal, relative to the body's position.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphereAlong {
    pub(super) number: u32,
    pub(super) radius: f64,
    /// Control points, m.
    pub(super) way: [f64; 4],
    /// Bound on their rounding, m.
    pub(super) rounding: f64,
    /// Bound on the distance of a turning centre from its cubic that the radius does not contain, m.
    pub(super) path_error: f64,
}

impl SphereAlong {
    /// Returns a sphere that does not turn, with the coordinate of its offset and a bound on that one's rounding, m.
    pub(super) const fn resting(number: u32, radius: f64, along: f64, rounding: f64) -> Self {
        Self {
            number,
            radius,
            way: [along; 4],
            rounding,
            path_error: 0.0,
        }
    }
}

/// Returns the pair of a half-space and the sphere that is nearest to it, or `None` if neither body
/// is a half-space, both are, or one turns. A body that does not turn has one sphere that is the nearest
/// at all times.
#[cold]
pub(super) fn lone_pair(a: &BodyView<'_>, b: &BodyView<'_>, span: Span) -> Option<SpherePair> {
    let pair = PlanePair::of(a, b, span)?;
    if pair.body.turning.is_some() {
        return None;
    }
    let sphere = pair.lowest_sphere();
    Some(pair.sphere_pair(span, &pair.heights(span), &sphere))
}

/// Returns true if a cheap test cannot exclude that the spheres of a pair with a half-space come
/// within the margin in `from..=to`, a part of a span. The test always excludes two half-spaces.
pub(super) fn may_touch_plane(
    a: &BodyView<'_>,
    b: &BodyView<'_>,
    span: Span,
    margin: f64,
    (from, to): (f64, f64),
) -> bool {
    let Some(pair) = PlanePair::of(a, b, span) else {
        return false;
    };
    // That of the body is part of its bounding sphere.
    let margin = widened(margin, pair.plane.model_error);
    let part = Span {
        start: span.start.max(from),
        end: span.end.min(to),
        ..span
    };
    if pair.is_far_above(margin, part) {
        return false;
    }
    let offset = pair.along(pair.body.bounding.offset);
    let least = least_of(pair.heights(part).points);
    least + offset <= pair.bound(margin, part)
}

impl<'a> PlanePair<'a> {
    /// Returns the pair, or `None` unless one body is a half-space and the other is not.
    pub(super) fn of(a: &'a BodyView<'a>, b: &'a BodyView<'a>, span: Span) -> Option<Self> {
        let is_first = a.is_half_space();
        if is_first == b.is_half_space() {
            return None;
        }
        let (body, plane) = if is_first { (b, a) } else { (a, b) };
        let (of_body, of_plane) = if is_first {
            (span.cubic_b, span.cubic_a)
        } else {
            (span.cubic_a, span.cubic_b)
        };
        let normal = plane.bounding.offset;
        Some(Self {
            body,
            plane,
            segments: [
                body.segment(of_body as usize),
                plane.segment(of_plane as usize),
            ],
            span,
            is_first,
            normal,
            // Its length is 1, nearly: no square underflows that matters.
            inverse_length: 1.0 / normal.length(),
        })
    }

    /// Returns the heights of the body's position above the plane over a part of the span.
    pub(super) fn heights(&self, part: Span) -> HeightCubic {
        let [body, plane] = &self.segments;
        let motion = RelativeMotion::between(body, plane, (part.start, part.end));
        motion.heights(self.normal, self.inverse_length)
    }

    /// Returns true if the body is so far above the plane over a part of the span that rounding does not
    /// matter.
    fn is_far_above(&self, margin: f64, part: Span) -> bool {
        let [body, plane] = &self.segments;
        let range = |segment| HeightRange::of_segment(segment, (part.start, part.end), self.normal);
        let (Some(body), Some(plane)) = (range(body), range(plane)) else {
            return false;
        };
        let bounding = self.body.bounding;
        let centre = HeightRange {
            low: body.low + bounding.offset.dot(self.normal),
            size: body.size + bounding.offset.abs().element_sum(),
            ..body
        };
        centre.is_above(&plane, bounding.radius, margin)
    }

    /// Returns the magnitude to which all rounding over a part of the span is relative, m.
    pub(super) fn rounding_scale(&self, part: Span) -> f64 {
        let [body, plane] = &self.segments;
        let bounding = self.body.bounding;
        let scale = local_scale(body, plane, (part.start, part.end), bounding.offset);
        scale + 4.0 * bounding.radius
    }

    /// Returns the height of the bounding sphere's centre (m) above which the separation certainly
    /// exceeds `margin` over a part of the span.
    pub(super) fn bound(&self, margin: f64, part: Span) -> f64 {
        let scale = self.rounding_scale(part) + margin.abs();
        rejection_threshold(self.body.bounding.radius + margin, scale)
    }

    /// Returns the coordinate of a vector along the normal, m: good to 8 roundings.
    pub(super) fn along(&self, vector: DVec3) -> f64 {
        vector.dot(self.normal) * self.inverse_length
    }

    /// Returns a bound on the rounding of [`along`](Self::along), m.
    pub(super) fn rounding_along(&self, vector: DVec3) -> f64 {
        16.0 * UNIT_ROUNDOFF * vector.abs().dot(self.normal.abs()) + UNDERFLOW
    }

    /// Returns the sphere that reaches farthest down, of a body that does not turn.
    fn lowest_sphere(&self) -> SphereAlong {
        let mut found = SphereAlong::resting(0, 0.0, 0.0, 0.0);
        let (mut least, mut rounding) = (f64::INFINITY, 0.0_f64);
        for (number, sphere) in (0..).zip(self.body.spheres) {
            let along = self.along(sphere.offset);
            let own = self.rounding_along(sphere.offset);
            rounding = rounding.max(own + 2.0 * UNIT_ROUNDOFF * (along.abs() + sphere.radius));
            if along - sphere.radius < least {
                least = along - sphere.radius;
                found = SphereAlong::resting(number, sphere.radius, along, own);
            }
        }
        if self.body.spheres.len() > 1 {
            // Another one may be lower by what rounding hides.
            found.rounding += 2.0 * rounding;
        }
        found
    }

    /// Returns a sphere and the half-space over a part of the span, as two spheres on a line.
    pub(super) fn sphere_pair(
        &self,
        part: Span,
        heights: &HeightCubic,
        sphere: &SphereAlong,
    ) -> SpherePair {
        let points = [0, 1, 2, 3].map(|k| heights.points[k] + sphere.way[k]);
        let error = heights.error + sphere.rounding;
        let unknown = error + sphere.path_error;
        let lowest = least_of(points);
        // Below the plane no distance from it is a height. Rounding may hide that; then little is added.
        let shift = if lowest > unknown {
            0.0
        } else if lowest >= -unknown {
            4.0 / scale_to_one(unknown)
        } else {
            // A power of two above twice the largest: what is added stays far from zero.
            let largest = |most: f64, height: f64| most.max(height.abs());
            4.0 / scale_to_one(points.into_iter().fold(unknown, largest))
        };
        let points = points.map(|height| height + shift);
        let size = points.into_iter().fold(0.0, f64::max);
        let (a, b, radius_a, radius_b) = if self.is_first {
            (0, sphere.number, shift, sphere.radius)
        } else {
            (sphere.number, 0, sphere.radius, shift)
        };
        SpherePair {
            a,
            b,
            radius_a,
            radius_b,
            // Not zero: the cubic is not the relative motion of the two bodies.
            path_error: sphere.path_error.max(f64::MIN_POSITIVE),
            cubic: RelativeCubic {
                start: part.start,
                end: part.end,
                points: points.map(|height| DVec3::new(height, 0.0, 0.0)),
                // It allows 16 roundings of the heights and 16 of the way, of which 10 and 8 occur. Both sums here
                // add one of what is shifted, and at most five of that.
                error,
                size,
            },
        }
    }
}

/// The lowest and the highest coordinate of a motion along a normal, rounding apart, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeightRange {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Magnitude of the coordinates, to which their rounding is relative, m.
    pub(crate) size: f64,
}

impl HeightRange {
    /// Returns true if a body with these heights, whose spheres reach so far (m), is certainly farther than
    /// `margin` (m) above a half-space with those.
    #[inline]
    pub(crate) fn is_above(&self, ground: &Self, reach: f64, margin: f64) -> bool {
        let size = self.size + ground.size + reach + margin.abs();
        self.low - ground.high > reach + margin + PLANE_CLEARANCE * size
    }

    /// Returns the heights of a segment over an interval (s), if they are found quickly.
    fn of_segment(segment: &Segment, (from, to): (f64, f64), normal: DVec3) -> Option<Self> {
        let origin = segment.origin();
        let heights = if segment.is_straight() {
            let ends = [from, to].map(|time| segment.motion_at(time).0.dot(normal));
            [ends[0], ends[1], ends[0], ends[1]]
        } else if segment.covers(from, to) {
            let height = origin.dot(normal);
            let points = segment.control_points();
            points.map(|point| height + point.dot(normal))
        } else {
            return None;
        };
        // A comparison with NaN would drop it.
        let are_known = heights.iter().all(|height| height.is_finite());
        are_known.then(|| Self {
            low: least_of(heights),
            high: heights.into_iter().fold(f64::NEG_INFINITY, f64::max),
            size: origin.abs().element_sum() + segment.rounding_scale(from, to),
        })
    }
}

#[cfg(test)]
mod tests;
