//! Recordings: replays say the same to the last bit, and damage is found where it is.

#![cfg(feature = "recording")]
#![allow(
    clippy::unwrap_used,
    reason = "a monitor that cannot be built or recorded fails the test"
)]

mod damage;
mod half_spaces;
mod snapshots;
#[path = "../../../support/mod.rs"]
mod support;
mod turning;
mod writers;

use glam::{DQuat, DVec3};
use nearmiss::recording::{RecordingError, Replay};
use nearmiss::{
    AlertLevel, Body, BodyId, BodyState, Budget, Command, Event, Hitbox, Layers, Monitor, Outside,
    RevisionThreshold, Scene, Sphere, State, Trajectory,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::io::{self, Write};
use std::sync::{Arc, Mutex};
use support::{rng, vector, wander, with_every_change};

/// A file in memory that can be looked into.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Memory {
    fn bytes(&self) -> Vec<u8> {
        self.0.lock().unwrap().clone()
    }
}

const CUBE: f64 = 20.0;

fn body(rng: &mut ChaCha8Rng, now: f64) -> Body {
    let states = wander(rng, now, 12, 1.0, CUBE, 4.0);
    let outside = [Outside::Absent, Outside::Coast, Outside::Extrapolate];
    let plan = Trajectory::from_states(&states).unwrap();
    let sphere = Sphere {
        offset: vector(rng, 0.5),
        radius: rng.random_range(0.1..0.6),
    };
    let hitbox = if rng.random_bool(0.3) {
        Hitbox::cluster(vec![sphere, Sphere::default()]).unwrap()
    } else {
        Hitbox::sphere(sphere.radius).unwrap()
    };
    Body::new(plan.with_outside(outside[rng.random_range(0..3)]))
        .with_hitbox(hitbox)
        .with_layers(Layers::new(rng.random_range(1..8), rng.random_range(1..8)))
        .with_tag(rng.random())
}

fn monitor(rng: &mut ChaCha8Rng, count: usize, lookahead: f64) -> Monitor {
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..count)
        .map(|_| scene.insert(body(rng, -2.0)).unwrap())
        .collect();
    scene
        .insert(Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap()))
        .unwrap();
    scene.ignore_pair(ids[0], ids[1]).unwrap();
    scene.remove(ids[2]).unwrap();
    let levels = [AlertLevel::at(2.0).with_release(2.5), AlertLevel::at(0.0)];
    with_every_change(Monitor::new(scene, 0.0, lookahead, &levels).unwrap())
}

/// Whatever comes to mind between two ticks; returns true if a limit is to be tried next.
fn change(monitor: &mut Monitor, rng: &mut ChaCha8Rng) -> bool {
    let now = monitor.now();
    let ids: Vec<BodyId> = monitor.scene().bodies().map(|(id, _)| id).collect();
    let mut commands = Vec::new();
    for _ in 0..rng.random_range(0..4) {
        let id = ids[rng.random_range(0..ids.len())];
        let begin = now + rng.random_range(-1.0..1.0);
        let plan = body(rng, begin).trajectory;
        commands.push(match rng.random_range(0..10) {
            0 | 1 => Command::Replan(id, now + rng.random_range(0.0..2.0), plan.into()),
            2 => Command::Extend(id, plan.into()),
            3 => Command::SetTrajectory(id, plan),
            4 => Command::SetHitbox(id, body(rng, now).hitbox),
            5 if id != ids[0] => Command::IgnorePair(id, ids[0]),
            6 if id != ids[0] => Command::UnignorePair(ids[0], id),
            8 => Command::InsertIgnoring(body(rng, now), vec![id, ids[0]]),
            7 => Command::SetModelError(id, rng.random_range(0.0..0.5)),
            _ => Command::SetLayers(id, body(rng, now).layers),
        });
    }
    // Some are refused as a whole, and leave no trace.
    let _ = monitor.apply(commands);
    match rng.random_range(0..14) {
        0 => drop(monitor.insert(body(rng, now)).unwrap()),
        1 if ids.len() > 6 => drop(monitor.remove(ids[rng.random_range(0..ids.len())]).unwrap()),
        2 if ids.len() > 6 => drop(monitor.ignore_pair(ids[3], ids[4])),
        3 if ids.len() > 6 => drop(monitor.unignore_pair(ids[3], ids[4])),
        4 => monitor.set_history(rng.random_range(0.0..3.0)).unwrap(),
        5 => monitor
            .set_revision_threshold(
                RevisionThreshold::default()
                    .with_time(0.1)
                    .with_separation(f64::INFINITY),
            )
            .unwrap(),
        6 => monitor.set_max_spans(rng.random_range(5_000..9_000)),
        7 => return true,
        8 => monitor.skip_to(now + rng.random_range(0.0..1.0)).unwrap(),
        _ => {}
    }
    false
}

/// One tick with whatever comes to mind.
fn live_on(monitor: &mut Monitor, rng: &mut ChaCha8Rng, events: &mut Vec<Event>) {
    if change(monitor, rng) {
        // Refused or not, and if so, it leaves no trace.
        monitor.set_max_spans(rng.random_range(0..20));
        let _ = monitor.advance(monitor.now(), events);
        monitor.set_max_spans(Monitor::MAX_SPANS);
    }
    // A change may have set the clock.
    let now = monitor.now();
    let step = [0.0, 0.05, 0.05, 0.05, 2.0][rng.random_range(0..5)];
    let budget = if rng.random_bool(0.4) {
        Budget::Work(rng.random_range(0..150))
    } else {
        Budget::Unlimited
    };
    monitor.advance_within(now + step, budget, events).unwrap();
}

/// A recorded run that begins after `before` ticks: the file and what was said.
fn run(seed: u64, count: usize, before: u32, ticks: u32) -> (Vec<u8>, Vec<Event>) {
    run_with(5.0, seed, count, before, ticks)
}

fn run_with(
    lookahead: f64,
    seed: u64,
    count: usize,
    before: u32,
    ticks: u32,
) -> (Vec<u8>, Vec<Event>) {
    let mut rng = rng(seed);
    let mut monitor = monitor(&mut rng, count, lookahead);
    for _ in 0..before {
        live_on(&mut monitor, &mut rng, &mut Vec::new());
    }
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    let mut events = Vec::new();
    for _ in 0..ticks {
        live_on(&mut monitor, &mut rng, &mut events);
    }
    assert!(monitor.is_recording());
    monitor.close(&mut events);
    (file.bytes(), events)
}

fn replay(file: &[u8]) -> (Vec<Event>, Result<(), RecordingError>) {
    let mut events = Vec::new();
    let mut replay = match Replay::open(file) {
        Ok(replay) => replay,
        Err(error) => return (events, Err(error)),
    };
    loop {
        match replay.tick(&mut events) {
            Ok(Some(_)) => {}
            Ok(None) => {
                // However often it is asked.
                assert!(matches!(replay.tick(&mut events), Ok(None)));
                return (events, Ok(()));
            }
            Err(error) => return (events, Err(error)),
        }
    }
}

/// Every digit of every number.
fn text(events: &[Event]) -> Vec<String> {
    events.iter().map(|event| format!("{event:?}")).collect()
}

#[test]
fn a_replay_says_the_same() {
    let mut said = 0;
    for seed in 0..12 {
        // Some from the first moment on, some in the middle of things.
        let before = if seed % 2 == 0 { 0 } else { 40 };
        // In some the clock jumps over many lookaheads at a time.
        let lookahead = if seed % 3 == 0 { 0.05 } else { 5.0 };
        let (file, events) = run_with(lookahead, seed, 12, before, 150);
        let (again, end) = replay(&file);
        end.unwrap();
        assert_eq!(text(&events), text(&again), "seed {seed}");
        said += events.len();
    }
    assert!(said > 1_000, "{said}");
}

/// Where a clock jumps over many lookaheads with little budget, and plans change before it is caught up
/// with, a replay must not look farther ahead than the recorded run had come.
#[test]
fn a_replay_says_the_same_after_far_jumps_on_a_budget() {
    for seed in 100..140 {
        let (file, events) = run_with(0.01, seed, 40, 0, 60);
        let (again, end) = replay(&file);
        end.unwrap();
        assert_eq!(text(&events), text(&again), "seed {seed}");
    }
}

/// A replay finds at once what the recorded run had found by and by, before the limit was lowered.
#[test]
fn a_limit_that_was_lowered_refuses_no_replay() {
    let mut scene = Scene::new();
    for place in 0..5 {
        let plan = Trajectory::at_rest(0.1 * f64::from(place) * DVec3::X).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let mut monitor =
        with_every_change(Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap());
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    monitor.set_max_spans(1);
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    let mut events = Vec::new();
    // A short step: the tick searches for nothing again.
    monitor.advance(0.1, &mut events).unwrap();
    monitor.close(&mut events);
    assert_eq!(events.len(), 10, "all pairs are together to the end");
    let (again, end) = replay(&file.bytes());
    end.unwrap();
    assert_eq!(text(&events), text(&again));
}

/// Records a monitor of two bodies from a clock that stands still on, or after a tick that failed, and replays it. Returns
/// the number of events of the first recorded tick, which reads all encounters again.
fn events_of_reading_again(plans: [Trajectory; 2], fails: bool) -> usize {
    let mut scene = Scene::new();
    for plan in plans {
        let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap());
        scene.insert(body).unwrap();
    }
    let mut monitor =
        with_every_change(Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(0.0)]).unwrap());
    let mut before = Vec::new();
    monitor.advance(0.0, &mut before).unwrap();
    monitor.advance(7.0, &mut before).unwrap();
    let (file, mut events) = (Memory::default(), Vec::new());
    monitor.start_recording(file.clone()).unwrap();
    if fails {
        monitor.set_max_spans(0);
        assert!(monitor.advance(30.0, &mut events).is_err());
        monitor.set_max_spans(Monitor::MAX_SPANS);
    }
    monitor.advance(7.0, &mut events).unwrap();
    let told = events.len();
    monitor.advance(9.0, &mut events).unwrap();
    monitor.close(&mut events);
    let (again, end) = replay(&file.bytes());
    end.unwrap();
    assert_eq!(events, again);
    told
}

/// In a formation the least separation differs by rounding whenever it is read again, which is no event.
#[test]
fn formations_are_replayed() {
    for seed in 0..200 {
        let mut rng = rng(seed);
        let velocity = vector(&mut rng, 1.0);
        let plans = [0; 2].map(|_| {
            let (time, place) = (rng.random_range(-5.0..5.0), vector(&mut rng, 0.3));
            Trajectory::coasting(State::new(time, place + time * velocity, velocity)).unwrap()
        });
        assert_eq!(events_of_reading_again(plans, seed % 2 == 0), 0, "{seed}");
    }
}

/// A distance that changes by a few roundings from state to state is told again when it is read again: so the replay must
/// read when the monitor did.
#[test]
fn what_is_read_again_is_replayed() {
    let mut told = 0;
    for seed in 0..200 {
        let mut rng = rng(seed);
        let creeping = (0..13).map(|k| {
            let place = DVec3::X * (0.5 + rng.random_range(-20.0..20.0) * f64::EPSILON);
            State::new(2.5 * f64::from(k), place, DVec3::ZERO)
        });
        let creeping = Trajectory::from_states(&creeping.collect::<Vec<_>>()).unwrap();
        let plans = [Trajectory::at_rest(DVec3::ZERO).unwrap(), creeping];
        told += events_of_reading_again(plans, seed % 2 == 0);
    }
    assert!(told > 0);
}

#[test]
fn a_stopped_recording_ends_where_it_was_stopped() {
    let mut rng = rng(5);
    let mut monitor = monitor(&mut rng, 8, 5.0);
    assert_eq!(monitor.stop_recording().unwrap(), None);
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    let mut events = Vec::new();
    for _ in 0..20 {
        live_on(&mut monitor, &mut rng, &mut events);
    }
    let restored = Monitor::restore(monitor.snapshot()).unwrap();
    assert!(monitor.is_recording() && !restored.is_recording());
    let records = monitor.stop_recording().unwrap();
    assert!(records.is_some_and(|records| records > 20) && !monitor.is_recording());
    let file = file.bytes();
    let mut replayed = Replay::open(&file[..]).unwrap();
    let mut again = Vec::new();
    while replayed.tick(&mut again).unwrap().is_some() {}
    assert_eq!(text(&events), text(&again));
    // It goes on from there: the scenes are the same.
    let (scene, copy) = (monitor.scene(), replayed.monitor().scene());
    assert!(scene.bodies().eq(copy.bodies()));
    let now = replayed.into_monitor().now();
    assert_eq!(now.to_bits(), monitor.now().to_bits());
}

/// The documentation of recordings says so.
#[test]
fn a_told_state_takes_about_190_bytes_and_one_with_a_spin_360() {
    let mut rng = rng(31);
    for (spins, expected) in [(false, 180..200), (true, 345..380)] {
        let mut scene = Scene::new();
        let ball = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
        let ids: Vec<BodyId> = (0..100)
            .map(|_| scene.insert(ball.clone()).unwrap())
            .collect();
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(-1.0)]).unwrap();
        let file = Memory::default();
        monitor.start_recording(file.clone()).unwrap();
        let begin = file.bytes().len();
        let told = ids.iter().map(|&id| {
            let (position, velocity) = (vector(&mut rng, 500.0), vector(&mut rng, 10.0));
            let state = BodyState::from(State::new(1.0 / 60.0, position, velocity));
            let turned = vector(&mut rng, 3.0);
            let state = if spins {
                state.with_spin(DQuat::from_scaled_axis(turned), vector(&mut rng, 5.0))
            } else {
                state
            };
            (id, state)
        });
        monitor.track(1.0 / 60.0, told).unwrap();
        monitor.stop_recording().unwrap();
        let bytes = (file.bytes().len() - begin) / ids.len();
        assert!(expected.contains(&bytes), "{spins} {bytes}");
    }
}

#[cfg(feature = "live")]
#[test]
fn a_live_monitor_is_recorded_as_it_was_applied() {
    use nearmiss::live::{LiveOptions, Report, ReportKind};
    let mut rng = rng(12);
    let mut monitor = monitor(&mut rng, 60, 5.0);
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    let ids: Vec<BodyId> = monitor.scene().bodies().map(|(id, _)| id).collect();
    let options = LiveOptions::default().with_budget(std::time::Duration::from_micros(200));
    let live = monitor.spawn(options).unwrap();
    let handle = live.handle();
    for tick in 1..=120 {
        for _ in 0..10 {
            let id = ids[rng.random_range(0..10)];
            let plan = body(&mut rng, 0.0).trajectory;
            // A plan that is superseded never reaches the file.
            let _ = handle.send(Command::SetTrajectory(id, plan));
        }
        while handle.advance(f64::from(tick) / 60.0).is_err() {
            std::thread::yield_now();
        }
    }
    let mut said = Vec::new();
    let mut read = |report: Report| {
        if let ReportKind::Event(event) = report.kind {
            said.push(event);
        }
    };
    while handle.now() < 2.0 {
        live.reports().try_iter().for_each(&mut read);
    }
    let mut stopped = live.shutdown().unwrap();
    stopped.reports.into_iter().for_each(&mut read);
    stopped.monitor.stop_recording().unwrap();
    let (again, end) = replay(&file.bytes());
    end.unwrap();
    // How many depends on how the orders fell together in time.
    assert!(!said.is_empty());
    assert_eq!(text(&said), text(&again));
}
