//! A cubic in place of a part of a polynomial of degree 7, with a proven bound of the remainder.

use super::place::PieceError;
use crate::rounding::{UNDERFLOW, UNIT_ROUNDOFF, norm};
use crate::trajectory::Segment;
use crate::trajectory::double_double::{DoubleDouble, largest_power, size_of_terms, taylor_shift};
use glam::DVec3;

/// Number of coefficients of a polynomial of degree 7.
pub(super) const COEFFICIENTS: usize = 8;

/// Number of equal parts of a piece in which its remainder is bounded.
const PARTS: u32 = 8;

/// Error of all double-double arithmetic, relative to the sum of the terms: each chain has fewer than 100 operations,
/// with 2^-102 each, and no factor exceeds 10.
const DOUBLE_DOUBLE: f64 = 1.0 / (1u128 << 90) as f64;

/// A polynomial of degree 7 whose variable begins at `origin` (s). Coefficients in increasing order of powers.
pub(super) struct PositionPolynomial {
    coefficients: [DVec3; COEFFICIENTS],
    origin: f64,
}

impl PositionPolynomial {
    pub(super) const fn new(coefficients: [DVec3; COEFFICIENTS], origin: f64) -> Self {
        Self {
            coefficients,
            origin,
        }
    }

    /// Returns the cubic that agrees with the polynomial in position and velocity at both ends of a part (s), and its
    /// error. It has the coefficients of t³, t², t, 1, with the time since the start of the part (m, s).
    ///
    /// In s = (t - start) / duration, the powers from the fourth on are
    /// s^k = (k-2) s³ - (k-3) s² + s² (1-s)² Q(s), with Q = 1, s + 2, s² + 2s + 3, s³ + 2s² + 3s + 4.
    /// So the remainder is s² (1-s)² times a cubic.
    pub(super) fn reduced(
        &self,
        [start, end]: [f64; 2],
        tolerance: f64,
    ) -> ([DVec3; 4], PieceError) {
        let duration = DoubleDouble::difference(end, start);
        let shift = DoubleDouble::difference(start, self.origin);
        let mut cubic = [DVec3::ZERO; 4];
        let mut high = [DVec3::ZERO; 4];
        for axis in 0..3 {
            let given = self.coefficients.map(|term| DoubleDouble::from(term[axis]));
            let [constant, linear, quadratic, third, from_fourth @ ..] =
                taylor_shift(given, |&term| term * shift);
            let square = duration * duration;
            // The sum of weight c_k duration^(k-4); weights grow by 1 from the first.
            let sum = |first: f64| {
                let weighted = from_fourth.into_iter().zip([0.0, 1.0, 2.0, 3.0]).rev();
                weighted.fold(DoubleDouble::from(0.0), |sum, (coefficient, more)| {
                    DoubleDouble::from(first + more) * coefficient + duration * sum
                })
            };
            let powers = [
                third + duration * sum(2.0),
                quadratic + (square * sum(1.0)).negated(),
                linear,
                constant,
            ];
            let mut factor = square * square;
            for (coefficient, high) in from_fourth.into_iter().zip(&mut high) {
                // A power that overflows has no meaning where it has no coefficient.
                if coefficient.rounded().abs() > 0.0 {
                    high[axis] = (coefficient * factor).rounded();
                }
                factor = factor * duration;
            }
            for (power, cubic) in powers.into_iter().zip(&mut cubic) {
                cubic[axis] = power.rounded();
            }
        }
        let duration = duration.rounded();
        let farthest = (start - self.origin).abs() + duration;
        let [third, second, first, constant] = cubic.map(norm);
        let extent = duration * (first + duration * (second + duration * third));
        // The coefficients are rounded, then the points of the segment, then what is returned of it.
        let rounding = UNIT_ROUNDOFF * (3.0 * constant + 16.0 * extent)
            + Segment::EVALUATION * extent
            + DOUBLE_DOUBLE * size_of_terms(&self.coefficients, farthest)
            + UNDERFLOW * 64.0 * largest_power(&self.coefficients, farthest);
        let error = PieceError::of(remainder(high), rounding, tolerance);
        (cubic, error)
    }
}

/// Returns a bound of the remainder by the coefficients of s⁴ to s⁷ (m).
fn remainder([c4, c5, c6, c7]: [DVec3; 4]) -> f64 {
    let quotient = [
        c4 + 2.0 * c5 + 3.0 * c6 + 4.0 * c7,
        c5 + 2.0 * c6 + 3.0 * c7,
        c6 + 2.0 * c7,
        c7,
    ];
    let size: f64 = [c4, c5, c6, c7].into_iter().map(norm).sum();
    let step = 1.0 / f64::from(PARTS);
    let parts = (0..PARTS).map(|part| {
        let (from, to) = (f64::from(part) * step, f64::from(part + 1) * step);
        // The weight s² (1-s)² is largest in the middle.
        let nearest = if part < PARTS / 2 { to } else { from };
        let weight = (nearest * (1.0 - nearest)).powi(2);
        weight * largest_of_cubic(quotient, from, step)
    });
    parts.fold(0.0, f64::max) + 64.0 * UNIT_ROUNDOFF * size
}

/// Returns a bound of a cubic over a part of its domain: the norm of its largest control point.
fn largest_of_cubic([q0, q1, q2, q3]: [DVec3; 4], from: f64, step: f64) -> f64 {
    let constant = q0 + from * (q1 + from * (q2 + from * q3));
    let linear = step * (q1 + from * (2.0 * q2 + from * 3.0 * q3));
    let quadratic = step * step * (q2 + from * 3.0 * q3);
    let cubic = step * step * step * q3;
    let points = [
        constant,
        constant + linear / 3.0,
        constant + (2.0 * linear + quadratic) / 3.0,
        constant + linear + quadratic + cubic,
    ];
    points.into_iter().map(norm).fold(0.0, f64::max)
}
