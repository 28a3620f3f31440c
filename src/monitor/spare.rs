//! Memory of pieces that nobody follows any more, for those to come: bodies that go on beyond their
//! knots are laid out anew with each plan, frame by frame maybe.

use crate::trajectory::Pieces;
use std::sync::{Mutex, PoisonError};

/// See the module. Taken by several threads at once.
#[derive(Debug, Default)]
pub(super) struct Spare {
    /// By class: a plan may be a thousand times as long as another one, whose memory does not serve
    /// it, nor should the other way round be wasted.
    by_class: Mutex<Vec<Shelf>>,
    /// Given back since the last review.
    given: usize,
}

/// Memory of one class.
#[derive(Debug, Default)]
struct Shelf {
    pieces: Vec<Pieces>,
    /// So many there were at least since the last review.
    least: usize,
}

/// Sizes of memory, four to each doubling: none is larger by a quarter than what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Class {
    steps: usize,
    doublings: u32,
}

impl Class {
    /// The largest that is not above `count`.
    const fn within(count: usize) -> Self {
        let doublings = match count.checked_ilog2() {
            Some(log) => log.saturating_sub(2),
            None => 0,
        };
        let steps = count >> doublings;
        Self { steps, doublings }
    }

    /// The smallest that is not below it.
    const fn for_all_of(count: usize) -> Self {
        let within = Self::within(count);
        Self::within(count + (1 << within.doublings) - 1)
    }

    const fn count(self) -> usize {
        self.steps << self.doublings
    }

    const fn number(self) -> usize {
        self.steps + 4 * self.doublings as usize
    }
}

impl Shelf {
    fn take(&mut self) -> Option<Pieces> {
        let pieces = self.pieces.pop();
        self.least = self.least.min(self.pieces.len());
        pieces
    }

    /// Drops what was not needed since the last review.
    fn review(&mut self) {
        self.pieces.truncate(self.pieces.len() - self.least);
        self.least = self.pieces.len();
    }
}

impl Spare {
    /// Pieces that are given back between reviews. Plans that get longer, or no longer go on, leave what
    /// nobody takes again.
    const REVIEW: usize = 4096;

    /// Memory for so many pieces, and no pieces in it.
    pub(super) fn take(&self, count: usize) -> Pieces {
        let class = Class::for_all_of(count);
        let mut by_class = self.by_class.lock().unwrap_or_else(PoisonError::into_inner);
        let shelf = by_class.get_mut(class.number());
        let spare = shelf.and_then(Shelf::take);
        drop(by_class);
        spare.unwrap_or_else(|| Pieces::with_capacity(class.count()))
    }

    pub(super) fn give_back(&mut self, mut pieces: Pieces) {
        pieces.clear();
        let number = Class::within(pieces.capacity()).number();
        let by_class = self.by_class.get_mut();
        let by_class = by_class.unwrap_or_else(PoisonError::into_inner);
        if by_class.len() <= number {
            by_class.resize_with(number + 1, Shelf::default);
        }
        by_class[number].pieces.push(pieces);
        self.given += 1;
        if self.given >= Self::REVIEW {
            self.given = 0;
            by_class.iter_mut().for_each(Shelf::review);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Class, Spare};
    use std::sync::PoisonError;

    #[test]
    fn classes_follow_one_on_another() {
        let mut last = Class::within(0);
        for count in 1..10_000 {
            let (within, class) = (Class::within(count), Class::for_all_of(count));
            assert!(within.count() <= count && count <= class.count());
            assert!(4 * class.count() < 5 * count.max(4), "{count} {class:?}");
            assert_eq!(Class::within(class.count()), class);
            assert_eq!(Class::for_all_of(within.count()), within);
            assert_eq!(within.number(), last.number() + usize::from(within != last));
            last = within;
        }
    }

    #[test]
    fn memory_comes_back_to_those_of_its_size() {
        let mut spare = Spare::default();
        let [small, large] = [6, 173].map(|count| spare.take(count));
        let places = [&small, &large].map(|pieces| pieces.knots.as_ptr());
        spare.give_back(large);
        spare.give_back(small);
        let [large, other, small] = [170, 171, 6].map(|count| spare.take(count));
        assert!(large.capacity() >= 170 && other.capacity() >= 171);
        assert_eq!([&small, &large].map(|pieces| pieces.knots.as_ptr()), places);
        assert!(!places.contains(&other.knots.as_ptr()));
    }

    /// Plans of one size, then of another one: what the first left goes, what is used stays.
    #[test]
    fn what_nobody_takes_is_dropped() {
        let mut spare = Spare::default();
        let held = |spare: &mut Spare| -> usize {
            let by_class = spare.by_class.get_mut();
            let by_class = by_class.unwrap_or_else(PoisonError::into_inner);
            by_class.iter().map(|shelf| shelf.pieces.len()).sum()
        };
        for size in [6, 40, 173] {
            for _ in 0..4 * Spare::REVIEW / 100 {
                let some: Vec<_> = (0..100).map(|_| spare.take(size)).collect();
                some.into_iter().for_each(|pieces| spare.give_back(pieces));
            }
            assert!(held(&mut spare) <= 100, "{size}");
        }
    }
}
