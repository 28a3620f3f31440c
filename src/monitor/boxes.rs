//! The boxes of all bodies in one slice, by slot, laid out so that one box is compared with all
//! others in a plain loop that the compiler vectorises.

use crate::broad_phase::BodyBox;
use parry3d::bounding_volume::Aabb;

/// Boxes by slot; a body that does not exist in the slice has an empty one that meets nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Boxes {
    low: [Vec<f32>; 3],
    high: [Vec<f32>; 3],
}

/// Boxes compared at a time.
const LANES: usize = 64;

impl Boxes {
    /// Empties all, with room for `slots` bodies.
    pub(super) fn clear(&mut self, slots: usize) {
        for (low, high) in self.low.iter_mut().zip(&mut self.high) {
            low.clear();
            high.clear();
            low.resize(slots, f32::INFINITY);
            high.resize(slots, f32::NEG_INFINITY);
        }
    }

    /// Sets or empties a body's box.
    pub(super) fn set(&mut self, slot: u32, aabb: Option<Aabb>) {
        let place = slot as usize;
        for axis in 0..3 {
            if self.low[axis].len() <= place {
                self.low[axis].resize(place + 1, f32::INFINITY);
                self.high[axis].resize(place + 1, f32::NEG_INFINITY);
            }
            let (low, high) = match &aabb {
                Some(aabb) => (aabb.mins.to_array()[axis], aabb.maxs.to_array()[axis]),
                None => (f32::INFINITY, f32::NEG_INFINITY),
            };
            self.low[axis][place] = low;
            self.high[axis][place] = high;
        }
    }

    /// Calls `visit` with each slot whose box meets `aabb` (touching counts).
    pub(super) fn meeting(&self, aabb: &Aabb, mut visit: impl FnMut(u32)) {
        let (low, high) = (aabb.mins.to_array(), aabb.maxs.to_array());
        let count = self.low[0].len();
        let mut hits = [false; LANES];
        for first in (0..count).step_by(LANES) {
            let lanes = LANES.min(count - first);
            let range = first..first + lanes;
            let lows = [0, 1, 2].map(|axis| &self.low[axis][range.clone()]);
            let highs = [0, 1, 2].map(|axis| &self.high[axis][range.clone()]);
            for (lane, hit) in hits[..lanes].iter_mut().enumerate() {
                *hit = (lows[0][lane] <= high[0])
                    & (highs[0][lane] >= low[0])
                    & (lows[1][lane] <= high[1])
                    & (highs[1][lane] >= low[1])
                    & (lows[2][lane] <= high[2])
                    & (highs[2][lane] >= low[2]);
            }
            if hits[..lanes].iter().any(|&hit| hit) {
                for (slot, _) in (first..).zip(&hits[..lanes]).filter(|(_, hit)| **hit) {
                    visit(u32::try_from(slot).unwrap_or(u32::MAX));
                }
            }
        }
    }

    /// All boxes that are not empty, as the broad phase takes them.
    pub(super) fn list(&self, boxes: &mut Vec<BodyBox>) {
        boxes.clear();
        for (place, &low_x) in self.low[0].iter().enumerate() {
            if low_x.is_finite() {
                let corner =
                    |side: &[Vec<f32>; 3]| [side[0][place], side[1][place], side[2][place]];
                boxes.push(BodyBox {
                    aabb: Aabb::new(corner(&self.low).into(), corner(&self.high).into()),
                    body: u32::try_from(place).unwrap_or(u32::MAX),
                });
            }
        }
    }
}
