//! Plans that come late: their beginning, or that of their body, lies before the clock.

use super::reference::{Reference, order, reported};
use super::scenarios::tick;
use super::support::{line, rng, wander};
use super::{Ledger, is_as_screened};
use glam::DVec3;
#[cfg(feature = "live")]
use nearmiss::live::{Handle, LiveOptions, Report, ReportKind, Request, Ticket};
#[cfg(feature = "recording")]
use nearmiss::recording::Replay;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Command, Error, Event, Hitbox, Monitor, Outside, Scene,
    State, Trajectory,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
#[cfg(feature = "recording")]
use std::{
    io,
    sync::{Arc, Mutex},
};

const LEVEL: AlertLevel = AlertLevel::at(1.5).with_release(2.0);

/// From the origin at a time (s) on, to 30 s.
fn away(time: f64, velocity: DVec3) -> Trajectory {
    line(time, 30.0, DVec3::ZERO, velocity)
}

fn alone(trajectory: Trajectory) -> (Monitor, BodyId) {
    let mut scene = Scene::new();
    let id = scene.insert(Body::new(trajectory)).unwrap();
    (Monitor::new(scene, 0.0, 10.0, &[LEVEL]).unwrap(), id)
}

/// Its position at a time (s).
fn place(monitor: &Monitor, id: BodyId, time: f64) -> Option<DVec3> {
    monitor.scene().body(id).unwrap().trajectory.position(time)
}

#[test]
fn a_newer_plan_that_begins_earlier_is_followed() {
    let (mut monitor, id) = alone(line(0.0, 9.0, DVec3::ZERO, DVec3::Z));
    tick(&mut monitor, 2.2);
    assert_eq!(monitor.replan(id, 2.15, away(2.15, DVec3::X)), Ok(2.15));
    // What the body did before 2.15 s is forgotten; once more in the same tick, and after the next.
    for (now, velocity) in [(2.2, DVec3::Y), (2.2, -DVec3::X), (2.3, -DVec3::Y)] {
        tick(&mut monitor, now);
        assert_eq!(monitor.replan(id, 2.0, away(2.0, velocity)), Ok(2.15));
        for time in [2.15, 4.0] {
            let there = away(2.0, velocity).position(time);
            assert_eq!(place(&monitor, id, time), there);
        }
        assert_eq!(place(&monitor, id, 2.1), None);
    }
    // One that begins after all that is known leaves what is known before it.
    assert_eq!(
        monitor.replan(id, 2.0, line(2.3, 9.0, DVec3::ZERO, DVec3::Z)),
        Ok(2.3)
    );
    let before = away(2.0, -DVec3::Y).position(2.2);
    assert_eq!(place(&monitor, id, 2.2), before);
    assert_eq!(place(&monitor, id, 2.3), Some(DVec3::ZERO));
    // Kept for long enough, nothing is lost.
    monitor.set_history(1.0).unwrap();
    tick(&mut monitor, 2.5);
    assert_eq!(monitor.replan(id, 2.45, away(2.45, DVec3::X)), Ok(2.45));
    assert_eq!(monitor.replan(id, 2.4, away(2.4, DVec3::Y)), Ok(2.4));
}

/// In a batch, each plan is judged against what those before it leave.
#[test]
fn a_late_plan_of_a_batch_follows_those_before_it() {
    let states = [0.0, 4.0, 10.0].map(|time| State::new(time, time * DVec3::Z, DVec3::Z));
    let own = Trajectory::from_states(&states).unwrap();
    let (mut together, id) = alone(own.clone());
    let (mut in_turn, _) = alone(own);
    for monitor in [&mut together, &mut in_turn] {
        tick(monitor, 5.0);
    }
    let plan = |start: f64, velocity| Command::Replan(id, start, away(start, velocity).into());
    // What the body did before 3 s is forgotten with the first one.
    let plans = [plan(3.0, DVec3::X), plan(2.0, DVec3::Y)];
    for plan in plans.clone() {
        in_turn.apply([plan]).unwrap();
    }
    together.apply(plans).unwrap();
    assert_eq!(place(&together, id, 2.9), None);
    assert_eq!(place(&together, id, 3.0), Some(DVec3::Y));
    let body = |monitor: &Monitor| monitor.scene().body(id).unwrap().clone();
    assert_eq!(body(&together), body(&in_turn));
}

#[test]
fn a_plan_that_does_not_reach_the_clock_is_refused() {
    let (mut monitor, id) = alone(line(0.0, 9.0, DVec3::ZERO, DVec3::Z));
    tick(&mut monitor, 2.2);
    // The body's past is known; and is not.
    for _ in 0..2 {
        let before = monitor.scene().body(id).unwrap().clone();
        for (start, end) in [(1.5, 2.1), (1.5, 2.2), (2.21, 5.0)] {
            let short = line(start, end, DVec3::ZERO, DVec3::X);
            let error = monitor.replan(id, 1.5, short).unwrap_err();
            let time = 2.2;
            let expected = Error::NoNewPlan { time, start, end };
            assert_eq!(error, expected.in_body(0).with_id(id));
            assert_eq!(monitor.scene().body(id), Some(&before));
        }
        for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = monitor.replan(id, time, away(2.0, DVec3::X)).unwrap_err();
            let expected = Error::ChangeTime { time }.in_body(0).with_id(id);
            assert_eq!(error.to_string(), expected.to_string());
        }
        assert_eq!(monitor.replan(id, 2.15, away(2.15, DVec3::X)), Ok(2.15));
    }
    // A body that is not there yet follows no plan from now on.
    let (mut monitor, id) = alone(line(5.0, 9.0, DVec3::ZERO, DVec3::Z));
    tick(&mut monitor, 2.2);
    let error = monitor.replan(id, 2.0, away(2.0, DVec3::X)).unwrap_err();
    let expected = Error::NoOldPlan {
        time: 2.2,
        start: 5.0,
        end: 9.0,
    };
    assert_eq!(error, expected.in_body(0).with_id(id));
    // Parts of a plan come one after the other, though all are over.
    let (mut monitor, id) = alone(line(0.0, 1.0, DVec3::ZERO, DVec3::Z));
    tick(&mut monitor, 9.0);
    let part = |start: f64| line(start, start + 1.0, start * DVec3::Z, DVec3::Z);
    assert_eq!(monitor.replan(id, 1.0, part(1.0)), Ok(1.0));
    assert_eq!(monitor.replan(id, 2.0, part(2.0)), Ok(2.0));
    assert_eq!(place(&monitor, id, 3.0), Some(3.0 * DVec3::Z));
}

/// A velocity that jumps is what it is from that instant on, in an answer and once it is so.
#[test]
fn the_velocity_at_the_instant_of_a_replan_is_the_new_one() {
    // Exact in f64: both plans are as far from the other body at that instant.
    let apart = DVec3::X * 1.25;
    let now = 2.0;
    let state = |time: f64| State::new(time, apart + (time - now) * DVec3::X, DVec3::X);
    let plans = [
        Trajectory::coasting(state(now)).unwrap(),
        Trajectory::from_states(&[now, 20.0].map(state)).unwrap(),
        Trajectory::from_states(&[now - 1.0, now, 20.0].map(state)).unwrap(),
    ];
    let mut scene = Scene::new();
    scene
        .insert(Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap()))
        .unwrap();
    let nears = line(0.0, 20.0, apart + 2.0 * DVec3::X, -DVec3::X);
    let id = scene.insert(Body::new(nears)).unwrap();
    for plan in plans {
        let mut monitor = Monitor::new(scene.clone(), 0.0, 10.0, &[LEVEL]).unwrap();
        tick(&mut monitor, now);
        let would = monitor.what_if(id, &plan, 0).unwrap()[0].closest;
        assert_eq!(would.time, now);
        assert!(would.relative_velocity.distance(-DVec3::X) < 1e-12);
        assert_eq!(monitor.replan(id, now, plan), Ok(now));
        let trajectory = &monitor.scene().body(id).unwrap().trajectory;
        assert_eq!(trajectory.velocity(now), Some(DVec3::X));
        tick(&mut monitor, now);
        assert_eq!(monitor.conflicts(0).unwrap()[0].closest, would);
        is_as_screened(&monitor, LEVEL);
    }
}

fn plan(rng: &mut ChaCha8Rng, start: f64) -> Trajectory {
    let segments = rng.random_range(1..6);
    let states = wander(rng, start, segments, 0.6, 9.0, 3.0);
    let outside = match rng.random_range(0..6) {
        0 => return Trajectory::coasting(states[0]).unwrap(),
        1 => return Trajectory::at_rest(states[0].position).unwrap(),
        2 => Outside::Coast,
        3 => Outside::Extrapolate,
        _ => Outside::Absent,
    };
    Trajectory::from_states(&states)
        .unwrap()
        .with_outside(outside)
}

fn goes_on_from(plan: &Trajectory, time: f64) -> bool {
    plan.domain().contains(time)
        && (plan.outside_after() != Outside::Absent || plan.domain().end() > time)
}

/// When a plan takes over from another one; none if it is refused.
fn takes_over(old: &Trajectory, new: &Trajectory, from: f64, now: f64) -> Option<f64> {
    let mut used = from;
    if from <= now {
        if old.domain().contains(now) && !goes_on_from(new, now) {
            return None;
        }
        let known = old.domain().start().max(new.domain().start());
        used = from.max(known).min(now);
    }
    (old.domain().contains(used) && goes_on_from(new, used)).then_some(used)
}

/// How often what happened.
#[derive(Debug, Default)]
struct Seen {
    in_time: u32,
    late: u32,
    cut_short: u32,
    refused: u32,
    events: usize,
}

/// The body follows the old plan before the instant, and the new one from it on, as far as it is known.
fn check_flown(old: &Trajectory, new: &Trajectory, used: f64, flown: &Trajectory, now: f64) {
    let known = flown.domain().start();
    assert!(known <= now.max(old.domain().start()));
    let steps = (-40..60).map(|step| now + 0.1 * f64::from(step));
    for time in steps.chain([used, now]).filter(|&time| time >= known) {
        let followed = if time < used { old } else { new };
        let both = |plan: &Trajectory| (plan.position(time), plan.velocity(time));
        assert_eq!(both(flown), both(followed), "{time} {used}");
    }
}

/// Plans that come in any order, for any time about the clock's, some in batches.
fn random_late_plans(seed: u64, history: f64, seen: &mut Seen) {
    let mut rng = rng(seed);
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..16)
        .map(|_| {
            let body = Body::new(plan(&mut rng, -1.0));
            scene
                .insert(body.with_hitbox(Hitbox::sphere(0.3).unwrap()))
                .unwrap()
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap();
    monitor.set_history(history).unwrap();
    #[cfg(feature = "recording")]
    let recording = Recording::of(&mut monitor);
    let mut said = Vec::new();
    let (mut reference, mut ledger) = (Reference::new(&[LEVEL], 0.0, 2.0), Ledger::default());
    let mut events: Vec<Event> = Vec::new();
    for step in 0..250_u32 {
        let clock = monitor.now();
        for _ in 0..rng.random_range(0..5) {
            let id = ids[rng.random_range(0..ids.len())];
            let from = clock + rng.random_range(-2.0..0.5);
            let start = from + rng.random_range(-1.0..0.3);
            let new = plan(&mut rng, start);
            let old = monitor.scene().body(id).unwrap().trajectory.clone();
            if rng.random_range(0..20) == 0 {
                monitor.set_trajectory(id, new).unwrap();
                continue;
            }
            let expected = takes_over(&old, &new, from, clock);
            let done = if rng.random_bool(0.3) {
                // Twice at once: what the first one leaves is what the second one follows.
                let twice = [(); 2].map(|()| Command::Replan(id, from, new.clone().into()));
                monitor.apply(twice).map(|_| expected.unwrap_or(from))
            } else {
                monitor.replan(id, from, new.clone())
            };
            let flown = &monitor.scene().body(id).unwrap().trajectory;
            if let Some(used) = expected {
                assert_eq!(done, Ok(used), "{from} {clock}");
                check_flown(&old, &new, used, flown, clock);
                seen.in_time += u32::from(from > clock);
                seen.late += u32::from(from <= clock);
                seen.cut_short += u32::from(used > from && used > new.domain().start());
            } else {
                assert!(done.is_err() && *flown == old, "{done:?}");
                seen.refused += 1;
            }
        }
        let now = clock + rng.random_range(0.0..0.4);
        let budget = match step % 3 {
            0 => Budget::Work(rng.random_range(0..40)),
            _ => Budget::Unlimited,
        };
        events.clear();
        monitor.advance_within(now, budget, &mut events).unwrap();
        ledger.read(&events);
        let known = monitor.complete_until();
        let mut expected = reference.tick(monitor.scene(), now, known);
        expected.sort_by(order);
        let mut found: Vec<_> = events.iter().map(reported).collect();
        found.sort_by(order);
        assert_eq!(found, expected, "seed {seed}, step {step}");
        if known > now {
            is_as_screened(&monitor, LEVEL);
        }
        said.append(&mut events);
    }
    seen.events += said.len();
    #[cfg(feature = "recording")]
    assert!(recording.again(&mut monitor) == said);
}

/// What a monitor writes.
#[cfg(feature = "recording")]
#[derive(Clone, Default)]
pub(super) struct Recording(pub(super) Arc<Mutex<Vec<u8>>>);

#[cfg(feature = "recording")]
impl io::Write for Recording {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(feature = "recording")]
impl Recording {
    pub(super) fn of(monitor: &mut Monitor) -> Self {
        let recording = Self::default();
        monitor.start_recording(recording.clone()).unwrap();
        recording
    }

    /// The events of a replay.
    pub(super) fn again(&self, monitor: &mut Monitor) -> Vec<Event> {
        monitor.stop_recording().unwrap();
        let bytes = self.0.lock().unwrap();
        let mut replay = Replay::open(&bytes[..]).unwrap();
        let mut events = Vec::new();
        while replay.tick(&mut events).unwrap().is_some() {}
        events
    }
}

#[test]
fn late_plans_are_followed_as_the_model_says() {
    let mut seen = Seen::default();
    for seed in 81..85 {
        random_late_plans(seed, 0.0, &mut seen);
        random_late_plans(seed, 0.7, &mut seen);
    }
    let counts = [seen.in_time, seen.late, seen.cut_short, seen.refused];
    assert!(counts.iter().all(|&count| count > 100), "{seen:?}");
    assert!(seen.events > 2_000, "{seen:?}");
}

/// A state that comes late is reported as a plan is: where it is the body's own motion, too.
#[cfg(feature = "live")]
#[test]
fn a_late_state_is_reported_as_a_late_plan_is() {
    type Tell = fn(&Handle, f64, BodyId, State) -> Ticket;
    let by_plan: Tell = |game, from, id, state| {
        let plan = Trajectory::coasting(state).unwrap();
        // In a batch: the next plan does not supersede it.
        game.send(vec![Command::Replan(id, from, plan.into())])
            .unwrap()
    };
    let by_state: Tell = |game, from, id, state| game.track(from, [(id, state)]).unwrap();
    for tell in [by_plan, by_state] {
        let (mut monitor, id) = alone(line(0.0, 9.0, DVec3::ZERO, DVec3::Z));
        tick(&mut monitor, 2.2);
        let live = monitor.spawn(LiveOptions::default()).unwrap();
        let game = live.handle();
        let state = |from: f64, velocity| State::new(from, DVec3::ZERO, velocity);
        // What the body did before 2.1 s is forgotten with the second one.
        tell(&game, 2.1, id, state(2.1, DVec3::X));
        tell(&game, 2.15, id, state(2.15, -DVec3::X));
        let late = [
            tell(&game, 2.0, id, state(2.0, DVec3::Y)),
            tell(&game, 2.0, id, state(2.0, DVec3::Y)),
        ];
        tell(&game, 2.2, id, state(2.2, DVec3::X));
        tell(&game, 2.3, id, state(2.3, DVec3::Y));
        live.stop_requests();
        let reports: Vec<Report> = live.reports().iter().collect();
        let reported = reports.iter().filter_map(|report| match &report.kind {
            ReportKind::Late { ticket, plans } => Some((*ticket, plans.clone())),
            _ => None,
        });
        let reported: Vec<_> = reported.collect();
        assert_eq!(reported, late.map(|ticket| (ticket, vec![(id, 2.1)])));
    }
}

/// On a network that delays plans by up to half a second, with more orders waiting than a step takes.
#[cfg(feature = "live")]
#[test]
fn a_backlog_loses_no_late_plan() {
    const BODIES: usize = 60;
    let mut rng = rng(91);
    let mut long = |start: f64| {
        let states = wander(&mut rng, start, 20, 1.0, 30.0, 4.0);
        Trajectory::from_states(&states).unwrap()
    };
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..BODIES)
        .map(|_| scene.insert(Body::new(long(0.0))).unwrap())
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 3.0, &[LEVEL]).unwrap();
    tick(&mut monitor, 0.0);
    // The last plan of each body, and all orders.
    let mut last = vec![Trajectory::at_rest(DVec3::ZERO).unwrap(); BODIES];
    let mut orders = Vec::new();
    for frame in 1..=60_u32 {
        // The last clock, 1 s, comes once: what waits for its tick waits for all.
        let clock = f64::from(frame) / 61.0;
        orders.push(Request::Clock(clock));
        for (number, last) in (0_u32..).zip(&mut last) {
            let delay = f64::from((frame * 37 + number * 11) % 60) / 120.0;
            let from = (clock - delay).max(0.0);
            *last = long(from - 0.01);
            orders.push(Command::Replan(ids[number as usize], from, last.clone().into()).into());
        }
    }
    orders.push(Request::Clock(1.0));
    let options = LiveOptions::default()
        .with_requests(8_192)
        .with_reports(1 << 16);
    let live = monitor.spawn(options).unwrap();
    let game = live.handle();
    let tickets: Vec<_> = orders
        .iter()
        .map(|order| game.send(order.clone()).unwrap())
        .collect();
    while game.complete_until() < 4.0 {
        std::thread::yield_now();
    }
    let stopped = live.shutdown().unwrap();
    assert_eq!(stopped.counts.refused, 0, "{:?}", stopped.counts);
    let mut cut_short = 0;
    for report in &stopped.reports {
        match &report.kind {
            ReportKind::Late { ticket, plans } => {
                let number = tickets.binary_search(ticket).unwrap();
                let Request::Change(Command::Replan(id, from, _)) = &orders[number] else {
                    panic!("{report:?}");
                };
                let [(late, used)] = plans[..] else {
                    panic!("{report:?}");
                };
                assert!(late == *id && *from < used && used <= 1.0, "{report:?}");
                cut_short += 1;
            }
            ReportKind::Event(_) | ReportKind::Ticked { .. } => {}
            other => panic!("{other:?}"),
        }
    }
    assert!(cut_short > 100, "{cut_short}");
    for (&id, plan) in ids.iter().zip(last) {
        for time in [1.0, 1.7, 9.0] {
            assert_eq!(place(&stopped.monitor, id, time), plan.position(time));
        }
    }
    is_as_screened(&stopped.monitor, LEVEL);
}
