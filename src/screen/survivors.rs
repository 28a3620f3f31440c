//! From slices to survivors: boxes, candidates, and cheap tests of their spans.

use super::line_up::LineUp;
use super::sift::{Sieve, Survivor};
use crate::bounds::{Frame, Inflation};
use crate::broad_phase::slices::{Block, Fill, Slices};
use crate::broad_phase::{BroadPhase, Candidate, PairFilter};
use crate::narrow_phase::Party;
use crate::parallel;
use crate::simd::Level;
use crate::stats::Stats;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// What one thread reuses from slice to slice.
#[derive(Default)]
struct Scratch<B> {
    method: B,
    block: Block,
    candidates: Vec<Candidate>,
    sieve: Sieve,
}

impl LineUp<'_> {
    /// Slices and cheap tests: every span of every pair in which they may touch, each once.
    pub(super) fn survivors<B: BroadPhase, F: PairFilter>(
        &self,
        parties: &[Party<'_>],
        filter: &F,
        progress: &(impl Fn(f64) + Sync),
        stats: &mut Stats,
    ) -> Vec<Survivor> {
        let size = |party: &Party<'_>| Inflation::size(party.spheres, party.bounding, self.margin);
        let largest = parties.iter().map(size).fold(0.0, f64::max);
        let frame = Frame::around(self.extremes(parties), largest);
        let inflations: Vec<Inflation> = parties
            .iter()
            .map(|party| Inflation::of(party.spheres, party.bounding, self.margin, &frame))
            .collect();
        let slices = self.slices(parties, &inflations, &frame);
        stats.slices = u64::from(slices.count());
        let blocks = slices.count().div_ceil(Block::SLICES);
        let done_blocks = AtomicU32::new(0);
        let results = parallel::map(blocks, Scratch::<B>::default, |scratch, block| {
            let start = block * Block::SLICES;
            let range = start..(start + Block::SLICES).min(slices.count());
            let found = self.block(
                parties,
                &inflations,
                &frame,
                &slices,
                range,
                filter,
                scratch,
            );
            let done = done_blocks.fetch_add(1, Ordering::Relaxed) + 1;
            progress(f64::from(done) / f64::from(blocks));
            found
        });
        let mut survivors = Vec::new();
        for (found, counted) in results {
            survivors.extend(found);
            *stats += counted;
        }
        let begin = Instant::now();
        parallel::sort(&mut survivors, Survivor::cmp);
        survivors.dedup();
        stats.narrow_time += begin.elapsed();
        survivors
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "one stage's inputs, each of its own kind"
    )]
    fn block<B: BroadPhase, F: PairFilter>(
        &self,
        parties: &[Party<'_>],
        inflations: &[Inflation],
        frame: &Frame,
        slices: &Slices,
        range: std::ops::Range<u32>,
        filter: &F,
        scratch: &mut Scratch<B>,
    ) -> (Vec<Survivor>, Stats) {
        let mut stats = Stats::default();
        let mut survivors = Vec::new();
        let begin = Instant::now();
        let Scratch {
            method,
            block,
            candidates,
            sieve,
        } = scratch;
        Level::best().run(Fill {
            block: &mut *block,
            parties,
            inflations,
            frame,
            cuts: slices,
            range: range.clone(),
        });
        stats.bounds_time += begin.elapsed();
        for (number, slice) in range.zip(&block.slices) {
            let begin = Instant::now();
            candidates.clear();
            let admission = ByPlace {
                bodies: &slice.bodies,
                filter,
            };
            method.pairs(&slice.boxes, &admission, candidates);
            let found = Instant::now();
            let at = (slice, slices.interval(number));
            stats.spans += sieve.sift(parties, at, candidates, self.margin, &mut survivors);
            stats.boxes += slice.boxes.len() as u64;
            stats.candidates += candidates.len() as u64;
            stats.broad_time += found - begin;
            stats.narrow_time += found.elapsed();
        }
        (survivors, stats)
    }
}

/// A filter of bodies asked about their places in a slice.
struct ByPlace<'a, F> {
    bodies: &'a [u32],
    filter: &'a F,
}

impl<F: PairFilter> PairFilter for ByPlace<'_, F> {
    #[inline]
    fn admits(&self, a: u32, b: u32) -> bool {
        // Bodies ascend with places: they are in the same order.
        self.filter
            .admits(self.bodies[a as usize], self.bodies[b as usize])
    }
}
