//! Half-spaces against all other bodies of a monitor: no slice has boxes of them.
//!
//! A body is compared with the half-spaces when it changes, from the clock to some time ahead, and
//! again when the lookahead reaches that time. So in most ticks few bodies are compared. When a
//! half-space changes, all bodies are. Many games tell each frame that a half-space rests where it
//! rested: then only bodies that may touch it are compared again, since their spans have other numbers.

use super::bodies::BodyTable;
use super::budget::BudgetMeter;
use super::due_times::DueTimes;
use super::monitored_bodies::MonitoredBodies;
use crate::broad_phase::PairFilter;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::narrow_phase::{BodyView, may_touch};
use crate::rounding::{seen_from, seen_until};
use crate::scene::Scene;
use crate::search::LimitExceeded;
use crate::spans::{SpanKey, spans};
use glam::DVec3;

/// The comparison of half-spaces with all other bodies.
#[derive(Debug, Default)]
pub(super) struct HalfSpaceSearch {
    /// Slots of half-spaces, ascending, as of the last call of [`note`](Self::note).
    planes: Vec<u32>,
    /// Each half-space as it was when it changed last, if it rested then.
    resting: Vec<Option<RestingPlane>>,
    /// Places in these lists of those that have changed since.
    changed_planes: Vec<usize>,
    /// True, by slot, if a span with a half-space may be listed.
    near: Vec<bool>,
    /// Instant up to which each body was compared, s.
    due: DueTimes,
    /// Slots to be compared again, and the instants up to which they are compared, s.
    taken: Vec<(f64, u32)>,
    /// Slots to be compared from the clock on, and where the next one is in this list.
    changed: Vec<u32>,
    next: usize,
}

/// A half-space at rest at all times, and all that its pairs depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RestingPlane {
    id: BodyId,
    position: DVec3,
    normal: DVec3,
    model_error: f64,
    layers: Layers,
}

impl RestingPlane {
    /// Returns the half-space in a slot, if it rests.
    fn of(scene: &Scene, slot: u32) -> Option<Self> {
        let (id, entry) = scene.in_slot(slot)?;
        let body = &entry.body;
        let motions = body.trajectory.straight_motions();
        let position = motions.first()?.origin();
        let rests = motions
            .iter()
            .all(|motion| motion.velocity() == DVec3::ZERO && motion.origin() == position);
        let plane = Self {
            id,
            position,
            normal: body.hitbox.normal()?,
            model_error: body.shape().model_error(),
            layers: body.layers,
        };
        rests.then_some(plane)
    }
}

impl HalfSpaceSearch {
    /// Returns true if there is no half-space.
    pub(super) const fn is_idle(&self) -> bool {
        self.planes.is_empty()
    }

    /// Notes that bodies have changed.
    pub(super) fn note(&mut self, bodies: &MonitoredBodies, changed: &[u32]) {
        let planes = bodies.half_spaces();
        if planes.is_empty() && self.planes.is_empty() {
            return;
        }
        if planes != self.planes {
            self.planes.clear();
            self.planes.extend_from_slice(planes);
            self.resting.clear();
            self.resting.resize(planes.len(), None);
            self.compare_all(if planes.is_empty() { 0 } else { bodies.len() });
            return;
        }
        let place_of = |slot| planes.binary_search(slot).ok();
        self.changed_planes
            .extend(changed.iter().filter_map(place_of));
        self.compare_again(changed.iter().copied());
    }

    /// Compares all bodies from the clock on.
    fn compare_all(&mut self, slots: usize) {
        self.changed_planes.clear();
        self.due = DueTimes::default();
        self.near.clear();
        self.near.resize(slots, false);
        self.changed.clear();
        self.changed.extend((0_u32..).take(slots));
        self.next = 0;
    }

    /// Compares some bodies from the clock on, and those that wait to be.
    fn compare_again(&mut self, slots: impl Iterator<Item = u32>) {
        self.changed.drain(..self.next);
        self.changed.extend(slots);
        self.changed.sort_unstable();
        self.changed.dedup();
        self.next = 0;
        let slots = self.changed.last().map_or(0, |&last| last as usize + 1);
        self.near.resize(slots.max(self.near.len()), false);
    }

    /// Finds out what is to be compared since half-spaces have changed.
    fn take_changes(&mut self, bodies: &BodyTable<'_>) {
        let mut all_rest = true;
        for place in self.changed_planes.drain(..) {
            let now = RestingPlane::of(bodies.scene, self.planes[place]);
            all_rest &= now.is_some() && now == self.resting[place];
            self.resting[place] = now;
        }
        if all_rest {
            let near = std::mem::take(&mut self.near);
            let is_near = (0_u32..).zip(&near).filter(|&(_, &is_near)| is_near);
            self.compare_again(is_near.map(|(slot, _)| slot));
            self.near = near;
        } else {
            self.compare_all(bodies.flights.len());
        }
    }

    /// Lists the spans that are not listed yet in which a half-space and another body may be in
    /// contact from `from` to `to` (s), as far as the meter lets. `ahead` is an instant up to which
    /// turning bodies are solved (s). Returns the instant up to which all are listed.
    pub(super) fn look<F: PairFilter>(
        &mut self,
        bodies: &BodyTable<'_>,
        (from, to, ahead): (f64, f64, f64),
        filter: &F,
        meter: &mut BudgetMeter,
        (found, most): (&mut Vec<SpanKey>, usize),
    ) -> Result<f64, LimitExceeded> {
        if !self.changed_planes.is_empty() {
            self.take_changes(bodies);
        }
        let most = found.len().saturating_add(most);
        let horizon = seen_until(to);
        let mut search = PlaneSearch {
            planes: &self.planes,
            bodies,
            ahead,
            // Looked at less often, and not much farther than is needed.
            until: to + (to - from),
            filter,
            found,
            most,
        };
        while let Some(&slot) = self.changed.get(self.next) {
            if meter.is_spent() || filter.gives_up() {
                return Ok(from);
            }
            let (next, is_near) = search.list(slot, seen_from(from))?;
            self.due.set(slot, next.max(horizon.next_up()));
            self.near[slot as usize] = is_near;
            self.next += 1;
            meter.count(1);
        }
        self.changed.clear();
        self.next = 0;
        let taken = &mut self.taken;
        taken.clear();
        self.due
            .take(horizon, |slot, since| taken.push((since, slot)));
        taken.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut known = to;
        for &(since, slot) in &*taken {
            if known < to || meter.is_spent() || filter.gives_up() {
                known = known.min(seen_from(since).next_down().max(from));
                self.due.set(slot, since);
                continue;
            }
            let (next, is_near) = search.list(slot, since)?;
            self.due.set(slot, next.max(horizon.next_up()));
            self.near[slot as usize] |= is_near;
            meter.count(1);
        }
        Ok(known)
    }
}

/// The comparison of bodies with half-spaces.
struct PlaneSearch<'s, F> {
    planes: &'s [u32],
    bodies: &'s BodyTable<'s>,
    ahead: f64,
    /// Instant up to which bodies are compared, s; or to the end of the last span that is listed.
    until: f64,
    filter: &'s F,
    found: &'s mut Vec<SpanKey>,
    /// Largest length of the list.
    most: usize,
}

impl<F: PairFilter> PlaneSearch<'_, F> {
    /// Lists the spans of a body from an instant (s) on. Returns when it is to be compared again,
    /// infinity if never, and true if a span was listed.
    fn list(&mut self, slot: u32, since: f64) -> Result<(f64, bool), LimitExceeded> {
        let body = self.bodies.get(slot).filter(|view| !view.is_half_space());
        let Some(body) = body else {
            return Ok((f64::INFINITY, false));
        };
        let (mut next, before) = (f64::INFINITY, self.found.len());
        for &plane in self.planes {
            let (first, second) = (slot.min(plane), slot.max(plane));
            let Some(ground) = self.bodies.get(plane) else {
                continue;
            };
            if !self.filter.admits(first, second) {
                continue;
            }
            let (a, b) = if slot < plane {
                (&body, &ground)
            } else {
                (&ground, &body)
            };
            next = next.min(self.list_pair((first, second), (a, b), since));
            if self.found.len() > self.most {
                return Err(LimitExceeded);
            }
        }
        Ok((next, self.found.len() > before))
    }

    /// Lists the spans of a pair from an instant (s) on. Returns when it is to be compared again.
    fn list_pair(
        &mut self,
        (first, second): (u32, u32),
        (a, b): (&BodyView<'_>, &BodyView<'_>),
        since: f64,
    ) -> f64 {
        let [until_a, until_b] = [first, second].map(|slot| {
            let flight = self.bodies.flights.get(self.bodies.scene, slot);
            flight.map_or(f64::INFINITY, |(flight, _)| flight.until)
        });
        let turns = a.turning.is_some() || b.turning.is_some();
        let mut spans = spans(&a.knots, &b.knots, since, f64::INFINITY);
        loop {
            let Some(span) = spans.next() else {
                // Plans without end are followed farther by then.
                return until_a.min(until_b);
            };
            if span.start > self.until {
                return span.start;
            }
            let part = (since, self.until.max(since));
            if may_touch(a, b, span, self.bodies.margin, part) {
                self.found.push(SpanKey {
                    a: first,
                    b: second,
                    cubic_a: span.a,
                    cubic_b: span.b,
                });
                if turns && span.end > self.ahead {
                    // Of a span that may last for ever, a part is solved.
                    return self.ahead.max(since.next_up());
                }
            } else if span.end > self.until {
                return self.until;
            }
        }
    }
}
