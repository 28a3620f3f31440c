//! The exact answer for the survivors, and how it is reported.

use super::line_up::{LineUp, clip_of};
use super::survivors::Survivor;
use crate::accuracy::Accuracy;
use crate::conflict::{Clip, ClosestApproach, Conflict};
use crate::id::BodyId;
use crate::narrow_phase::{
    Approach, CertifiedContact, Contact, Party, Workspace, certified_contacts, contacts,
};
use crate::parallel;

/// What one thread reuses from pair to pair.
#[derive(Default)]
struct Scratch {
    contacts: Vec<Contact>,
    certified: Vec<CertifiedContact>,
    workspace: Workspace,
}

impl LineUp<'_> {
    /// The exact answer for the survivors (sorted), a pair at a time.
    pub(super) fn solve(&self, parties: &[Party<'_>], survivors: &[Survivor]) -> Vec<Conflict> {
        let pairs: Vec<&[Survivor]> = survivors
            .chunk_by(|x, y| (x.a, x.b) == (y.a, y.b))
            .collect();
        let solved = parallel::map(pairs.len(), Scratch::default, |scratch, pair| {
            self.conflicts_of(parties, pairs[pair], scratch)
        });
        solved.into_iter().flatten().collect()
    }

    /// All conflicts of one pair.
    fn conflicts_of(
        &self,
        parties: &[Party<'_>],
        survivors: &[Survivor],
        scratch: &mut Scratch,
    ) -> Vec<Conflict> {
        let (place_a, place_b) = (survivors[0].a as usize, survivors[0].b as usize);
        let pair = (&parties[place_a], &parties[place_b]);
        let ids = (self.ids[place_a], self.ids[place_b]);
        let Some(clip) = clip_of(pair.0, pair.1, self.window) else {
            return Vec::new();
        };
        let met = survivors
            .iter()
            .map(|survivor| survivor.span(pair.0, pair.1));
        match self.accuracy {
            Accuracy::Exact => {
                let found = &mut scratch.contacts;
                found.clear();
                contacts(pair.0, pair.1, met, self.margin, clip, found);
                let report = |contact: &Contact| conflict(contact, ids, pair, clip);
                found.iter().map(report).collect()
            }
            Accuracy::Certified => {
                let found = &mut scratch.certified;
                found.clear();
                let workspace = &mut scratch.workspace;
                certified_contacts(pair.0, pair.1, met, self.margin, clip, workspace, found);
                let report = |certified: &CertifiedContact| Conflict {
                    certificate: Some(certified.certificate),
                    ..conflict(&certified.contact, ids, pair, clip)
                };
                found.iter().map(report).collect()
            }
        }
    }
}

/// A contact as it is reported, without a certificate.
pub(crate) fn conflict(
    contact: &Contact,
    (a, b): (BodyId, BodyId),
    (party_a, party_b): (&Party<'_>, &Party<'_>),
    clip: (f64, f64),
) -> Conflict {
    Conflict {
        a,
        b,
        enter: contact.enter,
        exit: contact.exit,
        closest: describe(&contact.closest, party_a, party_b),
        clip: Clip {
            at_enter: contact.enter <= clip.0,
            at_exit: contact.exit >= clip.1,
        },
        certificate: None,
    }
}

pub(super) fn describe(approach: &Approach, a: &Party<'_>, b: &Party<'_>) -> ClosestApproach {
    let (position_a, position_b, relative_velocity) = approach.kinematics(a, b);
    ClosestApproach {
        time: approach.time,
        separation: approach.separation,
        position_a,
        position_b,
        relative_velocity,
        sphere_a: approach.sphere_a,
        sphere_b: approach.sphere_b,
    }
}
