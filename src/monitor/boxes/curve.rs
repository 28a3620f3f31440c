//! An order of points in space.

use super::node::{corners, merged};
use crate::broad_phase::BodyBox;
use parry3d::bounding_volume::Aabb;

/// A curve through space on which what is near along it is near in space.
///
/// Cells are equally long within a distance from the median in which most boxes are, twice as long from there to three times
/// the distance, and so on: a few boxes far away leave cells enough for the others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MortonOrder {
    median: [f32; 3],
    /// One over the distance from the median within which cells are equally long.
    scale: [f32; 3],
    /// Cells for each unit of [`log`].
    cells: [f32; 3],
}

/// Cells on either side of the median.
const HALF: f32 = 512.0;

impl MortonOrder {
    /// Boxes that tell where most are.
    const SAMPLE: usize = 64;

    /// Returns the order through all of some boxes.
    pub(super) fn through(boxes: &[(u32, BodyBox)]) -> Self {
        let each = boxes.iter().map(|(_, body)| corners(&body.aabb));
        let (low, high) = each.reduce(merged).unwrap_or_default();
        let step = boxes.len().div_ceil(Self::SAMPLE).max(1);
        let mut order = Self::default();
        for axis in 0..3 {
            // No list: a tick allocates nothing.
            let (mut some, mut count) = ([0.0; Self::SAMPLE], 0);
            for (_, body) in boxes.iter().step_by(step) {
                some[count] = middle(&body.aabb, axis);
                count += 1;
            }
            some[..count].sort_unstable_by(f32::total_cmp);
            let [first, median, last] = [1, 4, 7].map(|eighths| some[count * eighths / 8]);
            let farthest = (high[axis] - median).max(median - low[axis]);
            // Of boxes at even distances, three quarters lie between these eighths.
            let most = 4.0 / 3.0 * (last - median).max(median - first);
            let most = if most > 0.0 { most } else { farthest };
            order.median[axis] = median;
            order.scale[axis] = 1.0 / if most > 0.0 { most } else { 1.0 };
            let most = log(farthest * order.scale[axis]);
            order.cells[axis] = HALF / if most > 0.0 { most } else { 1.0 };
        }
        order
    }

    /// Returns the code of a box's middle on the curve.
    #[inline(always)]
    pub(super) fn code(&self, aabb: &Aabb) -> u32 {
        let mut cells = [0; 3];
        for (axis, cell) in cells.iter_mut().enumerate() {
            let place = (middle(aabb, axis) - self.median[axis]) * self.scale[axis];
            let away = (log(place.abs()) * self.cells[axis]).copysign(place);
            *cell = number(HALF + away);
        }
        morton(cells)
    }
}

/// Returns the middle of a box on an axis, the first one numbered 0.
#[inline(always)]
fn middle(aabb: &Aabb, axis: usize) -> f32 {
    0.5 * aabb.mins[axis] + 0.5 * aabb.maxs[axis]
}

/// Returns the binary logarithm of one plus a distance (at least 0) in units of 2^-23, with a straight line from each power
/// of two to the next.
#[inline(always)]
#[allow(clippy::cast_precision_loss, reason = "cells are far longer")]
fn log(distance: f32) -> f32 {
    const ONE: i32 = 1.0_f32.to_bits().cast_signed();
    // Signed numbers are converted faster.
    ((1.0 + distance).to_bits().cast_signed() - ONE) as f32
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to 0..=1023; NaN becomes 0. Only the order of places depends on it"
)]
fn number(coordinate: f32) -> u32 {
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

#[cfg(test)]
mod tests {
    use super::MortonOrder;
    use crate::broad_phase::BodyBox;
    use parry3d::bounding_volume::Aabb;
    use std::collections::BTreeSet;

    fn boxed(place: [f32; 3]) -> (u32, BodyBox) {
        let aabb = Aabb::new(place.into(), place.into());
        (0, BodyBox { aabb, body: 0 })
    }

    /// One body that is far away, on either side, does not put all others into one cell.
    #[test]
    fn boxes_far_away_leave_cells_for_the_others() {
        let near = |number: u16| [number % 10, number / 10 % 10, number / 100].map(f32::from);
        for away in [0.0, 1e3, -1e6, 1e9, -1e30, f32::INFINITY] {
            let mut boxes: Vec<_> = (0..1000).map(|number| boxed(near(number))).collect();
            boxes.push(boxed([away; 3]));
            let order = MortonOrder::through(&boxes);
            let codes: BTreeSet<u32> = boxes.iter().map(|(_, one)| order.code(&one.aabb)).collect();
            assert!(codes.len() > 300, "{away}: {}", codes.len());
        }
    }
}
