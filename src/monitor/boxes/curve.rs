//! An order of places in space.

use super::node::{corners, merged};
use crate::broad_phase::BodyBox;
use parry3d::bounding_volume::Aabb;

/// A curve through space on which what is near in place is near in space.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MortonOrder {
    low: [f32; 3],
    scale: [f32; 3],
}

impl MortonOrder {
    /// Returns the order through all of some boxes.
    pub(super) fn through(boxes: &[(u32, BodyBox)]) -> Self {
        let each = boxes.iter().map(|(_, body)| corners(&body.aabb));
        let (low, high) = each.reduce(merged).unwrap_or_default();
        Self {
            low,
            scale: [0, 1, 2].map(|axis| {
                let side = high[axis] - low[axis];
                // 10 bits an axis.
                1023.0 / if side > 0.0 { side } else { 1.0 }
            }),
        }
    }

    /// Returns the code of a box's middle on the curve.
    #[inline(always)]
    pub(super) fn code(&self, aabb: &Aabb) -> u32 {
        let (low, high) = corners(aabb);
        morton([0, 1, 2].map(|axis| {
            let middle = 0.5 * low[axis] + 0.5 * high[axis];
            cell((middle - self.low[axis]) * self.scale[axis])
        }))
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to 0..=1023; NaN becomes 0. Only the order of places depends on it"
)]
fn cell(coordinate: f32) -> u32 {
    coordinate.clamp(0.0, 1023.0) as u32
}

/// Returns the bits of three cells in turn: near codes are near in space (G. M. Morton, 1966).
fn morton(cell: [u32; 3]) -> u32 {
    let spread = |mut bits: u32| {
        bits = (bits | bits << 16) & 0x0300_00ff;
        bits = (bits | bits << 8) & 0x0300_f00f;
        bits = (bits | bits << 4) & 0x030c_30c3;
        (bits | bits << 2) & 0x0924_9249
    };
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}
