//! The floor below the window's fleet.

use glam::DVec3;
use nearmiss::{Body, BodyId, Error, Hitbox, Trajectory};

/// A half-space at rest: all that is below a height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Floor {
    pub(crate) id: BodyId,
    /// m.
    pub(crate) height: f64,
}

impl Floor {
    /// Returns the body of a floor at a height (m).
    pub(crate) fn body(height: f64) -> Result<Body, Error> {
        let place = Trajectory::at_rest(height * DVec3::Y)?;
        Ok(Body::new(place).with_hitbox(Hitbox::half_space(DVec3::Y)?))
    }

    /// Returns the point of the floor that is nearest to a place, m.
    pub(crate) fn foot(&self, place: DVec3) -> DVec3 {
        DVec3::new(place.x, self.height, place.z)
    }
}
