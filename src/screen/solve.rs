//! Exact solutions of the survivors, and the conflicts reported.

use super::prepared::PreparedScene;
use crate::accuracy::Accuracy;
use crate::broad_phase::PairFilter;
use crate::conflict::{Clip, ClosestApproach, Conflict};
use crate::count::as_f64;
use crate::id::BodyId;
use crate::narrow_phase::{
    Approach, BodyView, CertifiedContact, Contact, Workspace, certified_contacts, contacts,
};
use crate::parallel;
use crate::search::Bodies;
use crate::spans::{Span, SpanKey, common_window};
use glam::DVec3;
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Buffers that are reused from pair to pair.
#[derive(Default)]
pub(crate) struct SolveScratch {
    contacts: Vec<Contact>,
    certified: Vec<CertifiedContact>,
    workspace: Workspace,
}

/// A question about the conflicts of two bodies.
pub(crate) struct PairQuestion<'p> {
    /// Ids and tags in the answer.
    names: [(BodyId, u64); 2],
    pub(super) views: (&'p BodyView<'p>, &'p BodyView<'p>),
    /// Interval of the answer, s: the part of the window in which both bodies exist.
    pub(super) window: (f64, f64),
    pub(super) margin: f64,
    accuracy: Accuracy,
}

impl<'p> PairQuestion<'p> {
    /// Returns the question about two bodies within a window (s) and a margin (m), or `None` if they do not
    /// exist at the same time.
    pub(crate) fn of(
        names: [(BodyId, u64); 2],
        views: (&'p BodyView<'p>, &'p BodyView<'p>),
        (margin, accuracy): (f64, Accuracy),
        window: (f64, f64),
    ) -> Option<Self> {
        Some(Self {
            names,
            views,
            window: common_window(&views.0.knots, &views.1.knots, window)?,
            margin,
            accuracy,
        })
    }

    /// Appends the conflicts in some spans to a list, in time order.
    pub(super) fn push_conflicts(
        &self,
        spans: impl Iterator<Item = Span>,
        scratch: &mut SolveScratch,
        conflicts: &mut Vec<Conflict>,
    ) {
        let Self { margin, window, .. } = *self;
        let (a, b) = self.views;
        let reported = |contact: &Contact| conflict(contact, self.names, self.views, window);
        match self.accuracy {
            Accuracy::Exact => {
                let found = &mut scratch.contacts;
                found.clear();
                contacts(a, b, spans, margin, window, found);
                conflicts.extend(found.iter().map(reported));
            }
            Accuracy::Certified => {
                let (found, workspace) = (&mut scratch.certified, &mut scratch.workspace);
                found.clear();
                certified_contacts(a, b, spans, margin, window, workspace, found);
                conflicts.extend(found.iter().map(|certified| Conflict {
                    certificate: Some(certified.certificate),
                    ..reported(&certified.contact)
                }));
            }
        }
    }
}

/// Share of the slices in the progress reported.
pub(super) const SHARE_OF_SLICES: f64 = 0.9;

/// Pairs of bodies that one thread solves at a time.
const CHUNK: usize = 64;

/// Spans that one thread solves before it tells its progress: clusters may take many microseconds for each.
const SPANS_PER_CHECK: u32 = 256;

/// The survivors of one pair of bodies.
type OfPair<'s> = &'s [SpanKey];

impl PreparedScene<'_> {
    /// Returns the conflicts of the sorted survivors, in the order of reports; fewer if the filter gives
    /// up.
    pub(super) fn solve(
        &self,
        bodies: &impl Bodies,
        survivors: &[SpanKey],
        filter: &dyn PairFilter,
        progress: &(impl Fn(f64) + Sync),
    ) -> Vec<Conflict> {
        let pairs: Vec<OfPair<'_>> = survivors
            .chunk_by(|x, y| (x.a, x.b) == (y.a, y.b))
            .collect();
        let chunks: Vec<&[OfPair<'_>]> = pairs.chunks(CHUNK).collect();
        let done_chunks = AtomicUsize::new(0);
        let solved = parallel::fold(chunks.len(), 1, Default::default, |share, chunk| {
            if filter.gives_up() {
                return;
            }
            let (conflicts, scratch): &mut (Vec<Conflict>, SolveScratch) = share;
            let chunk = chunks[chunk];
            let tell = |done: usize| {
                let share = as_f64(done) / as_f64(chunks.len());
                progress(SHARE_OF_SLICES + (1.0 - SHARE_OF_SLICES) * share);
            };
            let spans = Cell::new(0_u32);
            let goes_on = || {
                spans.set(spans.get() + 1);
                if !spans.get().is_multiple_of(SPANS_PER_CHECK) {
                    return true;
                }
                tell(done_chunks.load(Ordering::Relaxed));
                !filter.gives_up()
            };
            for (number, survivors) in chunk.iter().enumerate() {
                fetch(bodies, chunk, number);
                self.solve_pair(bodies, survivors, &goes_on, (scratch, conflicts));
            }
            let done = done_chunks.fetch_add(1, Ordering::Relaxed) + 1;
            if done < chunks.len() {
                tell(done);
            }
        });
        let mut conflicts = Vec::new();
        for (mut some, _) in solved {
            if conflicts.is_empty() {
                conflicts = some;
            } else {
                conflicts.append(&mut some);
            }
        }
        order(&mut conflicts);
        conflicts
    }

    /// Appends the conflicts of two bodies in their survivors to a list, in time order; or some of them if `goes_on` returns
    /// false, which is asked before each.
    fn solve_pair(
        &self,
        bodies: &impl Bodies,
        survivors: OfPair<'_>,
        goes_on: &impl Fn() -> bool,
        (scratch, conflicts): (&mut SolveScratch, &mut Vec<Conflict>),
    ) {
        let (a, b) = (survivors[0].a, survivors[0].b);
        // One by one: they are large, and the map of an array moves them.
        let (view_a, view_b) = (bodies.view(a), bodies.view(b));
        let names = [a, b].map(|place| {
            let place = place as usize;
            (self.ids[place], self.entries[place].body.tag)
        });
        let (views, asked) = (
            (&view_a, &view_b),
            (self.query.margin(), self.query.accuracy()),
        );
        if let Some(question) = PairQuestion::of(names, views, asked, self.window.ends()) {
            let spans = survivors.iter().take_while(|_| goes_on());
            let spans = spans.map(|survivor| survivor.span(&view_a.knots, &view_b.knots));
            question.push_conflicts(spans, scratch, conflicts);
        }
    }
}

/// Prefetches the data of later pairs, which is scattered in memory.
fn fetch(bodies: &impl Bodies, pairs: &[OfPair<'_>], number: usize) {
    /// Prefetch distance in pairs; bodies are prefetched twice as far ahead.
    const AHEAD: usize = 4;
    /// Spans prefetched of a pair: most have no more.
    const SPANS: usize = 4;
    if let Some(later) = pairs.get(number + 2 * AHEAD) {
        for place in [later[0].a, later[0].b] {
            bodies.fetch_view(place);
        }
    }
    if let Some(later) = pairs.get(number + AHEAD) {
        for survivor in later.iter().take(SPANS) {
            for cubic in survivor.cubics() {
                bodies.fetch_knots(cubic);
                bodies.fetch_segment(cubic);
            }
        }
    }
}

/// Brings conflicts from the order of pairs into that of reports.
///
/// Pairs ascend, and the conflicts of a pair are in time order. So the order is that of the
/// beginnings, and of the places where these tie. Conflicts are large: they are exchanged in their
/// list, and another one is not needed.
fn order(conflicts: &mut [Conflict]) {
    let enters = conflicts.iter().map(|conflict| conflict.enter);
    let mut places: Vec<(f64, u32)> = enters.zip(0..).collect();
    parallel::sort(&mut places, |x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    // Cycle by cycle, so that each is exchanged once.
    for first in (0..).take(places.len()) {
        let mut place = first;
        loop {
            let next = std::mem::replace(&mut places[place as usize].1, place);
            if next == first {
                break;
            }
            conflicts.swap(place as usize, next as usize);
            place = next;
        }
    }
    debug_assert!(
        conflicts.is_sorted_by(|x, y| x.order(y).is_le()),
        "pairs ascend"
    );
}

/// Returns the reported form of a contact, without certificate.
pub(crate) fn conflict(
    contact: &Contact,
    [(a, tag_a), (b, tag_b)]: [(BodyId, u64); 2],
    (view_a, view_b): (&BodyView<'_>, &BodyView<'_>),
    window: (f64, f64),
) -> Conflict {
    Conflict {
        a,
        b,
        tag_a,
        tag_b,
        enter: contact.enter,
        exit: contact.exit,
        closest: describe(&contact.closest, view_a, view_b),
        clip: Clip {
            at_enter: contact.enter <= window.0,
            at_exit: contact.exit >= window.1,
        },
        certificate: None,
    }
}

/// Returns the reported form of a closest approach.
pub(crate) fn describe(approach: &Approach, a: &BodyView<'_>, b: &BodyView<'_>) -> ClosestApproach {
    let (position_a, position_b, relative_velocity) = approach.kinematics(a, b);
    ClosestApproach {
        time: approach.time,
        separation: approach.separation,
        // Without negative zeros: bodies at rest have the same positions at all times, to the bit.
        position_a: position_a + DVec3::ZERO,
        position_b: position_b + DVec3::ZERO,
        relative_velocity,
        sphere_a: approach.sphere_a,
        sphere_b: approach.sphere_b,
        model_error: a.model_error_with(b),
    }
}
