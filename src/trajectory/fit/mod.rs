//! A trajectory that stands for another motion, with its error.

use super::Trajectory;

/// A trajectory that stands for another motion, and how far it may be from that.
///
/// Give the error to [`Body::with_model_error`](crate::Body::with_model_error), and a screening misses no
/// encounter of the motion that the trajectory stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    trajectory: Trajectory,
    error: f64,
    is_proven: bool,
}

impl Fit {
    /// Returns a trajectory whose distance from the other motion is proven to be at most `error` (m).
    pub(super) const fn proven(trajectory: Trajectory, error: f64) -> Self {
        Self {
            trajectory,
            error,
            is_proven: true,
        }
    }

    /// Returns the trajectory.
    #[must_use]
    pub const fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// Returns the trajectory, and drops the error.
    #[must_use]
    pub fn into_trajectory(self) -> Trajectory {
        self.trajectory
    }

    /// Returns the largest distance between the trajectory and the other motion, at one time, m.
    #[must_use]
    pub const fn error(&self) -> f64 {
        self.error
    }

    /// Returns true if the error is a proven bound.
    #[must_use]
    pub const fn is_proven(&self) -> bool {
        self.is_proven
    }
}
