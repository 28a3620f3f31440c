//! Options of a fit.

use super::fourth_derivative::FourthDerivative;
use crate::error::Error;
use crate::window::Window;

/// Options of [`Trajectory::fit_with`](crate::Trajectory::fit_with).
#[derive(Clone, Copy, Debug)]
pub struct FitOptions<'a> {
    pub(super) fourth_derivative: Option<FourthDerivative<'a>>,
    pub(super) ulps: f64,
    pub(super) max_knots: usize,
}

impl<'a> FitOptions<'a> {
    /// Number of knots that no fit exceeds by default.
    pub(super) const MAX_KNOTS: usize = 1_000_000;

    /// Returns the options with a bound of the fourth derivative of the position (m/s⁴), in Euclidean norm, at all
    /// times of the window. None by default. The bound makes the error of the fit a proven one.
    ///
    /// The proof takes three facts from the caller. The third derivative is continuous, the velocity is the
    /// derivative of the position, and values are as precise as [`with_ulps`](Self::with_ulps) says.
    #[must_use]
    pub const fn with_fourth_derivative(mut self, bound: f64) -> Self {
        self.fourth_derivative = Some(FourthDerivative::Constant(bound));
        self
    }

    /// Returns the options with a bound of the fourth derivative for any window: `bound` returns one (m/s⁴, in
    /// Euclidean norm) that holds at all times of the window that it is given. In place of
    /// [`with_fourth_derivative`](Self::with_fourth_derivative), with the same three facts taken from the caller.
    ///
    /// Knots are then as close as the motion needs them where they are, as in a path with one sharp bend. The bound
    /// of a part of a window should be no larger than that of the window. Infinity stands for no bound: the fit then
    /// asks about shorter windows.
    ///
    /// ```
    /// use nearmiss::{FitOptions, Trajectory, Window};
    ///
    /// // A glider sinks by exp(-t) metres: the fourth derivative is largest where a window begins.
    /// let motion = |time: f64| ([time, 0.0, (-time).exp()], [1.0, 0.0, -(-time).exp()]);
    /// let bound = |window: Window| (-window.start()).exp();
    /// let window = Window::new(0.0, 20.0)?;
    /// let fit = |options| Trajectory::fit_with(motion, window, 1e-6, &options);
    /// let adapted = fit(FitOptions::default().with_fourth_derivative_over(&bound))?;
    /// let even = fit(FitOptions::default().with_fourth_derivative(1.0))?;
    /// assert!(adapted.is_proven() && adapted.error() <= 1e-6);
    /// assert!(adapted.knot_count() < 50 && even.knot_count() > 140);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    #[must_use]
    pub const fn with_fourth_derivative_over(mut self, bound: &'a dyn Fn(Window) -> f64) -> Self {
        self.fourth_derivative = Some(FourthDerivative::Over(bound));
        self
    }

    /// Returns the options with the rounding of the motion's values: no position and no velocity is off by more
    /// than so many units of the last place of its length. 4 by default.
    ///
    /// Functions that cancel lose more than that: sin(ωt) is off by up to ωt units. With fewer units smaller tolerances
    /// can be reached: those of an estimated error down to 2.5 times (`ulps` + 1/2) units.
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

    /// Returns the bound of the fourth derivative over a window, m/s⁴, if one is given.
    #[must_use]
    pub fn fourth_derivative(&self, window: Window) -> Option<f64> {
        self.fourth_derivative.map(|bound| bound.within(window))
    }

    /// Returns the rounding of the motion's values, in units of the last place of their length.
    #[must_use]
    pub const fn ulps(&self) -> f64 {
        self.ulps
    }

    /// Returns the largest number of knots.
    #[must_use]
    pub const fn max_knots(&self) -> usize {
        self.max_knots
    }

    /// Returns an error if an option is not usable.
    pub(super) fn checked(self) -> Result<Self, Error> {
        let fourth_derivative = match self.fourth_derivative {
            Some(FourthDerivative::Constant(bound)) => bound,
            Some(FourthDerivative::Over(_)) | None => 0.0,
        };
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

impl Default for FitOptions<'_> {
    /// Returns options without a bound of the fourth derivative, with 4 ulps and 1,000,000 knots.
    fn default() -> Self {
        Self {
            fourth_derivative: None,
            ulps: 4.0,
            max_knots: Self::MAX_KNOTS,
        }
    }
}
