//! Bodies: what moves, how large it is, and what it is screened against.

use crate::hitbox::Hitbox;
use crate::layers::Layers;
use crate::trajectory::Trajectory;

/// A trajectory with a hitbox around it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Body {
    /// Where it goes.
    pub trajectory: Trajectory,
    /// What it occupies; a point by default.
    pub hitbox: Hitbox,
    /// Which bodies it is screened against; all by default.
    pub layers: Layers,
    /// The user's own name for it; 0 by default. Errors speak of bodies by their tag.
    pub tag: u64,
}

impl Body {
    /// A point that follows `trajectory`, in all layers, with tag 0.
    #[must_use]
    pub fn new(trajectory: Trajectory) -> Self {
        Self {
            trajectory,
            hitbox: Hitbox::POINT,
            layers: Layers::ALL,
            tag: 0,
        }
    }

    /// The same body with this hitbox.
    #[must_use]
    pub fn with_hitbox(mut self, hitbox: Hitbox) -> Self {
        self.hitbox = hitbox;
        self
    }

    /// The same body in these layers.
    #[must_use]
    pub const fn with_layers(mut self, layers: Layers) -> Self {
        self.layers = layers;
        self
    }

    /// The same body with this tag.
    #[must_use]
    pub const fn with_tag(mut self, tag: u64) -> Self {
        self.tag = tag;
        self
    }
}
