//! Pairs that a kernel could not settle, gathered until they fill a block.

use std::cmp::Ordering;

use super::batch::Lanes;
use super::cubic::ControlPoints;
use super::loops::BLOCK;
use crate::real::Real;

/// A number of lanes filled up to whole vectors of 64 bytes.
pub(super) fn whole_vectors<R>(count: usize) -> usize {
    count.next_multiple_of(64 / size_of::<R>())
}

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

    /// Appends as many of the selected pairs of a block as there is room for, and takes them from
    /// the selection. The block begins at pair `start` of the batch.
    ///
    #[inline]
    pub(super) fn take(
        &mut self,
        selection: &mut Selection,
        start: usize,
        lanes: &Lanes<'_, R>,
        extras: [&[R]; EXTRAS],
    ) {
        // Cut to one length, so that one check of a place serves all columns.
        let count = lanes.len().min(BLOCK);
        let lanes = lanes.first(count);
        let extras = extras.map(|extra| &extra[..count]);
        for i in self.count..BLOCK {
            let Some(place) = selection.next() else {
                return;
            };
            self.count = i + 1;
            self.pairs[i] = start + place;
            for axis in 0..3 {
                for point in 0..4 {
                    self.coordinates[axis][point][i] = lanes.coordinates[axis][point][place];
                }
            }
            for (slot, extra) in self.extras.iter_mut().zip(extras) {
                slot[i] = extra[place];
            }
        }
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
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

    /// The control points of a pair.
    #[inline]
    pub(super) fn control_points(&self, i: usize) -> ControlPoints<R> {
        let at = |point: usize| {
            let [x, y, z] = &self.coordinates;
            [x[point][i], y[point][i], z[point][i]]
        };
        [at(0), at(1), at(2), at(3)]
    }

    /// The number of lanes: that of the pairs, filled up to whole vectors of 64 bytes. What is in
    /// the lanes without a pair is of no use; without them the last pairs would be done one by one.
    pub(super) fn width(&self) -> usize {
        whole_vectors::<R>(self.count)
    }

    pub(super) fn lanes(&self) -> Lanes<'_, R> {
        let width = self.width();
        Lanes {
            coordinates: self
                .coordinates
                .each_ref()
                .map(|axis| axis.each_ref().map(|slot| &slot[..width])),
        }
    }

    pub(super) fn extras(&self) -> [&[R]; EXTRAS] {
        let width = self.width();
        self.extras.each_ref().map(|slot| &slot[..width])
    }
}

/// A flag for each pair of a block, in words of 64.
pub(super) const FLAGS: usize = BLOCK.next_multiple_of(64);

/// Places in a block, taken in order: a bit for each, so that few branches cannot be predicted.
#[derive(Debug)]
pub(super) struct Selection {
    bits: [u64; FLAGS / 64],
    /// Words before this one are empty.
    word: usize,
}

impl Selection {
    /// The places of a block whose certificate is not positive, or not a number.
    #[inline]
    pub(super) fn without(certificates: &[f32]) -> Self {
        let mut flags = [0_u8; FLAGS];
        for (flag, certificate) in flags.iter_mut().zip(certificates) {
            // Also where it is not a number.
            *flag = u8::from(certificate.partial_cmp(&0.0) != Some(Ordering::Greater));
        }
        Self::of(&flags)
    }

    /// The places of a block with a 1; all others are 0.
    #[inline]
    pub(super) fn of(flags: &[u8; FLAGS]) -> Self {
        let mut bits = [0; FLAGS / 64];
        let (words, _) = flags.as_chunks::<64>();
        for (bits, word) in bits.iter_mut().zip(words) {
            let (chunks, _) = word.as_chunks::<8>();
            for chunk in chunks.iter().rev() {
                // The product brings the lowest bits of the eight bytes side by side to the top.
                let byte = u64::from_le_bytes(*chunk).wrapping_mul(0x0102_0408_1020_4080) >> 56;
                *bits = *bits << 8 | byte;
            }
        }
        Self { bits, word: 0 }
    }

    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.bits.iter().all(|bits| *bits == 0)
    }

    #[inline]
    pub(super) fn next(&mut self) -> Option<usize> {
        while let Some(bits) = self.bits.get_mut(self.word) {
            if *bits != 0 {
                let place = 64 * self.word + bits.trailing_zeros() as usize;
                *bits &= *bits - 1;
                return Some(place);
            }
            self.word += 1;
        }
        None
    }
}
