//! Pairs that a kernel could not settle, gathered until they fill a block.

use super::batch::Lanes;
use super::loops::BLOCK;
use crate::guess::ControlPoints;
use crate::real::Real;

/// Rounds a number of lanes up to whole vectors of 64 bytes.
pub(super) fn whole_vectors<R>(count: usize) -> usize {
    count.next_multiple_of(64 / size_of::<R>())
}

/// Returns true if a certificate is positive, and so not NaN.
#[inline(always)]
pub(super) fn is_positive<R: Real>(certificate: R) -> bool {
    certificate > R::from_f64(0.0)
}

/// Places in a block, in order: a byte for each that is 1 if the place is one of them. Eight are skipped at
/// once, for most blocks have few.
#[derive(Debug)]
pub(super) struct Places {
    words: [u64; BLOCK / 8],
    /// Number of words that are done.
    done: usize,
}

impl Places {
    /// Returns the places of the values of a block for which a test is true.
    #[inline(always)]
    pub(super) fn of<T>(values: &[T], test: impl Fn(&T) -> bool) -> Self {
        let mut flags = [0; BLOCK];
        for (flag, value) in flags.iter_mut().zip(values) {
            *flag = u8::from(test(value));
        }
        let mut words: [u64; BLOCK / 8] = bytemuck::cast(flags);
        // The first place is the lowest byte.
        for word in &mut words {
            *word = u64::from_le(*word);
        }
        Self { words, done: 0 }
    }
}

impl Iterator for Places {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        while let Some(word) = self.words.get_mut(self.done) {
            if *word != 0 {
                let place = 8 * self.done + word.trailing_zeros() as usize / 8;
                *word &= *word - 1;
                return Some(place);
            }
            self.done += 1;
        }
        None
    }
}

/// Up to a block of pairs, each with `EXTRAS` more numbers.
#[derive(Debug)]
pub(super) struct RetryQueue<R, const EXTRAS: usize> {
    /// Numbers of the pairs in the batch.
    pairs: [usize; BLOCK],
    coordinates: [[[R; BLOCK]; 4]; 3],
    extras: [[R; BLOCK]; EXTRAS],
    count: usize,
}

impl<R: Real, const EXTRAS: usize> RetryQueue<R, EXTRAS> {
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

    /// Returns the number of a pair in its batch.
    #[inline]
    pub(super) fn pair(&self, i: usize) -> usize {
        self.pairs[i]
    }

    #[inline]
    pub(super) fn control_points(&self, i: usize) -> ControlPoints<R> {
        self.lanes().control_points(i)
    }

    /// Returns the number of lanes: that of the pairs, rounded up to whole vectors of 64 bytes so
    /// that the last pairs are not done one by one. The spare lanes hold arbitrary values.
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
