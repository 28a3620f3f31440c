//! Certified contacts and closest approach of one pair.
//!
//! Each pair of spheres over a span is a cubic with an error bound. [`enclosure`](crate::enclosure)
//! divides the span into intervals that are certainly inside the threshold, certainly outside, and
//! undecided. Touching or overlapping intervals that are not outside are joined, over all spans and
//! spheres: a conflict. So no contact is lost, and undecided gaps are bridged and marked.
//!
//! # Model errors
//!
//! Let e be the sum of both bodies' model errors, s the separation of the splines, and w that of
//! the world: |s - w| <= e at all times, and nothing else is known of w. An interval is certainly inside
//! where s < margin - e, certainly outside where s > margin + e: the threshold is an interval of
//! that width. With m the least s of an interval, the least w lies in m ± e. It is attained only
//! where s <= m + 2 e, which one more partition tells. So rejections keep what is within margin + e
//! for contacts, and what is within m + 2 e for closest approaches. (A pair of spheres that is behind
//! another one at all times adds nothing, whatever e.)
//!
//! The plain solver gives the reported numbers; those outside the enclosures because of its
//! rounding are moved into them.

use super::clusters::ProvenContact;
use super::contact::{ClosestSearch, each_for_contacts, each_for_nearest};
use super::profile::DistanceProfile;
use super::sphere_pair::{Approach, Contact, SpherePair};
use super::{BodyView, contact_radius, widened};
use crate::accuracy::{Accuracy, Certificate, TimeEnclosure};
use crate::enclosure::{Stretch, Threshold, Verdict};
use crate::rounding::two_sum;
use crate::spans::Span;
use separation::{LeastSeparationSearch, SeparationEnclosure};
use std::iter::once;

mod separation;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CertifiedContact {
    pub(crate) contact: Contact,
    pub(crate) certificate: Certificate,
}

/// Reusable buffers of a pair's work.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    members: Vec<UncertainPair>,
    intervals: Vec<VerdictInterval>,
    summaries: Vec<MemberSummary>,
}

/// Two spheres over a span in which they are not certainly apart.
#[derive(Clone, Copy, Debug)]
struct UncertainPair {
    span: Span,
    pair: SpherePair,
    /// Number of its intervals, also of those outside the window.
    count: usize,
}

/// An interval in which a member is not certainly apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct VerdictInterval {
    start: f64,
    end: f64,
    side: Verdict,
    /// Number of the member in the order of solving.
    member: usize,
    /// True if the window cuts it.
    is_clipped: bool,
}

/// A member's intervals in a group.
#[derive(Clone, Copy, Debug)]
struct MemberSummary {
    member: usize,
    /// Hull of its intervals, s.
    start: f64,
    end: f64,
    /// Number of those that the window does not cut.
    count: usize,
    /// True if it is certainly inside in one of them.
    is_inside: bool,
}

/// A margin, and the model error e of a pair of bodies, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct MarginBand {
    margin: f64,
    error: f64,
    /// Separation of the splines beyond which the bodies are certainly outside.
    pub(super) outer: f64,
}

impl MarginBand {
    pub(super) fn new(margin: f64, error: f64) -> Self {
        Self {
            margin,
            error,
            outer: widened(margin, error),
        }
    }

    /// Returns an outward enclosure of the centre distances at which two spheres may have the margin
    /// as separation.
    fn threshold(&self, (a, b): (f64, f64)) -> Threshold {
        let Threshold { low, high } = threshold(a, b, self.margin);
        if self.error > 0.0 {
            Threshold {
                low: (low - self.error).next_down(),
                high: (high + self.error).next_up(),
            }
        } else {
            Threshold { low, high }
        }
    }
}

/// Appends the contacts within `margin` and `window`, in time order, to `found`. Spans missing in
/// `spans` must be free of contact, also by the bodies' model errors.
pub(crate) fn certified_contacts(
    a: &BodyView<'_>,
    b: &BodyView<'_>,
    spans: impl Iterator<Item = Span>,
    margin: f64,
    window: (f64, f64),
    workspace: &mut Workspace,
    found: &mut Vec<CertifiedContact>,
) {
    let band = MarginBand::new(margin, a.model_error_with(b));
    let farthest = 2.0 * band.error;
    workspace.clear();
    for span in spans {
        let asked = (Accuracy::Certified, band.outer, window);
        each_for_contacts((a, b), span, asked, |pair, part, proven| {
            let verdicts = workspace.solve(pair, part, &band, window);
            let Some(proven) = proven else { return };
            // Only what is certain keeps others from being looked at.
            let inside = verdicts.iter().filter(|one| one.side == Verdict::Inside);
            proven.extend(inside.map(|one| ProvenContact {
                enter: one.start,
                exit: one.end,
                // Others that come within the model errors of it may be nearer.
                separation: widened(pair.reaches(part, (one.start, one.end)), farthest),
            }));
        });
    }
    workspace.join((a, b), &band, window, found);
}

impl Workspace {
    pub(super) fn clear(&mut self) {
        self.members.clear();
        self.intervals.clear();
    }

    /// Adds a pair of spheres over a span; returns the times of the window in which it is not certainly apart.
    pub(super) fn solve(
        &mut self,
        pair: &SpherePair,
        span: Span,
        band: &MarginBand,
        window: (f64, f64),
    ) -> &[VerdictInterval] {
        let (first, member) = (self.intervals.len(), self.members.len());
        let mut count = 0;
        let threshold = band.threshold((pair.radius_a, pair.radius_b));
        let stretches = pair.uncertain().stretches(threshold);
        for &Stretch { first, last, side } in stretches.as_slice() {
            if side == Verdict::Outside {
                continue;
            }
            let outer = (pair.cubic.earliest(first), pair.cubic.latest(last));
            let inner = (pair.cubic.latest(first), pair.cubic.earliest(last));
            // What the rounding of its times eats up is not certain any more.
            let (times, side) = if side == Verdict::Inside && inner.0 <= inner.1 {
                (inner, side)
            } else {
                (outer, Verdict::Undecided)
            };
            count += 1;
            let (start, end) = (times.0.max(window.0), times.1.min(window.1));
            if start <= end {
                self.intervals.push(VerdictInterval {
                    start,
                    end,
                    side,
                    member,
                    is_clipped: times.0 < start || times.1 > end,
                });
            }
        }
        let intervals = &self.intervals[first..];
        if !intervals.is_empty() {
            self.members.push(UncertainPair {
                span,
                pair: *pair,
                count,
            });
        }
        intervals
    }

    /// Appends the contacts of all pairs added, in time order, to `found`.
    pub(super) fn join(
        &mut self,
        views: (&BodyView<'_>, &BodyView<'_>),
        band: &MarginBand,
        window: (f64, f64),
        found: &mut Vec<CertifiedContact>,
    ) {
        let Self {
            members,
            intervals,
            summaries,
        } = self;
        intervals.sort_unstable_by(|x, y| x.start.total_cmp(&y.start));
        let mut first = 0;
        while first < intervals.len() {
            let mut end = intervals[first].end;
            let mut next = first + 1;
            while next < intervals.len() && intervals[next].start <= end {
                end = end.max(intervals[next].end);
                next += 1;
            }
            summarise(members, &intervals[first..next], summaries);
            let group = MergedConflict {
                members,
                intervals: &intervals[first..next],
                summaries,
                start: intervals[first].start,
                end,
            };
            found.extend(group.contact(views, band, window));
            first = next;
        }
    }
}

/// Returns the least separation over `spans` within `window`, its error half-width, and its time;
/// `None` without a span.
pub(crate) fn certified_approach(
    a: &BodyView<'_>,
    b: &BodyView<'_>,
    spans: impl Iterator<Item = Span>,
    (from, to): (f64, f64),
) -> Option<(Approach, f64, TimeEnclosure)> {
    let mut nearest = ClosestSearch::new();
    let mut least = LeastSeparationSearch::new(a.model_error_with(b));
    for span in spans {
        let accuracy = Accuracy::Certified;
        let near = least.near();
        each_for_nearest((a, b), span, accuracy, (from, to), near, |pair, span| {
            let (start, end) = (span.start.max(from), span.end.min(to));
            let is_whole = start <= span.start && end >= span.end;
            least.add((a, b), span, pair, is_whole, (start, end));
            nearest.push(pair, span, (from, to));
            least.near()
        });
        nearest.end_span();
    }
    let closest = nearest.closest;
    let least = least.least()?;
    let (approach, error) = least.settle(closest?);
    Some((approach, error, least.time))
}

/// Returns an outward enclosure of the exact sum of two radii and a margin.
fn threshold(a: f64, b: f64, margin: f64) -> Threshold {
    let radius = contact_radius(a, b, margin);
    let (radii, lost_radii) = two_sum(a, b);
    let (sum, lost_sum) = two_sum(radii, margin);
    let is_exact =
        lost_radii.abs() <= 0.0 && lost_sum.abs() <= 0.0 && radius.to_bits() == sum.to_bits();
    if is_exact {
        Threshold {
            low: radius,
            high: radius,
        }
    } else {
        // The rounded exact sum is within one unit in the last place of it.
        Threshold {
            low: radius.next_down(),
            high: radius.next_up(),
        }
    }
}

/// Summarises intervals by member, in the order of time and sphere numbers; replaces the content of `summaries`.
fn summarise(
    members: &[UncertainPair],
    intervals: &[VerdictInterval],
    summaries: &mut Vec<MemberSummary>,
) {
    summaries.clear();
    summaries.extend(intervals.iter().map(|interval| MemberSummary {
        member: interval.member,
        start: interval.start,
        end: interval.end,
        count: usize::from(!interval.is_clipped),
        is_inside: interval.side == Verdict::Inside,
    }));
    summaries.sort_unstable_by(|x, y| {
        let [one, other] = [x, y].map(|summary| &members[summary.member]);
        let time = one.span.start.total_cmp(&other.span.start);
        time.then((one.pair.a, one.pair.b).cmp(&(other.pair.a, other.pair.b)))
            .then(x.member.cmp(&y.member))
    });
    summaries.dedup_by(|later, summary| {
        let is_same = later.member == summary.member;
        if is_same {
            summary.start = summary.start.min(later.start);
            summary.end = summary.end.max(later.end);
            summary.count += later.count;
            summary.is_inside |= later.is_inside;
        }
        is_same
    });
}

/// Overlapping or touching intervals: one conflict.
struct MergedConflict<'w> {
    members: &'w [UncertainPair],
    /// Parts of this group by start, and their summaries by member.
    intervals: &'w [VerdictInterval],
    summaries: &'w [MemberSummary],
    start: f64,
    end: f64,
}

impl MergedConflict<'_> {
    /// Returns the conflict, or `None` if no interval is inside and the least separation is certainly
    /// above the margin. Examples: intervals cut to an instant by a window, grazing bodies.
    fn contact(
        &self,
        views: (&BodyView<'_>, &BodyView<'_>),
        band: &MarginBand,
        window: (f64, f64),
    ) -> Option<CertifiedContact> {
        let (enter, exit, resolved) = self.ends();
        let mut closest: Option<(Approach, usize)> = None;
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for (index, summary) in self.summaries.iter().enumerate() {
            let UncertainPair { span, pair, .. } = &self.members[summary.member];
            let profile = DistanceProfile::of(&pair.cubic);
            let instant = profile.closest(&pair.cubic, summary.start, summary.end);
            let approach = pair.approach(*span, instant);
            let (best, nearest) = closest.unwrap_or((approach, index));
            let is_nearer = approach.separation < best.separation;
            let nearest = if is_nearer { index } else { nearest };
            closest = Some((best.or_lower(approach), nearest));
            let radius = pair.radius(band.outer).max(0.0);
            profile.intervals_within(&pair.cubic, radius, window, |(enter, exit), _| {
                if exit >= self.start && enter <= self.end {
                    first = first.min(enter);
                    last = last.max(exit);
                }
            });
        }
        let least = closest.and_then(|(_, nearest)| self.least(views, nearest, band.error));
        let (Some(least), Some((closest, _))) = (least, closest) else {
            unreachable!("a group has intervals, and each interval a member")
        };
        if !resolved && least.low > band.margin {
            return None;
        }
        let least = least.within(self.start, self.end);
        let (closest, error) = least.settle(closest);
        Some(CertifiedContact {
            contact: Contact {
                enter: enter.nearest(first.min(closest.time)),
                exit: exit.nearest(last.max(closest.time)),
                closest,
            },
            certificate: Certificate {
                error,
                resolved,
                enter,
                exit,
                closest: least.time,
            },
        })
    }

    /// Returns the least separation of all members. The member of summary `nearest` goes first: its
    /// enclosure usually rules out most others without one of their own.
    fn least(
        &self,
        (a, b): (&BodyView<'_>, &BodyView<'_>),
        nearest: usize,
        error: f64,
    ) -> Option<SeparationEnclosure> {
        let mut least = LeastSeparationSearch::new(error);
        let others = (0..self.summaries.len()).filter(|&index| index != nearest);
        for index in once(nearest).chain(others) {
            let summary = &self.summaries[index];
            let UncertainPair { span, pair, .. } = &self.members[summary.member];
            if pair.is_beyond(least.near()) {
                continue;
            }
            let is_whole = self.is_all_of(summary);
            let times = (summary.start, summary.end);
            least.add((a, b), *span, pair, is_whole, times);
        }
        least.least()
    }

    /// Returns the beginning, the end, and true if this is certainly one conflict: some interval is
    /// inside, and so is everything between the first and the last of these.
    fn ends(&self) -> (TimeEnclosure, TimeEnclosure, bool) {
        let mut inside: Option<(f64, f64)> = None;
        let mut has_gap = false;
        let intervals = self.intervals.iter();
        for interval in intervals.filter(|interval| interval.side == Verdict::Inside) {
            let (start, end) = inside.unwrap_or((interval.start, interval.end));
            has_gap |= interval.start > end;
            inside = Some((start, end.max(interval.end)));
        }
        let (first, last) = inside.unwrap_or((self.end, self.start));
        let enter = TimeEnclosure {
            earliest: self.start,
            latest: first,
        };
        let exit = TimeEnclosure {
            earliest: last,
            latest: self.end,
        };
        (enter, exit, inside.is_some() && !has_gap)
    }

    /// Returns true if a member's least distance over its whole span is in its intervals of this group:
    /// it is certainly inside there, and certainly apart elsewhere in the span, also outside the window.
    fn is_all_of(&self, summary: &MemberSummary) -> bool {
        summary.is_inside && summary.count == self.members[summary.member].count
    }
}

#[cfg(test)]
mod tests;
