//! Polynomials in powers of the variable.

use super::recursion;
use super::roots::{RootList, Roots};
use crate::rounding::normalising_power;

/// A real polynomial of degree at most `N - 1`: the sum of `coefficients[i]` times x to the i.
///
/// The lowest power comes first. Leading coefficients may be zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial<const N: usize> {
    /// The coefficients of 1, x, x², …
    pub coefficients: [f64; N],
}

impl<const N: usize> Polynomial<N> {
    /// Returns the polynomial with these coefficients, lowest power first.
    #[must_use]
    pub const fn new(coefficients: [f64; N]) -> Self {
        Self { coefficients }
    }

    /// Returns the value at `x`, by Horner's rule.
    ///
    /// The error is at most 2(N-1) units of rounding of the sum of the terms' absolute values.
    #[inline]
    #[must_use]
    pub fn evaluate(&self, x: f64) -> f64 {
        self.coefficients
            .iter()
            .rev()
            .fold(0.0, |value, coefficient| value * x + coefficient)
    }

    /// Returns the value and the first derivative at `x`.
    #[inline]
    #[must_use]
    pub fn evaluate_with_derivative(&self, x: f64) -> (f64, f64) {
        let mut value = 0.0;
        let mut derivative = 0.0;
        for coefficient in self.coefficients.iter().rev() {
            derivative = derivative * x + value;
            value = value * x + coefficient;
        }
        (value, derivative)
    }

    /// Returns the derivative, with a last coefficient of zero.
    ///
    /// ```
    /// use nearmiss::internals::polynomial::Polynomial;
    ///
    /// let cubic = Polynomial::new([7.0, 1.0, 0.0, 2.0]);
    /// assert_eq!(cubic.derivative(), Polynomial::new([1.0, 0.0, 6.0, 0.0]));
    /// ```
    #[inline]
    #[must_use]
    pub fn derivative(&self) -> Self {
        let mut coefficients = [0.0; N];
        let mut power = 0.0;
        for (derived, coefficient) in coefficients
            .iter_mut()
            .zip(self.coefficients.iter().skip(1))
        {
            power += 1.0;
            *derived = power * coefficient;
        }
        Self { coefficients }
    }

    /// Returns a bound on the absolute value of all roots (Cauchy's bound), or `None` if the
    /// polynomial has no isolated roots: a constant, or zero.
    ///
    /// The bound is `1 + max |a_i / a_n|` with `a_n` the last coefficient that is not zero, or
    /// `f64::MAX` where that overflows.
    #[must_use]
    pub fn cauchy_bound(&self) -> Option<f64> {
        let degree = self.coefficients.iter().rposition(|&c| c != 0.0)?;
        let (lower, leading) = self.coefficients.split_at(degree);
        let leading = leading.first()?.abs();
        let largest = lower.iter().fold(None, |most: Option<f64>, c| {
            Some(most.map_or(c.abs(), |m| m.max(c.abs())))
        })?;
        // Two roundings of the quotient and the sum, upward.
        let bound = (1.0 + largest / leading) * (1.0 + 4.0 * f64::EPSILON);
        Some(bound.min(f64::MAX))
    }

    /// Returns the real roots in the closed interval from `low` to `high`.
    ///
    /// `tolerance` is the largest error of a well-conditioned root, in the unit of `x`; 0 means
    /// full precision. The [module](super) lists the guarantees. An interval with `low > high` is
    /// empty and has no roots.
    ///
    /// # Panics
    ///
    /// Does not compile for `N` above 7 (degree 6).
    ///
    /// ```
    /// use nearmiss::internals::polynomial::{Polynomial, Roots};
    ///
    /// // (x - 1)² touches zero, and the interval is closed.
    /// let touching = Polynomial::new([1.0, -2.0, 1.0]);
    /// assert_eq!(touching.roots_in(0.0, 1.0, 0.0).isolated(), Some(&[1.0][..]));
    /// let zero = Polynomial::new([0.0; 4]);
    /// assert!(zero.roots_in(0.0, 1.0, 0.0).is_everywhere());
    /// assert_eq!(zero.roots_in(1.0, 0.0, 0.0).isolated(), Some(&[][..]));
    /// ```
    #[inline]
    #[must_use]
    pub fn roots_in(&self, low: f64, high: f64, tolerance: f64) -> Roots {
        const { assert!(N >= 1 && N <= 7, "roots are found up to degree 6") };
        let mut padded = [0.0; 7];
        padded[..N].copy_from_slice(&self.coefficients);
        if low > high {
            return Roots::At(RootList::default());
        }
        let largest = self.largest_coefficient();
        if largest == 0.0 {
            return Roots::Everywhere;
        }
        if low.is_infinite() || high.is_infinite() {
            // No root is farther out.
            let Some(bound) = self.cauchy_bound() else {
                return Roots::At(RootList::default());
            };
            return self.roots_in(low.max(-bound), high.min(bound), tolerance);
        }
        // Away from the ends of the range nothing overflows in the derivatives or squares.
        if !(1e-90..=1e90).contains(&largest) {
            let factor = normalising_power(largest);
            padded = padded.map(|coefficient| coefficient * factor);
        }
        Roots::At(match N {
            1 => RootList::default(),
            2 => recursion::solve::<1>(&padded, low, high, tolerance),
            3 => recursion::solve::<2>(&padded, low, high, tolerance),
            4 => recursion::solve::<3>(&padded, low, high, tolerance),
            5 => recursion::solve::<4>(&padded, low, high, tolerance),
            6 => recursion::solve::<5>(&padded, low, high, tolerance),
            _ => recursion::solve::<6>(&padded, low, high, tolerance),
        })
    }

    /// Returns all real roots: those within [`cauchy_bound`](Self::cauchy_bound).
    ///
    /// Roots beyond `f64::MAX` are not reported.
    #[must_use]
    pub fn real_roots(&self, tolerance: f64) -> Roots {
        if self.largest_coefficient() == 0.0 {
            return Roots::Everywhere;
        }
        match self.cauchy_bound() {
            Some(bound) => self.roots_in(-bound, bound, tolerance),
            None => Roots::At(RootList::default()),
        }
    }

    #[inline]
    fn largest_coefficient(&self) -> f64 {
        self.coefficients
            .iter()
            .fold(0.0, |largest: f64, c| largest.max(c.abs()))
    }
}
