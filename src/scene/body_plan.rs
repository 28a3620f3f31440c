//! Plans: how a body moves and turns.

use super::body::checked_model_error;
use super::{Body, Scene};
use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::orientation::{Orientation, ToldSpin};
use crate::trajectory::Trajectory;

/// The motion of a body from some time on: a trajectory, an orientation where that changes, and a model error where that
/// changes.
///
/// Calls that take a plan take a [`Trajectory`] as well: the body then goes on turning as it does, and keeps its model error.
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
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BodyPlan {
    /// Motion of the body's position.
    pub trajectory: Trajectory,
    /// Rotation of the hitbox; `None` keeps the body's.
    pub orientation: Option<Orientation>,
    /// [Model error](Self::with_model_error), m; `None` keeps the body's.
    pub model_error: Option<f64>,
}

impl BodyPlan {
    /// Returns a plan of both.
    #[must_use]
    pub const fn new(trajectory: Trajectory, orientation: Orientation) -> Self {
        Self {
            trajectory,
            orientation: Some(orientation),
            model_error: None,
        }
    }

    /// Returns the plan with the [model error](Body::with_model_error) (m) that the body has once it follows the plan: as
    /// that of a new fit. A body has one model error: it counts from the clock of the monitor's last tick on, before the
    /// plan begins as well. The greater one of both plans is safe where the old plan is still followed.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Body, BodyPlan, Query, Scene, State, Trajectory};
    ///
    /// let mut scene = Scene::new();
    /// let fly = |y| [-9.0, 9.0].map(|t| State::new(t, DVec3::new(t, y, 0.0), DVec3::X));
    /// let drone = scene.insert(Body::new(Trajectory::from_states(&fly(9.0))?))?;
    /// scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    /// // It passes 3 m beside the other one, or by its fit 2.75 m.
    /// let plan = BodyPlan::from(Trajectory::from_states(&fly(3.0))?);
    /// let query = Query::default().with_margin(2.9);
    /// assert!(scene.what_if(drone, &plan, &query)?.is_empty());
    /// assert_eq!(scene.what_if(drone, &plan.with_model_error(0.25)?, &query)?.len(), 1);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::ModelError`] if it is negative, NaN, infinite or above 1e300.
    pub fn with_model_error(self, metres: f64) -> Result<Self, Error> {
        Ok(Self {
            model_error: Some(checked_model_error(metres)?),
            ..self
        })
    }
}

impl From<Trajectory> for BodyPlan {
    fn from(trajectory: Trajectory) -> Self {
        Self {
            trajectory,
            orientation: None,
            model_error: None,
        }
    }
}

/// A plan that is only looked at: a `&Trajectory` or a `&BodyPlan`, for
/// [`Monitor::what_if`](crate::Monitor::what_if).
#[derive(Clone, Copy, Debug)]
pub struct BodyPlanRef<'p> {
    pub(crate) trajectory: &'p Trajectory,
    pub(crate) orientation: Option<&'p Orientation>,
    model_error: Option<f64>,
}

impl BodyPlanRef<'_> {
    /// Returns the model error of a body that follows the plan, m.
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] with [`Error::ModelError`].
    pub(crate) fn model_error_of(&self, body: &Body) -> Result<f64, Error> {
        let metres = self.model_error.unwrap_or(body.model_error());
        checked_model_error(metres).map_err(|error| error.in_body(body.tag))
    }
}

impl<'p> From<&'p Trajectory> for BodyPlanRef<'p> {
    fn from(trajectory: &'p Trajectory) -> Self {
        Self {
            trajectory,
            orientation: None,
            model_error: None,
        }
    }
}

impl<'p> From<&'p BodyPlan> for BodyPlanRef<'p> {
    fn from(plan: &'p BodyPlan) -> Self {
        Self {
            trajectory: &plan.trajectory,
            orientation: plan.orientation.as_ref(),
            model_error: plan.model_error,
        }
    }
}

impl Scene {
    /// Replaces a body's orientation and returns the old one.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::TurningHalfSpace`].
    pub fn set_orientation(
        &mut self,
        id: BodyId,
        orientation: Orientation,
    ) -> Result<Orientation, Error> {
        let (entry, _) = self.entry_mut(id)?;
        let body = &entry.body;
        let checked = Body::check_turning(&body.hitbox, &orientation, body.tag);
        checked.map_err(|error| error.with_id(id))?;
        Ok(std::mem::replace(&mut entry.body.orientation, orientation))
    }

    /// Replaces the hitbox and the orientation of a body, each if it is given. The caller has checked that the
    /// outcome can turn.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub(crate) fn set_shape(
        &mut self,
        id: BodyId,
        hitbox: Option<Hitbox>,
        orientation: Option<Orientation>,
    ) -> Result<(), Error> {
        let body = &mut self.entry_mut(id)?.0.body;
        if let Some(orientation) = orientation {
            body.orientation = orientation;
        }
        if let Some(hitbox) = hitbox {
            body.hitbox = hitbox;
            self.count_shape(id);
        }
        Ok(())
    }

    /// Lets a body follow a spin from an instant `from` (s) on, and forgets what ends before `since`
    /// (s). Returns true if that changes its orientation.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub(crate) fn follow_spin(
        &mut self,
        id: BodyId,
        spin: &ToldSpin,
        (from, since): (f64, f64),
    ) -> Result<bool, Error> {
        let (entry, _) = self.entry_mut(id)?;
        entry.body.orientation.follow_spin(spin, from, since)
    }
}
