//! Which pairs of spheres matter, of two clusters over a span.
//!
//! All pairs follow the same relative motion, each with an offset of its own. Most that are near
//! sometime neither begin nor end a contact, nor are they ever the nearest ones, and need not be
//! solved:
//! - Chords of the motion tell from below how near a pair comes.
//! - A pair that is solved shows when the bodies are within the margin, and how near they are then.
//!   Another one matters only if it may be within the margin at another time, or be nearer.
//! - Before and after a contact bodies are apart in the direction in which they touch. The two
//!   spheres that reach farthest in it (as in GJK's support mapping) are asked first: if even they
//!   are apart, all are.
//! - Where the window and the margin are still to come (in a monitor), all pairs are kept that are the
//!   nearest ones at some time: the lower envelope of all separations.
//!
//! Each test rules out only what is certain, by more than the solver's rounding: what is reported
//! has the same bits as if every pair was solved.

mod chords;
mod envelope;
mod known;
#[cfg(test)]
mod tests;

use super::contact::SpherePair;
use super::filter::certainly_beyond;
use super::relative::{RelativeMotion, filter_threshold, local_scale};
use super::{Party, contact_radius};
use crate::hitbox::Sphere;
use crate::spans::Span;
use chords::Chords;
use envelope::Envelope;
use glam::DVec3;
use known::Known;

/// Two clusters over a span.
pub(super) struct Clusters<'a> {
    a: &'a Party<'a>,
    b: &'a Party<'a>,
    span: Span,
    motion: RelativeMotion,
    /// What the rounding of the motion is relative to, m.
    scale: f64,
}

/// What a pair of spheres that was solved shows: that the bodies are within the margin from one
/// instant to another one (s), and then as near as this (m) at some time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) enter: f64,
    pub(super) exit: f64,
    pub(super) separation: f64,
}

/// A pair of spheres, and a bound on how near it comes.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    a: u32,
    b: u32,
    /// Not above the least separation, m, but for [`Chords::slack`].
    low: f64,
}

impl<'a> Clusters<'a> {
    pub(super) fn of(a: &'a Party<'a>, b: &'a Party<'a>, span: Span) -> Self {
        let (segment_a, segment_b) = (&a.segments[span.a as usize], &b.segments[span.b as usize]);
        let interval = (span.start, span.end);
        Self {
            a,
            b,
            span,
            motion: RelativeMotion::between(segment_a, segment_b, interval),
            scale: local_scale(segment_a, segment_b, interval, DVec3::ZERO),
        }
    }

    /// Solves the pairs of spheres that matter for contacts within `margin` in `clip`; `solve` gives
    /// what is shown by each.
    pub(super) fn each_for_contacts(
        &self,
        margin: f64,
        clip: (f64, f64),
        mut solve: impl FnMut(&SpherePair, &mut Vec<Shown>),
    ) {
        let part = (self.span.start.max(clip.0), self.span.end.min(clip.1));
        if part.0 > part.1 {
            return;
        }
        let chords = Chords::of(self, part, margin);
        let candidates = chords.candidates(self, margin);
        let Some(nearest) = nearest(&candidates) else {
            return;
        };
        let toward = chords.nearest_point(self.offset(nearest));
        let mut known = Known::new(self, part, margin, (toward, chords.slack));
        let mut solved = Vec::new();
        let mut shown = Vec::new();
        let mut solve = |candidate: &Candidate, known: &mut Known<'_>, solved: &mut Vec<_>| {
            solved.push(*candidate);
            let pair = self.pair(candidate);
            if !self.is_beyond(&pair.cubic.points, candidate, margin) {
                shown.clear();
                solve(&pair, &mut shown);
                known.learn(&shown, self.offset(candidate));
            }
        };
        let mut next = Some(nearest);
        let mut others = candidates.iter();
        while let Some(candidate) = next {
            solve(candidate, &mut known, &mut solved);
            while let Some(support) = known.support() {
                let found = candidates.binary_search_by_key(&support, |other| (other.a, other.b));
                match found.map(|place| &candidates[place]) {
                    Ok(candidate) if !is_among(candidate, &solved) => {
                        solve(candidate, &mut known, &mut solved);
                    }
                    // They are apart, or were seen before: this direction does not tell.
                    _ => known.pass_over(),
                }
            }
            next =
                others.find(|other| known.may_matter(other) && !self.is_repeated(other, &solved));
        }
    }

    /// Solves the pairs of spheres one of which may be nearer in `clip` than what was `reached` so far
    /// (m); `solve` gives what is reached then.
    pub(super) fn each_for_nearest(
        &self,
        clip: (f64, f64),
        mut reached: f64,
        mut solve: impl FnMut(&SpherePair) -> f64,
    ) {
        let part = (self.span.start.max(clip.0), self.span.end.min(clip.1));
        let chords = Chords::of(self, part, 0.0);
        let candidates = chords.candidates(self, reached);
        let mut solved = Vec::new();
        for candidate in nearest(&candidates).into_iter().chain(&candidates) {
            let is_beyond = |pair: &SpherePair| {
                reached < f64::INFINITY && self.is_beyond(&pair.cubic.points, candidate, reached)
            };
            if candidate.low > reached + chords.slack || self.is_repeated(candidate, &solved) {
                continue;
            }
            let pair = self.pair(candidate);
            if !is_beyond(&pair) {
                reached = solve(&pair);
                solved.push(*candidate);
            }
        }
    }

    /// Solves the pairs of spheres that may come within `margin` and be the nearest ones of their
    /// bodies then: all that matter at this margin and smaller ones, whatever the window.
    pub(super) fn each_on_envelope(&self, margin: f64, mut solve: impl FnMut(&SpherePair)) {
        let chords = Chords::of(self, (self.span.start, self.span.end), margin);
        let candidates = chords.candidates(self, margin);
        let envelope = Envelope::of(self, &chords, &candidates);
        let mut solved = Vec::new();
        for candidate in &candidates {
            if envelope.is_above(candidate) || self.is_repeated(candidate, &solved) {
                continue;
            }
            let pair = self.pair(candidate);
            if !self.is_beyond(&pair.cubic.points, candidate, margin) {
                solve(&pair);
                solved.push(*candidate);
            }
        }
    }

    /// Control points of the bodies' relative motion between two instants of the span (s).
    fn points_between(&self, interval: (f64, f64)) -> [DVec3; 4] {
        let Self { a, b, span, .. } = self;
        let (segment_a, segment_b) = (&a.segments[span.a as usize], &b.segments[span.b as usize]);
        RelativeMotion::between(segment_a, segment_b, interval).points(DVec3::ZERO)
    }

    fn spheres(&self, candidate: &Candidate) -> (&'a Sphere, &'a Sphere) {
        (
            &self.a.spheres[candidate.a as usize],
            &self.b.spheres[candidate.b as usize],
        )
    }

    fn offset(&self, candidate: &Candidate) -> DVec3 {
        let (a, b) = self.spheres(candidate);
        a.offset - b.offset
    }

    fn pair(&self, candidate: &Candidate) -> SpherePair {
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
    fn is_beyond(&self, points: &[DVec3; 4], candidate: &Candidate, margin: f64) -> bool {
        let (a, b) = self.spheres(candidate);
        let radius = contact_radius(a.radius, b.radius, margin);
        let scale = self.scale + (a.offset - b.offset).abs().element_sum();
        // Below zero no distance is small enough, whatever the rounding.
        radius < 0.0 || certainly_beyond(points, filter_threshold(radius, scale))
    }

    /// Whether it is a pair that was solved, or moves as one that comes before it does: where they
    /// tie, that one is reported.
    fn is_repeated(&self, candidate: &Candidate, solved: &[Candidate]) -> bool {
        let (a, b) = self.spheres(candidate);
        solved.iter().any(|other| {
            let (other_a, other_b) = self.spheres(other);
            (other.a, other.b) <= (candidate.a, candidate.b)
                && self.offset(other) == a.offset - b.offset
                && (other_a.radius, other_b.radius) == (a.radius, b.radius)
        }) || is_among(candidate, solved)
    }
}

fn is_among(candidate: &Candidate, solved: &[Candidate]) -> bool {
    let mut solved = solved.iter();
    solved.any(|other| (other.a, other.b) == (candidate.a, candidate.b))
}

fn nearest(candidates: &[Candidate]) -> Option<&Candidate> {
    candidates.iter().min_by(|x, y| x.low.total_cmp(&y.low))
}
