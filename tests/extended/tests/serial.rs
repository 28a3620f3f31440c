//! What is written and read back by itself: the same to the last bit, and nothing else.

#![cfg(feature = "serde")]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built or written fails the test"
)]

#[path = "../../support/mod.rs"]
mod support;

use glam::DVec3;
use nearmiss::{
    Accuracy, Body, Conflict, Hitbox, Monitor, Query, RevisionThreshold, Scene, State, Trajectory,
};
use support::{rng, wander};

/// Infinite settings, in text and in other formats.
#[test]
fn revision_thresholds_come_back() {
    for separation in [0.0, 0.25, f64::INFINITY] {
        let least = RevisionThreshold {
            time: 1e-9,
            separation,
        };
        let text = serde_json::to_string(&least).unwrap();
        assert_eq!(
            serde_json::from_str::<RevisionThreshold>(&text).unwrap(),
            least
        );
        let bytes = postcard::to_allocvec(&least).unwrap();
        assert_eq!(
            postcard::from_bytes::<RevisionThreshold>(&bytes).unwrap(),
            least
        );
    }
}

/// Plans whose straight motion goes on beyond the largest times.
#[test]
fn plans_at_the_end_of_time_come_back() {
    let state = |time: f64| State::new(time, DVec3::ZERO, DVec3::ZERO);
    for plan in [
        Trajectory::from_states(&[state(0.0), state(9e299)]).unwrap(),
        Trajectory::coasting(state(1e300)).unwrap(),
        Trajectory::coasting(state(-1e300)).unwrap(),
    ] {
        let json = serde_json::to_string(&plan).unwrap();
        assert_eq!(serde_json::from_str::<Trajectory>(&json).unwrap(), plan);
    }
}

#[test]
fn states_and_conflicts_come_back() {
    let states = wander(&mut rng(5), 0.0, 12, 1.0, 4.0, 4.0);
    let json = serde_json::to_string(&states).unwrap();
    assert_eq!(serde_json::from_str::<Vec<State>>(&json).unwrap(), states);
    let mut scene = Scene::new();
    for seed in 0..30 {
        let states = wander(&mut rng(seed), 0.0, 12, 1.0, 4.0, 4.0);
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let query = Query::default().with_margin(1.0);
    let query = query.with_accuracy(Accuracy::Certified);
    let conflicts = scene.screen(&query).unwrap().conflicts;
    assert!(!conflicts.is_empty());
    let json = serde_json::to_string(&conflicts).unwrap();
    assert_eq!(
        serde_json::from_str::<Vec<Conflict>>(&json).unwrap(),
        conflicts
    );
}

#[test]
fn monitors_are_shared_between_threads() {
    const fn shared<T: Send + Sync>() {}
    shared::<Monitor>();
}

/// What is no trajectory does not become one.
#[test]
fn bad_numbers_are_refused() {
    let states = [0.0, 1.0].map(|t| State::new(t, DVec3::X * t, DVec3::X));
    let plan = Trajectory::from_states(&states).unwrap();
    let json = serde_json::to_string(&plan).unwrap();
    assert_eq!(serde_json::from_str::<Trajectory>(&json).unwrap(), plan);
    for (from, to) in [
        ("[0.0,1.0]", "[1.0,0.0]"),
        ("[0.0,1.0]", "[0.0]"),
        ("[0.0,1.0]", "[0.0,1e301]"),
        // A piece that lies beyond the reach of its cubic.
        ("[0.0,1.0]", "[0.0,1e120]"),
        ("[0.0,1.0]", "[-1e150,1.0]"),
        ("\"outside\":[\"Absent\"", "\"outside\":[\"Gone\""),
        // The extent, which bounds all control points.
        ("1.3333333333333344", "0.5"),
    ] {
        assert!(json.contains(from), "{from} in {json}");
        let broken = json.replacen(from, to, 1);
        assert!(serde_json::from_str::<Trajectory>(&broken).is_err(), "{to}");
    }
    assert!(serde_json::from_str::<Hitbox>("[]").is_err());
}
