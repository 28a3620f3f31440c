//! Bodies that rest in contact with each other: ticks hardly look at them.

use super::is_as_screened;
use super::support::{bits, rng, vector, with_every_change};
use glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Encounter, Hitbox, Layers, Monitor, Orientation, Scene,
    Sphere, State, Trajectory,
};
use rand::RngExt;

const LEVELS: [AlertLevel; 2] = [AlertLevel::at(0.2).with_release(0.5), AlertLevel::at(0.0)];

/// In one of two worlds all balls spin, which changes nothing but that they do not count as resting. Most are given states
/// now and then, many of them without velocity, and some never move. Clusters rest in both worlds.
#[test]
fn resting_bodies_are_reported_as_all_others() {
    let (mut reported, mut stayed) = (0, 0);
    let floor = Body::new(Trajectory::at_rest(-2.0 * DVec3::Z).unwrap());
    let floor = floor.with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
    for seed in 0..6 {
        let mut rng = rng(700 + seed);
        let mut scenes = [Scene::new(), Scene::new()];
        let mut ids: Vec<BodyId> = Vec::new();
        for number in 0..40 {
            let place = vector(&mut rng, 2.5);
            let is_cluster = number % 5 == 0;
            let hitbox = if is_cluster {
                let spheres = [-0.4, 0.4].map(|x| Sphere::new(x * DVec3::X, 0.5));
                Hitbox::cluster(spheres.to_vec()).unwrap()
            } else {
                Hitbox::sphere(0.5).unwrap()
            };
            let body = Body::new(Trajectory::at_rest(place).unwrap()).with_hitbox(hitbox);
            let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z).unwrap();
            let spinning = body.clone().with_orientation(spin);
            let other = if is_cluster { body.clone() } else { spinning };
            ids.push(scenes[0].insert(body).unwrap());
            scenes[1].insert(other).unwrap();
        }
        let mut monitors = scenes.map(|mut scene| {
            scene.insert(floor.clone()).unwrap();
            with_every_change(Monitor::new(scene, 0.0, 1.5, &LEVELS).unwrap())
        });
        let mut now = 0.0;
        for step in 0..150 {
            now += match rng.random_range(0..20) {
                0 => 2.5,
                1 => 0.0,
                _ => rng.random_range(0.0..0.1),
            };
            let told: Vec<(BodyId, State)> = (0..rng.random_range(0..2))
                .map(|_| {
                    let id = ids[rng.random_range(0..ids.len() / 2)];
                    let velocity = match rng.random_range(0..3) {
                        0 => vector(&mut rng, 0.5),
                        _ => DVec3::ZERO,
                    };
                    (id, State::new(now, vector(&mut rng, 2.5), velocity))
                })
                .collect();
            let budget = match rng.random_range(0..8) {
                0 => Budget::Work(rng.random_range(0..100)),
                _ => Budget::Unlimited,
            };
            let events = monitors.each_mut().map(|monitor| {
                let mut events = Vec::new();
                monitor.track(now, told.iter().copied()).unwrap();
                monitor.advance_within(now, budget, &mut events).unwrap();
                events
            });
            assert_eq!(events[0], events[1], "{seed} {step}");
            let encounters =
                [&monitors[0], &monitors[1]].map(|one| one.encounters().copied().collect());
            let [one, other]: [Vec<Encounter>; 2] = encounters;
            assert_eq!(one, other, "{seed} {step}");
            stayed += one.iter().filter(|one| one.open).count();
            for level in 0..LEVELS.len() {
                let [one, other] =
                    [&monitors[0], &monitors[1]].map(|one| bits(one.conflicts(level).unwrap()));
                assert_eq!(one, other, "{seed} {step}");
            }
            if monitors[0].is_caught_up() {
                is_as_screened(&monitors[0], LEVELS[0]);
            }
            reported += events[0].len();
        }
    }
    assert!(reported > 1_000 && stayed > 10_000, "{reported} {stayed}");
}

/// Balls on a floor that were told to rest at one instant are solved then, and never again.
#[test]
fn what_rests_is_solved_once() {
    let mut scene = Scene::new();
    let floor = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let ground = Hitbox::half_space(DVec3::Z).unwrap();
    scene
        .insert(
            Body::new(floor)
                .with_hitbox(ground)
                .with_layers(Layers::new(2, 1)),
        )
        .unwrap();
    let states: Vec<State> = (0..30)
        .map(|x| State::new(0.0, [f64::from(x), 0.0, 0.5], DVec3::ZERO))
        .collect();
    let ids: Vec<BodyId> = states
        .iter()
        .map(|state| {
            let ball = Body::new(Trajectory::coasting(*state).unwrap());
            let ball = ball.with_hitbox(Hitbox::sphere(0.5).unwrap());
            scene.insert(ball.with_layers(Layers::new(1, 2))).unwrap()
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &LEVELS).unwrap();
    let (mut events, mut solved) = (Vec::new(), Vec::new());
    for tick in 0..1_000 {
        let now = 0.25 * f64::from(tick);
        if tick == 10 {
            let told = ids.iter().zip(&states).take(15).map(|(&id, state)| {
                let state = State::new(now, state.position, DVec3::ZERO);
                (id, state)
            });
            monitor.track(now, told).unwrap();
        }
        monitor.advance(now, &mut events).unwrap();
        if monitor.stats().survivors > 0 {
            solved.push(tick);
        }
    }
    assert_eq!((events.len(), solved), (60, vec![0]));
}
