//! The loops of `loops.rs`, compiled for each instruction set.

use super::batch::Lanes;
use super::cubic::ControlPoints;
use super::guess::Guess;
use super::loops::{self, EnclosureBlock, LaneBlock};
use super::screen::Verdict;
use crate::real::Real;
use crate::simd::{InstructionSet, for_each_instruction_set};

for_each_instruction_set! {
    /// Guesses the closest approach of one pair.
    guess_pair<R: Real>(points: &ControlPoints<R>) -> Guess<R>
}

for_each_instruction_set! {
    /// Guesses the closest approach of each pair of a block.
    guess_block<R: Real>(
        block: &mut LaneBlock<R>,
        lanes: &Lanes<'_, R>,
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [f32],
    )
}

for_each_instruction_set! {
    /// Guesses again from the first guesses of a block, and proves against the rival.
    guess_block_again<R: Real>(
        block: &mut LaneBlock<R>,
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [f32],
    )
}

for_each_instruction_set! {
    /// Encloses the least distance of each pair of a block, from one split at the guess.
    enclose_block(
        block: &mut LaneBlock<f64>,
        lanes: &Lanes<'_, f64>,
        errors: &[f64],
        bounds: &mut EnclosureBlock,
    )
}

for_each_instruction_set! {
    /// Encloses the least distance of each pair of a block, from a split at given times and
    /// quarters of both sides.
    enclose_block_finely(
        lanes: &Lanes<'_, f64>,
        errors: &[f64],
        times: &[f64],
        bounds: &mut EnclosureBlock,
    )
}

for_each_instruction_set! {
    /// Screens each pair of a block on the halves of its span.
    screen_block<R: Real>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], verdicts: &mut [Verdict])
}

for_each_instruction_set! {
    /// Screens each pair of a block on the eighths of its span.
    screen_block_finely<R: Real>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], verdicts: &mut [Verdict])
}
