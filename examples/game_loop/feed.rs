//! Events as lines that can be read: one for each pair, held for a second.

use nearmiss::{BodyId, Encounter, EncounterId, Event, EventKind};
use std::collections::BTreeSet;

/// Time for which a line is not replaced by another one, s.
const HOLD: f64 = 1.0;
/// Time after which a line goes if nothing more is told of the pair, s.
const KEEP: f64 = 4.0;

/// The latest events of pairs, in the order in which the pairs were first told.
#[derive(Debug, Default)]
pub(crate) struct Feed {
    lines: Vec<Line>,
    /// Encounters of all levels that lie ahead or are under way: bodies, level and id.
    open: BTreeSet<(BodyId, BodyId, usize, EncounterId)>,
}

/// A pair, with what was told of it last.
#[derive(Debug)]
pub(crate) struct Line {
    pub(crate) shown: Told,
    /// When it was first shown, s.
    since: f64,
    /// It is shown when the line has been held for long enough.
    next: Option<Told>,
}

/// An event that is told.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Told {
    /// The clock, s.
    pub(crate) time: f64,
    pub(crate) word: &'static str,
    pub(crate) encounter: Encounter,
    /// True if the encounter is over, and the pair has no other one.
    is_over: bool,
}

impl Told {
    fn of(now: f64, event: &Event) -> Option<Self> {
        let (word, encounter, is_over) = match event.kind {
            EventKind::Predicted(encounter) => ("predicted", encounter, false),
            EventKind::Began(encounter) => ("began", encounter, false),
            EventKind::Withdrawn(encounter) => ("withdrawn", encounter, true),
            EventKind::Ended(encounter, _) => ("ended", encounter, true),
            _ => return None,
        };
        Some(Self {
            time: now,
            word,
            encounter,
            is_over,
        })
    }

    const fn pair(&self) -> (BodyId, BodyId) {
        (self.encounter.a, self.encounter.b)
    }
}

impl Feed {
    /// Takes the events of the tick that ended at `now` (s), of these alert levels and the worse ones.
    pub(crate) fn note(&mut self, now: f64, events: &[Event], lowest_level: usize) {
        let mut told: Vec<Told> = events
            .iter()
            .filter_map(|event| Told::of(now, event))
            .collect();
        for told in &told {
            let Encounter {
                a, b, level, id, ..
            } = told.encounter;
            if told.is_over {
                self.open.remove(&(a, b, level, id));
            } else {
                self.open.insert((a, b, level, id));
            }
        }
        told.retain(|told| told.encounter.level >= lowest_level);
        for mut told in told {
            let (a, b) = told.pair();
            let from = (a, b, lowest_level, EncounterId::from_bits(0));
            let next = self.open.range(from..).next();
            told.is_over &= next.is_none_or(|next| (next.0, next.1) != (a, b));
            let same = |line: &&mut Line| line.shown.pair() == told.pair();
            match self.lines.iter_mut().find(same) {
                // Of several within a tick, that of the worst level.
                Some(line) => {
                    let is_milder = |other: &Told| {
                        other.time >= now && other.encounter.level > told.encounter.level
                    };
                    let latest = line.next.as_ref().unwrap_or(&line.shown);
                    if !is_milder(latest) {
                        line.next = Some(told);
                    }
                }
                None => self.lines.push(Line {
                    shown: told,
                    since: now,
                    next: None,
                }),
            }
        }
        for line in &mut self.lines {
            let is_held = now - line.since < HOLD;
            if let Some(next) = line
                .next
                .take_if(|next| !is_held || next.time <= line.since)
            {
                line.since = now;
                line.shown = next;
            }
        }
    }

    /// Drops the lines that were held long enough, until no more than `room` are left if that can be.
    pub(crate) fn settle(&mut self, now: f64, room: usize) {
        let mut excess = self.lines.len().saturating_sub(room);
        self.lines.retain(|line| {
            let age = now - line.since;
            let is_done = line.next.is_none() && line.shown.is_over;
            let goes = age >= HOLD && (is_done || age >= KEEP || excess > 0);
            excess -= usize::from(goes && excess > 0);
            !goes
        });
    }

    pub(crate) fn lines(&self) -> &[Line] {
        &self.lines
    }
}
