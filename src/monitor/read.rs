//! Reading the outlook: the conflicts that are reported, and the plain encounters that feed the
//! state machine.
//!
//! Most contacts lie well within the window, and stay the same from tick to tick: each pair is
//! read once, when spans are added to it, as if the window were endless. Only pairs with a contact
//! that an edge of the window, or the clock, touches are read again.

use super::encounters::{Plain, Tick};
use super::event::Event;
use super::finds::Pair;
use super::kept::Kept;
use super::outlook::Outlook;
use super::reading::{Reading, Slots};
use super::{AlertLevel, Monitor};
use crate::conflict::{ClosestApproach, Conflict};
use crate::narrow_phase::Contact;
use crate::scene::Scene;
use crate::screen::conflict;

/// What each alert level has of every pair.
#[derive(Debug)]
pub(super) struct Readings {
    conflicts: Vec<Reading<Conflict>>,
    plains: Vec<Reading<Plain>>,
    scratch: Scratch,
}

/// What reading reuses.
#[derive(Debug, Default)]
struct Scratch {
    contacts: Vec<Contact>,
    released: Vec<Contact>,
    passed: Vec<Contact>,
}

/// What is read.
#[derive(Clone, Copy)]
struct Source<'m> {
    outlook: &'m Outlook,
    scene: &'m Scene,
}

impl Monitor {
    /// Reads the pairs to which spans were added.
    pub(super) fn read_new_pairs(&mut self) {
        if !self.outlook.list_pairs() {
            return;
        }
        let source = Source {
            outlook: &self.outlook,
            scene: &self.scene,
        };
        self.readings.update(source, &self.levels);
        self.outlook.all_are_read();
    }

    /// Reads the conflicts from now to the end of what is known; and the plain encounters from the
    /// last tick's clock on, and works out what they come to.
    pub(super) fn read(&mut self, tick: &Tick, next_id: &mut u64, events: &mut Vec<Event>) {
        let source = Source {
            outlook: &self.outlook,
            scene: &self.scene,
        };
        let Readings {
            conflicts,
            plains,
            scratch,
        } = &mut self.readings;
        let reported = conflicts.iter_mut().zip(&mut self.conflicts);
        for ((reading, reported), alert) in reported.zip(&self.levels) {
            reported.clear();
            if tick.now < tick.known {
                reading.read_conflicts(source, alert, (tick.now, tick.known), scratch);
                reported.extend(reading.iter().copied());
            }
        }
        // Up to an instant that was reached before, nothing new is known.
        if tick.before < tick.known {
            let encounters = plains.iter_mut().zip(&mut self.encounters);
            for ((reading, encounters), alert) in encounters.zip(&self.levels) {
                reading.read_plains(source, alert, tick, scratch);
                encounters.work_out(reading.iter(), tick, next_id, events);
            }
        }
    }
}

impl Readings {
    /// Of so many levels, and no pair.
    pub(super) fn of_levels(count: usize) -> Self {
        Self {
            conflicts: (0..count).map(|_| Reading::default()).collect(),
            plains: (0..count).map(|_| Reading::default()).collect(),
            scratch: Scratch::default(),
        }
    }

    /// Takes over what is known of pairs that have not changed, and reads the others.
    fn update(&mut self, source: Source<'_>, levels: &[AlertLevel]) {
        let pairs = source.outlook.finds().pairs();
        let readings = self.conflicts.iter_mut().zip(&mut self.plains);
        for ((conflicts, plains), alert) in readings.zip(levels) {
            conflicts.keep_unchanged(pairs);
            plains.keep_unchanged(pairs);
            let (conflicts, plains) = (&mut conflicts.always, &mut plains.always);
            for pair in pairs.iter().filter(|pair| pair.is_new) {
                source.always(pair, alert, &mut self.scratch, conflicts, plains);
            }
            conflicts.settle();
            plains.settle();
        }
    }
}

impl Reading<Plain> {
    /// Reads the plain encounters from the last tick's clock to the end of what is known, sorted by
    /// pair and time.
    fn read_plains(
        &mut self,
        source: Source<'_>,
        alert: &AlertLevel,
        tick: &Tick,
        scratch: &mut Scratch,
    ) {
        // What the clock has reached must say how close it came.
        let windows = ((tick.told, tick.known), (tick.before, tick.known));
        let begin = |plain: &Plain| plain.start;
        self.read(windows, begin, |pair, at_edge| {
            source.plains(pair, alert, tick, scratch, at_edge);
        });
    }
}

impl Reading<Conflict> {
    /// Reads the conflicts in a window, sorted as they are reported.
    fn read_conflicts(
        &mut self,
        source: Source<'_>,
        alert: &AlertLevel,
        window: (f64, f64),
        scratch: &mut Scratch,
    ) {
        let begin = |conflict: &Conflict| conflict.enter;
        self.read((window, window), begin, |pair, at_edge| {
            source.conflicts(pair, alert.margin, window, scratch, at_edge);
        });
        self.sort();
    }
}

impl Source<'_> {
    fn pair(&self, slots: Slots) -> Option<&Pair> {
        let pairs = self.outlook.finds().pairs();
        let place = pairs.binary_search_by_key(&slots, |pair| pair.slots).ok()?;
        Some(&pairs[place])
    }

    /// Reads a pair as if the window were endless, and the clock had not come to it.
    fn always(
        &self,
        pair: &Pair,
        alert: &AlertLevel,
        scratch: &mut Scratch,
        conflicts: &mut Kept<Slots, Conflict>,
        plains: &mut Kept<Slots, Plain>,
    ) {
        let slots = pair.slots;
        let Some(always) = self.outlook.domain(self.scene, slots) else {
            return;
        };
        let contacts = &mut scratch.contacts;
        self.outlook.contacts(pair, alert.margin, always, contacts);
        for conflict in contacts
            .iter()
            .filter_map(|one| self.report(slots, always, one))
        {
            conflicts.add(slots, (conflict.enter, conflict.exit), conflict);
        }
        let ahead = Tick {
            told: f64::NEG_INFINITY,
            known: f64::INFINITY,
            ..Tick::default()
        };
        self.each_plain(pair, alert, &ahead, (always, always.1), scratch, |plain| {
            plains.add(slots, (plain.start, plain.exit), plain);
        });
    }

    /// When both bodies of a pair exist within a window; and when they cease to.
    fn clip(&self, slots: Slots, (from, to): (f64, f64)) -> Option<((f64, f64), f64)> {
        let (start, ends) = self.outlook.domain(self.scene, slots)?;
        let clip = (start.max(from), ends.min(to));
        (clip.0 <= clip.1).then_some((clip, ends))
    }

    /// The conflicts of a pair within a window.
    fn conflicts(
        &self,
        slots: Slots,
        margin: f64,
        window: (f64, f64),
        scratch: &mut Scratch,
        conflicts: &mut Vec<Conflict>,
    ) {
        let (Some(pair), Some((clip, _))) = (self.pair(slots), self.clip(slots, window)) else {
            return;
        };
        let contacts = &mut scratch.contacts;
        self.outlook.contacts(pair, margin, clip, contacts);
        let report = |contact| self.report(slots, clip, contact);
        conflicts.extend(contacts.iter().filter_map(report));
    }

    /// The plain encounters of a pair as a tick sees them.
    fn plains(
        &self,
        slots: Slots,
        alert: &AlertLevel,
        tick: &Tick,
        scratch: &mut Scratch,
        plains: &mut Vec<Plain>,
    ) {
        let window = (tick.before, tick.known);
        if let (Some(pair), Some((clip, ends))) = (self.pair(slots), self.clip(slots, window)) {
            let contacts = &mut scratch.contacts;
            self.outlook.contacts(pair, alert.margin, clip, contacts);
            let period = (clip, ends);
            self.each_plain(pair, alert, tick, period, scratch, |plain| {
                plains.push(plain)
            });
        }
    }

    /// Works out the plain encounters of a pair within `clip`, of which `scratch` has the contacts
    /// at the margin. `ends` is when one of its bodies ceases to exist.
    fn each_plain(
        &self,
        pair: &Pair,
        alert: &AlertLevel,
        tick: &Tick,
        (clip, ends): ((f64, f64), f64),
        scratch: &mut Scratch,
        mut visit: impl FnMut(Plain),
    ) {
        let outlook = self.outlook;
        let Scratch {
            contacts,
            released,
            passed,
        } = scratch;
        if alert.release > alert.margin {
            outlook.contacts(pair, alert.release, clip, released);
        } else {
            released.clone_from(contacts);
        }
        for hold in &*released {
            let mut within = contacts
                .iter()
                .filter(|contact| contact.enter >= hold.enter && contact.exit <= hold.exit);
            let first = within.next();
            let Some(closest) = self.report(pair.slots, clip, hold) else {
                continue;
            };
            let flown = (hold.enter, hold.exit.min(tick.told));
            visit(Plain {
                a: closest.a,
                b: closest.b,
                enter: first.map(|contact| contact.enter),
                start: hold.enter,
                exit: hold.exit,
                open: hold.exit >= tick.known && ends > tick.known,
                with_trajectory: hold.exit >= ends,
                closest: closest.closest,
                passed: self.passed_closest(pair, alert.release, flown, passed),
            });
        }
    }

    /// The closest approach over the part of an encounter that the clock has passed.
    fn passed_closest(
        &self,
        pair: &Pair,
        margin: f64,
        flown: (f64, f64),
        scratch: &mut Vec<Contact>,
    ) -> Option<ClosestApproach> {
        if flown.0 > flown.1 {
            return None;
        }
        self.outlook.contacts(pair, margin, flown, scratch);
        let conflicts = scratch
            .iter()
            .filter_map(|contact| self.report(pair.slots, flown, contact));
        conflicts
            .map(|conflict| conflict.closest)
            .reduce(|x, y| if y.separation < x.separation { y } else { x })
    }

    fn report(&self, (a, b): Slots, clip: (f64, f64), contact: &Contact) -> Option<Conflict> {
        let ids = (self.scene.in_slot(a)?.0, self.scene.in_slot(b)?.0);
        let parties = (
            self.outlook.party(self.scene, a)?,
            self.outlook.party(self.scene, b)?,
        );
        Some(conflict(contact, ids, (&parties.0, &parties.1), clip))
    }
}
