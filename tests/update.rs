//! States of many bodies told to a scene in one call, against trajectories that are set one by one.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, BodyState, Error, Hitbox, Monitor, Orientation, Outside,
    Quantity, Query, Scene, State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use support::{bits, line, on_threads, rng, screen, vector, wander};

const CUBE: f64 = 20.0;

fn any_state(rng: &mut ChaCha8Rng, now: f64) -> State {
    let (position, velocity) = (vector(rng, CUBE / 2.0), vector(rng, 3.0));
    match rng.random_range(0..12) {
        0 => State::new(now - 1e9, position, DVec3::ZERO),
        1 => State::new(now, position + 1e9 * DVec3::Y, velocity),
        2 => State::new(now - 1e-9, position, velocity),
        3 => State::new(now + 7.0, position, velocity),
        _ => State::new(now, position, velocity),
    }
}

/// Splines absent outside, splines that coast, bodies at rest, and bodies of one state.
fn any_scene(rng: &mut ChaCha8Rng, count: u64) -> (Scene, Vec<BodyId>) {
    let mut scene = Scene::new();
    let ids = (0..count).map(|tag| {
        let states = wander(rng, -5.0, 12, 1.0, CUBE, 3.0);
        let plan = match tag % 4 {
            0 => Trajectory::from_states(&states).unwrap(),
            1 => {
                let plan = Trajectory::from_states(&states).unwrap();
                plan.with_outside(Outside::Coast)
            }
            2 => Trajectory::at_rest(states[0].position).unwrap(),
            _ => Trajectory::coasting(states[0]).unwrap(),
        };
        let hitbox = Hitbox::sphere(rng.random_range(0.0..0.4)).unwrap();
        let body = Body::new(plan).with_hitbox(hitbox).with_tag(tag);
        scene.insert(body).unwrap()
    });
    let ids = ids.collect();
    (scene, ids)
}

fn found(scene: &Scene, now: f64, accuracy: Accuracy) -> Vec<Vec<u64>> {
    let window = Window::new(now - 1.0, now + 4.0).unwrap();
    let query = Query::new(window).with_margin(1.0).with_accuracy(accuracy);
    bits(&scene.screen(&query).unwrap().conflicts)
}

#[test]
fn an_update_equals_trajectories_that_are_set_one_by_one() {
    for threads in [1, 2] {
        on_threads(threads, || {
            let (mut conflicts, mut twice) = (0, 0);
            for seed in 441..447 {
                let mut rng = rng(seed);
                let (mut scene, ids) = any_scene(&mut rng, 150);
                let mut one_by_one = scene.clone();
                for (frame, share) in (0..6).zip([0.05, 1.0, 0.6].into_iter().cycle()) {
                    let now = f64::from(frame) * 0.3;
                    let mut states = Vec::new();
                    for &id in &ids {
                        while rng.random_bool(share * 0.9) {
                            states.push((id, any_state(&mut rng, now)));
                        }
                    }
                    // Some are told a second time at the end, and some of the splines come back.
                    for _ in 0..5 {
                        let id = ids[rng.random_range(0..ids.len())];
                        states.push((id, any_state(&mut rng, now)));
                        let plan = wander(&mut rng, now - 2.0, 6, 1.0, CUBE, 3.0);
                        let plan = Trajectory::from_states(&plan).unwrap();
                        let id = ids[rng.random_range(0..ids.len())];
                        scene.set_trajectory(id, plan.clone()).unwrap();
                        one_by_one.set_trajectory(id, plan).unwrap();
                    }
                    let mut named: Vec<BodyId> = states.iter().map(|(id, _)| *id).collect();
                    named.sort_unstable();
                    named.dedup();
                    twice += states.len() - named.len();
                    scene.update(states.iter().copied()).unwrap();
                    for &(id, state) in &states {
                        let plan = Trajectory::coasting(state).unwrap();
                        one_by_one.set_trajectory(id, plan).unwrap();
                    }
                    assert!(scene.bodies().eq(one_by_one.bodies()), "{seed} {frame}");
                    // A clone has worked out nothing of the scene before.
                    let scenes = [&scene, &one_by_one, &scene.clone()];
                    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
                        let [updated, expected, anew] =
                            scenes.map(|scene| found(scene, now, accuracy));
                        assert_eq!(updated, expected, "{seed} {frame} {accuracy:?}");
                        assert_eq!(anew, expected, "{seed} {frame} {accuracy:?}");
                        conflicts += updated.len();
                    }
                }
            }
            assert!(conflicts > 2_000 && twice > 1_000, "{conflicts} {twice}");
        });
    }
}

#[test]
fn an_update_of_no_body_changes_nothing() {
    let (mut scene, _) = any_scene(&mut rng(451), 60);
    let before = scene.clone();
    scene.update([] as [(BodyId, State); 0]).unwrap();
    assert!(scene.bodies().eq(before.bodies()));
    let conflicts = found(&scene, 0.0, Accuracy::Exact);
    assert!(!conflicts.is_empty());
    assert_eq!(conflicts, found(&before, 0.0, Accuracy::Exact));
    Scene::new().update([] as [(BodyId, BodyState); 0]).unwrap();
}

/// In the middle of states that are fine. (Errors are compared as text, since no NaN equals another one.)
#[test]
fn an_update_that_is_refused_changes_nothing() {
    let mut rng = rng(452);
    let (mut scene, ids) = any_scene(&mut rng, 60);
    let removed = scene.insert(Body::new(line(0.0, 1.0, DVec3::X, DVec3::X)));
    let removed = removed.unwrap();
    scene.remove(removed).unwrap();
    let before = scene.clone();
    let expected = found(&before, 0.0, Accuracy::Exact);
    assert!(!expected.is_empty());
    let not_finite = |quantity, value| Error::NotFinite {
        knot: 0,
        quantity,
        value,
    };
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let at = |position, velocity| State::new(0.0, position, velocity);
    let too_large = Error::OutOfRange {
        knot: 0,
        quantity: Quantity::Position(2),
        value: 1e301,
    };
    let refused = [
        (
            ids[30],
            at(DVec3::ZERO, DVec3::new(0.0, nan, 0.0)),
            not_finite(Quantity::Velocity(1), nan)
                .in_body(30)
                .with_id(ids[30]),
        ),
        (
            ids[31],
            at(DVec3::new(-inf, 0.0, 0.0), DVec3::X),
            not_finite(Quantity::Position(0), -inf)
                .in_body(31)
                .with_id(ids[31]),
        ),
        (
            ids[32],
            at(DVec3::new(0.0, 0.0, 1e301), DVec3::X),
            too_large.in_body(32).with_id(ids[32]),
        ),
        (
            ids[33],
            State::new(nan, DVec3::ZERO, DVec3::X),
            not_finite(Quantity::Time, nan).in_body(33).with_id(ids[33]),
        ),
        (
            removed,
            at(DVec3::ZERO, DVec3::X),
            Error::UnknownBody { id: removed },
        ),
    ];
    for (id, state, error) in refused {
        let fine = ids.iter().map(|&id| (id, at(DVec3::ZERO, DVec3::Z)));
        let mut states: Vec<_> = fine.collect();
        states.insert(30, (id, state));
        let done = scene.update(states).unwrap_err();
        assert_eq!(format!("{done:?}"), format!("{error:?}"));
        assert!(scene.bodies().eq(before.bodies()), "{error}");
        assert_eq!(found(&scene, 0.0, Accuracy::Exact), expected, "{error}");
    }
}

/// Their summaries take no room: none is left behind by the last one that did.
#[test]
fn a_scene_without_any_spline_left_can_be_screened_and_cloned() {
    let window = Window::new(0.0, 9.0).unwrap();
    let rest = |x: f64| Body::new(Trajectory::at_rest(x * DVec3::X).unwrap());
    let spline = || Body::new(line(0.0, 9.0, DVec3::Y, DVec3::X));
    let mut scene = Scene::new();
    let first = scene.insert(spline()).unwrap();
    scene.insert(rest(0.0)).unwrap();
    scene.insert(rest(1.0)).unwrap();
    let second = scene.insert(spline()).unwrap();
    scene.remove(first).unwrap();
    let state = State::new(0.0, 9.0 * DVec3::X, DVec3::ZERO);
    scene.update([(second, state)]).unwrap();
    for scene in [&scene, &scene.clone()] {
        assert_eq!(screen(scene, window, 1.5).len(), 1);
    }
    // Nor does what comes then stand in their place.
    scene.insert(spline()).unwrap();
    assert_eq!(screen(&scene, window, 1.5).len(), 4);
    assert_eq!(screen(&scene.clone(), window, 1.5).len(), 4);
}

/// Also one without a spin: it leaves the orientation that the body had before. A monitor agrees.
#[test]
fn the_last_state_of_a_body_that_is_named_twice_counts() {
    let told = |x: f64| BodyState::from(State::new(0.0, x * DVec3::X, DVec3::Y));
    let spinning = |x: f64| told(x).with_spin(DQuat::IDENTITY, x * DVec3::Z);
    let turned = DQuat::from_rotation_x(1.0);
    let before = Orientation::spin(0.0, turned, DVec3::X).unwrap();
    let body = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
    let mut scene = Scene::new();
    let ids = [(); 5].map(|()| {
        let body = body.clone().with_orientation(before.clone());
        scene.insert(body).unwrap()
    });
    let states = [
        (ids[0], spinning(1.0)),
        (ids[1], told(2.0)),
        (ids[2], spinning(3.0)),
        (ids[0], told(4.0)),
        (ids[1], spinning(5.0)),
        (ids[2], spinning(6.0)),
        (ids[3], spinning(7.0)),
        (ids[4], spinning(8.0)),
        (ids[4], told(9.0)),
        (ids[4], spinning(10.0)),
    ];
    let mut monitor = Monitor::new(scene.clone(), 0.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
    scene.update(states).unwrap();
    monitor.track(0.0, states).unwrap();
    let spin = |x: f64| Orientation::spin(0.0, DQuat::IDENTITY, x * DVec3::Z).unwrap();
    let expected = [
        (4.0, before),
        (5.0, spin(5.0)),
        (6.0, spin(6.0)),
        (7.0, spin(7.0)),
        (10.0, spin(10.0)),
    ];
    for (id, (x, orientation)) in ids.into_iter().zip(expected) {
        let found = scene.body(id).unwrap();
        assert_eq!(found.trajectory.position(0.0), Some(x * DVec3::X));
        assert_eq!(found.orientation, orientation, "{x}");
        let tracked = monitor.scene().body(id).unwrap();
        let [found, tracked] = [found, tracked].map(|body| body.orientation.rotation(2.0));
        assert!(found.angle_between(tracked) < 1e-9, "{x}");
    }
}

/// `update` keeps the tolerance of orientations of all kinds, and so does a monitor, in which bodies turn as before until
/// they are told.
#[test]
fn a_told_spin_keeps_the_tolerance_that_the_body_has() {
    let knots = [0.0, 1.0, 2.0].map(|time| (time, DQuat::from_rotation_x(time)));
    let spinning = |rate: f64| Orientation::spin(0.0, DQuat::IDENTITY, rate * DVec3::Z).unwrap();
    let kinds = [
        spinning(1.0),
        spinning(0.0),
        Orientation::slerp(&knots).unwrap(),
        Orientation::normalized_cubic(&knots).unwrap(),
    ];
    let mut scene = Scene::new();
    let mut expected = Vec::new();
    let told = spinning(3.0);
    for kind in kinds {
        for tolerance in [None, Some(1e-8), Some(1e-2)] {
            let with = |orientation: Orientation| match tolerance {
                Some(tolerance) => orientation.with_tolerance(tolerance).unwrap(),
                None => orientation,
            };
            let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
            let body = Body::new(rest).with_orientation(with(kind.clone()));
            let spliced = body.orientation.spliced(0.0, &told).unwrap();
            let id = scene.insert(body).unwrap();
            expected.push((id, [with(told.clone()), spliced]));
        }
    }
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let fixed = scene.insert(Body::new(rest)).unwrap();
    let spliced = Orientation::FIXED.spliced(0.0, &told).unwrap();
    expected.push((fixed, [told, spliced]));
    let mut monitor = Monitor::new(scene.clone(), 0.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
    let state = State::new(0.0, DVec3::ZERO, DVec3::Y);
    let state = BodyState::from(state).with_spin(DQuat::IDENTITY, 3.0 * DVec3::Z);
    // What is told again is what the body does.
    for _ in 0..2 {
        let states = expected.iter().map(|(id, _)| (*id, state));
        scene.update(states.clone()).unwrap();
        monitor.track(0.0, states).unwrap();
        for (id, orientations) in &expected {
            for (scene, orientation) in [&scene, monitor.scene()].into_iter().zip(orientations) {
                assert_eq!(scene.body(*id).unwrap().orientation, *orientation);
            }
        }
    }
}

/// A half-space does not turn, and neither does any other body that is named before it.
#[test]
fn an_update_with_a_spin_that_is_refused_changes_nothing() {
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let mut scene = Scene::new();
    let ball = scene.insert(Body::new(rest.clone())).unwrap();
    let floor = Hitbox::half_space(DVec3::Z).unwrap();
    let floor = Body::new(rest).with_hitbox(floor).with_tag(7);
    let floor = scene.insert(floor).unwrap();
    let before = scene.clone();
    let state = BodyState::from(State::new(0.0, DVec3::X, DVec3::Y));
    let turning = state.with_spin(DQuat::IDENTITY, DVec3::Z);
    let too_fast = state.with_spin(DQuat::IDENTITY, 1e9 * DVec3::Z);
    let speed = Error::AngularSpeed { speed: 1e9 };
    for (id, state, error) in [
        (floor, turning, Error::TurningHalfSpace.in_body(7)),
        (ball, too_fast, speed.in_body(0)),
    ] {
        let refused = scene.update([(ball, turning), (id, state), (ball, turning)]);
        assert_eq!(refused, Err(error.with_id(id)));
        assert!(scene.bodies().eq(before.bodies()));
    }
    // Its last state has no spin.
    scene.update([(ball, turning), (floor, state)]).unwrap();
    assert!(scene.body(floor).unwrap().orientation.is_fixed());
    assert!(!scene.body(ball).unwrap().orientation.is_fixed());
}

/// A monitor that is told the state leaves the body as it is; a scene, and a new plan, do not.
#[test]
fn a_body_told_to_rest_where_it_rests() {
    let mut scene = Scene::new();
    let rest = Trajectory::at_rest(DVec3::X).unwrap();
    let id = scene.insert(Body::new(rest)).unwrap();
    let monitor = || Monitor::new(scene.clone(), 0.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
    let [mut tracked, mut replanned] = [monitor(), monitor()];
    let state = State::new(4.0, DVec3::X, DVec3::ZERO);
    scene.update([(id, state)]).unwrap();
    tracked.track(4.0, [(id, state)]).unwrap();
    let plan = Trajectory::coasting(state).unwrap();
    replanned.replan(id, 4.0, plan).unwrap();
    let last_knot = |scene: &Scene| scene.body(id).unwrap().trajectory.knots().last().copied();
    assert_eq!(scene.body(id).unwrap().trajectory.knots(), [4.0]);
    assert_eq!(last_knot(tracked.scene()), Some(0.0));
    assert_eq!(last_knot(replanned.scene()), Some(4.0));
    for (monitor, changed) in [(&mut tracked, 0), (&mut replanned, 1)] {
        monitor.advance(4.0, &mut Vec::new()).unwrap();
        assert_eq!(monitor.stats().changed, changed);
    }
}

/// So many bodies, and some that are gone, that threads share them.
#[test]
fn threads_share_the_bodies_that_are_told() {
    const COUNT: u64 = 12_000;
    let mut rng = rng(461);
    let (mut scene, mut ids) = any_scene(&mut rng, COUNT);
    for _ in 0..COUNT / 50 {
        let id = ids.swap_remove(rng.random_range(0..ids.len()));
        scene.remove(id).unwrap();
    }
    let mut shared = scene.clone();
    for share in [0.9, 0.5, 1.0] {
        let mut states = Vec::new();
        for &id in &ids {
            if rng.random_bool(share) {
                states.push((id, any_state(&mut rng, 1.0)));
            }
        }
        // The last ones of some count.
        for _ in 0..COUNT / 2 {
            let (id, _) = states[rng.random_range(0..states.len())];
            states.push((id, any_state(&mut rng, 1.0)));
        }
        on_threads(1, || scene.update(states.iter().copied()).unwrap());
        on_threads(2, || shared.update(states.iter().copied()).unwrap());
        assert_eq!(scene.bodies().count(), ids.len());
        for ((id, body), (other_id, other)) in scene.bodies().zip(shared.bodies()) {
            assert_eq!((id, &body.trajectory), (other_id, &other.trajectory));
        }
        assert_eq!(scene.clone().planned(), shared.clone().planned());
    }
}
