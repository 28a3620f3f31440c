//! Catching up with a clock that has jumped.
//!
//! A lookahead is cut into slices of equal length, and a clock that moves on by a frame needs one more
//! of them now and then. A clock that jumps by hours would need thousands, most of them without news. The
//! time that it passed over is searched once, in chunks that grow as long as they take little work, each
//! in slices that suit the bodies there. Results do not depend on these.

use super::super::bodies::BodyTable;
use super::super::budget::TickWork;
use super::super::search_from_nothing::SearchFromNothing;
use super::LookaheadSearch;
use crate::accuracy::Accuracy;
use crate::broad_phase::PairFilter;
use crate::count::short;
use crate::narrow_phase::BodyView;
use crate::rounding::earliest_exact;
use crate::search::{Bodies, LimitExceeded};
use crate::spans::{SpanKey, common_part};
use crate::stats::Stats;

impl LookaheadSearch {
    /// Boxes and candidates, in all and more for each body: a chunk that takes fewer is followed by one that is twice
    /// as long.
    const LITTLE: (usize, usize) = (1 << 15, 8);

    /// Returns true if the time from one instant to another (s) is searched as a jump.
    pub(super) fn is_jump(&self, (from, to): (f64, f64)) -> bool {
        /// Number of slices below which they are searched one by one.
        const FEW: f64 = 16.0;
        self.jump.is_some() || to - from > FEW * self.grid.length
    }

    /// Searches the time that the clock passed over, in chunks of at least the length of a slice, until the budget is
    /// spent, or turning bodies have as many parts to be solved as a tick should. Returns the instant at which the search had
    /// to stop, s; none if it is done.
    ///
    /// # Errors
    ///
    /// If there is too little room for what is found.
    pub(super) fn search_jump(
        &mut self,
        (from, to): (f64, f64),
        work: &mut TickWork<'_>,
    ) -> Result<Option<f64>, LimitExceeded> {
        let length = self.grid.length;
        let (admission, meter) = (&work.admission, &mut work.meter);
        let search = SearchFromNothing {
            limits: self.limits(),
            table: BodyTable::of(admission.scene, &self.monitored, &self.grid),
            pool: &self.search_pool,
            threads: meter.threads(),
        };
        // A budget may be spent within the first chunk: then that is short.
        let last = self.last_jump.filter(|_| !meter.may_leave_work());
        let first = last.unwrap_or((length, length));
        let (chunk, slice) = self.jump.get_or_insert(first);
        // What has changed since the last call counts from there on, with all instants that are rounded to it.
        let mut at = earliest_exact(from);
        // Not beyond the prescribed end of the known time: bodies may change then, and are searched for from there on.
        let until = meter.until().unwrap_or(f64::INFINITY);
        // Those of half-spaces are listed already, over all of the time.
        let lists_planes = !self.survivors.is_empty();
        let mut turning = TurningSpans::default();
        while at < to {
            // Half-spaces may take all of each budget: what was listed of them is solved as far as the first chunk.
            let may_stop = !lists_planes || at > from;
            if may_stop && meter.is_spent() || at >= until {
                return Ok(Some(at.max(from)));
            }
            let end = (at + *chunk).min(to.min(until));
            let mut counted = Stats::default();
            let found = (&mut self.survivors, &mut counted);
            *slice = search.list_spans((at, end), Some(*slice), admission, found)?;
            if admission.gives_up() {
                return Ok(Some(at.max(from)));
            }
            let examined = counted.boxes + counted.candidates;
            let examined = usize::try_from(examined).unwrap_or(usize::MAX);
            work.stats += counted;
            meter.count(examined.saturating_add(1));
            if meter.may_leave_work() {
                turning.list(&self.survivors, &search.table);
                if let Some(end) = turning.end_of_few(&search.table, (at, end), length) {
                    *chunk = (end - at).max(length);
                    return Ok(Some(end.max(from)));
                }
            }
            at = end;
            let little = Self::LITTLE.0 + Self::LITTLE.1 * self.monitored.len();
            let factor = if examined < little { 2.0 } else { 0.5 };
            *chunk = (factor * *chunk).max(length);
        }
        let last = self.jump.take();
        self.last_jump = last.map(|(chunk, slice)| (chunk.min(to - from).max(length), slice));
        Ok(None)
    }
}

/// The spans of turning bodies that a jump has found, and the work of solving them.
#[derive(Default)]
struct TurningSpans {
    spans: Vec<SpanKey>,
    /// Number of survivors that were looked through.
    seen: usize,
    /// Parts up to where the search has come: the spheres of both bodies between two cuts of a rotation, each counted once.
    parts: f64,
}

impl TurningSpans {
    /// Parts that a tick with a budget solves, unless one slice has more: some milliseconds.
    const FEW: f64 = 8192.0;

    /// Takes the spans of turning bodies from a list that grows.
    fn list(&mut self, survivors: &[SpanKey], bodies: &BodyTable<'_>) {
        let is_turning = |slot| bodies.view(slot).turning.is_some();
        let new = survivors[self.seen..].iter();
        let turning = new.filter(|key| is_turning(key.a) || is_turning(key.b));
        self.spans.extend(turning);
        self.spans.sort_unstable();
        self.spans.dedup();
        self.seen = survivors.len();
    }

    /// Returns the instant (s) up to which an interval (s) has few parts, or one slice of a length (s); none if there is room
    /// for more than all of its parts.
    fn end_of_few(
        &mut self,
        bodies: &BodyTable<'_>,
        (start, end): (f64, f64),
        length: f64,
    ) -> Option<f64> {
        let known = self.parts;
        let parts_until = |until| known + self.count(bodies, (start, until));
        let mut reached = end;
        while parts_until(reached) > Self::FEW && reached - start > length {
            reached = start + 0.5 * (reached - start);
        }
        self.parts = parts_until(reached);
        (reached < end || self.parts >= 0.5 * Self::FEW).then_some(reached)
    }

    /// Returns about how many parts the spans have in an interval (s).
    fn count(&self, bodies: &BodyTable<'_>, interval: (f64, f64)) -> f64 {
        let of_span = |key: &SpanKey| {
            let views = [key.a, key.b].map(|slot| bodies.view(slot));
            let span = key.span(&views[0].knots, &views[1].knots);
            let (from, to) = common_part((span.start, span.end), interval)?;
            // Only rotations that go on for ever may have more sections than knots: these are those at an end.
            let lengths = |view: &BodyView<'_>| {
                let section_at = |time| {
                    view.turning
                        .map(|turning| turning.section_at(time, Accuracy::Exact))
                };
                let at_ends = [section_at(from), section_at(to)];
                let lengths = at_ends
                    .into_iter()
                    .flatten()
                    .map(|section| section.end - section.start);
                lengths.fold(f64::INFINITY, f64::min)
            };
            let sections: f64 = views.iter().map(|view| (to - from) / lengths(view)).sum();
            let spheres = views.iter().map(|view| view.spheres.len()).sum();
            Some(sections * f64::from(short(spheres)))
        };
        self.spans.iter().filter_map(of_span).sum()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use crate::hitbox::{Hitbox, Sphere};
    use crate::monitor::{AlertLevel, Budget, Event, EventKind, Monitor};
    use crate::orientation::Orientation;
    use crate::scene::{Body, Scene};
    use crate::trajectory::{State, Trajectory};
    use glam::{DQuat, DVec3};

    /// A wheel over a floor, and beside another wheel that it touches at each turn.
    fn wheels() -> Monitor {
        let mut scene = Scene::new();
        let ground = Hitbox::half_space(DVec3::Z).unwrap();
        let floor = Trajectory::at_rest([0.0, 0.0, -1.6]).unwrap();
        scene.insert(Body::new(floor).with_hitbox(ground)).unwrap();
        for (x, rate) in [(0.0, 1.0), (3.3, 0.37)] {
            let spheres = [-1.0, 1.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.7));
            let spin = Orientation::spin(0.0, DQuat::IDENTITY, rate * DVec3::Y).unwrap();
            let body = Body::new(Trajectory::at_rest([x, 0.0, 0.0]).unwrap())
                .with_hitbox(Hitbox::cluster(spheres.to_vec()).unwrap())
                .with_orientation(spin);
            scene.insert(body).unwrap();
        }
        Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(0.0)]).unwrap()
    }

    /// A clock that moves on by far more than the lookahead jumps in each tick: each jump goes on as the one before ended.
    #[test]
    fn jumps_of_one_length_are_searched_in_few_slices() {
        let mut scene = Scene::new();
        let state = |x: u32, time: f64| {
            let velocity = DVec3::new(0.1, 0.0, 0.0);
            State::new(time, DVec3::X * (f64::from(2 * x) + 0.1 * time), velocity)
        };
        let ids = (0..100).map(|x| {
            let plan = Trajectory::coasting(state(x, 0.0)).unwrap();
            scene.insert(Body::new(plan)).unwrap()
        });
        let ids: Vec<_> = ids.collect();
        let mut monitor = Monitor::new(scene, 0.0, 1e-9, &[AlertLevel::at(0.0)]).unwrap();
        for tick in 1..20 {
            let now = f64::from(tick) / 64.0;
            let told = ids.iter().zip(0..).map(|(&id, x)| (id, state(x, now)));
            monitor.track(now, told).unwrap();
            monitor.advance(now, &mut Vec::new()).unwrap();
            let slices = monitor.stats().slices;
            assert!(slices <= 12 || tick == 1, "{tick}: {slices}");
        }
    }

    /// A tick with a budget solves few parts of turns, and all ticks together report what one without reports.
    #[test]
    fn turns_in_a_jump_are_left_to_later_ticks() {
        const JUMP: f64 = 20_000.0;
        let ticks_of = |budget| {
            let (mut monitor, mut events) = (wheels(), Vec::new());
            monitor.advance(0.0, &mut events).unwrap();
            let (mut ticks, mut most) = (0, 0);
            while monitor.now() < JUMP || !monitor.is_caught_up() {
                monitor.advance_within(JUMP, budget, &mut events).unwrap();
                most = most.max(monitor.search.solved.len());
                ticks += 1;
                assert!(ticks < 1000, "{}", monitor.complete_until());
            }
            let of_the_clock = |event: &Event| match &event.kind {
                EventKind::Began(one) => Some((event.time, one.a, one.b, true)),
                EventKind::Ended(one, _) => Some((event.time, one.a, one.b, false)),
                _ => None,
            };
            let events: Vec<_> = events.iter().filter_map(of_the_clock).collect();
            (ticks, most, events)
        };
        let expected = ticks_of(Budget::Unlimited);
        assert_eq!(expected.0, 1);
        for work in [1, 100_000] {
            let (ticks, most, events) = ticks_of(Budget::Work(work));
            assert!(ticks > 5 && most < expected.1 / 5, "{ticks} {most}");
            assert!(events.len() > 10_000 && events == expected.2);
        }
    }
}
