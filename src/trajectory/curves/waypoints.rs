//! Waypoints: straight legs of constant velocity.

use crate::error::{Error, Quantity};
use crate::rounding::without_negative_zero;
use crate::trajectory::build::{check_times, check_vector};
use crate::trajectory::{Outside, Segment, State, Trajectory};
use glam::DVec3;

impl Trajectory {
    /// Builds straight legs of constant velocity between waypoints, `(time, position)` (s, m). Positions can be what
    /// [`State::new`] takes.
    ///
    /// The velocity jumps at the waypoints. To stop at one, name its position twice, with the times of arrival and
    /// departure. Beyond the first and last waypoint, if [`Outside`] says so, the body keeps the
    /// velocity of the leg there.
    ///
    /// Each leg is exactly straight, and its velocity exactly constant. That velocity is the way between the waypoints over
    /// the time between them, good to a few roundings. A position on a leg is good to a few roundings of the leg's length,
    /// and of the position itself.
    ///
    /// ```
    /// use nearmiss::Trajectory;
    /// use nearmiss::glam::DVec3;
    ///
    /// // A delivery: there in 10 s, 5 s to set down the parcel, and on around a corner.
    /// let corner = 100.0 * DVec3::X;
    /// let legs = [(0.0, DVec3::ZERO), (10.0, corner), (15.0, corner), (20.0, corner + 50.0 * DVec3::Y)];
    /// let plan = Trajectory::from_waypoints(&legs)?;
    /// assert_eq!(plan.position(4.0), Some(40.0 * DVec3::X));
    /// assert_eq!(plan.position(12.0), Some(corner));
    /// assert_eq!(plan.velocity(15.0), Some(10.0 * DVec3::Y)); // from then on
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::TooFewStates`] below two waypoints; [`Error::TimeNotIncreasing`], [`Error::NotFinite`] and
    /// [`Error::OutOfRange`], each with the waypoint (as `knot`) and the value.
    #[doc(alias("polyline", "piecewise linear", "route", "mission", "path"))]
    pub fn from_waypoints<P: Copy + Into<DVec3>>(waypoints: &[(f64, P)]) -> Result<Self, Error> {
        Self::of_waypoints(&positions_of(waypoints))
    }

    fn of_waypoints(waypoints: &[(f64, DVec3)]) -> Result<Self, Error> {
        let count = waypoints.len();
        if count < 2 {
            return Err(Error::TooFewStates { count });
        }
        check_positions(waypoints)?;
        let knots: Vec<f64> = waypoints
            .iter()
            .map(|&(time, _)| without_negative_zero(time))
            .collect();
        let legs = (1..).zip(waypoints.windows(2));
        let legs = legs
            .map(|(knot, ends)| Segment::leg(ends[0], ends[1], knot))
            .collect::<Result<Vec<_>, _>>()?;
        let end_motion = |leg: &Segment, waypoint: usize| {
            let (time, position) = waypoints[waypoint];
            let state = State::new(time, position, leg.motion_at(time).1);
            let duration = leg.end() - leg.start();
            // The velocity is rounded, as the leg is, and once more.
            Segment::line(&state, duration, 4.0 * leg.error(), waypoint)
        };
        let ends = [
            end_motion(&legs[0], 0)?,
            end_motion(&legs[count - 2], count - 1)?,
        ];
        Ok(Self::of_cubics(&knots, &legs, &ends, [Outside::Absent; 2]))
    }
}

/// Returns times and positions with the positions as vectors.
pub(super) fn positions_of<P: Copy + Into<DVec3>>(given: &[(f64, P)]) -> Vec<(f64, DVec3)> {
    let positions = given.iter();
    positions
        .map(|&(time, position)| (time, position.into()))
        .collect()
}

/// Checks that times increase, and that positions can be used.
///
/// # Errors
///
/// Those of [`check_times`] and [`check_vector`].
pub(super) fn check_positions(positions: &[(f64, DVec3)]) -> Result<(), Error> {
    check_times(positions.iter().map(|&(time, _)| time))?;
    let mut positions = positions.iter().enumerate();
    positions
        .try_for_each(|(knot, &(_, position))| check_vector(knot, Quantity::Position, position))
}
