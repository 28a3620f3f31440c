//! States: the user's knowledge of a body at one instant.

use glam::DVec3;

/// Time, position and velocity of a body at one instant (s, m, m/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct State {
    /// Time, s, on any clock that all bodies of a scene share. -0 is taken as 0.
    pub time: f64,
    /// Position, m, in any frame that all bodies of a scene share.
    pub position: DVec3,
    /// Velocity, m/s, in the same frame.
    pub velocity: DVec3,
}

impl State {
    /// Returns a state from its parts (s, m, m/s); building a trajectory from it validates it.
    ///
    /// Position and velocity can be vectors of [`glam`] (also its f32 `Vec3`), arrays or tuples of f64; with the
    /// feature `mint`, vectors of f64 of mint.
    ///
    /// ```
    /// use nearmiss::State;
    /// use nearmiss::glam::{DVec3, Vec3};
    ///
    /// let state = State::new(0.0, [1.0, 2.0, 3.0], (0.0, 0.0, 4.0));
    /// assert_eq!(state, State::new(0.0, Vec3::new(1.0, 2.0, 3.0), 4.0 * DVec3::Z));
    /// ```
    #[must_use]
    pub fn new(time: f64, position: impl Into<DVec3>, velocity: impl Into<DVec3>) -> Self {
        Self {
            time,
            position: position.into(),
            velocity: velocity.into(),
        }
    }
}
