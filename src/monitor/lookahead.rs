//! The lookahead: every span in which a pair may come within the largest margin, solved once.
//!
//! The lookahead is cut into slices on a fixed grid of time. A slice knows the boxes of all bodies
//! in it, and which bodies have changed since they were compared. Catching up goes through the
//! slices in the order of time, so that what is known is always complete up to some instant. Slices
//! that overlap the lookahead are needed. The slice after them is compared as time passes, a share with
//! each tick, so that no tick takes much longer than others.
//!
//! A search from nothing forms boxes of all bodies, and keeps none. There are three of them. If the clock has
//! jumped far, the time that it passed over is [searched](LookaheadSearch::search_jump) so, once. If much is new, all of
//! the lookahead is, and slices have no boxes until few bodies change. A slice in which too many boxes overlap is, in
//! shorter slices.

mod affordable;
mod ask;
mod from_nothing;
mod jump;
mod query_index;
mod time_grid;

use super::bodies::{BodyTable, ChangedBounds};
use super::budget::TickWork;
use super::grid::Grid;
use super::half_spaces::HalfSpaceSearch;
use super::monitored_bodies::{MonitoredBodies, MonitoredBody};
use super::recent_changes::RecentChanges;
use super::slice::{LookaheadSlice, SliceScratch, SliceTask};
use super::slot_set::SlotSet;
use super::solved_spans::{SlotPair, SolvedSpans};
use crate::broad_phase::PairFilter;
use crate::error::Error;
use crate::parallel;
use crate::pool::Pool;
use crate::rounding::last_known;
use crate::scene::Scene;
use crate::search::{FEW_BOXES, LimitExceeded, SearchScratch, SpanSorter};
use crate::shape::BodyShape;
use crate::spans::{SpanKey, common_part};
use crate::stats::Stats;
use crate::trajectory::Trajectory;
use crate::wall_clock::Instant;
use crate::window::Window;
use affordable::AffordableLookahead;
use query_index::QueryIndexes;
use std::collections::{BTreeSet, VecDeque};
use std::iter::once;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;

/// All spans of the lookahead in which a pair may come within the largest margin.
#[derive(Debug)]
pub(super) struct LookaheadSearch {
    pub(super) monitored: MonitoredBodies,
    pub(super) solved: SolvedSpans,
    pub(super) grid: Grid,
    /// Slices of the lookahead, and the next one.
    slices: VecDeque<LookaheadSlice>,
    /// Unused slices: their memory is reused.
    unused: Vec<LookaheadSlice>,
    /// Lengths of the next chunk of a jump and of its slices, s; none if nothing is left to search.
    jump: Option<(f64, f64)>,
    /// Those with which the last jump ended, s. A clock that moves on by more than the lookahead jumps in each tick.
    last_jump: Option<(f64, f64)>,
    pub(super) half_spaces: HalfSpaceSearch,
    query_indexes: QueryIndexes,
    /// Spans that cheap tests have left: to be solved.
    survivors: Vec<SpanKey>,
    sorter: SpanSorter,
    pool: Pool<SliceScratch>,
    search_pool: Pool<SearchScratch>,
    /// Bodies that changed since the last catching up, each once.
    changed: SlotSet,
    /// Boxes of these bodies, for questions between ticks.
    recent: RecentChanges,
    /// Pairs that are ignored since the last catching up.
    left_out: BTreeSet<SlotPair>,
    /// Boxes of changed bodies in all slices.
    moved: ChangedBounds,
    /// Ends of the slices of the lookahead, s.
    ends: Vec<f64>,
    /// Last version of the [partners](Scene::partners) that was taken over.
    partners: Option<(u64, u64)>,
    /// Ticks since a search from nothing was cheaper or most was unknown, of which idle ones count less; none if that never was.
    pub(super) since_unknown: Option<f64>,
    pub(super) affordable: AffordableLookahead,
    /// Largest number of spans; with more the scene is too crowded.
    pub(super) max_spans: usize,
}

impl LookaheadSearch {
    /// Listed changes beyond two for each changed body, above which the list is shortened to one each.
    const MANY_CHANGES: usize = 1024;

    /// Returns a search without bodies, on a grid, for contacts at some margins (m, ascending), with room for so many spans.
    pub(super) fn new(grid: Grid, margins: Vec<f64>, max_spans: usize) -> Self {
        Self {
            monitored: MonitoredBodies::default(),
            solved: SolvedSpans::at(margins),
            grid,
            slices: VecDeque::new(),
            unused: Vec::new(),
            jump: None,
            last_jump: None,
            half_spaces: HalfSpaceSearch::default(),
            query_indexes: QueryIndexes::default(),
            survivors: Vec::new(),
            sorter: SpanSorter::default(),
            pool: Pool::default(),
            search_pool: Pool::default(),
            changed: SlotSet::default(),
            recent: RecentChanges::default(),
            left_out: BTreeSet::new(),
            moved: ChangedBounds::default(),
            ends: Vec::new(),
            partners: None,
            since_unknown: None,
            affordable: AffordableLookahead::new(grid.origin),
            max_spans,
        }
    }

    /// Returns a search without bodies on another grid.
    pub(super) fn emptied(&self, grid: Grid) -> Self {
        Self::new(grid, self.solved.margins().to_vec(), self.max_spans)
    }

    /// Returns true if anything has changed since the last catching up.
    pub(super) fn has_changed(&self) -> bool {
        !(self.changed.slots().is_empty() && self.left_out.is_empty())
    }

    /// Replaces the monitored body in a slot (none: it is gone). Its solved spans are dropped, and searched
    /// for again.
    pub(super) fn set(&mut self, slot: u32, monitored: Option<MonitoredBody>) {
        self.monitored.set(slot, monitored);
        self.mark_changed(slot);
    }

    /// Replaces the plan of the body in a slot over `window`. Its solved spans are dropped, and
    /// searched for again.
    pub(super) fn replan(
        &mut self,
        slot: u32,
        trajectory: &Trajectory,
        window: Window,
    ) -> Result<(), Error> {
        self.monitored.replan(slot, trajectory, window)?;
        self.mark_changed(slot);
        Ok(())
    }

    /// Replaces the shape of the body in a slot. Its solved spans are dropped, and searched for again.
    pub(super) fn reshape(&mut self, slot: u32, shape: BodyShape<'_>) {
        self.monitored.set_padding(slot, self.grid.padding(shape));
        self.mark_changed(slot);
    }

    /// Finds which bodies may be part of a pair: the one in a slot, and others that were none; or all (none). The boxes of
    /// bodies whose last partner is gone stay: shots come and go among scenery, and all boxes cost more than to keep them.
    pub(super) fn find_partners(&mut self, scene: &Scene, slot: Option<u32>) {
        let partners = scene.partners(self.grid.margin);
        let version = Some(partners.version());
        let has = |slot: u32| {
            scene
                .in_slot(slot)
                .is_some_and(|(_, one)| partners.has(&one.body))
        };
        if let Some(slot) = slot {
            self.monitored.set_partner(slot, has(slot));
        }
        if std::mem::replace(&mut self.partners, version) == version {
            return;
        }
        for other in (0_u32..).take(self.monitored.len()) {
            let has_partner = has(other);
            let counts = has_partner || slot.is_none();
            if counts && self.monitored.set_partner(other, has_partner) {
                self.mark_changed(other);
            }
        }
    }

    /// Forgets what was found of a pair: its bodies ignore each other now.
    pub(super) fn leave_out(&mut self, pair: SlotPair) {
        self.left_out.insert(pair);
    }

    /// Marks a body as changed: its pairs are searched for again.
    pub(super) fn mark_changed(&mut self, slot: u32) {
        self.mark_all_changed(once(slot));
    }

    /// Marks some bodies as changed; returns their number.
    pub(super) fn mark_all_changed(&mut self, slots: impl Iterator<Item = u32>) -> usize {
        let mut count = 0;
        for slot in slots {
            self.changed.insert(slot);
            self.recent.push(slot);
            count += 1;
        }
        let changed = self.changed.slots();
        if self.recent.len() > Self::MANY_CHANGES + 2 * changed.len() {
            self.recent.reset(changed);
        }
        count
    }

    /// Drops the solved spans of all changed bodies, in one pass.
    fn forget_changed_pairs(&mut self) {
        if !self.has_changed() {
            return;
        }
        let (changed, left_out) = (&self.changed, &self.left_out);
        self.solved
            .forget(|pair| changed.has(pair.0) || changed.has(pair.1) || left_out.contains(&pair));
        self.left_out.clear();
        self.recent.reset(&[]);
    }

    /// Returns the instant (s) to which plans must be followed for a lookahead that ends at `end`: the end of
    /// the slice after its last one, since slices are formed as a whole.
    pub(super) fn plans_needed_until(&self, end: f64) -> f64 {
        end + 2.0 * self.grid.length
    }

    /// Extends plans that go on beyond their knots so that they cover a lookahead until `end`.
    pub(super) fn extend_beyond(&mut self, scene: &Scene, end: f64) -> Result<(), Error> {
        let end = self.plans_needed_until(end);
        self.monitored.extend_beyond(scene, end)
    }

    /// Brings the slices from `from` on up to date, soonest first, until the budget is spent: as far as a lookahead goes
    /// (first and last instant, s), or less if the budget asks for it. Returns the instant up to which everything is known.
    ///
    /// # Errors
    ///
    /// If there is too little room. Then what is known is not complete: all is to be looked for anew.
    pub(super) fn catch_up(
        &mut self,
        from: f64,
        lookahead: (f64, f64),
        work: &mut TickWork<'_>,
    ) -> Result<f64, LimitExceeded> {
        let scene = work.admission.scene;
        let clock_slice = self.grid.start(self.index(lookahead.0));
        let is_unknown_again = self.is_unknown_again(scene, lookahead, (from, clock_slice), work);
        let changed = (self.has_changed(), is_unknown_again);
        let affordable = &mut self.affordable;
        let to = affordable.end_of_search(lookahead, changed, &mut work.meter);
        let mut screens = is_unknown_again && !work.meter.may_stop();
        self.query_indexes.clear();
        self.forget_changed_pairs();
        self.half_spaces.note(&self.monitored, self.changed.slots());
        loop {
            self.survivors.clear();
            let mut known = to;
            if !self.monitored.half_spaces().is_empty() {
                // First: slices, and the search over a jump, go on no farther than half-spaces are known.
                let begin = Instant::now();
                let bodies = BodyTable::of(scene, &self.monitored, &self.grid);
                let times = (from, to, self.plans_needed_until(to));
                let found = (&mut self.survivors, self.max_spans);
                known = self.half_spaces.list_spans(&bodies, times, work, found)?;
                work.stats.narrow_time += begin.elapsed();
            }
            let screens = std::mem::take(&mut screens);
            let (compared_until, is_done) =
                self.search_slices((from, clock_slice, to), screens, work)?;
            let complete_until = compared_until.min(known);
            self.changed.clear();
            let begin = Instant::now();
            let bodies = BodyTable::of(scene, &self.monitored, &self.grid);
            self.solved.forget_before(from);
            self.sorter
                .sort_and_dedup(&mut self.survivors, self.monitored.len());
            let most = self.max_spans;
            // A budget, or a jump, may stop elsewhere: then more is solved of what it cuts.
            let cuts = [from, lookahead.0, to];
            let mut window = (from, self.plans_needed_until(to));
            if self.jump.is_some() {
                // All that comes after is searched again.
                window.1 = compared_until;
                self.half_spaces
                    .put_off(&bodies, &self.survivors, compared_until);
            }
            work.stats.survivors +=
                self.solved
                    .add(&self.survivors, &bodies, (window, &cuts), most)?;
            work.stats.narrow_time += begin.elapsed();
            if is_done {
                return Ok(work.meter.until().unwrap_or(complete_until));
            }
        }
    }

    fn bodies<'s>(&'s self, scene: &'s Scene) -> BodyTable<'s> {
        BodyTable::of(scene, &self.monitored, &self.grid)
    }

    /// Brings what is not up to date from `from` to `to` (s) up to date, until the budget is spent. `clock_slice` is the
    /// beginning of the slice of the clock (s). If it `screens`, all of the lookahead is searched from nothing. Lists
    /// survivors, as many as are solved at a time. Returns the instant up to which all is up to date, and false if another
    /// call, which screens nothing, is to go on once these survivors are solved.
    fn search_slices(
        &mut self,
        (mut from, clock_slice, to): (f64, f64, f64),
        screens: bool,
        work: &mut TickWork<'_>,
    ) -> Result<(f64, bool), LimitExceeded> {
        let jump = (self.laid_until(from), clock_slice);
        if self.is_jump(jump) {
            // Slices before the lookahead are needed no more; those in it are laid out again below.
            self.unused.extend(self.slices.drain(..));
            if let Some(stop) = self.search_jump((from, clock_slice), work)? {
                return Ok((stop, true));
            }
            from = clock_slice;
        }
        self.drop_before(from);
        let needed = self.lay_slices(from, to);
        if screens {
            self.screen((from, to), needed, work)?;
            if !work.admission.gives_up() {
                return Ok((to, true));
            }
        }
        for slice in &mut self.slices {
            slice.note(self.changed.slots());
        }
        self.refresh((from, to), needed, work)
    }

    /// Compares what has not been compared in each slice from `from` to `to` (s), and what is due of the next
    /// one. The first `needed` slices are needed. The result is that of [`search_slices`](Self::search_slices).
    fn refresh(
        &mut self,
        (from, to): (f64, f64),
        needed: usize,
        work: &mut TickWork<'_>,
    ) -> Result<(f64, bool), LimitExceeded> {
        let slices = self.slices.make_contiguous();
        slices[..needed].iter_mut().for_each(LookaheadSlice::need);
        if let [.., last, next] = slices {
            // It is due when the lookahead's end has passed through the last one.
            let start = self.grid.start(last.number);
            let share = ((to - start) / self.grid.length).clamp(0.0, 1.0);
            next.set_share_due_ahead(share, last);
        }
        let bodies = self.bodies(work.admission.scene);
        let stale = self.slices.iter().filter(|slice| !slice.is_fresh(&bodies));
        let is_shared = work.meter.is_unlimited() && stale.count() > 1;
        let found = if is_shared {
            self.refresh_together(needed, work)
        } else {
            self.refresh_one_by_one(from, needed, work)
        };
        // The budget may be spent, or the filter have given up.
        let bodies = self.bodies(work.admission.scene);
        let mut in_order = self.slices.iter().take(needed);
        let stale = in_order.find(|slice| !slice.is_fresh(&bodies));
        let known = stale.map_or(to, |slice| {
            let until = slice.compared_until().max(from);
            last_known(until).max(from).min(to)
        });
        let done = |stats: &Stats| stats.boxes + stats.candidates;
        let before = done(&work.stats);
        self.take_survivors(needed, &mut work.stats)?;
        if is_shared {
            let count = done(&work.stats) - before;
            work.meter.count(usize::try_from(count).unwrap_or(0));
        }
        Ok((known, found <= self.max_spans))
    }

    /// Compares what is due in all slices, on all threads. Returns the number of survivors: if these are more than there is
    /// room for, they are to be solved before the rest.
    fn refresh_together(&mut self, needed: usize, work: &mut TickWork<'_>) -> usize {
        let (limits, most) = (self.limits(), self.max_spans);
        let scene = work.admission.scene;
        let bodies = BodyTable::of(scene, &self.monitored, &self.grid);
        let slices = self.slices.make_contiguous();
        let begin = Instant::now();
        let is_boxed = slices[..needed].iter().any(LookaheadSlice::is_placed);
        let changed = if is_boxed { self.changed.slots() } else { &[] };
        self.moved.form(&bodies, changed, &self.ends);
        work.stats.bounds_time += begin.elapsed();
        let alone = SliceTask {
            bodies: &bodies,
            filter: &work.admission,
            moved: None,
            limits,
            pool: &self.search_pool,
        };
        let moved = &self.moved;
        let boxes = slices.iter().map(|slice| slice.missing(&bodies)).sum();
        let (found, pool) = (AtomicUsize::new(0), &self.pool);
        parallel::for_each_chunk(slices, 1, (boxes, FEW_BOXES), |number, slices| {
            for slice in slices {
                if found.load(Relaxed) > most {
                    // The survivors found so far are solved first: there may be no room for more.
                    return;
                }
                let moved = (number < needed).then_some((moved, number));
                let task = SliceTask { moved, ..alone };
                slice.refresh(&task, &mut pool.take(), |_| true);
                // More than there is room for, if the slice has none.
                let beyond = slice.check_room().map_or(most, |()| 0);
                found.fetch_add(beyond + slice.survivors.len(), Relaxed);
            }
        });
        found.into_inner()
    }

    /// Compares what is due in all slices from `from` (s) on, soonest first, until the budget is spent. Returns what
    /// [`refresh_together`](Self::refresh_together) does.
    fn refresh_one_by_one(&mut self, from: f64, needed: usize, work: &mut TickWork<'_>) -> usize {
        let limits = self.limits();
        let scene = work.admission.scene;
        let bodies = BodyTable::of(scene, &self.monitored, &self.grid);
        let task = SliceTask {
            bodies: &bodies,
            filter: &work.admission,
            moved: None,
            limits,
            pool: &self.search_pool,
        };
        let meter = &mut work.meter;
        let mut found = 0;
        for (number, slice) in self.slices.iter_mut().enumerate() {
            let is_needed = number < needed;
            // What is solved of turning bodies does not reach beyond, and no work is due there.
            if found > self.max_spans || !is_needed && meter.has_to_finish() {
                break;
            }
            let start = self.grid.start(slice.number).max(from);
            if is_needed && meter.ends_before(start) {
                break;
            }
            if slice.is_fresh(&bodies) {
                continue;
            }
            if !meter.is_spent() {
                slice.refresh(&task, &mut self.pool.take(), |work| {
                    meter.count(work);
                    !meter.is_spent()
                });
            }
            found += slice.survivors.len();
            if is_needed && !slice.is_fresh(&bodies) {
                break;
            }
        }
        found
    }

    /// Takes the survivors and the counts out of all slices. What is found ahead of time must leave room for what is
    /// needed.
    ///
    /// # Errors
    ///
    /// If a needed slice was given up for lack of room.
    fn take_survivors(&mut self, needed: usize, stats: &mut Stats) -> Result<(), LimitExceeded> {
        let room = (self.max_spans / 2).saturating_sub(self.solved.len());
        for (number, slice) in self.slices.iter_mut().enumerate() {
            let has_room = slice.check_room();
            if number >= needed && (has_room.is_err() || slice.survivors.len() > room) {
                slice.put_off();
                continue;
            }
            has_room?;
            self.survivors.append(&mut slice.survivors);
            *stats += std::mem::take(&mut slice.stats);
        }
        Ok(())
    }

    /// Returns when both bodies of a pair exist, s, as far back as they are known.
    pub(super) fn domain(&self, (a, b): (u32, u32)) -> Option<(f64, f64)> {
        let [a, b] = [a, b].map(|slot| self.monitored.domain(slot));
        common_part(a?, b?)
    }
}
