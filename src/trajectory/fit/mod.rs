//! Motions of any kind, approximated by cubics with a known error.
//!
//! | file | content |
//! |---|---|
//! | `options` | options of a fit |
//! | `place` | knots, as far apart as a tolerance allows |
//! | `motion` | functions of time |
//! | `velocity` | velocities that are not the derivative of the position |
//! | `fourth_derivative` | distance of a motion from its cubic, by bounds of the fourth derivative |
//! | `polynomials` | polynomials up to degree 7 |
//! | `reduction` | one cubic in place of a part of a polynomial, with the proven remainder |

mod fourth_derivative;
mod motion;
mod options;
mod place;
mod polynomials;
mod reduction;
mod velocity;

pub use options::FitOptions;
pub(super) use place::checked_tolerance;

use super::Trajectory;

/// A trajectory that stands for another motion, with its error: the result of [`Trajectory::fit`],
/// [`Trajectory::fit_polynomials`] and [`Trajectory::simplified`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fit {
    /// The cubics.
    pub trajectory: Trajectory,
    error: f64,
    is_proven: bool,
}

impl Fit {
    /// Returns a trajectory whose distance from another motion provably never exceeds `error` (m).
    pub(in crate::trajectory) const fn proven(trajectory: Trajectory, error: f64) -> Self {
        Self {
            trajectory,
            error,
            is_proven: true,
        }
    }

    /// Returns the error: a bound of the distance (m) between trajectory and motion, from the first to the last knot. It
    /// is proven or estimated: see [`is_proven`](Self::is_proven). It is never above the tolerance.
    ///
    /// For a fit it contains the rounding of
    /// [`Trajectory::position`] and of the cubics. Give it to
    /// [`Body::with_model_error`](crate::Body::with_model_error), and answers cover the motion.
    #[must_use]
    pub const fn error(&self) -> f64 {
        self.error
    }

    /// Returns true if the error is proven, and false if it is estimated from instants examined.
    #[must_use]
    pub const fn is_proven(&self) -> bool {
        self.is_proven
    }

    /// Returns the number of knots of the trajectory.
    #[must_use]
    pub fn knot_count(&self) -> usize {
        self.trajectory.knots().len()
    }
}
