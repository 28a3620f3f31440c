//! Pairs of bodies that are never screened.

use crate::id::BodyId;
use std::collections::BTreeSet;

/// A set of pairs, each in both orders, so that the pairs of one body are adjacent.
#[derive(Clone, Debug, Default)]
pub(crate) struct IgnoredPairs(BTreeSet<(BodyId, BodyId)>);

impl IgnoredPairs {
    pub(super) fn insert(&mut self, (a, b): (BodyId, BodyId)) {
        self.0.extend([(a, b), (b, a)]);
    }

    pub(super) fn remove(&mut self, (a, b): (BodyId, BodyId)) {
        self.0.remove(&(a, b));
        self.0.remove(&(b, a));
    }

    pub(super) fn forget(&mut self, id: BodyId) {
        let pairs = self.0.range((id, BodyId::FIRST)..=(id, BodyId::LAST));
        let others: Vec<BodyId> = pairs.map(|&(_, other)| other).collect();
        for other in others {
            self.remove((id, other));
        }
    }

    pub(super) fn contains(&self, a: BodyId, b: BodyId) -> bool {
        self.0.contains(&(a, b))
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns each pair once, smaller id first.
    pub(super) fn iter(&self) -> impl Iterator<Item = (BodyId, BodyId)> {
        self.0.iter().copied().filter(|(a, b)| a < b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn equals_a_plain_set_of_pairs() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let (mut ignored, mut plain) = (IgnoredPairs::default(), BTreeSet::new());
        let mut most = 0;
        for _ in 0..3_000 {
            let mut any = || BodyId {
                slot: [0, 1, 2, 3, 4, 5, u32::MAX - 1, u32::MAX][rng.random_range(0..8)],
                generation: [0, 1, u32::MAX][rng.random_range(0..3)],
            };
            let (a, b) = (any(), any());
            if a == b {
                ignored.forget(a);
                plain.retain(|&(x, y)| x != a && y != a);
            } else if rng.random_range(0..3) == 0 {
                ignored.remove((a, b));
                plain.remove(&(a.min(b), a.max(b)));
            } else {
                ignored.insert((a, b));
                plain.insert((a.min(b), a.max(b)));
            }
            assert!(ignored.iter().eq(plain.iter().copied()));
            assert_eq!(ignored.is_empty(), plain.is_empty());
            assert_eq!(
                ignored.contains(b, a),
                plain.contains(&(a.min(b), a.max(b)))
            );
            most = most.max(plain.len());
        }
        assert!(most > 30, "{most}");
    }
}
