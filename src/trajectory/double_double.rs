//! Sums and products to twice the precision of f64, for converting polynomials to local form.
//!
//! T. J. Dekker, "A floating-point technique for extending the available precision", 1971.
//! J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
//! predicates", 1997, for [`Expansion`]. Only run when a trajectory is built, never in a query.

use crate::rounding::{norm, two_sum};
use glam::DVec3;
use std::ops::{Add, Mul};

/// An unevaluated sum of two f64, the second at most half an ulp of the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// Returns the nearest f64.
    pub(crate) fn rounded(self) -> f64 {
        self.high
    }

    /// Returns twice this number, exactly.
    pub(super) fn twice(self) -> Self {
        Self {
            high: 2.0 * self.high,
            low: 2.0 * self.low,
        }
    }

    /// Returns the sum as an f64, with an error of one rounding and 2^-104 of both terms.
    pub(super) fn rounded_sum(self, other: Self) -> f64 {
        let Self { high, low } = Self::sum(self.high, other.high);
        high + (low + (self.low + other.low))
    }

    /// Returns `a - b`, exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        Self::sum(a, -b)
    }

    /// Returns `a b`, exactly unless its last digit underflows.
    pub(super) fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        let low = a.mul_add(b, -high);
        Self { high, low }
    }

    /// Returns the quotient, to 2^-100 of itself.
    pub(crate) fn quotient(self, other: Self) -> Self {
        let high = self.high / other.high;
        let rest = self + (other * Self::from(high)).negated();
        Self::renormalised(high, rest.high / other.high)
    }

    /// Returns this number with the other sign, exactly.
    pub(super) fn negated(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }

    /// Returns the two f64 whose sum this is.
    pub(super) const fn parts(self) -> [f64; 2] {
        [self.high, self.low]
    }

    /// Returns `a + b`, exactly.
    fn sum(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, b);
        Self { high, low }
    }

    fn renormalised(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self {
            high: sum,
            low: low - (sum - high),
        }
    }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self {
            high: value,
            low: 0.0,
        }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.high, other.high);
        let low = Self::sum(self.low, other.low);
        let first = Self::renormalised(high.high, high.low + low.high);
        Self::renormalised(first.high, first.low + low.low)
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let Self { high, low } = Self::product(self.high, other.high);
        Self::renormalised(high, low + (self.high * other.low + self.low * other.high))
    }
}

/// Returns the coefficients of a polynomial around another instant, in increasing order of powers as the given ones.
/// `times_shift` multiplies a term by the time to that instant.
pub(super) fn taylor_shift<T: Clone + Add<Output = T>, const N: usize>(
    mut coefficients: [T; N],
    times_shift: impl Fn(&T) -> T,
) -> [T; N] {
    // Horner's rule, one coefficient less each time: what is left of each pass is one of the shifted.
    for first in 1..N {
        for power in (first..N).rev() {
            let shifted = times_shift(&coefficients[power]);
            coefficients[power - 1] = coefficients[power - 1].clone() + shifted;
        }
    }
    coefficients
}

/// Returns a bound of the sum of the terms' absolute values of a polynomial, the constant first, at all times up to
/// `farthest` (s) from its origin (m).
pub(super) fn size_of_terms(coefficients: &[DVec3], farthest: f64) -> f64 {
    let sizes = coefficients.iter().rev().copied().map(norm);
    sizes.fold(0.0, |sum, size| sum * farthest + size)
}

/// Returns the largest power of the time that a polynomial, the constant first, multiplies its coefficients by, up to
/// `farthest` (s) from its origin, and at least 1: what a product lost by underflow grows by no more.
pub(super) fn largest_power(coefficients: &[DVec3], farthest: f64) -> f64 {
    let farthest = farthest.max(1.0);
    let (mut power, mut largest) = (1.0, 1.0);
    for coefficient in coefficients {
        if *coefficient != DVec3::ZERO {
            largest = power;
        }
        power *= farthest;
    }
    largest
}

/// An exact sum of f64 that do not overlap, by increasing size.
#[derive(Clone, Debug)]
pub(super) struct Expansion(Vec<f64>);

impl Expansion {
    /// Returns the nearest f64, or a neighbour of it where that is close.
    pub(super) fn rounded(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Returns the product with a double-double, exactly unless a last digit underflows.
    pub(super) fn times(&self, factor: DoubleDouble) -> Self {
        let mut product = Self(Vec::new());
        for &part in &self.0 {
            for factor in factor.parts() {
                for term in DoubleDouble::product(part, factor).parts() {
                    product.include(term);
                }
            }
        }
        product
    }

    fn include(&mut self, term: f64) {
        let mut carried = term;
        self.0.retain_mut(|part| {
            let sum = DoubleDouble::sum(carried, *part);
            (carried, *part) = (sum.high, sum.low);
            part.abs() > 0.0
        });
        if carried.abs() > 0.0 {
            self.0.push(carried);
        }
    }
}

impl From<f64> for Expansion {
    fn from(value: f64) -> Self {
        Self(vec![value])
    }
}

impl From<DoubleDouble> for Expansion {
    fn from(value: DoubleDouble) -> Self {
        Self::from(value.low) + Self::from(value.high)
    }
}

impl Add for Expansion {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        other.0.into_iter().for_each(|term| self.include(term));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::DoubleDouble;

    #[test]
    fn keeps_what_f64_loses() {
        let tiny = 2f64.powi(-70);
        let sum = DoubleDouble::from(1.0) + DoubleDouble::from(tiny);
        assert!((sum + DoubleDouble::from(-1.0)).rounded().to_bits() == tiny.to_bits());
        // (1 + 2^-40)² - 1 - 2^-39 = 2^-80, far below the precision of f64.
        let near_one = DoubleDouble::from(1.0 + 2f64.powi(-40));
        let square = near_one * near_one;
        let rest = square + DoubleDouble::from(-1.0) + DoubleDouble::from(-2f64.powi(-39));
        assert!(rest.rounded().to_bits() == 2f64.powi(-80).to_bits());
    }
}
