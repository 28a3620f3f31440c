//! Monitors that go back to what they were: they go on as if nothing had been in between.

use super::{change, live_on, monitor, text};
use crate::support::rng;
use nearmiss::{AlertLevel, Error, Event, Monitor, Scene, Snapshot};
use rand::RngExt;

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

    let mut numbers: serde_json::Value = serde_json::from_str(&file).unwrap();
    numbers["next_id"] = 0.into();
    let snapshot: Snapshot = serde_json::from_value(numbers).unwrap();
    let refused = Monitor::restore(snapshot).unwrap_err();
    assert!(matches!(refused, Error::Snapshot { .. }), "{refused}");
}

/// The snapshot of a monitor of nothing is one of nothing.
#[test]
fn a_monitor_of_nothing_can_be_restored() {
    let monitor = Monitor::new(Scene::new(), 3.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
    let restored = Monitor::restore(monitor.snapshot()).unwrap();
    assert!(restored.scene().is_empty());
    assert_eq!((restored.now(), restored.lookahead()), (3.0, 5.0));
}
