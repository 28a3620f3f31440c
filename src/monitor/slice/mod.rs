//! A slice of the lookahead: the boxes of all bodies in it, and the state of their comparison.

mod ask;
mod changes;
mod refine;
mod state;
mod teleport_bounds;

use super::bodies::BodyTable;
use crate::broad_phase::{BodyBox, BroadPhase, Candidate, PairFilter};
use crate::count::{as_f64, whole};
use crate::search::{LimitExceeded, are_coarse};
use crate::wall_clock::Instant;
pub(super) use ask::NearBody;
pub(super) use state::{BoxIndex, LookaheadSlice, SliceScratch, SliceTask};
use state::{BuildStage, LimitedAdmission};

impl LookaheadSlice {
    /// Boxes formed, or candidates looked at, before a budget is looked at: some tenths of a
    /// millisecond.
    const STEP: usize = 1024;

    /// Share of the work for a slice that forms its boxes and places them in the tree; the rest compares
    /// them.
    const PLACING: f64 = 0.6;

    /// Leaves compared before a budget is looked at: they hold about `STEP` bodies.
    const STEP_LEAVES: usize = 100;

    /// Memory for so many candidates, and four for each body, is kept when all are refined. More is given
    /// back: there are many slices.
    const FEW_CANDIDATES: usize = 1024;

    /// Boxes that are compared with the tree before a filter is asked whether it gives up.
    const BOXES_PER_CHECK: usize = 64;

    /// Returns an empty slice in this one's memory.
    pub(super) fn begin(&mut self, number: i64, interval: (f64, f64)) {
        self.number = number;
        self.interval = interval;
        self.stage = BuildStage::default();
        self.due_share = 0.0;
        self.boxed.clear();
        self.index.places.clear();
        self.candidates.clear();
        self.refined = 0;
        self.has_exceeded_limit = false;
        self.is_put_off = false;
        self.survivors.clear();
        self.search_from = None;
        self.changed.clear();
    }

    /// Notes that all bodies were compared with each other until an instant (s), without boxes of the whole slice.
    pub(super) fn set_compared(&mut self, until: f64) {
        self.stats.slices += u64::from(!self.stage.is_compared());
        self.begin(self.number, self.interval);
        self.stage = BuildStage::Compared(0);
        self.search_from = Some(until).filter(|&until| until < self.interval.1);
    }

    /// Drops the work done for the slice until it is needed: there is no room.
    pub(super) fn put_off(&mut self) {
        self.begin(self.number, self.interval);
        self.is_put_off = true;
    }

    /// Returns an error if the slice was given up for lack of room.
    pub(super) const fn check_room(&self) -> Result<(), LimitExceeded> {
        if self.has_exceeded_limit {
            Err(LimitExceeded)
        } else {
            Ok(())
        }
    }

    /// Returns the instant (s) before which all bodies were compared with each other.
    pub(super) fn compared_until(&self) -> f64 {
        let is_compared = self.stage.is_compared()
            && self.changed.slots().is_empty()
            && self.refined == self.candidates.len();
        let until = self.search_from.filter(|_| is_compared);
        until.unwrap_or(self.interval.0)
    }

    /// Notes that the slice is needed from now on: all of its work is due.
    pub(super) const fn need(&mut self) {
        self.due_share = 1.0;
    }

    /// Notes that a share of the work (0 to 1) is due, before the slice is needed. Boxes are placed in the order of
    /// the tree of the slice before: in most scenes bodies have the same neighbours in both. Without that tree, the work
    /// is put off until there is one, or the slice is needed.
    pub(super) fn set_share_due_ahead(&mut self, share: f64, before: &Self) {
        self.due_share = share;
        if !matches!(self.stage, BuildStage::Listing(_)) {
            return;
        }
        if share > 0.0 && before.is_placed() && !self.is_put_off {
            self.index.boxes.begin_like(&before.index.boxes);
            self.boxed.clear();
            self.stage = BuildStage::Placing(0);
        } else {
            self.due_share = 0.0;
        }
    }

    /// Returns the part of `count` that is due now, for a stage of the work that lasts from one share of
    /// all work to another.
    fn due_of(&self, count: usize, (from, to): (f64, f64)) -> usize {
        let share = ((self.due_share - from) / (to - from)).clamp(0.0, 1.0);
        whole((as_f64(count) * share).ceil()) as usize
    }

    /// Returns how many slots are to have boxes now.
    fn due_slots(&self, bodies: &BodyTable<'_>) -> usize {
        self.due_of(bodies.monitored.len(), (0.0, Self::PLACING))
    }

    /// Returns how many leaves are to be compared now.
    fn due_leaves(&self) -> usize {
        self.due_of(self.index.boxes.leaves(), (Self::PLACING, 1.0))
    }

    /// Returns true if all bodies have their boxes in the tree.
    pub(super) const fn is_placed(&self) -> bool {
        matches!(self.stage, BuildStage::Joining(..) | BuildStage::Built)
    }

    /// Returns true if all that is due is compared: the slice is *fresh*.
    pub(super) fn is_fresh(&self, bodies: &BodyTable<'_>) -> bool {
        let has_all = |slots| (self.due_slots(bodies)..bodies.monitored.len()).contains(&slots);
        let is_there = match self.stage {
            // Changed bodies are boxed again when the slice is built.
            BuildStage::Listing(_) => return self.due_share < 1.0,
            // When all boxes are placed, joining has to begin: the slice is not fresh.
            BuildStage::Placing(slots) => self.due_share < 1.0 && has_all(slots),
            BuildStage::Joining(leaves, order) => {
                self.due_share < 1.0
                    && leaves >= self.due_leaves()
                    && order == self.index.boxes.resort_count()
            }
            BuildStage::Compared(_) | BuildStage::Built => true,
        };
        is_there
            && self.changed.slots().is_empty()
            && self.search_from.is_none()
            && self.refined == self.candidates.len()
    }

    /// Returns how many boxes are to be formed, at most.
    pub(super) fn missing(&self, bodies: &BodyTable<'_>) -> usize {
        match self.stage {
            BuildStage::Built => self.changed.slots().len(),
            BuildStage::Compared(_) if self.changed.slots().is_empty() => 0,
            _ => bodies.monitored.len(),
        }
    }

    /// Appends the admitted pairs of a listed box with another body whose box it overlaps, if `wanted` returns true
    /// for the two bodies; not all if the filter gives up.
    fn list_meeting(
        &mut self,
        filter: &LimitedAdmission<'_>,
        scratch: &mut SliceScratch,
        wanted: impl Fn(u32, u32) -> bool,
    ) {
        let candidates = &mut self.candidates;
        for some in scratch.listed.chunks(Self::BOXES_PER_CHECK) {
            if filter.gives_up() {
                return;
            }
            let boxes = &self.index.boxes;
            boxes.meeting(some, &mut scratch.search, |own, other| {
                if wanted(own.body, other) {
                    let pair = Candidate::new(own.body, other);
                    if filter.admits(pair.a, pair.b) {
                        candidates.push(pair);
                    }
                }
            });
        }
    }

    /// Compares what has not been compared, step by step, while `goes_on` returns true and there
    /// [is room](Self::check_room). `goes_on` gets the work of each step (boxes and candidates). Spans and
    /// counts are added to `survivors` and `stats`.
    pub(super) fn refresh(
        &mut self,
        task: &SliceTask<'_>,
        scratch: &mut SliceScratch,
        mut goes_on: impl FnMut(usize) -> bool,
    ) {
        self.has_exceeded_limit = false;
        while !self.is_fresh(task.bodies) {
            let begin = Instant::now();
            let work = if self.refined < self.candidates.len() {
                let work = self.refine(task, scratch);
                self.stats.narrow_time += begin.elapsed();
                work
            } else {
                let work = self.find_candidates(task, scratch);
                self.stats.broad_time += begin.elapsed();
                work
            };
            self.has_exceeded_limit |= task.limits.check(self.survivors.len()).is_err();
            // A slice without a body is work as well: a budget of counted work stops at one place
            // only.
            if !goes_on(1 + work) || task.filter.gives_up() || self.has_exceeded_limit {
                break;
            }
        }
        let few = Self::FEW_CANDIDATES + 4 * self.index.fat_lines.len();
        if self.refined >= self.candidates.len() && self.candidates.capacity() > few {
            self.candidates = Vec::new();
            self.refined = 0;
        }
    }

    /// Takes a step towards all candidates; returns the number of boxes formed. If there are too many
    /// candidates, the slice is searched from nothing, in shorter slices.
    fn find_candidates(&mut self, task: &SliceTask<'_>, scratch: &mut SliceScratch) -> usize {
        self.candidates.clear();
        self.refined = 0;
        if let Some(from) = self.search_from {
            return self.search_next_part(from, task);
        }
        let bodies = task.bodies.monitored.len();
        let is_coarse = are_coarse(&self.index.fat_lines);
        let usual = task.limits.candidates_of_slice(bodies, is_coarse);
        let room = match self.stage {
            // There may be as many in each slice: then a search of all bodies takes less time.
            BuildStage::Built if is_coarse => usual / 8,
            // For each later change all of the shorter slices would be searched again.
            BuildStage::Built => usual.saturating_mul(3),
            _ => usual,
        };
        let filter = &LimitedAdmission::new(task.filter, room);
        let boxes = self.compare(task, filter, scratch);
        if filter.is_exceeded() {
            self.candidates.clear();
            // All bodies as they are now.
            self.stats.slices += u64::from(!self.stage.is_compared());
            self.stage = BuildStage::Built;
            self.boxed = Vec::new();
            self.changed.clear();
            self.search_from = Some(self.interval.0);
        }
        self.stats.candidates += self.candidates.len() as u64;
        boxes
    }

    /// Takes a step towards all candidates of the slice as a whole; returns the number of boxes formed.
    fn compare(
        &mut self,
        task: &SliceTask<'_>,
        filter: &LimitedAdmission<'_>,
        scratch: &mut SliceScratch,
    ) -> usize {
        let bodies = task.bodies;
        match self.stage {
            BuildStage::Listing(slots) | BuildStage::Compared(slots)
                if slots < bodies.monitored.len() =>
            {
                let mut boxed = std::mem::take(&mut self.boxed);
                let until = self.list(bodies, slots, (&mut boxed, &mut scratch.slots));
                self.boxed = boxed;
                self.stage = match self.stage {
                    BuildStage::Listing(_) => BuildStage::Listing(until),
                    _ if until < bodies.monitored.len() => BuildStage::Compared(until),
                    // Those that have changed are compared next.
                    _ => {
                        self.index.boxes.build(&std::mem::take(&mut self.boxed));
                        BuildStage::Built
                    }
                };
                until - slots
            }
            BuildStage::Placing(slots) if slots < self.due_slots(bodies) => {
                scratch.listed.clear();
                let until = self.list(bodies, slots, (&mut scratch.listed, &mut scratch.slots));
                self.index.boxes.move_to(&scratch.listed);
                self.stage = BuildStage::Placing(until);
                until - slots
            }
            BuildStage::Placing(slots) if slots < bodies.monitored.len() => {
                let changed = self.changed.slots().len();
                self.box_changed(bodies, task.moved, scratch);
                self.index.boxes.move_to(&scratch.listed);
                self.changed.clear();
                changed
            }
            BuildStage::Placing(_) => {
                self.index.boxes.fit();
                self.stage = BuildStage::Joining(0, self.index.boxes.resort_count());
                0
            }
            BuildStage::Joining(leaves, order) if self.changed.slots().is_empty() => {
                self.join(filter, leaves, order, scratch);
                0
            }
            BuildStage::Listing(_) => {
                self.build(bodies, filter, scratch);
                0
            }
            BuildStage::Joining(..) | BuildStage::Built | BuildStage::Compared(_) => {
                self.compare_changed(task, filter, scratch)
            }
        }
    }

    /// Appends the boxes of slots from `first` on to a list, as many as are due, but not too many at a
    /// time; returns the slot that comes next. The slots of bodies that exist are listed meanwhile.
    fn list(
        &mut self,
        bodies: &BodyTable<'_>,
        first: usize,
        (listed, present): (&mut Vec<BodyBox>, &mut Vec<u32>),
    ) -> usize {
        let until = self.due_slots(bodies).min(first + Self::STEP);
        bodies.list_present(first..until, self.interval, present);
        let before = listed.len();
        let slots = present.iter().copied();
        self.index.list_boxes(bodies, slots, self.interval, listed);
        self.stats.boxes += (listed.len() - before) as u64;
        until
    }

    /// Ends a step: sets the stage, and forgets the changes. If the filter gave up, not all was found, and the step is
    /// still to be done.
    fn end_at(&mut self, stage: BuildStage, filter: &LimitedAdmission<'_>) {
        if filter.gives_up() {
            self.candidates.clear();
            return;
        }
        self.stats.slices += u64::from(stage == BuildStage::Built && self.stage != stage);
        self.stage = stage;
        self.changed.clear();
    }

    /// Compares the bodies in the next leaves with all others. Each body is compared with those in lower slots only, so
    /// that each pair is found once.
    fn join(
        &mut self,
        filter: &LimitedAdmission<'_>,
        leaves: usize,
        order: u32,
        scratch: &mut SliceScratch,
    ) {
        let first = if order == self.index.boxes.resort_count() {
            leaves
        } else {
            0
        };
        let until = self.due_leaves().min(first + Self::STEP_LEAVES);
        scratch.listed.clear();
        let listed = &mut scratch.listed;
        self.index
            .boxes
            .each(first..until, |body| listed.push(body));
        self.list_meeting(filter, scratch, |own, other| other < own);
        let stage = if until == self.index.boxes.leaves() {
            BuildStage::Built
        } else {
            BuildStage::Joining(until, self.index.boxes.resort_count())
        };
        self.end_at(stage, filter);
    }

    /// Builds the tree, once all boxes are formed, and compares all of them.
    fn build(
        &mut self,
        bodies: &BodyTable<'_>,
        filter: &LimitedAdmission<'_>,
        scratch: &mut SliceScratch,
    ) {
        self.index.boxes.build(&self.boxed);
        if !self.changed.slots().is_empty() {
            self.box_changed(bodies, None, scratch);
            self.index.boxes.move_to(&scratch.listed);
        }
        let SliceScratch { sweep, listed, .. } = scratch;
        listed.clear();
        let boxes = &self.index.boxes;
        boxes.each(0..boxes.leaves(), |body| listed.push(body));
        sweep.pairs(listed, filter, &mut self.candidates);
        self.end_at(BuildStage::Built, filter);
        if self.stage == BuildStage::Built {
            self.boxed = Vec::new();
        }
    }
}
