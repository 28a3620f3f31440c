//! Alert levels: margins that a monitor watches.

/// A margin at which an encounter begins, and a margin at which it ends.
///
/// The sum of both bodies' [model errors](crate::Body::with_model_error) is added to both margins: an
/// encounter lasts while the bodies may be within the margin in the world.
///
/// Any values can be held: [`Monitor::new`](crate::Monitor::new) refuses, with
/// [`Error::AlertLevel`](crate::Error::AlertLevel), margins that are not within ±1e300, and a release below the
/// margin.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{AlertLevel, Body, Monitor, Scene, Trajectory};
///
/// // A caution at 50 m; an alarm at 10 m, which is over beyond 12 m.
/// let levels = [AlertLevel::at(50.0), AlertLevel::at(10.0).with_release(12.0)];
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
#[non_exhaustive]
pub struct AlertLevel {
    /// Separation at which an encounter begins, m. A negative one asks for overlaps of that depth.
    pub margin: f64,
    /// Separation above which an encounter ends, m: the margin, or more. A release above the margin keeps an
    /// encounter whose separation hovers at the margin from ending and beginning again and again.
    pub release: f64,
}

impl AlertLevel {
    /// Returns a level whose encounters begin and end at one margin (m).
    ///
    /// States that are [told](crate::Monitor::track) in `f32` are off by another rounding each time. Two bodies that
    /// stay at the margin then begin and end encounters again and again: [`with_release`](Self::with_release) prevents that.
    #[must_use]
    pub const fn at(margin: f64) -> Self {
        Self {
            margin,
            release: margin,
        }
    }

    /// Returns the level with another [`release`](Self::release), m.
    #[must_use]
    pub const fn with_release(mut self, release: f64) -> Self {
        self.release = release;
        self
    }

    /// Returns all margins of some levels, m, ascending, each once.
    pub(super) fn margins(levels: &[Self]) -> Vec<f64> {
        let both = levels
            .iter()
            .flat_map(|level| [level.margin, level.release]);
        let mut margins: Vec<f64> = both.collect();
        margins.sort_unstable_by(f64::total_cmp);
        margins.dedup();
        margins
    }

    /// Returns true if encounters end at another margin than they begin at.
    pub(super) fn has_release(&self) -> bool {
        self.release > self.margin
    }
}
