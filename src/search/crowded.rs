//! Slices with many candidates: they are searched island by island, each in a frame of its own, and in shorter slices.

use super::box_sizes::BoxSizes;
use super::form::{SliceBlock, SliceBounds};
use super::limits::are_coarse;
use super::window::SlicePart;
use super::{BoxedBodies, LimitExceeded, SearchScratch, WindowSearch};
use crate::broad_phase::{Candidate, PairFilter};
use crate::count::as_f64;
use crate::stats::Stats;
use crate::wall_clock::Instant;

impl<S: BoxedBodies> WindowSearch<'_, S> {
    /// Searches a part with many candidates per box: by [islands](SliceBounds::islands) if there are several, or in halves.
    ///
    /// In a frame of its own, an island that is far from the middle of the scene has boxes without its rounding there, and one
    /// whose bodies fly together has boxes without their common displacement.
    pub(super) fn divide(
        &self,
        part: SlicePart<'_>,
        filter: &dyn PairFilter,
        stats: &mut Stats,
        scratch: &mut SearchScratch,
    ) -> Result<(), LimitExceeded> {
        let SlicePart {
            interval,
            bounds,
            frame,
        } = part;
        let Some(islands) = bounds.islands() else {
            // Coarse ones came here with few candidates per box: nothing else helps but to look at them.
            let room = self.limits.candidates_of_slice(bounds.boxes.len(), false);
            let is_coarse = are_coarse(&bounds.fat_lines);
            return if is_coarse && self.search_whole(part, room, filter, stats, scratch)? {
                Ok(())
            } else {
                self.halve(part, filter, stats, scratch)
            };
        };
        let mut block = SliceBlock::default();
        for island in islands {
            if filter.gives_up() {
                break;
            }
            let begin = Instant::now();
            let frame = &island.frame(bounds, interval, frame);
            let ends = [interval.0, interval.1];
            self.form(frame, (&ends, &island.bodies(bounds)), 1, &mut block);
            stats.bounds_time += begin.elapsed();
            if let [bounds, ..] = &block.slices[..] {
                let part = SlicePart {
                    interval,
                    bounds,
                    frame,
                };
                self.search_part(part, filter, stats, scratch)?;
            }
        }
        Ok(())
    }

    /// Lists the spans of a part, which is divided if it has many candidates per box.
    fn search_part(
        &self,
        part: SlicePart<'_>,
        filter: &dyn PairFilter,
        stats: &mut Stats,
        scratch: &mut SearchScratch,
    ) -> Result<(), LimitExceeded> {
        stats.boxes += part.bounds.boxes.len() as u64;
        let room = self.room_of(part.bounds);
        if self.search_whole(part, room, filter, stats, scratch)? {
            return Ok(());
        }
        self.divide(part, filter, stats, scratch)
    }

    /// Lists the spans of a part, and returns true; or lists none if it has more candidates than there is room for.
    fn search_whole(
        &self,
        SlicePart {
            interval, bounds, ..
        }: SlicePart<'_>,
        room: u64,
        filter: &dyn PairFilter,
        stats: &mut Stats,
        scratch: &mut SearchScratch,
    ) -> Result<bool, LimitExceeded> {
        let mut candidates = Vec::new();
        if !self.list_timed(bounds, room, filter, (&mut candidates, stats), scratch) {
            return Ok(false);
        }
        self.refine_timed(bounds, (interval, &candidates), filter, stats, scratch)?;
        Ok(true)
    }

    /// Returns the largest number of candidates of a slice before it is divided.
    pub(super) fn room_of(&self, bounds: &SliceBounds) -> u64 {
        let is_coarse = are_coarse(&bounds.fat_lines);
        self.limits
            .candidates_of_slice(bounds.boxes.len(), is_coarse)
    }

    /// Searches a part with many candidates per box. It is halved while the
    /// halves have fewer candidates in all. Candidates shrink with boxes, until these are as large
    /// as hitboxes and the margin. Overlaps that remain are a crowd, which may fit the limits as a
    /// whole. So do those of bodies that fly side by side, whose boxes overlap however long they are.
    fn halve(
        &self,
        part: SlicePart<'_>,
        filter: &dyn PairFilter,
        stats: &mut Stats,
        scratch: &mut SearchScratch,
    ) -> Result<(), LimitExceeded> {
        /// Halves with boxes nearly as large have as many candidates.
        const LESS: f64 = 0.875;
        let SlicePart {
            interval,
            bounds: slice,
            frame,
        } = part;
        // Halves of the time in which any of them exists.
        let ends = slice
            .bodies
            .iter()
            .map(|&body| self.lifetimes[body as usize]);
        let (first, last) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |hull, (first, last)| {
            (hull.0.min(first), hull.1.max(last))
        });
        let (from, to) = (interval.0.max(first), interval.1.min(last));
        // Aside of the very middle: where all meet at that instant, they would be near each other in both parts.
        let middle = 0.5625 * from + 0.4375 * to;
        let mut halves = SliceBlock::default();
        let begin = Instant::now();
        if from < middle && middle < to {
            let ends = [from, middle, to];
            self.form(frame, (&ends, slice.each_body()), 1, &mut halves);
        }
        stats.bounds_time += begin.elapsed();
        let whole = BoxSizes::of(&slice.boxes);
        let sizes = halves.slices.iter().map(|half| BoxSizes::of(&half.boxes));
        let both = sizes.fold(BoxSizes::default(), BoxSizes::and);
        let has_fewer = !halves.slices.is_empty() && both.makes_fewer_pairs_than(&whole);
        if !has_fewer || !self.shows_fewer_pairs(&halves, slice, filter, scratch) {
            let mut candidates = Vec::new();
            let room = self.limits.candidates;
            if self.list_timed(slice, room, filter, (&mut candidates, stats), scratch) {
                let before = scratch.found.clone();
                match self.refine_timed(slice, (interval, &candidates), filter, stats, scratch) {
                    Ok(()) => return Ok(()),
                    Err(exceeded) if !has_fewer => return Err(exceeded),
                    // Bodies may be near each other in fewer pairs within the halves.
                    Err(_) => scratch.found = before,
                }
            }
            let is_smaller = !halves.slices.is_empty() && both.is_below(2.0 * LESS, &whole);
            if !has_fewer && !is_smaller {
                return Err(LimitExceeded);
            }
        }
        for (bounds, interval) in halves.slices.iter().zip([(from, middle), (middle, to)]) {
            if filter.gives_up() {
                break;
            }
            let half = SlicePart {
                interval,
                bounds,
                frame,
            };
            self.search_part(half, filter, stats, scratch)?;
        }
        Ok(())
    }

    /// Does what [`list_pairs`](Self::list_pairs) does, and adds the time.
    fn list_timed(
        &self,
        slice: &SliceBounds,
        room: u64,
        filter: &dyn PairFilter,
        (candidates, stats): (&mut Vec<Candidate>, &mut Stats),
        scratch: &mut SearchScratch,
    ) -> bool {
        let begin = Instant::now();
        let has_room = self.list_pairs(&mut scratch.methods, slice, room, filter, candidates);
        stats.broad_time += begin.elapsed();
        has_room
    }

    /// Does what [`refine`](Self::refine) does with all candidates of a slice, and adds the counts and the time.
    fn refine_timed(
        &self,
        slice: &SliceBounds,
        (interval, candidates): ((f64, f64), &[Candidate]),
        filter: &dyn PairFilter,
        stats: &mut Stats,
        scratch: &mut SearchScratch,
    ) -> Result<(), LimitExceeded> {
        let begin = Instant::now();
        let examined = self.refine(slice, (interval, candidates), filter, scratch);
        stats.narrow_time += begin.elapsed();
        stats.spans += examined?;
        stats.candidates += candidates.len() as u64;
        Ok(())
    }

    /// Returns true unless a sample of the bodies shows that the halves of a slice have nearly twice as many candidates:
    /// also if it has too few for that, or the slice more than the limit.
    fn shows_fewer_pairs(
        &self,
        halves: &SliceBlock,
        slice: &SliceBounds,
        filter: &dyn PairFilter,
        scratch: &mut SearchScratch,
    ) -> bool {
        /// Fewest candidates of a sample that tell something.
        const TELLING: f64 = 64.0;
        /// Largest share of twice the candidates that counts as far fewer.
        const FEWER: f64 = 0.75;
        let sampled = u64::from(SliceBounds::ONE_IN);
        let room = self.limits.candidates / (sampled * sampled);
        let mut count = |slice: &SliceBounds| {
            let (sample, mut candidates) = (slice.sample(), Vec::new());
            self.list_pairs(&mut scratch.methods, &sample, room, filter, &mut candidates)
                .then(|| as_f64(candidates.len()))
        };
        let Some(whole) = count(slice).filter(|&whole| whole >= TELLING) else {
            return true;
        };
        let halves = halves.slices.iter().map(count);
        halves
            .sum::<Option<f64>>()
            .is_some_and(|halves| halves < FEWER * 2.0 * whole)
    }
}
