//! Bodies: trajectory, hitbox, layers and tag.

use crate::error::Error;
use crate::hitbox::{Hitbox, Sphere};
use crate::layers::Layers;
use crate::orientation::Orientation;
use crate::shape::BodyShape;
use crate::trajectory::Trajectory;

/// A trajectory with a hitbox around it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Name chosen by the user; 0 by default. Errors name bodies by their tag.
    pub tag: u64,
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

    /// Returns the spheres of the hitbox at `time` (s), with their centres in the world as offsets
    /// (m), or `None` where the body does not exist: for drawing. None of a half-space, whose plane
    /// goes through the body's position.
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
        BodyShape::new(&self.hitbox, self.orientation.turning())
    }
}
