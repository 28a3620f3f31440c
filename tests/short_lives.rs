//! Bodies that exist for a short time each, of which a few are there long before or after all others.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

mod support;

use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, EventKind, Monitor, Outside, Query, Scene, State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use support::rng;

/// Two bodies that meet at an instant, far from all other pairs, and exist for a second around it.
fn pair(rng: &mut ChaCha8Rng, number: u32, time: f64) -> [Body; 2] {
    let place = 50.0 * f64::from(number) * DVec3::X;
    let life = [0.3, 0.5].map(|half| rng.random_range(0.1..half));
    [1.0, -1.0].map(|side| {
        let state = |at: f64| {
            let aside = side * DVec3::new(0.0, time - at, 0.0);
            State::new(at, place + aside, side * DVec3::NEG_Y)
        };
        let states = [state(time - life[0]), state(time + life[1])];
        Body::new(Trajectory::from_states(&states).unwrap())
    })
}

/// When so many pairs meet: most crowd into some of the time, a few before and after that.
fn times(rng: &mut ChaCha8Rng, count: u32, duration: f64) -> Vec<f64> {
    let begin = rng.random_range(0.2..0.7) * duration;
    let crowded = rng.random_range(0.001..0.2) * duration;
    let time = |number: u32, rng: &mut ChaCha8Rng| match number % 97 {
        13 => rng.random_range(1.0..begin),
        58 => rng.random_range(begin..duration),
        _ => begin + rng.random_range(0.0..crowded),
    };
    (0..count).map(|number| time(number, rng)).collect()
}

#[test]
fn each_pair_is_found_by_a_screening() {
    let mut rng = rng(91);
    for round in 0..60 {
        let count = [40, 300, 1_500][round % 3];
        let duration = [20.0, 1e3, 1e5][round / 3 % 3];
        let mut scene = Scene::new();
        let times = times(&mut rng, count, duration);
        for (number, &time) in (0..).zip(&times) {
            for body in pair(&mut rng, number, time) {
                scene.insert(body).unwrap();
            }
        }
        let query = Query::default().with_margin(0.01);
        let wider = Window::new(-3.0 * duration, 2.0 * duration).unwrap();
        for query in [query, query.with_window(wider)] {
            let found = scene.screen(&query).unwrap().conflicts;
            let mut sorted = times.clone();
            sorted.sort_unstable_by(f64::total_cmp);
            assert_eq!(found.len(), sorted.len(), "{round}");
            for (conflict, time) in found.iter().zip(sorted) {
                assert!(
                    (conflict.closest.time - time).abs() < 1e-6,
                    "{round} {time}"
                );
            }
        }
    }
}

#[test]
fn each_pair_is_reported_by_a_monitor() {
    let mut rng = rng(92);
    for round in 0..12 {
        let (count, duration) = ([40, 300][round % 2], [20.0, 1e3, 1e5][round % 3]);
        let mut scene = Scene::new();
        for (number, time) in (0..).zip(times(&mut rng, count, duration)) {
            for mut body in pair(&mut rng, number, time) {
                body.trajectory = body.trajectory.with_outside(Outside::Absent);
                scene.insert(body).unwrap();
            }
        }
        let lookahead = [0.5, 0.05 * duration, 2.0 * duration][round / 2 % 3];
        let levels = [AlertLevel::at(0.01)];
        let mut monitor = Monitor::new(scene, 0.0, lookahead, &levels).unwrap();
        let (mut events, mut begun) = (Vec::new(), 0);
        // In a few long steps, or all at once.
        let steps = [1, 9, 40][round / 3 % 3];
        for step in 1..=steps {
            let now = 2.0 * duration * f64::from(step) / f64::from(steps);
            monitor.advance(now, &mut events).unwrap();
            let is_begin = |kind: &EventKind| matches!(kind, EventKind::Began(_));
            begun += events.iter().filter(|event| is_begin(&event.kind)).count();
            events.clear();
        }
        assert_eq!(begun, count as usize, "{round}");
    }
}
