//! Options of a fit.

use crate::error::Error;

/// Options of [`Trajectory::fit_with`](crate::Trajectory::fit_with).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitOptions {
    pub(super) fourth_derivative: Option<f64>,
    pub(super) ulps: f64,
    pub(super) max_knots: usize,
}

impl FitOptions {
    /// Number of knots that no fit exceeds by default.
    pub(super) const MAX_KNOTS: usize = 1_000_000;

    /// Returns the options with a bound of the fourth derivative of the position (m/s⁴), in Euclidean norm, at all
    /// times of the window. None by default. The bound makes the error of the fit a proven one.
    ///
    /// The proof takes three facts from the caller. The third derivative is continuous, the velocity is the
    /// derivative of the position, and values are as precise as [`with_ulps`](Self::with_ulps) says.
    #[must_use]
    pub const fn with_fourth_derivative(mut self, bound: f64) -> Self {
        self.fourth_derivative = Some(bound);
        self
    }

    /// Returns the options with the rounding of the motion's values: no position and no velocity is off by more
    /// than so many units of the last place of its length. 4 by default.
    ///
    /// Functions that cancel lose more than that: sin(ωt) is off by up to ωt units.
    #[must_use]
    pub const fn with_ulps(mut self, ulps: f64) -> Self {
        self.ulps = ulps;
        self
    }

    /// Returns the options with the largest number of knots. 1,000,000 by default. A fit that needs more is an
    /// error.
    #[must_use]
    pub const fn with_max_knots(mut self, max_knots: usize) -> Self {
        self.max_knots = max_knots;
        self
    }

    /// Returns an error if an option is not usable.
    pub(super) fn checked(self) -> Result<Self, Error> {
        let fourth_derivative = self.fourth_derivative.unwrap_or(0.0);
        for (option, value) in [
            ("bound of the fourth derivative", fourth_derivative),
            ("number of ulps", self.ulps),
        ] {
            if !(0.0..f64::INFINITY).contains(&value) {
                return Err(Error::FitOption { option, value });
            }
        }
        Ok(self)
    }
}

impl Default for FitOptions {
    /// Returns options without a bound of the fourth derivative, with 4 ulps and 1,000,000 knots.
    fn default() -> Self {
        Self {
            fourth_derivative: None,
            ulps: 4.0,
            max_knots: Self::MAX_KNOTS,
        }
    }
}
