//! The error of one cubic between two states of a motion.

use crate::rounding::{UNDERFLOW, UNIT_ROUNDOFF, norm};
use crate::trajectory::{Segment, State};

/// Rounding of a position that a trajectory returns, relative to the extent of its cubic: 80 roundings in the worst
/// case, by the count of those in [`Segment::motion_at`].
pub(super) const EVALUATION: f64 = 128.0 * UNIT_ROUNDOFF;

/// Factor on bounds, for their own rounding.
pub(super) const SPARE: f64 = 1.0 + 1e-12;

/// A cubic between two states of a motion.
pub(super) struct FittedPiece {
    pub(super) segment: Segment,
    /// Largest distance (m) between positions of the trajectory and of the motion that follows from rounding alone.
    pub(super) rounding: f64,
}

impl FittedPiece {
    /// Returns the cubic between two states, or `None` if it leaves the range of f64. Values of the motion are good
    /// to `ulps`.
    pub(super) fn between(first: &State, second: &State, ulps: f64) -> Option<Self> {
        let segment = Segment::hermite(first, second, 0).ok()?;
        let duration = second.time - first.time;
        let distance = norm(first.position) + segment.extent();
        let speed = norm(first.velocity).max(norm(second.velocity));
        // The weights of the positions add up to 1, those of the velocities to a quarter of the duration.
        let values = ulps * f64::EPSILON * (distance + duration * speed / 4.0);
        let evaluation = UNIT_ROUNDOFF * distance + EVALUATION * segment.extent();
        let rounding = (values + segment.error() + evaluation) * SPARE + UNDERFLOW;
        Some(Self { segment, rounding })
    }

    /// Returns a bound of the error (m), by a bound of the motion's distance from the exact cubic (m).
    pub(super) fn bound(&self, remainder: f64) -> f64 {
        remainder * SPARE + self.rounding
    }
}
