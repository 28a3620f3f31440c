//! The two floating-point types the kernels are written for.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`, as the kernels need them: arithmetic, comparison and square roots. All are
/// correctly rounded, so that a lane of a vector computes the same bits as a scalar. No other type can implement this
/// trait.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + sealed::Sealed
    + 'static
{
    /// Unit of rounding: half the distance from 1 to the next number.
    #[doc(hidden)]
    const ROUNDING: Self;

    /// Upper bound of the underflow in a sum of some hundred products.
    ///
    /// Large enough not to underflow when multiplied by a rounding: a subnormal result costs
    /// a hundred times an ordinary one.
    #[doc(hidden)]
    const UNDERFLOW: Self;

    /// Squares up to this size do not overflow in sums of some hundred products.
    #[doc(hidden)]
    const LARGE: Self;

    /// Limit as `LARGE`, for squares to be squared again or used in proofs, in f32.
    #[doc(hidden)]
    const MAX_SQUARE: f32;

    /// A step of Halley's method up to this size leaves an error of a few units of rounding, also where
    /// the slope's second derivative vanishes: less than the cube root of the rounding.
    #[doc(hidden)]
    const SETTLED: Self;

    /// True for `f32`.
    #[doc(hidden)]
    const IS_SINGLE: bool;

    /// Steps of Householder's method in `f32` that bring most samples to `SETTLED` of a minimum.
    #[doc(hidden)]
    const STEPS: u32;

    /// Returns the nearest number of this type.
    #[must_use]
    fn from_f64(value: f64) -> Self;

    /// Returns the greatest number of this type that is not above `value`.
    #[doc(hidden)]
    #[must_use]
    fn not_above(value: f64) -> Self;

    /// Returns the number as `f64`, exactly.
    #[must_use]
    fn to_f64(self) -> f64;

    /// Returns the nearest `f32`.
    #[must_use]
    fn to_f32(self) -> f32;

    /// Returns the absolute value.
    #[must_use]
    fn abs(self) -> Self;

    /// Returns the square root.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Returns the absolute value with the sign of another number.
    #[doc(hidden)]
    #[must_use]
    fn with_sign_of(self, other: Self) -> Self;

    /// Returns the smaller number; `other` if either is NaN.
    #[doc(hidden)]
    #[inline(always)]
    #[must_use]
    fn min_or_other(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// Returns the larger number; `other` if either is NaN.
    #[doc(hidden)]
    #[inline(always)]
    #[must_use]
    fn max_or_other(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
}

/// Returns the least of some numbers, without those that are NaN.
#[inline(always)]
pub(crate) fn least_of<const N: usize>(numbers: [f64; N]) -> f64 {
    let mut least = f64::INFINITY;
    for number in numbers {
        least = number.min_or_other(least);
    }
    least
}

macro_rules! implement_real {
    ($float:ident, $steps:expr, $settled:expr, $underflow:expr, $most:expr) => {
        #[allow(
            clippy::cast_possible_truncation,
            reason = "rounding to the nearest f32 is what is wanted"
        )]
        impl Real for $float {
            const ROUNDING: Self = 0.5 * $float::EPSILON;
            const SETTLED: Self = $settled;
            const IS_SINGLE: bool = $float::MANTISSA_DIGITS == f32::MANTISSA_DIGITS;
            const STEPS: u32 = $steps;
            const LARGE: Self = $float::MAX / 1024.0;
            const MAX_SQUARE: f32 = $most;
            const UNDERFLOW: Self = $underflow;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            #[inline]
            fn not_above(value: f64) -> Self {
                let nearest = Self::from_f64(value);
                if nearest.to_f64() > value {
                    nearest.next_down()
                } else {
                    nearest
                }
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn to_f32(self) -> f32 {
                self as f32
            }

            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }

            #[inline(always)]
            fn with_sign_of(self, other: Self) -> Self {
                self.copysign(other)
            }
        }
    };
}

implement_real!(f32, 1, 2e-3, 1e-28, 8e18);
implement_real!(f64, 2, 1e-6, 1e-270, f32::MAX / 1024.0);

#[cfg(test)]
mod tests {
    use super::Real;

    #[test]
    fn thresholds_are_rounded_down() {
        for numerator in 1..200 {
            let value = f64::from(numerator) / 7.0;
            for value in [value, -value] {
                assert!(f32::not_above(value).to_f64() <= value, "{value}");
                assert!(f64::not_above(value).to_bits() == value.to_bits());
            }
        }
    }
}
