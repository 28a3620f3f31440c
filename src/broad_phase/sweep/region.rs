//! The part of space in which a set of boxes is responsible for pairs.

use parry3d::math::Vector;

use crate::broad_phase::BodyBox;

/// A box of space, half open: low faces belong to it, high faces do not.
///
/// Where boxes are divided among regions, a box that reaches into several is copied to each, and
/// the pair belongs to the region in which its common part starts: to exactly one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) low: Vector,
    pub(super) high: Vector,
}

impl Region {
    pub(super) const EVERYWHERE: Self = Self {
        low: Vector::splat(f32::NEG_INFINITY),
        high: Vector::splat(f32::INFINITY),
    };

    /// Returns true if the common part of two boxes that meet starts here.
    #[inline(always)]
    pub(super) fn owns(&self, one: &BodyBox, other: &BodyBox) -> bool {
        let start = one.aabb.mins.max(other.aabb.mins);
        (self.low.cmple(start) & start.cmplt(self.high)).all()
    }

    /// The part of this region from `low` to `high` on an axis.
    pub(super) fn between(mut self, axis: usize, low: f32, high: f32) -> Self {
        self.low[axis] = self.low[axis].max(low);
        self.high[axis] = self.high[axis].min(high);
        self
    }
}
