//! A list with room in front: what a new plan needs to take over the end of the one before it
//! without a move of all its numbers.

use std::iter::repeat_n;
use std::ops::Deref;

/// Entries that there is room for: what is usually left of the plan before, and one more.
const ROOM: usize = 2;

/// A list of numbers, without what lies before `first`.
#[derive(Clone, Debug)]
pub(super) struct Roomy<T> {
    all: Vec<T>,
    first: usize,
}

impl<T: Copy> Roomy<T> {
    /// An empty list with memory for some entries, and room in front of them.
    pub(super) fn with_capacity(count: usize) -> Self {
        Self {
            all: Vec::with_capacity(ROOM + count),
            first: ROOM,
        }
    }

    pub(super) fn push(&mut self, entry: T) {
        if self.all.is_empty() {
            self.all.extend(repeat_n(entry, self.first));
        }
        self.all.push(entry);
    }

    /// Puts `count` new entries in place of the first `replaced` ones.
    pub(super) fn replace_front(
        &mut self,
        replaced: usize,
        count: usize,
        new: impl Iterator<Item = T>,
    ) {
        let rest = self.first + replaced;
        if count <= rest {
            self.first = rest - count;
            for (entry, new) in self.all[self.first..rest].iter_mut().zip(new) {
                *entry = new;
            }
        } else {
            self.first = 0;
            self.all.splice(..rest, new.take(count));
        }
    }

    /// Drops the first entries.
    pub(super) fn drop_front(&mut self, count: usize) {
        self.all.drain(..self.first + count);
        self.first = 0;
    }
}

impl<T> Deref for Roomy<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        self.all.get(self.first..).unwrap_or_default()
    }
}

impl<T> From<Vec<T>> for Roomy<T> {
    fn from(all: Vec<T>) -> Self {
        Self { all, first: 0 }
    }
}

impl<T: PartialEq> PartialEq for Roomy<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}
