//! Reading the search: the conflicts that are reported, and the planned encounters, which are the input
//! of the state machine.
//!
//! Most contacts lie well within the window, and stay the same from tick to tick: each pair is
//! read once, when its solved spans have changed, whatever the window. What an edge of the window, or the
//! clock, touches is clipped to it in each tick.

use super::alert_level::AlertLevel;
use super::encounters::PlannedEncounter;
use super::lookahead::LookaheadSearch;
use super::reading::{ConflictCache, EncounterCache};
use super::solved_conflict::SolvedConflict;
use super::solved_spans::SlotPair;
use super::tick_context::TickContext;
use crate::conflict::{Clip, ClosestApproach, Conflict};
use crate::id::BodyId;
use crate::narrow_phase::{BodyView, Contact};
use crate::scene::Scene;
use crate::screen::{conflict, describe};

/// The caches of all alert levels.
#[derive(Debug)]
pub(super) struct LevelCaches {
    pub(super) conflicts: Vec<ConflictCache>,
    pub(super) planned: Vec<EncounterCache>,
    /// Memory of two threads, or of one: contacts within the margin, and within the release margin.
    pub(super) scratch: [Vec<Contact>; 2],
    /// Pairs whose contacts last at some instant.
    pub(super) lasting: Vec<SlotPair>,
}

/// The search that is read, and its scene.
#[derive(Clone, Copy)]
pub(super) struct ReadContext<'m> {
    pub(super) search: &'m LookaheadSearch,
    pub(super) scene: &'m Scene,
}

impl LevelCaches {
    /// Returns empty caches for so many levels.
    pub(super) fn of_levels(count: usize) -> Self {
        Self {
            conflicts: (0..count).map(|_| ConflictCache::default()).collect(),
            planned: (0..count).map(|_| EncounterCache::default()).collect(),
            scratch: Default::default(),
            lasting: Vec::new(),
        }
    }

    /// Returns true if all is to be read next.
    pub(super) fn reads_all(&self) -> bool {
        self.planned.iter().any(EncounterCache::lists_all)
    }

    /// Reads the [changed pairs](super::solved_spans::SolvedSpans::changed_pairs). Of all other pairs, conflicts and planned encounters that ended
    /// before an instant (s) are dropped.
    pub(super) fn update(&mut self, context: ReadContext<'_>, levels: &[AlertLevel], before: f64) {
        let (changed, scratch) = (&context.search.solved.changed_pairs, &mut self.scratch);
        let readings = self.conflicts.iter_mut().zip(&mut self.planned);
        for ((conflicts, encounters), alert) in readings.zip(levels) {
            conflicts.drop_changed(changed, before);
            encounters.drop_changed(changed, before);
            for &slots in changed {
                context.read_whole(slots, alert, scratch, conflicts, encounters);
            }
            conflicts.merge_added();
            encounters.merge_added();
        }
    }
}

impl ReadContext<'_> {
    /// Reads all conflicts and planned encounters of a pair in the time in which both bodies exist.
    fn read_whole(
        &self,
        slots: SlotPair,
        alert: &AlertLevel,
        [contacts, released]: &mut [Vec<Contact>; 2],
        conflicts: &mut ConflictCache,
        encounters: &mut EncounterCache,
    ) {
        let Some(domain) = self.search.domain(slots) else {
            return;
        };
        let (Some(names), Some([a, b])) = (self.names(slots), self.views(slots)) else {
            return;
        };
        let has_plateau = self.search.solved.has_plateau(slots);
        let rests_from = self.rests_from(slots);
        let solved = |contact: &Contact| SolvedConflict {
            conflict: conflict(contact, names, (&a, &b), domain),
            plateau: contact.closest.plateau,
            has_plateau,
            rests_from,
        };
        let planned = |solved: SolvedConflict, enter: Option<f64>| PlannedEncounter {
            solved,
            enter,
            open: false,
            passed: None,
        };
        self.contacts(slots, alert.margin, domain, contacts);
        for contact in &*contacts {
            let solved = solved(contact);
            conflicts.add(slots, solved);
            if !alert.has_release() {
                encounters.add(slots, planned(solved, Some(contact.enter)));
            }
        }
        if !alert.has_release() {
            return;
        }
        self.contacts(slots, alert.release, domain, released);
        // Both lists are in order of time. A pair may have thousands.
        let mut rest = &contacts[..];
        for outer in &*released {
            // `outer` is within the release margin. The contacts within the margin that overlap it lie in it, but for
            // rounding if both margins are nearly the same.
            rest = &rest[rest.partition_point(|contact| contact.exit < outer.enter)..];
            let within = &rest[..rest.partition_point(|contact| contact.enter <= outer.exit)];
            let (first, last) = (within.first(), within.last());
            let mut solved = solved(outer);
            if let (Some(first), Some(last)) = (first, last) {
                let conflict = &mut solved.conflict;
                conflict.enter = conflict.enter.min(first.enter);
                conflict.exit = conflict.exit.max(last.exit);
            }
            encounters.add(slots, planned(solved, first.map(|contact| contact.enter)));
        }
    }

    /// Returns the part of a pair's conflict at a margin (m) that lies in a window (s): what solving it in that
    /// window would give.
    pub(super) fn clipped(
        &self,
        slots: SlotPair,
        whole: &SolvedConflict,
        (margin, window): (f64, (f64, f64)),
        contacts: &mut Vec<Contact>,
    ) -> Option<SolvedConflict> {
        let SolvedConflict {
            conflict,
            has_plateau,
            rests_from,
            ..
        } = whole;
        let interval = (conflict.enter.max(window.0), conflict.exit.min(window.1));
        if interval.0 > interval.1 {
            return None;
        }
        let clip = Clip {
            at_enter: conflict.clip.at_enter || conflict.enter <= window.0,
            at_exit: conflict.clip.at_exit || conflict.exit >= window.1,
        };
        let time = conflict.closest.time;
        let (closest, plateau) = if *rests_from <= conflict.enter {
            // At any instant it is as near. The first one is reported.
            let time = interval.0;
            (
                ClosestApproach {
                    time,
                    ..conflict.closest
                },
                whole.plateau,
            )
        } else if !has_plateau && window.0 < time && time < window.1 {
            (conflict.closest, whole.plateau)
        } else {
            let approach = if *has_plateau {
                // Which of nearly equal distances is reported depends on all of them.
                self.contacts(slots, margin, interval, contacts);
                contacts.first()?.closest
            } else {
                contacts.clear();
                if interval.0 >= interval.1 {
                    // The instant may be that of a knot, and one of both spans beyond the margin there.
                    self.contacts(slots, margin, window, contacts);
                }
                let holds = |one: &&Contact| one.enter <= interval.0 && interval.1 <= one.exit;
                match contacts.iter().find(holds) {
                    Some(contact) => contact.closest,
                    None => self.search.solved.closest(slots, interval, clip)?,
                }
            };
            let [a, b] = self.views(slots)?;
            (describe(&approach, &a, &b), approach.plateau)
        };
        Some(SolvedConflict {
            conflict: Conflict {
                enter: interval.0,
                exit: interval.1,
                closest,
                clip,
                ..*conflict
            },
            plateau,
            ..*whole
        })
    }

    /// Returns a planned encounter of a pair as a tick sees it.
    pub(super) fn planned(
        &self,
        slots: SlotPair,
        whole: &PlannedEncounter,
        alert: &AlertLevel,
        tick: &TickContext<'_>,
        contacts: &mut Vec<Contact>,
    ) -> Option<PlannedEncounter> {
        let mut clipped = |to| {
            let window = (tick.before, to);
            self.clipped(slots, &whole.solved, (alert.release, window), contacts)
        };
        let mut solved = clipped(tick.known)?;
        let passed = clipped(tick.reported).map(|passed| passed.closest());
        let (conflict, whole_conflict) = (&mut solved.conflict, &whole.solved.conflict);
        conflict.clip.at_exit = whole_conflict.clip.at_exit && whole_conflict.exit <= tick.known;
        let enter = match whole.enter {
            Some(enter) if enter <= tick.before => {
                if alert.has_release() {
                    // That one may be over, and another one ahead.
                    let interval = (conflict.enter, conflict.exit);
                    self.contacts(slots, alert.margin, interval, contacts);
                    contacts.first().map(|contact| contact.enter)
                } else {
                    Some(conflict.enter)
                }
            }
            later => later.filter(|&enter| enter <= tick.known),
        };
        Some(PlannedEncounter {
            enter,
            open: conflict.exit >= tick.known && !conflict.clip.at_exit,
            passed,
            solved,
        })
    }

    /// Finds all contacts of a pair within `margin` and the bodies' model errors in `window`; replaces
    /// the content of `found`.
    fn contacts(&self, slots: SlotPair, margin: f64, window: (f64, f64), found: &mut Vec<Contact>) {
        let margin = self.scene.widened(slots, margin);
        self.search.solved.contacts(slots, margin, window, found);
    }

    /// Returns the instant from which on neither body of a pair moves, s; infinite if one always does.
    fn rests_from(&self, (a, b): SlotPair) -> f64 {
        let of_body = |slot| {
            let body = self.scene.in_slot(slot);
            body.map_or(f64::INFINITY, |(_, entry)| entry.body.rests_from())
        };
        of_body(a).max(of_body(b))
    }

    fn views(&self, (a, b): SlotPair) -> Option<[BodyView<'_>; 2]> {
        let view = |slot| self.search.monitored.view(self.scene, slot);
        Some([view(a)?, view(b)?])
    }

    /// Returns the ids and tags of a pair.
    fn names(&self, (a, b): SlotPair) -> Option<[(BodyId, u64); 2]> {
        let name = |slot| {
            let (id, entry) = self.scene.in_slot(slot)?;
            Some((id, entry.body.tag))
        };
        Some([name(a)?, name(b)?])
    }
}
