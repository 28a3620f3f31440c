//! A monitor from a snapshot: what it knows before its first tick, and what it reports from then on.

use super::scenarios::tick;
use super::support::line;
use glam::DVec3;
use nearmiss::{AlertLevel, Body, BodyId, Error, Monitor, Scene, Trajectory};

fn pair() -> (Monitor, BodyId) {
    let mut scene = Scene::new();
    let nears = line(0.0, 90.0, 12.0 * DVec3::X, -DVec3::X);
    let id = scene.insert(Body::new(nears)).unwrap();
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    scene.insert(Body::new(rest)).unwrap();
    let level = [AlertLevel::at(5.0)];
    (Monitor::new(scene, 0.0, 10.0, &level).unwrap(), id)
}

/// Returns the number of conflicts of a plan, or `None` while nothing is known.
fn asked(monitor: &Monitor, id: BodyId) -> Option<usize> {
    let plan = line(0.0, 90.0, 9.0 * DVec3::X, -DVec3::X);
    match monitor.what_if(id, &plan, 0) {
        Err(Error::NothingKnown { .. }) => None,
        conflicts => Some(conflicts.unwrap().len()),
    }
}

/// Between a tick and the next change all is known; after a change nothing before the next tick.
#[test]
fn a_restored_monitor_knows_what_is_said_of_it() {
    let (mut monitor, id) = pair();
    tick(&mut monitor, 1.0);
    let known = |monitor: &Monitor| {
        let conflicts = monitor.conflicts(0).unwrap().len();
        (monitor.complete_until(), conflicts, asked(monitor, id))
    };
    let mut settled = Monitor::restore(monitor.snapshot()).unwrap();
    assert_eq!(known(&monitor), (11.0, 1, Some(1)));
    assert_eq!(known(&settled), known(&monitor));
    for monitor in [&mut monitor, &mut settled] {
        let away = line(1.0, 90.0, 11.0 * DVec3::X, -2.0 * DVec3::X);
        monitor.replan(id, 1.0, away).unwrap();
    }
    let mut changed = Monitor::restore(monitor.snapshot()).unwrap();
    assert_eq!(known(&changed), (1.0, 0, None));
    assert!(!changed.is_caught_up());
    for now in [1.0, 4.0, 9.0] {
        let expected = tick(&mut monitor, now);
        for restored in [&mut settled, &mut changed] {
            assert_eq!(tick(restored, now), expected, "{now}");
            assert_eq!(known(restored), known(&monitor));
        }
    }
}
