//! A plan that is changed while it is flown: what has been flown stays, whatever either plan says of the
//! time beyond its knots.

#![allow(
    clippy::unwrap_used,
    reason = "a plan that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, Conflict, Error, Event, EventKind, Hitbox, Monitor, Outside, Query, Scene,
    State, Trajectory, Window, pair,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use support::{line, rng, vector, wander, with_every_change};

const RULES: [Outside; 3] = [Outside::Absent, Outside::Coast, Outside::Extrapolate];

/// With knots from `start` on under each rule, from one state, and at rest.
fn plans(rng: &mut ChaCha8Rng, start: f64) -> Vec<Trajectory> {
    let states = wander(rng, start, 5, 1.0, 20.0, 4.0);
    let plans = RULES.map(|outside| {
        Trajectory::from_states(&states)
            .unwrap()
            .with_outside(outside)
    });
    let mut more = vec![
        Trajectory::coasting(states[0]).unwrap(),
        Trajectory::at_rest(states[1].position).unwrap(),
    ];
    more.extend(plans);
    more
}

/// Before the splice the old plan, after it the new one, and absent where they are.
#[test]
fn what_has_been_flown_stays() {
    let mut rng = rng(41);
    let (mut spliced_often, mut refused, mut beyond) = (0, 0, 0);
    for _ in 0..60 {
        let start = rng.random_range(-3.0..3.0);
        let (mut flown, new) = (plans(&mut rng, start), plans(&mut rng, 0.0));
        let trimmed = flown[2].clone().trimmed_before(start + 2.5);
        let froms = [-6.0, -1.0, start, 0.3, 2.2, trimmed.knots()[0], 9.0];
        flown.extend(RULES.map(|outside| trimmed.clone().with_outside(outside)));
        for (old, plan) in flown
            .iter()
            .flat_map(|old| new.iter().map(move |new| (old, new)))
        {
            for from in froms {
                let Ok(spliced) = old.spliced(from, plan) else {
                    let is_there = old.domain().contains(from) && plan.domain().contains(from);
                    let is_over = plan.outside_after() == Outside::Absent
                        && *plan.knots().last().unwrap() <= from;
                    assert!(!is_there || is_over, "{old:?} {from} {plan:?}");
                    refused += 1;
                    continue;
                };
                spliced_often += 1;
                for step in -150..150 {
                    let time = f64::from(step) * 0.1 + 0.007;
                    let followed = if time < from { old } else { plan };
                    let both = (spliced.position(time), spliced.velocity(time));
                    assert_eq!(
                        both,
                        (followed.position(time), followed.velocity(time)),
                        "{time} {from} {old:?} {plan:?}"
                    );
                    beyond += u32::from(time < old.knots()[0] && both.0.is_some());
                }
                let (old, new) = (old.domain(), plan.domain());
                let domain = Window::new(old.start().min(from), new.end()).unwrap();
                assert_eq!(spliced.domain(), domain);
            }
        }
    }
    assert!(spliced_often > 4_000 && refused > 1_000 && beyond > 100_000);
}

/// Checks that a plan, which has lost its beginning, goes on before its first knot as the other rules say.
fn check_before(trimmed: &Trajectory) {
    let first = trimmed.knots()[0];
    let state = trimmed.state(first).unwrap();
    let coasting = trimmed.clone().with_outside(Outside::Coast);
    let extrapolated = trimmed.clone().with_outside(Outside::Extrapolate);
    let cubic = trimmed.segments()[0];
    assert!(trimmed.position(first.next_down()).is_none());
    for step in 0..40 {
        let time = first - 0.1 * f64::from(step);
        let straight = state.position + (time - first) * state.velocity;
        let scale = 1.0 + cubic.extent() + straight.length();
        let off = |plan: &Trajectory, place| plan.position(time).unwrap().distance(place) / scale;
        assert!(off(&coasting, straight) < 1e-12, "{time} {trimmed:?}");
        let velocity = coasting.velocity(time).unwrap();
        assert!(velocity.distance(state.velocity) < 1e-12 * (1.0 + state.velocity.length()));
        assert!(off(&extrapolated, cubic.motion_at(time).0) < 1e-12);
    }
    // One rule after the other.
    let both = coasting.clone().with_outside(Outside::Extrapolate);
    assert_eq!(both, extrapolated);
    assert_eq!(both.with_outside(Outside::Coast), coasting);
}

/// A plan that is trimmed or was trimmed by a monitor, at a knot, at a splice, and where it was extrapolated.
#[test]
fn what_has_lost_its_beginning_goes_on_from_its_first_knot() {
    let known = [
        State::new(0.0, DVec3::ZERO, DVec3::X),
        State::new(1.0, DVec3::new(1.0, 1.0, 0.0), DVec3::Y),
        State::new(2.0, DVec3::new(1.0, 2.0, 0.0), DVec3::Y),
    ];
    let known = Trajectory::from_states(&known).unwrap().trimmed_before(1.5);
    check_before(&known);
    let known = known.with_outside(Outside::Coast);
    assert_eq!(known.position(0.5), Some(DVec3::new(1.0, 0.5, 0.0)));

    let mut rng = rng(46);
    let mut checked = [0; 4];
    for round in 0..100 {
        for flown in plans(&mut rng, 0.0) {
            let trimmed = flown.clone().trimmed_before(2.5);
            if trimmed.knots() != flown.knots() {
                check_before(&trimmed);
                // Once more, and with what comes before the first knot of a part.
                check_before(&trimmed.trimmed_before(3.5));
                checked[0] += 1;
            }
            // Cut in the middle of a cubic, or where the plan goes on beyond its knots.
            for from in [2.3, 40.0] {
                let next = plans(&mut rng, from)[round % 5].clone();
                let Ok(spliced) = flown.spliced(from, &next) else {
                    continue;
                };
                for since in [from - 0.1, from + 1.1] {
                    let trimmed = spliced.clone().trimmed_before(since);
                    if trimmed.knots() != spliced.knots() && !trimmed.segments().is_empty() {
                        check_before(&trimmed);
                        checked[1] += 1;
                    }
                }
            }
            // A plan for a time before its own first knot.
            let Ok(spliced) = flown.spliced(-9.0, &plans(&mut rng, 2.0)[round % 5]) else {
                continue;
            };
            for since in [-6.0, 0.0, 2.5] {
                let trimmed = spliced.clone().trimmed_before(since);
                if trimmed.knots() != spliced.knots() {
                    check_before(&trimmed);
                    checked[2] += 1;
                }
            }
        }
        let old = plans(&mut rng, -6.0)[3 + round % 2].clone();
        let (mut monitor, bodies) = monitor(std::slice::from_ref(&old));
        monitor.set_history([0.0, 1.0][round % 2]).unwrap();
        monitor.advance(-2.5, &mut Vec::new()).unwrap();
        let new = plans(&mut rng, -2.2)[round / 3 % 5].clone();
        monitor.replan(bodies[0], -2.2, new).unwrap();
        let flown = &monitor.scene().body(bodies[0]).unwrap().trajectory;
        assert!(flown.knots()[0] > old.knots()[0]);
        check_before(flown);
        checked[3] += 1;
    }
    assert!(checked.iter().all(|&count| count >= 100), "{checked:?}");
}

/// The numbers of a file are all there is to know.
#[cfg(feature = "recording")]
#[test]
fn what_was_read_from_a_file_goes_on_as_well() {
    use std::io::Write;
    use std::sync::{Arc, Mutex};

    #[derive(Clone, Default)]
    struct File(Arc<Mutex<Vec<u8>>>);
    impl Write for File {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    let mut rng = rng(47);
    for _ in 0..20 {
        let mut all = Vec::new();
        for flown in plans(&mut rng, -6.0) {
            for from in [-2.2, 3.0] {
                let next = plans(&mut rng, from)[2].clone();
                all.extend(flown.spliced(from, &next));
            }
            all.extend(flown.spliced(-9.0, &plans(&mut rng, -1.0)[2]));
            all.push(flown);
        }
        let trimmed = |plan: &Trajectory| plan.clone().trimmed_before(-2.3);
        for plan in all.clone() {
            let rest = trimmed(&plan);
            all.extend(RULES.map(|outside| rest.clone().with_outside(outside)));
            all.extend(RULES.map(|outside| plan.clone().with_outside(outside)));
            for outside in [Outside::Coast, Outside::Extrapolate] {
                let rest = rest.clone().with_outside(outside);
                all.extend(rest.spliced(-8.0, &plan));
            }
        }
        let (mut monitor, bodies) = monitor(&all);
        let file = File::default();
        monitor.start_recording(file.clone()).unwrap();
        monitor.stop_recording().unwrap();
        let bytes = file.0.lock().unwrap().clone();
        let read = nearmiss::recording::Replay::open(&bytes[..]).unwrap();
        for (id, plan) in bodies.into_iter().zip(&all) {
            let again = &read.monitor().scene().body(id).unwrap().trajectory;
            assert_eq!(again, plan);
            for outside in RULES {
                let [again, plan] = [again, plan].map(|plan| plan.clone().with_outside(outside));
                for time in [-30.0, -8.5, -2.4, 0.0, 50.0] {
                    assert_eq!(again.state(time), plan.state(time));
                }
            }
        }
    }
}

/// What is dropped is dropped: the body was not there.
#[test]
fn what_is_forgotten_is_not_asked() {
    let mut rng = rng(42);
    for plan in plans(&mut rng, 0.0) {
        let late = plan.clone().trimmed_before(2.5);
        for step in 25..200 {
            let time = f64::from(step) * 0.1;
            assert_eq!(late.position(time), plan.position(time));
        }
        if late.knots() != plan.knots() {
            let first = late.knots()[0];
            assert!(first > 0.0 && late.position(first - 0.1).is_none());
            assert_eq!(
                late.domain(),
                Window::new(first, late.domain().end()).unwrap()
            );
        }
    }
}

fn monitor(plans: &[Trajectory]) -> (Monitor, Vec<nearmiss::BodyId>) {
    let mut scene = Scene::new();
    let hitbox = Hitbox::sphere(1.0).unwrap();
    let bodies = plans
        .iter()
        .map(|plan| scene.insert(Body::new(plan.clone()).with_hitbox(hitbox.clone())));
    let bodies = bodies.map(Result::unwrap).collect();
    let monitor =
        with_every_change(Monitor::new(scene, -4.0, 8.0, &[AlertLevel::at(3.0)]).unwrap());
    (monitor, bodies)
}

/// A plan for later changes nothing before it, also of bodies that are not at their first knot yet.
#[test]
fn a_plan_for_later_leaves_what_comes_before() {
    let mut rng = rng(43);
    let (mut same, mut before_knots, mut refused) = (0, 0, 0);
    for round in 0..300 {
        let start = rng.random_range(-6.0..4.0);
        let flown = plans(&mut rng, start);
        let old = flown[round % flown.len()].clone();
        let from = rng.random_range(-4.0..4.0);
        let new = plans(&mut rng, from);
        let new = new[round / 5 % new.len()].clone();
        let mut all = vec![old.clone()];
        for _ in 0..4 {
            let states = wander(&mut rng, -9.0, 20, 1.0, 12.0, 3.0);
            all.push(Trajectory::from_states(&states).unwrap());
        }
        let ((mut changed, bodies), (mut twin, _)) = (monitor(&all), monitor(&all));
        let (mut events, mut others) = (Vec::new(), Vec::new());
        for monitor in [&mut changed, &mut twin] {
            monitor.advance(-4.0, &mut Vec::new()).unwrap();
        }
        match changed.replan(bodies[0], from, new) {
            Ok(used) => assert_eq!(used.to_bits(), from.to_bits()),
            Err(error) => {
                assert!(matches!(error, Error::InBody { .. }), "{error}");
                refused += 1;
                continue;
            }
        }
        for now in [-4.0, -3.5, from - 0.1] {
            if now < changed.now() {
                continue;
            }
            changed.advance(now, &mut events).unwrap();
            twin.advance(now, &mut others).unwrap();
            let early = |monitor: &Monitor| -> Vec<Conflict> {
                let mut found = monitor.conflicts(0).unwrap().to_vec();
                found.retain(|conflict| conflict.exit < from);
                found
            };
            let (found, expected) = (early(&changed), early(&twin));
            assert_eq!(found.len(), expected.len(), "{now} {from} {old:?}");
            for (found, expected) in found.iter().zip(&expected) {
                // Rounding differs where a cubic is cut.
                let times = |one: &Conflict| [one.enter, one.exit, one.closest.time];
                let off = times(found).into_iter().zip(times(expected));
                let off = off.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                assert!((found.a, found.b) == (expected.a, expected.b) && off < 1e-6);
            }
            same += found.len();
            let first = old.knots()[0];
            let own = found.iter().filter(|conflict| conflict.a == bodies[0]);
            before_knots += own.filter(|conflict| conflict.enter < first).count();
        }
    }
    assert!(
        same > 500 && before_knots > 50 && refused < 200,
        "{same} {before_knots} {refused}"
    );
}

/// In the middle of an encounter before its first knot.
#[test]
fn an_encounter_before_the_first_knot_goes_on() {
    let still = line(-20.0, 20.0, DVec3::ZERO, DVec3::ZERO);
    // At the origin at 0 s.
    let states = [8.0, 15.0].map(|time| State::new(time, DVec3::X * time, DVec3::X));
    let comes = Trajectory::from_states(&states)
        .unwrap()
        .with_outside(Outside::Coast);
    let (mut monitor, bodies) = monitor(&[still, comes]);
    let mut events = Vec::new();
    monitor.advance(-4.0, &mut events).unwrap();

    let later = line(
        6.0,
        30.0,
        DVec3::X * 6.0 + vector(&mut rng(44), 1.0),
        DVec3::Y,
    );
    monitor.replan(bodies[1], 6.0, later).unwrap();
    for now in [-3.0, 0.0, 4.9] {
        events.clear();
        monitor.advance(now, &mut events).unwrap();
        // Its end is told once it is in sight.
        let is_revised = |event: &Event| matches!(event.kind, EventKind::Revised(_));
        assert!(events.iter().all(is_revised), "{events:?}");
        assert!((monitor.conflicts(0).unwrap()[0].exit - 5.0).abs() < 1e-12);
    }
}

/// Nor is what a monitor has dropped.
#[test]
fn what_a_monitor_forgets_is_not_asked() {
    let states = wander(&mut rng(45), -4.0, 20, 1.0, 12.0, 3.0);
    let plan = Trajectory::from_states(&states).unwrap();
    let (mut monitor, bodies) = monitor(&[plan.with_outside(Outside::Coast)]);
    for now in [-4.0, 3.0] {
        monitor.advance(now, &mut Vec::new()).unwrap();
    }
    let later = line(3.5, 30.0, DVec3::ZERO, DVec3::Y);
    monitor.replan(bodies[0], 3.5, later).unwrap();
    monitor.advance(3.2, &mut Vec::new()).unwrap();
    let body = monitor.scene().body(bodies[0]).unwrap();
    let first = body.trajectory.knots()[0];
    assert!(-4.0 < first && first <= 3.0, "{first}");
    assert_eq!(body.trajectory.domain(), Window::new(first, 30.0).unwrap());
}

/// Pieces beyond the knots are counted from the last knot, also where the plan's last segment is shorter than what
/// f64 resolves at the splice.
#[test]
fn a_plan_goes_on_after_a_splice_far_beyond_its_knots() {
    let resting = |x: f64| Trajectory::at_rest(x * DVec3::X).unwrap();
    let ball = |plan| Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap());
    for (step, from, speed) in [
        (1e-6, 1e12, 1e-9),
        (1e-9, 2e7, 1e-3),
        (1e-10, 1e12, 1e-9),
        (1e-12, 2e7, 1e-3),
        (1e-12, 1e5, 1.0),
    ] {
        let velocity = speed * DVec3::X;
        let states = [0.0, step].map(|time| State::new(time, time * velocity, velocity));
        let plan = Trajectory::from_states(&states).unwrap();
        let plan = plan.with_outside(Outside::Coast);
        let (far, way) = (speed * from, 50.0);
        let wall = ball(resting(far + way));
        let window = Window::new(from, from + 2.0 * way / speed).unwrap();
        let query = Query::new(window);
        let contact = |plan: &Trajectory| {
            let found = pair::conflicts(&ball(plan.clone()), &wall, &query).unwrap();
            assert_eq!(found.len(), 1, "{step} {from} {speed}");
            [found[0].enter, found[0].exit].map(|time| (time - from) * speed)
        };
        let spliced = resting(far).spliced(from, &plan).unwrap();
        let close = 4.0 * f64::EPSILON * far + 1e-9 * way;
        for (found, expected) in contact(&spliced).into_iter().zip(contact(&plan)) {
            assert!((found - expected).abs() <= close, "{found} {expected}");
        }
        let mut scene = Scene::new();
        let body = scene.insert(ball(resting(far))).unwrap();
        scene.insert(wall.clone()).unwrap();
        let lookahead = 2.0 * way / speed;
        let mut monitor = Monitor::new(scene, from, lookahead, &[AlertLevel::at(0.0)]).unwrap();
        monitor.replan(body, from, plan).unwrap();
        let mut events = Vec::new();
        for quarter in 0..=8 {
            let now = from + f64::from(quarter) * way / speed / 4.0;
            monitor.advance(now, &mut events).unwrap();
        }
        let kinds = events.iter().map(|event| event.kind);
        let count =
            |wanted: fn(EventKind) -> bool| kinds.clone().filter(|&kind| wanted(kind)).count();
        assert_eq!(
            count(|kind| matches!(kind, EventKind::Began(_))),
            1,
            "{events:?}"
        );
        assert_eq!(
            count(|kind| matches!(kind, EventKind::Ended(..))),
            1,
            "{events:?}"
        );
    }
    // The same before the first knot.
    let states = [0.0, 1e-6].map(|time| State::new(time, time * 1e-9 * DVec3::X, 1e-9 * DVec3::X));
    let plan = Trajectory::from_states(&states).unwrap();
    let plan = plan.with_outside(Outside::Coast);
    let spliced = plan.spliced(-1e12, &resting(-1e3)).unwrap();
    let wall = ball(resting(-1050.0));
    let query = Query::new(Window::new(-2e12, -1e12).unwrap());
    for plan in [plan, spliced] {
        let found = pair::conflicts(&ball(plan), &wall, &query).unwrap();
        assert_eq!(found.len(), 1);
    }
}

/// The velocity at a splice may cancel. Its rounding is that of the plan there, and grows with the time before.
#[test]
fn a_line_from_within_a_segment_knows_how_well_it_is_known() {
    for tenths in 1..200 {
        let speed = 0.1 * f64::from(tenths);
        let state = |time: f64, place: f64, speed: f64| {
            State::new(time, place * DVec3::X, speed * DVec3::X)
        };
        // At 1 s it stands still, whatever the first speed: 4 p = 3 v.
        let plan = Trajectory::from_states(&[state(0.0, 0.0, speed), state(3.0, 3.0, 4.0)]);
        let plan = plan.unwrap();
        let still = plan.spliced(1.0, &plan).unwrap().trimmed_before(1.5);
        let body = Body::new(still.with_outside(Outside::Coast));
        let place = 4.0 / 9.0 * speed - 1.0 / 9.0;
        let wall = Body::new(Trajectory::at_rest(-1000.0 * DVec3::X).unwrap());
        let long_ago = Window::new(-1e9, -1e9).unwrap();
        let found = pair::certified_closest_approach(&body, &wall, long_ago);
        let found = found.unwrap().unwrap();
        let off = (found.approach.separation - (1000.0 + place)).abs();
        assert!(off <= found.error + 1e-12, "{speed}: {off} {}", found.error);
        // Some hundred roundings of the plan's size, a third of 1e9 times.
        assert!(found.error < 1e-3, "{}", found.error);
    }
}

/// A segment shorter than what f64 resolves at a far splice is no unit of time there.
#[test]
fn a_body_that_exists_for_ever_has_a_position() {
    let curved = [0.0, 1e-6].map(|time| State::new(time, time * time * DVec3::Y, DVec3::X));
    let curved = Trajectory::from_states(&curved).unwrap();
    let curved = curved.with_outside(Outside::Extrapolate);
    let resting = Trajectory::at_rest(DVec3::ZERO).unwrap();
    for (from, cut) in [(1e12, 5e11), (-1e11, -2e11)] {
        let spliced = curved.spliced(from, &resting).unwrap().trimmed_before(cut);
        let spliced = spliced.with_outside(Outside::Coast);
        let first = spliced.knots()[0];
        assert!(spliced.position(first - 1e9).is_some(), "{spliced:?}");
    }
}
