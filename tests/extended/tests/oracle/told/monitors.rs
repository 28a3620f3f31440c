//! `Monitor::track` and the events of ticks.

use super::answers::{Row, tolerance, wrong};
use super::motions::{Motion, meet, spline, told, trajectory};
use super::{Asked, Far, epoch};
use crate::check::Truth;
use crate::support::{rng, with_every_change};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, Encounter, EncounterId, Event, EventKind, Monitor, Query,
    Scene, State, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::collections::BTreeMap;

const PAIRS: usize = 3;
const LOOKAHEAD: f64 = 2.0;
const TICKS: u32 = 12;

/// A monitor, what its bodies do exactly, and the encounters that its events tell of.
struct World {
    monitor: Monitor,
    far: Far,
    bodies: Vec<(BodyId, Motion)>,
    encounters: BTreeMap<EncounterId, Encounter>,
}

impl World {
    fn new(rng: &mut ChaCha8Rng, now: f64, margin: f64) -> Self {
        let far = Far::any(rng);
        let mut scene = Scene::new();
        let mut bodies = Vec::new();
        for _ in 0..2 * PAIRS {
            let at = far.place(rng);
            let plan = spline(rng, now, at);
            let id = scene.insert(Body::new(trajectory(&plan))).unwrap();
            bodies.push((id, Motion::spline(&plan.0, plan.1, now)));
        }
        let monitor = Monitor::new(scene, now, LOOKAHEAD, &[AlertLevel::at(margin)]).unwrap();
        Self {
            monitor: with_every_change(monitor),
            far,
            bodies,
            encounters: BTreeMap::new(),
        }
    }

    /// States of a share of the bodies, two of which always meet, and some of them twice. All take effect at
    /// one instant (s).
    fn tell(&mut self, rng: &mut ChaCha8Rng, now: f64) {
        let share = [0.2, 1.0, 1.0][rng.random_range(0..3)];
        let mut states: Vec<(BodyId, State)> = Vec::new();
        // A change for the past takes effect there: all that is asked lies after the clock.
        for pair in self.bodies.chunks_exact_mut(2) {
            let time = now + rng.random_range(0.0..2.5);
            let meeting = self.far.place(rng);
            for ((id, motion), (state, at)) in pair.iter_mut().zip(meet(rng, time, meeting)) {
                if !rng.random_bool(share) {
                    continue;
                }
                if rng.random_bool(0.3) {
                    states.push((*id, told(rng, time, at)));
                }
                states.push((*id, state));
                *motion = motion.clone().then(now, &state, now);
            }
        }
        self.monitor.track(now, states.iter().copied()).unwrap();
        if rng.random_bool(0.2) {
            // A second time, bit for bit.
            let last = states.last().copied();
            self.monitor.track(now, last).unwrap();
        }
    }

    fn read(&mut self, events: &[Event]) {
        for event in events {
            match event.kind {
                EventKind::Predicted(encounter)
                | EventKind::Revised(encounter)
                | EventKind::Began(encounter) => {
                    self.encounters.insert(encounter.id, encounter);
                }
                EventKind::Withdrawn(encounter) | EventKind::Ended(encounter, _) => {
                    self.encounters.remove(&encounter.id);
                }
                _ => {}
            }
        }
    }

    /// Conflicts, encounters and certificates of a tick.
    fn check(&self, margin: f64, at: (u64, u32), asked: &mut Asked) {
        let clock = self.monitor.now();
        let until = self.monitor.complete_until();
        // A body may have been told to be elsewhere at the clock itself.
        let from = clock + 1e-3;
        let query = Query::new(Window::new(from, until).unwrap()).with_margin(margin);
        let query = query.with_accuracy(Accuracy::Certified);
        let certified = self.monitor.scene().screen(&query).unwrap().conflicts;
        let conflicts = self.monitor.conflicts(0).unwrap();
        for (place, (a, first)) in self.bodies.iter().enumerate() {
            for (b, second) in &self.bodies[place + 1..] {
                let exact = || [first, second].map(|motion| motion.exact.clone());
                let told = || format!("{at:?} {a:?} {b:?} {margin} {first:?} {second:?}");
                let proven: Vec<_> = certified
                    .iter()
                    .filter(|row| (row.a, row.b) == (*a, *b))
                    .copied()
                    .collect();
                let truth = Truth::between(exact(), margin, (from, until));
                assert_eq!(truth.wrong(&proven), None, "{proven:?} {}", told());
                let truth = Truth::between(exact(), margin, (clock, until));
                let tolerance = tolerance(first, second, until);
                let rows = conflicts
                    .iter()
                    .filter(|row| (row.a, row.b) == (*a, *b))
                    .map(Row::of);
                let rows: Vec<Row> = rows.collect();
                let mistake = wrong(&truth, margin, tolerance, &rows);
                assert_eq!(mistake, None, "{tolerance} {rows:?} {}", told());
                let live = self.encounters.values();
                let mut ahead: Vec<Row> = live
                    .filter(|one| (one.a, one.b) == (*a, *b))
                    .map(|one| Row::ahead(one, (clock, until)))
                    .collect();
                ahead.sort_by(|x, y| x.enter.total_cmp(&y.enter));
                let mistake = wrong(&truth, margin, tolerance, &ahead);
                assert_eq!(mistake, None, "{tolerance} {ahead:?} {}", told());
                asked.pairs += 1;
                asked.conflicts += rows.len();
            }
        }
    }
}

/// A few ticks. States are told for the clock, for the next tick, for the past and for the future.
pub(crate) fn life(seed: u64, asked: &mut Asked) {
    let mut rng = rng(seed);
    let start = epoch(&mut rng);
    let margin = match rng.random_range(0..2) {
        0 => rng.random_range(0.2..3.0),
        // That of bodies that fly beside each other.
        _ => f64::from(rng.random_range(1..4)),
    };
    let mut world = World::new(&mut rng, start, margin);
    for tick in 0..TICKS {
        let clock = world.monitor.now();
        let next = clock + [1.0 / 64.0, 1.0 / 60.0, 0.7][rng.random_range(0..3)];
        let now = match rng.random_range(0..6) {
            0 => clock - rng.random_range(0.0..0.3),
            1 => clock,
            2 => next + rng.random_range(0.0..1.0),
            _ => next,
        };
        world.tell(&mut rng, now);
        let mut events = Vec::new();
        world.monitor.advance(next, &mut events).unwrap();
        asked.events += events.len();
        world.read(&events);
        world.check(margin, (seed, tick), asked);
    }
}
