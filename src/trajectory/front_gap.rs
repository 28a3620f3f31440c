//! A vector with spare capacity in front, so that a splice can prepend without moving the rest.

use crate::simd::prefetch;
use std::iter::repeat_n;
use std::ops::Deref;

/// Spare places in front: for the usual remainder of the previous plan, and one more.
const ROOM: usize = 2;

/// A vector that begins at `first`, with spare places in front of it and `EXTRA` other values in
/// the same allocation.
#[derive(Clone, Debug)]
pub(super) struct FrontGapVec<T, const EXTRA: usize = 0> {
    /// The extra values come first.
    all: Vec<T>,
    first: usize,
}

impl<T: Copy, const EXTRA: usize> FrontGapVec<T, EXTRA> {
    /// Returns an empty list with capacity for `count` entries. The extra values must be
    /// [set](Self::put_extra) once it has an entry.
    pub(super) fn with_capacity(count: usize) -> Self {
        let first = EXTRA + ROOM;
        Self {
            all: Vec::with_capacity(first + count),
            first,
        }
    }

    /// Returns a copy of a list, with spare places in front.
    pub(super) fn new(list: &[T], extra: &[T; EXTRA]) -> Self {
        let mut all = Vec::with_capacity(EXTRA + ROOM + list.len());
        all.extend_from_slice(extra);
        // The spare places are never read.
        if let Some(&any) = extra.first().or(list.first()) {
            all.extend(repeat_n(any, ROOM));
        }
        let first = all.len();
        all.extend_from_slice(list);
        Self { all, first }
    }

    pub(super) fn push(&mut self, entry: T) {
        if self.all.is_empty() {
            self.all.extend(repeat_n(entry, self.first));
        }
        self.all.push(entry);
    }

    /// Takes the last entry out.
    pub(super) fn pop(&mut self) {
        if self.all.len() > self.first {
            self.all.pop();
        }
    }

    /// Keeps the first `count` entries.
    pub(super) fn truncate(&mut self, count: usize) {
        self.all.truncate(self.first + count);
    }

    pub(super) fn extra(&self) -> &[T] {
        &self.all[..EXTRA]
    }

    pub(super) fn put_extra(&mut self, place: usize, value: T) {
        self.all[..EXTRA][place] = value;
    }

    /// Replaces the first `replaced` entries by `count` new ones.
    pub(super) fn replace_front(
        &mut self,
        replaced: usize,
        count: usize,
        new: impl Iterator<Item = T>,
    ) {
        let rest = self.first + replaced;
        if EXTRA + count <= rest {
            self.first = rest - count;
            for (entry, new) in self.all[self.first..rest].iter_mut().zip(new) {
                *entry = new;
            }
        } else {
            self.first = EXTRA;
            self.all.splice(EXTRA..rest, new.take(count));
        }
    }

    pub(super) fn all_mut(&mut self) -> &mut [T] {
        self.front_mut(self.len())
    }

    pub(super) fn front_mut(&mut self, count: usize) -> &mut [T] {
        &mut self.all[self.first..][..count]
    }

    /// Prefetches both ends of the allocation.
    pub(super) fn prefetch_ends(&self) {
        prefetch(&self.all[..self.all.len().min(1)]);
        prefetch(&self.all[self.all.len().saturating_sub(1)..]);
    }

    pub(super) fn drop_front(&mut self, count: usize) {
        self.all.drain(EXTRA..self.first + count);
        self.first = EXTRA;
    }
}

impl<T, const EXTRA: usize> Deref for FrontGapVec<T, EXTRA> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        self.all.get(self.first..).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::FrontGapVec;

    #[test]
    fn equals_a_plain_list_whatever_is_replaced_and_dropped() {
        let mut roomy = FrontGapVec::<usize, 2>::with_capacity(4);
        (0..4).for_each(|entry| roomy.push(entry));
        roomy.put_extra(0, 70);
        roomy.put_extra(1, 71);
        let mut plain = vec![0, 1, 2, 3];
        let memory = roomy.all.as_ptr();
        // Within the room, beyond it, and back.
        for (replaced, count) in [(1, 2), (0, 1), (0, 3), (2, 0), (0, 1), (1, 4)] {
            let new = 10 * count..11 * count;
            roomy.replace_front(replaced, count, new.clone());
            plain.splice(..replaced, new);
            assert_eq!((&*roomy, roomy.extra()), (&plain[..], &[70, 71][..]));
            if plain.len() == 6 {
                assert_eq!(roomy.all.as_ptr(), memory, "there was room");
            }
        }
        roomy.drop_front(3);
        assert_eq!((&*roomy, roomy.extra()), (&plain[3..], &[70, 71][..]));
    }
}
