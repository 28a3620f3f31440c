//! Parts of a slice in which there are too many candidates.
//!
//! Long boxes of fast bodies meet many others that no body comes near. Halves of the slice have shorter
//! ones, and candidates shrink with the volume of boxes; until those are as large as hitboxes and the
//! margin: what meets then is a crowd.

use super::state::{Part, Scratch, Slice, Stage};
use crate::broad_phase::{BroadPhase, PairFilter, mean_size};
use crate::monitor::bodies::Bodies;

impl Slice {
    /// Compares all bodies in a part of the slice; returns how many boxes were formed.
    pub(super) fn compare_part<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        part: &Part,
        scratch: &mut Scratch,
    ) -> usize {
        let Scratch {
            listed,
            block,
            sweep,
            ..
        } = scratch;
        listed.clear();
        let (from, to) = part.interval;
        let slots = (0..bodies.flights.len()).filter_map(|slot| u32::try_from(slot).ok());
        bodies.boxes(slots, &[from, to], block, |_, boxed, _| listed.push(boxed));
        self.stats.boxes += listed.len() as u64;
        sweep.pairs(listed, filter, &mut self.candidates);
        listed.len()
    }

    /// Leaves a part, or all of the slice, to be compared in halves, or as a whole where these would cost
    /// more. Gives the slice up where there is no room for that, and halves have as many candidates.
    pub(super) fn divide(&mut self, part: Option<Part>, scratch: &Scratch) {
        /// Next to the boxes of the whole: a mean extent of halves that still lessens candidates, and a
        /// mean volume that pays for twice as many boxes.
        const LESS: f64 = 0.875;
        const PAYS: f64 = 0.5;
        let (from, to) = part.map_or(self.interval, |part| part.interval);
        let middle = 0.5 * from + 0.5 * to;
        let can_be_halved = from < middle && middle < to;
        let Some(part) = part else {
            // Parts are about all bodies as they are now.
            self.stats.slices += u64::from(self.stage != Stage::Built);
            self.stage = Stage::Built;
            self.forget_changes();
            self.is_crowded = !can_be_halved;
            self.halve((from, middle, to), (f64::INFINITY, f64::INFINITY));
            return;
        };
        let mean = mean_size(&scratch.listed);
        if can_be_halved && mean.1 < PAYS * part.mean.1 {
            self.halve((from, middle, to), mean);
        } else if !part.is_whole {
            self.parts.push(Part {
                is_whole: true,
                ..part
            });
        } else {
            self.is_crowded = !(can_be_halved && mean.0 < LESS * part.mean.0);
            self.halve((from, middle, to), mean);
        }
    }

    fn halve(&mut self, (from, middle, to): (f64, f64, f64), mean: (f64, f64)) {
        for interval in [(middle, to), (from, middle)] {
            self.parts.push(Part {
                interval,
                mean,
                is_whole: false,
            });
        }
    }
}
