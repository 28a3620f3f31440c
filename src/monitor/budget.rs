//! Limits of the work of a tick.

use crate::parallel;
use crate::rounding::latest_exact;
use crate::scene::PairAdmission;
use crate::stats::Stats;
use crate::wall_clock::Instant;
use std::time::Duration;

/// Limit of the work that a call of [`Monitor::advance_within`](super::Monitor::advance_within) may do
/// before it returns with what it has. Changes, one by one or as a [batch](super::Monitor::apply), do not
/// count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Budget {
    /// No limit.
    Unlimited,
    /// Wall time, checked after every thousand boxes or candidates: so many are examined however short it
    /// is. A tick exceeds the time by:
    ///
    /// - Sorting the boxes of one slice.
    /// - Solving and reading what was found. That is most of the work where many bodies stay near each other, or turn
    ///   many times in the lookahead. Of turns that a far jump of the clock passes over, a tick solves some thousand.
    /// - A search of all bodies in a part of the time: a far jump of the clock, and a slice with too many pairs, are
    ///   searched in parts.
    /// - A search that cannot be left to the next tick: where [many bodies](crate::Monitor#cost) change in each
    ///   tick, or the known time has long been behind the clock while bodies change. Then the tick searches as much of
    ///   the lookahead as earlier ticks had time for, and a 16th at least, whatever time that takes.
    /// - The error [`TooCrowded`](crate::Error::TooCrowded), which asks 16 bodies what comes near them.
    ///
    /// A tick with a budget searches on one thread. Only dropping replaced plans, and reading what was found, may take a
    /// second one.
    ///
    /// So [`complete_until`](crate::Monitor::complete_until) goes on with the clock: with too little time less is known
    /// ahead. Where many bodies change in each tick it stays beyond the clock. Where some change, it may be behind the
    /// clock for 32 ticks that hardly gain on it, and then no longer, until all of the lookahead is known within a budget;
    /// then the same may happen again.
    Time(Duration),
    /// Counted work: boxes formed, candidates examined, and one for each step. It is the same on every
    /// machine and in every run. A tick exceeds it as it does a time where bodies change. With 0 a monitor whose bodies do
    /// not change never catches up, however many ticks it makes.
    Work(u64),
}

/// The work of a tick: the pairs that it looks at, its limit, and what was done.
pub(super) struct TickWork<'s> {
    pub(super) admission: PairAdmission<'s>,
    pub(super) meter: BudgetMeter,
    pub(super) stats: Stats,
}

/// The work done in a tick, and its limit.
#[derive(Debug)]
pub(super) struct BudgetMeter {
    /// Begin of the tick, and the time that it may take.
    time: Option<(Instant, Duration)>,
    /// Largest work.
    limit: Option<u64>,
    /// Prescribed end of the known time, s.
    until: Option<f64>,
    done: u64,
    /// True if the tick is to finish its search even if that exceeds the limit.
    has_to_finish: bool,
}

impl BudgetMeter {
    pub(super) fn start(budget: Budget) -> Self {
        let (time, limit) = match budget {
            Budget::Unlimited => (None, None),
            Budget::Time(time) => (Some((Instant::now(), time)), None),
            Budget::Work(work) => (None, Some(work)),
        };
        Self {
            time,
            limit,
            until: None,
            done: 0,
            has_to_finish: false,
        }
    }

    /// Returns the meter of a tick whose known time is to end at `until` (s): for the replay of a tick with a budget.
    #[cfg(feature = "recording")]
    pub(super) fn up_to(until: f64) -> Self {
        Self {
            until: Some(until),
            ..Self::start(Budget::Unlimited)
        }
    }

    /// Returns the prescribed end of the known time, s, if there is one.
    pub(super) const fn until(&self) -> Option<f64> {
        self.until
    }

    /// Returns true if the prescribed known time ends before an instant (s), and with it all instants that are rounded to its
    /// end.
    pub(super) fn ends_before(&self, time: f64) -> bool {
        let ends_before = |until: f64| latest_exact(latest_exact(until)) < time;
        self.until.is_some_and(ends_before)
    }

    /// Returns the work counted so far, as in [`Budget::Work`].
    #[cfg(feature = "recording")]
    pub(super) const fn done(&self) -> u64 {
        self.done
    }

    pub(super) fn is_unlimited(&self) -> bool {
        !self.has_limit() && self.until.is_none()
    }

    /// Returns true if the tick may leave a part of its search to the next one.
    pub(super) const fn may_stop(&self) -> bool {
        (self.has_limit() || self.until.is_some()) && !self.has_to_finish
    }

    /// Returns true if the tick may leave work to the next one before its budget is spent. One that is replayed ends where the
    /// recorded one did.
    pub(super) const fn may_leave_work(&self) -> bool {
        self.has_limit() && !self.has_to_finish
    }

    /// Returns true if there is a largest time or work.
    pub(super) const fn has_limit(&self) -> bool {
        self.time.is_some() || self.limit.is_some()
    }

    /// Lets the tick finish its search even if that exceeds the limit.
    pub(super) const fn let_finish(&mut self) {
        self.has_to_finish = true;
    }

    pub(super) const fn has_to_finish(&self) -> bool {
        self.has_to_finish
    }

    /// Returns how much of the budget is used: 1 is all of it. Without a limit it is 0.
    #[allow(
        clippy::cast_precision_loss,
        reason = "it steers how far ahead the next tick searches"
    )]
    pub(super) fn used(&self) -> f64 {
        let of_time = |(begin, time): (Instant, Duration)| {
            begin.elapsed().as_secs_f64() / time.as_secs_f64().max(f64::MIN_POSITIVE)
        };
        let of_work = |limit: u64| self.done as f64 / limit.max(1) as f64;
        (self.time.map(of_time))
            .or_else(|| self.limit.map(of_work))
            .unwrap_or(0.0)
    }

    /// Returns the number of threads that may share the searches of the tick.
    pub(super) fn threads(&self) -> usize {
        if self.is_unlimited() {
            parallel::threads()
        } else {
            1
        }
    }

    pub(super) fn count(&mut self, work: usize) {
        self.done += work as u64;
    }

    pub(super) fn is_spent(&self) -> bool {
        if self.has_to_finish {
            return false;
        }
        // However little time there is, something is done: else nothing ever would be.
        let is_late = |(begin, time): (Instant, Duration)| self.done > 0 && begin.elapsed() >= time;
        self.limit.is_some_and(|limit| self.done >= limit) || self.time.is_some_and(is_late)
    }
}
