//! Calls of `track` that are refused, that name a body twice, and what remains of it on paper.

use super::support::{rng, vector};
use super::tracked::{LEVELS, LOOKAHEAD, Pair, Seen, any_state, are_same};
use glam::{DQuat, DVec3};
#[cfg(feature = "serde")]
use nearmiss::{AlertLevel, Outside};
use nearmiss::{
    Body, BodyId, BodyState, Budget, Error, Monitor, Quantity, Query, Scene, State, Trajectory,
    Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::collections::BTreeMap;

/// A life of some ticks; the same each time.
fn started() -> Pair {
    let (mut rng, mut seen) = (rng(431), Seen::default());
    let mut pair = Pair::new(&mut rng, 0.0, LOOKAHEAD);
    for tick in 1..20 {
        let next = 0.05 * f64::from(tick);
        pair.tell_any(&mut rng, next, &mut seen);
        pair.advance(next, Budget::Unlimited);
    }
    assert!(seen.told > 100, "{seen:?}");
    pair
}

/// Returns states that are refused, with the error's number and value.
fn refused_states() -> Vec<(State, Quantity, f64)> {
    let [nan, inf] = [f64::NAN, f64::INFINITY];
    let of = |position, velocity| State::new(1.0, position, velocity);
    vec![
        (
            of(DVec3::ZERO, DVec3::new(0.0, nan, 0.0)),
            Quantity::Velocity(1),
            nan,
        ),
        (
            of(DVec3::X, DVec3::new(0.0, 0.0, inf)),
            Quantity::Velocity(2),
            inf,
        ),
        (
            of(DVec3::new(0.0, 0.0, -inf), DVec3::X),
            Quantity::Position(2),
            -inf,
        ),
        (
            of(DVec3::new(-1e301, 0.0, 0.0), DVec3::X),
            Quantity::Position(0),
            -1e301,
        ),
        (State::new(nan, DVec3::ZERO, DVec3::X), Quantity::Time, nan),
        (
            State::new(1e301, DVec3::ZERO, DVec3::X),
            Quantity::Time,
            1e301,
        ),
    ]
}

fn refusal(quantity: Quantity, value: f64) -> Error {
    if value.is_finite() {
        Error::OutOfRange {
            knot: 0,
            quantity,
            value,
        }
    } else {
        Error::NotFinite {
            knot: 0,
            quantity,
            value,
        }
    }
}

/// In the middle of states that are fine. (Errors are compared as text, since no NaN equals another one.)
#[test]
fn a_call_with_a_state_that_is_refused_changes_nothing() {
    let mut asked = started();
    let mut never = started();
    let mut rng = rng(432);
    let clock = asked.tracked.now();
    let now = clock + 0.05;
    let fresh: Vec<(BodyId, State)> = asked
        .ids
        .iter()
        .filter(|id| asked.plan(**id).position(now).is_some())
        .map(|&id| (id, any_state(&mut rng, now)))
        .collect();
    assert!(fresh.len() > 20);
    let middle = fresh.len() / 2;
    let id = fresh[middle].0;
    let tag_of = |pair: &Pair, id| pair.tracked.scene().body(id).unwrap().tag;
    let mut calls = Vec::new();
    for (state, quantity, value) in refused_states() {
        let mut states = fresh.clone();
        states[middle].1 = state;
        let error = refusal(quantity, value)
            .in_body(tag_of(&asked, id))
            .with_id(id);
        calls.push((now, states, error));
    }
    for now in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e301] {
        for states in [fresh.clone(), Vec::new()] {
            calls.push((now, states, Error::Clock { time: now }));
        }
    }
    // It has no plan at that time.
    let position = DVec3::ZERO;
    let short = [-3.0, -2.0].map(|time| State::new(time, position, DVec3::X));
    let short = Body::new(Trajectory::from_states(&short).unwrap()).with_tag(77);
    let mut gone = None;
    for pair in [&mut asked, &mut never] {
        let absent = pair.tracked.insert(short.clone()).unwrap();
        let removed = pair.tracked.insert(short.clone()).unwrap();
        pair.tracked.remove(removed).unwrap();
        gone = Some((absent, removed));
        pair.tracked.advance(clock, &mut Vec::new()).unwrap();
    }
    let (absent, removed) = gone.unwrap();
    let errors = [
        (
            absent,
            Error::NoOldPlan {
                time: now,
                start: -3.0,
                end: -2.0,
            }
            .in_body(77)
            .with_id(absent),
        ),
        (removed, Error::UnknownBody { id: removed }),
    ];
    for (id, error) in errors {
        let mut states = fresh.clone();
        states.insert(middle, (id, State::new(now, position, DVec3::X)));
        calls.push((now, states, error));
    }
    for (now, states, error) in calls {
        let refused = asked.tracked.track(now, states).unwrap_err();
        assert_eq!(format!("{refused:?}"), format!("{error:?}"));
        are_same(&asked.tracked, &never.tracked, (0, 0));
        for (id, body) in never.tracked.scene().bodies() {
            assert_eq!(asked.tracked.scene().body(id), Some(body), "{error}");
        }
    }
    // The next ticks are those of a monitor that was never asked.
    for (tick, told) in [(0, 0), (1, fresh.len()), (2, 0)] {
        let [events, expected] = [&mut asked, &mut never].map(|pair| {
            let monitor = &mut pair.tracked;
            monitor.track(now, fresh[..told].iter().copied()).unwrap();
            let mut events = Vec::new();
            let next = clock + 0.1 * f64::from(tick + 1);
            monitor.advance(next, &mut events).unwrap();
            assert_eq!(monitor.stats().changed, told as u64);
            events
        });
        assert_eq!(events, expected);
        are_same(&asked.tracked, &never.tracked, (0, tick));
        assert!(!asked.tracked.conflicts(0).unwrap().is_empty());
    }
}

/// The first of them begins later than the instant it is told for; the last is what the body does already, or
/// replaces it anew.
#[test]
fn of_a_body_that_is_named_twice_the_last_state_counts() {
    let mut scene = Scene::new();
    let (position, velocity) = (DVec3::X, DVec3::Y);
    let known = State::new(0.0, position, velocity);
    let body = Body::new(Trajectory::coasting(known).unwrap());
    let id = scene.insert(body).unwrap();
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &LEVELS).unwrap();
    let later = State::new(5.0, -9.0 * position, velocity);
    for (now, last, changed) in [
        (1.0, known, 0),
        (2.0, State::new(2.0, position, velocity), 1),
        (3.0, State::new(3.0, position, -velocity), 1),
    ] {
        monitor.track(now, [(id, later), (id, last)]).unwrap();
        let plan = &monitor.scene().body(id).unwrap().trajectory;
        for time in [now, now + 1.0, 9.0] {
            let expected = last.position + (time - last.time) * last.velocity;
            assert_eq!(plan.position(time), Some(expected), "{now}");
        }
        monitor.advance(now, &mut Vec::new()).unwrap();
        assert_eq!(monitor.stats().changed, changed, "{now}");
    }
}

/// Its knots so far are no matter of the caller's.
#[test]
fn a_state_that_cannot_be_followed_is_knot_0() {
    let mut scene = Scene::new();
    let id = scene
        .insert(Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap()))
        .unwrap();
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &LEVELS).unwrap();
    monitor.set_history(9.0).unwrap();
    for tick in 0..6 {
        let now = 0.5 * f64::from(tick);
        let far = State::new(now - 1e9, DVec3::ZERO, 1e295 * DVec3::X);
        let by_state = monitor.track(now, [(id, far)]).unwrap_err();
        let by_plan = monitor.replan(id, now, Trajectory::coasting(far).unwrap());
        assert_eq!(by_plan, Err(by_state.clone()));
        let Error::InBody { error, .. } = by_state else {
            panic!("{by_state}");
        };
        assert!(
            matches!(*error, Error::OutOfRange { knot: 0, .. }),
            "{error}"
        );
        let state = State::new(now, DVec3::ZERO, f64::from(tick) * DVec3::Y);
        monitor.track(now, [(id, state)]).unwrap();
        monitor.advance(now, &mut Vec::new()).unwrap();
    }
}

/// A number that is unusable by itself is refused in any state; what depends on the monitor, in the last state of a
/// body: of those, the error is that of the body which was named first.
#[test]
fn which_state_of_a_body_is_refused() {
    let mut scene = Scene::new();
    let [a, b] = [1, 2].map(|tag| {
        let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
        scene.insert(Body::new(rest).with_tag(tag)).unwrap()
    });
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &LEVELS).unwrap();
    let state = |time, speed: f64| State::new(time, DVec3::ZERO, speed * DVec3::X);
    // Out of range at the monitor's clock, not where it was.
    let (fine, far, unusable) = (state(1.0, 1.0), state(-1e9, 1e295), state(1.0, f64::NAN));
    let mut refused = |states: &[(BodyId, State)]| {
        let done = monitor.track(1.0, states.iter().copied());
        done.err().map(|error| match error {
            Error::InBody { id, error, .. } => {
                (id.unwrap(), matches!(*error, Error::NotFinite { .. }))
            }
            other => panic!("{other}"),
        })
    };
    assert_eq!(refused(&[(a, unusable), (a, fine)]), Some((a, true)));
    assert_eq!(refused(&[(a, fine), (b, far), (a, far)]), Some((a, false)));
    assert_eq!(refused(&[(a, fine), (b, far), (a, fine)]), Some((b, false)));
    assert_eq!(
        refused(&[(a, far), (b, unusable), (a, fine)]),
        Some((a, false))
    );
    assert_eq!(refused(&[(a, far), (a, fine)]), None);
}

/// Returns bodies that turn, in a row, and a state of each at an instant (s).
fn turning(rng: &mut ChaCha8Rng, count: usize, now: f64) -> (Monitor, Vec<(BodyId, BodyState)>) {
    let mut scene = Scene::new();
    let states = (0..count).map(|number| {
        let position = 9.0 * number as f64 * DVec3::X;
        let body = Body::new(Trajectory::at_rest(position).unwrap());
        (
            scene.insert(body).unwrap(),
            turning_state(rng, position, now),
        )
    });
    let states = states.collect();
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &LEVELS).unwrap();
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    (monitor, states)
}

fn turning_state(rng: &mut ChaCha8Rng, position: DVec3, now: f64) -> BodyState {
    let state = BodyState::from(State::new(now, position, vector(rng, 1.0)));
    let rotation = DQuat::from_scaled_axis(vector(rng, 1.0));
    state.with_spin(rotation, vector(rng, 1.0))
}

/// With its spin, or without one: whatever states of the same and of other bodies come before it.
#[test]
fn the_last_state_counts_with_its_spin() {
    let mut rng = rng(434);
    let (mut monitor, states) = turning(&mut rng, 60, 1.0);
    let mut alone = Monitor::restore(monitor.snapshot()).unwrap();
    for frame in 1..40 {
        let now = 0.05 * f64::from(frame);
        let mut told = Vec::new();
        for _ in 0..rng.random_range(1..200) {
            let (id, state) = states[rng.random_range(0..states.len())];
            let mut state = turning_state(&mut rng, state.state.position, now);
            if rng.random_bool(0.4) {
                state.spin = None;
            }
            told.push((id, state));
        }
        let last: BTreeMap<BodyId, BodyState> = told.iter().copied().collect();
        monitor.track(now, told).unwrap();
        alone.track(now, last).unwrap();
        assert!(
            monitor.scene().bodies().eq(alone.scene().bodies()),
            "{frame}"
        );
        monitor.advance(now, &mut Vec::new()).unwrap();
        alone.advance(now, &mut Vec::new()).unwrap();
    }
}

/// Plans that were replaced in place, written down and read again.
#[cfg(feature = "serde")]
#[test]
fn trajectories_of_tracked_bodies_are_read_as_they_were_written() {
    let mut pair = started();
    let now = pair.tracked.now();
    let (mut rng, mut seen) = (rng(433), Seen::default());
    for now in [now + 0.05, now + 0.1] {
        let there = pair
            .ids
            .iter()
            .filter(|id| pair.plan(**id).position(now).is_some());
        let states: Vec<_> = there.map(|&id| (id, any_state(&mut rng, now))).collect();
        pair.tell(now, &states, &mut seen);
        pair.advance(now, Budget::Unlimited);
    }
    let (mut read, mut turned) = (Scene::new(), 0);
    for (_, body) in pair.tracked.scene().bodies() {
        let written = serde_json::to_string(&body.trajectory).unwrap();
        let trajectory: Trajectory = serde_json::from_str(&written).unwrap();
        assert_eq!(trajectory, body.trajectory);
        let is_turned = !trajectory.segments().is_empty();
        turned += usize::from(is_turned && trajectory.outside_after() == Outside::Coast);
        let mut body = body.clone();
        body.trajectory = trajectory;
        read.insert(body).unwrap();
    }
    assert!(turned > 20, "{turned}");
    let mut monitor = Monitor::new(read, pair.tracked.now(), LOOKAHEAD, &LEVELS).unwrap();
    monitor
        .advance(pair.tracked.now(), &mut Vec::new())
        .unwrap();
    are_same(&monitor, &pair.tracked, (0, 0));
    assert!(!monitor.conflicts(0).unwrap().is_empty());
}

/// A body that rests, and is told to rest there, keeps its plan: also one that was read from a file, and one whose plan
/// ended at rest.
#[cfg(feature = "serde")]
#[test]
fn a_body_told_to_rest_where_it_rests_is_not_changed() {
    let state = |time: f64, x: f64, speed: f64| State::new(time, x * DVec3::X, speed * DVec3::X);
    let watch = |states: [State; 2]| {
        let plan = Trajectory::from_states(&states).unwrap();
        let mut scene = Scene::new();
        let body = Body::new(plan.with_outside(Outside::Coast));
        let id = scene.insert(body).unwrap();
        let monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap();
        (monitor, id)
    };
    let (mut flying, id) = watch([state(0.0, 0.0, 1.0), state(1.0, 1.0, 1.0)]);
    flying.advance(2.0, &mut Vec::new()).unwrap();
    flying.track(2.0, [(id, state(2.0, 2.0, 0.0))]).unwrap();
    flying.advance(3.0, &mut Vec::new()).unwrap();
    let written = serde_json::to_string(&flying.snapshot()).unwrap();
    let read = Monitor::restore(serde_json::from_str(&written).unwrap()).unwrap();
    let (stopped, stopped_id) = watch([state(0.0, 0.0, 1.0), state(1.0, 1.0, 0.0)]);
    for (mut monitor, id, x) in [
        (flying, id, 2.0),
        (read, id, 2.0),
        (stopped, stopped_id, 1.0),
    ] {
        let knots = |monitor: &Monitor| {
            monitor
                .scene()
                .body(id)
                .unwrap()
                .trajectory
                .knots()
                .to_vec()
        };
        let before = knots(&monitor);
        monitor.track(4.0, [(id, state(4.0, x, 0.0))]).unwrap();
        assert_eq!(knots(&monitor), before);
        // Elsewhere is another plan.
        monitor
            .track(4.0, [(id, state(4.0, x + 1.0, 0.0))])
            .unwrap();
        assert_ne!(knots(&monitor), before);
    }
}

/// As far, as fast and as long ago as numbers go: what one refuses, the other refuses, for the same reason.
#[test]
fn extreme_states_are_refused_or_followed_alike() {
    let (mut taken, mut refused, mut failed) = (0, 0, 0);
    for seed in 451..471 {
        let mut rng = rng(seed);
        let mut pair = Pair::new(&mut rng, 0.0, LOOKAHEAD);
        for tick in 1..30 {
            let now = 0.05 * f64::from(tick);
            for _ in 0..3 {
                let id = pair.ids[rng.random_range(0..pair.ids.len())];
                let mut power = |least: f64, most: f64| {
                    let size = 10_f64.powf(rng.random_range(least..most));
                    [size, -size, 0.0][rng.random_range(0..3)]
                };
                let time = [now, now + power(-12.0, 18.0), power(-3.0, 299.9)];
                let velocity = DVec3::new(power(-30.0, 3.0), power(-3.0, 299.9), 0.0);
                let position = DVec3::new(power(-9.0, 9.0), 0.0, power(-9.0, 299.9));
                let state = State::new(time[rng.random_range(0..3)], position, velocity);
                let Ok(plan) = Trajectory::coasting(state) else {
                    continue;
                };
                let done = pair.tracked.track(now, [(id, state)]);
                let expected = pair.replanned.replan(id, now, plan).map(drop);
                assert_eq!(done, expected, "{seed} {tick} {state:?}");
                taken += usize::from(done.is_ok());
                refused += usize::from(done.is_err());
            }
            let [done, expected] = [&mut pair.tracked, &mut pair.replanned].map(|monitor| {
                let mut events = Vec::new();
                let done = monitor.advance(now, &mut events);
                done.map(|()| events)
            });
            assert_eq!(done, expected, "{seed} {tick}");
            let bodies = pair.tracked.scene().bodies();
            assert!(bodies.eq(pair.replanned.scene().bodies()), "{seed} {tick}");
            if done.is_err() {
                failed += 1;
                break;
            }
        }
    }
    assert!(taken > 500 && refused > 20, "{taken} {refused} {failed}");
}

/// Between two ticks a body is told as often as there is room in place for its motions, and more often: the first of
/// them that is kept begins at the very clock.
#[test]
fn states_that_are_told_many_times_between_two_ticks() {
    let mut scene = Scene::new();
    let ids = [0.0, 5.0].map(|x| {
        let plan = Trajectory::coasting(State::new(0.0, x * DVec3::X, DVec3::ZERO));
        scene.insert(Body::new(plan.unwrap())).unwrap()
    });
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[LEVELS[0]]).unwrap();
    let query = |now: f64| Query::new(Window::new(now, now + 10.0).unwrap());
    for frame in 1..200 {
        let now = 0.125 * f64::from(frame);
        let velocity = if frame % 2 == 0 { 0.25 } else { -0.25 };
        let body = monitor.scene().body(ids[0]).unwrap();
        let place = body.trajectory.position(now).unwrap();
        let state = State::new(now, place, velocity * DVec3::X);
        monitor.track(now, [(ids[0], state)]).unwrap();
        if frame % 7 == 0 || frame % 13 == 0 {
            monitor.advance(now, &mut Vec::new()).unwrap();
            let query = query(now).with_margin(LEVELS[0].margin);
            let screened = monitor.scene().screen(&query).unwrap();
            assert_eq!(monitor.conflicts(0).unwrap(), screened.conflicts, "{frame}");
        }
    }
}
