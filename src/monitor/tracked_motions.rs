//! Changes of the bodies whose states are given in one call.

use super::monitored_bodies::MonitoredBody;
use crate::error::Error;
use crate::id::BodyId;
use crate::orientation::Orientation;
use crate::trajectory::{StraightMotion, Trajectory};

/// Changes of the bodies of one call. Their memory is reused.
#[derive(Debug, Default)]
pub(super) struct TrackedMotions {
    /// One for each body.
    pub(super) motions: Vec<TrackedMotion>,
    /// By slot: the place of its motion in `motions`, if that is of this slot.
    place_of: Vec<usize>,
}

impl TrackedMotions {
    /// Takes a motion in. It replaces that of the same body, if there is one.
    pub(super) fn put(&mut self, motion: TrackedMotion) {
        let slot = motion.id.slot as usize;
        if self.place_of.len() <= slot {
            self.place_of.resize(slot + 1, 0);
        }
        let place = &mut self.place_of[slot];
        match self.motions.get_mut(*place) {
            Some(known) if known.id == motion.id => *known = motion,
            _ => {
                *place = self.motions.len();
                self.motions.push(motion);
            }
        }
    }
}

/// The change of one body.
#[derive(Debug)]
pub(super) struct TrackedMotion {
    pub(super) id: BodyId,
    /// From when on, s.
    pub(super) from: f64,
    /// Straight motion from then on.
    pub(super) motion: StraightMotion,
    /// Orientation from then on, if it was given; then that of all time.
    pub(super) orientation: Option<Orientation>,
    pub(super) change: TrackedChange,
}

/// The way in which a body comes to follow a straight motion.
#[derive(Debug)]
pub(super) enum TrackedChange {
    /// None: it follows it already.
    Same,
    /// Its plan is turned in place.
    Turn,
    /// The body takes another plan.
    Replan(Box<(Trajectory, MonitoredBody)>),
    /// None: it is refused.
    Refused(Box<Error>),
}
