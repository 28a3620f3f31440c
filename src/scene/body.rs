//! Bodies: trajectory, hitbox, layers and tag.

use crate::error::{Error, MAX_MAGNITUDE};
use crate::hitbox::{Hitbox, Sphere};
use crate::layers::Layers;
use crate::orientation::Orientation;
use crate::shape::BodyShape;
use crate::trajectory::{Extension, Trajectory};
use crate::window::Window;

/// A trajectory with a hitbox around it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Body {
    /// Motion of the body.
    pub trajectory: Trajectory,
    /// Space that the body occupies; a point by default.
    pub hitbox: Hitbox,
    /// Rotation of the hitbox over time; fixed by default.
    #[cfg_attr(feature = "serde", serde(default))]
    pub orientation: Orientation,
    /// Masks that select the bodies to screen against; all by default.
    pub layers: Layers,
    /// Number chosen by the user; 0 by default. It need not be unique. Answers and errors give it beside the id; before
    /// the body is in a scene, errors have the tag alone.
    pub tag: u64,
    #[cfg_attr(
        feature = "serde",
        serde(default, deserialize_with = "serial::model_error")
    )]
    pub(super) model_error: f64,
}

impl From<Trajectory> for Body {
    fn from(trajectory: Trajectory) -> Self {
        Self::new(trajectory)
    }
}

impl Body {
    /// Returns a point that follows `trajectory` without turning, in all layers, with tag 0.
    #[must_use]
    pub fn new(trajectory: Trajectory) -> Self {
        Self {
            trajectory,
            hitbox: Hitbox::POINT,
            orientation: Orientation::FIXED,
            layers: Layers::ALL,
            tag: 0,
            model_error: 0.0,
        }
    }

    /// Returns the body with this hitbox.
    #[must_use]
    pub fn with_hitbox(mut self, hitbox: Hitbox) -> Self {
        self.hitbox = hitbox;
        self
    }

    /// Returns the body with this orientation.
    #[must_use]
    pub fn with_orientation(mut self, orientation: Orientation) -> Self {
        self.orientation = orientation;
        self
    }

    /// Returns the body with these layers.
    #[must_use]
    pub const fn with_layers(mut self, layers: Layers) -> Self {
        self.layers = layers;
        self
    }

    /// Returns the body with this tag.
    #[must_use]
    pub const fn with_tag(mut self, tag: u64) -> Self {
        self.tag = tag;
        self
    }

    /// Returns the body with this model error (m): every point of its hitbox is, at all times, at
    /// most so far from where the body's plan has it. 0 by default.
    ///
    /// The numbers of a plan describe a spline. The model error says how far the world may be from
    /// it: the error of a fit, of a simplification, of a prediction. All answers about a pair take
    /// the sum e of both bodies' model errors into account, and report e beside the separation:
    /// see [`ClosestApproach::model_error`](crate::ClosestApproach::model_error).
    ///
    /// - A conflict is a maximal interval in which the splines' separation is at most margin + e.
    ///   Every instant at which the bodies are within the margin in the world lies in one.
    /// - With [`Accuracy::Certified`](crate::Accuracy::Certified), the enclosures of separation and
    ///   times hold for the world, and so does [`resolved`](crate::Certificate::resolved).
    /// - Several conflicts of the world may lie in one that is reported. A conflict of the world
    ///   never reaches from one that is reported into another.
    ///
    /// The plans that the body is given later have the same model error, until
    /// [`Scene::set_model_error`](crate::Scene::set_model_error),
    /// [`Monitor::set_model_error`](crate::Monitor::set_model_error) or a
    /// [plan](crate::BodyPlan::with_model_error) changes it.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Accuracy, Body, Query, Scene, State, Trajectory};
    ///
    /// let mut scene = Scene::new();
    /// let fly = [-9.0, 9.0].map(|t| State::new(t, DVec3::new(t, 3.0, 0.0), DVec3::X));
    /// scene.insert(Body::new(Trajectory::from_states(&fly)?).with_model_error(0.25)?)?;
    /// scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    /// // The splines pass each other 3 m apart, the bodies perhaps 2.75 m.
    /// let query = Query::default().with_margin(2.9).with_accuracy(Accuracy::Certified);
    /// let conflict = scene.screen(&query)?.conflicts[0];
    /// assert_eq!(conflict.closest.separation, 3.0);
    /// assert_eq!(conflict.closest.model_error, 0.25);
    /// // They may come within 2.9 m, but that is not certain.
    /// let proof = conflict.certificate.expect("the query asks for one");
    /// assert!(!proof.resolved && (0.25..0.26).contains(&proof.error));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] with [`Error::ModelError`] if it is negative, NaN, infinite or above 1e300.
    pub fn with_model_error(mut self, metres: f64) -> Result<Self, Error> {
        self.model_error = checked_model_error(metres).map_err(|error| error.in_body(self.tag))?;
        Ok(self)
    }

    /// Returns the [model error](Self::with_model_error), m.
    #[must_use]
    pub const fn model_error(&self) -> f64 {
        self.model_error
    }

    /// Returns the spheres of the hitbox at `time` (s), with their centres in the world as offsets
    /// (m), or `None` where the body does not exist: for drawing. Of a half-space the list is empty: its plane
    /// goes through the body's position. Where the orientation jumps, the later rotation counts.
    #[must_use]
    pub fn spheres_at(&self, time: f64) -> Option<Vec<Sphere>> {
        let position = self.trajectory.position(time)?;
        let rotation = self.orientation.rotation(time);
        let turned = |sphere: &Sphere| Sphere {
            offset: position + rotation * sphere.offset,
            ..*sphere
        };
        Some(self.hitbox.spheres().iter().map(turned).collect())
    }

    /// Returns the pieces that the body follows beyond its knots over a window, if any.
    ///
    /// # Errors
    ///
    /// [`Error::WindowNotClosed`]; [`Error::InBody`] with those of [`Trajectory::extension`].
    pub(crate) fn extension(&self, window: Window) -> Result<Option<Extension>, Error> {
        let Self {
            trajectory, tag, ..
        } = self;
        let is_within = |ends: [f64; 2]| ends[0] < window.start() && window.end() < ends[1];
        let straight = trajectory.straight();
        if !trajectory.goes_beyond() || straight.is_some_and(|(_, ends)| is_within(ends)) {
            return Ok(None);
        }
        let followed = trajectory.domain().intersection(window);
        if followed.is_some_and(|followed| !followed.is_closed()) {
            return Err(Error::WindowNotClosed {
                body: *tag,
                id: None,
            });
        }
        let extension = trajectory.extension(window);
        extension.map_err(|error| error.in_body(*tag))
    }

    /// Returns the instant (s) from which on it does not move or turn: see [`Trajectory::rests_from`].
    pub(crate) fn rests_from(&self) -> f64 {
        if self.orientation.is_fixed() {
            self.trajectory.rests_from()
        } else {
            f64::INFINITY
        }
    }

    /// Checks that the hitbox can turn as the orientation does.
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] with [`Error::TurningHalfSpace`].
    pub(crate) fn check_turning(
        hitbox: &Hitbox,
        orientation: &Orientation,
        tag: u64,
    ) -> Result<(), Error> {
        if hitbox.is_half_space() && !orientation.is_fixed() {
            return Err(Error::TurningHalfSpace.in_body(tag));
        }
        Ok(())
    }

    /// Returns the space that the body occupies around its position.
    #[inline]
    pub(crate) fn shape(&self) -> BodyShape<'_> {
        BodyShape::new(&self.hitbox, self.orientation.turning(), self.model_error)
    }
}

/// Returns a model error (m), if it is one.
///
/// # Errors
///
/// [`Error::ModelError`].
pub(crate) fn checked_model_error(metres: f64) -> Result<f64, Error> {
    if (0.0..=MAX_MAGNITUDE).contains(&metres) {
        // Not -0.
        Ok(metres.abs())
    } else {
        Err(Error::ModelError { metres })
    }
}

#[cfg(feature = "serde")]
mod serial {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer};

    /// Reads a model error, which must be one.
    pub(super) fn model_error<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
        super::checked_model_error(f64::deserialize(source)?).map_err(D::Error::custom)
    }
}
