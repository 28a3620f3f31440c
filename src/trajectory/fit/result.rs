//! A trajectory in place of a motion, and its error.

use crate::trajectory::Trajectory;

/// A trajectory that stands for another motion, with the error of doing so: the result of
/// [`Trajectory::fit`] and [`Trajectory::fit_polynomials`].
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
    pub(crate) const fn proven(trajectory: Trajectory, error: f64) -> Self {
        Self {
            trajectory,
            error,
            is_proven: true,
        }
    }

    /// Returns a trajectory whose distance from another motion is estimated (m).
    pub(super) const fn estimated(trajectory: Trajectory, error: f64) -> Self {
        Self {
            trajectory,
            error,
            is_proven: false,
        }
    }

    /// Returns the distance (m) that the trajectory keeps from the motion, at all times between its first and its
    /// last knot. The distance is never above the tolerance.
    ///
    /// The error contains the rounding of [`Trajectory::position`] and of the cubics. It is proven or estimated:
    /// see [`is_proven`](Self::is_proven). Give it to
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
