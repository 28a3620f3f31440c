//! Limits of the work of a tick.

use crate::parallel;
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
    ///   many times in the lookahead.
    /// - A search of all bodies in a part of the time: a far jump of the clock, and a slice with too many pairs, are
    ///   searched in parts.
    /// - A search of the whole lookahead, where most bodies change in each tick. It takes few slices, often one. It
    ///   is done only if the tick before had time for all of these, or all but one.
    ///
    /// A tick with a budget searches on one thread. Only dropping replaced plans, and reading what was found, may take a
    /// second one.
    ///
    /// The changes of each tick must fit in. Where few plans change, half of what unlimited ticks take lets less be
    /// known ahead. Where all bodies are told each tick, give clearly more than an unlimited tick takes. With less
    /// [`complete_until`](crate::Monitor::complete_until) may stand still until fewer plans change or a tick has more
    /// time. Meanwhile the monitor keeps all told motions, so that memory and the time of each change grow.
    Time(Duration),
    /// Counted work: boxes formed, candidates examined, and one for each step. It is the same on every
    /// machine and in every run. With 0 a monitor never catches up, however many ticks it makes.
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
    deadline: Option<Instant>,
    /// Largest work.
    limit: Option<u64>,
    /// Prescribed end of the known time, s.
    until: Option<f64>,
    done: u64,
}

impl BudgetMeter {
    pub(super) fn start(budget: Budget) -> Self {
        let (deadline, limit) = match budget {
            Budget::Unlimited => (None, None),
            Budget::Time(time) => (Instant::now().checked_add(time), None),
            Budget::Work(work) => (None, Some(work)),
        };
        Self {
            deadline,
            limit,
            until: None,
            done: 0,
        }
    }

    /// Returns the meter of a tick whose known time is to end at `until` (s): for the replay of a tick with a budget.
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

    /// Returns the work counted so far, as in [`Budget::Work`].
    #[cfg(feature = "recording")]
    pub(super) const fn done(&self) -> u64 {
        self.done
    }

    pub(super) fn is_unlimited(&self) -> bool {
        self.deadline.is_none() && self.limit.is_none() && self.until.is_none()
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
        // However little time there is, something is done: else nothing ever would be.
        let is_late = |end| self.done > 0 && Instant::now() >= end;
        self.limit.is_some_and(|limit| self.done >= limit) || self.deadline.is_some_and(is_late)
    }
}
