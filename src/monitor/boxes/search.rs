//! Search for the boxes of a tree that overlap others.

use super::node::corners;
use super::{BoxTree, WIDTH};
use crate::broad_phase::BodyBox;
use crate::simd::{InstructionSet, Task, prefetch};
use std::slice::from_ref;

/// Memory for searches: the nodes of one level, and of the next one down, that are to be searched. Each
/// comes after the number of the box that is asked about. Below the lowest level, the index of an overlapping
/// box stands for a node.
#[derive(Clone, Debug, Default)]
pub(in crate::monitor) struct TreeSearch {
    visits: Vec<(u32, u32)>,
    below: Vec<(u32, u32)>,
}

impl BoxTree {
    /// Calls `visit` with each of `boxes` and each slot whose box meets it (touching counts).
    pub(in crate::monitor) fn meeting(
        &self,
        boxes: &[BodyBox],
        search: &mut TreeSearch,
        visit: impl FnMut(&BodyBox, u32),
    ) {
        debug_assert!(self.is_fitted, "no way down yet");
        InstructionSet::best().run(Meet {
            tree: self,
            boxes,
            search,
            visit,
        });
    }
}

/// A search in which all boxes go down together, level by level. So the next nodes are known, and are
/// fetched before they are read.
struct Meet<'b, V> {
    tree: &'b BoxTree,
    boxes: &'b [BodyBox],
    search: &'b mut TreeSearch,
    visit: V,
}

impl<V> Meet<'_, V> {
    /// Nodes that are fetched ahead.
    const AHEAD: usize = 4;
}

impl<V: FnMut(&BodyBox, u32)> Task for Meet<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let TreeSearch { visits, below } = self.search;
        let all = (0..).zip(self.boxes);
        visits.clear();
        visits.extend(all.map(|(asked, _)| (asked, 0)));
        for level in self.tree.levels[..self.tree.height].iter().rev() {
            below.clear();
            for (number, &(asked, node)) in visits.iter().enumerate() {
                if let Some(later) = visits.get(number + Self::AHEAD) {
                    prefetch(from_ref(&level[later.1 as usize]));
                }
                let mut lanes =
                    level[node as usize].meeting(&corners(&self.boxes[asked as usize].aabb));
                while lanes != 0 {
                    let node = node * WIDTH_U32 + lanes.trailing_zeros();
                    below.push((asked, node));
                    lanes &= lanes - 1;
                }
            }
            std::mem::swap(visits, below);
        }
        if self.tree.height > 0 {
            for &(asked, node) in &*visits {
                let slot = self.tree.slot_at[node as usize];
                (self.visit)(&self.boxes[asked as usize], slot);
            }
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "it is 16")]
const WIDTH_U32: u32 = WIDTH as u32;
