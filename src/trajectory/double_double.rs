//! Sums and products to twice the precision of f64, for converting polynomials to local form.
//!
//! T. J. Dekker, "A floating-point technique for extending the available precision", 1971.
//! Only run when a trajectory is built, never in a query.

use std::ops::{Add, Mul};

/// An unevaluated sum of two f64, the second at most half an ulp of the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// The nearest f64.
    pub(crate) fn rounded(self) -> f64 {
        self.high
    }

    /// `a - b`, exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        Self::sum(a, -b)
    }

    /// `a + b`, exactly (by Knuth).
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let shadow = high - a;
        let low = (a - (high - shadow)) + (b - shadow);
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
        let product = self.high * other.high;
        let rest = self.high.mul_add(other.high, -product);
        Self::renormalised(
            product,
            rest + (self.high * other.low + self.low * other.high),
        )
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
