//! A clock that is set ahead without a look at the time in between.

use super::scenarios::tick;
use super::support::{bits, exceeded, line, rng, vector, wander, with_every_change};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, EncounterId, EndReason, Error, Event, EventKind, Monitor, Outside,
    Scene, State, Trajectory,
};

const LEVELS: [AlertLevel; 2] = [AlertLevel::at(1.0), AlertLevel::at(2.0).with_release(3.0)];

fn scene(seed: u64) -> (Scene, Vec<BodyId>) {
    let (mut rng, mut scene) = (rng(seed), Scene::new());
    let bodies = (0..40).map(|number| {
        let states = wander(&mut rng, -1.0, 20, 1.0, 12.0, 3.0);
        let outside = [Outside::Absent, Outside::Coast][number % 2];
        Body::new(
            Trajectory::from_states(&states)
                .unwrap()
                .with_outside(outside),
        )
    });
    let ids = bodies.map(|body| scene.insert(body).unwrap()).collect();
    (scene, ids)
}

/// The events of a monitor, without the ids of encounters.
fn said(events: &[Event]) -> Vec<String> {
    let text = |event: &Event| {
        let mut kind = event.kind;
        if let EventKind::Predicted(one)
        | EventKind::Revised(one)
        | EventKind::Began(one)
        | EventKind::Ended(one, _)
        | EventKind::Withdrawn(one) = &mut kind
        {
            one.id = EncounterId::from_bits(0);
        }
        format!("{:?} {kind:?}", event.time)
    };
    events.iter().map(text).collect()
}

/// After it, a monitor is as a new one of the same scene, but for the ids of encounters, and what it says of old ones.
#[test]
fn after_it_a_monitor_is_as_a_new_one() {
    let (mut over, mut withdrawn, mut later) = (0, 0, 0);
    for seed in 0..24 {
        let (scene, ids) = scene(seed);
        let mut monitor = with_every_change(Monitor::new(scene, 0.0, 3.0, &LEVELS).unwrap());
        let mut rng = rng(100 + seed);
        tick(&mut monitor, 0.0);
        tick(&mut monitor, 0.7);
        // Changes since the last tick count.
        monitor.remove(ids[3]).unwrap();
        let coasting = State::new(0.7, vector(&mut rng, 6.0), vector(&mut rng, 2.0));
        monitor.track(0.7, [(ids[4], coasting)]).unwrap();
        let known: Vec<_> = monitor
            .encounters()
            .map(|one| (one.id, one.enter))
            .collect();
        let to = [0.7, 0.9, 4.0, 1e6][usize::try_from(seed % 4).unwrap()];
        monitor.skip_to(to).unwrap();
        assert!(monitor.conflicts(0).unwrap().is_empty() && !monitor.is_caught_up());
        let fresh = Monitor::new(monitor.scene().clone(), to, 3.0, &LEVELS).unwrap();
        let mut fresh = with_every_change(fresh);
        let mut events = tick(&mut monitor, to);
        // What was known is over, once.
        let mut is_old = |event: &Event| match event.kind {
            EventKind::Ended(one, reason) => {
                assert!(one.enter <= 0.7 && event.time.to_bits() == 0.7_f64.to_bits());
                assert!(matches!(
                    reason,
                    EndReason::ClockSet | EndReason::BodyRemoved
                ));
                over += u32::from(reason == EndReason::ClockSet);
                true
            }
            EventKind::Withdrawn(_) => {
                withdrawn += 1;
                true
            }
            _ => false,
        };
        let old: Vec<Event> = events.extract_if(.., |event| is_old(event)).collect();
        let ended = |id| {
            let of = |event: &&Event| match event.kind {
                EventKind::Ended(one, _) | EventKind::Withdrawn(one) => one.id == id,
                _ => false,
            };
            old.iter().filter(of).count()
        };
        assert!(known.iter().all(|&(id, _)| ended(id) == 1), "{seed}");
        let first_id = known.iter().map(|(id, _)| id.to_bits() + 1).max();
        for now in [to, to + 0.3, to + 2.5] {
            events.append(&mut tick(&mut monitor, now));
            assert_eq!(said(&events), said(&tick(&mut fresh, now)), "{seed} {now}");
            events.clear();
            for level in 0..2 {
                let [own, other] = [&monitor, &fresh].map(|one| one.conflicts(level).unwrap());
                assert_eq!(bits(own), bits(other), "{seed} {now}");
                later += own.len();
            }
            let mut ids = monitor.encounters().map(|one| one.id.to_bits());
            assert!(ids.all(|id| first_id.is_none_or(|first| id >= first)));
        }
    }
    assert!(
        over > 50 && withdrawn > 50 && later > 500,
        "{over} {withdrawn} {later}"
    );
}

/// Fragments that fly off from one point are refused however far the clock is to go, until it is set past that.
#[test]
fn a_crowd_of_an_instant_is_left_behind() {
    let mut scene = Scene::new();
    let mut rng = rng(7);
    for _ in 0..300 {
        let state = State::new(0.0, DVec3::ZERO, vector(&mut rng, 50.0));
        scene
            .insert(Body::new(Trajectory::coasting(state).unwrap()))
            .unwrap();
    }
    for side in [-1.0, 1.0] {
        let plan = line(
            0.0,
            20.0,
            DVec3::new(10.0 * side, 500.0, 0.0),
            -side * DVec3::X,
        );
        scene.insert(Body::new(plan)).unwrap();
    }
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(0.01)]).unwrap();
    monitor.set_max_spans(20_000);
    for now in [0.0, 0.5, 30.0] {
        assert_eq!(
            exceeded(monitor.advance(now, &mut Vec::new())),
            Some(20_000)
        );
        assert_eq!(monitor.now().to_bits(), 0.0_f64.to_bits());
    }
    monitor.skip_to(0.5).unwrap();
    let met = [0.5, 5.0, 15.0].map(|now| tick(&mut monitor, now));
    let began = |event: &&Event| matches!(event.kind, EventKind::Began(one) if one.enter > 9.0);
    assert_eq!(met.iter().flatten().filter(began).count(), 1);
}

#[test]
fn a_refused_one_changes_nothing() {
    let (scene, _) = scene(5);
    let mut monitor = Monitor::new(scene, 0.0, 3.0, &LEVELS).unwrap();
    tick(&mut monitor, 1.0);
    let state = |monitor: &Monitor| (monitor.now(), bits(monitor.conflicts(1).unwrap()));
    let before = state(&monitor);
    assert!(matches!(
        monitor.skip_to(0.5),
        Err(Error::ClockWentBack { .. })
    ));
    assert!(matches!(
        monitor.skip_to(f64::NAN),
        Err(Error::Clock { .. })
    ));
    let far = monitor.skip_to(1e300).map_err(|error| error.to_string());
    assert!(far.is_err());
    assert_eq!(state(&monitor), before);
    assert!(monitor.is_caught_up() && !before.1.is_empty());
}
