//! Comparison of every box with every other.

use super::{BodyBox, BroadPhase, Candidate, PairFilter, emit};

/// Compares every box with every other: n (n - 1) / 2 tests.
///
/// The reference for the other methods, and the fastest one for a few dozen boxes.
#[derive(Clone, Copy, Debug, Default)]
pub struct BruteForce;

impl BroadPhase for BruteForce {
    fn pairs(
        &mut self,
        boxes: &[BodyBox],
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) {
        for (i, one) in boxes.iter().enumerate() {
            if filter.gives_up() {
                return;
            }
            for other in &boxes[i + 1..] {
                if one.meets(other) {
                    emit(one.body, other.body, filter, candidates);
                }
            }
        }
    }
}
