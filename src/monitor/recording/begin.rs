//! A monitor as it is written at the beginning of a recording.

use super::record::Begin;
use crate::error::{Error, MAX_MAGNITUDE};
use crate::monitor::encounters::{Encounters, Saved};
use crate::monitor::{EventKind, Monitor, check_setting};
use crate::rounding::one_zero;

/// More than there will ever be: what comes after it can be counted.
const MAX_ENCOUNTERS: u64 = 1 << 62;

/// Why a monitor that was written cannot be.
pub(super) enum Flaw {
    Refused(Error),
    Contradiction(&'static str),
}

impl From<Error> for Flaw {
    fn from(error: Error) -> Self {
        Self::Refused(error)
    }
}

impl Begin {
    pub(super) fn of(monitor: &Monitor) -> Self {
        Self {
            scene: monitor.scene.clone(),
            now: monitor.now,
            told: monitor.told,
            lookahead: monitor.lookahead,
            levels: monitor.levels.clone(),
            revision_threshold: monitor.revision_threshold,
            history: monitor.history,
            max_spans: monitor.outlook.max_spans,
            next_id: monitor.next_id,
            encounters: monitor
                .encounters
                .iter()
                .map(|level| level.save())
                .collect(),
            waiting: monitor.waiting.clone(),
            end_told: (0..)
                .take(monitor.scene.slots())
                .map(|slot| !monitor.plan_ends.has(slot))
                .collect(),
            settled: monitor.has_told_all(),
        }
    }

    /// The same monitor, with nothing looked at yet, unless it is settled.
    ///
    /// # Errors
    ///
    /// What no monitor writes.
    pub(super) fn monitor(self) -> Result<Monitor, Flaw> {
        let mut monitor = Monitor::new(self.scene, self.told, self.lookahead, &self.levels)?;
        let is_time = |time: f64| time >= self.told && time <= MAX_MAGNITUDE;
        if !is_time(self.now) {
            return Err(Flaw::Refused(Error::ClockWentBack {
                now: self.told,
                time: self.now,
            }));
        }
        let lengths = [self.encounters.len(), self.end_told.len()];
        if lengths != [self.levels.len(), monitor.scene.slots()] {
            return Err(Flaw::Contradiction("its lists do not fit its scene"));
        }
        let could_be =
            |(level, saved): (usize, &Saved)| saved.could_be(level, self.told, monitor.scene());
        if !self.encounters.iter().enumerate().all(could_be) {
            return Err(Flaw::Contradiction("its encounters cannot be"));
        }
        let ended = self.waiting.iter().map(|event| match event.kind {
            EventKind::Ended(it, _) | EventKind::Withdrawn(it) => Ok(it.id.0),
            _ => Err(Flaw::Contradiction("what waits to be told is no end")),
        });
        let mut ids = ended.collect::<Result<Vec<_>, _>>()?;
        ids.extend(self.encounters.iter().flat_map(Saved::ids));
        ids.sort_unstable();
        let are_new = ids.last().is_none_or(|last| *last < self.next_id);
        if !are_new || ids.windows(2).any(|ids| ids[0] == ids[1]) || self.next_id > MAX_ENCOUNTERS {
            return Err(Flaw::Contradiction("its encounters are not told apart"));
        }
        monitor.now = one_zero(self.now);
        monitor.known = self.told;
        if self.settled {
            // All of it has been told.
            monitor.advance_to(self.now, self.now + self.lookahead, &mut Vec::new())?;
        }
        let threshold = self.revision_threshold;
        for value in [threshold.time, threshold.separation, self.history] {
            check_setting(value)?;
        }
        monitor.revision_threshold = threshold;
        monitor.history = self.history;
        monitor.set_max_spans(self.max_spans);
        monitor.next_id = self.next_id;
        for (number, saved) in self.encounters.into_iter().enumerate() {
            monitor.encounters[number] = Encounters::restored(number, saved);
        }
        monitor.waiting = self.waiting;
        for (slot, _) in (0..).zip(self.end_told).filter(|(_, was_told)| *was_told) {
            monitor.plan_ends.set(slot, f64::INFINITY);
        }
        Ok(monitor)
    }
}
