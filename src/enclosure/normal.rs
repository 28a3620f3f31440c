//! Scaling by powers of two, so that squares and products of squares stay in range.

use glam::DVec3;

/// Unit roundoff of f64: the largest relative error of one operation.
pub(super) const UNIT: f64 = f64::EPSILON / 2.0;

/// 1 + 2^-40: covers all terms of second order and the rounding of the bounds themselves.
pub(super) const SLACK: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;

/// Far above the sum of the underflow errors (at most 2^-1075 each) of one formula, far below
/// what roundings do to lengths above 1e-60 and their squares; large enough that neither it nor its
/// products with u are subnormal, which would be slow.
pub(super) const TINY: f64 = 1e-250;

/// Below this the square of a norm may have lost digits to underflow.
const SMALLEST_SQUARE: f64 = 1e-250;

/// Magnitudes within which nothing needs to be scaled: the fourth powers of lengths are in range.
const UNSCALED: std::ops::Range<f64> = 1e-60..1e60;

/// A relative cubic brought to a magnitude near one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    pub(super) points: [DVec3; 4],
    /// Bound on the distance between this cubic and the exact motion (E).
    pub(super) error: f64,
    /// Upper bound of the control points' norms (M).
    pub(super) size: f64,
    /// Power of two that brings lengths back; 1 for nearly all input.
    factor: f64,
    is_scaled: bool,
}

impl Normal {
    /// Finite control points and a finite `error >= 0`.
    pub(super) fn new(points: &[DVec3; 4], error: f64) -> Self {
        let [a, b, c, d] = points.map(DVec3::abs);
        let magnitude = a.max(b).max(c.max(d)).max_element().max(error);
        if UNSCALED.contains(&magnitude) {
            return Self::scaled(*points, error, 1.0);
        }
        let (down, up) = powers(magnitude);
        // Scaling down loses at most 2^-1075 per component, scaling up nothing.
        Self::scaled(points.map(|p| p * down), error * down + TINY, up)
    }

    fn scaled(points: [DVec3; 4], error: f64, factor: f64) -> Self {
        let size = points
            .iter()
            .fold(0.0_f64, |size, p| size.max(norm_above(*p)));
        Self {
            points,
            error,
            size,
            factor,
            is_scaled: factor < 1.0 || 1.0 < factor,
        }
    }

    /// Bound on the distance between any part computed from this cubic and the exact motion (F).
    pub(super) fn part_error(&self) -> f64 {
        (self.error + 9.0 * UNIT * self.size) * SLACK
    }

    /// A lower bound of a length, in the caller's unit.
    pub(super) fn restore_below(&self, length: f64) -> f64 {
        let restored = length * self.factor;
        if self.is_scaled {
            restored.next_down().max(0.0)
        } else {
            restored
        }
    }

    /// An upper bound of a length, in the caller's unit.
    pub(super) fn restore_above(&self, length: f64) -> f64 {
        let restored = length * self.factor;
        if self.is_scaled {
            restored.next_up()
        } else {
            restored
        }
    }

    /// A length of the caller's in this cubic's unit, rounded down by a trifle.
    pub(super) fn bring_below(&self, length: f64) -> f64 {
        let brought = length / self.factor;
        if self.is_scaled {
            brought.next_down()
        } else {
            brought
        }
    }

    /// A length of the caller's in this cubic's unit, rounded up by a trifle.
    pub(super) fn bring_above(&self, length: f64) -> f64 {
        let brought = length / self.factor;
        if self.is_scaled {
            brought.next_up()
        } else {
            brought
        }
    }
}

/// The power of two that brings `magnitude` into [1, 4), as far as one factor can, and its inverse.
fn powers(magnitude: f64) -> (f64, f64) {
    // Both biased exponents stay within those of normal numbers, 1..=2046; they sum to 2046.
    let exponent = ((magnitude.to_bits() >> 52) & 0x7ff).clamp(1, 2045);
    (
        f64::from_bits((2046 - exponent) << 52),
        f64::from_bits(exponent << 52),
    )
}

/// At least the Euclidean norm; exactly zero for the zero vector.
pub(super) fn norm_above(vector: DVec3) -> f64 {
    let square = vector.dot(vector);
    if square > SMALLEST_SQUARE {
        square.sqrt() * (1.0 + 4.0 * UNIT)
    } else {
        2.0 * vector.abs().max_element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::{Exact, number};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// From the smallest numbers to the largest.
    fn size_of(rng: &mut ChaCha8Rng) -> f64 {
        10f64.powf(rng.random_range(-322.0..300.0))
    }

    fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)))
    }

    #[test]
    fn norms_are_rounded_up() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..5_000 {
            let size = size_of(&mut rng).min(1e150);
            let vector = vector(&mut rng, size);
            assert!(Exact::of(vector).is_within(norm_above(vector)), "{vector}");
        }
    }

    /// What scaling takes from a cubic is in its error, and the error of its parts holds both.
    #[test]
    fn scaled_cubics_are_within_their_error() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for round in 0..5_000 {
            let large = size_of(&mut rng);
            let small = if round % 2 == 0 {
                large
            } else {
                size_of(&mut rng).min(large)
            };
            let points = [large, small, small, small].map(|size| vector(&mut rng, size));
            let error = if round % 3 == 0 { 0.0 } else { small };
            let normal = Normal::new(&points, error);
            let factor = number(normal.factor);
            for (point, given) in normal.points.into_iter().zip(points) {
                let off = Exact::of(point).times(&factor).minus(&Exact::of(given));
                let room = (number(normal.error) * &factor - number(error)) / &factor;
                assert!(
                    off.times(&(number(1.0) / &factor)).is_within_exactly(&room),
                    "{points:?}"
                );
            }
            let rounding = number(9.0 * UNIT) * number(normal.size);
            assert!(number(normal.part_error()) >= number(normal.error) + rounding);
        }
    }

    /// There and back, lengths that are subnormal in one of the units or in both.
    #[test]
    fn lengths_are_rounded_outward() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..5_000 {
            let size = size_of(&mut rng);
            let normal = Normal::new(&[vector(&mut rng, size); 4], 0.0);
            let factor = number(normal.factor);
            let length = 10f64.powf(rng.random_range(-320.0..2.0));
            let given = length.min(1e300 / normal.factor.max(1.0));
            let exact = number(given) * &factor;
            assert!(number(normal.restore_below(given)) <= exact);
            assert!(exact <= number(normal.restore_above(given)));
            let length = size_of(&mut rng).min(1e300 * normal.factor.min(1.0));
            let exact = number(length) / &factor;
            assert!(number(normal.bring_below(length)) <= exact);
            assert!(exact <= number(normal.bring_above(length)));
        }
    }
}
