//! One slice of the lookahead: the boxes of all bodies in it, and what has not been compared yet.

use super::bodies::{Bodies, Moved, form};
use super::boxes::Boxes;
use super::finds::Key;
use super::flights::Flight;
use crate::bounds::{Frame, Pose};
use crate::broad_phase::fill::Block;
use crate::broad_phase::{BodyBox, BroadPhase, Candidate, PairFilter, Sweep};
use crate::narrow_phase::{Party, may_touch};
use crate::simd::prefetch;
use crate::spans::{Span, spans};
use crate::stats::Stats;
use std::slice::from_ref;
use std::time::Instant;

/// See the module.
#[derive(Clone, Debug, Default)]
pub(super) struct Slice {
    /// Place on the monitor's grid of time.
    pub(super) index: i64,
    interval: (f64, f64),
    boxes: Boxes,
    /// All boxes are there and were compared with each other, but for the changed bodies'.
    built: bool,
    /// Not built yet: slots below this have their boxes in `boxes`, and were compared; or in
    /// `listed`, as long as there is no order of places.
    prepared: usize,
    is_ordered: bool,
    /// How many slots are to be prepared now: all of them if the slice is needed.
    due: usize,
    is_needed: bool,
    /// Bodies that changed since they were boxed.
    changed: Vec<u32>,
    is_changed: Vec<bool>,
    listed: Vec<BodyBox>,
    /// Memory for forming boxes.
    block: Block,
    candidates: Vec<Candidate>,
    /// Candidates before this one have been looked at.
    sifted: usize,
    /// Spans of some candidates, these by number.
    pieces: Vec<(usize, Span)>,
    sweep: Sweep,
    /// What was found and not taken yet.
    pub(super) survivors: Vec<(Key, Span)>,
    pub(super) stats: Stats,
}

impl Slice {
    /// Sweeping over all boxes costs as much as asking for what meets the boxes of a tenth of the
    /// bodies (measured with 10,000 and 100,000): this share of the places for them.
    const FEW_CHANGED: usize = 16;

    /// Boxes formed, or candidates looked at, before a budget is looked at: some tenths of a
    /// millisecond.
    const STEP: usize = 1024;

    /// Boxes that are asked for what meets them before a filter is asked whether it gives up.
    const ASKED: usize = 64;

    /// Candidates looked at together.
    const BATCH: usize = 16;

    /// Knots that are fetched: few bodies have left more than these behind.
    const KNOTS: usize = 40;

    /// An empty slice in this one's memory.
    pub(super) fn begin(&mut self, index: i64, interval: (f64, f64)) {
        self.index = index;
        self.interval = interval;
        self.built = false;
        self.prepared = 0;
        self.is_ordered = false;
        self.listed.clear();
        self.candidates.clear();
        self.sifted = 0;
        self.forget_changes();
    }

    /// All of the slice is needed from now on.
    pub(super) fn need(&mut self, bodies: &Bodies<'_>) {
        self.due = bodies.flights.len();
        self.is_needed = true;
    }

    /// The slice is not needed yet, but soon: a share of it (0 to 1) is due. In most scenes bodies
    /// have the same neighbours in it as in the one before.
    pub(super) fn foresee(&mut self, bodies: &Bodies<'_>, share: f64, before: &Self) {
        if self.prepared == 0 && !self.is_ordered && before.is_ordered {
            self.boxes.begin_like(&before.boxes);
            self.is_ordered = true;
        }
        let count = bodies.flights.len();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a share of a number of slots"
        )]
        let due = (count as f64 * share).ceil() as usize;
        self.due = due.min(count);
        self.is_needed = false;
    }

    /// Whether all that is due is compared.
    pub(super) fn is_fresh(&self) -> bool {
        let is_there = self.built || (!self.is_needed && self.prepared >= self.due);
        let is_compared = self.changed.is_empty() || !self.is_ordered;
        is_there && is_compared && self.sifted == self.candidates.len()
    }

    /// Notes that bodies have changed; each slot once.
    pub(super) fn note(&mut self, slots: &[u32]) {
        for &slot in slots {
            let place = slot as usize;
            // Not boxed yet.
            if !self.built && place >= self.prepared {
                continue;
            }
            if self.is_changed.len() <= place {
                self.is_changed.resize(place + 1, false);
            }
            if !std::mem::replace(&mut self.is_changed[place], true) {
                self.changed.push(slot);
            }
        }
    }

    const fn ends(&self) -> [f64; 2] {
        [self.interval.0, self.interval.1]
    }

    fn forget_changes(&mut self) {
        for slot in self.changed.drain(..) {
            self.is_changed[slot as usize] = false;
        }
    }

    /// Forms the boxes of slots below `until` that are not there yet, and compares them with those
    /// that are; returns how many slots.
    fn prepare_to<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        until: usize,
    ) -> usize {
        let first = self.prepared;
        let slots = (first..until).filter_map(|slot| u32::try_from(slot).ok());
        let ends = self.ends();
        if self.is_ordered {
            self.listed.clear();
        }
        let (block, listed) = (&mut self.block, &mut self.listed);
        bodies.boxes(slots, &ends, block, |_, boxed| listed.push(boxed));
        if self.is_ordered {
            self.boxes.move_to(&self.listed);
            // All others have smaller slots: each pair once.
            self.list_meeting(filter, |new, other| other < new);
            if filter.gives_up() {
                self.candidates.clear();
                return 0;
            }
        }
        self.prepared = until;
        until - first
    }

    /// Appends the pairs of the listed boxes with the others that they meet and that are wanted
    /// beside them; not all if the filter gives up.
    fn list_meeting<F: PairFilter>(&mut self, filter: &F, wanted: impl Fn(u32, u32) -> bool) {
        for some in self.listed.chunks(Self::ASKED) {
            if filter.gives_up() {
                return;
            }
            let candidates = &mut self.candidates;
            self.boxes.meeting(some, |own, other| {
                let pair = (own.body.min(other), own.body.max(other));
                if wanted(own.body, other) && filter.admits(pair.0, pair.1) {
                    candidates.push(Candidate::new(pair.0, pair.1));
                }
            });
        }
    }

    /// Compares what has not been compared, as long as `goes_on` lets: it is told the work of each
    /// step (boxes and candidates). What is found is added to `survivors` and `stats`. Boxes that
    /// were formed for all slices are taken from `moved`, where this slice has a number.
    pub(super) fn refresh<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        moved: Option<(&Moved, usize)>,
        mut goes_on: impl FnMut(usize) -> bool,
    ) {
        while !self.is_fresh() {
            let begin = Instant::now();
            let work = if self.sifted < self.candidates.len() {
                let work = self.sift(bodies);
                self.stats.narrow_time += begin.elapsed();
                work
            } else {
                let work = self.compare(bodies, filter, moved);
                self.stats.broad_time += begin.elapsed();
                work
            };
            // A slice without a body is work as well: a budget of counted work stops at one place
            // only.
            if !goes_on(1 + work) || filter.gives_up() {
                return;
            }
        }
    }

    /// One step towards all candidates.
    fn compare<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        moved: Option<(&Moved, usize)>,
    ) -> usize {
        self.candidates.clear();
        self.sifted = 0;
        let boxes = if !self.built && self.prepared < self.due {
            let until = self.due.min(self.prepared + Self::STEP);
            self.prepare_to(bodies, filter, until)
        } else {
            let boxes = if self.is_ordered {
                self.compare_changed(bodies, filter, moved)
            } else {
                self.build(bodies, filter);
                0
            };
            if filter.gives_up() {
                // Not all was found: it stays to be done.
                self.candidates.clear();
                return boxes;
            }
            self.is_ordered = true;
            self.forget_changes();
            self.stats.slices += u64::from(self.is_needed && !self.built);
            self.built |= self.is_needed;
            boxes
        };
        self.stats.boxes += boxes as u64;
        self.stats.candidates += self.candidates.len() as u64;
        boxes
    }

    /// All pairs, of boxes that are all there.
    fn build<F: PairFilter>(&mut self, bodies: &Bodies<'_>, filter: &F) {
        self.boxes.build(&self.listed);
        if !self.changed.is_empty() {
            self.box_changed(bodies, None);
            self.boxes.replace(&self.listed);
            self.list_all();
        }
        self.sweep.pairs(&self.listed, filter, &mut self.candidates);
    }

    /// Changed bodies against all.
    fn compare_changed<F: PairFilter>(
        &mut self,
        bodies: &Bodies<'_>,
        filter: &F,
        moved: Option<(&Moved, usize)>,
    ) -> usize {
        let changed = self.changed.len();
        self.box_changed(bodies, moved);
        if changed > self.boxes.capacity() / Self::FEW_CHANGED {
            self.boxes.replace(&self.listed);
            self.list_all();
            let filter = Concerns {
                is_changed: &self.is_changed,
                filter,
            };
            self.sweep
                .pairs(&self.listed, &filter, &mut self.candidates);
        } else {
            self.boxes.move_to(&self.listed);
            self.list_meeting(filter, |moved, other| other != moved);
        }
        changed
    }

    /// Lists the boxes of the changed bodies; takes out those that have none any more.
    fn box_changed(&mut self, bodies: &Bodies<'_>, moved: Option<(&Moved, usize)>) {
        self.listed.clear();
        let ends = self.ends();
        let (block, listed) = (&mut self.block, &mut self.listed);
        match moved {
            Some((moved, number)) if moved.are(&self.changed) => moved.list(number, listed),
            _ => {
                let changed = self.changed.iter().copied();
                bodies.boxes(changed, &ends, block, |_, boxed| listed.push(boxed));
            }
        }
        // In the order of `changed`, but for those that are missing.
        let mut boxed = listed.iter().map(|boxed| boxed.body).peekable();
        for &slot in &self.changed {
            if boxed.next_if_eq(&slot).is_none() {
                self.boxes.remove(slot);
            }
        }
    }

    fn list_all(&mut self) {
        self.listed.clear();
        let listed = &mut self.listed;
        self.boxes.each(|body| listed.push(body));
    }

    /// Keeps the spans of some more candidates that cheap tests cannot rule out. Bodies that have
    /// changed since are compared anew.
    fn sift(&mut self, bodies: &Bodies<'_>) -> usize {
        let first = self.sifted;
        self.sifted = self.candidates.len().min(first + Self::STEP);
        let is_changed = |slot: u32| self.is_changed.get(slot as usize) == Some(&true);
        for batch in self.candidates[first..self.sifted].chunks(Self::BATCH) {
            // What each loop reads lies anywhere in memory, and was fetched by the one before.
            let mut pairs = [[Party::NONE; 2]; Self::BATCH];
            for (pair, candidate) in pairs.iter_mut().zip(batch) {
                let slots = [candidate.a, candidate.b];
                if slots.into_iter().any(is_changed) {
                    continue;
                }
                *pair = slots.map(|slot| bodies.party(slot).unwrap_or(Party::NONE));
                for party in &*pair {
                    prefetch(&party.knots[..party.knots.len().min(Self::KNOTS)]);
                }
            }
            self.pieces.clear();
            for (number, [a, b]) in pairs.iter().enumerate() {
                for span in spans(a.knots, b.knots, self.interval.0, self.interval.1) {
                    prefetch(from_ref(&a.segments[span.a as usize]));
                    prefetch(from_ref(&b.segments[span.b as usize]));
                    self.pieces.push((number, span));
                }
            }
            self.stats.spans += self.pieces.len() as u64;
            for &(number, span) in &self.pieces {
                let [a, b] = &pairs[number];
                if may_touch(a, b, span, bodies.margin, self.interval) {
                    let key = Key {
                        a: batch[number].a,
                        b: batch[number].b,
                        span_a: span.a,
                        span_b: span.b,
                    };
                    self.survivors.push((key, span));
                }
            }
        }
        self.sifted - first
    }

    /// Bodies that a body's box over the slice may meet.
    pub(super) fn near(
        &self,
        (flight, party): (&Flight, &Party<'_>),
        frame: &Frame,
        block: &mut Block,
        near: &mut Vec<u32>,
    ) {
        let pose = Pose::plain(party.segments, &flight.inflation, frame);
        form(&[*party], &[pose], &self.ends(), block);
        let boxes = &block.slices[0].boxes;
        self.boxes.meeting(boxes, |_, other| near.push(other));
        near.extend_from_slice(&self.changed);
    }

    /// Whether the slice has boxes, all of them if it is needed, and a time in common with an
    /// interval.
    pub(super) fn covers_some_of(&self, (from, to): (f64, f64)) -> bool {
        self.is_ordered && self.interval.0 <= to && self.interval.1 >= from
    }
}

/// Wants pairs with a changed body.
struct Concerns<'f, F> {
    is_changed: &'f [bool],
    filter: &'f F,
}

impl<F: PairFilter> PairFilter for Concerns<'_, F> {
    fn admits(&self, a: u32, b: u32) -> bool {
        let is_changed = |slot: u32| self.is_changed.get(slot as usize) == Some(&true);
        (is_changed(a) || is_changed(b)) && self.filter.admits(a, b)
    }

    fn gives_up(&self) -> bool {
        self.filter.gives_up()
    }
}
