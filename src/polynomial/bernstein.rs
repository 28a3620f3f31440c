//! Polynomials in Bernstein form over the unit interval.

use super::Polynomial;

/// A polynomial of degree at most `N - 1` over 0..=1, in Bernstein form.
///
/// The coefficients are the heights of the control polygon at 0, 1/(N-1), …, 1: the polynomial
/// starts at the first, ends at the last, and stays between the least and the largest (G. Farin,
/// "Curves and Surfaces for CAGD", chapter 5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bernstein<const N: usize> {
    /// The control heights, from the one at 0 to the one at 1.
    pub coefficients: [f64; N],
}

impl<const N: usize> Bernstein<N> {
    /// Returns the polynomial with these control heights.
    #[must_use]
    pub const fn new(coefficients: [f64; N]) -> Self {
        const { assert!(N >= 1, "a polynomial has at least one coefficient") };
        Self { coefficients }
    }

    /// Returns the value at `x`, by de Casteljau's algorithm.
    ///
    /// For `x` in 0..=1 only averages are formed, so the error is a few units of rounding of the
    /// largest coefficient.
    #[inline]
    #[must_use]
    pub fn evaluate(&self, x: f64) -> f64 {
        let mut heights = self.coefficients;
        for level in 1..N {
            for i in 0..N - level {
                heights[i] = (1.0 - x) * heights[i] + x * heights[i + 1];
            }
        }
        heights[0]
    }

    /// Returns the least and the largest coefficient: on 0..=1 the polynomial stays between them.
    ///
    /// Exact for the given coefficients. The ends of the range are attained if they are the first
    /// or the last coefficient.
    #[inline]
    #[must_use]
    pub fn bounds(&self) -> (f64, f64) {
        let mut low = self.coefficients[0];
        let mut high = low;
        for &height in &self.coefficients {
            low = if height < low { height } else { low };
            high = if height > high { height } else { high };
        }
        (low, high)
    }

    /// Returns the halves over 0..=1/2 and 1/2..=1, each over its own unit interval.
    #[inline]
    #[must_use]
    pub fn halves(&self) -> (Self, Self) {
        let mut left = self.coefficients;
        let mut right = self.coefficients;
        for (level, end) in left.iter_mut().enumerate().skip(1) {
            // After this level right[i] is the average over the original i ..= i + level.
            for i in 0..N - level {
                right[i] = 0.5 * right[i] + 0.5 * right[i + 1];
            }
            *end = right[0];
        }
        (Self::new(left), Self::new(right))
    }

    /// Returns the polynomial in powers of the variable.
    ///
    /// Forward differences cancel: the coefficient of x to the j has an error of up to 2^j ·
    /// binomial(N-1, j) units of rounding of the largest height. Away from 0 prefer
    /// [`evaluate`](Self::evaluate).
    #[inline]
    #[must_use]
    pub fn to_power(&self) -> Polynomial<N> {
        let mut differences = self.coefficients;
        for level in 1..N {
            for i in (level..N).rev() {
                differences[i] -= differences[i - 1];
            }
        }
        // binomial(n, j) from binomial(n, j - 1); all of them are exact for N up to 50.
        let (mut binomial, mut power, mut remaining) = (1.0, 0.0, (N - 1) as f64);
        for coefficient in &mut differences {
            *coefficient *= binomial;
            power += 1.0;
            binomial = binomial * remaining / power;
            remaining -= 1.0;
        }
        Polynomial::new(differences)
    }
}

impl<const N: usize> From<Bernstein<N>> for Polynomial<N> {
    fn from(form: Bernstein<N>) -> Self {
        form.to_power()
    }
}
