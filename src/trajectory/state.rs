//! What a user knows of a body at one instant.

use glam::DVec3;

/// Time, position and velocity of a body at one instant (s, m, m/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Seconds, on any clock that all bodies of a scene share. (-0 is taken as 0.)
    pub time: f64,
    /// Metres, in any frame that all bodies of a scene share.
    pub position: DVec3,
    /// Metres per second.
    pub velocity: DVec3,
}

impl State {
    /// A state from its parts (s, m, m/s); validation happens where a trajectory is built from it.
    #[must_use]
    pub const fn new(time: f64, position: DVec3, velocity: DVec3) -> Self {
        Self {
            time,
            position,
            velocity,
        }
    }
}
