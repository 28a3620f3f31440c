//! One slice of the lookahead: the boxes of all bodies in it, and what has not been compared yet.

mod ask;
mod changes;
mod parts;
mod sift;
mod state;

use super::bodies::{Bodies, Moved};
use super::finds::Crowded;
use crate::bounds::Course;
use crate::broad_phase::{BodyBox, BroadPhase, Candidate, PairFilter, Room};
use crate::search::Block;
use crate::wall_clock::Instant;
pub(super) use ask::{Answer, Neighbour};
pub(super) use state::{Limits, Scratch, Slice};
use state::{Part, Stage};

impl Slice {
    /// Boxes formed, or candidates looked at, before a budget is looked at: some tenths of a
    /// millisecond.
    const STEP: usize = 1024;

    /// Which share of the work for a slice is forming and placing its boxes; the rest is comparing
    /// them.
    const PLACING: f64 = 0.6;

    /// Leaves with as many bodies.
    const STEP_LEAVES: usize = 100;

    /// Pairs of so many boxes as are asked for at a time that are many.
    const MANY: usize = 1 << 14;

    /// Memory for so many candidates, and four a body, is kept when all were looked at: there are many
    /// slices.
    const FEW_CANDIDATES: usize = 1024;

    /// Boxes that are asked for what meets them before a filter is asked whether it gives up.
    const ASKED: usize = 64;

    /// Of a body without a box: nobody asks for it.
    const NO_COURSE: Course = Course {
        start: [0.0; 3],
        change: [0.0; 3],
        slack: f32::INFINITY,
        first: 0,
    };

    /// An empty slice in this one's memory.
    pub(super) fn begin(&mut self, index: i64, interval: (f64, f64)) {
        self.index = index;
        self.interval = interval;
        self.stage = Stage::default();
        self.due = 0.0;
        self.boxed.clear();
        self.candidates.clear();
        self.sifted = 0;
        self.is_crowded = false;
        self.is_put_off = false;
        self.survivors.clear();
        self.parts.clear();
        self.forget_changes();
    }

    /// Forgets what was done for it until it is needed: there is no room.
    pub(super) fn put_off(&mut self) {
        self.begin(self.index, self.interval);
        self.is_put_off = true;
    }

    /// # Errors
    ///
    /// If what was looked at last had too little room.
    pub(super) const fn check_room(&self) -> Result<(), Crowded> {
        if self.is_crowded {
            Err(Crowded)
        } else {
            Ok(())
        }
    }

    /// Where it ends, s.
    pub(super) const fn end(&self) -> f64 {
        self.interval.1
    }

    /// All of the slice is needed from now on.
    pub(super) const fn need(&mut self) {
        self.due = 1.0;
    }

    /// The slice is not needed yet, but soon: a share of it (0 to 1) is due. In most scenes bodies
    /// have the same neighbours in it as in the one before.
    pub(super) fn foresee(&mut self, share: f64, before: &Self) {
        if self.is_put_off {
            return;
        }
        if share > 0.0 && self.stage == Stage::default() {
            if !before.is_placed() {
                // It is likely to be there with the next tick.
                return;
            }
            self.boxes.begin_like(&before.boxes);
            self.stage = Stage::Placing(0);
        }
        self.due = share;
    }

    /// How much of `count` is due now in a stage of the work, which lasts from one share to
    /// another.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a share of a number of slots"
    )]
    fn due_of(&self, count: usize, (from, to): (f64, f64)) -> usize {
        let share = ((self.due - from) / (to - from)).clamp(0.0, 1.0);
        (count as f64 * share).ceil() as usize
    }

    /// How many slots are to have boxes now.
    fn due_slots(&self, bodies: &Bodies<'_>) -> usize {
        self.due_of(bodies.flights.len(), (0.0, Self::PLACING))
    }

    /// How many leaves are to be compared now.
    fn due_leaves(&self) -> usize {
        self.due_of(self.boxes.leaves(), (Self::PLACING, 1.0))
    }

    /// Whether all bodies have their boxes in the tree.
    pub(super) const fn is_placed(&self) -> bool {
        matches!(self.stage, Stage::Joining(..) | Stage::Built)
    }

    /// Whether all that is due is compared.
    pub(super) fn is_fresh(&self, bodies: &Bodies<'_>) -> bool {
        let is_there = match self.stage {
            // What has changed is looked at when the slice is built.
            Stage::Listing(slots) => {
                return self.due < 1.0 && slots >= self.due_slots(bodies);
            }
            // With the last of them they are to be joined.
            Stage::Placing(slots) => {
                let due = self.due_slots(bodies);
                self.due < 1.0 && slots >= due && slots < bodies.flights.len()
            }
            Stage::Joining(leaves, order) => {
                self.due < 1.0 && leaves >= self.due_leaves() && order == self.boxes.orders()
            }
            Stage::Built => true,
        };
        is_there
            && self.changed.is_empty()
            && self.parts.is_empty()
            && self.sifted == self.candidates.len()
    }

    /// How many boxes are to be formed, at most.
    pub(super) fn missing(&self, bodies: &Bodies<'_>) -> usize {
        match self.stage {
            Stage::Built => self.changed.len(),
            _ => bodies.flights.len(),
        }
    }

    const fn ends(&self) -> [f64; 2] {
        [self.interval.0, self.interval.1]
    }

    /// Appends the pairs of the listed boxes with the others that they meet and that are wanted
    /// beside them; not all if the filter gives up. Few are asked for admission only when they are
    /// looked at, which is cheaper; of many, those that are not admitted would fill the memory.
    fn list_meeting<F: PairFilter>(
        &mut self,
        filter: &F,
        scratch: &mut Scratch,
        wanted: impl Fn(u32, u32) -> bool,
    ) {
        for some in scratch.listed.chunks(Self::ASKED) {
            if filter.gives_up() {
                return;
            }
            let candidates = &mut self.candidates;
            let before = candidates.len();
            self.boxes.meeting(some, &mut scratch.search, |own, other| {
                if wanted(own.body, other) {
                    candidates.push(Candidate::new(own.body, other));
                }
            });
            if candidates.len() - before > Self::MANY {
                let mut kept = before;
                for number in before..candidates.len() {
                    let pair = candidates[number];
                    if filter.admits(pair.a, pair.b) {
                        candidates[kept] = pair;
                        kept += 1;
                    }
                }
                candidates.truncate(kept);
            }
        }
    }

    /// Compares what has not been compared, as long as `goes_on` lets: it is told the work of each
    /// step (boxes and candidates); and as long as there [is room](Self::check_room). What is found is
    /// added to `survivors` and `stats`. Boxes that were formed for all slices are taken from `moved`,
    /// where this slice has a number.
    pub(super) fn refresh<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        moved: Option<(&Moved, usize)>,
        limits: Limits,
        scratch: &mut Scratch,
        goes_on: impl FnMut(usize) -> bool,
    ) {
        self.take_steps(bodies, filter, moved, limits, scratch, goes_on);
        let is_used = self.sifted < self.candidates.len();
        if !is_used && self.candidates.capacity() > Self::FEW_CANDIDATES + 4 * self.courses.len() {
            self.candidates = Vec::new();
            self.sifted = 0;
        }
    }

    fn take_steps<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        moved: Option<(&Moved, usize)>,
        limits: Limits,
        scratch: &mut Scratch,
        mut goes_on: impl FnMut(usize) -> bool,
    ) {
        self.is_crowded = false;
        while !self.is_fresh(bodies) {
            let begin = Instant::now();
            let work = if self.sifted < self.candidates.len() {
                let work = self.sift(bodies, filter, scratch);
                self.stats.narrow_time += begin.elapsed();
                work
            } else {
                let work = self.look(bodies, filter, moved, limits.candidates, scratch);
                self.stats.broad_time += begin.elapsed();
                work
            };
            self.is_crowded |= self.survivors.len() > limits.survivors;
            // A slice without a body is work as well: a budget of counted work stops at one place
            // only.
            if !goes_on(1 + work) || filter.gives_up() || self.is_crowded {
                return;
            }
        }
    }

    /// One step towards all candidates, with room for so many at a time; returns how many boxes were formed.
    /// A slice in which there are more is divided.
    fn look<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        moved: Option<(&Moved, usize)>,
        room: u64,
        scratch: &mut Scratch,
    ) -> usize {
        self.candidates.clear();
        self.sifted = 0;
        let part = self.parts.pop();
        let room = Part::room(part.as_ref(), bodies.flights.len(), room);
        let filter = &Room::new(filter, room);
        let boxes = match &part {
            Some(part) => self.compare_part(bodies, filter, part, scratch),
            None => self.compare(bodies, filter, moved, scratch),
        };
        if filter.is_short() {
            self.candidates.clear();
            self.divide(part, scratch);
        } else if filter.gives_up() {
            self.candidates.clear();
            self.parts.extend(part);
        }
        self.stats.candidates += self.candidates.len() as u64;
        boxes
    }

    /// One step towards all candidates of the slice as a whole; returns how many boxes were formed.
    fn compare<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        moved: Option<(&Moved, usize)>,
        scratch: &mut Scratch,
    ) -> usize {
        match self.stage {
            Stage::Listing(slots) if slots < self.due_slots(bodies) => {
                let mut boxed = std::mem::take(&mut self.boxed);
                let until = self.list(bodies, slots, &mut boxed, &mut scratch.block);
                self.boxed = boxed;
                self.stage = Stage::Listing(until);
                until - slots
            }
            Stage::Placing(slots) if slots < self.due_slots(bodies) => {
                let Scratch { listed, block, .. } = scratch;
                listed.clear();
                let until = self.list(bodies, slots, listed, block);
                self.boxes.move_to(listed);
                self.stage = Stage::Placing(until);
                until - slots
            }
            Stage::Placing(slots) if slots < bodies.flights.len() => {
                let changed = self.changed.len();
                self.box_changed(bodies, moved, scratch);
                self.boxes.move_to(&scratch.listed);
                self.forget_changes();
                changed
            }
            Stage::Placing(_) => {
                self.boxes.fit();
                self.stage = Stage::Joining(0, self.boxes.orders());
                0
            }
            Stage::Joining(leaves, order) if self.changed.is_empty() => {
                self.join(filter, leaves, order, scratch);
                0
            }
            Stage::Listing(_) => {
                self.build(bodies, filter, scratch);
                0
            }
            Stage::Joining(..) | Stage::Built => {
                self.compare_changed(bodies, filter, moved, scratch)
            }
        }
    }

    /// Appends the boxes of slots from `first` on to a list, as many as are due, but not too many at a
    /// time; returns the slot that comes next.
    fn list(
        &mut self,
        bodies: &Bodies<'_>,
        first: usize,
        listed: &mut Vec<BodyBox>,
        block: &mut Block,
    ) -> usize {
        let until = self.due_slots(bodies).min(first + Self::STEP);
        let slots = (first..until).filter_map(|slot| u32::try_from(slot).ok());
        let ends = self.ends();
        let courses = &mut self.courses;
        courses.resize(bodies.flights.len(), Self::NO_COURSE);
        let before = listed.len();
        bodies.boxes(slots, &ends, block, |_, boxed, course| {
            courses[boxed.body as usize] = *course;
            listed.push(boxed);
        });
        self.stats.boxes += (listed.len() - before) as u64;
        until
    }

    /// All is compared, unless the filter gave up: then not all was found, and it stays to be done.
    fn end_at<F: PairFilter>(&mut self, stage: Stage, filter: &F) {
        if filter.gives_up() {
            self.candidates.clear();
            return;
        }
        self.stats.slices += u64::from(stage == Stage::Built && self.stage != stage);
        self.stage = stage;
        self.forget_changes();
    }

    /// Compares the bodies of some more leaves, one of a pair after the other, with all.
    fn join<F: PairFilter>(
        &mut self,
        filter: &F,
        leaves: usize,
        order: u32,
        scratch: &mut Scratch,
    ) {
        let first = if order == self.boxes.orders() {
            leaves
        } else {
            0
        };
        let until = self.due_leaves().min(first + Self::STEP_LEAVES);
        scratch.listed.clear();
        let listed = &mut scratch.listed;
        self.boxes.each(first..until, |body| listed.push(body));
        self.list_meeting(filter, scratch, |own, other| other < own);
        let stage = if until == self.boxes.leaves() {
            Stage::Built
        } else {
            Stage::Joining(until, self.boxes.orders())
        };
        self.end_at(stage, filter);
    }

    /// All pairs, of boxes that are all there.
    fn build<F: PairFilter>(&mut self, bodies: &Bodies<'_>, filter: &F, scratch: &mut Scratch) {
        self.boxes.build(&self.boxed);
        if self.changed.is_empty() {
            scratch.listed.clone_from(&self.boxed);
        } else {
            self.box_changed(bodies, None, scratch);
            self.boxes.replace(&scratch.listed);
            self.list_all(&mut scratch.listed);
        }
        let Scratch { sweep, listed, .. } = scratch;
        sweep.pairs(listed, filter, &mut self.candidates);
        self.end_at(Stage::Built, filter);
        if self.stage == Stage::Built {
            self.boxed = Vec::new();
        }
    }

    fn list_all(&self, listed: &mut Vec<BodyBox>) {
        listed.clear();
        self.boxes
            .each(0..self.boxes.leaves(), |body| listed.push(body));
    }
}
