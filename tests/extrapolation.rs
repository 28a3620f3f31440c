//! What goes on along its last cubic, far beyond its knots.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

use nearmiss::glam::DVec3;
use nearmiss::{
    Accuracy, AlertLevel, Body, Conflict, Event, Monitor, Outside, Query, Scene, State, TimeBase,
    Trajectory, Window,
};

const MARGIN: f64 = 1.0;

/// Two plans 10 m apart all along.
fn plans(name: &str) -> [Trajectory; 2] {
    let apart = [0.0, 10.0];
    match name {
        "side by side" => apart.map(|y| {
            let state = |k: f64| {
                let time = k / 60.0;
                let velocity = DVec3::X * 10.0;
                State::new(time, velocity * time + y * DVec3::Y, velocity)
            };
            Trajectory::from_states(&[state(0.0), state(1.0), state(2.0)]).unwrap()
        }),
        "satellites" => apart.map(|z| {
            let state = |time: f64| {
                let (radius, rate) = (7e6, 1.1e-3);
                let (sine, cosine) = (rate * time).sin_cos();
                let place = DVec3::new(radius * cosine, radius * sine, z);
                State::new(time, place, radius * rate * DVec3::new(-sine, cosine, 0.0))
            };
            Trajectory::from_states(&[state(0.0), state(60.0), state(120.0)]).unwrap()
        }),
        "constant" => apart.map(|y| {
            let place = DVec3::new(7e6, y, 0.0);
            let still = [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, place];
            let knots = [0.3, 0.3 + 1.0 / 60.0];
            Trajectory::from_coefficients(&knots, &[still], TimeBase::SegmentLocal).unwrap()
        }),
        _ => unreachable!(),
    }
}

/// Names, and until when they are looked at.
const FLIGHTS: [(&str, f64); 3] = [
    ("side by side", 1e6),
    ("satellites", 250_000.0),
    ("constant", 1e12),
];

fn bodies(name: &str, outside: Outside) -> [Body; 2] {
    plans(name).map(|plan| Body::new(plan.with_outside(outside)))
}

fn screen(
    bodies: &[Body; 2],
    window: (f64, f64),
    margin: f64,
    accuracy: Accuracy,
) -> Vec<Conflict> {
    let mut scene = Scene::new();
    for body in bodies {
        scene.insert(body.clone()).unwrap();
    }
    let window = Window::new(window.0, window.1).unwrap();
    let query = Query::new(window).with_margin(margin).unwrap();
    scene
        .screen(&query.with_accuracy(accuracy))
        .unwrap()
        .conflicts
}

/// Before as after.
#[test]
fn who_stays_apart_has_no_conflict() {
    for (name, until) in FLIGHTS {
        for outside in [Outside::Extrapolate, Outside::Coast] {
            let bodies = bodies(name, outside);
            for accuracy in [Accuracy::Exact, Accuracy::Certified] {
                for window in [(0.0, until), (-until, 0.0), (until, until)] {
                    let found = screen(&bodies, window, MARGIN, accuracy);
                    assert_eq!(found, [], "{name} {outside:?} {accuracy:?} {window:?}");
                }
            }
        }
    }
}

#[test]
fn a_monitor_reports_no_conflict_of_who_stays_apart() {
    for (name, until) in FLIGHTS {
        let mut scene = Scene::new();
        for body in bodies(name, Outside::Extrapolate) {
            scene.insert(body).unwrap();
        }
        let levels = [AlertLevel::at(MARGIN)];
        let mut monitor = Monitor::new(scene, 0.0, until / 8.0, &levels).unwrap();
        let mut events: Vec<Event> = Vec::new();
        for step in 0..8 {
            let now = until / 8.0 * f64::from(step);
            monitor.advance(now, &mut events).unwrap();
        }
        assert!(events.is_empty(), "{name} {events:?}");
    }
}

/// Within a millimetre of the margin or two the answer is there, and right.
#[test]
fn the_margin_is_told_to_a_millimetre() {
    for (name, until) in FLIGHTS {
        let bodies = bodies(name, Outside::Extrapolate);
        for (margin, count) in [(9.998, 0), (10.002, 1)] {
            for accuracy in [Accuracy::Exact, Accuracy::Certified] {
                let found = screen(&bodies, (0.0, until.min(40_000.0)), margin, accuracy);
                assert_eq!(found.len(), count, "{name} {margin} {accuracy:?}");
            }
        }
    }
}
