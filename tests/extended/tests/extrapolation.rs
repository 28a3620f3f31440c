//! What goes on along its last cubic, far beyond its knots.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

#[path = "../../support/mod.rs"]
mod support;

use nearmiss::glam::DVec3;
use nearmiss::{
    Accuracy, AlertLevel, Body, Conflict, Event, Monitor, Outside, Query, Scene, State, TimeBase,
    Trajectory, Window,
};
use rand::RngExt;
use support::rng;

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
    let query = Query::new(window).with_margin(margin);
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

/// A new plan long after the end of the one before, and after its own.
#[test]
fn spliced_plans_go_on_as_they_did() {
    let far = 5_000.0;
    for (name, _) in FLIGHTS {
        let bodies = plans(name).map(|plan| {
            let plan = plan.with_outside(Outside::Extrapolate);
            let spliced = plan.spliced(far, &plan).unwrap();
            assert_eq!(spliced.outside_after(), Outside::Extrapolate);
            for time in [-1e4, 0.4 * far, far, 2e4] {
                assert_eq!(spliced.position(time), plan.position(time), "{name} {time}");
            }
            Body::new(spliced)
        });
        for accuracy in [Accuracy::Exact, Accuracy::Certified] {
            let found = screen(&bodies, (-2e4, 2e4), MARGIN, accuracy);
            assert_eq!(found, [], "{name} {accuracy:?}");
        }
        #[cfg(feature = "serde")]
        for body in &bodies {
            let text = serde_json::to_string(&body.trajectory).unwrap();
            let back: Trajectory = serde_json::from_str(&text).unwrap();
            assert_eq!(back, body.trajectory);
        }
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

/// Also where a distance is known to a percent.
#[test]
fn screening_and_closest_approach_agree_at_the_end_of_time() {
    let window = Window::new(0.0, 1e15).unwrap();
    let mut rng = rng(15);
    for round in 0..500 {
        let mut vector =
            |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
        let velocities = [vector(10.0), vector(10.0)];
        let (place, apart) = (vector(100.0), vector(50.0));
        let time = 10_f64.powf(rng.random_range(12.0..15.0));
        let places = [
            place,
            place + (velocities[0] - velocities[1]) * time + apart,
        ];
        let mut scene = Scene::new();
        let ids = [0, 1].map(|k| {
            let plan = Trajectory::coasting(State::new(0.0, places[k], velocities[k])).unwrap();
            scene.insert(Body::new(plan)).unwrap()
        });
        let nearest = scene
            .closest_approach(ids[0], ids[1], window)
            .unwrap()
            .unwrap();
        for share in [0.97, 0.99, 0.999, 1.0, 1.5] {
            let query = Query::new(window).with_margin(share * nearest.separation);
            let found = scene.screen(&query).unwrap().conflicts;
            let least = found.iter().map(|conflict| conflict.closest.separation);
            let Some(least) = least.reduce(f64::min) else {
                assert!(share < 1.0, "{round} {share} {nearest:?}");
                continue;
            };
            let off = (least - nearest.separation).abs();
            assert!(off <= 0.0, "{round} {share} {least} {nearest:?}");
        }
    }
}
