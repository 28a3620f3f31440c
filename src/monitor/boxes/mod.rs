//! The boxes of all bodies in one slice as a tree, in which the boxes that meet another one are found.
//!
//! Sixteen boxes side by side make a node, compared in plain loops that the compiler vectorises;
//! sixteen nodes make one of the next level. The leaves divide space along a curve, as evenly as
//! the bodies are when they are put in order; a body that moves goes to the leaf where it is then.

mod curve;
mod moves;
mod node;
mod search;

use crate::broad_phase::BodyBox;
use crate::count::short;
use curve::MortonOrder;
use node::{BoxNode, WIDTH, corners};
use parry3d::bounding_volume::Aabb;
pub(super) use search::TreeSearch;
use std::ops::Range;

/// Bodies in a leaf at first; the rest of it is room for those that come.
const FILLED: usize = 10;

/// Marks a body without a place, and a place without a body.
const NOWHERE: u32 = u32::MAX;

/// Boxes by slot; a body that does not exist in the slice has none.
#[derive(Clone, Debug, Default)]
pub(super) struct BoxTree {
    /// Place of each slot's body in the leaves: [`WIDTH`] for each node of the lowest level, one in each lane.
    index_of: Vec<u32>,
    /// Slot at each place.
    slot_at: Vec<u32>,
    /// The bodies' own boxes first, then those around each node of the level below; the highest
    /// has one node. Levels above it are spare memory.
    levels: Vec<Vec<BoxNode>>,
    height: usize,
    /// Beginning of each leaf on the curve.
    begins: Vec<u32>,
    curve: MortonOrder,
    /// True if the boxes around nodes are formed. Else they wait for [`fit`](Self::fit), and nobody searches.
    is_fitted: bool,
    /// Number of times that all bodies were put in order: names the current order.
    resort_count: u32,
    /// Cost of searches for free places since all bodies were put in order. If it grows beyond the number of places, all
    /// are put in order again.
    disorder: usize,
    sorted: Vec<(u32, BodyBox)>,
}

impl BoxTree {
    /// Replaces all boxes.
    pub(super) fn build(&mut self, boxes: &[BodyBox]) {
        self.sorted.clear();
        self.sorted.extend(boxes.iter().map(|body| (0, *body)));
        self.put_in_order();
    }

    /// Empties the tree and takes over the order of another: bodies can be moved to their places one by one, and
    /// the whole be [fitted](Self::fit) once they are there.
    pub(super) fn begin_like(&mut self, other: &Self) {
        self.take_all_out();
        self.slot_at.resize(other.slot_at.len(), NOWHERE);
        self.lay_levels(other.slot_at.len() / WIDTH);
        self.begins.clone_from(&other.begins);
        self.curve = other.curve;
        self.is_fitted = false;
        self.disorder = 0;
    }

    /// Fits every box around a node to what the node holds.
    pub(super) fn fit(&mut self) {
        for level in 1..self.height {
            for node in 0..self.levels[level - 1].len() {
                let around = self.levels[level - 1][node].around();
                self.levels[level][node / WIDTH].set(node % WIDTH, around);
            }
        }
        self.is_fitted = true;
    }

    /// Takes a body's box out, if it has one.
    pub(super) fn remove(&mut self, slot: u32) {
        if let Some(index) = self.index(slot) {
            self.vacate(index);
        }
    }

    /// Returns the number of leaves. What is in them stays there as long as
    /// [`resort_count`](Self::resort_count) stays the same, but for bodies that are moved, inserted or removed.
    pub(super) fn leaves(&self) -> usize {
        self.slot_at.len() / WIDTH
    }

    /// Returns how often all bodies were given other places.
    pub(super) const fn resort_count(&self) -> u32 {
        self.resort_count
    }

    /// Calls `visit` with the box of each body in some leaves.
    pub(super) fn each(&self, leaves: Range<usize>, mut visit: impl FnMut(BodyBox)) {
        for leaf in leaves {
            let slots = &self.slot_at[leaf * WIDTH..(leaf + 1) * WIDTH];
            for (lane, &body) in slots.iter().enumerate() {
                if body != NOWHERE {
                    let (low, high) = self.levels[0][leaf].get(lane);
                    let aabb = Aabb::new(low.into(), high.into());
                    visit(BodyBox { aabb, body });
                }
            }
        }
    }

    fn list_for_order(&mut self) {
        let mut sorted = std::mem::take(&mut self.sorted);
        sorted.clear();
        self.each(0..self.leaves(), |body| sorted.push((0, body)));
        self.sorted = sorted;
    }

    fn take_all_out(&mut self) {
        for slot in self.slot_at.drain(..).filter(|&slot| slot != NOWHERE) {
            self.index_of[slot as usize] = NOWHERE;
        }
    }

    /// Gives places to what is listed for it: near places to what is near in space.
    fn put_in_order(&mut self) {
        self.take_all_out();
        let mut sorted = std::mem::take(&mut self.sorted);
        self.curve = MortonOrder::through(&sorted);
        for (code, body) in &mut sorted {
            *code = self.curve.code(&body.aabb);
        }
        sorted.sort_unstable_by_key(|(code, body)| (*code, body.body));
        let leaves = sorted.len().div_ceil(FILLED).max(1);
        self.slot_at.resize(leaves * WIDTH, NOWHERE);
        self.lay_levels(leaves);
        self.begins.clear();
        for (leaf, bodies) in sorted.chunks(FILLED).enumerate() {
            self.begins.push(bodies[0].0);
            for (lane, (_, body)) in bodies.iter().enumerate() {
                self.occupy(leaf * WIDTH + lane, body);
            }
        }
        self.sorted = sorted;
        self.fit();
        self.disorder = 0;
        self.resort_count = self.resort_count.wrapping_add(1);
    }

    /// Lays empty levels above this many leaves.
    fn lay_levels(&mut self, leaves: usize) {
        let mut count = leaves;
        self.height = 0;
        loop {
            if self.height == self.levels.len() {
                self.levels.push(Vec::new());
            }
            let level = &mut self.levels[self.height];
            level.clear();
            level.resize(count, BoxNode::EMPTY);
            self.height += 1;
            if count == 1 {
                return;
            }
            count = count.div_ceil(WIDTH);
        }
    }

    fn occupy(&mut self, index: usize, body: &BodyBox) {
        let slot = body.body as usize;
        if self.index_of.len() <= slot {
            self.index_of.resize(slot + 1, NOWHERE);
        }
        self.index_of[slot] = short(index);
        self.slot_at[index] = body.body;
        self.levels[0][index / WIDTH].set(index % WIDTH, corners(&body.aabb));
    }

    #[inline(always)]
    fn index(&self, slot: u32) -> Option<usize> {
        let index = *self.index_of.get(slot as usize)?;
        (index != NOWHERE).then_some(index as usize)
    }

    /// Returns the leaf where a box belongs.
    #[inline(always)]
    fn leaf_of(&self, aabb: &Aabb) -> usize {
        let code = self.curve.code(aabb);
        let after = self.begins.partition_point(|&begin| begin <= code);
        after.saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn random_box(rng: &mut ChaCha8Rng) -> Aabb {
        let mut corner = || rng.random_range(-100.0..100.0_f32);
        let low = [corner(), corner(), corner()];
        let high = low.map(|low| low + rng.random_range(0.0..12.0_f32));
        Aabb::new(low.into(), high.into())
    }

    #[test]
    fn meets_what_a_plain_list_meets_whatever_was_changed() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut plain: Vec<Option<Aabb>> = vec![None; 1000];
        let (mut boxes, mut search) = (BoxTree::default(), TreeSearch::default());
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
            let mut moved = Vec::new();
            for _ in 0..300 {
                let slot = rng.random_range(0..plain.len());
                let new = rng.random_bool(0.8).then(|| random_box(&mut rng));
                plain[slot] = new;
                let (order, body) = (boxes.resort_count(), short(slot));
                let leaf = |boxes: &BoxTree, slot: u32| boxes.index(slot).map(|at| at / WIDTH);
                let leaves: Vec<_> = (0..1000).map(|slot| leaf(&boxes, slot)).collect();
                match new {
                    Some(aabb) if round % 3 == 0 => moved.push(BodyBox { aabb, body }),
                    Some(aabb) => boxes.move_to(&[BodyBox { aabb, body }]),
                    None => {
                        boxes.remove(body);
                        moved.retain(|boxed| boxed.body != body);
                    }
                }
                // Whoever goes through the leaves misses nobody, as long as the order is the same.
                let stayed = (0..1000)
                    .zip(leaves)
                    .all(|(other, before)| other == body || leaf(&boxes, other) == before);
                assert!(stayed || boxes.resort_count() != order);
                reordered += u32::from(!stayed);
            }
            let order = boxes.resort_count();
            boxes.move_to(&moved);
            reordered += boxes.resort_count() - order;
            for _ in 0..200 {
                let asked = random_box(&mut rng);
                let body = BodyBox {
                    aabb: asked,
                    body: 0,
                };
                let mut found = Vec::new();
                boxes.meeting(&[body], &mut search, |_, slot| found.push(slot));
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
        assert!(met > 500 && reordered > 2, "{met} {reordered}");
    }

    /// They would search through more and more full leaves for a place.
    #[test]
    fn many_that_come_to_one_place_are_put_in_order_soon() {
        const FEW: u32 = 2_000;
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut spread = |first: u32, place: f32| -> Vec<BodyBox> {
            let bodies = first..first + FEW;
            let boxes = bodies.map(|body| {
                let Aabb { mins, maxs } = random_box(&mut rng);
                let aabb = Aabb::new(mins + place, maxs + place);
                BodyBox { aabb, body }
            });
            boxes.collect()
        };
        let (few, come) = (spread(0, 0.0), spread(FEW, 1e6));
        let mut boxes = BoxTree::default();
        boxes.build(&few);
        let order = boxes.resort_count();
        boxes.move_to(&come);
        let sorted = boxes.resort_count() - order;
        assert!(sorted > 1, "{sorted}");
        let (mut search, mut met) = (TreeSearch::default(), 0);
        boxes.meeting(&come, &mut search, |own, slot| {
            met += usize::from(own.body == slot);
        });
        assert_eq!(met, come.len());
    }
}
