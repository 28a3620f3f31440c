//! Trajectories: irregular states in, cubic segments out. All validation of motion happens here.

mod bend;
mod build;
mod cuts;
mod double_double;
mod outside;
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
pub use outside::Outside;
pub(crate) use outside::{Pieces, Scope};
pub(crate) use segment::Restriction;
pub use segment::Segment;
pub use state::State;

use crate::window::Window;
use glam::DVec3;
use roomy::Roomy;

/// The motion of one body: cubic segments between knots, and what it does before and after.
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
    /// One more than segments. A body that is at rest, or only coasts, has one knot and no segment.
    knots: Roomy<f64>,
    /// Beside them: straight motion before the first and after the last knot. There they cost a
    /// body that is moved about, or never asked, nothing.
    segments: Roomy<Segment, 2>,
    /// Before the first knot.
    before: Outside,
    /// After the last knot.
    after: Outside,
}

impl Trajectory {
    /// The same motion, with another rule for the time before and the time after its knots.
    ///
    /// A body that is [`at_rest`](Self::at_rest), or only [coasts](Self::coasting), does so for all time,
    /// whatever the rule.
    #[must_use]
    pub fn with_outside(mut self, outside: Outside) -> Self {
        if !self.segments.is_empty() {
            (self.before, self.after) = (outside, outside);
        }
        self
    }

    /// What the body does before its first knot.
    #[must_use]
    pub const fn outside_before(&self) -> Outside {
        self.before
    }

    /// What the body does after its last knot. Not the same as [before](Self::outside_before) its first
    /// one where a plan was [spliced](Self::spliced). A plan that was spliced in after its own last knot goes
    /// on as it did.
    #[must_use]
    pub const fn outside_after(&self) -> Outside {
        self.after
    }

    /// Whether it exists before its first knot or after its last one.
    pub(crate) fn goes_beyond(&self) -> bool {
        self.before != Outside::Absent || self.after != Outside::Absent
    }

    /// The times of the knots, s, increasing.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The cubics, one between each two knots. Of a cubic that a splice has cut, only the part
    /// between its knots is flown.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// When the body exists: between its knots, and where it is not `Absent` before and after them.
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

    /// Returns time, position and velocity at `time` (s, m, m/s): [`position`](Self::position) and
    /// [`velocity`](Self::velocity) at once; none where there is no position.
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

    /// Position at `time`, m; none where the body does not exist, or its motion, extrapolated, has left
    /// the range of f64.
    ///
    /// Relative to the segment's first knot good to a few roundings of the segment's extent; of a body
    /// that coasts, of the way from its knot; of a cubic that is extrapolated, of its terms there, which
    /// may be far larger than their sum. The sum with the absolute position is rounded once more.
    #[must_use]
    pub fn position(&self, time: f64) -> Option<DVec3> {
        self.motion_at(time).map(|(position, _, _)| position)
    }

    /// Velocity at `time`, m/s; none where there is no [position](Self::position). At a knot: that from
    /// then on, if the body exists then.
    #[must_use]
    pub fn velocity(&self, time: f64) -> Option<DVec3> {
        self.motion_at(time).map(|(_, velocity, _)| velocity)
    }

    /// Acceleration at `time`, m/s²; none where there is no [position](Self::position). At a knot: that from
    /// then on, if the body exists then.
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

    /// Position, velocity and acceleration on the cubic that the body follows at `time`.
    fn followed_at(&self, time: f64) -> (DVec3, DVec3, DVec3) {
        let after = self.knots.partition_point(|&knot| knot <= time);
        if after == 0 {
            return self.carrier_before().motion_at(time);
        }
        if after < self.knots.len() {
            return self.segments[after - 1].motion_at(time);
        }
        match self.segments.last() {
            // It is at its last knot, where it ceases to exist.
            Some(last) if self.after == Outside::Absent => last.motion_at(time),
            _ => self.carrier_after().motion_at(time),
        }
    }
}
