//! Trajectories: irregular states in, cubic segments out. All validation of motion happens here.
//!
//! Words that are used beyond one file are defined in [`internals`](crate::internals), in the order of the data.

mod build;
mod curves;
mod cuts;
mod double_double;
mod end_cubic;
#[cfg(test)]
mod exact_cubic;
mod extension;
mod fit;
mod front_gap;
mod many_motions;
mod motion_list;
mod outside;
mod recent_motions;
mod rows;
mod segment;
mod segment_lists;
#[cfg(feature = "serde")]
mod serial;
mod simplified;
mod splice;
mod state;
mod straight;
mod told;

pub use build::TimeBase;
pub(crate) use build::{check_number, check_times};
pub use curves::{Keyframe, PositionOptions};
#[cfg(test)]
pub(crate) use double_double::DoubleDouble;
pub(crate) use extension::Extension;
#[cfg(test)]
pub(crate) use extension::Pieces;
pub use fit::{Fit, FitOptions};
pub use outside::Outside;
pub(crate) use recent_motions::LastMotion;
pub(crate) use segment::Restriction;
pub use segment::Segment;
pub use state::State;
pub(crate) use straight::StraightMotion;

use crate::window::Window;
use glam::DVec3;
use many_motions::ManyMotions;
use motion_list::MotionList;
pub(crate) use motion_list::count_at_end;
use recent_motions::RecentMotions;
use segment_lists::SegmentLists;
use std::fmt;
use std::slice::from_ref;

/// The motion of one body: cubic segments between knots, and a rule for the time outside them.
///
/// ```
/// use nearmiss::glam::DVec3;
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
#[derive(Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serial::Numbers", into = "serial::Numbers")
)]
pub struct Trajectory {
    storage: Storage,
}

impl fmt::Debug for Trajectory {
    /// Writes how many knots there are, the first and the last one, and the rules beyond them: plans may be long.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let knots = self.knots();
        formatter
            .debug_struct("Trajectory")
            .field("knots", &knots.len())
            .field("first", &knots.first())
            .field("last", &knots.last())
            .field("before", &self.outside_before())
            .field("after", &self.outside_after())
            .finish_non_exhaustive()
    }
}

/// The ways in which a trajectory is stored. Between its knots, and beyond them as far as it is asked about, it consists of
/// *pieces*, each on one cubic; on the *end motion* it goes on before the first knot or after the last one.
#[derive(Clone, Debug)]
enum Storage {
    /// Straight motion for all time, from one state. It takes no other memory.
    ///
    /// The two instants (s) lie one duration of its cubic before the state, and one after it. Between them the motion
    /// is one cubic. Farther away the motion is cut into [pieces](extension), as beyond the knots of a plan.
    Straight(StraightMotion, [f64; 2]),
    /// A few straight motions, one after another, of a body whose state is told each frame.
    Recent(Box<RecentMotions>),
    /// More of them.
    Many(ManyMotions),
    /// Any other motion.
    Lists(SegmentLists),
}

impl PartialEq for Trajectory {
    fn eq(&self, other: &Self) -> bool {
        let rules = |plan: &Self| (plan.outside_before(), plan.outside_after());
        self.knots() == other.knots()
            && self.segments() == other.segments()
            && self.end_motions() == other.end_motions()
            && rules(self) == rules(other)
    }
}

impl Trajectory {
    /// Returns this motion with another rule for the time before and after its knots.
    ///
    /// A motion with a single knot ignores the rule. A body that is [`at_rest`](Self::at_rest) or only
    /// [coasts](Self::coasting) keeps its motion for all time. A [splice](Self::spliced) at the first knot may leave a single
    /// one, with its rules: the old plan's before, and `Coast` after.
    #[must_use]
    pub fn with_outside(mut self, outside: Outside) -> Self {
        if self.knots().len() > 1 {
            let lists = self.as_lists();
            lists.drop_piece_after();
            (lists.before, lists.after) = (outside, outside);
        }
        self
    }

    /// Returns the rule before the first knot.
    #[must_use]
    pub const fn outside_before(&self) -> Outside {
        match &self.storage {
            Storage::Straight(..) => Outside::Coast,
            Storage::Recent(recent) => recent.before(),
            Storage::Many(many) => many.before(),
            Storage::Lists(lists) => lists.before,
        }
    }

    /// Returns the rule after the last knot. After a [splice](Self::spliced) it may differ from the
    /// one [before](Self::outside_before) the first knot. A plan that is spliced in after its own
    /// last knot goes on as it did there.
    #[must_use]
    pub const fn outside_after(&self) -> Outside {
        match &self.storage {
            Storage::Straight(..) | Storage::Recent(_) | Storage::Many(_) => Outside::Coast,
            Storage::Lists(lists) => lists.after,
        }
    }

    /// Returns true if the body exists before its first or after its last knot.
    pub(crate) fn goes_beyond(&self) -> bool {
        self.outside_before() != Outside::Absent || self.outside_after() != Outside::Absent
    }

    /// Returns the straight motion from one state that this is, and where its cubic begins and ends (s).
    pub(crate) const fn straight(&self) -> Option<(&StraightMotion, [f64; 2])> {
        match &self.storage {
            Storage::Straight(motion, ends) => Some((motion, *ends)),
            Storage::Recent(_) | Storage::Many(_) | Storage::Lists(_) => None,
        }
    }

    /// Returns the knots between which its own cubics are followed, s: those of the plan, and where the cubic of
    /// a straight motion from a state begins and ends.
    pub(crate) fn piece_knots(&self) -> &[f64] {
        match &self.storage {
            Storage::Straight(_, ends) => ends,
            Storage::Recent(recent) => recent.piece_knots(),
            Storage::Many(many) => many.piece_knots(),
            Storage::Lists(lists) => &lists.knots,
        }
    }

    /// Returns the cubics of a plan between the [knots of its pieces](Self::piece_knots); none if there are
    /// [straight motions](Self::straight_motions).
    pub(crate) fn cubics(&self) -> &[Segment] {
        match &self.storage {
            Storage::Straight(..) | Storage::Recent(_) | Storage::Many(_) => &[],
            Storage::Lists(lists) => &lists.segments,
        }
    }

    /// Returns the instant (s) from which on the body rests until its trajectory ends: minus infinity if it always does,
    /// infinity if it never does. A plan counts as one that never does.
    pub(crate) fn rests_from(&self) -> f64 {
        let motions = self.straight_motions();
        match motions.last() {
            Some(last) if last.velocity() == DVec3::ZERO => match motions.len() {
                1 => f64::NEG_INFINITY,
                count => self.piece_knots()[count - 1],
            },
            _ => f64::INFINITY,
        }
    }

    /// Returns the straight motions between the [knots of its pieces](Self::piece_knots); none if there are
    /// [cubics](Self::cubics).
    pub(crate) fn straight_motions(&self) -> &[StraightMotion] {
        match &self.storage {
            Storage::Straight(motion, _) => from_ref(motion),
            Storage::Recent(recent) => recent.motions(),
            Storage::Many(many) => many.motions(),
            Storage::Lists(_) => &[],
        }
    }

    /// Returns the end motion before the first knot (0) or after the last one (1).
    fn end_motion(&self, end: usize) -> Segment {
        if let Storage::Lists(lists) = &self.storage {
            return lists.segments.extra()[end];
        }
        let motions = self.straight_motions();
        motions[end * (motions.len() - 1)].segment()
    }

    /// Returns both end motions.
    fn end_motions(&self) -> [Segment; 2] {
        [self.end_motion(0), self.end_motion(1)]
    }

    /// Returns the times of the knots, s, increasing. A body at rest has a single one, at 0 s. A body that only coasts
    /// has that of its state.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        match &self.storage {
            Storage::Straight(motion, _) => from_ref(motion.start_ref()),
            Storage::Recent(recent) => recent.knots(),
            Storage::Many(many) => &many.piece_knots()[..many.motions().len()],
            Storage::Lists(lists) => lists.knots(),
        }
    }

    /// Returns the cubics between consecutive knots; none for a body with a single knot. If a splice has cut a
    /// cubic, only the part between its knots is followed.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        match &self.storage {
            Storage::Straight(..) => &[],
            Storage::Recent(recent) => recent.segments(),
            Storage::Many(many) => many.segments(),
            Storage::Lists(lists) => lists.segments(),
        }
    }

    /// Returns the window in which the body exists: from its first to its last knot, and on
    /// either side for all time unless `Absent`.
    ///
    /// ```
    /// use nearmiss::{Outside, State, Trajectory, Window};
    ///
    /// let states = [2.0, 7.0].map(|t| State::new(t, [t, 0.0, 0.0], [1.0, 0.0, 0.0]));
    /// let plan = Trajectory::from_states(&states)?;
    /// assert_eq!(plan.domain(), Window::new(2.0, 7.0)?);
    /// assert_eq!(plan.with_outside(Outside::Coast).domain(), Window::ALL);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    #[must_use]
    pub fn domain(&self) -> Window {
        let (own, all) = (self.listed_domain(), Window::ALL);
        let or_ever = |outside, knot, ever| match outside {
            Outside::Absent => knot,
            Outside::Extrapolate | Outside::Coast => ever,
        };
        let start = or_ever(self.outside_before(), own.start(), all.start());
        let end = or_ever(self.outside_after(), own.end(), all.end());
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

    /// Returns the position at `time`, m, or `None` where the body does not exist, or its extrapolated
    /// motion has left the range of f64.
    ///
    /// The offset from the segment's first knot is good to a few roundings of the segment's extent. For
    /// a coasting body, these are roundings of the distance from its knot; for an extrapolated cubic, of
    /// its terms there, which may far exceed their sum. The sum with the absolute position is rounded
    /// once more.
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
        let knots = self.knots();
        let after = knots_until(knots, time);
        if after == 0 {
            return self.segment_before().motion_at(time);
        }
        let motions = self.straight_motions();
        if !motions.is_empty() {
            return motions[after - 1].segment().motion_at(time);
        }
        let segments = self.segments();
        if after < knots.len() {
            return segments[after - 1].motion_at(time);
        }
        match segments.last() {
            // It is at its last knot, where it ceases to exist.
            Some(last) if self.outside_after() == Outside::Absent => last.motion_at(time),
            _ => self.segment_after().motion_at(time),
        }
    }
}

/// Returns the number of knots up to a time (s). The ends are looked at first: they are asked about most
/// often, and a search in between reads a long list at many places.
fn knots_until(knots: &[f64], time: f64) -> usize {
    match knots {
        [.., last] if *last <= time => knots.len(),
        [first, second, ..] if time < *second => usize::from(*first <= time),
        _ => knots.partition_point(|&knot| knot <= time),
    }
}
