//! Keyframes: Hermite cubics whose velocity may jump at the knots.

use crate::error::Error;
use crate::trajectory::build::check_states;
use crate::trajectory::{State, Trajectory};
use glam::DVec3;

/// Time, position, and the velocities before and after, of a body at one instant (s, m, m/s).
///
/// It is a keyframe of glTF's `CUBICSPLINE` interpolation, in its order: in-tangent, value, out-tangent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias("glTF", "CUBICSPLINE", "tangent"))]
pub struct Keyframe {
    /// Time, s.
    pub time: f64,
    /// Velocity with which the body arrives, m/s.
    pub in_tangent: DVec3,
    /// Position, m.
    pub position: DVec3,
    /// Velocity with which the body leaves, m/s.
    pub out_tangent: DVec3,
}

impl Keyframe {
    /// Returns a keyframe from its parts; building a trajectory from it validates it.
    ///
    /// Vectors can be what [`State::new`] takes.
    #[must_use]
    pub fn new(
        time: f64,
        in_tangent: impl Into<DVec3>,
        position: impl Into<DVec3>,
        out_tangent: impl Into<DVec3>,
    ) -> Self {
        Self {
            time,
            in_tangent: in_tangent.into(),
            position: position.into(),
            out_tangent: out_tangent.into(),
        }
    }

    pub(super) const fn arriving(&self) -> State {
        State {
            time: self.time,
            position: self.position,
            velocity: self.in_tangent,
        }
    }

    pub(super) const fn leaving(&self) -> State {
        State {
            velocity: self.out_tangent,
            ..self.arriving()
        }
    }
}

impl Trajectory {
    /// Builds cubic Hermite segments through keyframes at irregular, increasing times. The velocity with which a
    /// body leaves a keyframe may differ from the one with which it arrives.
    ///
    /// The first in-tangent and the last out-tangent shape no segment. Beyond the first and last keyframe, if
    /// [`Outside`](crate::Outside) says so, the body goes on from the first out-tangent and the last in-tangent.
    ///
    /// # glTF and other formats
    ///
    /// A tangent here is a velocity, in m/s. glTF 2.0 keeps the tangents of `CUBICSPLINE` per second, and multiplies
    /// them by the duration of the segment when it interpolates. So its numbers are taken as they are; each f32 is an
    /// f64. If a format keeps tangents per segment (its parameter runs from 0 to 1), divide the out-tangent by
    /// the duration of the segment after the keyframe, and the in-tangent by that of the segment before.
    ///
    /// ```
    /// use nearmiss::{Keyframe, Trajectory};
    ///
    /// // It falls for a second, and bounces.
    /// let still = [0.0; 3];
    /// let bounce = Trajectory::from_keyframes(&[
    ///     Keyframe::new(0.0, still, [0.0, 0.0, 5.0], still),
    ///     Keyframe::new(1.0, [0.0, 0.0, -10.0], still, [0.0, 0.0, 8.0]),
    ///     Keyframe::new(1.8, still, [0.0, 0.0, 3.2], still),
    /// ])?;
    /// let velocity = |time| bounce.velocity(time).map_or(f64::NAN, |velocity| velocity.z);
    /// assert!((velocity(0.5) + 5.0).abs() < 1e-14 && (velocity(1.0) - 8.0).abs() < 1e-14);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`from_states`](Self::from_states). Also the tangents that shape no segment must be finite.
    #[doc(alias("glTF", "CUBICSPLINE", "from_tangents", "Hermite"))]
    pub fn from_keyframes(keyframes: &[Keyframe]) -> Result<Self, Error> {
        let arriving: Vec<State> = keyframes.iter().map(Keyframe::arriving).collect();
        let leaving: Vec<State> = keyframes.iter().map(Keyframe::leaving).collect();
        check_states(&arriving)?;
        Self::hermite(&leaving, &arriving)
    }
}
