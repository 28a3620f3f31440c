//! Pairs of bodies of which at least one turns.
//!
//! The bounding spheres, which do not turn, show when the bodies may be near each other. There, the
//! span is cut where a rotation's cubic ends. In each part every sphere's centre follows a cubic of
//! its own, so each pair of spheres is solved like two bodies of one sphere each.
//!
//! The cuts depend on the orientations alone, and each part is solved as a whole. Hence a window,
//! a margin or a slicing selects parts, and changes no bit of their results.

mod cells;
mod part;

use super::BodyView;
use super::contact_radius;
use super::filter::certainly_beyond;
use super::relative::{RelativeCubic, RelativeMotion, filter_threshold, local_scale};
use super::sphere_pair::SpherePair;
use crate::accuracy::Accuracy;
use crate::enclosure::{Side, Stretch, Threshold};
use crate::rounding::{seen_from, seen_until};
use crate::spans::Span;
use cells::Cells;
use part::SpheresOverPart;

/// Two bodies of which at least one turns, over a span.
pub(super) struct TurningPair<'a> {
    a: &'a BodyView<'a>,
    b: &'a BodyView<'a>,
    span: Span,
    accuracy: Accuracy,
}

impl<'a> TurningPair<'a> {
    /// Returns the pair, or `None` if neither body turns.
    #[inline(always)]
    pub(super) fn of(
        a: &'a BodyView<'a>,
        b: &'a BodyView<'a>,
        span: Span,
        accuracy: Accuracy,
    ) -> Option<Self> {
        (a.turning.is_some() || b.turning.is_some()).then_some(Self {
            a,
            b,
            span,
            accuracy,
        })
    }

    /// Solves the pairs of spheres that may come within `margin` in a part of the span that meets
    /// `clip`; `solve` gets that part as well.
    pub(super) fn each_within(
        &self,
        margin: f64,
        clip: (f64, f64),
        mut solve: impl FnMut(&SpherePair, Span),
    ) {
        let clip = (seen_from(clip.0), seen_until(clip.1));
        self.each_near(margin, clip, f64::NEG_INFINITY, |part| {
            part.each_within(margin, |pair| solve(pair, part.span));
        });
    }

    /// Solves the pairs of spheres that may come within `margin` in a part of the span that meets
    /// `clip` and does not begin before `after` (s). Returns the end of the last such part: the next
    /// value of `after`.
    pub(super) fn each_within_after(
        &self,
        margin: f64,
        (clip, after): ((f64, f64), f64),
        mut solve: impl FnMut(&SpherePair, Span),
    ) -> f64 {
        let clip = (seen_from(clip.0), seen_until(clip.1));
        self.each_near(margin, clip, after, |part| {
            part.each_within(margin, |pair| solve(pair, part.span));
        });
        let end = (clip.1, clip.1);
        let mut cells = Cells::of((self.a, self.b), self.span, self.accuracy, end);
        let mut last = self.span.end;
        while let Some(part) = cells.next() {
            last = part.end;
        }
        last
    }

    /// Solves the pairs of spheres that may come nearer in `clip` than `reached` (m); `solve` gets
    /// the part of the span as well, and returns the new value of `reached`.
    pub(super) fn each_for_nearest(
        &self,
        clip: (f64, f64),
        mut reached: f64,
        mut solve: impl FnMut(&SpherePair, Span) -> f64,
    ) {
        let clip = (clip.0.max(self.span.start), clip.1.min(self.span.end));
        // The parts in which the bodies come nearest go first: they rule out most others.
        let mut order: Vec<(f64, Span)> = Vec::new();
        let mut cells = Cells::of((self.a, self.b), self.span, self.accuracy, clip);
        let [segment_a, segment_b] = &self.a.segments_in(self.b, self.span);
        while let Some(part) = cells.next() {
            let ends = (clip.0.max(part.start), clip.1.min(part.end));
            if ends.0 > ends.1 {
                continue;
            }
            let middle = ends.0 + 0.5 * (ends.1 - ends.0);
            let [place_a, place_b] = [segment_a, segment_b].map(|one| one.motion_at(middle).0);
            order.push((place_a.distance_squared(place_b), part));
        }
        order.sort_by(|x, y| x.0.total_cmp(&y.0));
        for (_, part) in order {
            let at = (part.start, part.start);
            let mut cells = Cells::of((self.a, self.b), part, self.accuracy, at);
            cells.next();
            let Some(near) = self.part(&mut cells, part, reached) else {
                continue;
            };
            // Compared with one of the nearest pairs of spheres, few others are near.
            let probe = reached.is_infinite().then(|| near.facing());
            if let Some(pair) = probe {
                reached = reached.min(solve(&near.pair(pair), part));
            }
            near.each_within(reached, |pair| {
                if probe != Some((pair.a, pair.b)) {
                    reached = reached.min(solve(pair, part));
                }
            });
        }
    }

    /// Calls `visit` with each part of the span in which the bounding spheres may come within
    /// `margin`, from the one that begins at `after` (s) on.
    fn each_near(
        &self,
        margin: f64,
        (from, to): (f64, f64),
        after: f64,
        mut visit: impl FnMut(&SpheresOverPart),
    ) {
        let Some(threshold) = self.threshold(margin) else {
            return;
        };
        let [segment_a, segment_b] = &self.a.segments_in(self.b, self.span);
        let ends = (self.span.start, self.span.end);
        let offset = self.a.bounding.offset - self.b.bounding.offset;
        let cubic = RelativeCubic::between(segment_a, segment_b, ends, offset);
        let stretches = cubic.uncertain().stretches(Threshold {
            low: threshold,
            high: threshold,
        });
        // Each part of the span is visited once.
        let mut visited = after;
        for &Stretch { first, last, side } in stretches.as_slice() {
            if side == Side::Outside {
                continue;
            }
            let times = (cubic.earliest(first).max(from), cubic.latest(last).min(to));
            if times.0 > times.1 {
                continue;
            }
            let mut cells = Cells::of((self.a, self.b), self.span, self.accuracy, times);
            while let Some(part) = cells.next() {
                if part.start < visited {
                    continue;
                }
                visited = part.end.max(part.start.next_up());
                if let Some(near) = self.part(&mut cells, part, margin) {
                    visit(&near);
                }
            }
        }
    }

    /// Returns the distance within which the bounding spheres' centres are where the separation
    /// may be `margin`, or `None` if it never is.
    fn threshold(&self, margin: f64) -> Option<f64> {
        let radius = contact_radius(self.a.bounding.radius, self.b.bounding.radius, margin);
        if radius < 0.0 {
            return None;
        }
        let [segment_a, segment_b] = &self.a.segments_in(self.b, self.span);
        let ends = (self.span.start, self.span.end);
        let offset = self.a.bounding.offset - self.b.bounding.offset;
        let scale = local_scale(segment_a, segment_b, ends, offset);
        let arms = self.a.bounding.radius + self.b.bounding.radius;
        Some(filter_threshold(radius, scale + arms))
    }

    /// Returns the spheres over a part of the span, or `None` if the bounding spheres are certainly
    /// farther apart than `margin`.
    fn part(&self, cells: &mut Cells<'_>, part: Span, margin: f64) -> Option<SpheresOverPart> {
        let [segment_a, segment_b] = &self.a.segments_in(self.b, part);
        let ends = (part.start, part.end);
        let motion = RelativeMotion::between(segment_a, segment_b, ends);
        let offset = self.a.bounding.offset - self.b.bounding.offset;
        // A threshold of infinity is that of a search that has found nothing yet.
        if margin < f64::INFINITY {
            let threshold = self.threshold(margin)?;
            if certainly_beyond(&motion.points(offset), threshold) {
                return None;
            }
        }
        let scale = local_scale(segment_a, segment_b, ends, offset);
        let rotations = cells.rotations(part);
        let views = (self.a, self.b);
        let near = SpheresOverPart::new(views, part, self.accuracy, (motion, scale), &rotations);
        Some(near)
    }
}
