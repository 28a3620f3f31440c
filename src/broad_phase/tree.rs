//! parry3d's bounding volume hierarchy, built anew for each slice.

use super::{BodyBox, BroadPhase, BruteForce, Candidate, PairFilter};
use parry3d::bounding_volume::BoundingVolume;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

/// Exactly the pairs whose boxes meet, by a tree over the boxes of the slice.
#[derive(Default)]
pub(crate) struct Tree {
    workspace: BvhWorkspace,
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tree").finish_non_exhaustive()
    }
}

/// Below this a tree costs more than it saves (and parry's builds treat one and two leaves
/// differently).
const FEWEST_LEAVES: usize = 8;

impl BroadPhase for Tree {
    fn pairs<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        filter: &F,
        candidates: &mut Vec<Candidate>,
    ) {
        if boxes.len() < FEWEST_LEAVES {
            return BruteForce.pairs(boxes, filter, candidates);
        }
        // Leaves are numbered by their place in the slice: parry's ids are dense.
        let leaves = boxes.iter().map(|body| body.aabb).enumerate();
        let tree = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |x, y| {
            let (one, other) = (&boxes[x as usize], &boxes[y as usize]);
            // The tree's own boxes may be wider than the leaves were.
            if one.aabb.intersects(&other.aabb) && filter.admits(one.body, other.body) {
                candidates.push(Candidate::of(one.body, other.body));
            }
        });
    }
}
