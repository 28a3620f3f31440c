//! Half-spaces against all other bodies of a monitor: no slice has boxes of them.
//!
//! A body is compared with the half-spaces when it changes, from the clock to some time ahead, and
//! again when the lookahead reaches that time. So in most ticks few bodies are compared. When a
//! half-space changes, all bodies are: first by the ends of their straight motions, or the box of
//! their plan, then span by span.

use super::admission::SlotAdmission;
use super::bodies::BodyTable;
use super::budget::TickWork;
use super::due_times::DueTimes;
use super::monitored_bodies::MonitoredBodies;
use crate::broad_phase::PairFilter;
use crate::narrow_phase::{BodyView, may_touch};
use crate::rounding::{earliest_exact, exact_interval};
use crate::scene::HeightRange;
use crate::search::LimitExceeded;
use crate::spans::{SpanKey, in_order, spans};

/// The comparison of half-spaces with all other bodies.
#[derive(Debug, Default)]
pub(super) struct HalfSpaceSearch {
    /// Slots of half-spaces, ascending, as of the last call of [`note`](Self::note).
    planes: Vec<u32>,
    /// Heights of each half-space along its normal, in the interval that is searched.
    ground: Vec<Option<HeightRange>>,
    /// Instant up to which each body is compared, s: it is due again then.
    due: DueTimes,
    /// Memory of [`list_spans`](Self::list_spans): slots that are due, each with the instant up to which it is compared (s).
    taken: Vec<(f64, u32)>,
    /// Slots to be compared from the clock on, and the place of the next one in this list.
    to_compare: Vec<u32>,
    next: usize,
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
        let is_plane = |slot: &u32| planes.binary_search(slot).is_ok();
        if planes != self.planes || changed.iter().any(is_plane) {
            self.planes.clear();
            self.planes.extend_from_slice(planes);
            self.compare_all(if planes.is_empty() { 0 } else { bodies.len() });
            return;
        }
        self.to_compare.drain(..self.next);
        self.to_compare.extend_from_slice(changed);
        self.to_compare.sort_unstable();
        self.to_compare.dedup();
        self.next = 0;
    }

    /// Compares all bodies from the clock on.
    fn compare_all(&mut self, slots: usize) {
        self.due = DueTimes::default();
        self.to_compare.clear();
        self.to_compare.extend((0_u32..).take(slots));
        self.next = 0;
    }

    /// Lists the spans that are not listed yet in which a half-space and another body may be in
    /// contact from `from` to `to` (s), until the budget is spent. `ahead` is an instant up to which
    /// turning bodies are solved (s). Returns the instant up to which all are listed.
    pub(super) fn list_spans(
        &mut self,
        bodies: &BodyTable<'_>,
        (from, to, ahead): (f64, f64, f64),
        work: &mut TickWork<'_>,
        (found, most): (&mut Vec<SpanKey>, usize),
    ) -> Result<f64, LimitExceeded> {
        let most = found.len().saturating_add(most);
        let (since, horizon) = exact_interval((from, to));
        // As far again beyond `to`: each body is then compared about once per lookahead, and not much farther than is
        // needed.
        let until = to + (to - from);
        self.ground.clear();
        self.ground.extend(self.planes.iter().map(|&plane| {
            let normal = bodies.scene.in_slot(plane)?.1.body.hitbox.normal()?;
            bodies.heights(plane, (since, until), normal)
        }));
        let mut search = PlaneSearch {
            planes: &self.planes,
            ground: &self.ground,
            bodies,
            ahead,
            since,
            until,
            filter: &work.admission,
            found,
            most,
        };
        while let Some(&slot) = self.to_compare.get(self.next) {
            if work.meter.is_spent() || search.filter.gives_up() {
                return Ok(from);
            }
            let next = search.list(slot, since)?;
            self.due.set(slot, next.max(horizon.next_up()));
            self.next += 1;
            work.meter.count(1);
        }
        self.to_compare.clear();
        self.next = 0;
        let taken = &mut self.taken;
        taken.clear();
        self.due
            .take(horizon, |slot, since| taken.push((since, slot)));
        taken.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut known = to;
        for &(since, slot) in &*taken {
            if known < to || work.meter.is_spent() || search.filter.gives_up() {
                known = known.min(earliest_exact(since).next_down().max(from));
                self.due.set(slot, since);
                continue;
            }
            let next = search.list(slot, since)?;
            self.due.set(slot, next.max(horizon.next_up()));
            work.meter.count(1);
        }
        Ok(known)
    }
}

/// The comparison of bodies with half-spaces.
struct PlaneSearch<'s> {
    planes: &'s [u32],
    ground: &'s [Option<HeightRange>],
    bodies: &'s BodyTable<'s>,
    /// Instant up to which turning bodies are solved, s.
    ahead: f64,
    /// Instant from which on the heights of the half-spaces are known, s.
    since: f64,
    /// Instant up to which bodies are compared, s; or to the end of the last span that is listed.
    until: f64,
    filter: &'s SlotAdmission<'s>,
    found: &'s mut Vec<SpanKey>,
    /// Largest length of the list.
    most: usize,
}

impl PlaneSearch<'_> {
    /// Lists the spans of a body from an instant (s) on. Returns when it is to be compared again,
    /// infinity if never.
    fn list(&mut self, slot: u32, since: f64) -> Result<f64, LimitExceeded> {
        let mut next = f64::INFINITY;
        for (&plane, ground) in self.planes.iter().zip(self.ground) {
            if since >= self.since && self.is_clear(slot, (plane, ground.as_ref()), since) {
                next = next.min(self.until);
                continue;
            }
            let views = [slot, plane].map(|slot| self.bodies.get(slot));
            let [Some(body), Some(ground)] = views else {
                continue;
            };
            let [(first, a), (second, b)] = in_order((slot, &body), (plane, &ground));
            if body.is_half_space() || !self.filter.admits(first, second) {
                continue;
            }
            next = next.min(self.list_pair((first, second), (a, b), since));
            if self.found.len() > self.most {
                return Err(LimitExceeded);
            }
        }
        Ok(next)
    }

    /// Returns true if a body is certainly above a half-space as far as it is compared.
    fn is_clear(
        &self,
        slot: u32,
        (plane, ground): (u32, Option<&HeightRange>),
        since: f64,
    ) -> bool {
        let scene = self.bodies.scene;
        let entries = [slot, plane].map(|slot| scene.in_slot(slot));
        let (Some(ground), [Some((_, entry)), Some((_, plane))]) = (ground, entries) else {
            return false;
        };
        let Some(normal) = plane.body.hitbox.normal() else {
            return false;
        };
        let heights = self.bodies.heights(slot, (since, self.until), normal);
        // The reach contains the model error of the body, not that of the half-space.
        let reach = entry.body.shape().reach() + plane.body.shape().model_error();
        !entry.body.hitbox.is_half_space()
            && heights.is_some_and(|heights| heights.is_above(ground, reach, self.bodies.margin))
    }

    /// Lists the spans of a pair from an instant (s) on. Returns when it is to be compared again.
    fn list_pair(
        &mut self,
        (first, second): (u32, u32),
        (a, b): (&BodyView<'_>, &BodyView<'_>),
        since: f64,
    ) -> f64 {
        let [until_a, until_b] = [first, second].map(|slot| {
            let monitored = self.bodies.monitored.get(self.bodies.scene, slot);
            monitored.map_or(f64::INFINITY, |(monitored, _)| monitored.until())
        });
        let is_turning = a.turning.is_some() || b.turning.is_some();
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
                self.found.push(SpanKey::of((first, second), span));
                if is_turning && span.end > self.ahead {
                    // Of a span that may last for ever, a part is solved.
                    return self.ahead.max(since.next_up());
                }
            } else if span.end > self.until {
                return self.until;
            }
        }
    }
}
