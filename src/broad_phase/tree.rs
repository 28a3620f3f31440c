//! parry's bounding volume hierarchy, rebuilt for each slice.

use std::fmt;

use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

use super::{BodyBox, BroadPhase, Candidate, PairFilter, emit};

/// Finds pairs with a [`Bvh`] built for each slice: n log n, whatever the shape of the scene.
///
/// A rebuild was measured faster than updating the last slice's tree and querying it, since all
/// boxes move. parry allocates the tree on each call.
#[derive(Default)]
pub struct Tree {
    workspace: BvhWorkspace,
}

impl fmt::Debug for Tree {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Tree").finish_non_exhaustive()
    }
}

impl BroadPhase for Tree {
    fn pairs(
        &mut self,
        boxes: &[BodyBox],
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) {
        // Leaves are numbered by position: parry needs dense ids, and 0 and 1 where there are no
        // more than two.
        let leaves = boxes.iter().map(|one| thickened(&one.aabb)).enumerate();
        let tree = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |i, j| {
            let (one, other) = (&boxes[i as usize], &boxes[j as usize]);
            if one.meets(other) && !filter.gives_up() {
                emit(one.body, other.body, filter, candidates);
            }
        });
    }
}

/// Returns a box around the given one, at least an eighth as thick as long on every axis.
///
/// parry splits nodes by their volume, so flat boxes make trees several times deeper. Pairs found
/// only by the thicker leaves are removed by a test of the boxes themselves.
fn thickened(aabb: &Aabb) -> Aabb {
    let largest = Vector::splat(f32::MAX);
    // Halved first: the difference of two finite corners may be infinite.
    let half = 0.5 * aabb.maxs - 0.5 * aabb.mins;
    let missing = (Vector::splat(0.125 * half.max_element()) - half).max(Vector::ZERO);
    Aabb::new(
        (aabb.mins - missing).max(-largest),
        (aabb.maxs + missing).min(largest),
    )
}
