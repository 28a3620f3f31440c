//! Contacts of several spheres, or before and after a jump: which of them are one conflict.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "exact cases are exact; a body that cannot be built fails the test"
)]

use glam::DVec3;
use nearmiss::{Body, Hitbox, Query, Sphere, State, Trajectory, Window, pair};

/// A few roundings of numbers of size 10.
const CLOSE: f64 = 1e-13;

/// A point flies along the axis of two spheres that touch: it is in one of them, or on it, all the way. The instant at which
/// it goes from one to the other is rounded twice.
#[test]
fn one_sphere_takes_over_from_another() {
    let spheres = [0.15, -0.15].map(|z| Sphere::new([0.0, 0.0, z], 0.15));
    let rod = Hitbox::cluster(spheres.to_vec()).unwrap();
    let rod = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap()).with_hitbox(rod);
    let query = Query::new(Window::new(-10.0, 20.0).unwrap());
    for (height, speed) in [(4.25, 1.75), (3.5, 1.25), (4.75, 0.75), (2.25, 0.5)] {
        let state = State::new(0.0, [0.0, 0.0, height], [0.0, 0.0, -speed]);
        let point = Body::new(Trajectory::coasting(state).unwrap());
        let found = pair::conflicts(&point, &rod, &query).unwrap();
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].enter - (height - 0.3) / speed).abs() < CLOSE);
        assert!((found[0].exit - (height + 0.3) / speed).abs() < CLOSE);
    }
}

/// Two points pass another one in turn. Between them, three instants of Unix time, it is farther away than the margin.
#[test]
fn conflicts_that_are_instants_apart_are_two() {
    const NOW: f64 = 1.7e9;
    let tips = [-0.005, 0.005].map(|x| Sphere::new([x, 0.0, 0.0], 0.0));
    let flown = State::new(NOW, DVec3::ZERO, 1e4 * DVec3::X);
    let flown = Body::new(Trajectory::coasting(flown).unwrap());
    let flown = flown.with_hitbox(Hitbox::cluster(tips.to_vec()).unwrap());
    let rest = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
    for (from, expected) in [(NOW - 1.0, 2), (NOW, 1)] {
        let query = Query::new(Window::new(from, NOW + 1.0).unwrap()).with_margin(1e-3);
        let found = pair::conflicts(&rest, &flown, &query).unwrap();
        assert_eq!(found.len(), expected, "{found:?}");
        assert!(found.iter().all(|one| one.clip.bits() == 0), "{found:?}");
        let gap = found[0].exit.next_up()..found[expected - 1].enter;
        assert!(expected == 1 || gap.contains(&NOW), "{found:?}");
    }
}

/// However long a body rests after its return.
#[test]
fn a_body_that_comes_back_to_rest_is_in_conflict_twice() {
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let away = Trajectory::coasting(State::new(0.0, DVec3::ZERO, 4.0 * DVec3::X)).unwrap();
    let away = Body::new(away.spliced(2.0, &rest).unwrap());
    let query = Query::new(Window::new(0.0, 10.0).unwrap()).with_margin(1.0);
    let found = pair::conflicts(&away, &Body::new(rest), &query).unwrap();
    let times: Vec<_> = found.iter().map(|one| (one.enter, one.exit)).collect();
    assert_eq!(times, [(0.0, 0.25), (2.0, 10.0)]);
}
