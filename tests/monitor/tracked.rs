//! States of many bodies told in one call: a monitor that is told by `track` against one that is told plan by
//! plan.

#[cfg(feature = "recording")]
use super::late::Recording;
use super::reference::{Reference, order, reported};
use super::support::{bits, rng, vector, wander, with_every_change};
use super::{Ledger, one_shot};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Command, Error, Event, Hitbox, Monitor, Outside, Scene,
    State, Trajectory,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::collections::BTreeMap;

pub(super) const LEVELS: [AlertLevel; 2] =
    [AlertLevel::at(3.0).with_release(3.5), AlertLevel::at(0.5)];
pub(super) const LOOKAHEAD: f64 = 2.0;
const CUBE: f64 = 12.0;
const BODIES: u64 = 40;

pub(super) fn any_state(rng: &mut ChaCha8Rng, time: f64) -> State {
    State::new(time, vector(rng, CUBE / 2.0), vector(rng, 3.0))
}

fn spline(rng: &mut ChaCha8Rng, start: f64, outside: Outside) -> Trajectory {
    let segments = rng.random_range(1..9);
    let states = wander(rng, start, segments, 0.8, CUBE, 3.0);
    let plan = Trajectory::from_states(&states).unwrap();
    plan.with_outside(outside)
}

/// What a body is known to follow from its last knot on: one straight motion, told as a state.
#[derive(Clone, Copy)]
struct Followed {
    state: State,
    last_knot: f64,
}

impl Followed {
    fn from_start(state: State) -> Self {
        Self {
            state,
            last_knot: state.time,
        }
    }

    fn is(&self, state: &State, from: f64) -> bool {
        self.last_knot <= from && self.state == *state
    }
}

/// Splines absent outside, splines that coast, bodies at rest, and bodies of one state.
fn any_body(rng: &mut ChaCha8Rng, start: f64) -> (Trajectory, Option<Followed>) {
    let of_state = |state| {
        let plan = Trajectory::coasting(state).unwrap();
        (plan, Some(Followed::from_start(state)))
    };
    match rng.random_range(0..5) {
        0 => (spline(rng, start, Outside::Absent), None),
        1 => (spline(rng, start, Outside::Coast), None),
        // Not bit for bit what coasting with no velocity is.
        2 => {
            let plan = Trajectory::at_rest(vector(rng, CUBE / 2.0)).unwrap();
            (plan, None)
        }
        _ => of_state(any_state(rng, start)),
    }
}

/// How often what happened.
#[derive(Debug, Default)]
pub(super) struct Seen {
    pub(super) told: usize,
    unchanged: usize,
    twice: usize,
    late: usize,
    ahead: usize,
    refused: usize,
    idle: usize,
    jumps: usize,
    known_short: usize,
    conflicts: usize,
    events: usize,
    again: usize,
}

/// Two monitors that live the same life.
pub(super) struct Pair {
    pub(super) tracked: Monitor,
    pub(super) replanned: Monitor,
    pub(super) ids: Vec<BodyId>,
    followed: BTreeMap<BodyId, Followed>,
}

impl Pair {
    pub(super) fn new(rng: &mut ChaCha8Rng, start: f64, lookahead: f64) -> Self {
        let mut scene = Scene::new();
        let (mut ids, mut followed) = (Vec::new(), BTreeMap::new());
        for tag in 0..BODIES {
            let (trajectory, line) = any_body(rng, start - 0.5);
            let hitbox = Hitbox::sphere(rng.random_range(0.0..0.4)).unwrap();
            let body = Body::new(trajectory).with_hitbox(hitbox).with_tag(tag);
            let id = scene.insert(body).unwrap();
            ids.push(id);
            followed.extend(line.map(|line| (id, line)));
        }
        let monitor = |scene: &Scene| {
            with_every_change(Monitor::new(scene.clone(), start, lookahead, &LEVELS).unwrap())
        };
        Self {
            tracked: monitor(&scene),
            replanned: monitor(&scene),
            ids,
            followed,
        }
    }

    pub(super) fn plan(&self, id: BodyId) -> &Trajectory {
        &self.replanned.scene().body(id).unwrap().trajectory
    }

    /// From when on a body follows a straight motion that is told for an instant (s).
    fn follows_from(&self, id: BodyId, now: f64) -> f64 {
        let clock = self.replanned.now();
        if now > clock {
            return now;
        }
        now.max(self.plan(id).domain().start()).min(clock)
    }

    /// A state of a body, as networks and physics engines tell them for an instant (s).
    fn state(&self, rng: &mut ChaCha8Rng, id: BodyId, now: f64) -> State {
        let near = match self.plan(id).state(now) {
            Some(state) if state.position.abs().max_element() < CUBE => state,
            _ => any_state(rng, now),
        };
        let velocity = near.velocity * 0.8 + vector(rng, 1.0) - near.position * 0.1;
        let position = near.position + vector(rng, 0.01);
        match rng.random_range(0..24) {
            // Long ago, and still here.
            0 => State::new(now - 1e9, position, DVec3::ZERO),
            1 => State::new(now - 1e9, position, vector(rng, 1e-9)),
            2 => State::new(now - 1e9, position, velocity),
            3 => State::new(now, position + 1e9 * DVec3::X, velocity),
            4 => State::new(now - 1e-9, position, velocity),
            5..9 => {
                let ago = rng.random_range(0.0..0.3);
                State::new(now - ago, position - ago * velocity, velocity)
            }
            9..12 => {
                let ahead = rng.random_range(0.0..9.0);
                State::new(now + ahead, position + ahead * velocity, velocity)
            }
            12 => State::new(0.0, position, DVec3::ZERO),
            13 => State::new(now, position.round(), velocity.round()),
            _ => State::new(now, position, velocity),
        }
    }

    /// States for a share of the bodies, some told before, some bodies twice.
    fn states(&self, rng: &mut ChaCha8Rng, now: f64, share: f64) -> Vec<(BodyId, State)> {
        let mut states = Vec::new();
        for &id in &self.ids {
            if !rng.random_bool(share) {
                continue;
            }
            if self.plan(id).outside_after() == Outside::Absent
                && !self.plan(id).domain().contains(self.follows_from(id, now))
                && rng.random_bool(0.7)
            {
                continue;
            }
            let again = self.followed.get(&id).filter(|_| rng.random_bool(0.15));
            let state = again.map_or_else(|| self.state(rng, id, now), |line| line.state);
            states.push((id, state));
            if rng.random_bool(0.1) {
                let other = self.state(rng, id, now);
                let place = rng.random_range(0..=states.len());
                states.insert(place, (id, other));
            }
        }
        states
    }

    /// Tells both.
    pub(super) fn tell(&mut self, now: f64, states: &[(BodyId, State)], seen: &mut Seen) {
        let mut followed = self.followed.clone();
        // The last state of each body, in the order in which they are named first.
        let mut last: Vec<(BodyId, State)> = Vec::new();
        for &(id, state) in states {
            match last.iter_mut().find(|known| known.0 == id) {
                Some(known) => known.1 = state,
                None => last.push((id, state)),
            }
        }
        let mut commands = Vec::new();
        for &(id, state) in &last {
            let from = self.follows_from(id, now);
            if followed.get(&id).is_some_and(|line| line.is(&state, from)) {
                seen.unchanged += 1;
                continue;
            }
            let last_knot = from.max(state.time);
            followed.insert(id, Followed { state, last_knot });
            let plan = Trajectory::coasting(state).unwrap();
            commands.push(Command::Replan(id, now, plan.into()));
        }
        let count = commands.len();
        let done = self.tracked.track(now, states.iter().copied());
        let replanned = self.replanned.apply(commands).map(drop);
        // States are told by body: so the command of a refusal says no more than the body.
        let replanned = replanned.map_err(|error| match error {
            Error::InCommand { error, .. } => *error,
            other => other,
        });
        assert_eq!(done, replanned);
        if done.is_err() {
            seen.refused += 1;
            return;
        }
        self.followed = followed;
        seen.told += count;
        seen.twice += states.len() - last.len();
        seen.late += usize::from(now < self.tracked.now());
        seen.ahead += usize::from(now > self.tracked.now());
    }

    /// Tells both any states, for some instant about the clock and the next tick's (s).
    pub(super) fn tell_any(
        &mut self,
        rng: &mut ChaCha8Rng,
        next: f64,
        seen: &mut Seen,
    ) -> (f64, Vec<(BodyId, State)>) {
        let clock = self.tracked.now();
        let share = [0.05, 0.6, 1.0][rng.random_range(0..3)];
        let now = match rng.random_range(0..8) {
            0 => clock - rng.random_range(0.0..0.5),
            1..3 => clock,
            3 => clock + rng.random_range(0.0..1.5),
            _ => next,
        };
        let states = self.states(rng, now, share);
        self.tell(now, &states, seen);
        (now, states)
    }

    /// Bit for bit what those bodies do that follow a state from an instant (s) on.
    fn known_states(&self, from: f64) -> Vec<(BodyId, State)> {
        let lines = self.followed.iter();
        let lines = lines.filter(|(_, line)| line.last_knot <= from);
        lines.map(|(&id, line)| (id, line.state)).collect()
    }

    /// A new spline for some body, of both.
    fn give_spline(&mut self, rng: &mut ChaCha8Rng) {
        let id = self.ids[rng.random_range(0..self.ids.len())];
        let outside = [Outside::Absent, Outside::Coast][rng.random_range(0..2)];
        let plan = spline(rng, self.tracked.now() - 0.2, outside);
        for monitor in [&mut self.tracked, &mut self.replanned] {
            monitor.set_trajectory(id, plan.clone()).unwrap();
        }
        self.followed.remove(&id);
    }

    pub(super) fn advance(&mut self, now: f64, budget: Budget) -> Vec<Event> {
        let [events, expected] = [&mut self.tracked, &mut self.replanned].map(|monitor| {
            let mut events = Vec::new();
            monitor.advance_within(now, budget, &mut events).unwrap();
            events
        });
        for (found, expected) in events.iter().zip(&expected) {
            assert_eq!(found, expected);
        }
        assert_eq!(events.len(), expected.len());
        events
    }

    fn assert_same(&self, rng: &mut ChaCha8Rng, at: (u64, u32)) {
        are_same(&self.tracked, &self.replanned, at);
        let now = self.tracked.now();
        for &id in &self.ids {
            let [tracked, replanned] = [&self.tracked, &self.replanned]
                .map(|monitor| &monitor.scene().body(id).unwrap().trajectory);
            assert_eq!(tracked, replanned, "{at:?}");
            let near = (0..5).map(|_| now + rng.random_range(-0.5..4.0));
            for time in near.chain([now, now - 1e6, now + 1e6]) {
                let state = tracked.state(time);
                assert_eq!(state, replanned.state(time), "{at:?}, {time} s");
            }
        }
    }
}

pub(super) fn are_same(found: &Monitor, expected: &Monitor, at: (u64, u32)) {
    assert_eq!(found.complete_until(), expected.complete_until(), "{at:?}");
    for level in 0..LEVELS.len() {
        let [found, expected] =
            [found, expected].map(|monitor| bits(monitor.conflicts(level).unwrap()));
        assert_eq!(found, expected, "{at:?}, level {level}");
    }
}

/// A monitor restored from a snapshot, with serde from one that was written down.
fn restored(monitor: &Monitor) -> Monitor {
    let snapshot = monitor.snapshot();
    #[cfg(feature = "serde")]
    let snapshot = serde_json::from_str(&serde_json::to_string(&snapshot).unwrap()).unwrap();
    Monitor::restore(snapshot).unwrap()
}

/// Both lives, and what each tick is compared with.
fn life(seed: u64, seen: &mut Seen) {
    let mut rng = rng(seed);
    let start = [0.0, 1e3, -7.0][rng.random_range(0..3)];
    // Where a state is not followed in one piece, too.
    let lookahead = [LOOKAHEAD, 7.0, 40.0][rng.random_range(0..3)];
    let mut pair = Pair::new(&mut rng, start, lookahead);
    if rng.random_bool(0.3) {
        for monitor in [&mut pair.tracked, &mut pair.replanned] {
            monitor.set_history(0.3).unwrap();
        }
    }
    #[cfg(feature = "recording")]
    let recording = Recording::of(&mut pair.tracked);
    let mut said = Vec::new();
    let mut reference = Reference::new(&LEVELS, start, lookahead);
    let mut ledger = Ledger::default();
    let mut third: Option<Monitor> = None;
    for tick in 0..60_u32 {
        let at = (seed, tick);
        let clock = pair.tracked.now();
        let step = if rng.random_bool(0.05) {
            seen.jumps += 1;
            rng.random_range(1.0..9.0)
        } else {
            rng.random_range(0.0..0.08)
        };
        let next = clock + step;
        let is_idle = rng.random_bool(0.1);
        let calls = if is_idle {
            vec![(next, pair.known_states(next))]
        } else {
            if rng.random_bool(0.3) {
                third = None;
                pair.give_spline(&mut rng);
            }
            let count = rng.random_range(0..3);
            (0..count)
                .map(|_| pair.tell_any(&mut rng, next, seen))
                .collect()
        };
        if is_idle {
            seen.idle += calls[0].1.len();
            pair.tell(next, &calls[0].1, seen);
        }
        let budget = match rng.random_range(0..5) {
            0 | 1 => Budget::Work(rng.random_range(0..60)),
            _ => Budget::Unlimited,
        };
        let mut events = pair.advance(next, budget);
        pair.assert_same(&mut rng, at);
        let [changed, expected] =
            [&pair.tracked, &pair.replanned].map(|monitor| monitor.stats().changed);
        // Bodies that were told bit for bit what they do are no change.
        assert_eq!(changed, expected, "{at:?}");
        assert!(!is_idle || changed == 0, "{at:?}");
        // One that was restored goes on alike.
        third = third.filter(|_| budget == Budget::Unlimited);
        if let Some(monitor) = &mut third {
            for (now, states) in calls {
                // What is refused here was refused there.
                drop(monitor.track(now, states));
            }
            let mut again = Vec::new();
            monitor.advance(next, &mut again).unwrap();
            assert_eq!(again, events, "{at:?}");
            are_same(monitor, &pair.tracked, at);
            seen.again += again.len();
        }
        if rng.random_bool(0.1) {
            third = Some(restored(&pair.tracked));
        }
        ledger.read(&events);
        let known = pair.tracked.complete_until();
        let mut expected = reference.tick(pair.tracked.scene(), next, known);
        expected.sort_by(order);
        let mut found: Vec<_> = events.iter().map(reported).collect();
        found.sort_by(order);
        assert_eq!(found, expected, "{at:?}");
        if known > next {
            for (index, level) in LEVELS.into_iter().enumerate() {
                let found = bits(pair.tracked.conflicts(index).unwrap());
                assert_eq!(found, one_shot(&pair.tracked, level, known), "{at:?}");
                seen.conflicts += found.len();
            }
        }
        seen.known_short += usize::from(known < next + lookahead);
        said.append(&mut events);
    }
    seen.events += said.len();
    #[cfg(feature = "recording")]
    assert!(recording.again(&mut pair.tracked) == said);
}

#[test]
fn a_monitor_that_is_told_states_equals_one_that_is_told_plans() {
    let mut seen = Seen::default();
    for seed in 401..421 {
        life(seed, &mut seen);
    }
    assert!(seen.told > 10_000 && seen.unchanged > 2_000, "{seen:?}");
    assert!(seen.conflicts > 20_000 && seen.events > 5_000, "{seen:?}");
    assert!(seen.twice > 1_000 && seen.idle > 1_000, "{seen:?}");
    let counts = [seen.late, seen.ahead, seen.refused, seen.jumps];
    assert!(counts.iter().all(|&count| count > 20), "{seen:?}");
    assert!(seen.known_short > 50 && seen.again > 500, "{seen:?}");
}
