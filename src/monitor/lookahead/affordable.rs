//! Ticks with a budget that cannot leave a part of their work to the next tick, since bodies change again by then. They
//! search less of the lookahead instead.

use super::super::budget::BudgetMeter;

/// The part of the lookahead that the budget of a tick suffices for, as far as earlier ticks tell.
#[derive(Clone, Copy, Debug)]
pub(in crate::monitor) struct AffordableLookahead {
    /// Share of the lookahead, beyond the clock.
    share: f64,
    /// True if something has changed at this tick.
    has_changed: bool,
    /// True if the last tick at which something had changed had to finish its search.
    had_to_finish: bool,
    /// Ticks whose known time was behind the clock and hardly gained on it, since all was known.
    late_ticks: u32,
    /// The clock at the last tick, and the end of what was known, s.
    last: (f64, f64),
}

impl AffordableLookahead {
    /// A search of less takes hardly less time: the boxes of all bodies are formed for any.
    const LEAST_SHARE: f64 = 1.0 / 16.0;
    /// Late ticks after which no work is left to the next tick. Fewer are usual when a monitor begins.
    const MANY_LATE_TICKS: u32 = 32;

    /// Returns that of a monitor whose clock is `now` (s).
    pub(super) const fn new(now: f64) -> Self {
        Self {
            share: 1.0,
            has_changed: false,
            had_to_finish: false,
            late_ticks: 0,
            last: (now, now),
        }
    }

    /// Returns true if all of the lookahead was, the last time that something had changed.
    pub(super) fn is_all(&self) -> bool {
        self.share >= 1.0
    }

    /// Returns the instant (s) up to which a tick is to search a lookahead (first and last instant, s). `has_changed` says
    /// if anything has changed, `is_unknown_again` if the search is one from nothing, and so it was a few ticks before. If the
    /// tick cannot leave anything to the next one, the meter is told to let it finish.
    pub(super) fn end_of_search(
        &mut self,
        (now, end): (f64, f64),
        (has_changed, is_unknown_again): (bool, bool),
        meter: &mut BudgetMeter,
    ) -> f64 {
        self.has_changed = has_changed;
        let is_late = self.late_ticks >= Self::MANY_LATE_TICKS;
        // What has not changed is not searched for again: it can be left to the next tick.
        let has_to_finish = self.has_changed && (is_late || is_unknown_again);
        if !(has_to_finish && meter.has_limit()) {
            return end;
        }
        meter.let_finish();
        (now + self.share * (end - now)).min(end)
    }

    /// Takes note of what a tick came to know of a lookahead (first and last instant, s), up to `known` (s).
    pub(in crate::monitor) fn note(
        &mut self,
        meter: &BudgetMeter,
        (now, end): (f64, f64),
        known: f64,
    ) {
        let used = meter.used();
        if self.has_changed {
            self.had_to_finish = meter.has_to_finish();
            let share = if self.had_to_finish {
                // The square root, so that the share does not swing: where a search of twice the time takes four times
                // as long.
                self.share * used.recip().sqrt().clamp(0.5, 2.0)
            } else {
                (known - now) / (end - now)
            };
            self.share = share.clamp(Self::LEAST_SHARE, 1.0);
        }
        let last = std::mem::replace(&mut self.last, (now, known));
        // A tick without changes may know all only because the one before had to finish.
        if known >= end && used <= 1.0 && (self.has_changed || !self.had_to_finish) {
            self.late_ticks = 0;
        } else if known < now && known - last.1 <= 2.0 * (now - last.0) {
            self.late_ticks = self.late_ticks.saturating_add(1);
        }
    }
}
