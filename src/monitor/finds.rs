//! Every span in which a pair may come within the largest margin, solved once and kept.

use super::bodies::Bodies;
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

/// A span that was found to matter, and its solution for one pair of spheres.
#[derive(Clone, Copy, Debug)]
struct Find {
    key: Key,
    solved: Solved,
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
    /// Sorted by key.
    finds: Vec<Find>,
    merged: Vec<Find>,
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
        self.keep(|find| !is_gone(find.key.a) && !is_gone(find.key.b));
    }

    /// Forgets spans that end before `from` (s).
    pub(super) fn forget_before(&mut self, from: f64) {
        self.keep(|find| find.solved.span().end >= from);
    }

    fn keep(&mut self, keeps: impl Fn(&Find) -> bool) {
        let count = self.finds.len();
        self.finds.retain(keeps);
        self.is_stale |= self.finds.len() < count;
    }

    /// Solves the survivors (sorted by key, each once) that are not there yet; returns how many.
    pub(super) fn add(&mut self, survivors: &[(Key, Span)], bodies: &Bodies<'_>) -> u64 {
        let mut count = 0;
        self.merged.clear();
        self.merged.reserve(self.finds.len());
        let mut rest = &self.finds[..];
        for &(key, span) in survivors {
            let before = rest.partition_point(|find| find.key < key);
            self.merged.extend_from_slice(&rest[..before]);
            rest = &rest[before..];
            if rest.first().is_some_and(|find| find.key == key) {
                continue;
            }
            let parties = [key.a, key.b].map(|slot| bodies.party(slot));
            let [Some(a), Some(b)] = parties else {
                continue;
            };
            count += 1;
            let known = self.merged.len();
            solve(&a, &b, span, bodies.margin, |solved| {
                self.merged.push(Find { key, solved });
            });
            if self.merged.len() > known {
                self.grown.push(key.pair());
            }
        }
        if self.grown.is_empty() {
            return count;
        }
        self.merged.extend_from_slice(rest);
        std::mem::swap(&mut self.finds, &mut self.merged);
        self.is_stale = true;
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
        for finds in self.finds.chunk_by(|x, y| x.key.pair() == y.key.pair()) {
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
        let solved = self.finds[pair.finds.clone()]
            .iter()
            .map(|find| &find.solved);
        contacts_of(solved, margin, clip, found);
    }
}
