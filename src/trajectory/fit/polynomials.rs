//! Polynomials up to degree 7, approximated by cubics.

use super::Fit;
use super::options::FitOptions;
use super::place::{checked_tolerance, place_knots};
use super::reduction::{COEFFICIENTS, PositionPolynomial};
use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::trajectory::build::{check_vector, checked_knots};
use crate::trajectory::double_double::size_of_terms;
use crate::trajectory::{TimeBase, Trajectory};
use glam::DVec3;

impl Trajectory {
    /// Approximates polynomials of degree up to 7, one between each two consecutive knots (s), by cubics that differ
    /// from them by at most `tolerance` (m): plans of minimum jerk, minimum snap, and the like. The error is proven.
    ///
    /// Each polynomial is given by 1 to 8 coefficients (m, s), the highest power first, as in
    /// [`from_coefficients`](Self::from_coefficients). Its cubics agree with it in position and velocity where they
    /// meet, to rounding. The knots stay knots; more of them lie between, where the tolerance asks for them. The
    /// difference from a cubic is itself a polynomial, and the proof bounds it by its control points.
    ///
    /// Consecutive polynomials may be discontinuous. Coefficients over absolute time are exact numbers in the proof;
    /// as f64, they may describe the intended motion badly far from 0 s. Prefer local time.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{TimeBase, Trajectory};
    ///
    /// // From rest to rest over 10 m in 2 s, with the least jerk: 10 (6 s⁵ - 15 s⁴ + 10 s³), s = t / 2 s.
    /// let move_by_10 = [1.875, -9.375, 12.5, 0.0, 0.0, 0.0].map(|c| c * DVec3::X);
    /// let fit =
    ///     Trajectory::fit_polynomials(&[0.0, 2.0], &[move_by_10], TimeBase::SegmentLocal, 0.001)?;
    /// assert!(fit.is_proven() && fit.error() <= 0.001);
    /// assert!(fit.knot_count() < 15);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::FitTolerance`]; [`Error::SegmentCount`], [`Error::TooFewStates`]; [`Error::TimeNotIncreasing`],
    /// [`Error::NotFinite`] and [`Error::OutOfRange`] with the value and the knot (of a polynomial, the one at which
    /// it begins); [`Error::FitUnreachable`] where the tolerance is below the rounding; [`Error::FitKnots`] if more
    /// than a million knots have to be added.
    #[doc(alias = "minimum snap")]
    #[doc(alias = "minimum jerk")]
    #[doc(alias = "quintic")]
    pub fn fit_polynomials<const N: usize>(
        knots: &[f64],
        coefficients: &[[DVec3; N]],
        base: TimeBase,
        tolerance: f64,
    ) -> Result<Fit, Error> {
        const { assert!(N >= 1 && N <= COEFFICIENTS, "degree up to 7") }
        let tolerance = checked_tolerance(tolerance)?;
        let knots = checked_knots(knots, coefficients.len())?;
        let (mut times, mut cubics) = (Vec::from(&knots[..1]), Vec::new());
        let mut error = 0.0_f64;
        for (knot, given) in coefficients.iter().enumerate() {
            let ends = [knots[knot], knots[knot + 1]];
            let polynomial = checked_polynomial(given, base, ends, knot)?;
            let added = times.len() - (knot + 1);
            let max_knots = (FitOptions::MAX_KNOTS + 2).saturating_sub(added);
            let error_of = |from, to| Ok(polynomial.reduced([from, to], tolerance).1);
            let placed = place_knots(ends, tolerance, max_knots, error_of);
            let placed = placed.map_err(|mut error| {
                // The knots between all that are given count.
                if let Error::FitKnots { limit, .. } = &mut error {
                    *limit = FitOptions::MAX_KNOTS;
                }
                error
            })?;
            error = error.max(placed.error);
            for pair in placed.knots.windows(2) {
                cubics.push(polynomial.reduced([pair[0], pair[1]], tolerance).0);
                times.push(pair[1]);
            }
        }
        let trajectory = Self::from_coefficients(&times, &cubics, TimeBase::SegmentLocal)?;
        Ok(Fit::proven(trajectory, error))
    }
}

/// Returns the polynomial between two knots, the first one number `knot`.
///
/// # Errors
///
/// [`Error::NotFinite`], [`Error::OutOfRange`].
fn checked_polynomial(
    given: &[DVec3],
    base: TimeBase,
    [start, end]: [f64; 2],
    knot: usize,
) -> Result<PositionPolynomial, Error> {
    let mut coefficients = [DVec3::ZERO; COEFFICIENTS];
    for (power, (&from, to)) in given.iter().rev().zip(&mut coefficients).enumerate() {
        check_vector(knot, |axis| Quantity::Coefficient { power, axis }, from)?;
        *to = from;
    }
    let origin = match base {
        TimeBase::Absolute => 0.0,
        TimeBase::SegmentLocal => start,
    };
    let value = size_of_terms(&coefficients, (start - origin).abs() + (end - start));
    if value.is_nan() || value > MAX_MAGNITUDE {
        return Err(Error::OutOfRange {
            knot,
            quantity: Quantity::Distance,
            value,
        });
    }
    Ok(PositionPolynomial::new(coefficients, origin))
}
