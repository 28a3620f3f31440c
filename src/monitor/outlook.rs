//! What lies ahead: every span in which a pair may come within the largest margin, solved once.
//!
//! The lookahead is cut into slices on a fixed grid of time. A slice knows the boxes of all bodies
//! in it, and which bodies have changed since they were compared. Catching up goes through the
//! slices in the order of time, so that what is known is always complete up to some instant.

use super::boxes::Boxes;
use super::budget::Meter;
use crate::bounds::{Anchor, Frame, Hull, Inflation, Part};
use crate::broad_phase::{BodyBox, BroadPhase, Candidate, PairFilter};
use crate::error::Error;
use crate::hitbox::Sphere;
use crate::narrow_phase::{Contact, Party, Solved, contacts, contacts_of, may_touch, solve};
use crate::spans::{Span, common_domain, spans};
use crate::stats::Stats;
use crate::trajectory::{Pieces, Trajectory};
use crate::window::Window;
use std::collections::VecDeque;
use std::time::Instant;

/// A body as the outlook sees it; its place is its slot in the scene.
#[derive(Clone, Debug)]
pub(super) struct Flight {
    pub(super) spheres: Vec<Sphere>,
    bounding: Sphere,
    inflation: Inflation,
    trajectory: Trajectory,
    /// Pieces beyond the knots, where the body exists there: they begin with the monitor's window
    /// at the time the plan was set, so that their numbers stay as the window's end moves on.
    beyond: Option<Pieces<'static>>,
    begin: f64,
}

impl Flight {
    /// Up to where the pieces reach of a body that exists for ever, s.
    fn endless_until(&self) -> f64 {
        if self.trajectory.domain() == Window::ALL {
            let last = self.party().knots.last().copied();
            last.unwrap_or(f64::NEG_INFINITY)
        } else {
            f64::INFINITY
        }
    }

    pub(super) fn party(&self) -> Party<'_> {
        let (knots, segments) = match &self.beyond {
            Some(pieces) => (&pieces.knots[..], &pieces.segments[..]),
            None => (self.trajectory.knots(), self.trajectory.segments()),
        };
        Party {
            knots,
            segments,
            spheres: &self.spheres,
            bounding: self.bounding,
        }
    }
}

/// A pair's span that was found to matter, and its solution for one pair of spheres.
#[derive(Clone, Copy, Debug)]
struct Find {
    key: Key,
    solved: Solved,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    a: u32,
    b: u32,
    span_a: u32,
    span_b: u32,
}

/// The solved spans of one pair.
#[derive(Debug)]
pub(super) struct Group<'o> {
    finds: &'o [Find],
}

impl Group<'_> {
    /// All contacts within `margin` in `clip`, in the order of time; replaces what `found` held.
    pub(super) fn contacts(&self, margin: f64, clip: (f64, f64), found: &mut Vec<Contact>) {
        found.clear();
        let solved = self.finds.iter().map(|find| &find.solved);
        contacts_of(solved, margin, clip, found);
    }
}

#[derive(Clone, Debug, Default)]
struct Slice {
    index: i64,
    boxes: Boxes,
    /// All boxes are there and were compared with each other, but for the changed bodies'.
    built: bool,
    /// Bodies that changed since.
    changed: Vec<u32>,
}

/// See the module.
#[derive(Debug)]
pub(super) struct Outlook<B> {
    flights: Vec<Option<Flight>>,
    margin: f64,
    frame: Frame,
    origin: f64,
    length: f64,
    slices: VecDeque<Slice>,
    spare: Vec<Slice>,
    /// Sorted by key.
    finds: Vec<Find>,
    merged: Vec<Find>,
    method: B,
    listed: Vec<BodyBox>,
    candidates: Vec<Candidate>,
    survivors: Vec<(Key, Span)>,
    /// Bodies that changed since the last catching up, each once.
    dirty: Vec<u32>,
    is_dirty: Vec<bool>,
    /// No body that exists for ever is laid out less far than this, s.
    endless_until: f64,
}

impl<B: BroadPhase> Outlook<B> {
    /// An outlook for pairs within `margin` (m) on a grid of slices of `length` s from `origin`.
    pub(super) fn new(margin: f64, frame: Frame, origin: f64, length: f64) -> Self {
        Self {
            flights: Vec::new(),
            margin,
            frame,
            origin,
            length,
            slices: VecDeque::new(),
            spare: Vec::new(),
            finds: Vec::new(),
            merged: Vec::new(),
            method: B::default(),
            listed: Vec::new(),
            candidates: Vec::new(),
            survivors: Vec::new(),
            dirty: Vec::new(),
            is_dirty: Vec::new(),
            endless_until: f64::INFINITY,
        }
    }

    pub(super) fn flight(&self, slot: u32) -> Option<&Flight> {
        self.flights.get(slot as usize)?.as_ref()
    }

    /// What a body's plan means over `window`, without changing anything.
    pub(super) fn prepare(
        &self,
        trajectory: &Trajectory,
        spheres: &[Sphere],
        bounding: Sphere,
        window: Window,
    ) -> Result<Flight, Error> {
        let pieces = trajectory.pieces(window)?;
        let own = pieces.segments.len() == trajectory.segments().len();
        let beyond = (!own || trajectory.segments().is_empty()).then(|| pieces.into_owned());
        Ok(Flight {
            spheres: spheres.to_vec(),
            bounding,
            inflation: Inflation::of(spheres, bounding, self.margin, &self.frame),
            trajectory: trajectory.clone(),
            beyond,
            begin: window.start(),
        })
    }

    /// Puts a body's new state of affairs in place (none: it is gone). What was found of it is
    /// forgotten, and looked for again.
    pub(super) fn set(&mut self, slot: u32, flight: Option<Flight>) {
        let place = slot as usize;
        if self.flights.len() <= place {
            self.flights.resize(place + 1, None);
        }
        if let Some(flight) = &flight {
            self.endless_until = self.endless_until.min(flight.endless_until());
        }
        self.flights[place] = flight;
        self.forget(slot);
    }

    /// Looks for a body's pairs anew: its filter changed.
    pub(super) fn forget(&mut self, slot: u32) {
        let place = slot as usize;
        if self.is_dirty.len() <= place {
            self.is_dirty.resize(place + 1, false);
        }
        if !std::mem::replace(&mut self.is_dirty[place], true) {
            self.dirty.push(slot);
        }
    }

    /// Drops what was found of changed bodies, and marks them in each slice: once for all of them.
    fn spread_changes(&mut self) {
        if self.dirty.is_empty() {
            return;
        }
        self.is_dirty.resize(self.flights.len(), false);
        let is_dirty = |slot: u32| self.is_dirty[slot as usize];
        self.finds
            .retain(|find| !is_dirty(find.key.a) && !is_dirty(find.key.b));
        for slice in self.slices.iter_mut().filter(|slice| slice.built) {
            slice.changed.extend_from_slice(&self.dirty);
        }
        for slot in self.dirty.drain(..) {
            self.is_dirty[slot as usize] = false;
        }
    }

    /// How far plans must be laid out for a lookahead that ends at `end`: to the end of its last
    /// slice, since a slice is compared as a whole.
    pub(super) fn laid_out(&self, end: f64) -> f64 {
        end + self.length
    }

    /// Extends plans that go on beyond their knots so that they cover a lookahead until `end`.
    pub(super) fn extend_beyond(&mut self, end: f64) -> Result<(), (u32, Error)> {
        let end = self.laid_out(end);
        if self.endless_until >= end {
            return Ok(());
        }
        let mut until = f64::INFINITY;
        for (slot, flight) in (0..).zip(&mut self.flights) {
            let Some(flight) = flight else { continue };
            if flight.endless_until() < end {
                let window = Window::new(flight.begin, end).map_err(|error| (slot, error))?;
                let pieces = flight.trajectory.pieces(window);
                flight.beyond = Some(pieces.map_err(|error| (slot, error))?.into_owned());
            }
            until = until.min(flight.endless_until());
        }
        self.endless_until = until;
        Ok(())
    }

    /// Brings the slices from `from` to `to` up to date, soonest first, as far as the meter lets.
    /// Returns the instant up to which everything is known.
    pub(super) fn catch_up<F: PairFilter>(
        &mut self,
        (from, to): (f64, f64),
        filter: &F,
        meter: &mut Meter,
        stats: &mut Stats,
    ) -> f64 {
        self.drop_before(from);
        self.spread_changes();
        let mut index = self.index(from);
        let mut known = from;
        for place in 0.. {
            if self.start(index) > to {
                break;
            }
            if place == self.slices.len() {
                let mut slice = self.spare.pop().unwrap_or_default();
                slice.index = index;
                slice.built = false;
                slice.changed.clear();
                self.slices.push_back(slice);
            }
            let fresh = {
                let slice = &self.slices[place];
                slice.built && slice.changed.is_empty()
            };
            if !fresh {
                if meter.is_spent() {
                    self.settle(from, stats);
                    return known.min(to);
                }
                self.refresh(place, filter, meter, stats);
            }
            index += 1;
            known = self.start(index);
        }
        self.settle(from, stats);
        to
    }

    /// Compares what has not been compared in one slice.
    fn refresh<F: PairFilter>(
        &mut self,
        place: usize,
        filter: &F,
        meter: &mut Meter,
        stats: &mut Stats,
    ) {
        let begin = Instant::now();
        let interval = self.interval(self.slices[place].index);
        let slice = &mut self.slices[place];
        self.candidates.clear();
        let frame = &self.frame;
        self.listed.clear();
        // A slice without a body is work as well: a budget of counted work stops at one place only.
        meter.count(1);
        if slice.built {
            slice.changed.sort_unstable();
            slice.changed.dedup();
            for &body in &slice.changed {
                let flight = self.flights[body as usize].as_ref();
                let moved = flight.and_then(|flight| box_of(flight, body, interval, frame));
                slice
                    .boxes
                    .set(body, moved.as_ref().map(|moved| &moved.aabb));
                self.listed.extend(moved);
            }
            for moved in &self.listed {
                slice.boxes.meeting(&moved.aabb, |other| {
                    let pair = (moved.body.min(other), moved.body.max(other));
                    if other != moved.body && filter.admits(pair.0, pair.1) {
                        self.candidates.push(Candidate::new(pair.0, pair.1));
                    }
                });
            }
            meter.count(slice.changed.len() * (1 + self.flights.len() / 1024));
        } else {
            let flights = (0..).zip(&self.flights);
            let boxes = flights
                .filter_map(|(body, flight)| box_of(flight.as_ref()?, body, interval, frame));
            self.listed.extend(boxes);
            slice.boxes.build(&self.listed);
            self.method
                .pairs(&self.listed, filter, &mut self.candidates);
            stats.slices += 1;
            meter.count(self.listed.len());
        }
        stats.boxes += self.listed.len() as u64;
        slice.built = true;
        slice.changed.clear();
        stats.candidates += self.candidates.len() as u64;
        meter.count(self.candidates.len());
        let found = Instant::now();
        stats.broad_time += found - begin;
        self.sift(interval, stats);
        stats.narrow_time += found.elapsed();
    }

    /// Keeps the spans of the candidates that cheap tests cannot rule out.
    fn sift(&mut self, interval: (f64, f64), stats: &mut Stats) {
        for candidate in &self.candidates {
            let flights =
                [candidate.a, candidate.b].map(|slot| self.flights[slot as usize].as_ref());
            let [Some(a), Some(b)] = flights else {
                continue;
            };
            let (a, b) = (a.party(), b.party());
            for span in spans(a.knots, b.knots, interval.0, interval.1) {
                stats.spans += 1;
                if may_touch(&a, &b, span, self.margin, interval) {
                    let key = Key {
                        a: candidate.a,
                        b: candidate.b,
                        span_a: span.a,
                        span_b: span.b,
                    };
                    self.survivors.push((key, span));
                }
            }
        }
    }

    /// Solves the survivors that are new, and forgets what is past.
    fn settle(&mut self, from: f64, stats: &mut Stats) {
        let begin = Instant::now();
        self.finds.retain(|find| find.solved.span().end >= from);
        self.survivors.sort_unstable_by_key(|(key, _)| *key);
        self.survivors.dedup_by_key(|(key, _)| *key);
        if self.survivors.is_empty() {
            return;
        }
        self.merged.clear();
        let mut old = self.finds.iter().peekable();
        for &(key, span) in &self.survivors {
            while let Some(find) = old.next_if(|find| find.key < key) {
                self.merged.push(*find);
            }
            if old.peek().is_some_and(|find| find.key == key) {
                continue;
            }
            let flights = [key.a, key.b].map(|slot| self.flights[slot as usize].as_ref());
            let [Some(a), Some(b)] = flights else {
                continue;
            };
            stats.survivors += 1;
            solve(&a.party(), &b.party(), span, self.margin, |solved| {
                self.merged.push(Find { key, solved });
            });
        }
        self.merged.extend(old.copied());
        std::mem::swap(&mut self.finds, &mut self.merged);
        self.survivors.clear();
        stats.narrow_time += begin.elapsed();
    }

    /// Calls `visit` with each pair that may have contacts in `from..=to`: slots, the clip, and
    /// its solved spans.
    pub(super) fn each_pair(
        &self,
        (from, to): (f64, f64),
        mut visit: impl FnMut((u32, u32), (f64, f64), &Group<'_>),
    ) {
        for finds in self
            .finds
            .chunk_by(|x, y| (x.key.a, x.key.b) == (y.key.a, y.key.b))
        {
            let pair = (finds[0].key.a, finds[0].key.b);
            if let Some(clip) = self.clip(pair, (from, to)) {
                visit(pair, clip, &Group { finds });
            }
        }
    }

    /// When both bodies of a pair exist.
    pub(super) fn domain(&self, (a, b): (u32, u32)) -> Option<(f64, f64)> {
        common_domain(self.flight(a)?.party().knots, self.flight(b)?.party().knots)
    }

    /// Contacts of one plan that is not in place with all others, within `from..=to`.
    pub(super) fn contacts_with<F: PairFilter>(
        &self,
        slot: u32,
        plan: &Flight,
        margin: f64,
        (from, to): (f64, f64),
        filter: &F,
        mut visit: impl FnMut(u32, (f64, f64), &Party<'_>, &Contact),
    ) {
        let own = plan.party();
        let mut near = self.dirty.clone();
        for slice in &self.slices {
            let interval = self.interval(slice.index);
            let boxed = box_of(plan, slot, interval, &self.frame);
            if let Some(boxed) = boxed.filter(|_| interval.0 <= to && interval.1 >= from) {
                slice.boxes.meeting(&boxed.aabb, |other| near.push(other));
                near.extend_from_slice(&slice.changed);
            }
        }
        near.sort_unstable();
        near.dedup();
        let mut found = Vec::new();
        for other in near {
            let admitted = other != slot && filter.admits(slot.min(other), slot.max(other));
            let Some(flight) = self.flight(other).filter(|_| admitted) else {
                continue;
            };
            let party = flight.party();
            // The smaller slot is a: the same order, and so the same bits, as everywhere.
            let (a, b) = if slot < other {
                (&own, &party)
            } else {
                (&party, &own)
            };
            let domain = common_domain(a.knots, b.knots);
            let clip = domain.map(|(start, end)| (start.max(from), end.min(to)));
            let Some(clip) = clip.filter(|clip| clip.0 <= clip.1) else {
                continue;
            };
            let near = spans(a.knots, b.knots, clip.0, clip.1)
                .filter(|&span| may_touch(a, b, span, margin, clip));
            found.clear();
            contacts(a, b, near, margin, clip, &mut found);
            for contact in &found {
                visit(other, clip, &party, contact);
            }
        }
    }

    fn clip(&self, pair: (u32, u32), (from, to): (f64, f64)) -> Option<(f64, f64)> {
        let (start, end) = self.domain(pair)?;
        let (start, end) = (start.max(from), end.min(to));
        (start <= end).then_some((start, end))
    }

    fn drop_before(&mut self, from: f64) {
        let first = self.index(from);
        while self.slices.front().is_some_and(|slice| slice.index < first) {
            self.spare.extend(self.slices.pop_front());
        }
    }

    fn interval(&self, index: i64) -> (f64, f64) {
        (self.start(index), self.start(index + 1))
    }

    #[allow(
        clippy::cast_precision_loss,
        reason = "a slice's number is far below 2^53"
    )]
    fn start(&self, index: i64) -> f64 {
        self.origin + self.length * index as f64
    }

    /// The slice that `time` lies in; on a cut, the one before it, since slices are closed.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "saturates; a lookahead of 2^63 slices is refused by `Monitor`"
    )]
    fn index(&self, time: f64) -> i64 {
        let mut index = ((time - self.origin) / self.length).floor() as i64;
        while self.start(index) >= time {
            index -= 1;
        }
        index
    }
}

/// A body's box over an interval, if it exists in it.
fn box_of(flight: &Flight, body: u32, (from, to): (f64, f64), frame: &Frame) -> Option<BodyBox> {
    let party = flight.party();
    let (&first, &last) = (party.knots.first()?, party.knots.last()?);
    if first > to || last < from {
        return None;
    }
    let mut hull = Hull::EMPTY;
    let begin = party.knots.partition_point(|&knot| knot < from).max(1) - 1;
    let anchor = Anchor::at(party.segments.get(begin)?, frame);
    for (ends, segment) in party.knots[begin..]
        .windows(2)
        .zip(&party.segments[begin..])
    {
        if ends[0] > to {
            break;
        }
        let part = (ends[0].max(from), ends[1].min(to));
        hull.include(&Part::of(segment, part, &anchor));
    }
    Some(BodyBox {
        aabb: hull.inflated(&flight.inflation, &anchor),
        body,
    })
}
