//! Search of a whole window: boxes, candidates, and the spans that cheap tests leave.

use super::body_walk::SLICES_AT_A_TIME;
use super::by_place::ByPlace;
use super::form::{SliceBlock, SliceBounds};
use super::form_slices::SlicesToForm;
use super::lifetimes::list_present;
use super::{
    BoxedBodies, LimitExceeded, Limits, RefineContext, SceneStatistics, SearchScratch, TimeSlices,
};
use crate::bounds::MovingFrame;
use crate::broad_phase::{Candidate, CandidateLimit, Method, Methods, PairFilter};
use crate::count::{short, whole};
use crate::parallel;
use crate::pool::Pool;
use crate::simd::InstructionSet;
use crate::spans::SpanKey;
use crate::stats::Stats;
use crate::wall_clock::Instant;
use crate::window::Window;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Bodies, with the query about them in a window.
#[derive(Debug)]
pub(crate) struct WindowSearch<'a, B> {
    pub(crate) bodies: B,
    /// First and last instant of each body, s.
    pub(crate) lifetimes: &'a [(f64, f64)],
    pub(crate) frame: &'a MovingFrame,
    pub(crate) window: Window,
    pub(crate) margin: f64,
    pub(crate) limits: Limits,
    pub(crate) method: Method,
    pub(crate) instructions: InstructionSet,
    pub(crate) pool: &'a Pool<SearchScratch>,
    /// Threads that share the work.
    pub(crate) threads: usize,
}

/// A slice, or a part of one.
#[derive(Clone, Copy)]
pub(super) struct SlicePart<'a> {
    /// s.
    pub(super) interval: (f64, f64),
    pub(super) bounds: &'a SliceBounds,
    /// The frame of the bounds.
    pub(super) frame: &'a MovingFrame,
}

impl<S: BoxedBodies> WindowSearch<'_, S> {
    /// Appends every span in which a pair may be in contact within some slices to `found`, then
    /// sorts it and removes duplicates. `progress` gets the share of slices done. If the filter
    /// gives up, spans may be missing.
    ///
    /// # Errors
    ///
    /// [`LimitExceeded`] for more spans, or more candidates at an instant, than the limits.
    pub(crate) fn spans(
        &self,
        (slices, statistics): (&TimeSlices<'_>, &SceneStatistics),
        filter: &dyn PairFilter,
        progress: &(impl Fn(f64) + Sync),
        (found, stats): (&mut Vec<SpanKey>, &mut Stats),
    ) -> Result<(), LimitExceeded> {
        let bodies = self.lifetimes.len();
        let are_shared = S::ARE_SHARED && bodies > SlicesToForm::CHUNK;
        let blocks = SliceBlocks::of(slices, statistics, (bodies, self.threads, are_shared));
        let done_blocks = AtomicU32::new(0);
        let is_exceeded = AtomicBool::new(false);
        let search = |scratch: &mut SearchScratch, block: u32| {
            if is_exceeded.load(Ordering::Relaxed) {
                return Err(LimitExceeded);
            }
            if filter.gives_up() {
                scratch.found.clear();
                return Ok(Stats::default());
            }
            let range = blocks.range(block);
            let counted = self.block(slices, range, filter, scratch);
            is_exceeded.fetch_or(counted.is_err(), Ordering::Relaxed);
            let done = done_blocks.fetch_add(1, Ordering::Relaxed) + 1;
            progress(f64::from(done) / f64::from(blocks.count));
            counted
        };
        let mut own = self.pool.take();
        let mut first = 0;
        while first < blocks.count {
            let blocks_per_merge = blocks.blocks_per_merge.min(blocks.count - first);
            if blocks.is_shared {
                let take = || self.pool.take();
                let results = parallel::map(blocks_per_merge as usize, take, |scratch, place| {
                    let counted = search(scratch, first + short(place))?;
                    Ok((scratch.found.clone(), counted))
                });
                for result in results {
                    let (keys, counted) = result?;
                    found.extend(keys);
                    *stats += counted;
                }
            } else {
                for block in first..first + blocks_per_merge {
                    *stats += search(&mut own, block)?;
                    found.extend_from_slice(&own.found);
                }
            }
            let begin = Instant::now();
            own.sorter.sort_and_dedup(found, bodies);
            self.limits.check(found.len())?;
            stats.narrow_time += begin.elapsed();
            first += blocks_per_merge;
        }
        Ok(())
    }

    /// Lists the spans of a few slices in `scratch.found`; returns the counts.
    fn block(
        &self,
        slices: &TimeSlices<'_>,
        range: Range<u32>,
        filter: &dyn PairFilter,
        scratch: &mut SearchScratch,
    ) -> Result<Stats, LimitExceeded> {
        let mut stats = Stats::default();
        let begin = Instant::now();
        let mut ends = std::mem::take(&mut scratch.ends);
        slices.ends(range.clone(), &mut ends);
        let interval = (ends[0], ends[ends.len() - 1]);
        let lives = self.lifetimes.iter().copied();
        list_present(lives, 0, interval, &mut scratch.present);
        // Taken out meanwhile, so that the rest can be borrowed beside them.
        let mut block = std::mem::take(&mut scratch.block);
        // Blocks are shared by threads where there are several.
        let threads = if range.len() == slices.count() as usize {
            self.threads
        } else {
            1
        };
        let slices_to_form = (&ends[..], &scratch.present[..]);
        self.form(self.frame, slices_to_form, threads, &mut block);
        scratch.ends = ends;
        stats.bounds_time += begin.elapsed();
        let mut candidates = std::mem::take(&mut scratch.candidates);
        scratch.found.clear();
        let mut crowded = Vec::new();
        let mut begin = Instant::now();
        for (number, slice) in range.zip(&block.slices) {
            let room = self.room_of(slice);
            if !self.list_pairs(&mut scratch.methods, slice, room, filter, &mut candidates) {
                crowded.push(SlicePart {
                    interval: slices.interval(number),
                    bounds: slice,
                    frame: self.frame,
                });
            }
            stats.boxes += slice.boxes.len() as u64;
            if candidates.is_empty() {
                // Reading the clock takes as long as comparing a few boxes.
                continue;
            }
            stats.candidates += candidates.len() as u64;
            let compared = Instant::now();
            let part = (slices.interval(number), &candidates[..]);
            stats.spans += self.refine(slice, part, filter, scratch)?;
            let refined = Instant::now();
            stats.broad_time += compared - begin;
            stats.narrow_time += refined - compared;
            begin = refined;
        }
        stats.broad_time += begin.elapsed();
        for part in crowded {
            self.divide(part, filter, &mut stats, scratch)?;
        }
        (scratch.block, scratch.candidates) = (block, candidates);
        let begin = Instant::now();
        if scratch.found.len() > FEW_FOUND {
            let SearchScratch { sorter, found, .. } = scratch;
            sorter.sort_and_dedup(found, self.lifetimes.len());
        }
        stats.narrow_time += begin.elapsed();
        Ok(stats)
    }

    /// Forms the boxes of some bodies (ascending) in the slices with these ends (s), in a frame with the unit of the search's.
    pub(super) fn form(
        &self,
        frame: &MovingFrame,
        (ends, present): (&[f64], &[u32]),
        threads: usize,
        block: &mut SliceBlock,
    ) {
        self.bodies.form(SlicesToForm {
            block: &mut *block,
            frame,
            present,
            ends,
            instructions: self.instructions,
            threads,
        });
        if self.bodies.have_long_arms() {
            for (slice, ends) in block.slices.iter_mut().zip(ends.windows(2)) {
                let interval = (ends[0], ends[1]);
                slice.tighten(interval, frame, |body| self.bodies.long_arms(body));
            }
        }
    }

    /// Adds the spans of a slice's candidates to those found; returns the number examined. If the
    /// filter gives up, spans may be missing.
    pub(super) fn refine(
        &self,
        slice: &SliceBounds,
        (interval, candidates): ((f64, f64), &[Candidate]),
        filter: &dyn PairFilter,
        scratch: &mut SearchScratch,
    ) -> Result<u64, LimitExceeded> {
        /// Candidates examined before the filter is asked again: some milliseconds.
        const STEP: usize = 1 << 14;
        let SearchScratch {
            refiner,
            found,
            sorter,
            ..
        } = scratch;
        let pair = |pair: Candidate| Some([pair.a, pair.b].map(|at| slice.bodies[at as usize]));
        let (mut examined, before) = (0, found.len());
        // Fewer may be copies of those that there is room for.
        let most = self.limits.spans.saturating_mul(slice.copies_of_span());
        for some in candidates.chunks(STEP) {
            if filter.gives_up() {
                break;
            }
            let context = RefineContext {
                bodies: &self.bodies,
                fat_lines: &slice.fat_lines,
                interval,
                window: self.window,
                margin: self.margin,
                max_spans: most.saturating_sub(found.len() - before),
            };
            examined += refiner.refine(&context, some, pair, found);
        }
        if found.len() > self.limits.spans {
            // A span that lasts for several slices is found in each, and more than once of bodies that teleport.
            sorter.sort_and_dedup(found, self.lifetimes.len());
            self.limits.check(found.len())?;
        }
        Ok(examined)
    }

    /// Replaces the content of a list by the candidates of a slice, numbered by place in it. Returns false, and lists none,
    /// if there are more than the limit.
    pub(super) fn list_pairs(
        &self,
        methods: &mut Methods,
        slice: &SliceBounds,
        room: u64,
        filter: &dyn PairFilter,
        candidates: &mut Vec<Candidate>,
    ) -> bool {
        let by_place = ByPlace::new(&slice.bodies, filter);
        candidates.clear();
        let room = CandidateLimit::new(&by_place, room);
        let method = (self.method, self.instructions);
        methods.pairs(method, &slice.boxes, &room, candidates);
        if room.is_exceeded() {
            candidates.clear();
        }
        !room.is_exceeded()
    }
}

/// Slices distributed in blocks of about equal size. Results do not depend on it.
struct SliceBlocks {
    slices: u32,
    count: u32,
    /// Blocks after which results are merged, so that a long span is kept once.
    blocks_per_merge: u32,
    /// True if several threads share the blocks.
    is_shared: bool,
}

impl SliceBlocks {
    /// Least number of blocks per thread, if several threads share them.
    const FEWEST: u32 = 3;
    /// Usual number of slices in a block of slices with less than one cubic per body.
    const FEW_SLICES: usize = 4;
    /// Boxes of a block of slices with a cubic per body or more, and the least and largest number of its slices. With more slices,
    /// cubics are read less often, but the lists of boxes leave the caches, and their memory is new in a first screening.
    const CACHED_BOXES: f64 = 16_384.0;
    const CACHED_SLICES: [usize; 2] = [2, 8];
    /// Boxes that make longer blocks where bodies are few. More of them save less than their memory
    /// costs when it is first touched.
    const BOXES_OF_FEW_BODIES: f64 = 512.0;
    /// Largest number of boxes in a block, which bounds its memory: 64 bytes each.
    const BOXES_OF_A_BLOCK: usize = 1 << 20;
    /// Approximate largest number of boxes of the blocks of a merge.
    const MERGE_BOXES: usize = 1 << 24;

    fn of(
        slices: &TimeSlices<'_>,
        statistics: &SceneStatistics,
        (bodies, threads, are_bodies_shared): (usize, usize, bool),
    ) -> Self {
        let present = statistics.present(slices.effective_window());
        let cubics = statistics.cubics_in(slices.length());
        let slices = slices.count();
        let [least, largest] = Self::CACHED_SLICES;
        let usual = if cubics < 1.0 {
            Self::FEW_SLICES
        } else if slices as usize <= largest {
            // Each plan is read once.
            largest
        } else {
            (whole(Self::CACHED_BOXES / present) as usize).clamp(least, largest)
        };
        let fit =
            (whole(Self::BOXES_OF_FEW_BODIES / present) as usize).clamp(usual, SLICES_AT_A_TIME);
        let most = (Self::BOXES_OF_A_BLOCK / bodies.max(1)).clamp(1, fit);
        let count = slices.div_ceil(short(most));
        let threads = short(threads);
        // Plans of many cubics lie in no cache. If each thread formed some slices, all would wait for all plans.
        let is_together = are_bodies_shared && cubics >= 1.0 && count == 1;
        let has_many = u64::from(slices) * bodies as u64 > FEW_BOXES as u64;
        let is_shared = threads > 1 && has_many && !is_together;
        let fewest = if is_shared {
            Self::FEWEST.saturating_mul(threads)
        } else {
            1
        };
        let blocks_per_merge = Self::MERGE_BOXES / (most * bodies.max(1));
        Self {
            slices,
            count: count.max(fewest).min(slices),
            blocks_per_merge: short(blocks_per_merge).max(16),
            is_shared,
        }
    }

    fn range(&self, block: u32) -> Range<u32> {
        let boundary = |block: u32| {
            let slice = u64::from(self.slices) * u64::from(block) / u64::from(self.count);
            u32::try_from(slice).unwrap_or(self.slices)
        };
        boundary(block)..boundary(block + 1)
    }
}

/// Largest number of a block's spans left unsorted until blocks are merged: 64 KiB.
const FEW_FOUND: usize = 1 << 12;

/// Boxes below which another thread does not pay on a busy machine. (Two cores with 17 ready
/// threads, 200 bodies each replanned, medians of 400 ticks: with 1,204 boxes a tick 0.9 ms on the
/// caller's thread, 3.2 ms on two; with 3,805 boxes 1.7 ms, and 1.9 to 7.6 ms.)
pub(crate) const FEW_BOXES: usize = 4096;
