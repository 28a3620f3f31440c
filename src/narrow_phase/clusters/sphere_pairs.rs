//! The pairs of spheres of two clusters, and their motion over a span.

use crate::hitbox::Sphere;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::relative::{RelativeMotion, local_scale};
use crate::narrow_phase::sphere_pair::{SpherePair, spheres_beyond};
use crate::rounding::{seen_from, seen_until};
use crate::spans::Span;
use glam::DVec3;

/// Two clusters over a span.
pub(in crate::narrow_phase) struct ClusterPair<'a> {
    pub(super) a: &'a BodyView<'a>,
    pub(super) b: &'a BodyView<'a>,
    pub(super) span: Span,
    pub(super) motion: RelativeMotion,
    /// What the rounding of the motion is relative to, m.
    pub(super) scale: f64,
}

/// What a pair of spheres that was solved shows: that the bodies are within the margin from one
/// instant to another one (s), and then as near as this (m) at some time.
#[derive(Clone, Copy, Debug)]
pub(in crate::narrow_phase) struct ProvenContact {
    pub(in crate::narrow_phase) enter: f64,
    pub(in crate::narrow_phase) exit: f64,
    pub(in crate::narrow_phase) separation: f64,
}

/// A pair of spheres, and a bound on how near it comes.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpherePairBound {
    pub(super) a: u32,
    pub(super) b: u32,
    /// Not above the least separation, m, but for [`PiecewiseLinearBound::slack`].
    pub(super) low: f64,
}

impl<'a> ClusterPair<'a> {
    pub(in crate::narrow_phase) fn of(
        a: &'a BodyView<'a>,
        b: &'a BodyView<'a>,
        span: Span,
    ) -> Self {
        let [segment_a, segment_b] = &a.segments_in(b, span);
        let interval = (span.start, span.end);
        Self {
            a,
            b,
            span,
            motion: RelativeMotion::between(segment_a, segment_b, interval),
            scale: local_scale(segment_a, segment_b, interval, DVec3::ZERO),
        }
    }

    /// When to look at the motion for all that is reported of a window (s): instants that are reported
    /// are rounded.
    pub(super) fn part(&self, (from, to): (f64, f64)) -> (f64, f64) {
        let (start, end) = (self.span.start, self.span.end);
        (start.max(seen_from(from)), end.min(seen_until(to)))
    }

    /// Control points of the bodies' relative motion between two instants of the span (s).
    pub(super) fn points_between(&self, interval: (f64, f64)) -> [DVec3; 4] {
        let Self { a, b, span, .. } = *self;
        let [segment_a, segment_b] = &a.segments_in(b, span);
        RelativeMotion::between(segment_a, segment_b, interval).points(DVec3::ZERO)
    }

    pub(super) fn spheres(&self, candidate: &SpherePairBound) -> (&'a Sphere, &'a Sphere) {
        (
            &self.a.spheres[candidate.a as usize],
            &self.b.spheres[candidate.b as usize],
        )
    }

    pub(super) fn offset(&self, candidate: &SpherePairBound) -> DVec3 {
        let (a, b) = self.spheres(candidate);
        a.offset - b.offset
    }

    pub(super) fn pair(&self, candidate: &SpherePairBound) -> SpherePair {
        let (a, b) = self.spheres(candidate);
        SpherePair {
            a: candidate.a,
            b: candidate.b,
            radius_a: a.radius,
            radius_b: b.radius,
            cubic: self.motion.of_spheres(a.offset - b.offset),
        }
    }

    /// Whether cheap tests show that the separation of two spheres stays above `margin` on the part
    /// of the span with these control points of theirs.
    pub(super) fn is_beyond(
        &self,
        points: &[DVec3; 4],
        candidate: &SpherePairBound,
        margin: f64,
    ) -> bool {
        let (a, b) = self.spheres(candidate);
        let scale = self.scale + (a.offset - b.offset).abs().element_sum();
        spheres_beyond(points, (a.radius, b.radius), margin, scale)
    }
}

/// Spheres are counted in 32 bits; more of them do not fit into memory.
#[allow(clippy::cast_possible_truncation, reason = "see above")]
pub(super) const fn short(number: usize) -> u32 {
    number as u32
}
