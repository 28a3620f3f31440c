//! A packed sweep over boxes sorted into rows.
//!
//! Boxes become 16 bytes each: six faces on a 16-bit grid (`quantizer`) and the cell they are
//! sorted to. A counting sort (`rows`) copies each into every row it reaches over two axes, by fine
//! bins of the third (`layout` chooses these numbers), and by groups where that pays (`grouping`).
//! Each record is compared with its successors in its row, in each group that its own may
//! form pairs with, 16 at a time (`row_sweep`). Overlaps on the grid are tested again with the boxes
//! themselves, so the pairs are exact.
//!
//! The grid is chosen from a `sample` of the boxes; nothing has to be configured. Box sets that one
//! grid serves badly are divided first (`partition`): distant clusters, and sets in which most
//! comparisons fail. Few boxes are compared directly.

mod compare_all;
mod copies;
mod grouping;
mod layout;
mod partition;
mod quantizer;
mod region;
mod row_sweep;
mod rows;
mod sample;

use self::compare_all::CompareAll;
use self::grouping::Grouping;
use self::layout::RowLayout;
use self::partition::Partition;
use self::quantizer::Quantizer;
use self::region::Region;
use self::row_sweep::SweepRows;
use self::rows::{SortIntoRows, SortedRows};
use self::sample::BoxSample;
use super::{BodyBox, BroadPhase, Candidate, Groups, PairFilter};
use crate::count::short;
use crate::parallel;
use crate::simd::InstructionSet;
use std::ops::Range;

/// Sorts boxes on a 16-bit grid into rows and sweeps along them: the default method.
///
/// At even density the time is about linear in the number of boxes; if nearly all boxes overlap,
/// nearly all pairs are compared. Buffers are reused from slice to slice, so a steady scene allocates
/// nothing. They take 40 to 130 bytes a box in the scenes measured, and never more than 1 KiB a box
/// of the largest slice so far, 2 KiB where bodies are of several groups.
#[derive(Clone, Debug)]
pub struct Sweep {
    instructions: InstructionSet,
    sample: BoxSample,
    rows: SortedRows,
    /// The group of each box, if the rows are sorted by groups.
    group_of: Vec<u8>,
    /// Memory of comparisons of all boxes.
    faces: [[Vec<f32>; 3]; 2],
    /// Divided boxes, by depth.
    partitions: Vec<Partition>,
    /// Number of copies that dividing may still make in this slice.
    copies_left: usize,
    /// Candidates found by several threads, in the order of the lists of successors.
    chunks: Vec<Vec<Candidate>>,
}

impl Sweep {
    /// Number of boxes below which all are compared directly.
    const FEW: usize = 256;
    /// Number of boxes from which several threads share the sweep of one slice.
    const SHARED: usize = 1 << 15;
    /// Number of boxes above which all are compared directly, too: their copies could not be counted in 32 bits.
    const MAX: usize = 1 << 28;
    /// Largest number of copies by dividing in a slice, per box.
    const MAX_COPIES: usize = 8;
    /// Comparisons per box from which the hit rate is measured: twice the cost of dividing.
    const MANY_COMPARISONS: f64 = 256.0;
    /// Hit rate below which boxes are divided.
    const IN_VAIN: f64 = 1.0 / 16.0;

    /// Returns a sweep with an instruction set. All sets find the same pairs in the same order.
    #[must_use]
    pub fn with_instruction_set(instructions: InstructionSet) -> Self {
        Self {
            instructions,
            sample: BoxSample::default(),
            rows: SortedRows::default(),
            group_of: Vec::new(),
            faces: Default::default(),
            partitions: Vec::new(),
            copies_left: 0,
            chunks: Vec::new(),
        }
    }

    /// Sets the instruction set, and returns the sweep.
    pub(crate) const fn set_instruction_set(&mut self, instructions: InstructionSet) -> &mut Self {
        self.instructions = instructions;
        self
    }

    /// Appends the pairs of boxes that belong to a region.
    fn find(
        &mut self,
        boxes: &[BodyBox],
        region: Region,
        depth: usize,
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) {
        if boxes.len() < Self::FEW || boxes.len() > Self::MAX {
            return self.instructions.run(CompareAll {
                boxes,
                region: &region,
                faces: &mut self.faces,
                filter,
                candidates,
            });
        }
        self.sample.take(boxes, &region);
        if depth == self.partitions.len() {
            self.partitions.push(Partition::default());
        }
        let partition = &mut self.partitions[depth];
        if self.sample.set_planes_at_gaps(partition)
            && partition.divide(boxes, &mut self.copies_left)
        {
            return self.find_in_parts(region, depth, filter, candidates);
        }
        let layout = RowLayout::choose(boxes.len(), self.sample.shares);
        let comparisons = self.sort(boxes, layout, filter);
        let are_many = comparisons as f64 > Self::MANY_COMPARISONS * boxes.len() as f64;
        if are_many && self.rows.hit_rate(boxes) < Self::IN_VAIN {
            let partition = &mut self.partitions[depth];
            self.sample.set_planes_evenly(partition);
            if partition.divide(boxes, &mut self.copies_left) {
                return self.find_in_parts(region, depth, filter, candidates);
            }
        }
        let region = (depth > 0).then_some(&region);
        self.sweep_rows(boxes, region, filter, candidates);
    }

    /// Sorts boxes into rows, and by their groups where that pays; returns the number of comparisons that a sweep makes.
    fn sort(&mut self, boxes: &[BodyBox], layout: RowLayout, filter: &dyn PairFilter) -> u64 {
        let quantizer = Quantizer::new(self.sample.ranges);
        let count = boxes.len() as f64;
        let Self {
            instructions,
            rows,
            group_of,
            ..
        } = self;
        let sort_by = |groups: Groups, group_of: &[u8], rows: &mut SortedRows| {
            instructions.run(SortIntoRows {
                boxes,
                groups,
                group_of,
                quantizer: &quantizer,
                layout: RowLayout {
                    groups: short(groups.count()),
                    ..layout
                },
                rows,
            })
        };
        let grouping = Grouping::of(boxes, filter);
        if grouping.is_none_or(|grouping| !grouping.pays(layout.comparisons / count)) {
            let comparisons = sort_by(Groups::ONE, &[], rows);
            // More, where the layout did not foresee a crowd.
            let pays_now = |grouping: Grouping| {
                let made = comparisons as f64 / count;
                grouping.still_pays(made, made * rows.hit_rate(boxes))
            };
            if !grouping.is_some_and(pays_now) {
                return comparisons;
            }
        }
        group_of.clear();
        group_of.extend(boxes.iter().map(|one| filter.group(one.body)));
        sort_by(filter.groups(), group_of, rows)
    }

    /// Appends the pairs of boxes that are sorted into rows; several threads share many of them.
    fn sweep_rows(
        &mut self,
        boxes: &[BodyBox],
        region: Option<&Region>,
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) {
        let Self {
            instructions,
            rows,
            chunks,
            ..
        } = self;
        let all = rows.lists();
        let sweep = |lists: Range<usize>, candidates: &mut Vec<Candidate>| {
            instructions.run(SweepRows {
                boxes,
                rows,
                lists,
                region,
                filter,
                candidates,
            });
        };
        let threads = parallel::threads();
        if threads == 1 || boxes.len() < Self::SHARED {
            return sweep(0..all, candidates);
        }
        // Rows differ in length.
        let size = all.div_ceil(4 * threads).max(1);
        chunks.resize_with(all.div_ceil(size), Vec::new);
        parallel::for_each(chunks, |number, found| {
            let first = number * size;
            sweep(first..all.min(first + size), found);
        });
        for found in chunks {
            candidates.append(found);
        }
    }

    /// Appends the pairs of the boxes divided at a depth.
    fn find_in_parts(
        &mut self,
        region: Region,
        depth: usize,
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) {
        // Taken out meanwhile: what is below uses the scratch of further depths.
        let partition = std::mem::take(&mut self.partitions[depth]);
        for (boxes, region) in partition.iter(region) {
            self.find(boxes, region, depth + 1, filter, candidates);
        }
        self.partitions[depth] = partition;
    }
}

impl Default for Sweep {
    /// Returns a sweep with this processor's best instructions.
    fn default() -> Self {
        Self::with_instruction_set(InstructionSet::best())
    }
}

impl BroadPhase for Sweep {
    fn pairs(
        &mut self,
        boxes: &[BodyBox],
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) {
        self.copies_left = Self::MAX_COPIES * boxes.len();
        self.find(boxes, Region::EVERYWHERE, 0, filter, candidates);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CandidateLimit, Everyone};
    use super::*;
    use crate::count::short;
    use parry3d::bounding_volume::Aabb;
    use parry3d::math::Vector;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Several threads find the same candidates in the same order, and count all of them.
    #[test]
    fn a_shared_sweep_equals_that_of_one_thread() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let count = short(Sweep::SHARED + 777);
        let boxes: Vec<BodyBox> = (0..count)
            .map(|body| {
                let low = Vector::from_array([0; 3].map(|_| rng.random_range(-99.0_f32..99.0)));
                let aabb = Aabb::new(low, low + 2.0);
                BodyBox { aabb, body }
            })
            .collect();
        let pairs = |threads: usize, most: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.unwrap_or_else(|error| unreachable!("{error}"));
            pool.install(|| {
                let (mut sweep, mut found) = (Sweep::default(), Vec::new());
                let mut is_exceeded = false;
                for _ in 0..2 {
                    found.clear();
                    let room = CandidateLimit::new(&Everyone, most);
                    sweep.pairs(&boxes, &room, &mut found);
                    is_exceeded = room.is_exceeded();
                }
                (found, is_exceeded)
            })
        };
        let (alone, _) = pairs(1, u64::MAX);
        let count = alone.len() as u64;
        assert!(count > 1_000, "{count}");
        for threads in [2, 3] {
            assert_eq!(pairs(threads, count), (alone.clone(), false), "{threads}");
            assert!(pairs(threads, count - 1).1, "{threads}");
        }
    }
}
