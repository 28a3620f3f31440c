//! Half-spaces against all other bodies of a monitor: no slice has boxes of them.
//!
//! A body is compared with the half-spaces when it changes, from the clock to some time ahead, and
//! again when the lookahead reaches that time. So in most ticks few bodies are compared. When
//! half-spaces change, all bodies are compared with these: first by the ends of their straight
//! motions, or the box of their plan, then span by span.

use super::bodies::BodyTable;
use super::budget::TickWork;
use super::due_times::DueTimes;
use super::monitored_bodies::MonitoredBodies;
use crate::broad_phase::PairFilter;
use crate::count::are_most;
use crate::narrow_phase::{BodyView, may_touch};
use crate::rounding::{exact_interval, last_known, latest_exact};
use crate::scene::{PairAdmission, PlaneHeights, PositionBox};
use crate::search::{Bodies, LimitExceeded};
use crate::spans::{SpanKey, in_order, spans};
use std::cell::LazyCell;

/// The comparison of half-spaces with all other bodies.
#[derive(Debug, Default)]
pub(super) struct HalfSpaceSearch {
    /// Slots of half-spaces that have changed, ascending: they are compared with all bodies that are to be compared. Some
    /// may be half-spaces no more.
    changed: Vec<u32>,
    /// Instant up to which each body is compared with the other half-spaces, s: it is due again then.
    due: DueTimes,
    /// Slots to be compared from the clock on, and the place of the next one in this list.
    to_compare: Vec<u32>,
    next: usize,
    /// Number of bodies that have changed since all were compared. Others are compared with half-spaces that have changed.
    changed_bodies: usize,
    /// Memory of [`list_spans`](Self::list_spans): slots that are due, each with the instant up to which it is compared (s).
    taken: Vec<(f64, u32)>,
    /// Memory of [`list_spans`](Self::list_spans): all half-spaces, and those that have changed.
    all_planes: Vec<PlaneHeights>,
    changed_planes: Vec<PlaneHeights>,
}

impl HalfSpaceSearch {
    /// Notes that bodies have changed. `changed` holds every body that became or ceased to be a half-space.
    pub(super) fn note(&mut self, bodies: &MonitoredBodies, changed: &[u32]) {
        let planes = bodies.half_spaces();
        if planes.is_empty() {
            // The first one will be compared with all bodies.
            *self = Self::default();
            return;
        }
        let is_plane = |slot: &u32| planes.binary_search(slot).is_ok();
        self.changed_bodies += changed.len();
        let known = self.changed.len();
        self.changed
            .extend(changed.iter().copied().filter(is_plane));
        self.to_compare.drain(..self.next);
        self.next = 0;
        if self.changed.len() > known {
            self.to_compare.clear();
            self.to_compare.extend((0_u32..).take(bodies.len()));
        } else {
            self.to_compare.extend_from_slice(changed);
            self.to_compare.sort_unstable();
            self.to_compare.dedup();
        }
        self.changed.sort_unstable();
        self.changed.dedup();
        for &slot in changed {
            // It is compared with no half-space yet.
            self.due.set(slot, f64::NEG_INFINITY);
        }
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
        // As far again beyond `to`: each body is then compared once or twice per lookahead, and not much farther than is
        // needed, also with half-spaces that do not change while another one does. Where most bodies have changed, they may
        // do so again at the next tick.
        let have_most_changed = are_most(self.changed_bodies, bodies.monitored.bodies());
        let until = if have_most_changed {
            // Just so far that `to` is [known](last_known).
            latest_exact(horizon).next_up()
        } else {
            to + (to - from)
        };
        for (planes, slots) in [
            (&mut self.all_planes, bodies.monitored.half_spaces()),
            (&mut self.changed_planes, &self.changed),
        ] {
            let in_interval = |&slot: &u32| {
                let entry = bodies.entry(slot, until)?;
                PlaneHeights::of(slot, entry, (since, until))
            };
            planes.clear();
            planes.extend(slots.iter().filter_map(in_interval));
        }
        let mut search = PlaneSearch {
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
            let due = self.due.at(slot);
            let next = if due > horizon {
                search.list(slot, &self.changed_planes, since)?.min(due)
            } else {
                search.list(slot, &self.all_planes, since)?
            };
            self.due.set(slot, due_by(slot, next, (horizon, until)));
            self.next += 1;
            work.meter.count(1);
        }
        self.to_compare.clear();
        (self.next, self.changed_bodies) = (0, 0);
        self.changed.clear();
        let taken = &mut self.taken;
        taken.clear();
        self.due
            .take(horizon, |slot, since| taken.push((since, slot)));
        taken.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut known = to;
        for &(since, slot) in &*taken {
            if known < to || work.meter.is_spent() || search.filter.gives_up() {
                known = known.min(last_known(since).max(from));
                self.due.set(slot, since);
                continue;
            }
            let next = search.list(slot, &self.all_planes, since)?;
            self.due.set(slot, due_by(slot, next, (horizon, until)));
            work.meter.count(1);
        }
        Ok(known)
    }

    /// Lets the bodies in some spans with half-spaces be due again at an instant (s): turning ones are solved so far.
    pub(super) fn put_off(&mut self, bodies: &BodyTable<'_>, spans: &[SpanKey], until: f64) {
        let planes = bodies.monitored.half_spaces();
        let is_plane = |slot: u32| planes.binary_search(&slot).is_ok();
        for key in spans {
            for (slot, other) in [(key.a, key.b), (key.b, key.a)] {
                if is_plane(other) {
                    self.due.set(slot, until.min(self.due.at(slot)));
                }
            }
        }
    }
}

/// Returns the instant (s), beyond the horizon, at which a body is due again that is compared up to `next` (s). If that is `until`, the end of the
/// compared time, the instant lies in the second half of the time from the horizon to there (both s). Else bodies that are
/// compared in one tick would be due in one tick as well, which would take much longer than others.
fn due_by(slot: u32, next: f64, (horizon, until): (f64, f64)) -> f64 {
    /// Its multiples are spread evenly between whole numbers.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let soonest = horizon.next_up();
    if next.total_cmp(&until).is_ne() {
        return next.max(soonest);
    }
    let share = (GOLDEN * f64::from(slot)).fract();
    (next - 0.5 * share * (next - horizon)).max(soonest)
}

/// The comparison of bodies with half-spaces.
struct PlaneSearch<'s> {
    bodies: &'s BodyTable<'s>,
    /// Instant up to which turning bodies are solved, s.
    ahead: f64,
    /// Instant from which on the heights of the half-spaces are known, s.
    since: f64,
    /// Instant up to which bodies are compared, s; or to the end of the last span that is listed.
    until: f64,
    filter: &'s PairAdmission<'s>,
    found: &'s mut Vec<SpanKey>,
    /// Largest length of the list.
    most: usize,
}

impl PlaneSearch<'_> {
    /// Lists the spans of a body with some half-spaces from an instant (s) on. Returns when it is to be compared again,
    /// infinity if never.
    fn list(
        &mut self,
        slot: u32,
        planes: &[PlaneHeights],
        since: f64,
    ) -> Result<f64, LimitExceeded> {
        let mut next = f64::INFINITY;
        let Some(entry) = self.bodies.entry(slot, self.until) else {
            return Ok(next);
        };
        if entry.0.body.hitbox.is_half_space() {
            return Ok(next);
        }
        let (bodies, interval) = (self.bodies, (since, self.until));
        let body = LazyCell::new(|| bodies.view(slot));
        // Bodies are due after the end of some lookahead, which is not known before it is compared.
        debug_assert!(since >= self.since, "heights are known");
        let positions = PositionBox::of(entry, interval);
        for plane in planes {
            let is_below = |positions| plane.is_below(positions, bodies.grid.margin);
            // As far as it is compared.
            if positions.as_ref().is_some_and(is_below) {
                next = next.min(self.until);
                continue;
            }
            let ground = bodies.view(plane.body);
            let [(first, a), (second, b)] = in_order((slot, &*body), (plane.body, &ground));
            if !self.filter.admits(first, second) {
                continue;
            }
            next = next.min(self.list_pair((first, second), (a, b), since));
            if self.found.len() > self.most {
                return Err(LimitExceeded);
            }
        }
        Ok(next)
    }

    /// Lists the spans of a pair from an instant (s) on. Returns when it is to be compared again.
    fn list_pair(
        &mut self,
        (first, second): (u32, u32),
        (a, b): (&BodyView<'_>, &BodyView<'_>),
        since: f64,
    ) -> f64 {
        let [until_a, until_b] = [first, second].map(|slot| {
            let monitored = self.bodies.monitored.with_body(self.bodies.scene, slot);
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
            // To solve a span of bodies that do not turn takes as long as the test. One that reaches beyond the part is always
            // tested: see the refinement of boxes.
            let is_within = part.0 <= span.start && span.end <= part.1;
            if is_within && !is_turning || may_touch(a, b, span, self.bodies.grid.margin, part) {
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use crate::hitbox::Hitbox;
    use crate::monitor::{AlertLevel, Monitor};
    use crate::scene::{Body, Scene};
    use crate::trajectory::{State, Trajectory};
    use glam::DVec3;

    /// Else each body would be compared with all half-spaces in each tick: many, of which one moves.
    #[test]
    fn a_half_space_that_is_told_each_frame_leaves_the_others_known() {
        const LOOKAHEAD: f64 = 2.0;
        let mut scene = Scene::new();
        let floor = Hitbox::half_space(DVec3::Z).unwrap();
        let mut put = |hitbox: &Hitbox, place: DVec3| {
            let body = Body::new(Trajectory::at_rest(place).unwrap());
            scene.insert(body.with_hitbox(hitbox.clone())).unwrap()
        };
        let [_, lift] = [-20.0, -10.0].map(|height| put(&floor, height * DVec3::Z));
        let ball = Hitbox::sphere(0.5).unwrap();
        let balls = [0.0, 3.0, 6.0].map(|place| put(&ball, place * DVec3::X));
        let levels = [AlertLevel::at(0.1)];
        let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &levels).unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        for frame in 1..40 {
            let now = f64::from(frame) / 60.0;
            let place = (0.1 * now - 10.0) * DVec3::Z;
            let velocity = (0.1 + 0.01 * now) * DVec3::Z;
            let told = [(lift, State::new(now, place, velocity))];
            monitor.track(now, told).unwrap();
            monitor.advance(now, &mut Vec::new()).unwrap();
            for id in balls {
                let due = monitor.search.half_spaces.due.at(id.slot);
                let ahead = due - (now + LOOKAHEAD);
                assert!(ahead > 0.1 * LOOKAHEAD, "{frame} {ahead}");
            }
        }
    }

    /// Bodies that are compared in one tick are not all compared again in one tick.
    #[test]
    fn bodies_are_due_one_after_another() {
        let mut scene = Scene::new();
        let floor = Body::new(Trajectory::at_rest(-9.0 * DVec3::Z).unwrap());
        let floor = floor.with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
        scene.insert(floor).unwrap();
        for place in 0..120 {
            let place = 5.0 * f64::from(place) * DVec3::X;
            let ball = Body::new(Trajectory::at_rest(place).unwrap());
            scene.insert(ball).unwrap();
        }
        let levels = [AlertLevel::at(0.1)];
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &levels).unwrap();
        for frame in 0..3 {
            let now = f64::from(frame) / 60.0;
            monitor.advance(now, &mut Vec::new()).unwrap();
        }
        let half_spaces = &monitor.search.half_spaces;
        let mut due: Vec<f64> = (1..121).map(|slot| half_spaces.due.at(slot)).collect();
        due.sort_by(f64::total_cmp);
        assert!(due[0] > 2.5 && due[119] < 4.5, "{due:?}");
        assert!(
            due.windows(12).all(|some| some[11] - some[0] > 0.05),
            "{due:?}"
        );
    }
}
