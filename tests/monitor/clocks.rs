//! Clocks that jump, and ticks that are refused.

use super::scenarios::{head_on, kinds, tick, two};
use super::support::{line, rng, wander, with_every_change};
use glam::DVec3;
use nearmiss::{AlertLevel, Body, Budget, Error, Monitor, Query, Scene, State, Trajectory, Window};
use std::time::Duration;

#[test]
fn a_jump_over_an_encounter_tells_both_its_ends() {
    let (a, b) = head_on();
    let (mut monitor, ..) = two(a, b, &[AlertLevel::at(2.0), AlertLevel::at(1.0)]);
    let events = tick(&mut monitor, 50.0);
    assert_eq!(
        kinds(&events),
        [
            "began 0",
            "began 1",
            "ended 1 Separated",
            "ended 0 Separated"
        ]
    );
    let back = monitor.advance(49.0, &mut Vec::new());
    assert_eq!(
        back.unwrap_err(),
        Error::ClockWentBack {
            now: 50.0,
            time: 49.0
        }
    );
    assert_eq!(monitor.now(), 50.0);
}

/// A jump over 3e12 slices: bodies rest, some touching, some fly past each other early on or after
/// a long time, and what happened meanwhile is reported, whatever the budget of a tick.
#[test]
fn the_clock_may_jump_as_far_as_it_can_show() {
    let (lookahead, end) = (1e-3, 1e9);
    for budget in [
        Budget::Unlimited,
        Budget::Work(200),
        Budget::Time(Duration::ZERO),
    ] {
        for count in [0_u16, 1, 300] {
            let mut scene = Scene::new();
            for k in 0..count {
                let place = DVec3::new(0.9 * f64::from(k), 50.0, 0.0);
                let body = Body::new(Trajectory::at_rest(place).unwrap());
                scene.insert(body).unwrap();
            }
            if count > 1 {
                // 5 s from each other.
                let (a, b) = head_on();
                scene.insert(Body::new(a)).unwrap();
                scene.insert(Body::new(b)).unwrap();
                // Passes all those at rest, one after the other, from 7e8 s on.
                let late = line(7e8, 7e8 + 500.0, DVec3::new(-10.0, 50.5, 0.0), DVec3::X);
                scene.insert(Body::new(late)).unwrap();
            }
            let mut monitor = with_every_change(
                Monitor::new(scene, 0.0, lookahead, &[AlertLevel::at(1.0)]).unwrap(),
            );
            let mut events = tick(&mut monitor, 0.0);
            let mut ticks = 0;
            loop {
                monitor.advance_within(end, budget, &mut events).unwrap();
                if monitor.is_caught_up() {
                    break;
                }
                ticks += 1;
                assert!(ticks < 200_000, "{budget:?} {count}");
            }
            let names = kinds(&events);
            let number = |name: &str| names.iter().filter(|kind| *kind == name).count();
            let neighbours = usize::from(count).max(1) - 1;
            let passed = if count > 1 { 1 + usize::from(count) } else { 0 };
            assert_eq!(number("began 0"), neighbours + passed);
            assert_eq!(number("ended 0 Separated"), passed);
            assert_eq!(monitor.encounters().count(), neighbours);
        }
    }
    // So far that the lookahead would be lost in the clock's rounding, or no time at all.
    let (mut monitor, ..) = two(head_on().0, head_on().1, &[AlertLevel::at(2.0)]);
    tick(&mut monitor, 1e9);
    for time in [1e17, 1e300, f64::INFINITY, f64::NAN] {
        let refused = monitor.advance(time, &mut Vec::new()).unwrap_err();
        assert!(matches!(refused, Error::Clock { .. }), "{refused}");
        assert_eq!(monitor.now(), 1e9);
    }
}

/// A plan that cannot be followed so far is refused as often as the tick is tried, until it is replaced.
#[test]
fn a_tick_that_is_refused_is_refused_again() {
    let fast = State::new(0.0, DVec3::ZERO, 1e298 * DVec3::X);
    let rest = Trajectory::at_rest(DVec3::Y).unwrap();
    let (mut monitor, runaway, _) = two(
        Trajectory::coasting(fast).unwrap(),
        rest.clone(),
        &[AlertLevel::at(2.0)],
    );
    tick(&mut monitor, 0.0);
    for _ in 0..3 {
        let mut events = Vec::new();
        let refused = monitor.advance(100.0, &mut events).unwrap_err();
        assert!(matches!(refused, Error::InBody { .. }), "{refused}");
        assert_eq!((monitor.now(), events.len()), (0.0, 0));
    }
    monitor.set_trajectory(runaway, rest).unwrap();
    tick(&mut monitor, 100.0);
    assert_eq!(monitor.now(), 100.0);
}

/// Nothing for a million seconds, so that slices become long; then a minute in which everybody meets
/// everybody in such a slice.
#[test]
fn a_jump_over_nothing_and_then_a_crowd() {
    let mut rng = rng(77);
    let mut scene = Scene::new();
    for _ in 0..1000 {
        let states = wander(&mut rng, 1e6, 30, 2.0, 200.0, 5.0);
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let all = Query::default().with_margin(1.0);
    let expected = scene.screen(&all).unwrap().conflicts.len();
    let mut monitor =
        with_every_change(Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap());
    let names = kinds(&tick(&mut monitor, 3e6));
    let number = |name: &str| names.iter().filter(|kind| kind.starts_with(name)).count();
    assert!(expected > 500, "{expected}");
    assert_eq!([number("began"), number("ended")], [expected; 2]);
    // In slices of the least length a million seconds would be 300 million boxes; in one slice the
    // crowd would be 500,000 candidates.
    let stats = monitor.stats();
    assert!(stats.boxes < 200_000, "{stats:?}");
    assert!(stats.candidates < 300_000, "{stats:?}");
}

/// A body whose motion is replaced where it is goes on for as long as nothing changes. It was followed far ahead when it was
/// told last, and its next motion is known for some seconds.
#[test]
fn a_motion_that_was_replaced_goes_on_without_end() {
    for is_tracked in [false, true] {
        let state =
            |time: f64, x: f64, speed: f64| State::new(time, x * DVec3::X, speed * DVec3::X);
        let mut scene = Scene::new();
        let ids = [0.0, 40.0].map(|x| {
            let plan = Trajectory::coasting(state(0.0, x, 0.0)).unwrap();
            scene.insert(Body::new(plan)).unwrap()
        });
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(2.0)]).unwrap();
        let mut met = 0;
        for frame in 0..200 {
            let now = 0.25 * f64::from(frame);
            if [1.0, 1.25, 5.25].contains(&now) {
                let state = state(now, now, 1.0 + 0.001 * now);
                if is_tracked {
                    monitor.track(now, [(ids[0], state)]).unwrap();
                } else {
                    let plan = Trajectory::coasting(state).unwrap();
                    monitor.replan(ids[0], now, plan).unwrap();
                }
            }
            tick(&mut monitor, now);
            let query = Query::new(Window::new(now, now + 2.0).unwrap()).with_margin(2.0);
            let screened = monitor.scene().screen(&query).unwrap().conflicts;
            assert_eq!(
                monitor.conflicts(0).unwrap(),
                screened,
                "{is_tracked} {now}"
            );
            met += screened.len();
        }
        assert!(met > 10, "{met}");
    }
}
