//! The format of a recording, as its documentation has it.

use super::late::Recording;
use super::support::line;
use glam::DVec3;
use nearmiss::{AlertLevel, Body, Monitor, RevisionThreshold, Scene, State};
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
