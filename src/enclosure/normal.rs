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
        (self.error + 9.0 * UNIT * self.size) * SLACK + TINY
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
