//! The format of a recording, as its documentation has it.

use super::late::Recording;
use super::support::line;
use glam::DVec3;
use nearmiss::{AlertLevel, Body, Monitor, RevisionThreshold, Scene, State, Trajectory};
use std::collections::BTreeSet;

const DOCUMENTED: &str = include_str!("../../src/monitor/recording/replay.rs");

/// Kinds of record in the first column of the documented table.
fn documented() -> BTreeSet<String> {
    let rows = DOCUMENTED
        .lines()
        .filter(|line| line.starts_with("/// | `"));
    let kinds = rows.filter_map(|row| row.split('|').nth(1));
    let names = kinds.flat_map(|kinds| kinds.split(','));
    names.map(|name| name.trim().replace('`', "")).collect()
}

#[test]
fn the_records_have_the_names_of_the_documented_table() {
    let level = [AlertLevel::at(5.0)];
    let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &level).unwrap();
    let recording = Recording::of(&mut monitor);
    let body = |x: f64| Body::new(line(0.0, 90.0, x * DVec3::X, DVec3::Y));
    let id = monitor.insert(body(0.0)).unwrap();
    monitor.insert(body(1.0)).unwrap();
    monitor.set_history(1.0).unwrap();
    monitor
        .set_revision_threshold(RevisionThreshold::default())
        .unwrap();
    monitor.set_max_spans(0);
    let mut events = Vec::new();
    assert!(monitor.advance(1.0, &mut events).is_err());
    monitor.set_max_spans(9);
    monitor.advance(1.0, &mut events).unwrap();
    let state = State::new(1.0, DVec3::Z, DVec3::Z);
    monitor.track(1.0, [(id, state)]).unwrap();
    monitor.skip_to(2.0).unwrap();
    monitor.close(&mut events);
    let bytes = recording.0.lock().unwrap().clone();
    let text = String::from_utf8(bytes).unwrap();
    // Length, checksum, and an object with one key or a string.
    let written: BTreeSet<String> = text
        .lines()
        .skip(1)
        .map(|line| {
            let json = line.splitn(3, ' ').nth(2).unwrap();
            json.split('"').nth(1).unwrap().to_owned()
        })
        .collect();
    assert_eq!(written, documented());
}

/// Late on the clock, where instants are far apart: what begins just after the end of the lookahead is reported at that end,
/// and so it is in a replay.
#[test]
fn what_is_rounded_to_the_last_known_instant_is_replayed() {
    const NOW: f64 = 1.7e9;
    const LOOKAHEAD: f64 = 0.003;
    let mut at_end = 0;
    for place in -20..20 {
        let end = NOW + LOOKAHEAD;
        // Instants are 2.4e-7 s apart there.
        let enter = (end - NOW) + 1e-8 * f64::from(place);
        let velocity = -2e4 * DVec3::X;
        let coming = State::new(NOW, DVec3::X - enter * velocity, velocity);
        let plans = [
            Trajectory::at_rest(DVec3::ZERO),
            Trajectory::coasting(coming),
        ];
        let mut scene = Scene::new();
        for plan in plans {
            scene.insert(Body::new(plan.unwrap())).unwrap();
        }
        let level = [AlertLevel::at(1.0)];
        let mut monitor = Monitor::new(scene, NOW, LOOKAHEAD, &level).unwrap();
        let recording = Recording::of(&mut monitor);
        let mut events = Vec::new();
        monitor.advance(NOW, &mut events).unwrap();
        at_end += events.len();
        monitor.advance(end, &mut events).unwrap();
        assert_eq!(recording.again(&mut monitor), events, "{place}");
    }
    assert!(at_end > 20, "{at_end}");
}
