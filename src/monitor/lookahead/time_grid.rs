//! The grid of time: the slices of the lookahead, and where they begin.

use super::LookaheadSearch;
use crate::rounding::last_known;

impl LookaheadSearch {
    /// Returns the end of the last existing slice, s, if slices exist from `from` (s) on; else `from`.
    pub(super) fn laid_until(&self, from: f64) -> f64 {
        let (first, last) = (self.slices.front(), self.slices.back());
        let is_there = first.is_some_and(|first| first.number <= self.index(from));
        last.filter(|_| is_there)
            .map_or(from, |last| last.interval.1.max(from))
    }

    /// Begins the missing slices, from the one that contains `from` to the one after that with `to`. Returns the number
    /// of needed slices: those that have a time in common with `from..=to`, or an instant that may be rounded to `to`.
    pub(super) fn lay_slices(&mut self, from: f64, to: f64) -> usize {
        let mut index = self.index(from);
        let mut needed = 0;
        self.ends.clear();
        loop {
            self.ends.push(self.grid.start(index));
            let is_needed = last_known(self.grid.start(index)) < to;
            let place = usize::try_from(index - self.index(from)).unwrap_or(usize::MAX);
            if place >= self.slices.len() {
                let mut slice = self.unused.pop().unwrap_or_default();
                slice.begin(index, (self.grid.start(index), self.grid.start(index + 1)));
                self.slices.push_back(slice);
            }
            if !is_needed {
                return needed;
            }
            needed += 1;
            index += 1;
        }
    }

    pub(super) fn drop_before(&mut self, from: f64) {
        let first = self.index(from);
        while self
            .slices
            .front()
            .is_some_and(|slice| slice.number < first)
        {
            self.unused.extend(self.slices.pop_front());
        }
    }

    /// Returns the number of the first slice to search for reports from `time` (s) on: the last slice that
    /// begins before `time`. If `time` is a boundary, an instant that is rounded to it may lie in the slice before it.
    /// Further slices are not needed: neighbouring boundaries are many roundings apart.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "saturates; a lookahead of 2^63 slices is refused by `Monitor`"
    )]
    pub(super) fn index(&self, time: f64) -> i64 {
        let mut index = ((time - self.grid.origin) / self.grid.length).floor() as i64;
        while self.grid.start(index) >= time {
            index -= 1;
        }
        index
    }
}
