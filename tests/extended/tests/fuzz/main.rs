//! Arbitrary bits through the public API: an error or a sound answer, never a panic, never a NaN.
//!
//! The seed is fixed, so that a failure comes again; `PROPTEST_CASES=100000 cargo test --release
//! --test fuzz` asks for more.

#![allow(clippy::unwrap_used, reason = "a panic is what is looked for")]

mod covers;
mod strategies;
mod turning;

use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{
    Accuracy, AlertLevel, Body, Budget, ClosestApproach, Command, Conflict, Event, Monitor, Query,
    Scene, TimeEnclosure,
};
use proptest::collection::vec;
use proptest::prelude::{Strategy, any, prop_oneof};
use proptest::test_runner::{Config, RngSeed, TestRunner};
use std::cell::Cell;
use strategies::{body, number, ordinary, trajectory, window};

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

/// Screens by every method, at both accuracies, which must agree. Returns what `Exact` and `Certified` find, or
/// the same refusals.
fn screened(scene: &Scene, query: &Query) -> Vec<Conflict> {
    let mut conflicts = Vec::new();
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
            conflicts.extend(screening.conflicts);
        }
    }
    conflicts
}

#[test]
fn screenings() {
    let question = (vec(body(), 0..5), window(), number());
    run(2_000, 0.04, question, |(bodies, window, margin)| {
        let scene = scene_of(bodies);
        let conflicts = screened(&scene, &Query::new(window).with_margin(margin));
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
        !conflicts.is_empty()
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
                .map(|(margin, release)| AlertLevel::at(margin).with_release(release))
                .collect();
            let Ok(mut monitor) = Monitor::new(scene_of(bodies), now, lookahead, &levels) else {
                return false;
            };
            let mut events: Vec<Event> = Vec::new();
            for (time, plan, choice) in steps {
                let ids: Vec<_> = monitor.scene().bodies().map(|(id, _)| id).collect();
                if let (Some(plan), Some(&id)) = (plan, ids.get(usize::from(choice) % 5)) {
                    let command = match choice % 4 {
                        0 => Command::Replan(id, time, plan.into()),
                        1 => Command::Extend(id, plan.into()),
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
