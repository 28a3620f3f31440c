//! A monitor from a snapshot: what it knows before its first tick, and what it reports from then on.

use super::scenarios::tick;
use super::support::{line, rng, vector};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Encounter, EndReason, Error, Event, EventKind, Monitor, Scene, State,
    Trajectory,
};
use rand::RngExt;

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

/// Boxes that would be of no use in the next tick are not formed: where all bodies are told in each frame.
#[test]
fn a_restored_monitor_goes_on_as_the_other_one_did() {
    let mut rng = rng(37);
    let mut scene = Scene::new();
    let mut states: Vec<(DVec3, DVec3)> = (0..500)
        .map(|_| (vector(&mut rng, 50.0), vector(&mut rng, 5.0)))
        .collect();
    let coasting = |now: f64, (place, velocity): (DVec3, DVec3)| State::new(now, place, velocity);
    let ids: Vec<BodyId> = states
        .iter()
        .map(|&one| {
            let plan = Trajectory::coasting(coasting(0.0, one)).unwrap();
            scene.insert(Body::new(plan)).unwrap()
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(2.0)]).unwrap();
    tick(&mut monitor, 0.0);
    let first = Monitor::restore(monitor.snapshot()).unwrap();
    // Those of all slices, at least three and one ahead.
    let keeps_boxes = |monitor: &Monitor| monitor.stats().boxes > 3 * 500;
    let now = |frame: u32| 0.125 * f64::from(frame);
    for frame in 1..80 {
        // All of them; then nobody for a while, which does not count; then one.
        let told = match frame {
            1..10 => ids.len(),
            10..30 => 0,
            _ => 1,
        };
        for (place, velocity) in &mut states {
            *place += 0.125 * *velocity;
            *velocity = vector(&mut rng, 5.0);
        }
        let states = states.iter().map(|&one| coasting(now(frame), one));
        monitor
            .track(now(frame), ids.iter().copied().zip(states).take(told))
            .unwrap();
        tick(&mut monitor, now(frame));
        let restored = Monitor::restore(monitor.snapshot()).unwrap();
        if !(30..70).contains(&frame) {
            assert_eq!(keeps_boxes(&restored), told == 1, "{frame}");
        }
        assert_eq!(
            restored.conflicts(0).unwrap(),
            monitor.conflicts(0).unwrap()
        );
    }
    // All was unknown a tick before.
    assert!(!keeps_boxes(&first));
}

/// Encounters of bodies that are removed end alike, in whichever order these go.
#[test]
fn a_snapshot_ends_the_encounters_of_all_removed_bodies() {
    const COUNT: usize = 60;
    let mut rng = rng(31);
    let mut scene = Scene::new();
    let mut ids: Vec<BodyId> = (0..2 * COUNT)
        .map(|_| {
            let plan = line(0.0, 90.0, vector(&mut rng, 20.0), vector(&mut rng, 1.0));
            scene.insert(Body::new(plan)).unwrap()
        })
        .collect();
    let levels = [AlertLevel::at(3.0), AlertLevel::at(6.0)];
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &levels).unwrap();
    tick(&mut monitor, 0.0);
    tick(&mut monitor, 1.0);
    let before = monitor.encounters().count();
    for number in 0..COUNT {
        let gone = ids.swap_remove(rng.random_range(0..ids.len()));
        monitor.remove(gone).unwrap();
        if number % 10 == 0 || number == COUNT - 1 {
            let known: Vec<Encounter> = monitor.encounters().copied().collect();
            let mut restored = Monitor::restore(monitor.snapshot()).unwrap();
            assert_eq!(restored.encounters().copied().collect::<Vec<_>>(), known);
            let ends = tick(&mut restored, 1.0);
            let of_removed = |event: &&Event| {
                let over = match event.kind {
                    EventKind::Ended(over, EndReason::BodyRemoved) => over,
                    EventKind::Withdrawn(over) => over,
                    _ => return false,
                };
                [over.a, over.b]
                    .iter()
                    .any(|&id| monitor.scene().body(id).is_none())
            };
            assert_eq!(ends.iter().filter(of_removed).count(), before - known.len());
        }
    }
    let mut restored = Monitor::restore(monitor.snapshot()).unwrap();
    for now in [1.5, 4.0, 20.0] {
        let expected = tick(&mut monitor, now);
        let ends = expected
            .iter()
            .filter(|event| matches!(event.kind, EventKind::Ended(_, EndReason::BodyRemoved)));
        assert!(now > 1.5 || ends.count() > 50);
        assert_eq!(tick(&mut restored, now), expected, "{now}");
    }
}
