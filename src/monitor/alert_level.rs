//! Margins that are watched.

/// A margin that is watched, and when to let go.
///
/// Of bodies with [model errors](crate::Body::with_model_error), their sum is added to both margins: an
/// encounter lasts while the bodies may be within the margin in the world.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{AlertLevel, Body, Monitor, Scene, Trajectory};
///
/// // A caution at 50 m; an alarm at 10 m, which is over beyond 12 m.
/// let levels = [AlertLevel::at(50.0), AlertLevel { margin: 10.0, release: 12.0 }];
/// let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &levels)?;
/// for x in [0.0, 30.0] {
///     monitor.insert(Body::new(Trajectory::at_rest(x * DVec3::X)?))?;
/// }
/// monitor.advance(0.0, &mut Vec::new())?;
/// assert_eq!((monitor.conflicts(0)?.len(), monitor.conflicts(1)?.len()), (1, 0));
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AlertLevel {
    /// An encounter begins when the separation falls to this, m.
    pub margin: f64,
    /// An encounter ends when the separation exceeds this, m; at least the margin. More than the
    /// margin is hysteresis: an encounter that hovers at its margin does not flicker.
    pub release: f64,
}

impl AlertLevel {
    /// Returns a level that lets go where it begins.
    ///
    /// States that are [told](crate::Monitor::track) in `f32` are off by another rounding each time. Two bodies that
    /// stay at the margin then begin and end encounters again and again: set `release` above the margin there.
    #[must_use]
    pub const fn at(margin: f64) -> Self {
        Self {
            margin,
            release: margin,
        }
    }
}
