//! Plans: how a body moves and turns.

use crate::orientation::Orientation;
use crate::trajectory::Trajectory;

/// The motion of a body from some time on: a trajectory, and an orientation where that changes.
///
/// Calls that take a plan take a [`Trajectory`] as well: the body then goes on turning as it does.
///
/// ```
/// use nearmiss::glam::{DQuat, DVec3};
/// use nearmiss::{Orientation, BodyPlan, Trajectory};
///
/// let rest = Trajectory::at_rest(DVec3::ZERO)?;
/// assert_eq!(BodyPlan::from(rest.clone()).orientation, None);
/// let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z)?;
/// let both = BodyPlan::new(rest, spin.clone());
/// assert_eq!(both.orientation, Some(spin));
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyPlan {
    /// Motion of the body's position.
    pub trajectory: Trajectory,
    /// Rotation of the hitbox; `None` keeps the body's.
    pub orientation: Option<Orientation>,
}

impl BodyPlan {
    /// Returns a plan of both.
    #[must_use]
    pub const fn new(trajectory: Trajectory, orientation: Orientation) -> Self {
        Self {
            trajectory,
            orientation: Some(orientation),
        }
    }
}

impl From<Trajectory> for BodyPlan {
    fn from(trajectory: Trajectory) -> Self {
        Self {
            trajectory,
            orientation: None,
        }
    }
}

impl From<&Trajectory> for BodyPlan {
    fn from(trajectory: &Trajectory) -> Self {
        Self::from(trajectory.clone())
    }
}

impl From<&Self> for BodyPlan {
    fn from(plan: &Self) -> Self {
        plan.clone()
    }
}
