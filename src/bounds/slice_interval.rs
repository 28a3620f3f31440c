//! Time intervals of slices.

use super::{FAR, nearest, nearest_vector};
use glam::{DVec3, Vec4};

/// The time interval of a slice, in which boxes move or rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SliceInterval<const MOVES: bool> {
    /// First and last instant, s.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Inverse of the duration, 1/s; 0 if the duration is too short to be divided by.
    pub(super) rate: f64,
    /// Displacement of boxes in the slice, in the frame's unit.
    displacement: Vec4,
}

impl<const MOVES: bool> SliceInterval<MOVES> {
    /// Stands for an interval in memory that is not used: all bits are 0, which is fast to write.
    pub(crate) const UNUSED: Self = Self {
        from: 0.0,
        to: 0.0,
        rate: 0.0,
        displacement: Vec4::ZERO,
    };
}

impl SliceInterval<false> {
    pub(crate) fn new(from: f64, to: f64) -> Self {
        let duration = to - from;
        let rate = if duration >= f64::MIN_POSITIVE {
            1.0 / duration
        } else {
            0.0
        };
        Self {
            from,
            to,
            rate,
            displacement: Vec4::ZERO,
        }
    }

    /// Returns the slice with this displacement of its boxes, in the frame's unit. Any displacement
    /// common to all bodies is correct, so one beyond f32 becomes zero.
    pub(super) fn moving(self, displacement: DVec3) -> SliceInterval<true> {
        let Self { from, to, rate, .. } = self;
        let displacement = if displacement.abs().max_element() < FAR && rate > 0.0 {
            nearest_vector(displacement, 0.0)
        } else {
            Vec4::ZERO
        };
        SliceInterval {
            from,
            to,
            rate,
            displacement,
        }
    }
}

impl<const MOVES: bool> SliceInterval<MOVES> {
    /// Returns the displacement of boxes in the slice, in the frame's unit.
    #[inline(always)]
    pub(super) const fn displacement(&self) -> Vec4 {
        if MOVES { self.displacement } else { Vec4::ZERO }
    }

    /// Returns a point relative to a moving box, at a share of the slice.
    #[inline(always)]
    pub(super) fn relative_at(&self, point: Vec4, share: f32) -> Vec4 {
        if MOVES {
            point - self.displacement * share
        } else {
            point
        }
    }

    /// Returns control points relative to moving boxes, from one share of the slice to another.
    #[inline(always)]
    pub(super) fn relative(&self, points: [Vec4; 4], first: f32, last: f32) -> [Vec4; 4] {
        if !MOVES {
            return points;
        }
        let (start, end) = (self.displacement * first, self.displacement * last);
        let third = (end - start) * (1.0 / 3.0);
        let [p0, p1, p2, p3] = points;
        [
            p0 - start,
            p1 - (start + third),
            p2 - (end - third),
            p3 - end,
        ]
    }

    /// Returns the elapsed share of the slice at an instant.
    #[inline(always)]
    pub(super) fn share(&self, time: f64) -> f32 {
        nearest((time - self.from) * self.rate)
    }
}
