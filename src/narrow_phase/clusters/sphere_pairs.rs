//! The pairs of spheres of two clusters, and their motion over a span.

use crate::hitbox::Sphere;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::relative::{RelativeMotion, local_scale};
use crate::narrow_phase::sphere_pair::{SpherePair, spheres_beyond};
use crate::rounding::{earliest_exact, latest_exact};
use crate::spans::Span;
use glam::DVec3;

/// Two clusters over a span.
pub(in crate::narrow_phase) struct ClusterPair<'a> {
    pub(super) a: &'a BodyView<'a>,
    pub(super) b: &'a BodyView<'a>,
    pub(super) span: Span,
    pub(super) motion: RelativeMotion,
    /// Magnitude to which the rounding of the motion is relative, m.
    pub(super) scale: f64,
}

/// A contact of a solved pair of spheres: the bodies are within the margin from `enter` to `exit`
/// (s), with a least separation of at most `separation` (m).
#[derive(Clone, Copy, Debug)]
pub(in crate::narrow_phase) struct ProvenContact {
    pub(in crate::narrow_phase) enter: f64,
    pub(in crate::narrow_phase) exit: f64,
    pub(in crate::narrow_phase) separation: f64,
}

/// A pair of spheres with a lower bound of its separation.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpherePairBound {
    pub(super) a: u32,
    pub(super) b: u32,
    /// Lower bound of the least separation, m, up to the slack of the chords.
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

    /// Returns the interval of motion that determines all results for a window (s): reported
    /// instants are rounded.
    pub(super) fn part(&self, (from, to): (f64, f64)) -> (f64, f64) {
        let (start, end) = (self.span.start, self.span.end);
        (start.max(earliest_exact(from)), end.min(latest_exact(to)))
    }

    /// Returns the relative control points of the bodies between two instants of the span (s).
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
            path_error: 0.0,
            cubic: self.motion.of_spheres(a.offset - b.offset),
        }
    }

    /// Returns true if cheap tests show that the separation of two spheres stays above `margin` on
    /// the part of the span with these control points.
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
