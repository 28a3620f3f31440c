//! Changing a plan while it is flown: what has been flown stays, bit for bit.

use super::{Outside, Trajectory};
use crate::error::Error;

impl Trajectory {
    /// This plan up to `from` (s), then `plan`.
    ///
    /// The cubics before `from` are kept as they are, the one that `from` lies in up to there; the
    /// new plan's are used from there on. There is no instant between the two: the body is never
    /// absent. (That the positions meet is the planner's affair: a jump is allowed.) What the body
    /// does outside its knots is the new plan's rule.
    ///
    /// # Errors
    ///
    /// [`Error::NoPlanAt`] if `from` is not a time at which both plans exist, and the new one goes
    /// on from.
    pub fn spliced(&self, from: f64, plan: &Self) -> Result<Self, Error> {
        let exists = |trajectory: &Self| from.is_finite() && trajectory.domain().contains(from);
        let ahead = plan.knots.partition_point(|&knot| knot <= from);
        let ends = ahead == plan.knots.len() && plan.outside == Outside::Absent;
        if !exists(self) || !exists(plan) || ends {
            return Err(Error::NoPlanAt { time: from });
        }
        // Flown: whole pieces, then the one that is cut. Beyond its knots a plan goes on along its
        // carrier, which becomes a piece like any other.
        let flown = self.knots.partition_point(|&knot| knot < from);
        let mut knots = self.knots[..flown].to_vec();
        let mut segments = self.segments[..flown.min(self.segments.len())].to_vec();
        if flown > self.segments.len() {
            segments.push(*self.after());
        }
        knots.push(from);
        // To come: the piece of the new plan that holds at `from`, and the rest.
        let mut coast = [*self.before(), plan.coast[1]];
        let mut outside = plan.outside;
        match ahead {
            0 => segments.push(*plan.before()),
            _ if ahead < plan.knots.len() => segments.push(plan.segments[ahead - 1]),
            _ => {
                // No knot left: the carrier goes on for ever, whatever its rule was called.
                coast[1] = *plan.after();
                outside = Outside::Coast;
            }
        }
        knots.extend_from_slice(&plan.knots[ahead..]);
        segments.extend_from_slice(&plan.segments[ahead.min(plan.segments.len())..]);
        Ok(Self {
            knots,
            segments,
            coast,
            outside,
        })
    }

    /// The same motion without the cubics that end before `time` (s): they are forgotten.
    /// At least one is kept.
    #[must_use]
    pub fn since(mut self, time: f64) -> Self {
        let past = self.knots.partition_point(|&knot| knot < time);
        let dropped = past
            .saturating_sub(1)
            .min(self.segments.len().saturating_sub(1));
        self.knots.drain(..dropped);
        self.segments.drain(..dropped);
        self
    }
}
