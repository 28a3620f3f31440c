//! Exact solutions of the survivors, and the conflicts reported.

use super::prepared::{PreparedScene, clip_of};
use crate::accuracy::Accuracy;
use crate::broad_phase::PairFilter;
use crate::conflict::{Clip, ClosestApproach, Conflict};
use crate::id::BodyId;
use crate::narrow_phase::{
    Approach, BodyView, CertifiedContact, Contact, Workspace, certified_contacts, contacts,
};
use crate::parallel;
use crate::search::Bodies;
use crate::spans::Span;
use crate::spans::SpanKey;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Buffers that are reused from pair to pair.
#[derive(Default)]
pub(super) struct SolveScratch {
    pub(super) contacts: Vec<Contact>,
    pub(super) certified: Vec<CertifiedContact>,
    pub(super) workspace: Workspace,
}

/// The conflicts of consecutive pairs.
#[derive(Default)]
struct SolvedPairs {
    conflicts: Vec<Conflict>,
    scratch: SolveScratch,
}

/// Share of the slices in the progress reported.
pub(super) const SHARE_OF_SLICES: f64 = 0.9;

/// Pairs of bodies that one thread solves at a time.
const CHUNK: usize = 64;

/// The survivors of one pair of bodies.
type OfPair<'s> = &'s [SpanKey];

impl PreparedScene<'_> {
    /// Returns the conflicts of the sorted survivors, in the order of reports; fewer if the filter gives
    /// up.
    pub(super) fn solve(
        &self,
        bodies: &impl Bodies,
        survivors: &[SpanKey],
        filter: &impl PairFilter,
        progress: &(impl Fn(f64) + Sync),
    ) -> Vec<Conflict> {
        let pairs: Vec<OfPair<'_>> = survivors
            .chunk_by(|x, y| (x.a, x.b) == (y.a, y.b))
            .collect();
        let chunks: Vec<&[OfPair<'_>]> = pairs.chunks(CHUNK).collect();
        let done_chunks = AtomicUsize::new(0);
        let solved = parallel::fold(chunks.len(), 1, SolvedPairs::default, |solved, chunk| {
            if filter.gives_up() {
                return;
            }
            let SolvedPairs { conflicts, scratch } = solved;
            let chunk = chunks[chunk];
            match self.accuracy {
                Accuracy::Exact => self.exact(bodies, chunk, scratch, conflicts),
                Accuracy::Certified => self.certified(bodies, chunk, scratch, conflicts),
            }
            let done = done_chunks.fetch_add(1, Ordering::Relaxed) + 1;
            if done < chunks.len() {
                let share = ratio(done, chunks.len());
                progress(SHARE_OF_SLICES + (1.0 - SHARE_OF_SLICES) * share);
            }
        });
        let mut conflicts = Vec::new();
        for mut some in solved {
            if conflicts.is_empty() {
                conflicts = some.conflicts;
            } else {
                conflicts.append(&mut some.conflicts);
            }
        }
        order(&mut conflicts);
        conflicts
    }

    fn exact(
        &self,
        bodies: &impl Bodies,
        pairs: &[OfPair<'_>],
        scratch: &mut SolveScratch,
        conflicts: &mut Vec<Conflict>,
    ) {
        let found = &mut scratch.contacts;
        for number in 0..pairs.len() {
            let Some(pair) = self.pair(bodies, pairs, number) else {
                continue;
            };
            found.clear();
            let [a, b] = &pair.views;
            contacts(a, b, pair.spans(), self.margin, pair.clip, found);
            conflicts.extend(found.iter().map(|contact| pair.conflict(contact)));
        }
    }

    fn certified(
        &self,
        bodies: &impl Bodies,
        pairs: &[OfPair<'_>],
        scratch: &mut SolveScratch,
        conflicts: &mut Vec<Conflict>,
    ) {
        let (found, workspace) = (&mut scratch.certified, &mut scratch.workspace);
        for number in 0..pairs.len() {
            let Some(pair) = self.pair(bodies, pairs, number) else {
                continue;
            };
            found.clear();
            let [a, b] = &pair.views;
            certified_contacts(a, b, pair.spans(), self.margin, pair.clip, workspace, found);
            conflicts.extend(found.iter().map(|certified| Conflict {
                certificate: Some(certified.certificate),
                ..pair.conflict(&certified.contact)
            }));
        }
    }

    /// Returns the task of a pair of bodies, or `None` if the two do not exist at the same time
    /// within the window.
    fn pair<'p>(
        &self,
        bodies: &'p impl Bodies,
        pairs: &[OfPair<'p>],
        number: usize,
    ) -> Option<PairTask<'p>> {
        fetch(bodies, pairs, number);
        let survivors = pairs[number];
        let (a, b) = (survivors[0].a, survivors[0].b);
        // One by one: they are large, and the map of an array moves them.
        let views = [bodies.view(a), bodies.view(b)];
        let name = |place: u32| {
            let place = place as usize;
            (self.ids[place], self.entries[place].body.tag)
        };
        Some(PairTask {
            clip: clip_of(&views[0], &views[1], self.window)?,
            names: [name(a), name(b)],
            views,
            survivors,
        })
    }
}

#[allow(clippy::cast_precision_loss, reason = "shown, not computed with")]
fn ratio(done: usize, all: usize) -> f64 {
    done as f64 / all as f64
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
    for next in 0..places.len() {
        let mut place = places[next].1 as usize;
        // It has been exchanged with the one that was to come there.
        while place < next {
            place = places[place].1 as usize;
        }
        conflicts.swap(next, place);
    }
    debug_assert!(
        conflicts.is_sorted_by(|x, y| x.order(y).is_le()),
        "pairs ascend"
    );
}

/// Two bodies with the spans in which they may be in contact.
struct PairTask<'p> {
    names: [(BodyId, u64); 2],
    views: [BodyView<'p>; 2],
    clip: (f64, f64),
    survivors: OfPair<'p>,
}

impl PairTask<'_> {
    fn spans(&self) -> impl Iterator<Item = Span> {
        let [a, b] = &self.views;
        self.survivors
            .iter()
            .map(|survivor| survivor.span(&a.knots, &b.knots))
    }

    fn conflict(&self, contact: &Contact) -> Conflict {
        let [a, b] = &self.views;
        conflict(contact, self.names, (a, b), self.clip)
    }
}

/// Returns the reported form of a contact, without certificate.
pub(crate) fn conflict(
    contact: &Contact,
    [(a, tag_a), (b, tag_b)]: [(BodyId, u64); 2],
    (view_a, view_b): (&BodyView<'_>, &BodyView<'_>),
    clip: (f64, f64),
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
            at_enter: contact.enter <= clip.0,
            at_exit: contact.exit >= clip.1,
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
        position_a,
        position_b,
        relative_velocity,
        sphere_a: approach.sphere_a,
        sphere_b: approach.sphere_b,
        model_error: a.model_error_with(b),
    }
}
