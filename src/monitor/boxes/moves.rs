//! Places of bodies in a tree: a body finds one or leaves one, and the nodes above follow.

use super::node::{Corners, EMPTY, WIDTH, corners, is_inside, merged};
use super::{BoxTree, NOWHERE};
use crate::broad_phase::BodyBox;
use crate::simd::{InstructionSet, Task, prefetch};
use std::slice::from_ref;

impl BoxTree {
    /// Replaces the boxes of some bodies, few of all: each finds the best place for it.
    pub(in crate::monitor) fn move_to(&mut self, boxes: &[BodyBox]) {
        /// Boxes that are moved before the order is looked at. Where many come to one place, each of them takes longer to
        /// find a free one.
        const STEP: usize = 64;
        for boxes in boxes.chunks(STEP) {
            InstructionSet::best().run(MoveBoxes { tree: self, boxes });
            self.keep_in_order();
        }
    }

    /// Puts all bodies in order again if there is too much disorder.
    fn keep_in_order(&mut self) {
        if self.disorder > self.slot_at.len() {
            self.list_for_order();
            self.put_in_order();
        }
    }

    /// Fetches a leaf.
    #[inline(always)]
    fn fetch(&self, leaf: usize) {
        if let Some(node) = self.levels.first().and_then(|level| level.get(leaf)) {
            prefetch(from_ref(node));
            prefetch(&self.slot_at[leaf * WIDTH..(leaf + 1) * WIDTH]);
        }
    }

    /// Sets one body's box, which belongs in a leaf.
    #[inline(always)]
    fn set(&mut self, leaf: usize, body: &BodyBox) {
        match self.index(body.body) {
            Some(index) if index / WIDTH == leaf => {
                let (node, lane, new) = (&mut self.levels[0][leaf], index % WIDTH, &body.aabb);
                let old = node.get(lane);
                node.set(lane, corners(new));
                self.grow(leaf, corners(new));
                self.shrink(leaf, old);
            }
            Some(index) => {
                self.vacate(index);
                self.insert(leaf, body);
            }
            None => self.insert(leaf, body),
        }
    }

    #[inline(always)]
    pub(super) fn vacate(&mut self, index: usize) {
        let slot = std::mem::replace(&mut self.slot_at[index], NOWHERE);
        self.index_of[slot as usize] = NOWHERE;
        let (node, lane) = (&mut self.levels[0][index / WIDTH], index % WIDTH);
        let old = node.get(lane);
        node.set(lane, EMPTY);
        self.shrink(index / WIDTH, old);
    }

    /// Gives a place to a body that has none: the nearest along the curve to the leaf where it
    /// belongs.
    fn insert(&mut self, first: usize, body: &BodyBox) {
        let leaves = self.leaves();
        for distance in 0..leaves.max(1) {
            let before = first.checked_sub(distance);
            let after = (distance > 0).then_some(first + distance);
            for leaf in before
                .into_iter()
                .chain(after)
                .filter(|&leaf| leaf < leaves)
            {
                let places = leaf * WIDTH..(leaf + 1) * WIDTH;
                let free = self.slot_at[places]
                    .iter()
                    .position(|&slot| slot == NOWHERE);
                if let Some(lane) = free {
                    self.occupy(leaf * WIDTH + lane, body);
                    self.grow(leaf, corners(&body.aabb));
                    return;
                }
                self.disorder += 1;
            }
        }
        self.list_for_order();
        self.sorted.push((0, *body));
        self.put_in_order();
    }

    /// Widens the boxes around a leaf to which a box came.
    #[inline(always)]
    fn grow(&mut self, leaf: usize, new: Corners) {
        if !self.is_fitted {
            return;
        }
        let mut node = leaf;
        for level in &mut self.levels[1..self.height] {
            let (parent, lane) = (&mut level[node / WIDTH], node % WIDTH);
            let around = parent.get(lane);
            let grown = merged(around, new);
            if grown == around {
                return;
            }
            parent.set(lane, grown);
            node /= WIDTH;
        }
    }

    /// Fits the boxes around a leaf that a box left, as far as they may have hung on it.
    #[inline(always)]
    fn shrink(&mut self, leaf: usize, mut old: Corners) {
        if !self.is_fitted {
            return;
        }
        let mut node = leaf;
        for level in 1..self.height {
            let around = self.levels[level][node / WIDTH].get(node % WIDTH);
            if is_inside(old, around) {
                return;
            }
            let fitted = self.levels[level - 1][node].around();
            if fitted == around {
                return;
            }
            self.levels[level][node / WIDTH].set(node % WIDTH, fitted);
            old = around;
            node /= WIDTH;
        }
    }
}

/// The move of some boxes, for [`BoxTree::move_to`].
struct MoveBoxes<'b> {
    tree: &'b mut BoxTree,
    boxes: &'b [BodyBox],
}

impl MoveBoxes<'_> {
    /// Boxes whose nodes are fetched together: they lie anywhere in memory.
    const BATCH: usize = 16;
}

impl Task for MoveBoxes<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let tree = self.tree;
        for boxes in self.boxes.chunks(Self::BATCH) {
            for body in boxes {
                if let Some(index) = tree.index_of.get(body.body as usize) {
                    prefetch(from_ref(index));
                }
            }
            let mut leaves = [0; Self::BATCH];
            for (leaf, body) in leaves.iter_mut().zip(boxes) {
                *leaf = tree.leaf_of(&body.aabb);
                let before = tree.index(body.body).map(|index| index / WIDTH);
                for leaf in before.into_iter().chain([*leaf]) {
                    tree.fetch(leaf);
                }
            }
            for (&leaf, body) in leaves.iter().zip(boxes) {
                tree.set(leaf, body);
            }
        }
    }
}
