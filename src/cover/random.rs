//! Random numbers that depend on a seed alone.

use glam::DVec3;

/// The generator `SplitMix64`.
///
/// G. Steele, D. Lea and C. Flood: Fast splittable pseudorandom number generators, OOPSLA 2014.
#[derive(Clone, Debug)]
pub(super) struct Random(u64);

impl Random {
    /// Returns the generator of one of several sequences of a seed.
    pub(super) fn new(seed: u64, sequence: u64) -> Self {
        let mut random = Self(seed);
        let mixed = random.next();
        Self(mixed ^ Self(sequence).next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number in 0..1.
    pub(super) fn unit(&mut self) -> f64 {
        #[allow(clippy::cast_precision_loss, reason = "53 bits")]
        let whole = (self.next() >> 11) as f64;
        whole * f64::EPSILON / 2.0
    }

    /// Returns a number below `count`, which must not be 0.
    pub(super) fn below(&mut self, count: usize) -> usize {
        usize::try_from(self.next() % (count as u64)).unwrap_or(0)
    }

    /// Returns a point in a box.
    pub(super) fn point(&mut self, low: DVec3, high: DVec3) -> DVec3 {
        let shares = DVec3::new(self.unit(), self.unit(), self.unit());
        low + (high - low) * shares
    }
}
