//! From when changes count that have no time of their own.

use super::scenarios::tick;
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Event, EventKind, Hitbox, Layers, Monitor, Scene, State,
    Trajectory,
};

/// A body counts from the clock of the last tick on. Inserted after the tick at whose clock it appears, a bullet does not
/// meet the one who fired it; inserted before, it is taken to have flown through him. One that is removed before the tick has
/// hit nothing since the last one.
#[test]
fn insertions_and_removals_count_from_the_last_tick_on() {
    let ball = |state: State, radius: f64| {
        let body = Body::new(Trajectory::coasting(state).unwrap());
        body.with_hitbox(Hitbox::sphere(radius).unwrap())
    };
    let shooter = ball(State::new(0.0, [0.0; 3], [0.0; 3]), 0.5);
    // 0.25 m away when it appears, and flying away.
    let bullet = |now: f64| ball(State::new(now, [0.8, 0.0, 0.0], [100.0, 0.0, 0.0]), 0.05);
    let begun = |events: &[Event]| {
        let began = |event: &&Event| matches!(event.kind, EventKind::Began(_));
        events.iter().filter(began).count()
    };
    for is_after in [true, false] {
        let mut scene = Scene::new();
        scene.insert(shooter.clone()).unwrap();
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(0.0)]).unwrap();
        tick(&mut monitor, 1.0);
        let mut events = Vec::new();
        if is_after {
            events.extend(tick(&mut monitor, 1.1));
        }
        monitor.insert(bullet(1.1)).unwrap();
        events.extend(tick(&mut monitor, 1.1));
        events.extend(tick(&mut monitor, 1.2));
        assert_eq!(begun(&events), usize::from(!is_after));
    }
    for is_after in [true, false] {
        let mut scene = Scene::new();
        scene.insert(shooter.clone()).unwrap();
        let towards = State::new(0.0, [20.0, 0.0, 0.0], [-100.0, 0.0, 0.0]);
        let hit = scene.insert(ball(towards, 0.05)).unwrap();
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(0.0)]).unwrap();
        tick(&mut monitor, 0.0);
        let mut events = Vec::new();
        if is_after {
            events.extend(tick(&mut monitor, 0.5));
        }
        monitor.remove(hit).unwrap();
        events.extend(tick(&mut monitor, 0.5));
        assert_eq!(begun(&events), usize::from(is_after));
    }
}

/// Hitboxes, layers, model errors, whole trajectories and ignored pairs count from the clock of the last tick on, as
/// insertions do. Under a budget that left the monitor behind, they count from the instant up to which all was reported.
#[test]
fn changes_without_a_time_count_from_the_last_tick_on() {
    type Change = fn(&mut Monitor, BodyId, BodyId);
    let wide = || Hitbox::sphere(6.0).unwrap();
    // The change after which the bodies meet, at 5.5 s.
    let cases: [(&str, Change); 5] = [
        ("hitbox", |monitor, a, _| {
            monitor.set_hitbox(a, Hitbox::sphere(6.0).unwrap()).unwrap();
        }),
        ("model error", |monitor, a, _| {
            monitor.set_model_error(a, 6.0).unwrap();
        }),
        ("layers", |monitor, a, _| {
            monitor.set_layers(a, Layers::ALL).unwrap();
        }),
        ("trajectory", |monitor, a, _| {
            let nearer = Trajectory::at_rest([0.0, 1.0, 0.0]).unwrap();
            monitor.set_trajectory(a, nearer).unwrap();
        }),
        ("pair", |monitor, a, b| monitor.unignore_pair(a, b).unwrap()),
    ];
    for (what, change) in cases {
        let ended = |is_after: bool, budget: Budget| {
            let mut scene = Scene::new();
            let mut a = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
            a = match what {
                "layers" => a.with_hitbox(wide()).with_layers(Layers::NONE),
                "pair" => a.with_hitbox(wide()),
                "trajectory" => a.with_hitbox(Hitbox::sphere(4.5).unwrap()),
                _ => a,
            };
            let a = scene.insert(a).unwrap();
            let passing = State::new(5.0, [20.0, 5.0, 0.0], [-40.0, 0.0, 0.0]);
            let b = Body::new(Trajectory::coasting(passing).unwrap());
            let b = scene.insert(b).unwrap();
            if what == "pair" {
                scene.ignore_pair(a, b).unwrap();
            }
            let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(0.0)]).unwrap();
            let mut events = tick(&mut monitor, 0.0);
            if is_after {
                monitor.advance_within(9.0, budget, &mut events).unwrap();
            }
            assert!(events.is_empty(), "{what} {events:?}");
            change(&mut monitor, a, b);
            events.extend(tick(&mut monitor, 9.0));
            let ended = |event: &&Event| matches!(event.kind, EventKind::Ended(..));
            events.iter().filter(ended).count()
        };
        assert_eq!(ended(false, Budget::Unlimited), 1, "{what}");
        assert_eq!(ended(true, Budget::Unlimited), 0, "{what}");
        assert_eq!(ended(true, Budget::Work(0)), 1, "{what}");
    }
}

/// The end of the known time is known: an encounter that was to begin there is withdrawn as soon as its plans change.
#[test]
fn an_encounter_at_the_end_of_the_known_time_is_withdrawn_at_once() {
    let coasting = |x: f64, velocity: DVec3| {
        Trajectory::coasting(State::new(0.0, x * DVec3::X, velocity)).unwrap()
    };
    let mut scene = Scene::new();
    scene.insert(Body::new(coasting(0.0, DVec3::ZERO))).unwrap();
    let id = scene.insert(Body::new(coasting(12.0, -DVec3::X))).unwrap();
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(2.0)]).unwrap();
    let predicted: Vec<Event> = tick(&mut monitor, 0.0);
    let [
        Event {
            kind: EventKind::Predicted(encounter),
            ..
        },
    ] = predicted[..]
    else {
        panic!("{predicted:?}")
    };
    assert_eq!(encounter.enter, monitor.complete_until());
    monitor
        .set_trajectory(id, coasting(99.0, DVec3::X))
        .unwrap();
    let withdrawn: Vec<Event> = tick(&mut monitor, 0.0);
    let [
        Event {
            kind: EventKind::Withdrawn(other),
            ..
        },
    ] = withdrawn[..]
    else {
        panic!("{withdrawn:?}")
    };
    assert_eq!(other.id, encounter.id);
}
