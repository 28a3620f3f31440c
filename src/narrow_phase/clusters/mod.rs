//! Selection of the pairs of spheres that matter, for two bodies of which at least one is a cluster or turns.
//!
//! The bounding spheres, which do not turn, show when the bodies may be near each other. There, the
//! span is cut where a rotation's cubic ends. In each part every sphere's centre follows a cubic of
//! its own, so each pair of spheres is solved like two bodies of one sphere each. Most pairs that come near neither
//! begin nor end a contact, nor are they ever the nearest ones:
//!
//! - A screening solves those first that are probably the nearest ones. What these prove tells how near another
//!   pair must come, and when, to matter (`search`).
//! - A monitor keeps what it solves. Of contacts as a whole, at each of its margins, it needs the same pairs (`whole`). For
//!   windows that cut a contact it needs all pairs that are the nearest ones at some time (`nearest`). Few pairs are compared
//!   sooner than solved: of these it solves all that are the nearest ones at once.
//!
//! Each test excludes a pair only if that is certain, by more than the solver's rounding. So the reported values have the
//! same bits as if every pair was solved.
//!
//! The cuts depend on the orientations alone, and each part is solved as a whole. Hence a window,
//! a margin or a slicing selects parts, and changes no bit of their results.

mod candidates;
mod half_space;
mod near;
mod nearest;
mod part;
mod proven;
mod search;
mod sections;
mod shares;
mod stretch;
#[cfg(test)]
mod tests;
mod whole;

use super::BodyView;
use super::profile::DistanceProfile;
use super::rejection::certainly_beyond;
use super::relative::{RelativeCubic, RelativeMotion, local_scale, rejection_threshold};
use super::sphere_pair::SpherePair;
use super::{contact_radius, widened};
use crate::accuracy::Accuracy;
use crate::spans::Span;
use glam::DVec3;
use half_space::ClusterOverPlane;
use nearest::NearestQuestion;
use part::{PartScratch, SpheresOverPart};
pub(super) use proven::ProvenContact;
use proven::ProvenContacts;
use search::{ClosestQuestion, ContactsQuestion};
use sections::{Rotations, Section, Sections, each_near, nearest_first};
pub(crate) use whole::KeptQuestion;
pub(super) use whole::SolvedCuts;
use whole::{MAX_MARGINS, WholeContactsQuestion};

/// Two bodies over a span, of which at least one is a cluster or turns.
pub(super) struct ClusterPair<'a> {
    a: &'a BodyView<'a>,
    b: &'a BodyView<'a>,
    span: Span,
    accuracy: Accuracy,
    /// Difference of the bounding spheres' offsets, m.
    offset: DVec3,
}

impl<'a> ClusterPair<'a> {
    /// With no more pairs of spheres, all that are the nearest ones at some time are solved at once.
    const FEW: usize = if cfg!(test) { 4 } else { 512 };

    pub(super) fn of(
        a: &'a BodyView<'a>,
        b: &'a BodyView<'a>,
        span: Span,
        accuracy: Accuracy,
    ) -> Self {
        Self {
            a,
            b,
            span,
            accuracy,
            offset: a.bounding.offset - b.bounding.offset,
        }
    }

    /// Returns the magnitude to which all rounding over a part of the span is relative, m.
    fn scale(&self, part: Span) -> f64 {
        let [segment_a, segment_b] = &self.a.segments_in(self.b, part);
        let scale = local_scale(segment_a, segment_b, (part.start, part.end), self.offset);
        // A sphere's centre, and the control points of its way. Clusters that do not turn may lie aside.
        let reach =
            |view: &BodyView<'_>| view.bounding.offset.abs().element_sum() + view.bounding.radius;
        scale + 4.0 * (reach(self.a) + reach(self.b))
    }

    /// Solves the pairs of spheres that may come within `margin` in a part of the span that meets
    /// `window` and does not begin before `after` (s). Returns the end of the last such part, the next
    /// value of `after`; infinity if it ends with the span.
    pub(super) fn solve_parts(
        &self,
        (asked, margin): (&KeptQuestion<'_>, f64),
        (window, after): ((f64, f64), f64),
        mut solve: impl FnMut(&SpherePair, Span, SolvedCuts) -> Option<DistanceProfile>,
    ) -> f64 {
        if window.1 < self.span.start {
            // A span may last for ever: its parts are not gone through before the interval comes there.
            return self.span.start;
        }
        let last = self.sections((window.1, window.1)).last();
        let reached = last.map_or(self.span.end, |section| section.span.end);
        // The last part may have bounding spheres that come near after `window` alone: it is solved as a whole.
        let parts = (window.0, reached.max(window.1));
        if let Some(over_plane) = self.over_plane() {
            over_plane.each_near(margin, parts, after, |pair, part| {
                if part.start <= window.1 {
                    solve(pair, part, SolvedCuts::Any);
                }
            });
        } else {
            let model_error = self.a.model_error_with(self.b);
            let may_be_whole = self.a.spheres.len() * self.b.spheres.len() > Self::FEW
                && asked.margins.len() <= MAX_MARGINS;
            self.each_part_near(margin, (parts, after), |part, span, scratch| {
                if span.start > window.1 {
                    return;
                }
                let cuts = asked.cuts.filter(|_| may_be_whole);
                let cuts = cuts.map_or(SolvedCuts::Any, |cuts| self.cuts_in(cuts, margin, span));
                let solve = |pair: &SpherePair| solve(pair, span, cuts);
                if let SolvedCuts::AtEnds(ends) = cuts {
                    let margins = asked.margins.iter();
                    let margins = margins.map(|&margin| widened(margin, model_error));
                    let mut question = WholeContactsQuestion::new((span, ends), margins, solve);
                    part.search(&mut question, scratch);
                } else {
                    part.search(&mut NearestQuestion::new(margin, solve), scratch);
                }
            });
        }
        if reached < self.span.end {
            reached
        } else {
            f64::INFINITY
        }
    }

    /// Returns which of these instants (s) may cut a contact within a margin (m) in a part of the span: those at its ends, or any
    /// if the bodies may be within the margin at another one.
    fn cuts_in(&self, cuts: &[f64], margin: f64, part: Span) -> SolvedCuts {
        let is_near = |time: f64| {
            let (cubic, threshold) = (self.cubic(), self.threshold(margin, self.scale(part)));
            threshold.is_some_and(|threshold| cubic.distance(cubic.parameter(time)) <= threshold)
        };
        let is_cut = |time: f64| part.start < time && time < part.end && is_near(time);
        if cuts.iter().any(|&time| is_cut(time)) {
            return SolvedCuts::Any;
        }
        let is_at = |end: f64| cuts.iter().any(|cut| cut.total_cmp(&end).is_eq());
        SolvedCuts::AtEnds([part.start, part.end].map(is_at))
    }

    /// Solves the pairs of spheres that may come nearer in `window` than `reached` (m); `solve` gets
    /// the part of the span as well, and returns the new value of `reached`.
    pub(super) fn each_for_nearest(
        &self,
        window: (f64, f64),
        mut reached: f64,
        mut solve: impl FnMut(&SpherePair, Span) -> f64,
    ) {
        if let Some(over_plane) = self.over_plane() {
            return over_plane.each_for_nearest(window, reached, solve);
        }
        let window = (window.0.max(self.span.start), window.1.min(self.span.end));
        if reached < f64::INFINITY
            && self.is_beyond(&self.motion(self.span), reached, self.scale(self.span))
        {
            return;
        }
        let cubic = self.cubic();
        let distance = |section: &Section| {
            let middle = cubic.parameter(section.middle(window)?);
            Some(cubic.at(middle).0.length_squared())
        };
        let (mut rotations, mut scratch) = (Rotations::default(), PartScratch::default());
        nearest_first(self.sections(window), &distance, &mut |section| {
            let Some(part) = self.part(section, reached, &mut rotations) else {
                return;
            };
            let solve = |pair: &SpherePair| solve(pair, section.span);
            let is_whole = window.0 <= section.span.start && section.span.end <= window.1;
            let mut question = ClosestQuestion {
                reached,
                is_whole,
                model_error: self.a.model_error_with(self.b),
                solve,
            };
            part.search(&mut question, &mut scratch);
            reached = question.reached;
        });
    }

    /// Solves the pairs of spheres that may begin or end a contact within `margin` in `window`, or be the nearest ones in it.
    /// `solve` gets the part of the span as well, and appends the pair's contacts to an empty list if others depend on them.
    pub(super) fn each_for_contacts(
        &self,
        margin: f64,
        window: (f64, f64),
        mut solve: impl FnMut(&SpherePair, Span, Option<&mut Vec<ProvenContact>>),
    ) {
        if let Some(over_plane) = self.over_plane() {
            let solve = |pair: &SpherePair, part| solve(pair, part, None);
            return over_plane.each_near(margin, window, f64::NEG_INFINITY, solve);
        }
        let mut contacts = Vec::new();
        self.each_part_near(
            margin,
            (window, f64::NEG_INFINITY),
            |part, span, scratch| {
                let proven = ProvenContacts::new(span, (margin, window));
                let mut question = ContactsQuestion {
                    proven,
                    found: &mut contacts,
                    solve: |pair: &SpherePair, found: &mut Vec<ProvenContact>| {
                        solve(pair, span, Some(found));
                    },
                };
                part.search(&mut question, scratch);
            },
        );
    }

    /// Calls `visit` with the spheres over each part of the span that meets an interval (s), does not begin before `after`
    /// (s), and in which the bounding spheres may come within `margin`.
    fn each_part_near(
        &self,
        margin: f64,
        ((from, to), after): ((f64, f64), f64),
        mut visit: impl FnMut(&SpheresOverPart<'_>, Span, &mut PartScratch),
    ) {
        let Some(threshold) = self.threshold(margin, self.scale(self.span)) else {
            return;
        };
        let (mut rotations, mut scratch) = (Rotations::default(), PartScratch::default());
        let interval = (from.max(self.span.start), to.min(self.span.end));
        let near = || {
            let cubic = self.cubic();
            Some((cubic, cubic.uncertain(), threshold))
        };
        let sections = |interval| self.sections(interval);
        each_near(&sections, (interval, after), &near, &mut |section| {
            if let Some(part) = self.part(section, margin, &mut rotations) {
                visit(&part, section.span, &mut scratch);
            }
        });
    }

    /// Returns the pair if one body is a half-space.
    fn over_plane(&self) -> Option<ClusterOverPlane<'a>> {
        ClusterOverPlane::of(self.a, self.b, self.span, self.accuracy)
    }

    fn sections(&self, interval: (f64, f64)) -> Sections<'a> {
        Sections::of((self.a, self.b), self.span, self.accuracy, interval)
    }

    /// Returns the distance within which the bounding spheres' centres are where the separation
    /// may be `margin`, or `None` if it never is.
    fn threshold(&self, margin: f64, scale: f64) -> Option<f64> {
        let radius = contact_radius(self.a.bounding.radius, self.b.bounding.radius, margin);
        (radius >= 0.0).then(|| rejection_threshold(radius, scale))
    }

    /// Returns the relative motion of the bounding spheres' centres over the whole span.
    fn cubic(&self) -> RelativeCubic {
        self.motion(self.span).of_spheres(self.offset)
    }

    /// Returns the motion of the bodies over a part of the span.
    fn motion(&self, part: Span) -> RelativeMotion {
        let [segment_a, segment_b] = &self.a.segments_in(self.b, part);
        RelativeMotion::between(segment_a, segment_b, (part.start, part.end))
    }

    /// Returns true if the bounding spheres certainly stay farther apart than `margin`.
    fn is_beyond(&self, motion: &RelativeMotion, margin: f64, scale: f64) -> bool {
        let threshold = self.threshold(margin, scale);
        threshold.is_none_or(|threshold| certainly_beyond(&motion.points(self.offset), threshold))
    }

    /// Returns the spheres over a part of the span, or `None` if the bounding spheres are certainly
    /// farther apart than `margin`, which may be infinite.
    fn part(
        &self,
        section: &Section,
        margin: f64,
        rotations: &mut Rotations,
    ) -> Option<SpheresOverPart<'a>> {
        let (motion, scale) = (self.motion(section.span), self.scale(section.span));
        if margin < f64::INFINITY && self.is_beyond(&motion, margin, scale) {
            return None;
        }
        let views = [self.a, self.b];
        let rotations = rotations.over(views, section, self.accuracy);
        let motion = (motion, scale);
        Some(SpheresOverPart::new(
            views,
            self.accuracy,
            motion,
            rotations,
        ))
    }
}
