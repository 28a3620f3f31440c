//! Every box against every other: the definition that the other methods are checked against.

use super::{BodyBox, BroadPhase, Candidate, PairFilter};
use parry3d::bounding_volume::BoundingVolume;

/// Exactly the pairs whose boxes meet, in quadratic time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BruteForce;

impl BroadPhase for BruteForce {
    fn pairs<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        filter: &F,
        candidates: &mut Vec<Candidate>,
    ) {
        for (k, one) in boxes.iter().enumerate() {
            for other in &boxes[k + 1..] {
                if one.aabb.intersects(&other.aabb) && filter.admits(one.body, other.body) {
                    candidates.push(Candidate::of(one.body, other.body));
                }
            }
        }
    }
}
