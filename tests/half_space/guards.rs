//! What a monitor keeps of half-spaces at rest, and instants that rounding moves across a window's end.

use super::vector;
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyId, Conflict, Hitbox, Layers, Monitor, Orientation, Outside, Query,
    Scene, Sphere, State, TimeBase, Trajectory, Window, pair,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const LOOKAHEAD: f64 = 4.0;

fn floor(normal: DVec3) -> Body {
    let plan = Trajectory::at_rest(DVec3::ZERO).unwrap();
    Body::new(plan).with_hitbox(Hitbox::half_space(normal).unwrap())
}

/// A ball of 1 m.
fn ball(state: State) -> Body {
    let body = Body::new(Trajectory::coasting(state).unwrap());
    body.with_hitbox(Hitbox::sphere(1.0).unwrap())
}

fn watch(bodies: Vec<Body>, now: f64, lookahead: f64) -> (Monitor, Vec<BodyId>) {
    let mut scene = Scene::new();
    let insert = |body| scene.insert(body).unwrap();
    let ids = bodies.into_iter().map(insert).collect();
    let monitor = Monitor::new(scene, now, lookahead, &[AlertLevel::at(0.0)]).unwrap();
    (monitor, ids)
}

fn screened(scene: &Scene, from: f64, to: f64) -> Vec<Conflict> {
    let query = Query::new(Window::new(from, to).unwrap());
    scene.screen(&query).unwrap().conflicts
}

/// Compares a monitor with a screening of its window; returns the number of conflicts.
fn compare(monitor: &Monitor) -> usize {
    let found = monitor.conflicts(0).unwrap();
    let expected = screened(monitor.scene(), monitor.now(), monitor.complete_until());
    assert_eq!(
        found,
        expected,
        "{} {}",
        monitor.now(),
        monitor.complete_until()
    );
    found.len()
}

/// A body above a floor, or a floor below a body, whose plan turns towards the other one at its end, long before the
/// lookahead ends, and goes on beyond it.
#[test]
fn what_follows_a_plan_is_met_in_time() {
    const LAST: f64 = 17.0;
    let state = |time: f64, z: f64, speed: f64| State::new(time, z * DVec3::Z, speed * DVec3::Z);
    let mut met = 0;
    for outside in [Outside::Coast, Outside::Extrapolate] {
        for last in [state(LAST, 48.1, -36.7), state(LAST, 48.0, -40.0)] {
            for is_floor in [false, true] {
                let states = [state(-5.0, 50.0, 0.0), state(LAST - 0.1, 50.0, 0.0), last];
                let plan = Trajectory::from_states(&states).unwrap();
                let turned = Body::new(plan.with_outside(outside));
                let bodies = if is_floor {
                    // The other side of the floor is solid.
                    let hitbox = Hitbox::half_space(-DVec3::Z).unwrap();
                    vec![turned.with_hitbox(hitbox), ball(state(0.0, 0.0, 0.0))]
                } else {
                    vec![
                        turned.with_hitbox(Hitbox::sphere(1.0).unwrap()),
                        floor(DVec3::Z),
                    ]
                };
                let (mut monitor, _) = watch(bodies, 0.0, 10.0);
                for tick in 0..100 {
                    let now = 0.25 * f64::from(tick);
                    monitor.advance(now, &mut Vec::new()).unwrap();
                    met += compare(&monitor);
                }
            }
        }
    }
    assert!(met > 300, "{met}");
}

/// A half-space that is told at rest, and has changed in one way since: each has another body touch
/// it, which was far from it before.
#[test]
fn what_a_plane_at_rest_depends_on() {
    for change in 0..7 {
        let hover = |place: DVec3| ball(State::new(0.0, place, DVec3::ZERO));
        let near = hover(0.5 * DVec3::Z);
        let mut high = hover(DVec3::new(9.0, 0.0, 1.5));
        if change == 4 {
            high = hover(DVec3::new(9.0, 0.0, 0.5)).with_layers(Layers::new(2, 2));
        }
        let mut ground = floor(DVec3::Z);
        if change == 4 {
            ground = ground.with_layers(Layers::new(1, 1));
        }
        let (mut monitor, ids) = watch(vec![ground.clone(), near, high], 0.0, LOOKAHEAD);
        let id = ids[0];
        let mut events = Vec::new();
        let tell = |monitor: &mut Monitor, now: f64, place: DVec3, velocity: DVec3| {
            let told = [(id, State::new(now, place, velocity))];
            monitor.track(now, told).unwrap();
        };
        if change == 6 {
            monitor.ignore_pair(id, ids[2]).unwrap();
            monitor
                .set_hitbox(ids[2], Hitbox::sphere(2.0).unwrap())
                .unwrap();
        }
        for now in [0.0, 0.1, 0.2] {
            tell(&mut monitor, now, DVec3::ZERO, DVec3::ZERO);
            monitor.advance(now, &mut events).unwrap();
            assert_eq!(compare(&monitor), 1, "{change}");
        }
        match change {
            0 => tell(&mut monitor, 0.3, DVec3::Z, DVec3::ZERO),
            1 => tell(&mut monitor, 0.3, DVec3::ZERO, DVec3::Z),
            2 => {
                let slope = DVec3::new(-0.8, 0.0, 0.6);
                monitor
                    .set_hitbox(id, Hitbox::half_space(slope).unwrap())
                    .unwrap();
            }
            3 => monitor.set_model_error(id, 1.0).unwrap(),
            4 => monitor.set_layers(id, Layers::ALL).unwrap(),
            5 => {
                // It goes on with its plan, and has another one after that.
                let rises = Trajectory::coasting(State::new(1.0, DVec3::ZERO, DVec3::Z));
                monitor.replan(id, 1.0, rises.unwrap()).unwrap();
            }
            _ => {
                // Another one in the place of the first, at which no pair is ignored.
                monitor.remove(id).unwrap();
                monitor.insert(ground).unwrap();
            }
        }
        monitor.advance(0.4, &mut events).unwrap();
        assert!(compare(&monitor) > 1, "{change}");
    }
}

/// Balls that pass a floor at a hundred metres per second, late on the clock: what is reported at an
/// instant may have been before or after it.
#[test]
fn windows_that_end_with_a_contact() {
    let mut rng = ChaCha8Rng::seed_from_u64(41);
    let rng = &mut rng;
    for round in 0..300 {
        let begin = 1.7e9 + rng.random_range(0.0..100.0);
        let speed = rng.random_range(50.0..200.0) * [1.0, -1.0][round % 2];
        let height = -speed * rng.random_range(1.0..3.0);
        let state = State::new(begin, height * DVec3::Z, speed * DVec3::Z);
        let bodies = [floor(DVec3::Z), ball(state)];
        let (monitor, _) = watch(bodies.to_vec(), begin, 16.0);
        let all = screened(monitor.scene(), begin, begin + 16.0);
        let [passing] = all.as_slice() else {
            unreachable!("{all:?}")
        };
        let windows = if speed < 0.0 {
            [(begin, passing.enter), (passing.enter, passing.enter)]
        } else {
            [(passing.exit, begin + 16.0), (passing.exit, passing.exit)]
        };
        for (from, to) in windows {
            let found = screened(monitor.scene(), from, to);
            assert_eq!(found.len(), 1, "{round} {from} {to} {passing:?}");
            let (mut monitor, _) = watch(bodies.to_vec(), from, (to - from).max(1.0));
            monitor.advance(from, &mut Vec::new()).unwrap();
            compare(&monitor);
        }
    }
}

/// Lookaheads that end about where the one before the last one was compared to.
#[test]
fn lookaheads_that_end_with_a_contact() {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    let rng = &mut rng;
    let mut count = 0;
    for round in 0..1_500 {
        let now: f64 = 1.7e9 + rng.random_range(0.0..100.0);
        let step = now.next_up() - now;
        // Bodies are compared up to here at first.
        let until = now + 2.0 * LOOKAHEAD;
        let (start, speed) = (now - [0.0, 9.0][round % 2], rng.random_range(0.5..2.0));
        let after = until - start + step * rng.random_range(-2.0..2.0);
        let state = State::new(start, (1.0 + speed * after) * DVec3::Z, -speed * DVec3::Z);
        let aside = vector(rng, 3.0) * DVec3::new(1.0, 1.0, 0.0);
        let state = State::new(state.time, state.position + aside, state.velocity);
        let (mut monitor, _) = watch(vec![floor(DVec3::Z), ball(state)], now, LOOKAHEAD);
        let mut events = Vec::new();
        monitor.advance(now, &mut events).unwrap();
        for ticks in -3..=3 {
            let next = until - LOOKAHEAD + f64::from(ticks) * step;
            monitor.advance(next, &mut events).unwrap();
            count += compare(&monitor);
        }
    }
    assert!(count > 1_000, "{count}");
}

/// Lookaheads so short that rounding is longer.
#[test]
fn lookaheads_of_few_instants() {
    let now = 1.7e9_f64;
    let step = now.next_up() - now;
    for steps in [20.0, 25.0, 60.0] {
        let state = State::new(now, 2.0 * DVec3::Z, -1e6 * DVec3::Z);
        let turning = Orientation::spin(now, DQuat::IDENTITY, DVec3::X);
        let sphere = Sphere {
            offset: 0.1 * DVec3::X,
            radius: 0.9,
        };
        let turning = ball(state)
            .with_hitbox(Hitbox::cluster(vec![sphere]).unwrap())
            .with_orientation(turning.unwrap());
        let bodies = vec![floor(DVec3::Z), ball(state), turning];
        let (mut monitor, _) = watch(bodies, now, steps * step);
        let mut events = Vec::new();
        for tick in 0..40_u8 {
            monitor
                .advance(now + f64::from(tick) * step, &mut events)
                .unwrap();
            compare(&monitor);
        }
        assert!(events.len() > 2, "{steps}");
    }
}

/// Bodies at rest that touch a half-space whose normal is as long, or as short, as is accepted.
#[test]
fn normals_of_any_length() {
    let mut rng = ChaCha8Rng::seed_from_u64(43);
    let rng = &mut rng;
    for round in 0..200 {
        let unit = vector(rng, 1.0).normalize();
        let normal = unit * (1.0 + [0.9e-9, -0.9e-9][round % 2]);
        let high = rng.random_range(-1e3..1e3);
        let states = [0.0, 1.0].map(|time| State::new(time, high * unit, DVec3::ZERO));
        let plan = match round % 3 {
            0 => Trajectory::at_rest(high * unit),
            _ => Trajectory::from_states(&states),
        };
        let hitbox = Hitbox::sphere(1.0).unwrap();
        let body = Body::new(plan.unwrap()).with_hitbox(hitbox);
        let mut scene = Scene::new();
        scene.insert(body).unwrap();
        scene.insert(floor(normal)).unwrap();
        let margin = high - 1.0 + 1e-12 * high.abs();
        let query = Query::new(Window::new(0.0, 1.0).unwrap()).with_margin(margin);
        let found = scene.screen(&query).unwrap().conflicts;
        assert_eq!(found.len(), 1, "{round} {high} {normal}");
        let monitor = Monitor::new(scene, 0.0, 1.0, &[AlertLevel::at(margin)]);
        let mut monitor = monitor.unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        assert_eq!(
            monitor.conflicts(0).unwrap().len(),
            1,
            "{round} {high} {normal}"
        );
    }
}

/// The height of a point that is a rounding below the plane is formed as 0. The point is within a margin of half that depth
/// below 0.
#[test]
fn points_that_rounding_lifts_to_the_plane_touch_it() {
    let normal = DVec3::new(0.6, 0.8, 0.0);
    let exact = |place: DVec3| {
        // Both products exactly; their sums have one rounding, of what is left.
        let product = |a: f64, b: f64| (a * b, a.mul_add(b, -(a * b)));
        let ((x, low_x), (y, low_y)) = (product(normal.x, place.x), product(normal.y, place.y));
        (x + y) + (low_x + low_y)
    };
    let (mut hidden, mut touching) = (0, 0);
    for step in 1..400 {
        let place = DVec3::new(4.0 * f64::from(step), -3.0 * f64::from(step), 0.0);
        let height = exact(place);
        if height >= 0.0 {
            continue;
        }
        hidden += 1;
        let point = Body::new(Trajectory::at_rest(place).unwrap());
        let query = Query::new(Window::new(0.0, 1.0).unwrap()).with_margin(0.5 * height);
        let bodies = [point, floor(normal)];
        for accuracy in [nearmiss::Accuracy::Exact, nearmiss::Accuracy::Certified] {
            let query = query.with_accuracy(accuracy);
            let found = pair::conflicts(&bodies[0], &bodies[1], &query).unwrap();
            touching += usize::from(!found.is_empty());
        }
    }
    assert!(hidden > 50, "{hidden}");
    assert_eq!(touching, 2 * hidden);
}

/// The coefficients of a plan cancel: each of its points is good to half a metre, as in the narrow phase.
#[test]
fn errors_of_plans_count() {
    let time = f64::from(1 << 30);
    let (t, window) = (DVec3::X * time, Window::new(time, time + 1.0).unwrap());
    let cube = [DVec3::X, -3.0 * t, 3.0 * t * time, -t * time * time];
    let plan = Trajectory::from_coefficients(&[time, time + 1.0], &[cube], TimeBase::Absolute);
    let rising = Body::new(plan.unwrap());
    let query = Query::new(window);
    for (height, count) in [(0.01, 1), (0.1, 1), (0.3, 1), (0.45, 1), (1.0, 0)] {
        let (mut ceiling, mut ground) = (floor(DVec3::NEG_X), floor(DVec3::X));
        let rest = Trajectory::at_rest((1.0 + height) * DVec3::X).unwrap();
        ceiling.trajectory = rest.clone();
        ground.trajectory = rising.trajectory.clone();
        for (plane, body) in [(ceiling, rising.clone()), (ground, Body::new(rest))] {
            let expected = pair::conflicts(&plane, &body, &query).unwrap();
            assert_eq!(expected.len(), count, "{height}");
            let (mut monitor, _) = watch(vec![plane, body], time, 1.0);
            monitor.advance(time, &mut Vec::new()).unwrap();
            assert_eq!(screened(monitor.scene(), time, time + 1.0), expected);
            assert_eq!(monitor.conflicts(0).unwrap(), expected);
        }
    }
}
