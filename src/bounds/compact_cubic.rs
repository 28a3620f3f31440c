//! One cubic in f32.

use super::frame::Frame;
use super::points::PaddedPoints;
use super::{FAR, nearest};
use crate::trajectory::Segment;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec4};

/// One cubic of a compact trajectory, 64 bytes: its Bézier points, relative to the compact trajectory's frame.
///
/// Each coordinate is rounded once from f64. The fourth lane of the first point is what all other
/// rounding of the cubic is relative to: no point is farther from the first one; more where the
/// segment itself is known less well than f32 could tell.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct CompactCubic([Vec4; 4]);

impl CompactCubic {
    /// None where `f32` does not serve its coordinates.
    #[inline(always)]
    pub(super) fn of(segment: &Segment, ends: (f64, f64), frame: &Frame) -> Option<Self> {
        let part = PaddedPoints::of(segment, ends);
        let (offset, near) = (segment.origin() - frame.origin, part.spread() * frame.power);
        let lanes = |point: DVec3, last: f64| {
            let DVec3 { x, y, z } = (offset + point) * frame.power;
            Vec4::new(nearest(x), nearest(y), nearest(z), nearest(last))
        };
        let [p0, p1, p2, p3] = part.points;
        let is_served = (offset + p0).abs().max_element() * frame.power + near < FAR;
        is_served.then(|| {
            Self([
                lanes(p0, near),
                lanes(p1, 0.0),
                lanes(p2, 0.0),
                lanes(p3, 0.0),
            ])
        })
    }

    pub(super) const NONE: Self = Self([Vec4::ZERO; 4]);

    /// The points in another unit, and what their rounding is relative to.
    #[inline(always)]
    pub(super) fn points(&self, factor: f32) -> ([Vec4; 4], f32) {
        let points = self.0.map(|point| point * factor);
        (points, points[0].w)
    }
}
