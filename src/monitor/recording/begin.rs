//! A monitor as it is written at the beginning of a recording.

use crate::error::{Error, LARGEST_MAGNITUDE};
use crate::monitor::encounters::{Encounters, Saved};
use crate::monitor::{AlertLevel, Event, LeastChange, Monitor};
use crate::rounding::one_zero;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

/// What a monitor cannot work out from the rest.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::monitor) struct Begin {
    scene: Scene,
    now: f64,
    told: f64,
    lookahead: f64,
    levels: Vec<AlertLevel>,
    least_change: LeastChange,
    #[serde(with = "super::number")]
    history: f64,
    /// Recordings of old have none: there was no limit.
    #[serde(default = "no_limit")]
    most_spans: usize,
    next_id: u64,
    /// By level.
    encounters: Vec<Saved>,
    waiting: Vec<Event>,
    /// By slot: whether the end of its plan, if it has one, has been told.
    end_told: Vec<bool>,
    /// Another tick at the same time would find everything as it is.
    #[serde(default)]
    settled: bool,
}

const fn no_limit() -> usize {
    usize::MAX
}

impl Begin {
    pub(super) fn of(monitor: &Monitor) -> Self {
        Self {
            scene: monitor.scene.clone(),
            now: monitor.now,
            told: monitor.told,
            lookahead: monitor.lookahead,
            levels: monitor.levels.clone(),
            least_change: monitor.least_change,
            history: monitor.history,
            most_spans: monitor.outlook.most_spans,
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
    pub(super) fn monitor(self) -> Result<Monitor, Error> {
        let mut monitor = Monitor::new(self.scene, self.told, self.lookahead, &self.levels)?;
        let is_time = |time: f64| time >= self.told && time <= LARGEST_MAGNITUDE;
        if !is_time(self.now) {
            return Err(Error::ClockWentBack {
                now: self.told,
                time: self.now,
            });
        }
        let lengths = [self.encounters.len(), self.end_told.len()];
        if lengths != [self.levels.len(), monitor.scene.slots()] || self.history.is_nan() {
            return Err(Error::Lookahead {
                value: self.history,
            });
        }
        monitor.now = one_zero(self.now);
        monitor.known = self.told;
        if self.settled {
            // All of it has been told.
            monitor.advance_to(self.now, self.now + self.lookahead, &mut Vec::new())?;
        }
        monitor.least_change = self.least_change;
        monitor.history = self.history;
        monitor.set_most_spans(self.most_spans);
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
