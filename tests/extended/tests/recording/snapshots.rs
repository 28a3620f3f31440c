//! Monitors that go back to what they were: they go on as if nothing had been in between.

use super::{change, live_on, monitor, text};
use crate::support::rng;
use glam::DVec3;
use nearmiss::{AlertLevel, Body, Error, Event, Monitor, Scene, Snapshot, State, Trajectory};
use rand::RngExt;
use serde_json::Value;

/// From a snapshot, the same changes and ticks lead to the same events, conflicts and encounters; also where it was
/// taken between changes and a tick, with bodies that were just taken out, behind the clock, and twice.
#[test]
fn a_restored_monitor_says_the_same() {
    let (mut said, mut gone) = (0, 0);
    for seed in 0..40 {
        let mut life = rng(seed);
        let lookahead = if seed % 3 == 0 { 0.05 } else { 5.0 };
        let mut monitor = monitor(&mut life, 12, lookahead);
        for _ in 0..20 {
            live_on(&mut monitor, &mut life, &mut Vec::new());
        }
        if seed % 2 == 0 {
            change(&mut monitor, &mut life);
        }
        if seed % 4 == 0 {
            let under_way = monitor.encounters().next().map(|encounter| encounter.a);
            gone += usize::from(under_way.is_some_and(|id| monitor.remove(id).is_ok()));
        }
        let snapshot = monitor.snapshot();
        let (events, end) = lives(monitor, seed + 100);
        // What it did since is of no matter.
        let again = Monitor::restore(snapshot.clone()).unwrap().snapshot();
        for snapshot in [snapshot, again] {
            let restored = Monitor::restore(snapshot).unwrap();
            let (found, other) = lives(restored, seed + 100);
            assert_eq!(text(&events), text(&found), "seed {seed}");
            assert_eq!(end, other, "seed {seed}");
        }
        said += events.len();
    }
    assert!(said > 1_000 && gone > 0, "{said} {gone}");
}

/// Ticks until all is known, and in the end all that can be asked.
fn lives(mut monitor: Monitor, seed: u64) -> (Vec<Event>, String) {
    let mut life = rng(seed);
    let mut events = Vec::new();
    for _ in 0..30 {
        let now = monitor.now() + [0.0, 0.05, 0.05, 0.3, 2.0][life.random_range(0..5)];
        monitor.advance(now, &mut events).unwrap();
        change(&mut monitor, &mut life);
    }
    let conflicts = [monitor.conflicts(0).unwrap(), monitor.conflicts(1).unwrap()];
    let encounters: Vec<_> = monitor.encounters().collect();
    let settings = (
        monitor.history(),
        monitor.max_spans(),
        monitor.revision_threshold(),
    );
    let end = format!("{conflicts:?} {encounters:?} {settings:?}");
    monitor.close(&mut events);
    (events, end)
}

/// A snapshot can lie in a file; one that contradicts itself is refused.
#[test]
fn snapshots_in_files() {
    let mut life = rng(5);
    let mut monitor = monitor(&mut life, 12, 5.0);
    for _ in 0..20 {
        live_on(&mut monitor, &mut life, &mut Vec::new());
    }
    let file = serde_json::to_string(&monitor.snapshot()).unwrap();
    let (events, end) = lives(monitor, 105);
    let snapshot: Snapshot = serde_json::from_str(&file).unwrap();
    let (found, other) = lives(Monitor::restore(snapshot).unwrap(), 105);
    assert_eq!((text(&events), end), (text(&found), other));

    let mut numbers: Value = serde_json::from_str(&file).unwrap();
    numbers["next_id"] = 0.into();
    let snapshot: Snapshot = serde_json::from_value(numbers).unwrap();
    let refused = Monitor::restore(snapshot).unwrap_err();
    assert!(matches!(refused, Error::Snapshot { .. }), "{refused}");
}

/// Returns a snapshot from a binary file, in which a number can be no number.
fn with_nan(written: &Value, place: &str) -> Snapshot {
    const MARK: f64 = 0.123_456_789;
    let mut marked = written.clone();
    *marked.pointer_mut(place).unwrap() = MARK.into();
    let snapshot: Snapshot = serde_json::from_value(marked).unwrap();
    let mut file = postcard::to_allocvec(&snapshot).unwrap();
    let mark = MARK.to_le_bytes();
    let starts: Vec<usize> = (0..file.len())
        .filter(|&start| file[start..].starts_with(&mark))
        .collect();
    assert_eq!(starts.len(), 1, "{place}");
    file[starts[0]..][..mark.len()].copy_from_slice(&f64::NAN.to_le_bytes());
    postcard::from_bytes(&file).unwrap()
}

/// A snapshot with one number that no monitor can have is refused: one encounter has begun, one lies ahead, one waits
/// to be reported as over.
#[test]
fn encounters_that_cannot_be_are_refused() {
    let mut scene = Scene::new();
    let rest = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
    scene.insert(rest).unwrap();
    let ids = [-1.0, -6.0, 1.5].map(|x| {
        let state = State::new(0.0, x * DVec3::X, DVec3::X);
        let body = Body::new(Trajectory::coasting(state).unwrap());
        scene.insert(body).unwrap()
    });
    let mut monitor = Monitor::new(scene, 0.0, 9.0, &[AlertLevel::at(2.0)]).unwrap();
    monitor.advance(0.25, &mut Vec::new()).unwrap();
    monitor.remove(ids[2]).unwrap();
    let written = serde_json::to_value(monitor.snapshot()).unwrap();
    let restored = |written: &Value| {
        let snapshot: Snapshot = serde_json::from_value(written.clone()).unwrap();
        Monitor::restore(snapshot).map(drop)
    };
    restored(&written).unwrap();
    let is_refused = |restored: Result<(), Error>, what: &str| {
        assert!(matches!(restored, Err(Error::Snapshot { .. })), "{what}");
    };
    let closest = [
        "time",
        "separation",
        "position_a/1",
        "position_b/0",
        "relative_velocity/2",
        "model_error",
    ];
    let sent = ["enter", "exit", "closest_time", "separation", "model_error"];
    let over = "/pending_events/0/kind/Ended/0/";
    let mut places = vec!["/pending_events/0/time".to_owned()];
    for number in ["enter", "exit"] {
        places.push(format!("/encounters/0/1/encounter/{number}"));
        places.push(format!("{over}{number}"));
    }
    places.extend(closest.map(|number| format!("{over}closest/{number}")));
    places.extend(closest.map(|number| format!("/encounters/0/0/passed/approach/{number}")));
    places.push("/encounters/0/0/passed/plateau".to_owned());
    places.extend(closest.map(|number| format!("/encounters/0/1/encounter/closest/{number}")));
    places.extend(sent.map(|number| format!("/encounters/0/1/sent/{number}")));
    for place in &places {
        let restored = Monitor::restore(with_nan(&written, place));
        is_refused(restored.map(drop), place);
    }
    let begun = &written["encounters"][0][0];
    assert!(begun["begun"] == true && written["encounters"][0][1]["begun"] == false);
    for (place, value) in [
        ("/encounters/0/0/begun", false.into()),
        ("/encounters/0/1/begun", true.into()),
        ("/encounters/0/1/passed", begun["passed"].clone()),
        ("/pending_events/0/kind/Ended/0/level", 1.into()),
    ] {
        let mut broken = written.clone();
        *broken.pointer_mut(place).unwrap() = value;
        is_refused(restored(&broken), place);
    }
}

/// A clock that is too large for the lookahead is refused at once, as a tick would refuse it.
#[test]
fn a_clock_that_no_tick_can_have_is_refused() {
    let monitor = Monitor::new(Scene::new(), 3.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
    let written = serde_json::to_value(monitor.snapshot()).unwrap();
    for settled in [false, true] {
        let mut broken = written.clone();
        broken["now"] = 1e30.into();
        broken["has_reported_all"] = settled.into();
        let snapshot: Snapshot = serde_json::from_value(broken).unwrap();
        let refused = Monitor::restore(snapshot).unwrap_err();
        assert_eq!(refused, Error::Clock { time: 1e30 });
    }
}

/// The snapshot of a monitor of nothing is one of nothing.
#[test]
fn a_monitor_of_nothing_can_be_restored() {
    let monitor = Monitor::new(Scene::new(), 3.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
    let restored = Monitor::restore(monitor.snapshot()).unwrap();
    assert!(restored.scene().is_empty());
    assert_eq!((restored.now(), restored.lookahead()), (3.0, 5.0));
}
