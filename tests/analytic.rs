//! Answers that can be worked out by hand: straight lines, circles, parallel flight, docking.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "exact cases are exact; a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::{
    Body, Conflict, Hitbox, Outside, Query, Scene, Sphere, State, TimeBase, Trajectory, Window,
};
use rand::RngExt;
use support::{line, screen};

/// A few roundings of numbers of size 10.
const CLOSE: f64 = 1e-13;

fn two(a: Trajectory, b: Trajectory) -> (Scene, nearmiss::BodyId, nearmiss::BodyId) {
    let mut scene = Scene::new();
    let a = scene.insert(Body::new(a)).unwrap();
    let b = scene.insert(Body::new(b)).unwrap();
    (scene, a, b)
}

fn conflicts(a: Trajectory, b: Trajectory, margin: f64) -> Vec<Conflict> {
    screen(&two(a, b).0, Window::ALL, margin)
}

#[test]
fn two_lines_pass() {
    // Relative motion (t - 5, 2, 0): within 2.5 m while |t - 5| <= 1.5.
    let a = line(0.0, 10.0, DVec3::new(-5.0, 2.0, 0.0), DVec3::X);
    let b = line(0.0, 10.0, DVec3::ZERO, DVec3::ZERO);
    let found = conflicts(a, b, 2.5);
    assert_eq!(found.len(), 1);
    assert!((found[0].enter - 3.5).abs() < CLOSE);
    assert!((found[0].exit - 6.5).abs() < CLOSE);
    assert!((found[0].closest.time - 5.0).abs() < CLOSE);
    assert!((found[0].closest.separation - 2.0).abs() < CLOSE);
    assert!((found[0].closest.relative_velocity - DVec3::X).length() < CLOSE);
    assert_eq!(found[0].clip.bits(), 0);
}

#[test]
fn radii_and_margin_add_up() {
    let a = line(0.0, 10.0, DVec3::new(-5.0, 2.0, 0.0), DVec3::X);
    let b = line(0.0, 10.0, DVec3::ZERO, DVec3::ZERO);
    let mut scene = Scene::new();
    for (trajectory, radius) in [(a, 1.0), (b, 2.0)] {
        let hitbox = Hitbox::sphere(radius).unwrap();
        scene
            .insert(Body::new(trajectory).with_hitbox(hitbox))
            .unwrap();
    }
    let found = screen(&scene, Window::ALL, -0.5);
    assert!((found[0].closest.separation + 1.0).abs() < CLOSE);
    assert!((found[0].exit - found[0].enter - 3.0).abs() < CLOSE);
    assert_eq!(screen(&scene, Window::ALL, -1.5), []);
}

#[test]
fn touching_at_one_instant_is_a_conflict() {
    let a = line(0.0, 10.0, DVec3::new(-5.0, 2.0, 0.0), DVec3::X);
    let b = line(0.0, 10.0, DVec3::ZERO, DVec3::ZERO);
    let found = conflicts(a, b, 2.0);
    assert_eq!(found.len(), 1);
    assert!(found[0].exit - found[0].enter < 1e-6);
    assert_eq!(found[0].closest.separation, 2.0);
}

#[test]
fn a_cubic_against_a_rest_point() {
    // x = t³ over -1..1 (Hermite from its own end states), y = 1: closest at t = 0, where the
    // squared distance t⁶ + 1 has a sixfold flat minimum.
    let a = Trajectory::from_states(&[
        State::new(-1.0, DVec3::new(-1.0, 1.0, 0.0), 3.0 * DVec3::X),
        State::new(1.0, DVec3::new(1.0, 1.0, 0.0), 3.0 * DVec3::X),
    ])
    .unwrap();
    let b = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let (scene, a, b) = two(a, b);
    let window = Window::new(-1.0, 1.0).unwrap();
    let closest = scene.closest_approach(a, b, window).unwrap().unwrap();
    assert_eq!(closest.separation, 1.0);
    // d = 1 + t⁶ equals 1 in f64 while |t| < 2e-3: no closer can be asked.
    assert!(closest.time.abs() < 5e-3);
    let found = screen(&scene, window, 0.125_f64.hypot(1.0));
    // |t|³ <= 1/8.
    assert!((found[0].enter + 0.5).abs() < 1e-12 && (found[0].exit - 0.5).abs() < 1e-12);
}

#[test]
fn docking_comes_to_rest_at_contact() {
    // x = 4 (1 - s)², s = t / 8: speed and distance vanish together at the end.
    let a = Trajectory::from_states(&[
        State::new(0.0, DVec3::new(4.0, 0.0, 0.0), -DVec3::X),
        State::new(8.0, DVec3::ZERO, DVec3::ZERO),
    ])
    .unwrap();
    let b = line(0.0, 20.0, DVec3::ZERO, DVec3::ZERO);
    let found = conflicts(a, b, 0.25);
    assert_eq!(found.len(), 1);
    // (1 - s)² = 1/16 at s = 3/4.
    assert!((found[0].enter - 6.0).abs() < 1e-12);
    assert_eq!(found[0].exit, 8.0);
    assert_eq!(found[0].closest.time, 8.0);
    assert_eq!(found[0].closest.separation, 0.0);
    assert_eq!(found[0].clip.bits(), 2);
}

#[test]
fn formation_flight_is_one_conflict_from_the_first_instant() {
    let offset = DVec3::new(0.0, 3.0, 4.0);
    let states: Vec<State> = (0..12)
        .map(|k| {
            let time = f64::from(k * k) * 0.25;
            let position = DVec3::new(time, f64::from(k % 3), f64::from(k % 2));
            State::new(time, position, DVec3::new(1.0, 0.5, -0.25))
        })
        .collect();
    let wing: Vec<State> = states
        .iter()
        .map(|state| State {
            position: state.position + offset,
            ..*state
        })
        .collect();
    let lead = Trajectory::from_states(&states).unwrap();
    let wing = Trajectory::from_states(&wing).unwrap();
    for (margin, count) in [(5.0, 1), (5.0 + 1e-9, 1), (5.0 - 1e-9, 0)] {
        let found = conflicts(lead.clone(), wing.clone(), margin);
        assert_eq!(found.len(), count, "margin {margin}");
        for conflict in found {
            assert_eq!(conflict.enter, 0.0);
            assert_eq!(conflict.exit, 121.0 * 0.25);
            assert_eq!(conflict.closest.time, 0.0);
            assert!((conflict.closest.separation - 5.0).abs() < CLOSE);
            assert_eq!(conflict.clip.bits(), 3);
        }
    }
}

#[test]
fn coincident_bodies_touch_throughout() {
    let wander = support::wander(&mut support::rng(3), 0.0, 20, 1.0, 50.0, 5.0);
    let twin = Trajectory::from_states(&wander).unwrap();
    let end = wander.last().unwrap().time;
    let found = conflicts(twin.clone(), twin, 0.0);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].enter, found[0].exit), (0.0, end));
    assert_eq!(found[0].closest.separation, 0.0);
    assert_eq!(found[0].closest.time, 0.0);
}

#[test]
fn bodies_at_rest() {
    let at = |x: f64| Trajectory::at_rest(DVec3::new(x, 0.0, 0.0)).unwrap();
    let window = Window::new(-1e6, 1e6).unwrap();
    let (scene, ..) = two(at(1.0), at(3.0));
    let found = screen(&scene, window, 2.0);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].enter, found[0].exit), (-1e6, 1e6));
    assert_eq!(found[0].closest.time, -1e6);
    assert_eq!(found[0].clip.bits(), 3);
    assert_eq!(screen(&scene, window, 1.999), []);
    // At an instant, that of their only knot included.
    for time in [-1.0, 0.0, 1.0] {
        let instant = Window::new(time, time).unwrap();
        let found = screen(&scene, instant, 2.0);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].enter, found[0].exit), (time, time));
        assert_eq!(screen(&scene, instant, 1.999), []);
    }
}

/// Where a body is that has coasted for centuries, and had to before: nothing of its motion may grow
/// faster than the way it covers, neither in its own answers nor in what is reported.
#[test]
fn straight_flight_stays_straight_for_centuries() {
    let (place, velocity) = (DVec3::new(0.3, 1.7, 2.9), DVec3::new(10.0 / 3.0, 7.1, -1.1));
    let state = State::new(0.7, place, velocity);
    let earlier = State::new(-0.6, place - 1.3 * velocity, velocity);
    let plan = Trajectory::from_states(&[earlier, state]).unwrap();
    for plan in [
        Trajectory::coasting(state).unwrap(),
        plan.with_outside(Outside::Coast),
    ] {
        for time in [-1e10, -1e6, -50.0, 0.7, 40.0, 1e4, 1e6, 1e8, 1e10] {
            let way = velocity * (time - 0.7);
            let close = 1e-15 * (way.length() + place.length());
            let found = plan.position(time).unwrap();
            assert!((found - (place + way)).length() <= close, "{time} {found}");
            assert!((plan.velocity(time).unwrap() - velocity).length() < 1e-14);
            let beside = Trajectory::at_rest(place + way + DVec3::X).unwrap();
            let (scene, ..) = two(plan.clone(), beside);
            let found = screen(&scene, Window::new(time - 1.0, time + 1.0).unwrap(), 2.0);
            let closest = found[0].closest;
            let way = velocity * (closest.time - 0.7);
            assert!((closest.position_a - (place + way)).length() <= 4.0 * close);
            assert!((closest.relative_velocity - velocity).length() < 1e-14);
        }
    }
}

/// From one state each, at different times, and before, between and after them.
#[test]
fn bodies_that_only_coast() {
    let coasting = |time: f64, position: DVec3, velocity: DVec3| {
        Trajectory::coasting(State::new(time, position, velocity)).unwrap()
    };
    for meeting in [-1e3, -3.0, 0.0, 2.0, 5.0, 60.0, 1e6] {
        let along = DVec3::new(1.0, 2.0, -2.0);
        let a = coasting(1.0, (1.0 - meeting) * along, along);
        let across = DVec3::new(0.0, 4.0, 4.0);
        // Abeam of both ways: that is how near they come.
        let abeam = 2.0 * along.cross(across).normalize();
        let b = coasting(4.0, abeam + (4.0 - meeting) * across, across);
        let (scene, ..) = two(a, b);
        let speed = (along - across).length();
        for window in [(meeting - 10.0, meeting + 10.0), (-2e6, 2e6)] {
            let found = screen(&scene, Window::new(window.0, window.1).unwrap(), 2.5);
            assert_eq!(found.len(), 1);
            // The square of the distance is 4 + speed² t².
            let half = (2.5_f64 * 2.5 - 4.0).sqrt() / speed;
            // Good to some roundings of the ways that are covered in 6 s, or in the time to the meeting.
            let close = 1e-14 * 10.0 * meeting.abs().max(12.0);
            assert!((found[0].closest.separation - 2.0).abs() < close);
            assert!((found[0].closest.time - meeting).abs() < close);
            assert!((found[0].enter - (meeting - half)).abs() < close);
            assert!((found[0].exit - (meeting + half)).abs() < close);
            let past = screen(
                &scene,
                Window::new(window.0, window.1).unwrap(),
                2.0 - close,
            );
            assert_eq!(past, []);
        }
        let before = Window::new(meeting - 30.0, meeting - 20.0).unwrap();
        assert_eq!(screen(&scene, before, 2.5), []);
    }
}

#[test]
fn a_minimum_on_a_shared_knot_is_found_once() {
    let knots = [0.0, 2.0, 5.0, 6.0, 9.0];
    let fly = |height: f64, speed: f64| {
        let states: Vec<State> = knots
            .iter()
            .map(|&time| {
                let position = DVec3::new(speed * (time - 5.0), height, 0.0);
                State::new(time, position, speed * DVec3::X)
            })
            .collect();
        Trajectory::from_states(&states).unwrap()
    };
    let found = conflicts(fly(0.0, 1.0), fly(0.5, -1.0), 1.0);
    assert_eq!(found.len(), 1);
    assert!((found[0].closest.time - 5.0).abs() < CLOSE);
    assert_eq!(found[0].closest.separation, 0.5);
}

#[test]
fn domains_that_share_one_instant() {
    let a = line(0.0, 5.0, DVec3::ZERO, DVec3::X);
    let b = line(5.0, 9.0, DVec3::new(5.0, 1.0, 0.0), -DVec3::X);
    let found = conflicts(a.clone(), b, 1.0);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].enter, found[0].exit), (5.0, 5.0));
    assert_eq!(found[0].clip.bits(), 3);
    assert_eq!(found[0].closest.separation, 1.0);
    let later = line(5.5, 9.0, DVec3::new(5.0, 0.0, 0.0), DVec3::ZERO);
    assert_eq!(conflicts(a, later, 1.0), []);
}

#[test]
fn beginning_and_ending_inside() {
    let a = line(0.0, 4.0, DVec3::ZERO, DVec3::X);
    let b = line(1.0, 9.0, DVec3::new(1.5, 0.0, 0.0), DVec3::X);
    let found = conflicts(a, b, 1.0);
    assert_eq!((found[0].enter, found[0].exit), (1.0, 4.0));
    assert_eq!(found[0].clip.bits(), 3);
}

#[test]
fn outside_its_knots_a_body_is_absent_coasts_or_goes_on() {
    let parabola = |outside| {
        Trajectory::from_states(&[
            State::new(0.0, DVec3::ZERO, DVec3::ZERO),
            State::new(1.0, DVec3::new(0.5, 0.0, 0.0), DVec3::X),
        ])
        .unwrap()
        .with_outside(outside)
    };
    let post = |x: f64| Trajectory::at_rest(DVec3::new(x, 0.0, 0.0)).unwrap();
    let window = Window::new(-100.0, 100.0).unwrap();
    let meet = |outside, x| {
        let (scene, ..) = two(parabola(outside), post(x));
        screen(&scene, window, 0.0)
    };
    assert_eq!(meet(Outside::Absent, 8.0), []);
    // Coast: x = t - 1/2 reaches 8 at 8.5; before its first knot it rests at 0.
    let coasting = meet(Outside::Coast, 8.0);
    assert_eq!(coasting.len(), 1);
    assert!((coasting[0].closest.time - 8.5).abs() < CLOSE);
    // Extrapolate: x = t²/2 is 8 at 4 and at -4.
    let going_on = meet(Outside::Extrapolate, 8.0);
    let times: Vec<f64> = going_on.iter().map(|found| found.closest.time).collect();
    assert_eq!(times.len(), 2);
    assert!((times[0] + 4.0).abs() < 1e-12 && (times[1] - 4.0).abs() < 1e-12);
}

#[test]
fn coefficients_over_absolute_and_local_time() {
    // x = (t - 1e5)³ - (t - 1e5), once in local and once in absolute time (all coefficients exact).
    let knots = [1e5 - 2.0, 1e5 + 2.0];
    let local = Trajectory::from_coefficients(
        &knots,
        &[[DVec3::X, -6.0 * DVec3::X, 11.0 * DVec3::X, -6.0 * DVec3::X]],
        TimeBase::SegmentLocal,
    )
    .unwrap();
    let absolute = Trajectory::from_coefficients(
        &knots,
        &[[
            DVec3::X,
            -3e5 * DVec3::X,
            (3e10 - 1.0) * DVec3::X,
            (-1e15 + 1e5) * DVec3::X,
        ]],
        TimeBase::Absolute,
    )
    .unwrap();
    for step in 0..=16 {
        let time = knots[0] + f64::from(step) * 0.25;
        let u = time - 1e5;
        let exact = u * u * u - u;
        for (name, trajectory) in [("local", &local), ("absolute", &absolute)] {
            let found = trajectory.position(time).unwrap().x;
            assert!((found - exact).abs() < CLOSE, "{name} at {u}: {found}");
        }
    }
}

#[test]
fn positions_only_follow_a_parabola_exactly() {
    let at = |t: f64| (t, DVec3::new(t * t, 2.0 * t, -t * t));
    let trajectory =
        Trajectory::from_positions(&[at(0.0), at(0.5), at(2.0), at(2.25), at(4.0)]).unwrap();
    for step in 0..=40 {
        let time = f64::from(step) * 0.1;
        let off = trajectory.position(time).unwrap() - at(time).1;
        assert!(off.length() < 1e-12, "{time}: {off}");
    }
}

/// Straight legs, exactly so and as cubics with the same velocities at both ends.
#[test]
fn legs_meet_as_cubics_do() {
    use nearmiss::{Accuracy, Keyframe};
    let mut rng = support::rng(31);
    let (mut legs, mut cubics) = (Scene::new(), Scene::new());
    for _ in 0..60 {
        let mut time = 0.0;
        let waypoints: Vec<(f64, DVec3)> = (0..8)
            .map(|_| {
                time += rng.random_range(0.5..4.0);
                (time, support::vector(&mut rng, 20.0))
            })
            .collect();
        let leg = |k: usize| {
            let ((from, p), (to, q)) = (waypoints[k], waypoints[k + 1]);
            (q - p) / (to - from)
        };
        let frame = |k: usize| {
            let (arrive, leave) = (leg(k.max(1) - 1), leg(k.min(6)));
            Keyframe::new(waypoints[k].0, arrive, waypoints[k].1, leave)
        };
        let frames: Vec<Keyframe> = (0..8).map(frame).collect();
        let hitbox = Hitbox::sphere(0.5).unwrap();
        for (scene, plan) in [
            (&mut legs, Trajectory::from_waypoints(&waypoints)),
            (&mut cubics, Trajectory::from_keyframes(&frames)),
        ] {
            let plan = plan.unwrap().with_outside(Outside::Coast);
            scene
                .insert(Body::new(plan).with_hitbox(hitbox.clone()))
                .unwrap();
        }
    }
    let query = Query::new(Window::new(0.0, 40.0).unwrap()).with_margin(1.0);
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let query = query.with_accuracy(accuracy);
        let [one, other] = [&legs, &cubics].map(|scene| scene.screen(&query).unwrap().conflicts);
        assert!(one.len() > 100, "{}", one.len());
        assert_eq!(one.len(), other.len());
        for (one, other) in one.iter().zip(&other) {
            assert_eq!((one.a, one.b), (other.a, other.b));
            assert!((one.enter - other.enter).abs() < 1e-9);
            assert!((one.exit - other.exit).abs() < 1e-9);
            assert!((one.closest.separation - other.closest.separation).abs() < 1e-12);
        }
    }
}

#[test]
fn the_spheres_that_meet_are_named() {
    let sphere = |x: f64, radius: f64| Sphere {
        offset: DVec3::new(x, 0.0, 0.0),
        radius,
    };
    let rod = Hitbox::cluster(vec![sphere(-2.0, 0.5), sphere(0.0, 0.5), sphere(2.0, 0.5)]).unwrap();
    let mut scene = Scene::new();
    let a = line(0.0, 10.0, DVec3::ZERO, DVec3::ZERO);
    let b = line(0.0, 10.0, DVec3::new(2.25, -5.0, 0.0), DVec3::Y);
    let post = Hitbox::cluster(vec![sphere(3.0, 0.25), sphere(0.0, 0.25)]).unwrap();
    scene.insert(Body::new(a).with_hitbox(rod)).unwrap();
    scene.insert(Body::new(b).with_hitbox(post)).unwrap();
    let found = screen(&scene, Window::ALL, 0.0);
    assert_eq!(found.len(), 1);
    assert_eq!(
        (found[0].closest.sphere_a, found[0].closest.sphere_b),
        (2, 1)
    );
    assert!((found[0].closest.separation + 0.5).abs() < CLOSE);
    // Surfaces meet while |t - 5|² + 1/16 <= 9/16.
    assert!((found[0].enter - (5.0 - 0.5_f64.sqrt())).abs() < CLOSE);
}

#[test]
fn layers_and_ignored_pairs() {
    use nearmiss::Layers;
    let mut scene = Scene::new();
    let ids: Vec<_> = [
        Layers::ALL,
        Layers::new(1, 2),
        Layers::new(2, 1),
        Layers::new(2, 2),
    ]
    .into_iter()
    .map(|layers| {
        let rest = line(0.0, 1.0, DVec3::ZERO, DVec3::ZERO);
        scene.insert(Body::new(rest).with_layers(layers)).unwrap()
    })
    .collect();
    let pairs = |scene: &Scene| -> Vec<(u32, u32)> {
        let query = Query::default();
        let found = scene.screen(&query).unwrap().conflicts;
        found.iter().map(|c| (c.a.slot(), c.b.slot())).collect()
    };
    assert_eq!(pairs(&scene), [(0, 1), (0, 2), (0, 3), (1, 2)]);
    scene.ignore_pair(ids[2], ids[0]).unwrap();
    assert_eq!(pairs(&scene), [(0, 1), (0, 3), (1, 2)]);
    scene.unignore_pair(ids[0], ids[2]).unwrap();
    assert_eq!(pairs(&scene).len(), 4);
}
