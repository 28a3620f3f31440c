//! Which answers model errors change, and that all ways to ask give the same ones.

use crate::support::{bits, hash, on_threads, rng, screen, sliced, swarm};
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, BodyPlan, Command, Error, Event, EventKind, Hitbox,
    Monitor, Outside, Query, Scene, State, Trajectory, Window, pair,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

fn error(rng: &mut ChaCha8Rng) -> f64 {
    [0.0, rng.random_range(0.0..0.3), rng.random_range(0.0..2.0)][rng.random_range(0..3)]
}

/// A swarm with model errors, with those of every third body.
fn scene(seed: u64, count: usize) -> Scene {
    let mut rng = rng(seed);
    let mut scene = Scene::new();
    for (states, radius) in swarm(seed, count, 30.0) {
        let body = Body::new(Trajectory::from_states(&states).unwrap())
            .with_hitbox(Hitbox::sphere(radius).unwrap())
            .with_model_error(error(&mut rng))
            .unwrap();
        scene.insert(body).unwrap();
    }
    scene
}

const BOTH: [Accuracy; 2] = [Accuracy::Exact, Accuracy::Certified];

#[test]
fn the_bits_depend_on_neither_threads_nor_slices_nor_method() {
    let scene = scene(1, 60);
    for margin in [-0.4, 0.0, 1.0] {
        for accuracy in BOTH {
            let query = Query::new(Window::new(2.0, 15.0).unwrap());
            let query = query.with_margin(margin).with_accuracy(accuracy);
            let expected = scene.screen(&query).unwrap().conflicts;
            assert!(!expected.is_empty());
            for method in Method::EVERY {
                for (threads, slices) in [(1, 1), (3, 7), (2, 200)] {
                    let query = sliced(query, slices).with_method(method);
                    let found = on_threads(threads, || scene.screen(&query).unwrap().conflicts);
                    assert_eq!(
                        hash(&found),
                        hash(&expected),
                        "{margin} {accuracy:?} {method:?}"
                    );
                }
            }
        }
    }
}

/// Each pair by itself, through all its spans.
#[test]
fn a_screening_finds_what_all_pairs_have() {
    for (seed, margin) in [(2, 0.0), (3, -0.5), (4, 1.5)] {
        let scene = scene(seed, 40);
        let bodies: Vec<_> = scene.bodies().collect();
        for accuracy in BOTH {
            let query = Query::new(Window::ALL)
                .with_margin(margin)
                .with_accuracy(accuracy);
            let mut all = Vec::new();
            for (number, &(a, body_a)) in bodies.iter().enumerate() {
                for &(b, body_b) in &bodies[number + 1..] {
                    let found = pair::conflicts(body_a, body_b, &query).unwrap();
                    all.extend(found.into_iter().map(|mut conflict| {
                        (conflict.a, conflict.b) = (a, b);
                        conflict
                    }));
                }
            }
            all.sort_by(nearmiss::Conflict::order);
            let found = scene.screen(&query).unwrap().conflicts;
            assert_eq!(bits(&found), bits(&all), "{seed} {accuracy:?}");
        }
    }
}

/// A model error of one body changes no bit of what others do.
#[test]
fn others_are_as_without() {
    let mut scene = Scene::new();
    for (states, radius) in swarm(5, 60, 25.0) {
        let body = Body::new(Trajectory::from_states(&states).unwrap());
        scene
            .insert(body.with_hitbox(Hitbox::sphere(radius).unwrap()))
            .unwrap();
    }
    let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
    let window = Window::new(0.0, 20.0).unwrap();
    let before = screen(&scene, window, 0.7);
    scene.set_model_error(ids[7], 1.5).unwrap();
    let with = screen(&scene, window, 0.7);
    let concerns = |conflict: &nearmiss::Conflict| conflict.a == ids[7] || conflict.b == ids[7];
    let others = |all: &[nearmiss::Conflict]| -> Vec<_> {
        all.iter()
            .copied()
            .filter(|conflict| !concerns(conflict))
            .collect()
    };
    assert_eq!(bits(&others(&with)), bits(&others(&before)));
    assert!(
        with.iter().filter(|one| concerns(one)).count()
            > before.iter().filter(|one| concerns(one)).count()
    );
    assert!(
        with.iter()
            .filter(|one| concerns(one))
            .all(|one| one.closest.model_error == 1.5)
    );
    assert_eq!(scene.set_model_error(ids[7], 0.0).unwrap(), 1.5);
    assert_eq!(bits(&screen(&scene, window, 0.7)), bits(&before));
}

/// Straight lines that come as near as margin, radii and model errors allow, less a millionth of the errors, along an axis or in
/// any direction: boxes and lines around the bodies hold all of the model errors.
#[test]
fn a_graze_within_the_last_of_the_model_errors_is_found() {
    let mut rng = rng(11);
    for seed in 0..2_000 {
        let axes = glam::DMat3::IDENTITY;
        let axes = if seed % 2 == 0 {
            axes
        } else {
            let angles = crate::support::vector(&mut rng, 3.0);
            glam::DMat3::from_euler(glam::EulerRot::XYZ, angles.x, angles.y, angles.z)
        };
        let errors = [rng.random_range(0.5..2.0), rng.random_range(0.5..2.0)];
        let margin = rng.random_range(-0.5..0.5);
        let radius = 0.25;
        let away = margin + 2.0 * radius + (errors[0] + errors[1]) * (1.0 - 1e-6);
        let speed = rng.random_range(0.0..1.0) * f64::from(seed % 3);
        let place = crate::support::vector(&mut rng, 5.0);
        let mut scene = Scene::new();
        for (side, error) in [(0.0, errors[0]), (1.0, errors[1])] {
            let position = place + axes.x_axis * (side * away);
            let velocity = axes.y_axis * (speed * (1.0 - 2.0 * side));
            // Nearest to each other at 5 s.
            let motion = State::new(5.0, position, velocity);
            let body = Body::new(Trajectory::coasting(motion).unwrap())
                .with_hitbox(Hitbox::sphere(radius).unwrap());
            scene.insert(body.with_model_error(error).unwrap()).unwrap();
        }
        for accuracy in BOTH {
            let query = Query::new(Window::new(0.0, 10.0).unwrap());
            let query = query.with_margin(margin).with_accuracy(accuracy);
            let found = scene.screen(&query).unwrap().conflicts;
            assert_eq!(found.len(), 1, "{seed} {accuracy:?}");
        }
    }
}

/// Tick by tick, with model errors that change, and plans that are told.
#[test]
fn a_monitor_says_what_a_screening_says() {
    for seed in 0..6 {
        let mut rng = rng(seed);
        let mut scene = scene(seed, 40);
        let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
        for &id in &ids {
            let plan = scene.body(id).unwrap().trajectory.clone();
            let plan = plan.with_outside(Outside::Coast);
            scene.set_trajectory(id, plan).unwrap();
        }
        let levels = [AlertLevel::at(1.5), AlertLevel::at(-0.2)];
        let mut monitor = Monitor::new(scene, 0.0, 6.0, &levels).unwrap();
        let (mut events, mut seen) = (Vec::new(), 0);
        for _ in 0..25 {
            let now = monitor.now() + rng.random_range(0.0..1.0);
            for _ in 0..3 {
                let id = ids[rng.random_range(0..ids.len())];
                match rng.random_range(0..3) {
                    0 => monitor.set_model_error(id, error(&mut rng)).unwrap(),
                    1 => {
                        // Together with a plan that could turn the old one in place.
                        let state = state(&mut rng, now);
                        let plan = Trajectory::coasting(state).unwrap();
                        let both = [
                            Command::SetTrajectory(id, plan),
                            Command::SetModelError(id, error(&mut rng)),
                        ];
                        monitor.apply(both).unwrap();
                    }
                    _ => {
                        let before = monitor.scene().body(id).unwrap().model_error();
                        let told = [(id, state(&mut rng, now))];
                        monitor.track(now.max(monitor.now()), told).unwrap();
                        assert!(monitor.scene().body(id).unwrap().model_error() == before);
                    }
                }
            }
            monitor
                .advance(now.max(monitor.now()), &mut events)
                .unwrap();
            let window = Window::new(monitor.now(), monitor.complete_until()).unwrap();
            for (level, alert) in levels.iter().enumerate() {
                let found = monitor.conflicts(level).unwrap();
                let expected = screen(monitor.scene(), window, alert.margin);
                assert_eq!(bits(found), bits(&expected), "{seed} {level}");
                seen += found.len();
            }
        }
        assert!(seen > 200, "{seen}");
    }
}

/// The model errors of an encounter are those of the bodies as they are, also where they come no nearer again.
#[test]
fn an_encounter_has_the_model_error_of_its_bodies() {
    let mut scene = Scene::new();
    let rest = |x: f64| Trajectory::at_rest(glam::DVec3::X * x).unwrap();
    let a = scene.insert(Body::new(rest(0.0))).unwrap();
    let b = scene.insert(Body::new(rest(1.0))).unwrap();
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(5.0)]).unwrap();
    let mut events = Vec::new();
    for now in [0.0, 1.0] {
        monitor.advance(now, &mut events).unwrap();
    }
    for (now, error) in [(2.0, 0.5), (3.0, 0.25), (4.0, 0.0)] {
        monitor.set_model_error(a, error).unwrap();
        events.clear();
        monitor.advance(now, &mut events).unwrap();
        let [conflict] = monitor.conflicts(0).unwrap() else {
            panic!("one pair");
        };
        assert_eq!(conflict.closest.model_error, error);
        let encounter = *monitor.encounters().next().unwrap();
        assert_eq!(encounter.closest.model_error, error);
        // The approach that came first is still the closest one.
        assert_eq!(encounter.closest.time, 0.0);
        let is_revised = |event: &Event| event.kind == EventKind::Revised(encounter);
        assert!(events.len() == 1 && is_revised(&events[0]), "{events:?}");
        // Nothing is said twice; nor is what is less than the threshold.
        events.clear();
        monitor.advance(now + 0.5, &mut events).unwrap();
        monitor.set_model_error(a, error + 1e-10).unwrap();
        monitor.advance(now + 0.6, &mut events).unwrap();
        assert_eq!(events, []);
    }
    // What has passed is reported with it as well.
    monitor.set_model_error(a, 0.5).unwrap();
    monitor.advance(5.0, &mut events).unwrap();
    monitor.remove(b).unwrap();
    events.clear();
    monitor.advance(6.0, &mut events).unwrap();
    let EventKind::Ended(encounter, _) = events[0].kind else {
        panic!("{events:?}");
    };
    assert_eq!(encounter.closest.model_error, 0.5);
}

fn state(rng: &mut ChaCha8Rng, time: f64) -> State {
    State::new(
        time,
        crate::support::vector(rng, 15.0),
        crate::support::vector(rng, 4.0),
    )
}

#[test]
fn what_is_no_model_error_is_refused() {
    let rest = || Body::new(Trajectory::at_rest(glam::DVec3::ZERO).unwrap()).with_tag(9);
    let mut scene = Scene::new();
    let id = scene.insert(rest().with_model_error(0.5).unwrap()).unwrap();
    let mut monitor = Monitor::new(scene.clone(), 0.0, 9.0, &[AlertLevel::at(1.0)]).unwrap();
    for bad in [f64::NAN, -1e-300, f64::INFINITY, 1.1e300] {
        let text = format!("model error {bad:?} m is not a number from 0 to 1e300");
        // A body has no id before it is in a scene.
        let refused = [
            ("body 9", rest().with_model_error(bad).map(drop)),
            ("body 0v0 (tag 9)", scene.set_model_error(id, bad).map(drop)),
            ("body 0v0 (tag 9)", monitor.set_model_error(id, bad)),
        ];
        for (name, error) in refused {
            let error = error.unwrap_err();
            assert_eq!(error.to_string(), format!("{name}: {text}"));
            let Error::InBody { body: 9, error, .. } = error else {
                panic!("{error}");
            };
            assert!(
                matches!(*error, Error::ModelError { metres } if metres.to_bits() == bad.to_bits())
            );
        }
        for scene in [&scene, monitor.scene()] {
            assert!(scene.body(id).unwrap().model_error() == 0.5);
        }
    }
    // The largest is served: two such bodies may be anywhere.
    let other = rest().with_model_error(1e300).unwrap();
    let both = [rest().with_model_error(1e300).unwrap(), other];
    for accuracy in BOTH {
        let query = Query::new(Window::new(0.0, 1.0).unwrap()).with_accuracy(accuracy);
        let found = pair::conflicts(&both[0], &both[1], &query.with_margin(1e300)).unwrap();
        assert_eq!(found.len(), 1);
        assert!(found[0].certificate.is_none_or(|proof| !proof.resolved));
    }
    assert!(
        rest()
            .with_model_error(-0.0)
            .unwrap()
            .model_error()
            .to_bits()
            == 0
    );
}

/// A plan that comes with a model error is asked about, and followed, with that one.
#[test]
fn plans_bring_their_own_model_errors() {
    let mut changed = 0;
    for seed in 0..20 {
        let mut rng = rng(700 + seed);
        let scene = scene(seed, 30);
        let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
        let id = ids[rng.random_range(0..ids.len())];
        let (now, margin) = (5.0, 0.5);
        let level = AlertLevel::at(margin);
        let mut monitor = Monitor::new(scene.clone(), now, 6.0, &[level]).unwrap();
        monitor.advance(now, &mut Vec::new()).unwrap();
        let (states, _) = &swarm(900 + seed, 1, 30.0)[0];
        let plan: BodyPlan = Trajectory::from_states(states).unwrap().into();
        let metres = rng.random_range(0.0..3.0);
        let with_error = plan.clone().with_model_error(metres).unwrap();
        let query = Query::new(Window::new(now, now + 6.0).unwrap()).with_margin(margin);
        let asked = scene.what_if(id, &with_error, &query).unwrap();
        let mut adopted = scene.clone();
        adopted
            .set_trajectory(id, with_error.trajectory.clone())
            .unwrap();
        adopted.set_model_error(id, metres).unwrap();
        let screened = adopted.screen(&query).unwrap();
        let expected: Vec<_> = screened.conflicts_of(id).copied().collect();
        assert_eq!(bits(&asked), bits(&expected), "{seed}");
        changed += usize::from(scene.what_if(id, &plan, &query).unwrap().len() != asked.len());
        // A monitor: asked, and then told.
        let asked = monitor.what_if(id, &with_error, 0).unwrap();
        monitor.replan(id, now, with_error.clone()).unwrap();
        assert_eq!(monitor.scene().body(id).unwrap().model_error(), metres);
        monitor.advance(now, &mut Vec::new()).unwrap();
        let partners = |one: &nearmiss::Conflict| (one.a, one.b, one.closest.model_error.to_bits());
        let told: Vec<_> = monitor.conflicts_of(id, 0).unwrap().map(partners).collect();
        // Where the body was at this very instant counts for what is told alone.
        let mut asked = asked.iter().map(partners);
        assert!(asked.all(|one| told.contains(&one)), "{seed}");
        // Bad ones are refused by name, and leave all as it was.
        for metres in [-1.0, f64::NAN, f64::INFINITY] {
            let bad = BodyPlan {
                model_error: Some(metres),
                ..with_error.clone()
            };
            let refused = [
                scene.what_if(id, &bad, &query).map(drop),
                monitor.what_if(id, &bad, 0).map(drop),
                monitor.replan(id, now, bad.clone()).map(drop),
                monitor.extend(
                    id,
                    BodyPlan {
                        model_error: Some(metres),
                        ..Trajectory::at_rest(glam::DVec3::ZERO).unwrap().into()
                    },
                ),
            ];
            for refusal in refused {
                assert!(
                    matches!(&refusal, Err(Error::InBody { error, .. })
                        if matches!(**error, Error::ModelError { .. })),
                    "{refusal:?}"
                );
            }
        }
        assert!(plan.clone().with_model_error(-1.0).is_err());
    }
    assert!(changed > 5, "{changed}");
}
