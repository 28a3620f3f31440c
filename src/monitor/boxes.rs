//! The boxes of all bodies in one slice, laid out so that few are looked at to find which of them
//! one box meets, and those in plain loops that the compiler vectorises.
//!
//! Bodies near each other have neighbouring places, 64 of which make a block with a box around
//! all of it. A body that moves away from its block gets a new place at the end; when many have,
//! all are put in order again.

use crate::broad_phase::BodyBox;
use parry3d::bounding_volume::Aabb;

/// Places in a block, and boxes compared at a time.
const LANES: usize = 64;

/// Marks a body without a place.
const NOWHERE: u32 = u32::MAX;

/// Boxes by slot; a body that does not exist in the slice has none.
#[derive(Clone, Debug, Default)]
pub(super) struct Boxes {
    /// By slot.
    place_of: Vec<u32>,
    /// By place.
    slot_at: Vec<u32>,
    boxes: Corners,
    blocks: Corners,
    /// Places given out at the end since all were put in order.
    strays: usize,
    sorted: Vec<(u32, BodyBox)>,
}

/// Boxes side by side, a list for each face; an empty box meets nothing.
#[derive(Clone, Debug, Default)]
struct Corners {
    low: [Vec<f32>; 3],
    high: [Vec<f32>; 3],
}

impl Corners {
    fn len(&self) -> usize {
        self.low[0].len()
    }

    fn clear(&mut self) {
        for side in self.low.iter_mut().chain(&mut self.high) {
            side.clear();
        }
    }

    fn push_empty(&mut self) {
        for (low, high) in self.low.iter_mut().zip(&mut self.high) {
            low.push(f32::INFINITY);
            high.push(f32::NEG_INFINITY);
        }
    }

    fn set(&mut self, place: usize, low: [f32; 3], high: [f32; 3]) {
        for axis in 0..3 {
            self.low[axis][place] = low[axis];
            self.high[axis][place] = high[axis];
        }
    }

    fn get(&self, place: usize) -> ([f32; 3], [f32; 3]) {
        (
            [0, 1, 2].map(|axis| self.low[axis][place]),
            [0, 1, 2].map(|axis| self.high[axis][place]),
        )
    }

    fn empty(&mut self, place: usize) {
        self.set(place, [f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    }

    /// Calls `visit` with each place in the range whose box meets `aabb` (touching counts).
    fn meeting(&self, places: std::ops::Range<usize>, aabb: &Aabb, mut visit: impl FnMut(usize)) {
        let (low, high) = (aabb.mins.to_array(), aabb.maxs.to_array());
        let mut hits = [false; LANES];
        for first in places.clone().step_by(LANES) {
            let range = first..places.end.min(first + LANES);
            let lows = [0, 1, 2].map(|axis| &self.low[axis][range.clone()]);
            let highs = [0, 1, 2].map(|axis| &self.high[axis][range.clone()]);
            let hits = &mut hits[..range.len()];
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = (lows[0][lane] <= high[0])
                    & (highs[0][lane] >= low[0])
                    & (lows[1][lane] <= high[1])
                    & (highs[1][lane] >= low[1])
                    & (lows[2][lane] <= high[2])
                    & (highs[2][lane] >= low[2]);
            }
            if hits.contains(&true) {
                for (place, _) in range.zip(hits).filter(|(_, hit)| **hit) {
                    visit(place);
                }
            }
        }
    }
}

fn merged(
    (low, high): ([f32; 3], [f32; 3]),
    (other_low, other_high): ([f32; 3], [f32; 3]),
) -> ([f32; 3], [f32; 3]) {
    (
        [0, 1, 2].map(|axis| low[axis].min(other_low[axis])),
        [0, 1, 2].map(|axis| high[axis].max(other_high[axis])),
    )
}

/// Sum of a box's sides, 0 for an empty one.
fn girth((low, high): ([f32; 3], [f32; 3])) -> f32 {
    (0..3).map(|axis| (high[axis] - low[axis]).max(0.0)).sum()
}

impl Boxes {
    /// Replaces all boxes.
    pub(super) fn build(&mut self, boxes: &[BodyBox]) {
        for &slot in &self.slot_at {
            if slot != NOWHERE {
                self.place_of[slot as usize] = NOWHERE;
            }
        }
        self.slot_at.clear();
        self.boxes.clear();
        self.blocks.clear();
        self.sorted.clear();
        let corner = |body: &BodyBox| (body.aabb.mins.to_array(), body.aabb.maxs.to_array());
        let world = boxes.iter().map(corner).reduce(merged);
        let Some((low, high)) = world else { return };
        let scale = [0, 1, 2].map(|axis| {
            let side = high[axis] - low[axis];
            // A box per unit at most, and no more than 10 bits an axis.
            1023.0 / if side > 0.0 { side } else { 1.0 }
        });
        self.sorted.extend(boxes.iter().map(|body| {
            let (body_low, body_high) = corner(body);
            let cell = [0, 1, 2].map(|axis| {
                let middle = 0.5 * body_low[axis] + 0.5 * body_high[axis];
                cell((middle - low[axis]) * scale[axis])
            });
            (morton(cell), *body)
        }));
        self.sorted
            .sort_unstable_by_key(|(code, body)| (*code, body.body));
        let sorted = std::mem::take(&mut self.sorted);
        for (_, body) in &sorted {
            let (low, high) = corner(body);
            self.append(body.body, low, high);
        }
        self.sorted = sorted;
        self.strays = 0;
    }

    /// Sets or removes a body's box.
    pub(super) fn set(&mut self, slot: u32, aabb: Option<&Aabb>) {
        let place = self.place_of.get(slot as usize).copied();
        let place = place.filter(|&place| place != NOWHERE);
        let Some(aabb) = aabb else {
            self.vacate(place);
            return;
        };
        let corners = (aabb.mins.to_array(), aabb.maxs.to_array());
        if let Some(place) = place {
            let (place, block) = (place as usize, place as usize / LANES);
            let around = self.blocks.get(block);
            let grown = merged(around, corners);
            // Near enough to its neighbours to stay with them.
            if girth(grown) <= 1.25 * (girth(around) + girth(corners)) {
                self.boxes.set(place, corners.0, corners.1);
                self.blocks.set(block, grown.0, grown.1);
                return;
            }
        }
        self.vacate(place);
        self.append(slot, corners.0, corners.1);
        self.strays += 1;
        if self.strays > LANES + self.slot_at.len() / 4 {
            let mut all = Vec::with_capacity(self.slot_at.len());
            self.list(&mut all);
            self.build(&all);
        }
    }

    fn vacate(&mut self, place: Option<u32>) {
        if let Some(place) = place {
            let slot = std::mem::replace(&mut self.slot_at[place as usize], NOWHERE);
            self.place_of[slot as usize] = NOWHERE;
            self.boxes.empty(place as usize);
        }
    }

    fn append(&mut self, slot: u32, low: [f32; 3], high: [f32; 3]) {
        let place = self.slot_at.len();
        if place.is_multiple_of(LANES) {
            self.blocks.push_empty();
        }
        self.slot_at.push(slot);
        self.boxes.push_empty();
        self.boxes.set(place, low, high);
        let block = self.blocks.len() - 1;
        let (low, high) = merged(self.blocks.get(block), (low, high));
        self.blocks.set(block, low, high);
        if self.place_of.len() <= slot as usize {
            self.place_of.resize(slot as usize + 1, NOWHERE);
        }
        self.place_of[slot as usize] = u32::try_from(place).unwrap_or(NOWHERE);
    }

    /// Calls `visit` with each slot whose box meets `aabb` (touching counts).
    pub(super) fn meeting(&self, aabb: &Aabb, mut visit: impl FnMut(u32)) {
        self.blocks.meeting(0..self.blocks.len(), aabb, |block| {
            let first = block * LANES;
            let places = first..(first + LANES).min(self.boxes.len());
            self.boxes
                .meeting(places, aabb, |place| visit(self.slot_at[place]));
        });
    }

    /// How many bodies have a box, at least; some of these may have lost theirs.
    pub(super) fn len(&self) -> usize {
        self.slot_at.len()
    }

    /// All boxes.
    pub(super) fn list(&self, boxes: &mut Vec<BodyBox>) {
        boxes.extend(
            self.slot_at
                .iter()
                .enumerate()
                .filter(|(_, slot)| **slot != NOWHERE)
                .map(|(place, &body)| {
                    let (low, high) = self.boxes.get(place);
                    BodyBox {
                        aabb: Aabb::new(low.into(), high.into()),
                        body,
                    }
                }),
        );
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

/// The bits of three cells in turn: near codes are near in space (G. M. Morton, 1966).
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
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn random_box(rng: &mut ChaCha8Rng) -> Aabb {
        let mut corner = || rng.random_range(-100.0..100.0_f32);
        let low = [corner(), corner(), corner()];
        let high = low.map(|low| low + rng.random_range(0.0..12.0_f32));
        Aabb::new(low.into(), high.into())
    }

    #[test]
    fn meets_what_a_plain_list_meets_whatever_was_changed() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut plain: Vec<Option<Aabb>> = vec![None; 4000];
        let mut boxes = Boxes::default();
        let (mut met, mut reordered) = (0, 0);
        for round in 0..30 {
            if round % 10 == 0 {
                plain.fill_with(|| None);
                for aabb in plain.iter_mut().step_by(2) {
                    *aabb = Some(random_box(&mut rng));
                }
                let present = (0..).zip(&plain).filter_map(|(body, aabb)| {
                    let aabb = (*aabb)?;
                    Some(BodyBox { aabb, body })
                });
                boxes.build(&present.collect::<Vec<_>>());
            }
            for _ in 0..300 {
                let slot = rng.random_range(0..plain.len());
                let new = rng.random_bool(0.7).then(|| random_box(&mut rng));
                plain[slot] = new;
                let strays = boxes.strays;
                boxes.set(u32::try_from(slot).unwrap_or(0), new.as_ref());
                reordered += u32::from(boxes.strays < strays);
            }
            for _ in 0..20 {
                let asked = random_box(&mut rng);
                let body = BodyBox {
                    aabb: asked,
                    body: 0,
                };
                let mut found = Vec::new();
                boxes.meeting(&asked, |slot| found.push(slot));
                found.sort_unstable();
                let expected: Vec<u32> = (0..)
                    .zip(&plain)
                    .filter(|(_, aabb)| {
                        aabb.is_some_and(|aabb| body.meets(&BodyBox { aabb, body: 0 }))
                    })
                    .map(|(slot, _)| slot)
                    .collect();
                assert_eq!(found, expected);
                met += found.len();
            }
        }
        assert!(met > 100 && reordered > 2, "{met} {reordered}");
    }
}
