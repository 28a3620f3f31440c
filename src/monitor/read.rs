//! Reading the outlook: the conflicts that are reported, and the plain encounters that feed the
//! state machine.
//!
//! Most contacts lie well within the window, and stay the same from tick to tick: each pair is
//! read once, when spans are added to it, as if the window were endless. Only pairs with a contact
//! that an edge of the window, or the clock, touches are read again.

use super::encounters::{Plain, Tick};
use super::finds::Pair;
use super::outlook::Outlook;
use super::{AlertLevel, Monitor};
use crate::conflict::{ClosestApproach, Conflict};
use crate::narrow_phase::Contact;
use crate::scene::Scene;
use crate::screen::conflict;

/// What one alert level has of every pair, whatever the window. Sorted by pair.
#[derive(Debug, Default)]
pub(super) struct Readings {
    conflicts: Vec<(Slots, Conflict)>,
    plains: Vec<(Slots, Plain)>,
    /// The memory of the last ones.
    old_conflicts: Vec<(Slots, Conflict)>,
    old_plains: Vec<(Slots, Plain)>,
}

type Slots = (u32, u32);

/// What reading reuses.
#[derive(Debug, Default)]
pub(super) struct Scratch {
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

/// How a contact lies to a window.
#[derive(PartialEq)]
enum Place {
    Within,
    Beyond,
    AtEdge,
}

impl Place {
    /// `within` is open, `around` closed.
    fn of((start, end): (f64, f64), within: (f64, f64), around: (f64, f64)) -> Self {
        if start > within.0 && end < within.1 {
            Self::Within
        } else if end < around.0 || start > around.1 {
            Self::Beyond
        } else {
            Self::AtEdge
        }
    }
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
        for (readings, alert) in self.readings.iter_mut().zip(&self.levels) {
            readings.update(source, alert, &mut self.scratch);
        }
        self.outlook.all_are_read();
    }

    /// The conflicts of a level from now to the end of what is known.
    pub(super) fn read_conflicts(&mut self, level: usize, (from, to): (f64, f64)) {
        let margin = self.levels[level].margin;
        let conflicts = &mut self.conflicts[level];
        conflicts.clear();
        if to <= from {
            return;
        }
        let source = Source {
            outlook: &self.outlook,
            scene: &self.scene,
        };
        let pairs = self.readings[level].conflicts.chunk_by(|x, y| x.0 == y.0);
        for pair in pairs {
            let place = |conflict: &Conflict| {
                Place::of((conflict.enter, conflict.exit), (from, to), (from, to))
            };
            if pair.iter().any(|(_, x)| place(x) == Place::AtEdge) {
                source.conflicts(pair[0].0, margin, (from, to), &mut self.scratch, conflicts);
            } else {
                let within = pair.iter().filter(|(_, x)| place(x) == Place::Within);
                conflicts.extend(within.map(|(_, conflict)| *conflict));
            }
        }
        conflicts.sort_unstable_by(Conflict::order);
    }

    /// The plain encounters of a level from the last tick's clock to the end of what is known.
    pub(super) fn read_plain(&mut self, level: usize, tick: &Tick) {
        let alert = self.levels[level];
        self.plain.clear();
        let source = Source {
            outlook: &self.outlook,
            scene: &self.scene,
        };
        let pairs = self.readings[level].plains.chunk_by(|x, y| x.0 == y.0);
        for pair in pairs {
            // What the clock has reached must say how close it came.
            let place = |plain: &Plain| {
                let (ahead, all) = ((tick.told, tick.known), (tick.before, tick.known));
                Place::of((plain.start, plain.exit), ahead, all)
            };
            if pair.iter().any(|(_, x)| place(x) == Place::AtEdge) {
                source.plains(pair[0].0, &alert, tick, &mut self.scratch, &mut self.plain);
            } else {
                let within = pair.iter().filter(|(_, x)| place(x) == Place::Within);
                self.plain.extend(within.map(|(_, plain)| *plain));
            }
        }
    }
}

impl Readings {
    /// Takes over what is known of pairs that have not changed, and reads the others.
    fn update(&mut self, source: Source<'_>, alert: &AlertLevel, scratch: &mut Scratch) {
        let Self {
            conflicts,
            plains,
            old_conflicts,
            old_plains,
        } = self;
        std::mem::swap(conflicts, old_conflicts);
        std::mem::swap(plains, old_plains);
        conflicts.clear();
        plains.clear();
        let (mut old_conflicts, mut old_plains) = (&old_conflicts[..], &old_plains[..]);
        for pair in source.outlook.finds().pairs() {
            let known = (
                take(&mut old_conflicts, pair.slots),
                take(&mut old_plains, pair.slots),
            );
            if pair.is_new {
                source.always(pair, alert, scratch, conflicts, plains);
            } else {
                conflicts.extend_from_slice(known.0);
                plains.extend_from_slice(known.1);
            }
        }
    }
}

/// The entries of a pair, off the front of a sorted list.
fn take<'e, T>(entries: &mut &'e [(Slots, T)], slots: Slots) -> &'e [(Slots, T)] {
    let skipped = entries.iter().take_while(|entry| entry.0 < slots).count();
    let count = entries[skipped..]
        .iter()
        .take_while(|entry| entry.0 == slots)
        .count();
    let found = &entries[skipped..skipped + count];
    *entries = &entries[skipped + count..];
    found
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
        conflicts: &mut Vec<(Slots, Conflict)>,
        plains: &mut Vec<(Slots, Plain)>,
    ) {
        let slots = pair.slots;
        let Some(always) = self.outlook.domain(self.scene, slots) else {
            return;
        };
        let contacts = &mut scratch.contacts;
        self.outlook.contacts(pair, alert.margin, always, contacts);
        let report = |contact| Some((slots, self.report(slots, always, contact)?));
        conflicts.extend(contacts.iter().filter_map(report));
        let ahead = Tick {
            told: f64::NEG_INFINITY,
            known: f64::INFINITY,
            ..Tick::default()
        };
        self.each_plain(pair, alert, &ahead, always, scratch, |plain| {
            plains.push((slots, plain));
        });
    }

    fn clip(&self, slots: Slots, (from, to): (f64, f64)) -> Option<(f64, f64)> {
        let (start, end) = self.outlook.domain(self.scene, slots)?;
        let (start, end) = (start.max(from), end.min(to));
        (start <= end).then_some((start, end))
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
        let (Some(pair), Some(clip)) = (self.pair(slots), self.clip(slots, window)) else {
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
        if let (Some(pair), Some(clip)) = (self.pair(slots), self.clip(slots, window)) {
            self.each_plain(pair, alert, tick, clip, scratch, |plain| plains.push(plain));
        }
    }

    fn each_plain(
        &self,
        pair: &Pair,
        alert: &AlertLevel,
        tick: &Tick,
        clip: (f64, f64),
        scratch: &mut Scratch,
        mut visit: impl FnMut(Plain),
    ) {
        let outlook = self.outlook;
        let Scratch {
            contacts,
            released,
            passed,
        } = scratch;
        outlook.contacts(pair, alert.margin, clip, contacts);
        if alert.release > alert.margin {
            outlook.contacts(pair, alert.release, clip, released);
        } else {
            released.clone_from(contacts);
        }
        let domain = outlook.domain(self.scene, pair.slots);
        let ends = domain.map_or(tick.known, |(_, end)| end);
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
