//! The exact answer for the survivors, and how it is reported.

use super::line_up::{LineUp, clip_of};
use super::sift::Survivor;
use crate::conflict::{Clip, ClosestApproach, Conflict};
use crate::id::BodyId;
use crate::narrow_phase::{Approach, Contact, Party, contacts};
use crate::parallel;

/// Pairs that take some 50 microseconds together.
const FEW_PAIRS: usize = 32;

impl LineUp<'_> {
    /// The exact answer for the survivors (sorted), a pair at a time.
    pub(super) fn solve(&self, parties: &[Party<'_>], survivors: &[Survivor]) -> Vec<Conflict> {
        let pairs: Vec<&[Survivor]> = survivors
            .chunk_by(|x, y| (x.a, x.b) == (y.a, y.b))
            .collect();
        let solved = parallel::map(
            pairs.len(),
            FEW_PAIRS,
            Vec::new,
            |found: &mut Vec<Contact>, pair| {
                let met = pairs[pair];
                let (place_a, place_b) = (met[0].a as usize, met[0].b as usize);
                let (a, b) = (&parties[place_a], &parties[place_b]);
                let Some(clip) = clip_of(a, b, self.window) else {
                    return Vec::new();
                };
                let met = met.iter().map(|survivor| survivor.span(a, b));
                found.clear();
                contacts(a, b, met, self.margin, clip, found);
                let ids = (self.ids[place_a], self.ids[place_b]);
                let conflict = |contact: &Contact| conflict(contact, ids, (a, b), clip);
                found.iter().map(conflict).collect()
            },
        );
        solved.into_iter().flatten().collect()
    }
}

/// A contact as it is reported.
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
