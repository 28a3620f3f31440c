//! The state machine of encounters: from planned encounters, tick by tick, to events.
//!
//! Its input, for each alert level, is the planned encounters of pairs that may have changed, in the
//! window from the instant up to which the last tick reported to the end of the known time. [`Encounter`] says how old
//! and new ones are matched.

use super::event::{Encounter, EncounterId, EndReason, Event, EventKind};
use super::sent_numbers::{SentNumbers, differs};
use super::solved_conflict::{SolvedApproach, SolvedConflict};
use super::solved_spans::SlotPair;
use super::sorted_slab::SortedSlab;
use super::tick_context::TickContext;
use crate::scene::Scene;
use std::cmp::Ordering;

/// An encounter as the plans have it now.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlannedEncounter {
    /// The conflict at the release margin. It is clipped at its exit if that is the end of a body's trajectory.
    pub(super) solved: SolvedConflict,
    /// First instant within the margin, s; none if only the release margin is kept.
    pub(super) enter: Option<f64>,
    /// True if the exit is the end of the known time.
    pub(super) open: bool,
    /// Closest approach up to the clock, if the conflict has begun by then.
    pub(super) passed: Option<SolvedApproach>,
}

/// An encounter that has begun and not ended, or lies ahead.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct TrackedEncounter {
    /// As of the last tick that updated it.
    encounter: Encounter,
    sent: SentNumbers,
    begun: bool,
    ends_with_trajectory: bool,
    /// Closest approach so far, once it has begun.
    passed: Option<SolvedApproach>,
}

impl TrackedEncounter {
    /// Returns why it ends where the plans let it end.
    const fn reason_of_end(&self) -> EndReason {
        if self.ends_with_trajectory {
            EndReason::TrajectoryEnded
        } else {
            EndReason::Separated
        }
    }
}

/// The saved encounters of a level.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Saved(Vec<TrackedEncounter>);

impl Saved {
    /// Returns true if a monitor of this scene that has reported all up to `reported` (s) can have had these.
    pub(super) fn could_be(&self, level: usize, reported: f64, scene: &Scene) -> bool {
        self.0.iter().all(|tracked| {
            let TrackedEncounter {
                encounter,
                sent,
                passed,
                ..
            } = tracked;
            let has = |id, tag| scene.body(id).is_some_and(|body| body.tag == tag);
            let are_there = has(encounter.a, encounter.tag_a) && has(encounter.b, encounter.tag_b);
            let is_of_level = encounter.level == level && encounter.could_be(level + 1);
            let is_begun = tracked.begun == (encounter.enter <= reported);
            let is_passed = passed.is_none_or(|passed| tracked.begun && passed.is_finite());
            are_there && is_of_level && is_begun && is_passed && sent.are_finite()
        })
    }

    pub(super) fn ids(&self) -> impl Iterator<Item = u64> {
        self.0.iter().map(|tracked| tracked.encounter.id.0)
    }
}

/// The encounters of one alert level.
#[derive(Clone, Debug, Default)]
pub(super) struct EncounterTracker {
    level: usize,
    /// Encounters; of one pair in the order of time.
    tracked: SortedSlab<SlotPair, TrackedEncounter>,
    /// Pairs with a tracked encounter that begins beyond the known time, and was not found again, sorted.
    waiting: Vec<SlotPair>,
    /// Pairs that the last update replaced, sorted.
    updated: Vec<SlotPair>,
}

impl EncounterTracker {
    pub(super) fn of_level(level: usize) -> Self {
        Self {
            level,
            ..Self::default()
        }
    }

    /// Returns the encounters that have begun and not ended, or lie ahead.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Encounter> {
        self.tracked.values().map(|tracked| &tracked.encounter)
    }

    /// Returns the pairs that are updated whether they have changed or not, sorted.
    pub(super) fn waiting(&self) -> &[SlotPair] {
        &self.waiting
    }

    /// Makes all pairs wait for an update.
    pub(super) fn wait_for_all(&mut self) {
        self.waiting.clear();
        let tracked = self.tracked.entries().iter();
        self.waiting.extend(tracked.map(|entry| entry.key));
        self.waiting.dedup();
    }

    /// Updates the encounters of some pairs: of those that [wait](Self::waiting), and of all others whose
    /// planned encounters, or what a tick sees of them, are not as they were. Pairs are sorted, and so are
    /// the planned encounters of each, by time.
    pub(super) fn update<'p, P: Iterator<Item = &'p PlannedEncounter>>(
        &mut self,
        listed: impl Iterator<Item = (SlotPair, P)>,
        tick: &TickContext<'_>,
        next_id: &mut u64,
        events: &mut Vec<Event>,
    ) {
        self.updated.clear();
        self.waiting.clear();
        for (slots, planned) in listed {
            self.update_pair(slots, planned, tick, next_id, events);
            self.updated.push(slots);
        }
        let mut updated = self.updated.iter().peekable();
        self.tracked.retain(|entry, _| {
            while updated.next_if(|slots| **slots < entry.key).is_some() {}
            updated.peek() != Some(&&entry.key)
        });
        self.tracked.merge_added();
        // Those that stay as they are have not been listed.
        for tracked in self.tracked.values_mut() {
            if tracked.begun && tracked.encounter.open {
                tracked.encounter.exit = tick.known;
            }
        }
    }

    /// Adds the new encounters of a pair; its old ones stay beside them.
    fn update_pair<'p>(
        &mut self,
        slots: SlotPair,
        planned: impl Iterator<Item = &'p PlannedEncounter>,
        tick: &TickContext<'_>,
        next_id: &mut u64,
        events: &mut Vec<Event>,
    ) {
        let mut old = self.tracked.of(&slots);
        let mut new = planned.peekable();
        loop {
            let first = (!old.is_empty()).then(|| *self.tracked.nth(old.start));
            let order = match (&first, new.peek()) {
                (Some(old), Some(new)) => compare(old, new, tick),
                (Some(_), None) => Ordering::Less,
                (None, _) => Ordering::Greater,
            };
            let first = first.filter(|_| order.is_le());
            let second = new.next_if(|_| order.is_ge());
            old.start += usize::from(first.is_some());
            let goes_on = match (first, second) {
                (None, None) => break,
                (Some(old), None) => unmatched(&old, tick, events),
                (None, Some(new)) => appear(new, self.level, tick, next_id, events),
                (Some(old), Some(new)) => go_on(&old, new, tick, events),
            };
            if let Some(tracked) = goes_on {
                // Only an encounter that was not found again can begin beyond the known time here.
                let waiting = &mut self.waiting;
                if tracked.encounter.enter > tick.known && waiting.last() != Some(&slots) {
                    waiting.push(slots);
                }
                self.add(slots, tracked);
            }
        }
    }

    fn add(&mut self, slots: SlotPair, tracked: TrackedEncounter) {
        let interval = (tracked.encounter.enter, tracked.encounter.exit);
        self.tracked.add(slots, interval, tracked);
    }

    /// Returns a copy of the encounters, to be saved.
    pub(super) fn save(&self) -> Saved {
        Saved(self.tracked.values().copied().collect())
    }

    /// Restores the saved encounters of a level.
    pub(super) fn restored(level: usize, saved: Saved) -> Self {
        let mut encounters = Self::of_level(level);
        let Saved(mut saved) = saved;
        let slots_of =
            |tracked: &TrackedEncounter| (tracked.encounter.a.slot, tracked.encounter.b.slot);
        // They are, unless the file was changed.
        saved.sort_by_key(slots_of);
        for tracked in saved {
            encounters.add(slots_of(&tracked), tracked);
        }
        encounters.tracked.merge_added();
        encounters
    }

    /// Ends or withdraws, at a time (s), the encounters of bodies in slots for which `is_gone` returns true.
    pub(super) fn end(
        &mut self,
        now: f64,
        reason: EndReason,
        is_gone: impl Fn(u32) -> bool,
        events: &mut Vec<Event>,
    ) {
        self.tracked.retain(|entry, tracked| {
            let over = is_gone(entry.key.0) || is_gone(entry.key.1);
            if over {
                events.push(over_at(tracked, now, reason));
            }
            !over
        });
    }
}

/// Returns which comes first: an old encounter, or a new one; equal if the new one is the old one as it is now.
fn compare(old: &TrackedEncounter, new: &PlannedEncounter, tick: &TickContext<'_>) -> Ordering {
    let order =
        (old.encounter.a, old.encounter.b).cmp(&(new.solved.conflict.a, new.solved.conflict.b));
    if order.is_ne() {
        return order;
    }
    let old_is_over = if old.begun {
        // It was under way when the last tick reported: so it is still, or plans have changed.
        new.solved.conflict.enter > tick.before
    } else {
        // An open encounter has no known exit: it may last until the new one.
        !old.encounter.open && old.encounter.exit < new.enter.unwrap_or(new.solved.conflict.enter)
    };
    if old_is_over {
        Ordering::Less
    } else if new.solved.conflict.exit < old.encounter.enter {
        Ordering::Greater
    } else {
        Ordering::Equal
    }
}

fn over_at(tracked: &TrackedEncounter, now: f64, reason: EndReason) -> Event {
    let kind = if tracked.begun {
        let passed = tracked.passed.map(|passed| passed.approach);
        let closest = passed.unwrap_or(tracked.encounter.closest);
        let encounter = Encounter {
            exit: now,
            open: false,
            closest,
            ..tracked.encounter
        };
        EventKind::Ended(encounter, reason)
    } else {
        EventKind::Withdrawn(tracked.encounter)
    };
    Event { time: now, kind }
}

/// Ends or withdraws an encounter that the plans no longer have.
fn unmatched(
    old: &TrackedEncounter,
    tick: &TickContext<'_>,
    events: &mut Vec<Event>,
) -> Option<TrackedEncounter> {
    if !old.begun && old.encounter.enter > tick.known {
        // Nothing is known about it: it waits.
        return Some(*old);
    }
    // A change takes effect at the instant up to which the last tick reported: these events stay.
    let time = if old.begun { tick.before } else { tick.now };
    let has_ended = old.begun && !old.encounter.open && old.encounter.exit <= time;
    let reason = if has_ended {
        // At that very instant. What was followed up to there may be forgotten.
        old.reason_of_end()
    } else {
        EndReason::PlanChanged
    };
    events.push(over_at(old, time, reason));
    None
}

/// Reports a new encounter.
fn appear(
    new: &PlannedEncounter,
    level: usize,
    tick: &TickContext<'_>,
    next_id: &mut u64,
    events: &mut Vec<Event>,
) -> Option<TrackedEncounter> {
    // Within the release margin alone nothing begins.
    let enter = new.enter?;
    let encounter = Encounter {
        id: EncounterId(*next_id),
        a: new.solved.conflict.a,
        b: new.solved.conflict.b,
        tag_a: new.solved.conflict.tag_a,
        tag_b: new.solved.conflict.tag_b,
        level,
        enter,
        exit: new.solved.conflict.exit,
        open: new.open,
        closest: new.solved.conflict.closest,
    };
    *next_id += 1;
    let tracked = TrackedEncounter {
        encounter,
        sent: SentNumbers::of(&encounter),
        begun: false,
        ends_with_trajectory: new.solved.conflict.clip.at_exit,
        passed: None,
    };
    if enter > tick.reported {
        events.push(Event {
            time: tick.now,
            kind: EventKind::Predicted(encounter),
        });
    }
    clock(tracked, new, tick, events)
}

/// Revises an encounter that the plans still have.
fn go_on(
    old: &TrackedEncounter,
    new: &PlannedEncounter,
    tick: &TickContext<'_>,
    events: &mut Vec<Event>,
) -> Option<TrackedEncounter> {
    let Some(enter) = new.enter.or(old.begun.then_some(old.encounter.enter)) else {
        // Only the release margin is left of one that had not begun.
        return unmatched(old, tick, events);
    };
    let mut tracked = *old;
    tracked.ends_with_trajectory = new.solved.conflict.clip.at_exit;
    tracked.encounter.exit = new.solved.conflict.exit;
    tracked.encounter.open = new.open;
    if old.begun {
        tracked.encounter.closest = new.solved.closest().or_passed(old.passed).approach;
    } else {
        tracked.encounter.enter = enter;
        tracked.encounter.closest = new.solved.conflict.closest;
    }
    let revised = differs(&tracked.encounter, &tracked.sent, tick);
    // What ends in this very tick is reported with its last numbers, not revised first.
    let mut tracked = clock(tracked, new, tick, events)?;
    if revised {
        tracked.sent = SentNumbers::of(&tracked.encounter);
        events.push(Event {
            time: tick.now,
            kind: EventKind::Revised(tracked.encounter),
        });
    }
    Some(tracked)
}

/// Begins and ends an encounter that the clock has passed.
fn clock(
    mut tracked: TrackedEncounter,
    new: &PlannedEncounter,
    tick: &TickContext<'_>,
    events: &mut Vec<Event>,
) -> Option<TrackedEncounter> {
    if !tracked.begun && tracked.encounter.enter <= tick.reported {
        tracked.begun = true;
        tracked.sent.know_no_more_than(&tracked.encounter);
        events.push(Event {
            time: tracked.encounter.enter,
            kind: EventKind::Began(tracked.encounter),
        });
    }
    if tracked.begun {
        if let Some(passed) = new.passed {
            tracked.passed = Some(passed.or_passed(tracked.passed));
        }
        if !tracked.encounter.open && tracked.encounter.exit < tick.reported {
            events.push(Event {
                time: tracked.encounter.exit,
                kind: EventKind::Ended(tracked.encounter, tracked.reason_of_end()),
            });
            return None;
        }
    }
    Some(tracked)
}
