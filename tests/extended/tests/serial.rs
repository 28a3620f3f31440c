//! What is written and read back by itself: the same to the last bit, and nothing else.

#![cfg(feature = "recording")]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built or written fails the test"
)]

#[path = "../../support/mod.rs"]
mod support;

use glam::{DQuat, DVec3};
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, BodyPlan, BodyState, Budget, CertifiedApproach, Conflict,
    Hitbox, Monitor, Orientation, Outside, Query, RevisionThreshold, Scene, Screening, State,
    Trajectory, Window,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use support::{rng, wander};

/// Infinite settings, in text and in other formats.
#[test]
fn revision_thresholds_come_back() {
    for separation in [0.0, 0.25, f64::INFINITY] {
        let least = RevisionThreshold::default()
            .with_time(1e-9)
            .with_separation(separation);
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

/// Orientations of each kind, and bodies and plans that have them.
#[test]
fn orientations_come_back() {
    let turned = |angle: f64| DQuat::from_rotation_x(angle);
    let knots = [(0.0, turned(0.1)), (2.0, turned(1.4)), (2.5, -turned(-0.3))];
    let spin = Orientation::spin(1.0, turned(0.7), DVec3::new(0.1, 1e-7, 3.0)).unwrap();
    let kinds = [
        Orientation::FIXED,
        spin.clone(),
        spin.clone().with_tolerance(1e-5).unwrap(),
        Orientation::slerp(&knots).unwrap(),
        Orientation::normalized_cubic(&knots)
            .unwrap()
            .with_outside(Outside::Coast),
    ];
    let rest = Trajectory::at_rest(DVec3::X).unwrap();
    for kind in kinds {
        assert_eq!(back(&kind), kind);
        let body = Body::new(rest.clone()).with_orientation(kind.clone());
        let found = back(&body);
        assert_eq!(found, body);
        assert_eq!(found.spheres_at(1.7), body.spheres_at(1.7));
        let plan = BodyPlan::new(rest.clone(), kind);
        assert_eq!(back(&plan), plan);
    }
    let told = BodyState::from(State::new(0.0, DVec3::X, DVec3::Y));
    assert_eq!(back(&told), told);
    let told = told.with_spin(turned(0.2), DVec3::Z);
    assert_eq!(back(&told), told);
    // Of a body that turned first one way, then another.
    let levels = [AlertLevel::at(1.0)];
    let mut monitor = Monitor::new(Scene::new(), 0.0, 5.0, &levels).unwrap();
    let id = monitor
        .insert(Body::new(rest).with_orientation(spin))
        .unwrap();
    monitor
        .orient(id, 2.0, Orientation::slerp(&knots).unwrap())
        .unwrap();
    let body = monitor.scene().body(id).unwrap();
    assert_eq!(&back(body), body);

    // Without the field it does not turn; what cannot be is refused.
    let json = serde_json::to_value(body).unwrap();
    let mut plain = json.clone();
    plain.as_object_mut().unwrap().remove("orientation");
    let plain: Body = serde_json::from_value(plain).unwrap();
    assert!(plain.orientation.is_fixed());
    for (find, put) in [
        ("\"from\":2.0", "\"from\":null"),
        ("\"tolerance\":null", "\"tolerance\":0.5"),
        ("\"from\":null", "\"from\":1.0"),
        ("[0.0,[", "[7.0,["),
    ] {
        let text = json["orientation"].to_string();
        assert!(text.contains(find), "{text}");
        let bad = text.replacen(find, put, 1);
        assert!(serde_json::from_str::<Orientation>(&bad).is_err(), "{bad}");
    }
}

/// What is read of what was written, in text and in another format, which must be the same.
fn back<T: Serialize + DeserializeOwned>(value: &T) -> T {
    let text = serde_json::to_string(value).unwrap();
    let bytes = postcard::to_allocvec(value).unwrap();
    let read: T = serde_json::from_str(&text).unwrap();
    let other: T = postcard::from_bytes(&bytes).unwrap();
    assert_eq!(
        serde_json::to_string(&read).unwrap(),
        serde_json::to_string(&other).unwrap()
    );
    read
}

#[test]
fn questions_come_back() {
    let half_open = Window::new(-0.1, f64::INFINITY).unwrap();
    for window in [Window::ALL, half_open, Window::new(1.0, 1.0).unwrap()] {
        assert_eq!(back(&window), window);
        let query = Query::new(window)
            .with_margin(-0.3)
            .with_accuracy(Accuracy::Certified)
            .with_max_spans(77);
        assert_eq!(back(&query), query);
        // How the answer is found is no part of the question.
        assert_eq!(back(&query.with_method(Method::BruteForce)), query);
    }
    let silent = Query::default();
    assert_eq!(back(&silent), silent);
    assert_eq!(back(&silent).window(), None);
    let read = serde_json::from_str::<Query>;
    assert_eq!(read(r#"{"margin":2.0}"#).unwrap(), silent.with_margin(2.0));
    assert!(read(r#"{"margins":2.0}"#).is_err());
    assert!(read(r#"{"window":{"start":2.0,"end":1.0}}"#).is_err());
    assert!(serde_json::from_str::<Window>(r#"{"start":0.0,"end":1.0,"stop":1.0}"#).is_err());
    for budget in [Budget::Unlimited, Budget::Work(7)] {
        assert_eq!(back(&budget), budget);
    }
}

#[test]
fn answers_come_back() {
    let mut scene = Scene::new();
    let ids = [3, 5].map(|seed| {
        let states = wander(&mut rng(seed), 0.0, 12, 1.0, 4.0, 4.0);
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan)).unwrap()
    });
    let query = Query::default().with_margin(10.0);
    let screening = scene.screen(&query).unwrap();
    let read: Screening = back(&screening);
    assert!(!read.conflicts.is_empty() && read.stats.survivors > 0);
    assert_eq!(
        (read.conflicts, read.window),
        (screening.conflicts, screening.window)
    );
    assert_eq!(
        format!("{:?}", read.stats),
        format!("{:?}", screening.stats)
    );
    let nearest = scene.certified_closest_approach(ids[0], ids[1], Window::ALL);
    let nearest: CertifiedApproach = nearest.unwrap().unwrap();
    assert_eq!(back(&nearest), nearest);
}

#[cfg(feature = "live")]
#[test]
fn options_come_back() {
    let options = nearmiss::live::LiveOptions::default()
        .with_requests(3)
        .with_reports(4)
        .with_budget(std::time::Duration::from_micros(5));
    let fields = (
        options.requests,
        options.reports,
        options.budget.as_micros(),
    );
    assert_eq!(fields, (3, 4, 5));
    assert_eq!(back(&options), options);
}

/// An error that wraps one says which.
#[test]
fn a_refused_record_says_why() {
    use std::error::Error as _;
    let error = nearmiss::Error::NoPlan;
    let why = error.to_string();
    let refused = nearmiss::recording::RecordingError::Refused { offset: 20, error };
    assert_eq!(refused.source().map(ToString::to_string), Some(why));
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

/// The motions before and after the knots are in powers of time: as Bézier points, their bends would have no bound.
#[test]
fn end_motions_in_another_form_are_refused() {
    let states = [0.0, 1.0].map(|t| State::new(t, DVec3::X * t, DVec3::X));
    let plan = Trajectory::from_states(&states).unwrap();
    let plan = plan.with_outside(Outside::Extrapolate);
    let written = serde_json::to_value(&plan).unwrap();
    let read = |numbers: serde_json::Value| serde_json::from_value::<Trajectory>(numbers);
    assert_eq!(read(written.clone()).unwrap(), plan);
    for error in [1e-9, 1e300] {
        for place in 8..14 {
            let mut broken = written.clone();
            let after = &mut broken["ends"][1];
            assert!(after[15].as_f64().unwrap() <= 0.0);
            after[15] = error.into();
            after[place] = 1e300.into();
            let refused = read(broken).unwrap_err().to_string();
            assert!(refused.contains("contradict"), "{refused}");
        }
    }
}

/// The model error of a body stays with it; one that is none is refused, and older files have none.
#[test]
fn model_errors_in_files() {
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let body = Body::new(rest).with_model_error(0.1).unwrap();
    let file = serde_json::to_value(&body).unwrap();
    let back: Body = serde_json::from_value(file.clone()).unwrap();
    assert_eq!(back, body);
    let mut bad = file.clone();
    bad["model_error"] = (-1.0).into();
    let refused = serde_json::from_value::<Body>(bad).unwrap_err();
    assert!(
        refused.to_string().contains("model error -1.0 m"),
        "{refused}"
    );
    let mut old = file;
    old.as_object_mut().unwrap().remove("model_error");
    let old: Body = serde_json::from_value(old).unwrap();
    assert!(old.model_error() == 0.0);
}

/// A half-space is its normal, in people's formats and in binary ones; a bad one is refused.
#[test]
fn half_spaces_in_files() {
    let normal = DVec3::new(0.6, 0.0, 0.8);
    let hitbox = Hitbox::half_space(normal).unwrap();
    let text = serde_json::to_string(&hitbox).unwrap();
    assert_eq!(text, r#"{"half_space":[0.6,0.0,0.8]}"#);
    assert_eq!(serde_json::from_str::<Hitbox>(&text).unwrap(), hitbox);
    for hitbox in [hitbox, Hitbox::sphere(0.5).unwrap()] {
        let bytes = postcard::to_allocvec(&hitbox).unwrap();
        assert_eq!(postcard::from_bytes::<Hitbox>(&bytes).unwrap(), hitbox);
    }
    for bad in [r#"{"half_space":[0,0,2]}"#, r#"{"half_space":[0,0]}"#, "{}"] {
        assert!(serde_json::from_str::<Hitbox>(bad).is_err(), "{bad}");
    }
    // What is wrong is said, not that no form fits.
    for (bad, why) in [
        (r#"{"half_space":[0,"1",2]}"#, "expected f64"),
        (r#"{"halfspace":[0,0,1]}"#, "unknown field `halfspace`"),
        (r#"[{"offset":[0,0,0],"radius":true}]"#, "expected f64"),
        ("3", "expected a list of spheres"),
    ] {
        let error = serde_json::from_str::<Hitbox>(bad).unwrap_err().to_string();
        assert!(error.contains(why), "{bad}: {error}");
    }
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z).unwrap();
    let mut body = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
    body.orientation = spin;
    let mut scene = Scene::new();
    scene.insert(body).unwrap();
    let text = serde_json::to_string(&scene).unwrap();
    assert!(serde_json::from_str::<Scene>(&text).is_ok());
    let point = r#"[{"offset":[0.0,0.0,0.0],"radius":0.0}]"#;
    assert!(text.contains(point), "{text}");
    let turning = text.replace(point, r#"{"half_space":[0.0,0.0,1.0]}"#);
    assert!(serde_json::from_str::<Scene>(&turning).is_err());
}

/// A field that may be left out is not left out because it is misspelled.
#[test]
fn misspelled_fields_are_refused() {
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z).unwrap();
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let body = Body::new(rest.clone()).with_orientation(spin.clone());
    let body = serde_json::to_string(&body.with_model_error(3.0).unwrap()).unwrap();
    let plan = serde_json::to_string(&BodyPlan::new(rest, spin)).unwrap();
    let state = BodyState::from(State::new(0.0, DVec3::ZERO, DVec3::X));
    let state = state.with_spin(DQuat::IDENTITY, DVec3::Z);
    let state = serde_json::to_string(&state).unwrap();
    let misspelled = |text: &str, field: &str| {
        let new = text.replacen(&format!("\"{field}\":"), &format!("\"{field}s\":"), 1);
        assert_ne!(new, text);
        new
    };
    assert!(serde_json::from_str::<Body>(&body).is_ok());
    for field in ["model_error", "orientation"] {
        assert!(serde_json::from_str::<Body>(&misspelled(&body, field)).is_err());
    }
    assert!(serde_json::from_str::<BodyPlan>(&plan).is_ok());
    assert!(serde_json::from_str::<BodyPlan>(&misspelled(&plan, "orientation")).is_err());
    assert!(serde_json::from_str::<BodyState>(&state).is_ok());
    assert!(serde_json::from_str::<BodyState>(&misspelled(&state, "spin")).is_err());
}

/// As times in the calls, times in a file are 0 where they are -0.
#[test]
fn orientations_in_files_have_no_negative_zero() {
    let text = r#"{"parts":[{"from":null,"given":"Fixed"},
        {"from":-0.0,"given":{"Spin":{"time":0.0,"rotation":[0,0,1,0],"angular_velocity":[0,0,0]}}}],"tolerance":null}"#;
    let turned: Orientation = serde_json::from_str(text).unwrap();
    let text = serde_json::to_string(&turned).unwrap();
    assert!(!text.contains("-0.0"), "{text}");
}

/// Ids are numbers, so that maps by body can be written as text.
#[test]
fn ids_are_keys_of_maps() {
    let ids = [0, 7, 1 << 32 | 7, u64::MAX].map(BodyId::from_bits);
    let names: BTreeMap<BodyId, u64> = ids.into_iter().zip(1..).collect();
    let text = serde_json::to_string(&names).unwrap();
    assert_eq!(
        serde_json::from_str::<BTreeMap<BodyId, u64>>(&text).unwrap(),
        names
    );
    assert_eq!(serde_json::to_string(&ids[2]).unwrap(), "4294967303");
}
