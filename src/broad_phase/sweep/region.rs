//! The part of space in which a set of boxes owns pairs.

use parry3d::math::Vector;

use crate::broad_phase::BodyBox;

/// A half-open box of space: low faces belong to it, high faces do not.
///
/// A box that reaches into several regions is copied to each. A pair belongs to exactly one: the
/// region in which the boxes' intersection starts.
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

    /// Returns true if the intersection of two overlapping boxes starts here.
    #[inline(always)]
    pub(super) fn owns(&self, one: &BodyBox, other: &BodyBox) -> bool {
        let start = one.aabb.mins.max(other.aabb.mins);
        (self.low.cmple(start) & start.cmplt(self.high)).all()
    }

    /// Returns the part of this region from `low` to `high` on an axis.
    pub(super) fn between(mut self, axis: usize, low: f32, high: f32) -> Self {
        self.low[axis] = self.low[axis].max(low);
        self.high[axis] = self.high[axis].min(high);
        self
    }
}
