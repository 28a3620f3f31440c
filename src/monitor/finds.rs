//! Every span in which a pair may come within the largest margin, solved once and kept.

use super::bodies::Bodies;
use super::kept::Kept;
use crate::narrow_phase::{Contact, Solved, contacts_of, solve};
use crate::spans::Span;
use std::ops::Range;

/// A pair (by slot, the smaller first) and a cubic of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) span_a: u32,
    pub(super) span_b: u32,
}

impl Key {
    pub(super) fn pair(&self) -> (u32, u32) {
        (self.a, self.b)
    }
}

/// A pair with its solved spans.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// Slots, the smaller first.
    pub(super) slots: (u32, u32),
    finds: Range<usize>,
    /// Spans were added since [`Finds::all_are_read`].
    pub(super) is_new: bool,
}

/// See the module.
#[derive(Debug, Default)]
pub(super) struct Finds {
    /// The solution of each span for each two spheres.
    finds: Kept<Key, Solved>,
    /// Sorted by slots.
    pairs: Vec<Pair>,
    /// Pairs to which spans were added, sorted.
    grown: Vec<(u32, u32)>,
    /// Some were dropped or added since the pairs were listed.
    is_stale: bool,
}

impl Finds {
    /// Forgets all that concerns some bodies.
    pub(super) fn forget(&mut self, is_gone: impl Fn(u32) -> bool) {
        let gone = self
            .finds
            .retain(|find| !is_gone(find.key.a) && !is_gone(find.key.b));
        self.is_stale |= gone;
    }

    /// Forgets spans that end before `from` (s).
    pub(super) fn forget_before(&mut self, from: f64) {
        self.is_stale |= self.finds.retain(|find| find.interval.1 >= from);
    }

    /// Solves the survivors (sorted by key, each once) that are not there yet; returns how many.
    pub(super) fn add(&mut self, survivors: &[(Key, Span)], bodies: &Bodies<'_>) -> u64 {
        let mut count = 0;
        for &(key, span) in survivors {
            if self.finds.has(&key) {
                continue;
            }
            let parties = [key.a, key.b].map(|slot| bodies.party(slot));
            let [Some(a), Some(b)] = parties else {
                continue;
            };
            count += 1;
            let mut is_found = false;
            solve(&a, &b, span, bodies.margin, |solved| {
                self.finds.add(key, (span.start, span.end), solved);
                is_found = true;
            });
            if is_found {
                self.grown.push(key.pair());
            }
        }
        self.finds.settle();
        self.is_stale |= !self.grown.is_empty();
        count
    }

    /// Brings the list of pairs up to date; whether it has changed.
    pub(super) fn list_pairs(&mut self) -> bool {
        if !self.is_stale {
            return false;
        }
        self.is_stale = false;
        self.pairs.clear();
        self.grown.dedup();
        let mut grown = self.grown.drain(..).peekable();
        let mut first = 0;
        let entries = self.finds.entries();
        for finds in entries.chunk_by(|x, y| x.key.pair() == y.key.pair()) {
            let slots = finds[0].key.pair();
            let end = first + finds.len();
            self.pairs.push(Pair {
                slots,
                finds: first..end,
                is_new: grown.next_if_eq(&slots).is_some(),
            });
            first = end;
        }
        true
    }

    /// All pairs, sorted.
    pub(super) fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Nothing is new any more.
    pub(super) fn all_are_read(&mut self) {
        for pair in &mut self.pairs {
            pair.is_new = false;
        }
    }

    /// All contacts of a pair within `margin` in `clip`, in the order of time; replaces what
    /// `found` held.
    pub(super) fn contacts(
        &self,
        pair: &Pair,
        margin: f64,
        clip: (f64, f64),
        found: &mut Vec<Contact>,
    ) {
        found.clear();
        let solved = self.finds.entries()[pair.finds.clone()]
            .iter()
            .map(|find| self.finds.at(find.place));
        contacts_of(solved, margin, clip, found);
    }
}
