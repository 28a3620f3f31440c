//! Contacts and closest approach of one pair, over all its spans and all its spheres.

use super::clusters::{ClusterPair, KeptQuestion, ProvenContact, SolvedCuts};
use super::half_space::{self, may_touch_plane};
use super::long_arms::are_apart;
use super::profile::DistanceProfile;
use super::rejection::{certainly_beyond, segments_apart};
use super::relative::{RelativeCubic, RelativeMotion, local_scale, rejection_threshold};
use super::sphere_pair::{Approach, Contact, SpherePair};
use super::{BodyView, contact_radius, widened};
use crate::accuracy::Accuracy;
use crate::conflict::Clip;
use crate::rounding::UNIT_ROUNDOFF;
use crate::spans::Span;
use glam::DVec3;
use std::cmp::Ordering;

/// A pair of spheres whose distance over a span is solved. Contacts at any margin and window follow without a
/// search for stationary points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolvedSpan {
    span: Span,
    pair: SpherePair,
    profile: DistanceProfile,
    /// Instants at which windows may cut a contact, given all that is solved of the span, or of this part of it.
    cuts: SolvedCuts,
}

impl SolvedSpan {
    /// Returns true if windows may cut contacts at any instant.
    pub(crate) const fn may_be_cut_anywhere(&self) -> bool {
        matches!(self.cuts, SolvedCuts::Any)
    }

    /// Returns true if all pairs of spheres are solved that are needed for a window that cuts a contact at an instant (s); the
    /// span, or this part of it, is that interval (s).
    pub(crate) fn may_be_cut(&self, time: f64, interval: (f64, f64)) -> bool {
        self.cuts.has(time, interval)
    }

    /// Returns true if the distance is constant over the span.
    pub(crate) const fn is_plateau(&self) -> bool {
        self.profile.is_plateau()
    }

    /// Returns the closest approach of the two spheres in a part of a contact (s) that overlaps the span; `clip` says
    /// which ends of the part are not those of the contact.
    pub(crate) fn closest(&self, (from, to): (f64, f64), clip: Clip) -> Approach {
        let Self {
            span,
            pair,
            profile,
            ..
        } = self;
        let part = (from.max(pair.cubic.start), to.min(pair.cubic.end));
        pair.approach(*span, profile.closest_in(&pair.cubic, part, clip))
    }
}

/// Returns the only two spheres of a pair over a span, or `None` if there are more, or one turns. A
/// half-space has the effect of one sphere, and meets only one of a cluster's.
#[inline]
pub(super) fn lone_pair(a: &BodyView<'_>, b: &BodyView<'_>, span: Span) -> Option<SpherePair> {
    let ([sphere_a], [sphere_b]) = (a.spheres, b.spheres) else {
        return half_space::lone_pair(a, b, span);
    };
    if a.turning.is_some() || b.turning.is_some() {
        return None;
    }
    let [segment_a, segment_b] = &a.segments_in(b, span);
    let offset = sphere_a.offset - sphere_b.offset;
    Some(SpherePair {
        a: 0,
        b: 0,
        radius_a: sphere_a.radius,
        radius_b: sphere_b.radius,
        path_error: 0.0,
        cubic: RelativeCubic::between(segment_a, segment_b, (span.start, span.end), offset),
    })
}

/// Returns true if cheap tests cannot exclude that the bounding spheres of a pair come within the
/// margin in `from..=to`, a part of a span.
pub(crate) fn may_touch(
    a: &BodyView<'_>,
    b: &BodyView<'_>,
    span: Span,
    margin: f64,
    interval: (f64, f64),
) -> bool {
    if a.is_half_space() || b.is_half_space() {
        return may_touch_plane(a, b, span, margin, interval);
    }
    let radius = contact_radius(a.bounding.radius, b.bounding.radius, margin);
    if radius < 0.0 {
        return false;
    }
    let [segment_a, segment_b] = &a.segments_in(b, span);
    let offset = a.bounding.offset - b.bounding.offset;
    let whole = (span.start, span.end);
    let scale = local_scale(segment_a, segment_b, whole, offset);
    let threshold = rejection_threshold(radius, scale);
    let within_knots = segment_a.covers(whole.0, whole.1) && segment_b.covers(whole.0, whole.1);
    if within_knots && segments_apart(segment_a, segment_b, offset, threshold) {
        return false;
    }
    let part = (whole.0.max(interval.0), whole.1.min(interval.1));
    let motion = RelativeMotion::between(segment_a, segment_b, part);
    if certainly_beyond(&motion.points(offset), threshold) {
        return false;
    }
    if a.has_long_arms() || b.has_long_arms() {
        let scale = scale + 4.0 * (a.bounding.radius + b.bounding.radius);
        let points = motion.points(DVec3::ZERO);
        return !are_apart([a, b], (&points, part), (margin, scale));
    }
    true
}

/// Solves each pair of spheres over a span that matters to a question, and calls `solved` with those that come within the
/// largest margin, and with the interval in which they are solved (s). The bodies' model errors are added to the
/// margins.
///
/// If a body turns, only the parts of the span that meet `window` and do not begin before `after` (s) are
/// solved: a span may last for ever. Returns the next value of `after`, infinity if all of
/// the span is solved.
pub(crate) fn solve(
    a: &BodyView<'_>,
    b: &BodyView<'_>,
    span: Span,
    asked: &KeptQuestion<'_>,
    (window, after): ((f64, f64), f64),
    mut solved: impl FnMut((f64, f64), SolvedSpan),
) -> f64 {
    let margin = widened(asked.largest_margin(), a.model_error_with(b));
    let mut solve = |pair: &SpherePair, span: Span, cuts: SolvedCuts| {
        let radius = pair.radius(margin);
        if radius < 0.0 {
            return None;
        }
        let profile = DistanceProfile::of(&pair.cubic);
        if !profile.comes_within(&pair.cubic, radius) {
            return None;
        }
        let interval = (span.start, span.end);
        let pair = *pair;
        let span = SolvedSpan {
            span,
            pair,
            profile,
            cuts,
        };
        solved(interval, span);
        Some(profile)
    };
    if let Some(pair) = lone_pair(a, b, span) {
        solve(&pair, span, SolvedCuts::Any);
        return f64::INFINITY;
    }
    let clusters = ClusterPair::of(a, b, span, Accuracy::Exact);
    clusters.solve_parts((asked, margin), (window, after), solve)
}

/// Appends all maximal intervals of `window` with separation of at most `margin` and the bodies' model
/// errors, in time order, to `found`.
///
/// Spans missing in `spans` must be free of contact.
pub(crate) fn contacts(
    a: &BodyView<'_>,
    b: &BodyView<'_>,
    spans: impl Iterator<Item = Span>,
    margin: f64,
    window: (f64, f64),
    found: &mut Vec<Contact>,
) {
    let margin = widened(margin, a.model_error_with(b));
    let first = found.len();
    for span in spans {
        // For lone spheres the caller has run the test that each pair of spheres of clusters still has to pass, or one
        // of hulls that is as strict.
        let asked = (Accuracy::Exact, margin, window);
        each_for_contacts((a, b), span, asked, |pair, part, proven| {
            let count = found.len();
            let profile = DistanceProfile::of(&pair.cubic);
            pair.contacts(&profile, part, margin, window, found);
            if let Some(proven) = proven {
                proven.extend(found[count..].iter().map(|contact| ProvenContact {
                    enter: contact.enter,
                    exit: contact.exit,
                    separation: contact.closest.separation,
                }));
            }
        });
    }
    join(found, first);
}

/// Solves the pairs of spheres over a span that may begin or end a contact within a margin (m) and a window (s), or be the
/// nearest ones in it. `solve` gets the span, or the part of it that was solved. If others depend on it, `solve` appends
/// what it proves to an empty list.
pub(super) fn each_for_contacts(
    (a, b): (&BodyView<'_>, &BodyView<'_>),
    span: Span,
    (accuracy, margin, window): (Accuracy, f64, (f64, f64)),
    mut solve: impl FnMut(&SpherePair, Span, Option<&mut Vec<ProvenContact>>),
) {
    match lone_pair(a, b, span) {
        Some(pair) => solve(&pair, span, None),
        None => ClusterPair::of(a, b, span, accuracy).each_for_contacts(margin, window, solve),
    }
}

/// Appends the contacts from spans of one pair that were solved at this margin or a larger one. The
/// margin includes the bodies' model errors.
pub(crate) fn contacts_of<'s>(
    solved: impl Iterator<Item = &'s SolvedSpan>,
    margin: f64,
    window: (f64, f64),
    found: &mut Vec<Contact>,
) {
    let first = found.len();
    for SolvedSpan {
        span,
        pair,
        profile,
        ..
    } in solved
    {
        pair.contacts(profile, *span, margin, window, found);
    }
    join(found, first);
}

/// Returns the time, s, to which the rounding of the ends of a contact of two spheres is relative: the duration of its span,
/// whose local parameter is rounded; none if the distance is constant.
fn rounded_time(contact: &Contact) -> f64 {
    let Approach { span, plateau, .. } = contact.closest;
    if plateau > 0.0 {
        0.0
    } else {
        span.end - span.start
    }
}

/// Joins the contacts from index `first` on that overlap or touch, across spans and spheres. Where one sphere takes over from
/// another just at the margin, both ends are rounded: they touch if no more lies between them.
pub(super) fn join(contacts: &mut Vec<Contact>, first: usize) {
    /// Rounding of a local parameter, and as much again for the distance that is solved.
    const ROUNDING: f64 = 16.0 * UNIT_ROUNDOFF;
    contacts[first..].sort_unstable_by(|x, y| {
        x.enter
            .total_cmp(&y.enter)
            .then(x.exit.total_cmp(&y.exit))
            .then(x.closest.sphere_a.cmp(&y.closest.sphere_a))
            .then(x.closest.sphere_b.cmp(&y.closest.sphere_b))
            // At a knot both spans may have a contact of no duration.
            .then(x.closest.span.start.total_cmp(&y.closest.span.start))
    });
    let (mut last, mut time_of_last) = (first, contacts.get(first).map_or(0.0, rounded_time));
    for next in first + 1..contacts.len() {
        let contact = contacts[next];
        let joined = &mut contacts[last];
        let own_time = rounded_time(&contact);
        let longest = time_of_last.max(own_time);
        // Not more than instants are rounded, however long the span.
        let rounding = ROUNDING * longest.min(contact.enter.abs());
        if contact.enter <= (joined.exit + rounding).next_up() {
            match contact.exit.total_cmp(&joined.exit) {
                Ordering::Less => {}
                // That of all contacts that end there: which of them were solved makes no difference.
                Ordering::Equal => time_of_last = longest,
                Ordering::Greater => (joined.exit, time_of_last) = (contact.exit, own_time),
            }
            joined.closest = joined.closest.or_lower(contact.closest);
        } else {
            last += 1;
            (contacts[last], time_of_last) = (contact, own_time);
        }
    }
    contacts.truncate(contacts.len().min(last + 1));
}

/// Returns the least separation over `spans` within `window`, the earliest of ties, if any.
pub(crate) fn closest_approach(
    a: &BodyView<'_>,
    b: &BodyView<'_>,
    spans: impl Iterator<Item = Span>,
    (from, to): (f64, f64),
) -> Option<Approach> {
    let mut nearest = ClosestSearch::new();
    for span in spans {
        let least_so_far = nearest.least_so_far;
        let accuracy = Accuracy::Exact;
        each_for_nearest(
            (a, b),
            span,
            accuracy,
            (from, to),
            least_so_far,
            |pair, span| nearest.push(pair, span, (from, to)),
        );
        nearest.end_span();
    }
    nearest.closest
}

/// Solves the pairs of spheres over a span that may come nearer in `window` than `least_so_far` (m);
/// `solve` gets the span, or the part of it that was solved, and returns the new value of
/// `least_so_far`.
pub(super) fn each_for_nearest(
    (a, b): (&BodyView<'_>, &BodyView<'_>),
    span: Span,
    accuracy: Accuracy,
    window: (f64, f64),
    least_so_far: f64,
    mut solve: impl FnMut(&SpherePair, Span) -> f64,
) {
    match lone_pair(a, b, span) {
        Some(pair) => {
            if !pair.is_beyond(least_so_far) {
                solve(&pair, span);
            }
        }
        None => ClusterPair::of(a, b, span, accuracy).each_for_nearest(window, least_so_far, solve),
    }
}

/// A search for the closest approach, span by span.
#[derive(Debug)]
pub(super) struct ClosestSearch {
    pub(super) closest: Option<Approach>,
    /// Results for the sphere pairs of the current span, in the order of solving.
    found: Vec<Approach>,
    /// Upper bound of the least separation, m: others matter only if below.
    pub(super) least_so_far: f64,
}

impl ClosestSearch {
    pub(super) const fn new() -> Self {
        Self {
            closest: None,
            found: Vec::new(),
            least_so_far: f64::INFINITY,
        }
    }

    /// Adds a pair of spheres over a span; returns the new value of `least_so_far`, m.
    pub(super) fn push(&mut self, pair: &SpherePair, span: Span, times: (f64, f64)) -> f64 {
        let approach = pair.closest(span, times);
        self.found.push(approach);
        self.least_so_far = self.least_so_far.min(approach.separation);
        self.least_so_far
    }

    /// Ends a span. Ties are broken by sphere numbers, not by the order of solving.
    pub(super) fn end_span(&mut self) {
        self.found.sort_by(|x, y| {
            let spheres = (x.sphere_a, x.sphere_b).cmp(&(y.sphere_a, y.sphere_b));
            spheres.then(x.span.start.total_cmp(&y.span.start))
        });
        let found = self.found.drain(..);
        self.closest = self
            .closest
            .into_iter()
            .chain(found)
            .reduce(Approach::or_lower);
        // Of distances that are constant the earliest counts, though another may be lower by rounding.
        let closest = self.closest.map(|closest| closest.separation);
        self.least_so_far = closest.unwrap_or(f64::INFINITY);
    }
}
