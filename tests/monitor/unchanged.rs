//! Settings that a body has already.

use super::scenarios::tick;
use super::support::{bits, rng, vector, wander, with_every_change};
use glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyId, BodyState, Command, Hitbox, Layers, Monitor, Orientation, Scene,
    Sphere, State, Trajectory,
};

const LEVEL: AlertLevel = AlertLevel::at(1.0);

fn monitor() -> (Monitor, Vec<BodyId>) {
    let (mut rng, mut scene) = (rng(3), Scene::new());
    let mut ids = Vec::new();
    for number in 0..60 {
        let plan = if number % 2 == 0 {
            let states = wander(&mut rng, 0.0, 20, 1.0, 10.0, 3.0);
            Trajectory::from_states(&states).unwrap()
        } else {
            let state = State::new(0.0, vector(&mut rng, 5.0), vector(&mut rng, 1.0));
            Trajectory::coasting(state).unwrap()
        };
        let spheres = [-0.3, 0.3].map(|x| Sphere::new(x * DVec3::X, 0.3));
        let turn = Orientation::spin(0.0, DQuat::IDENTITY, vector(&mut rng, 1.0)).unwrap();
        let body = Body::new(plan).with_hitbox(Hitbox::cluster(spheres.to_vec()).unwrap());
        let body = body.with_orientation(turn).with_layers(Layers::new(3, 1));
        ids.push(scene.insert(body.with_model_error(0.1).unwrap()).unwrap());
    }
    (
        with_every_change(Monitor::new(scene, 0.0, 4.0, &[LEVEL]).unwrap()),
        ids,
    )
}

/// All that a body has, as a game may write it in each frame.
fn as_they_are(monitor: &Monitor, ids: &[BodyId]) -> Vec<Command> {
    let of = |&id: &BodyId| {
        let body = monitor.scene().body(id).unwrap().clone();
        [
            Command::SetTrajectory(id, body.trajectory.clone()),
            Command::SetLayers(id, body.layers),
            Command::SetModelError(id, body.model_error()),
            Command::SetOrientation(id, body.orientation),
            Command::SetHitbox(id, body.hitbox),
        ]
    };
    ids.iter().flat_map(of).collect()
}

#[test]
fn what_a_body_has_already_is_no_change() {
    let (mut monitor, ids) = monitor();
    let (mut written, _) = self::monitor();
    let mut events = 0;
    for number in 0..40 {
        let now = 0.1 * f64::from(number);
        let commands = as_they_are(&written, &ids);
        written.apply(commands).unwrap();
        let (said, expected) = (tick(&mut written, now), tick(&mut monitor, now));
        assert_eq!(said, expected, "{now}");
        assert_eq!(
            bits(written.conflicts(0).unwrap()),
            bits(monitor.conflicts(0).unwrap())
        );
        assert_eq!(written.stats().changed, 0, "{now}");
        assert_eq!(written.stats().boxes, monitor.stats().boxes, "{now}");
        events += said.len();
    }
    assert!(events > 100, "{events}");
    // One number that differs is a change, also together with others that do not.
    let mut commands = as_they_are(&written, &ids[..1]);
    commands.push(Command::SetModelError(ids[0], 0.1_f64.next_up()));
    written.apply(commands).unwrap();
    tick(&mut written, 4.0);
    assert_eq!(written.stats().changed, 1);
}

/// An engine tells the states and spins of bodies that sleep, too. Balls do not change however they turn.
#[test]
fn a_body_at_rest_may_be_told_its_rotation() {
    let mut rng = rng(4);
    let rod = [-0.9, 0.0, 0.9].map(|x| Sphere::new(x * DVec3::X, 0.3));
    let hitboxes = [
        Hitbox::cluster(rod.to_vec()).unwrap(),
        Hitbox::sphere(0.5).unwrap(),
    ];
    let mut scene = Scene::new();
    let mut told = Vec::new();
    for number in 0..40_u32 {
        let place = vector(&mut rng, 8.0);
        let turn = DQuat::from_rotation_y(f64::from(number));
        let rest = Body::new(Trajectory::at_rest(place).unwrap())
            .with_hitbox(hitboxes[number as usize % 2].clone())
            .with_orientation(Orientation::spin(0.0, turn, DVec3::ZERO).unwrap());
        let id = scene.insert(rest).unwrap();
        told.push((id, place, turn));
    }
    let state = State::new(0.0, -10.0 * DVec3::X, 4.0 * DVec3::X);
    let moving = Body::new(Trajectory::coasting(state).unwrap());
    scene
        .insert(moving.with_hitbox(hitboxes[0].clone()))
        .unwrap();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap();
    let mut left_alone = Monitor::new(monitor.scene().clone(), 0.0, 2.0, &[LEVEL]).unwrap();
    let mut events = 0;
    for frame in 0..120 {
        let now = f64::from(frame) / 30.0;
        let states = told.iter().map(|&(id, place, turn)| {
            let state = BodyState::from(State::new(now, place, DVec3::ZERO));
            let is_ball = monitor.scene().body(id).unwrap().hitbox.spheres().len() == 1;
            let spin = f64::from(frame) * DVec3::Z;
            (
                id,
                state.with_spin(turn, if is_ball { spin } else { DVec3::ZERO }),
            )
        });
        let states: Vec<(BodyId, BodyState)> = states.collect();
        monitor.track(now, states).unwrap();
        let said = tick(&mut monitor, now);
        assert_eq!(said, tick(&mut left_alone, now), "{now}");
        assert_eq!(monitor.stats().changed, 0, "{now}");
        assert_eq!(monitor.stats().boxes, left_alone.stats().boxes, "{now}");
        events += said.len();
    }
    assert!(events > 10, "{events}");
}

#[test]
fn a_pair_that_is_ignored_already_is_no_change() {
    let (mut monitor, ids) = monitor();
    let (mut written, _) = self::monitor();
    let pairs = |number: usize| (ids[number], ids[number + 1]);
    for monitor in [&mut monitor, &mut written] {
        let (a, b) = pairs(0);
        monitor.ignore_pair(a, b).unwrap();
    }
    for number in 0..20 {
        let now = 0.1 * f64::from(number);
        let (ignored, other) = (pairs(0), pairs(2));
        written.ignore_pair(ignored.0, ignored.1).unwrap();
        written.unignore_pair(other.0, other.1).unwrap();
        assert_eq!(tick(&mut written, now), tick(&mut monitor, now), "{now}");
        assert_eq!(written.stats().boxes, monitor.stats().boxes, "{now}");
        assert_eq!(
            written.stats().survivors,
            monitor.stats().survivors,
            "{now}"
        );
    }
}
