//! The distance of a motion from its cubic, by bounds of the motion's fourth derivative.

use crate::error::Error;
use crate::window::Window;
use std::fmt;

/// Number of equal parts of a piece whose bounds are asked for.
const PARTS: usize = 8;

/// Share of each part in the distance from the cubic, for a piece and a fourth derivative of 1. They are rounded up.
///
/// A motion differs from its cubic Hermite interpolant over 0..1 at t by the integral of K(t, s) f''''(s) over s,
/// with Peano's kernel K(t, s) = (1-s)² t² ((3-2t) s - t) / 6 >= 0 for t <= s, and K(1-t, 1-s) otherwise. Its maximum
/// over t is 2/3 s³ (1-s)² / (2s+1)² for s >= 1/2. The shares are the integrals of that.
const SHARES: [f64; PARTS] = [
    4.085_005_7e-5,
    2.298_413_5e-4,
    4.653_172_4e-4,
    6.217_889_6e-4,
    6.217_889_6e-4,
    4.653_172_4e-4,
    2.298_413_5e-4,
    4.085_005_7e-5,
];

/// A bound of the Euclidean norm of a motion's fourth derivative (m/s⁴).
#[derive(Clone, Copy)]
pub(super) enum FourthDerivative<'a> {
    /// One bound for all times.
    Constant(f64),
    /// A function of a window, with a bound for all of its times.
    Over(&'a dyn Fn(Window) -> f64),
}

impl fmt::Debug for FourthDerivative<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(bound) => write!(f, "{bound:?}"),
            Self::Over(_) => write!(f, "by window"),
        }
    }
}

impl FourthDerivative<'_> {
    /// Returns a bound of the distance of a motion from its cubic between two instants, without rounding (m).
    ///
    /// # Errors
    ///
    /// [`Error::FitOption`] if a bound is negative or NaN.
    pub(super) fn remainder(&self, from: f64, to: f64) -> Result<f64, Error> {
        let square = (to - from).powi(2);
        // One factor after the other: the square of a long duration may leave the range of f64.
        let over_piece = |bound: f64| {
            if bound > 0.0 {
                bound * square * square
            } else {
                // A bound of 0 stands for any duration.
                0.0
            }
        };
        let bound = self.over(from, to)?;
        let whole = over_piece(bound / 384.0);
        let Self::Over(_) = self else {
            return Ok(whole);
        };
        // If the fourth derivative is large in one part only, the parts together say more.
        let rounding = 4.0 * f64::EPSILON * from.abs().max(to.abs());
        let step = (to - from) / PARTS as f64;
        let mut mean = 0.0;
        for (part, share) in SHARES.into_iter().enumerate() {
            let start = from + step * part as f64 - rounding;
            let end = from + step * (part + 1) as f64 + rounding;
            mean += share * self.over(start.max(from), end.min(to))?;
        }
        Ok(whole.min(over_piece(mean)))
    }

    /// Returns the bound as it was given for the times of a window (m/s⁴).
    pub(super) fn within(&self, window: Window) -> f64 {
        match self {
            Self::Constant(bound) => *bound,
            Self::Over(bound) => bound(window),
        }
    }

    /// Returns the bound for a part of the time (m/s⁴).
    fn over(&self, from: f64, to: f64) -> Result<f64, Error> {
        let value = self.within(Window::new(from, to)?);
        if value > 0.0 {
            // A larger bound holds as well, and no fraction of it underflows.
            Ok(value.max(1e-290))
        } else if value >= 0.0 {
            Ok(0.0)
        } else {
            let option = "bound of the fourth derivative";
            Err(Error::FitOption { option, value })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{FourthDerivative, SHARES};

    /// Returns Peano's kernel of cubic Hermite interpolation, from its definition.
    fn kernel(t: f64, s: f64) -> f64 {
        let power = if t > s { (t - s).powi(3) / 6.0 } else { 0.0 };
        let at_end = (1.0 - s).powi(3) / 6.0;
        let slope = (1.0 - s).powi(2) / 2.0;
        power - at_end * t * t * (3.0 - 2.0 * t) - slope * t * t * (t - 1.0)
    }

    #[test]
    fn shares_are_the_integrals_of_the_largest_kernel() {
        const STEPS: u32 = 400;
        for (part, share) in SHARES.into_iter().enumerate() {
            let mut integral = 0.0;
            for step in 0..STEPS {
                let s = (part as f64 + (f64::from(step) + 0.5) / f64::from(STEPS)) / 8.0;
                let values = (0..=1000).map(|t| kernel(f64::from(t) / 1000.0, s));
                integral += values.fold(0.0, f64::max) / f64::from(STEPS) / 8.0;
            }
            // The midpoint rule, and the largest of 1001 values.
            assert!(
                integral <= share * (1.0 + 1e-6),
                "{part}: {integral} {share}"
            );
            assert!(
                integral > share * (1.0 - 1e-4),
                "{part}: {integral} {share}"
            );
        }
    }

    #[test]
    fn a_bound_that_is_the_same_everywhere_is_worth_a_constant() {
        let constant = FourthDerivative::Constant(3.0).remainder(-2.0, 5.0);
        let by_window = FourthDerivative::Over(&|_| 3.0).remainder(-2.0, 5.0);
        assert_eq!(constant, by_window);
        assert_eq!(constant, Ok(3.0 / 384.0 * 49.0 * 49.0));
    }
}
