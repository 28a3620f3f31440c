//! One cubic in f32.

use super::frame::Frame;
use super::points::InexactPoints;
use super::{FAR, nearest_vector};
use crate::trajectory::Segment;
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

/// One cubic of a compact trajectory, 64 bytes: Bézier points in the trajectory's frame.
///
/// Each coordinate is rounded once from f64. The fourth lane of the first point is the magnitude to
/// which all other rounding is relative. It bounds the distance of the points from the first one,
/// and is larger where the segment's own error exceeds f32 rounding.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct CompactCubic([Vec4; 4]);

impl CompactCubic {
    /// Returns the compact cubic, or `None` where f32 does not serve its coordinates.
    #[inline(always)]
    pub(super) fn of(segment: &Segment, ends: (f64, f64), frame: &Frame) -> Option<Self> {
        let part = InexactPoints::of(segment, ends);
        let (offset, spread) = (segment.origin() - frame.origin, part.spread() * frame.power);
        let lanes = |point, last| nearest_vector((offset + point) * frame.power, last);
        let [p0, p1, p2, p3] = part.points;
        let is_served = (offset + p0).abs().max_element() * frame.power + spread < FAR;
        is_served.then(|| {
            Self([
                lanes(p0, spread),
                lanes(p1, 0.0),
                lanes(p2, 0.0),
                lanes(p3, 0.0),
            ])
        })
    }

    pub(super) const NONE: Self = Self([Vec4::ZERO; 4]);

    /// Returns the points in another unit, and the magnitude to which their rounding is relative.
    #[inline(always)]
    pub(super) fn points(&self, factor: f32) -> ([Vec4; 4], f32) {
        let points = self.0.map(|point| point * factor);
        (points, points[0].w)
    }
}
