//! Reading the search: the conflicts that are reported, and the planned encounters, which are the input
//! of the state machine.
//!
//! Most contacts lie well within the window, and stay the same from tick to tick: each pair is
//! read once, when its solved spans have changed, whatever the window. Only what an edge of the
//! window, or the clock, touches is read again: conflicts one by one, encounters pair by pair.

use super::alert_level::AlertLevel;
use super::encounters::{PlannedEncounter, TickContext};
use super::lookahead::LookaheadSearch;
use super::reading::{ConflictCache, EncounterCache};
use super::solved_spans::SlotPair;
use crate::conflict::{ClosestApproach, Conflict};
use crate::narrow_phase::Contact;
use crate::scene::Scene;
use crate::screen::conflict;

/// The caches of all alert levels.
#[derive(Debug)]
pub(super) struct LevelCaches {
    pub(super) conflicts: Vec<ConflictCache>,
    pub(super) planned: Vec<EncounterCache>,
    /// Pairs whose solved spans have changed: to be read.
    pub(super) changed_pairs: Vec<SlotPair>,
    /// Memory of two threads.
    pub(super) scratch: [ReadScratch; 2],
}

/// Memory that reading reuses.
#[derive(Debug, Default)]
pub(super) struct ReadScratch {
    /// Contacts within the margin.
    pub(super) contacts: Vec<Contact>,
    /// Contacts within the release margin.
    released: Vec<Contact>,
    /// Contacts up to the clock.
    passed: Vec<Contact>,
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
            changed_pairs: Vec::new(),
            scratch: Default::default(),
        }
    }

    /// Returns true if all is to be read next.
    pub(super) fn reads_all(&self) -> bool {
        self.planned.iter().any(EncounterCache::lists_all)
    }

    /// Reads the [changed pairs](Self::changed_pairs). Of all other pairs, conflicts and planned encounters that ended
    /// before an instant (s) are dropped.
    pub(super) fn update(&mut self, context: ReadContext<'_>, levels: &[AlertLevel], before: f64) {
        let (changed, [scratch, _]) = (&self.changed_pairs, &mut self.scratch);
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
    /// Reads all conflicts and planned encounters of a pair in the time in which both bodies exist, as if the clock had
    /// reached none of them.
    fn read_whole(
        &self,
        slots: SlotPair,
        alert: &AlertLevel,
        scratch: &mut ReadScratch,
        conflicts: &mut ConflictCache,
        encounters: &mut EncounterCache,
    ) {
        let Some(domain) = self.search.domain(self.scene, slots) else {
            return;
        };
        let contacts = &mut scratch.contacts;
        self.contacts(slots, alert.margin, domain, contacts);
        for conflict in contacts
            .iter()
            .filter_map(|one| self.report(slots, domain, one))
        {
            conflicts.add(slots, conflict);
        }
        let any_time = TickContext {
            reported: f64::NEG_INFINITY,
            known: f64::INFINITY,
            ..TickContext::default()
        };
        let whole = (domain, domain.1);
        self.each_planned(slots, alert, &any_time, whole, scratch, |planned| {
            encounters.add(slots, planned);
        });
    }

    /// Returns the part of a window in which both bodies of a pair exist, and the instant at which one of them ceases to
    /// exist, s.
    fn clip(&self, slots: SlotPair, (from, to): (f64, f64)) -> Option<((f64, f64), f64)> {
        let (start, ends) = self.search.domain(self.scene, slots)?;
        let clip = (start.max(from), ends.min(to));
        (clip.0 <= clip.1).then_some((clip, ends))
    }

    /// Appends the part of a pair's conflict that lies in a window. `lasts` is the whole interval of the conflict (s).
    pub(super) fn clipped(
        &self,
        slots: SlotPair,
        margin: f64,
        (lasts, window): ((f64, f64), (f64, f64)),
        contacts: &mut Vec<Contact>,
        conflicts: &mut Vec<Conflict>,
    ) {
        let Some((clip, _)) = self.clip(slots, window) else {
            return;
        };
        let part = (clip.0.max(lasts.0), clip.1.min(lasts.1));
        self.contacts(slots, margin, part, contacts);
        let report = |contact| self.report(slots, clip, contact);
        conflicts.extend(contacts.iter().filter_map(report));
    }

    /// Appends the planned encounters of a pair as a tick sees them.
    pub(super) fn planned(
        &self,
        slots: SlotPair,
        alert: &AlertLevel,
        tick: &TickContext,
        scratch: &mut ReadScratch,
        found: &mut Vec<PlannedEncounter>,
    ) {
        let window = (tick.before, tick.known);
        if let Some((clip, ends)) = self.clip(slots, window) {
            let contacts = &mut scratch.contacts;
            self.contacts(slots, alert.margin, clip, contacts);
            let period = (clip, ends);
            self.each_planned(slots, alert, tick, period, scratch, |planned| {
                found.push(planned)
            });
        }
    }

    /// Computes the planned encounters of a pair within `clip`, of which `scratch` has the contacts
    /// at the margin. `ends` is the instant (s) at which one of the bodies ceases to exist.
    fn each_planned(
        &self,
        slots: SlotPair,
        alert: &AlertLevel,
        tick: &TickContext,
        (clip, ends): ((f64, f64), f64),
        scratch: &mut ReadScratch,
        mut visit: impl FnMut(PlannedEncounter),
    ) {
        let ReadScratch {
            contacts,
            released,
            passed,
        } = scratch;
        if alert.release > alert.margin {
            self.contacts(slots, alert.release, clip, released);
        } else {
            released.clone_from(contacts);
        }
        for outer in &*released {
            // `outer` is within the release margin. The contacts within the margin that overlap it lie in it, but for
            // rounding if both margins are nearly the same.
            let mut within = contacts
                .iter()
                .filter(|contact| contact.enter <= outer.exit && contact.exit >= outer.enter);
            let first = within.next();
            let last = within.next_back().or(first);
            let start = first.map_or(outer.enter, |contact| contact.enter.min(outer.enter));
            let exit = last.map_or(outer.exit, |contact| contact.exit.max(outer.exit));
            let Some(conflict) = self.report(slots, clip, outer) else {
                continue;
            };
            let passed_part = (start, exit.min(tick.reported));
            visit(PlannedEncounter {
                a: conflict.a,
                b: conflict.b,
                tags: [conflict.tag_a, conflict.tag_b],
                enter: first.map(|contact| contact.enter),
                start,
                exit,
                open: exit >= tick.known && ends > tick.known,
                with_trajectory: exit >= ends,
                closest: conflict.closest,
                passed: self.passed_closest(slots, alert.release, passed_part, passed),
            });
        }
    }

    /// Returns the closest approach over the part of an encounter that the clock has passed.
    fn passed_closest(
        &self,
        slots: SlotPair,
        margin: f64,
        part: (f64, f64),
        scratch: &mut Vec<Contact>,
    ) -> Option<ClosestApproach> {
        if part.0 > part.1 {
            return None;
        }
        self.contacts(slots, margin, part, scratch);
        let conflicts = scratch
            .iter()
            .filter_map(|contact| self.report(slots, part, contact));
        conflicts
            .map(|conflict| conflict.closest)
            .reduce(|x, y| if y.separation < x.separation { y } else { x })
    }

    /// Finds all contacts of a pair within `margin` and the bodies' model errors in `clip`; replaces
    /// the content of `found`.
    fn contacts(&self, slots: SlotPair, margin: f64, clip: (f64, f64), found: &mut Vec<Contact>) {
        let margin = self.scene.widened(slots, margin);
        self.search.solved.contacts(slots, margin, clip, found);
    }

    /// Returns the conflict of a contact of a pair, clipped to an interval (s).
    fn report(&self, (a, b): SlotPair, clip: (f64, f64), contact: &Contact) -> Option<Conflict> {
        let name = |slot| {
            let (id, entry) = self.scene.in_slot(slot)?;
            Some((id, entry.body.tag))
        };
        let names = [name(a)?, name(b)?];
        let views = (
            self.search.view(self.scene, a)?,
            self.search.view(self.scene, b)?,
        );
        Some(conflict(contact, names, (&views.0, &views.1), clip))
    }
}
