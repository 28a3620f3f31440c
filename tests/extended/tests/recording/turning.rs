//! Recordings and snapshots of bodies that turn.

use super::support::{rng, vector};
use super::{Memory, replay, text};
use glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyId, BodyPlan, BodyState, Command, Event, Hitbox, Monitor, Orientation,
    Outside, Scene, Snapshot, Sphere, State, Trajectory,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

const STEP: f64 = 0.1;

/// Ten bodies that turn above a floor.
fn monitor(rng: &mut ChaCha8Rng) -> (Monitor, Vec<BodyId>) {
    let sphere = |offset| Sphere {
        offset,
        radius: 0.3,
    };
    let hitbox = Hitbox::cluster(vec![sphere(1.5 * DVec3::X), sphere(-DVec3::Y)]).unwrap();
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..10)
        .map(|_| {
            let state = State::new(0.0, vector(rng, 5.0), vector(rng, 1.0));
            let plan = Trajectory::coasting(state).unwrap();
            let spin = Orientation::spin(0.0, DQuat::IDENTITY, vector(rng, 3.0)).unwrap();
            let body = Body::new(plan).with_hitbox(hitbox.clone());
            scene.insert(body.with_orientation(spin)).unwrap()
        })
        .collect();
    let floor = Trajectory::at_rest(-4.5 * DVec3::Z).unwrap();
    let above = Hitbox::half_space(DVec3::Z).unwrap();
    scene.insert(Body::new(floor).with_hitbox(above)).unwrap();
    let monitor = Monitor::new(scene, 0.0, 3.0, &[AlertLevel::at(0.2)]).unwrap();
    (monitor, ids)
}

/// Gives a body another way of turning, of each kind in turn, and moves the clock.
fn live_on(
    monitor: &mut Monitor,
    ids: &[BodyId],
    tick: u8,
    rng: &mut ChaCha8Rng,
    events: &mut Vec<Event>,
) {
    let now = STEP * f64::from(tick);
    let id = ids[rng.random_range(0..ids.len())];
    let turn = DQuat::from_scaled_axis(vector(rng, 1.0));
    let knots = [(now, DQuat::IDENTITY), (now + 2.0, turn)];
    let state = State::new(now, vector(rng, 4.0), vector(rng, 1.0));
    let plan = Trajectory::coasting(state).unwrap();
    match tick % 5 {
        0 => {
            let shortest = Orientation::slerp(&knots).unwrap();
            let on = shortest.with_outside(Outside::Coast);
            monitor.orient(id, now, on).unwrap();
        }
        1 => {
            let smooth = Orientation::normalized_cubic(&knots).unwrap();
            let next = BodyPlan::new(plan, smooth);
            monitor.replan(id, now, next).unwrap();
        }
        2 => {
            let told = BodyState::from(state).with_spin(turn, vector(rng, 2.0));
            monitor.track(now, [(id, told)]).unwrap();
        }
        3 => {
            let fixed = Command::SetOrientation(id, Orientation::FIXED);
            monitor.apply([fixed]).unwrap();
        }
        _ => {
            let spin = Orientation::spin(now, turn, vector(rng, 4.0)).unwrap();
            let coarse = spin.with_tolerance(0.01).unwrap();
            monitor.set_orientation(id, coarse).unwrap();
        }
    }
    monitor.advance(now, events).unwrap();
}

/// All that sets an orientation is recorded, and replayed.
#[test]
fn turning_bodies_are_replayed() {
    let mut rng = rng(31);
    let (mut monitor, ids) = monitor(&mut rng);
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    let mut events = Vec::new();
    for tick in 0..60 {
        live_on(&mut monitor, &ids, tick, &mut rng, &mut events);
    }
    monitor.close(&mut events);
    let (again, end) = replay(&file.bytes());
    end.unwrap();
    assert_eq!(text(&events), text(&again));
    assert!(events.len() > 30, "{}", events.len());
}

/// From a snapshot, from a file too, the same plans lead to the same events, bit for bit.
#[test]
fn turning_bodies_are_restored() {
    const BEFORE: u8 = 30;
    let mut said = 0;
    for seed in 0..6 {
        let mut life = rng(seed);
        let (mut monitor, ids) = monitor(&mut life);
        // Taken after each kind of change.
        let taken = BEFORE + u8::try_from(seed).unwrap();
        for tick in 0..taken {
            live_on(&mut monitor, &ids, tick, &mut life, &mut Vec::new());
        }
        let snapshot = monitor.snapshot();
        let file = serde_json::to_string(&snapshot).unwrap();
        let read: Snapshot = serde_json::from_str(&file).unwrap();
        let lives = |mut monitor: Monitor| {
            let (mut life, mut events) = (rng(seed + 100), Vec::new());
            let mut conflicts = Vec::new();
            for tick in taken..taken + 30 {
                live_on(&mut monitor, &ids, tick, &mut life, &mut events);
                conflicts.push(format!("{:?}", monitor.conflicts(0).unwrap()));
            }
            monitor.close(&mut events);
            (events, conflicts)
        };
        let (events, conflicts) = lives(monitor);
        for snapshot in [snapshot, read] {
            let (found, others) = lives(Monitor::restore(snapshot).unwrap());
            assert_eq!(text(&events), text(&found), "seed {seed}");
            assert_eq!(conflicts, others, "seed {seed}");
        }
        said += events.len();
    }
    assert!(said > 200, "{said}");
}
