//! Arbitrary bits through the public API: an error or a sound answer, never a panic, never a NaN.
//!
//! The seed is fixed, so that a failure comes again; `PROPTEST_CASES=100000 cargo test --release
//! --test fuzz` asks for more.

#![allow(clippy::unwrap_used, reason = "a panic is what is looked for")]

use glam::DVec3;
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{
    Accuracy, AlertLevel, Body, Budget, ClosestApproach, Command, Conflict, Event, Hitbox, Monitor,
    Outside, Query, Scene, Sphere, State, TimeBase, TimeEnclosure, Trajectory, Window,
};
use proptest::collection::vec;
use proptest::prelude::{BoxedStrategy, Just, Strategy, any, prop_oneof};
use proptest::test_runner::{Config, RngSeed, TestRunner};
use std::cell::Cell;

/// Any bits, and numbers that are likely to do harm together.
fn number() -> BoxedStrategy<f64> {
    prop_oneof![
        3 => -10.0..10.0_f64,
        2 => any::<u64>().prop_map(f64::from_bits),
        1 => (-320..310_i32, -9.9..9.9_f64).prop_map(|(power, digits)| digits * 10_f64.powi(power)),
        1 => proptest::sample::select(vec![
            0.0,
            -0.0,
            1.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            1e300,
            -1e300,
            1e-300,
            f64::EPSILON,
        ]),
    ]
    .boxed()
}

fn vector() -> impl Strategy<Value = DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array)
}

/// States in the order of time more often than not.
fn states() -> impl Strategy<Value = Vec<State>> {
    let state = (number(), vector(), vector());
    let state = state.prop_map(|(time, position, velocity)| State::new(time, position, velocity));
    (vec(state, 0..5), any::<bool>()).prop_map(|(mut states, sorts)| {
        if sorts {
            states.sort_by(|x, y| x.time.total_cmp(&y.time));
        }
        states
    })
}

fn outside() -> impl Strategy<Value = Outside> {
    proptest::sample::select(vec![Outside::Absent, Outside::Extrapolate, Outside::Coast])
}

fn trajectory() -> impl Strategy<Value = Option<Trajectory>> {
    let coefficients = vec([vector(), vector(), vector(), vector()], 0..3);
    let base = proptest::sample::select(vec![TimeBase::Absolute, TimeBase::SegmentLocal]);
    let made = prop_oneof![
        4 => states().prop_map(|states| Trajectory::from_states(&states).ok()),
        1 => vec((number(), vector()), 0..5)
            .prop_map(|positions| Trajectory::from_positions(&positions).ok()),
        1 => (vec(number(), 0..4), coefficients, base).prop_map(|(knots, coefficients, base)| {
            Trajectory::from_coefficients(&knots, &coefficients, base).ok()
        }),
        1 => vector().prop_map(|position| Trajectory::at_rest(position).ok()),
        1 => (number(), vector(), vector()).prop_map(|(time, position, velocity)| {
            Trajectory::coasting(State::new(time, position, velocity)).ok()
        }),
    ];
    (made, outside()).prop_map(|(made, outside)| Some(made?.with_outside(outside)))
}

fn hitbox() -> impl Strategy<Value = Hitbox> {
    let sphere = (vector(), number()).prop_map(|(offset, radius)| Sphere { offset, radius });
    vec(sphere, 0..3).prop_map(|spheres| match spheres[..] {
        [one] => Hitbox::sphere(one.radius).unwrap_or_default(),
        _ => Hitbox::cluster(spheres).unwrap_or_default(),
    })
}

/// A plan of ordinary numbers, which meets others of its kind.
fn ordinary() -> impl Strategy<Value = Option<Trajectory>> {
    let vector = || [-10.0..10.0_f64, -10.0..10.0, -10.0..10.0].prop_map(DVec3::from_array);
    vec((vector(), vector()), 2..4).prop_map(|states| {
        let state = |(time, (position, velocity))| State::new(time, position, velocity);
        let states: Vec<State> = (0..10).map(f64::from).zip(states).map(state).collect();
        Trajectory::from_states(&states).ok()
    })
}

fn body() -> impl Strategy<Value = Option<Body>> {
    let trajectory = prop_oneof![trajectory(), ordinary()];
    (trajectory, hitbox())
        .prop_map(|(trajectory, hitbox)| Some(Body::new(trajectory?).with_hitbox(hitbox)))
}

fn window() -> impl Strategy<Value = Window> {
    prop_oneof![
        1 => Just(Window::ALL),
        2 => (number(), number()).prop_map(|(x, y)| Window::new(x, y).unwrap_or(Window::ALL)),
        2 => (-10.0..10.0_f64, 0.0..10.0_f64)
            .prop_map(|(start, length)| Window::new(start, start + length).unwrap()),
        // Instants, that of a body at rest among them.
        1 => proptest::sample::select(vec![-1.0, 0.0, 1.0])
            .prop_map(|time| Window::new(time, time).unwrap()),
    ]
}

/// Runs a test on some cases. It returns true where there was something to check: in a share of them at least.
fn run<T: std::fmt::Debug>(
    cases: u32,
    least: f64,
    strategy: impl Strategy<Value = T>,
    test: impl Fn(T) -> bool,
) {
    let cases = std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(cases);
    let config = Config {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(20),
        ..Config::default()
    };
    let checked = Cell::new(0_u32);
    TestRunner::new(config)
        .run(&strategy, |value| {
            checked.set(checked.get() + u32::from(test(value)));
            Ok(())
        })
        .unwrap();
    let checked = checked.get();
    assert!(
        f64::from(checked) >= (least * f64::from(cases)).floor(),
        "{checked} of {cases}"
    );
}

fn assert_sound_approach(closest: &ClosestApproach) {
    assert!(
        closest.time.is_finite() && closest.separation.is_finite(),
        "{closest:?}"
    );
    let vectors = [
        closest.position_a,
        closest.position_b,
        closest.relative_velocity,
    ];
    assert!(
        vectors.iter().all(|vector| vector.is_finite()),
        "{closest:?}"
    );
}

fn assert_sound(conflict: &Conflict) {
    assert!(conflict.enter <= conflict.exit, "{conflict:?}");
    assert!(
        conflict.enter.is_finite() && conflict.exit.is_finite(),
        "{conflict:?}"
    );
    assert_sound_approach(&conflict.closest);
    let time = conflict.closest.time;
    assert!(
        conflict.enter <= time && time <= conflict.exit,
        "{conflict:?}"
    );
    if let Some(proof) = conflict.certificate {
        let holds =
            |times: TimeEnclosure, time: f64| times.earliest <= time && time <= times.latest;
        assert!(
            proof.error >= 0.0 && proof.error.is_finite(),
            "{conflict:?}"
        );
        assert!(holds(proof.enter, conflict.enter), "{conflict:?}");
        assert!(holds(proof.exit, conflict.exit), "{conflict:?}");
        assert!(holds(proof.closest, time), "{conflict:?}");
    }
}

fn scene_of(bodies: Vec<Option<Body>>) -> Scene {
    let mut scene = Scene::new();
    for body in bodies.into_iter().flatten() {
        scene.insert(body).unwrap();
    }
    scene
}

#[test]
fn trajectories() {
    run(
        4_000,
        0.2,
        (trajectory(), number(), trajectory()),
        |(made, time, other)| {
            let Some(made) = made else { return false };
            for value in [
                made.position(time),
                made.velocity(time),
                made.acceleration(time),
            ] {
                assert!(value.is_none_or(|value| !value.is_nan()), "{made:?} {time}");
            }
            if let Some(other) = other {
                let spliced = made.spliced(time, &other);
                assert!(spliced.is_err() || spliced.is_ok_and(|plan| plan.knots().is_sorted()));
            }
            true
        },
    );
}

#[test]
fn screenings() {
    let question = (vec(body(), 0..5), window(), number());
    run(2_000, 0.04, question, |(bodies, window, margin)| {
        let scene = scene_of(bodies);
        let mut conflicts = 0;
        let query = Query::new(window).with_margin(margin);
        for accuracy in [Accuracy::Exact, Accuracy::Certified] {
            let answers = Method::EVERY
                .map(|method| scene.screen(&query.with_accuracy(accuracy).with_method(method)));
            let [first, rest @ ..] = answers;
            for other in rest {
                let same = match (&first, &other) {
                    (Ok(x), Ok(y)) => x.conflicts == y.conflicts,
                    (Err(x), Err(y)) => x.to_string() == y.to_string(),
                    _ => false,
                };
                assert!(same, "{accuracy:?}: {first:?} {other:?}");
            }
            if let Ok(screening) = first {
                screening.conflicts.iter().for_each(assert_sound);
                conflicts += screening.conflicts.len();
            }
        }
        let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
        if let [a, b, ..] = ids[..] {
            if let Ok(Some(closest)) = scene.closest_approach(a, b, window) {
                assert_sound_approach(&closest);
            }
            if let Ok(Some(closest)) = scene.certified_closest_approach(a, b, window) {
                assert_sound_approach(&closest.approach);
                assert!(closest.error >= 0.0 && closest.error.is_finite());
            }
        }
        conflicts > 0
    });
}

#[test]
fn monitors() {
    let level = prop_oneof![
        1 => (number(), number()),
        4 => (0.0..10.0_f64, 0.0..1.0_f64).prop_map(|(margin, more)| (margin, margin + more)),
    ];
    let levels = vec(level, 0..3);
    let instant = || prop_oneof![number(), 0.0..1.0_f64];
    let lookahead = prop_oneof![number(), 0.0..10.0_f64];
    let plan = prop_oneof![trajectory(), ordinary()];
    let steps = vec((instant(), plan, any::<u8>()), 0..6);
    let life = (vec(body(), 0..5), instant(), lookahead, levels, steps);
    run(
        1_500,
        0.1,
        life,
        |(bodies, now, lookahead, levels, steps)| {
            let levels: Vec<AlertLevel> = levels
                .into_iter()
                .map(|(margin, release)| AlertLevel { margin, release })
                .collect();
            let Ok(mut monitor) = Monitor::new(scene_of(bodies), now, lookahead, &levels) else {
                return false;
            };
            let mut events: Vec<Event> = Vec::new();
            for (time, plan, choice) in steps {
                let ids: Vec<_> = monitor.scene().bodies().map(|(id, _)| id).collect();
                if let (Some(plan), Some(&id)) = (plan, ids.get(usize::from(choice) % 5)) {
                    let command = match choice % 4 {
                        0 => Command::Replan(id, time, plan),
                        1 => Command::Extend(id, plan),
                        2 => Command::SetTrajectory(id, plan),
                        _ => Command::Remove(id),
                    };
                    // Refusals are answers.
                    let _ = monitor.apply([command]);
                }
                // A jump is looked at slice by slice: over 1e300 s that would never end.
                let step = if time.is_finite() {
                    time.abs().min(100.0 * lookahead)
                } else {
                    time
                };
                let budget = Budget::Work(u64::from(choice) * 20);
                let _ = monitor.advance_within(monitor.now() + step, budget, &mut events);
                for level in 0..levels.len() {
                    monitor
                        .conflicts(level)
                        .unwrap()
                        .iter()
                        .for_each(assert_sound);
                }
            }
            assert!(events.iter().all(|event| event.time.is_finite()));
            monitor.close(&mut events);
            !events.is_empty()
        },
    );
}
