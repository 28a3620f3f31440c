//! Bodies: trajectory, hitbox, layers and tag.

use crate::hitbox::Hitbox;
use crate::layers::Layers;
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
    /// Masks that select the bodies to screen against; all by default.
    pub layers: Layers,
    /// Name chosen by the user; 0 by default. Errors name bodies by their tag.
    pub tag: u64,
}

impl Body {
    /// Returns a point that follows `trajectory`, in all layers, with tag 0.
    #[must_use]
    pub fn new(trajectory: Trajectory) -> Self {
        Self {
            trajectory,
            hitbox: Hitbox::POINT,
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
}
