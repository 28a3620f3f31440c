//! Pairs that a kernel could not settle, gathered until they fill a block.

use super::batch::Lanes;
use super::cubic::ControlPoints;
use super::loops::BLOCK;
use super::real::Real;

/// Up to a block of pairs with `EXTRAS` more numbers each.
#[derive(Debug)]
pub(super) struct Pending<R, const EXTRAS: usize> {
    /// Where they were in the batch.
    pairs: [usize; BLOCK],
    coordinates: [[[R; BLOCK]; 4]; 3],
    extras: [[R; BLOCK]; EXTRAS],
    count: usize,
}

impl<R: Real, const EXTRAS: usize> Pending<R, EXTRAS> {
    pub(super) fn new() -> Self {
        Self {
            pairs: [0; BLOCK],
            coordinates: [[[R::default(); BLOCK]; 4]; 3],
            extras: [[R::default(); BLOCK]; EXTRAS],
            count: 0,
        }
    }

    /// Appends a pair; there must be room.
    #[inline]
    pub(super) fn push(&mut self, pair: usize, points: ControlPoints<R>, extras: [R; EXTRAS]) {
        let i = self.count;
        self.pairs[i] = pair;
        for (axis, column) in self.coordinates.iter_mut().enumerate() {
            for (slot, point) in column.iter_mut().zip(&points) {
                slot[i] = point[axis];
            }
        }
        for (slot, extra) in self.extras.iter_mut().zip(extras) {
            slot[i] = extra;
        }
        self.count += 1;
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    #[inline]
    pub(super) fn is_full(&self) -> bool {
        self.count == BLOCK
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// The number that a pair has in its batch.
    #[inline]
    pub(super) fn pair(&self, i: usize) -> usize {
        self.pairs[i]
    }

    pub(super) fn lanes(&self) -> Lanes<'_, R> {
        Lanes {
            coordinates: self
                .coordinates
                .each_ref()
                .map(|axis| axis.each_ref().map(|slot| &slot[..self.count])),
        }
    }

    pub(super) fn extras(&self) -> [&[R]; EXTRAS] {
        self.extras.each_ref().map(|slot| &slot[..self.count])
    }
}

/// The places in a block where something holds, in order.
#[derive(Debug)]
pub(super) struct Selection {
    places: [usize; BLOCK],
    count: usize,
}

impl Selection {
    /// Without branches: which places they are cannot be predicted.
    #[inline]
    pub(super) fn new(holds: impl Iterator<Item = bool>) -> Self {
        let mut places = [0; BLOCK];
        let mut count = 0;
        for (i, holds) in holds.take(BLOCK).enumerate() {
            // Not more than i, so the remainder changes nothing but the bounds check.
            places[count % BLOCK] = i;
            count += usize::from(holds);
        }
        Self { places, count }
    }

    #[inline]
    pub(super) fn places(&self) -> &[usize] {
        &self.places[..self.count]
    }
}
