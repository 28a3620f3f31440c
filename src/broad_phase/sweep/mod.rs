//! A packed sweep over boxes sorted into rows.
//!
//! Boxes become 16 bytes each: six faces on a 16-bit grid (`scale`) and the place they are sorted
//! to. A counting sort (`rows`) puts a copy of each into every row it reaches over two axes, by
//! fine bins of the third (`plan` says which and how many). Each record is compared with the run
//! that follows it in its row, 16 at a time (`run`); what meets on the grid is tested again with
//! the boxes themselves, so the pairs are exactly those that meet.
//!
//! A sample of the boxes (`survey`) chooses the grid; no size of world or cell is asked for. What
//! one grid does not serve is divided first (`parts`): clusters with much empty space between
//! them, and what turns out to be compared mostly in vain. Few boxes, and boxes that nearly all
//! meet, are compared directly.

mod compare_all;
mod layout;
mod partition;
mod quantizer;
mod region;
mod rows;
mod run;
mod sample;

use self::compare_all::{BoxesSoA, CompareAll};
use self::layout::{BoxStatistics, GridLayout};
use self::partition::Partition;
use self::quantizer::Quantizer;
use self::region::Region;
use self::rows::{SortIntoRows, SortedRows};
use self::run::SweepRows;
use self::sample::BoxSample;
use super::{BodyBox, BroadPhase, Candidate, PairFilter};
use crate::simd::InstructionSet;

/// Sorts boxes on a 16-bit grid into rows and sweeps along them: the method for everything.
///
/// At even density the time is about linear in the number of boxes; where nearly all boxes meet,
/// all are compared. Scratch is kept from slice to slice, so that a steady scene allocates nothing:
/// 40 to 130 bytes a box in the scenes measured, and by the limits on copies never more than 1 KiB
/// a box of the largest slice so far.
#[derive(Clone, Debug)]
pub struct Sweep {
    instructions: InstructionSet,
    survey: BoxSample,
    rows: SortedRows,
    faces: BoxesSoA,
    /// The boxes divided at each depth.
    parts: Vec<Partition>,
    /// Number of copies that dividing may still make in this slice.
    copies_left: usize,
}

impl Sweep {
    /// Fewer boxes are compared directly.
    const FEW: usize = 128;
    /// More boxes are compared directly too: their copies could not be counted in 32 bits.
    const MAX: usize = 1 << 28;
    /// Dividing makes no more copies in a slice than this many times its boxes.
    const MAX_COPIES: usize = 8;
    /// Comparisons a box from which it is asked whether they are in vain: what they cost is then
    /// twice what dividing costs.
    const LONG_RUNS: f64 = 256.0;
    /// In vain if a smaller share of the boxes that are compared meet.
    const IN_VAIN: f64 = 1.0 / 16.0;
    /// Crowded if a larger share of all pairs meet: then nothing beats comparing all.
    const CROWDED: f64 = 1.0 / 4.0;

    /// A sweep with an instruction set. All sets find the same pairs in the same order.
    #[must_use]
    pub fn with_instruction_set(instructions: InstructionSet) -> Self {
        Self {
            instructions,
            survey: BoxSample::default(),
            rows: SortedRows::default(),
            faces: BoxesSoA::default(),
            parts: Vec::new(),
            copies_left: 0,
        }
    }

    /// Returns the sweep with another instruction set.
    pub(crate) const fn at(&mut self, instructions: InstructionSet) -> &mut Self {
        self.instructions = instructions;
        self
    }

    /// Appends the pairs of boxes that belong to a region.
    fn find<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        region: Region,
        depth: usize,
        filter: &F,
        candidates: &mut Vec<Candidate>,
    ) {
        if boxes.len() < Self::FEW || boxes.len() > Self::MAX {
            return self.compare_all(boxes, &region, filter, candidates);
        }
        self.survey.take(boxes, &region);
        if depth == self.parts.len() {
            self.parts.push(Partition::default());
        }
        let parts = &mut self.parts[depth];
        if self.survey.cut_at_gaps(&mut parts.cuts) && parts.divide(boxes, &mut self.copies_left) {
            return self.find_in_parts(region, depth, filter, candidates);
        }
        let scale = Quantizer::new(self.survey.ranges());
        let plan = GridLayout::choose(&BoxStatistics {
            count: boxes.len(),
            extents: self.survey.shares(),
        });
        let comparisons = self.instructions.run(SortIntoRows {
            boxes,
            scale: &scale,
            plan,
            rows: &mut self.rows,
        });
        let (comparisons, count) = (comparisons as f64, boxes.len() as f64);
        let pairs = 0.5 * count * count;
        let long = comparisons > Self::LONG_RUNS * count;
        if long || comparisons > 0.5 * pairs {
            let share = self.rows.probe(boxes).share();
            if share * comparisons > Self::CROWDED * pairs {
                return self.compare_all(boxes, &region, filter, candidates);
            }
            if long && share < Self::IN_VAIN {
                let parts = &mut self.parts[depth];
                self.survey.cut_evenly(&mut parts.cuts);
                if parts.divide(boxes, &mut self.copies_left) {
                    return self.find_in_parts(region, depth, filter, candidates);
                }
            }
        }
        self.instructions.run(SweepRows {
            boxes,
            rows: &self.rows,
            region: (depth > 0).then_some(&region),
            filter,
            candidates,
        });
    }

    /// Appends the pairs of boxes that belong to a region, each compared with each.
    fn compare_all<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        region: &Region,
        filter: &F,
        candidates: &mut Vec<Candidate>,
    ) {
        self.instructions.run(CompareAll {
            boxes,
            region,
            faces: &mut self.faces,
            filter,
            candidates,
        });
    }

    /// Appends the pairs of the boxes divided at a depth.
    fn find_in_parts<F: PairFilter>(
        &mut self,
        region: Region,
        depth: usize,
        filter: &F,
        candidates: &mut Vec<Candidate>,
    ) {
        // Taken out meanwhile: what is below uses the scratch of further depths.
        let parts = std::mem::take(&mut self.parts[depth]);
        for (boxes, region) in parts.iter(region) {
            self.find(boxes, region, depth + 1, filter, candidates);
        }
        self.parts[depth] = parts;
    }
}

impl Default for Sweep {
    /// With the instructions of this processor.
    fn default() -> Self {
        Self::with_instruction_set(InstructionSet::best())
    }
}

impl BroadPhase for Sweep {
    fn pairs<F: PairFilter>(
        &mut self,
        boxes: &[BodyBox],
        filter: &F,
        candidates: &mut Vec<Candidate>,
    ) {
        self.copies_left = Self::MAX_COPIES * boxes.len();
        self.find(boxes, Region::EVERYWHERE, 0, filter, candidates);
    }
}
