//! Trajectories: irregular states in, cubic segments out. All validation of motion happens here.

mod bend;
mod build;
mod cuts;
mod double_double;
mod extension;
mod roomy;
mod rows;
mod segment;
#[cfg(feature = "serde")]
mod serial;
mod splice;
mod state;

pub use build::TimeBase;
#[cfg(test)]
pub(crate) use double_double::DoubleDouble;
pub(crate) use extension::Extension;
#[cfg(test)]
pub(crate) use extension::Pieces;
pub(crate) use segment::Restriction;
pub use segment::Segment;
pub use state::State;

use crate::window::Window;
use glam::DVec3;
use roomy::Roomy;

/// The motion of one body: cubic segments between knots, and a rule for the time outside them.
///
/// ```
/// use glam::DVec3;
/// use nearmiss::{State, Trajectory};
///
/// let plan = Trajectory::from_states(&[
///     State::new(0.0, DVec3::ZERO, DVec3::X),
///     State::new(2.0, DVec3::new(2.0, 0.0, 0.0), DVec3::X),
/// ])?;
/// assert_eq!(plan.position(1.0), Some(DVec3::X));
/// assert_eq!(plan.position(3.0), None); // absent after its last knot
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serial::Numbers", into = "serial::Numbers")
)]
pub struct Trajectory {
    /// Knots, s; one more than segments. A body at rest or only coasting has no segment.
    knots: Roomy<f64>,
    /// Segments between the knots; beside them, the end motions before and after.
    segments: Roomy<Segment, 2>,
    before: Outside,
    after: Outside,
}

/// The rule for the motion of a body before its first and after its last knot.
///
/// A body that continues beyond its knots exists at all times: it can only be screened within a
/// closed window, else there is an [`Error::WindowNotClosed`](crate::Error::WindowNotClosed).
///
/// Rounding: a position beyond the knots is good to 4e-15 of the distance travelled from the knot.
/// For a cubic, take the sum of the sizes of its three terms; straight motion has only the linear
/// one. Two bodies then come within a margin to 1e-14 of both distances and of their separation.
/// [`Accuracy::Exact`](crate::Accuracy::Exact) reports conflicts that this leaves open,
/// [`Accuracy::Certified`](crate::Accuracy::Certified) marks them as unresolved.
///
/// Cost: in a window in which bodies cross the scene many times, every pair counts as near. Up to
/// 1e12 s, 1,000 bodies at 10 m/s take 4 s, and 5,000 more than 90 s. Ask for shorter windows.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Outside, State, Trajectory};
///
/// // It speeds up: t² metres after t seconds.
/// let square = |t: f64| State::new(t, t * t * DVec3::X, 2.0 * t * DVec3::X);
/// let plan = Trajectory::from_states(&[square(0.0), square(1.0)])?;
/// assert_eq!(plan.position(2.0), None);
/// for (outside, metres) in [(Outside::Extrapolate, 4.0), (Outside::Coast, 3.0)] {
///     assert_eq!(plan.clone().with_outside(outside).position(2.0), Some(metres * DVec3::X));
/// }
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Outside {
    /// The body does not exist there.
    #[default]
    Absent,
    /// The first and last cubic continue in their own parameter, as in the literature. A position
    /// is good to 4e-15 of the cubic's terms, which grow with time, its square and its cube. States
    /// one minute apart on a low orbit give 1 mm after 10 hours, and 1 m after five days.
    Extrapolate,
    /// The body keeps the velocity of its first or last knot (dead reckoning). From a single state:
    /// [`Trajectory::coasting`].
    Coast,
}

impl Trajectory {
    /// Returns this motion with another rule for the time before and after its knots.
    ///
    /// A body that is [`at_rest`](Self::at_rest) or only [coasts](Self::coasting) ignores the rule:
    /// it keeps its motion for all time.
    #[must_use]
    pub fn with_outside(mut self, outside: Outside) -> Self {
        if !self.segments.is_empty() {
            (self.before, self.after) = (outside, outside);
        }
        self
    }

    /// Returns the rule before the first knot.
    #[must_use]
    pub const fn outside_before(&self) -> Outside {
        self.before
    }

    /// Returns the rule after the last knot. After a [splice](Self::spliced) it may differ from the
    /// one [before](Self::outside_before) the first knot. A plan spliced in after its own last knot
    /// keeps its end motion.
    #[must_use]
    pub const fn outside_after(&self) -> Outside {
        self.after
    }

    /// Returns true if the body exists before its first or after its last knot.
    pub(crate) fn goes_beyond(&self) -> bool {
        self.before != Outside::Absent || self.after != Outside::Absent
    }

    /// Returns the times of the knots, s, increasing.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Returns the cubics between consecutive knots. Of a cubic that a splice has cut, only the
    /// part between its knots is followed.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Returns the window in which the body exists: from its first to its last knot, and on
    /// either side for all time unless `Absent`.
    #[must_use]
    pub fn domain(&self) -> Window {
        let (planned, all) = (self.planned(), Window::ALL);
        let or_ever = |outside, knot, ever| match outside {
            Outside::Absent => knot,
            Outside::Extrapolate | Outside::Coast => ever,
        };
        let start = or_ever(self.before, planned.start(), all.start());
        let end = or_ever(self.after, planned.end(), all.end());
        Window::new(start, end).unwrap_or(all)
    }

    /// Returns time, position and velocity at `time` (s, m, m/s), or `None` where there is no
    /// [`position`](Self::position).
    ///
    /// ```
    /// use nearmiss::{State, Trajectory};
    ///
    /// let states = [0.0, 10.0].map(|t| State::new(t, [t, 0.0, 0.0], [1.0, 0.0, 0.0]));
    /// let plan = Trajectory::from_states(&states)?;
    /// let middle = plan.state(5.0).map(|state| state.position.to_array());
    /// assert_eq!(middle, Some([5.0, 0.0, 0.0]));
    /// assert_eq!(plan.state(10.1), None);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    #[must_use]
    pub fn state(&self, time: f64) -> Option<State> {
        self.motion_at(time)
            .map(|(position, velocity, _)| State::new(time, position, velocity))
    }

    /// Returns the position at `time`, m, or `None` where the body does not exist. Also `None`
    /// where its extrapolated motion has left the range of f64.
    ///
    /// The offset from the segment's first knot is good to a few roundings of the segment's extent.
    /// For a coasting body: of the distance from its knot. For an extrapolated cubic: of its terms
    /// there, which may far exceed their sum. The sum with the absolute position is rounded once
    /// more.
    #[must_use]
    pub fn position(&self, time: f64) -> Option<DVec3> {
        self.motion_at(time).map(|(position, _, _)| position)
    }

    /// Returns the velocity at `time`, m/s, or `None` where there is no [position](Self::position).
    /// At a knot: the velocity from then on, if the body exists then.
    #[must_use]
    pub fn velocity(&self, time: f64) -> Option<DVec3> {
        self.motion_at(time).map(|(_, velocity, _)| velocity)
    }

    /// Returns the acceleration at `time`, m/s², or `None` where there is no
    /// [position](Self::position). At a knot: the acceleration from then on, if the body exists
    /// then.
    #[must_use]
    pub fn acceleration(&self, time: f64) -> Option<DVec3> {
        self.motion_at(time)
            .map(|(_, _, acceleration)| acceleration)
    }

    fn motion_at(&self, time: f64) -> Option<(DVec3, DVec3, DVec3)> {
        if !time.is_finite() || !self.domain().contains(time) {
            return None;
        }
        let motion = self.followed_at(time);
        // Far outside its knots an extrapolated cubic can leave the range of f64.
        let is_finite = motion.0.is_finite() && motion.1.is_finite() && motion.2.is_finite();
        is_finite.then_some(motion)
    }

    /// Returns position, velocity and acceleration on the cubic that the body follows at `time`.
    fn followed_at(&self, time: f64) -> (DVec3, DVec3, DVec3) {
        let after = self.knots.partition_point(|&knot| knot <= time);
        if after == 0 {
            return self.segment_before().motion_at(time);
        }
        if after < self.knots.len() {
            return self.segments[after - 1].motion_at(time);
        }
        match self.segments.last() {
            // It is at its last knot, where it ceases to exist.
            Some(last) if self.after == Outside::Absent => last.motion_at(time),
            _ => self.segment_after().motion_at(time),
        }
    }
}
