//! From slices to survivors: boxes, candidates, and cheap tests of their spans.

use super::line_up::LineUp;
use crate::bounds::{Pose, Stroke};
use crate::broad_phase::fill::{Block, Fill, Slice, short};
use crate::broad_phase::slices::{Slices, Traffic};
use crate::broad_phase::{BroadPhase, PairFilter, Room, mean_size};
use crate::error::Error;
use crate::narrow_phase::Party;
use crate::parallel;
use crate::search::{Arranger, Question, Scratch};
use crate::spans::SpanKey;
use crate::stats::Stats;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

/// How much of the work going through the slices is taken to be, when progress is told.
pub(super) const SHARE_OF_SLICES: f64 = 0.9;

/// Each body as the narrow phase takes it, and how it lies in the frame.
pub(super) type Bodies<'a> = (&'a [Party<'a>], &'a [Pose<'a, Stroke>]);

impl LineUp<'_> {
    /// Slices and cheap tests: every span of every pair in which they may touch, each once.
    ///
    /// # Errors
    ///
    /// [`Error::TooCrowded`].
    pub(super) fn survivors<B: BroadPhase, F: PairFilter>(
        &self,
        method: impl Fn(&mut Scratch) -> &mut B + Sync + Send,
        bodies: Bodies<'_>,
        (slices, blocks): (&Slices, &Blocks),
        filter: &F,
        progress: &(impl Fn(f64) + Sync),
        stats: &mut Stats,
    ) -> Result<Vec<SpanKey>, Error> {
        let (parties, _) = bodies;
        stats.slices = u64::from(slices.count());
        let done_blocks = AtomicU32::new(0);
        let mut survivors = Vec::new();
        let mut arranger = Arranger::default();
        let mut first = 0;
        while first < blocks.count {
            let round = blocks.round.min(blocks.count - first);
            let take = || self.pool.take();
            let results = parallel::map(round, 1, take, |scratch, block| {
                let range = blocks.range(first + block);
                let found = self.block(&method, bodies, slices, range, filter, scratch);
                let done = done_blocks.fetch_add(1, Ordering::Relaxed) + 1;
                progress(SHARE_OF_SLICES * f64::from(done) / f64::from(blocks.count));
                found
            });
            for result in results {
                let (found, counted) = result?;
                survivors.extend(found);
                *stats += counted;
            }
            let begin = Instant::now();
            arranger.tidy(&mut survivors, parties.len());
            self.check_room(survivors.len())?;
            stats.narrow_time += begin.elapsed();
            first += round;
        }
        Ok(survivors)
    }

    /// How slices are dealt out.
    pub(super) fn blocks(&self, traffic: &Traffic, slices: &Slices) -> Blocks {
        let present = traffic.present((self.window.start(), self.window.end()));
        let cubics = traffic.cubics_in(slices.length());
        Blocks::new((slices.count(), cubics), self.ids.len(), present)
    }

    fn check_room(&self, survivors: usize) -> Result<(), Error> {
        if survivors > self.max_spans {
            return Err(self.too_crowded());
        }
        Ok(())
    }

    fn too_crowded(&self) -> Error {
        Error::TooCrowded {
            limit: self.max_spans,
        }
    }

    /// The same of a few slices, beside how many were looked at.
    fn block<B: BroadPhase, F: PairFilter>(
        &self,
        method: impl Fn(&mut Scratch) -> &mut B,
        (parties, poses): Bodies<'_>,
        slices: &Slices,
        range: Range<u32>,
        filter: &F,
        scratch: &mut Scratch,
    ) -> Result<(Vec<SpanKey>, Stats), Error> {
        let mut stats = Stats::default();
        let mut survivors = Vec::new();
        let begin = Instant::now();
        let ends = slices.ends(range.clone());
        self.presence
            .list((ends[0], ends[ends.len() - 1]), &mut scratch.present);
        self.instructions.run(Fill {
            block: &mut scratch.block,
            frame: &self.frame,
            poses,
            present: &scratch.present,
            ends: &ends,
        });
        stats.bounds_time += begin.elapsed();
        // Taken out meanwhile, so that the method can be borrowed beside them.
        let block = std::mem::take(&mut scratch.block);
        let mut candidates = std::mem::take(&mut scratch.candidates);
        let mut counts = std::mem::take(&mut scratch.counts);
        let mut begin = Instant::now();
        let mut number = range.start;
        let mut crowded = Vec::new();
        for run in block.slices[..range.len()].chunks(slices_in_a_run(&block, range.len())) {
            candidates.clear();
            counts.clear();
            for slice in run {
                let first = candidates.len();
                let by_place = ByPlace {
                    bodies: &slice.bodies,
                    filter,
                };
                let room = Room::new(&by_place, self.room());
                method(scratch).pairs(&slice.boxes, &room, &mut candidates);
                if room.is_short() {
                    candidates.truncate(first);
                    crowded.push(number + short(counts.len()));
                }
                counts.push(candidates.len() - first);
                stats.boxes += slice.boxes.len() as u64;
            }
            let found = Instant::now();
            let mut rest = &candidates[..];
            for (slice, &count) in run.iter().zip(&counts) {
                let (these, others) = rest.split_at(count);
                let question = self.question((parties, poses), slice, slices.interval(number));
                stats.spans += scratch.sieve.sift(&question, these, &mut survivors);
                (rest, number) = (others, number + 1);
                self.make_room(&mut survivors, scratch)?;
            }
            stats.candidates += candidates.len() as u64;
            let sifted = Instant::now();
            stats.broad_time += found - begin;
            stats.narrow_time += sifted - found;
            begin = sifted;
        }
        for number in crowded {
            let halves = self.halves(slices.interval(number))?;
            let part = (halves, f64::INFINITY);
            let found = (&mut survivors, &mut stats);
            self.divide(&method, (parties, poses), part, filter, scratch, found)?;
        }
        (scratch.block, scratch.candidates, scratch.counts) = (block, candidates, counts);
        let begin = Instant::now();
        if survivors.len() > FEW_SURVIVORS {
            scratch.arranger.tidy(&mut survivors, parties.len());
        }
        stats.narrow_time += begin.elapsed();
        Ok((survivors, stats))
    }
}

impl LineUp<'_> {
    /// Candidates of a slice for which there is room: 32 MiB, unless more spans are allowed for.
    fn room(&self) -> u64 {
        const MAX_CANDIDATES: u64 = 1 << 22;
        MAX_CANDIDATES.max(self.max_spans as u64)
    }

    /// What is asked of the candidates of a slice.
    const fn question<'q>(
        &self,
        (parties, poses): Bodies<'q>,
        slice: &'q Slice,
        interval: (f64, f64),
    ) -> Question<'q> {
        Question {
            parties,
            poses,
            slice,
            interval,
            window: self.window,
            margin: self.margin,
            max_spans: self.max_spans,
        }
    }

    /// Keeps each survivor once where there are too many.
    fn make_room(&self, survivors: &mut Vec<SpanKey>, scratch: &mut Scratch) -> Result<(), Error> {
        if survivors.len() > self.max_spans {
            scratch.arranger.tidy(survivors, self.ids.len());
            self.check_room(survivors.len())?;
        }
        Ok(())
    }

    /// The ends of both halves of a part of a slice (s); an instant has none.
    fn halves(&self, (from, to): (f64, f64)) -> Result<[f64; 3], Error> {
        let middle = 0.5 * from + 0.5 * to;
        if from < middle && middle < to {
            Ok([from, middle, to])
        } else {
            Err(self.too_crowded())
        }
    }

    /// Looks at both halves of a part of a slice in which there are too many candidates, and in turn at
    /// theirs: candidates shrink with boxes, until these are as large as hitboxes and the margin. What meets
    /// then is a crowd. `before` is the mean extent of the boxes of the whole part.
    fn divide<B: BroadPhase, F: PairFilter>(
        &self,
        method: &impl Fn(&mut Scratch) -> &mut B,
        (parties, poses): Bodies<'_>,
        (ends, before): ([f64; 3], f64),
        filter: &F,
        scratch: &mut Scratch,
        (survivors, stats): (&mut Vec<SpanKey>, &mut Stats),
    ) -> Result<(), Error> {
        /// Boxes of halves that are nearly as large have as many candidates.
        const LESS: f64 = 0.875;
        let mut block = Block::default();
        self.instructions.run(Fill {
            block: &mut block,
            frame: &self.frame,
            poses,
            present: &scratch.present,
            ends: &ends,
        });
        for (slice, ends) in block.slices.iter().zip(ends.windows(2)) {
            let mut candidates = Vec::new();
            let by_place = ByPlace {
                bodies: &slice.bodies,
                filter,
            };
            let room = Room::new(&by_place, self.room());
            method(scratch).pairs(&slice.boxes, &room, &mut candidates);
            stats.boxes += slice.boxes.len() as u64;
            let interval = (ends[0], ends[1]);
            if room.is_short() {
                drop(candidates);
                let (extent, _) = mean_size(&slice.boxes);
                if extent >= LESS * before {
                    return Err(self.too_crowded());
                }
                let part = (self.halves(interval)?, extent);
                let found = (&mut *survivors, &mut *stats);
                self.divide(method, (parties, poses), part, filter, scratch, found)?;
                continue;
            }
            stats.candidates += candidates.len() as u64;
            let question = self.question((parties, poses), slice, interval);
            stats.spans += scratch.sieve.sift(&question, &candidates, survivors);
            self.make_room(survivors, scratch)?;
        }
        Ok(())
    }
}

/// How many of a block's slices are compared before what was found in them is sifted: as many as have
/// few boxes. Reading the clock takes as long as a few boxes.
fn slices_in_a_run(block: &Block, count: usize) -> usize {
    const BOXES: usize = 1024;
    let boxes = block.slices[..count].iter().map(|slice| slice.boxes.len());
    (BOXES * count / boxes.sum::<usize>().max(1)).max(1)
}

/// Slices dealt out in blocks of about equal size. What is found does not depend on it.
pub(super) struct Blocks {
    slices: u32,
    count: u32,
    /// Blocks after which what survived is put together: a span that lasts for many slices is then
    /// kept once.
    round: u32,
}

impl Blocks {
    /// At least this many for each of several threads to share, unless there are fewer boxes than
    /// this to share.
    const FEWEST: u32 = 2;
    const FEW_BOXES: u64 = 2048;
    /// With more slices in a block, a body's cubics are read less often, but the lists of boxes leave
    /// the caches: so many where slices hold less than one cubic of a body, and where they hold more.
    const FEW_SLICES: [usize; 2] = [4, 8];
    const CACHED_BOXES: f64 = 2048.0;
    /// Not more boxes in a block, which bounds its memory: 64 bytes each.
    const MAX_BOXES: usize = 1 << 20;
    /// Nor many more boxes in a round.
    const ROUND_BOXES: usize = 1 << 24;

    /// Of some slices with so many cubics of a body each, where that many bodies exist in all, and at a
    /// time on average.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "rounds towards zero, saturates"
    )]
    fn new((slices, cubics): (u32, f64), bodies: usize, present: f64) -> Self {
        let cached = (Self::CACHED_BOXES / present) as usize;
        let few = Self::FEW_SLICES[usize::from(cubics >= 1.0)];
        let fit = cached.clamp(few, Block::SLICES);
        let most = (Self::MAX_BOXES / bodies.max(1)).clamp(1, fit);
        let count = slices.div_ceil(u32::try_from(most).unwrap_or(u32::MAX));
        let threads = u32::try_from(parallel::threads()).unwrap_or(u32::MAX);
        let is_shared = threads > 1 && u64::from(slices) * bodies as u64 > Self::FEW_BOXES;
        let fewest = if is_shared {
            Self::FEWEST.saturating_mul(threads)
        } else {
            1
        };
        let round = Self::ROUND_BOXES / (most * bodies.max(1));
        Self {
            slices,
            count: count.max(fewest).min(slices),
            round: u32::try_from(round).unwrap_or(u32::MAX).max(16),
        }
    }

    fn range(&self, block: u32) -> Range<u32> {
        let cut = |block: u32| {
            let slice = u64::from(self.slices) * u64::from(block) / u64::from(self.count);
            u32::try_from(slice).unwrap_or(self.slices)
        };
        cut(block)..cut(block + 1)
    }
}

/// Not more of a block are left untidied until all blocks' are put together: 64 KiB.
const FEW_SURVIVORS: usize = 1 << 12;

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
