//! The choice between boxes sorted by groups and boxes sorted alone.

use super::sample::scattered;
use crate::broad_phase::{BodyBox, Groups, PairFilter};

/// The savings and the costs of sorting boxes by groups. Bodies of some groups form no pairs, and need not be compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grouping {
    /// Share of the pairs of boxes whose bodies are no pairs, 0..=1.
    excluded: f64,
    /// Mean number of groups that a box is compared with.
    partners: f64,
}

impl Grouping {
    /// Boxes whose groups are looked at.
    const SAMPLE: usize = 128;
    /// Nanoseconds to find the group of a box and to sort by it; to do that where boxes have been sorted without groups; for
    /// the list of its successors in a further group; for a comparison, with the work that follows; and for an overlap that is
    /// counted. Measured with 10,000 bodies that are told each frame. Only their ratios matter.
    const SORT: f64 = 3.5;
    const SORT_AGAIN: f64 = 12.0;
    const LIST: f64 = 4.5;
    const COMPARISON: f64 = 0.4;
    const OVERLAP: f64 = 3.0;

    /// Returns an estimate from a sample of the boxes; `None` if there is one group.
    pub(super) fn of(boxes: &[BodyBox], filter: &dyn PairFilter) -> Option<Self> {
        let groups = filter.groups();
        if groups.count() == 1 {
            return None;
        }
        let mut members = [0_u32; Groups::MAX];
        for place in scattered(Self::SAMPLE.min(boxes.len()), boxes.len()) {
            members[usize::from(filter.group(boxes[place].body))] += 1;
        }
        let all = f64::from(members.iter().sum::<u32>());
        let (mut admitted, mut partners) = (0.0, 0.0);
        for (one, &own) in members.iter().enumerate() {
            for (other, &others) in members.iter().enumerate() {
                if others > 0 && groups.admits(one, other) {
                    admitted += f64::from(own) * f64::from(others);
                    partners += f64::from(own);
                }
            }
        }
        Some(Self {
            excluded: 1.0 - admitted / (all * all),
            partners: partners / all,
        })
    }

    /// Returns true if sorting by groups saves more than it costs, at so many comparisons per box without groups.
    pub(super) fn pays(&self, comparisons: f64) -> bool {
        self.saved(comparisons, 0.0) > Self::SORT
    }

    /// Returns true if that pays where boxes have been sorted without groups, and have so many comparisons and overlaps each.
    pub(super) fn still_pays(&self, comparisons: f64, overlaps: f64) -> bool {
        self.saved(comparisons, overlaps) > Self::SORT_AGAIN
    }

    /// Returns the nanoseconds per box that are saved after sorting.
    fn saved(&self, comparisons: f64, overlaps: f64) -> f64 {
        self.excluded * (Self::COMPARISON * comparisons + Self::OVERLAP * overlaps)
            - Self::LIST * (self.partners - 1.0)
    }
}
