//! The loops of `loops.rs`, compiled for each instruction set.

use super::batch::Lanes;
use super::loops::{self, Block, Bounds};
use super::real::Real;
use crate::simd::{Level, for_each_level};

for_each_level! {
    /// Guesses the closest approach of each pair of a block.
    guess_block<R: Real, const HALF: usize, const PIECES: usize>(
        block: &mut Block<R>,
        lanes: &Lanes<'_, R>,
        times: &mut [R],
        distances: &mut [R],
        certificates: &mut [R],
    )
}

for_each_level! {
    /// Encloses the least distance of each pair of a block, from one split at the guess.
    enclose_block<R: Real>(
        block: &mut Block<R>,
        lanes: &Lanes<'_, R>,
        errors: &[R],
        bounds: &mut Bounds<R>,
    )
}

for_each_level! {
    /// Encloses the least distance of each pair of a block, from a split at given times and
    /// quarters of both sides.
    enclose_block_finely<R: Real>(
        lanes: &Lanes<'_, R>,
        errors: &[R],
        times: &[R],
        bounds: &mut Bounds<R>,
    )
}

for_each_level! {
    /// Screens each pair of a block on the halves of its span.
    screen_block<R: Real>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], findings: &mut [R])
}

for_each_level! {
    /// Screens each pair of a block on the eighths of its span.
    screen_block_finely<R: Real>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], findings: &mut [R])
}
