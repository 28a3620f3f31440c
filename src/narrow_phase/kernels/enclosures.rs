//! Enclosures for many pairs: one split, then quarters, then branch and bound.

use super::batch::Lanes;
use super::dispatch::{enclose_block, enclose_block_finely};
use super::enclosure::{Enclosure, enclose_near};
use super::loops::{BLOCK, Block, Bounds};
use super::pending::Pending;
use crate::simd::InstructionSet;

/// The enclosure of the least distance of each pair, on one thread.
pub(super) fn enclosures(
    instructions: InstructionSet,
    lanes: &Lanes<'_, f64>,
    errors: &[f64],
    enclosures: &mut [Enclosure],
) {
    let mut block = Block::new();
    let mut pending = Pending::new();
    let mut bounds = Bounds::new();
    let mut start = 0;
    while start < lanes.len() {
        let end = (start + BLOCK).min(lanes.len());
        enclose_block(
            instructions,
            &mut block,
            &lanes.range(start, end),
            &errors[start..end],
            &mut bounds,
        );
        for (i, enclosure) in enclosures[start..end].iter_mut().enumerate() {
            *enclosure = bounds.enclosure(i);
        }
        for pair in start..end {
            if !bounds.is_tight(pair - start) {
                let time = enclosures[pair].time;
                pending.push(pair, lanes.control_points(pair), [errors[pair], time]);
                if pending.is_full() {
                    enclose_again(instructions, &mut pending, enclosures);
                }
            }
        }
        start = end;
    }
    enclose_again(instructions, &mut pending, enclosures);
}

/// Quarters for the pairs that are pending, and branch and bound for those still not tight.
fn enclose_again(
    instructions: InstructionSet,
    pending: &mut Pending<f64, 2>,
    enclosures: &mut [Enclosure],
) {
    if pending.is_empty() {
        return;
    }
    let mut bounds = Bounds::new();
    let lanes = pending.lanes();
    let [errors, times] = pending.extras();
    enclose_block_finely(instructions, &lanes, errors, times, &mut bounds);
    for i in 0..pending.len() {
        enclosures[pending.pair(i)] = if bounds.is_tight(i) {
            bounds.enclosure(i)
        } else {
            enclose_near(&pending.control_points(i), errors[i], times[i])
        };
    }
    pending.clear();
}

impl Bounds<f64> {
    #[inline]
    fn enclosure(&self, i: usize) -> Enclosure {
        Enclosure {
            low: self.lows[i],
            high: self.highs[i],
            time: self.times[i],
        }
    }

    /// Not where it is not a number.
    #[inline]
    fn is_tight(&self, i: usize) -> bool {
        self.tight[i] > 0.0
    }
}
