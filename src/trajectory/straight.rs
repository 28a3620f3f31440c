//! Straight motion through a state.

use super::{Segment, State};
use glam::DVec3;

/// Straight motion through a state, in both directions of time. Its cubic is formed from this when it is needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StraightMotion {
    state: State,
    /// End of its cubic, s; the duration from the state's time on is the unit of the cubic's parameter.
    end: f64,
}

impl StraightMotion {
    pub(super) const NONE: Self = Self {
        state: State {
            time: 0.0,
            position: DVec3::ZERO,
            velocity: DVec3::ZERO,
        },
        end: 1.0,
    };

    /// Returns the motion through a state whose cubic was made by [`Segment::line`] without an error of its own.
    pub(super) const fn new(state: &State, line: &Segment) -> Self {
        Self {
            state: State {
                time: line.start(),
                ..*state
            },
            end: line.end(),
        }
    }

    /// Returns the motion whose cubic this is, if there is one.
    pub(super) fn of(line: &Segment) -> Option<Self> {
        let state = State {
            time: line.start(),
            position: line.origin(),
            velocity: line.straight_velocity(),
        };
        let motion = Self::new(&state, line);
        (motion.segment() == *line).then_some(motion)
    }

    /// Returns the cubic.
    #[inline]
    pub(crate) fn segment(&self) -> Segment {
        Segment::through(&self.state, self.end, 0.0)
    }

    /// Returns the time of the state, s.
    pub(crate) const fn start(&self) -> f64 {
        self.state.time
    }

    pub(super) const fn start_ref(&self) -> &f64 {
        &self.state.time
    }

    /// Returns the duration of the cubic, s.
    pub(crate) fn duration(&self) -> f64 {
        self.end - self.state.time
    }

    /// Returns the position at the time of the state, m.
    pub(crate) const fn origin(&self) -> DVec3 {
        self.state.position
    }

    /// Returns the velocity, m/s.
    pub(crate) const fn velocity(&self) -> DVec3 {
        self.state.velocity
    }

    /// Returns the way from the origin to the position at an instant (s), m. Each coordinate has two roundings.
    #[inline(always)]
    pub(crate) fn way_to(&self, time: f64) -> DVec3 {
        self.state.velocity * (time - self.state.time)
    }
}
