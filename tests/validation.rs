//! Every error says what is wrong and where, and leaves the scene as it was.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, Error, Hitbox, Monitor, Orientation, Outside, Quantity, Query,
    RevisionThreshold, Scene, Sphere, State, TimeBase, Trajectory, Window,
};

fn state(time: f64, x: f64) -> State {
    State::new(time, DVec3::new(x, 0.0, 0.0), DVec3::ZERO)
}

#[test]
fn states() {
    let build = |states: &[State]| Trajectory::from_states(states).unwrap_err();
    assert_eq!(build(&[]), Error::TooFewStates { count: 0 });
    assert_eq!(build(&[state(0.0, 0.0)]), Error::TooFewStates { count: 1 });
    assert_eq!(
        build(&[state(0.0, 0.0), state(2.0, 0.0), state(2.0, 1.0)]),
        Error::TimeNotIncreasing {
            knot: 2,
            previous: 2.0,
            time: 2.0
        }
    );
    let mut nan = state(1.0, 0.0);
    nan.velocity.z = f64::NAN;
    assert!(matches!(
        build(&[state(0.0, 0.0), nan]),
        Error::NotFinite { knot: 1, quantity: Quantity::Velocity(2), value } if value.is_nan()
    ));
    assert_eq!(
        build(&[state(f64::NEG_INFINITY, 0.0), state(0.0, 0.0)]),
        Error::NotFinite {
            knot: 0,
            quantity: Quantity::Time,
            value: f64::NEG_INFINITY
        }
    );
    assert_eq!(
        build(&[state(0.0, 0.0), state(1.0, -1.1e300)]),
        Error::OutOfRange {
            knot: 1,
            quantity: Quantity::Position(0),
            value: -1.1e300
        }
    );
    // 1e200 m in 1e-100 s: the numbers are in range, the motion is not.
    assert!(matches!(
        build(&[state(0.0, 0.0), state(1e-100, 1e200)]),
        Error::OutOfRange { knot: 1, .. }
    ));
}

#[test]
fn positions_and_coefficients() {
    assert_eq!(
        Trajectory::from_positions(&[(0.0, DVec3::ZERO)]).unwrap_err(),
        Error::TooFewStates { count: 1 }
    );
    let coefficients = |knots: &[f64], polynomials: &[[DVec3; 4]]| {
        Trajectory::from_coefficients(knots, polynomials, TimeBase::Absolute).unwrap_err()
    };
    let rest = [DVec3::ZERO; 4];
    assert_eq!(coefficients(&[0.0], &[]), Error::TooFewStates { count: 1 });
    assert_eq!(
        coefficients(&[0.0, 1.0, 2.0], &[rest]),
        Error::SegmentCount {
            knots: 3,
            segments: 1
        }
    );
    assert!(matches!(
        coefficients(&[1.0, 0.0], &[rest]),
        Error::TimeNotIncreasing { knot: 1, .. }
    ));
    let mut broken = rest;
    broken[1].y = f64::INFINITY;
    assert_eq!(
        coefficients(&[0.0, 1.0, 2.0], &[rest, broken]),
        Error::NotFinite {
            knot: 1,
            quantity: Quantity::Coefficient { power: 2, axis: 1 },
            value: f64::INFINITY
        }
    );
    assert!(matches!(
        Trajectory::at_rest(DVec3::new(0.0, f64::NAN, 0.0)),
        Err(Error::NotFinite { knot: 0, .. })
    ));
    let nowhere = State::new(1.0, DVec3::ONE, DVec3::new(0.0, 0.0, f64::NEG_INFINITY));
    assert_eq!(
        Trajectory::coasting(nowhere),
        Err(Error::NotFinite {
            knot: 0,
            quantity: Quantity::Velocity(2),
            value: f64::NEG_INFINITY
        })
    );
}

#[test]
fn rows() {
    let rows = |rows: Vec<(u64, State)>| Trajectory::group_rows(rows).unwrap_err();
    assert_eq!(
        rows(vec![
            (7, state(0.0, 0.0)),
            (7, state(1.0, 0.0)),
            (8, state(0.0, 0.0)),
            (8, state(1.0, 0.0)),
            (7, state(2.0, 0.0)),
        ]),
        Error::RowsApart { row: 4 }.in_body(7)
    );
    // In the order of time, bodies in turns.
    assert_eq!(
        rows(vec![
            (7, state(0.0, 0.0)),
            (8, state(0.0, 0.0)),
            (9, state(0.0, 0.0)),
            (7, state(1.0, 0.0)),
            (8, state(1.0, 0.0)),
        ]),
        Error::RowsApart { row: 3 }.in_body(7)
    );
    assert_eq!(
        rows(vec![
            (7, state(0.0, 0.0)),
            (8, state(0.0, 0.0)),
            (8, state(1.0, 0.0)),
        ]),
        Error::TooFewStates { count: 1 }.in_body(7)
    );
    assert_eq!(
        rows(vec![(1, state(1.0, 0.0)), (1, state(0.0, 0.0))]),
        Error::TimeNotIncreasing {
            knot: 1,
            previous: 1.0,
            time: 0.0
        }
        .in_body(1)
    );
    assert_eq!(
        rows(vec![(1, state(1.0, 0.0)), (2, state(0.0, 0.0))]),
        Error::TooFewStates { count: 1 }.in_body(1)
    );
    assert_eq!(Trajectory::group_rows([]).unwrap(), []);
}

#[test]
fn messages_name_place_and_value() {
    let error = Error::NotFinite {
        knot: 3,
        quantity: Quantity::Position(1),
        value: f64::NAN,
    };
    assert_eq!(
        error.in_body(12).to_string(),
        "body 12: knot 3: position y is NaN, not a finite number"
    );
}

#[test]
fn windows_and_margins() {
    assert!(matches!(
        Window::new(2.0, 1.0),
        Err(Error::Window { start, end }) if start > end
    ));
    assert!(Window::new(f64::NAN, 1.0).is_err());
    assert!(Window::new(f64::INFINITY, f64::INFINITY).is_err());
    assert!(Window::new(1.0, 1.0).is_ok());
    // A query takes any margin; a screening checks it first of all, with or without bodies.
    let scene = support::scene_of(&support::swarm(1, 3, 20.0));
    for margin in [f64::NAN, f64::INFINITY, -1e301] {
        for scene in [&scene, &Scene::new()] {
            let refused = scene.screen(&Query::default().with_margin(margin));
            let bits = margin.to_bits();
            assert!(matches!(refused, Err(Error::Margin { margin }) if margin.to_bits() == bits));
        }
    }
}

/// A cubic that would have to be followed over too many of its lengths is no part of a plan: not
/// before a splice, nor after it, nor in a window.
#[test]
fn splices_along_too_short_a_carrier() {
    let line = |start: f64, duration: f64| {
        let states =
            [0.0, duration].map(|time| State::new(start + time, DVec3::X * (1.0 + time), DVec3::X));
        Trajectory::from_states(&states).unwrap()
    };
    let long = line(0.0, 20.0);
    for duration in [5e-324, 1e-299, 1e-160, 1e-101] {
        let short = line(0.0, duration).with_outside(Outside::Coast);
        let error = short.spliced(10.0, &long).unwrap_err();
        assert!(matches!(error, Error::TooFar { knot: 1, .. }), "{error}");
        let error = line(-30.0, 10.0)
            .with_outside(Outside::Coast)
            .spliced(-10.0, &short)
            .unwrap_err();
        assert!(matches!(error, Error::TooFar { knot: 0, .. }), "{error}");
    }
    for duration in [1e-98, 1e-10] {
        let short = line(0.0, duration).with_outside(Outside::Coast);
        let mut scene = Scene::new();
        scene
            .insert(Body::new(short.spliced(10.0, &long).unwrap()))
            .unwrap();
        let rest = Trajectory::at_rest(5.0 * DVec3::X).unwrap();
        scene.insert(Body::new(rest)).unwrap();
        let query = Query::new(Window::new(0.0, 10.0).unwrap()).with_margin(1.0);
        let found = scene.screen(&query).unwrap().conflicts;
        assert_eq!(found.len(), 1);
        assert!((found[0].enter - 3.0).abs() < 1e-9 && (found[0].exit - 5.0).abs() < 1e-9);
    }
}

#[test]
fn hitboxes() {
    for radius in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            Hitbox::sphere(radius),
            Err(Error::Radius { sphere: 0, .. })
        ));
    }
    assert_eq!(Hitbox::cluster(vec![]).unwrap_err(), Error::EmptyCluster);
    let good = Sphere::default();
    for far in [f64::INFINITY, f64::NAN] {
        let bad = Sphere::new([0.0, far, 0.0], 1.0);
        assert!(matches!(
            Hitbox::cluster(vec![good, bad]),
            Err(Error::Offset { sphere: 1, value }) if value.to_bits() == far.to_bits()
        ));
    }
}

#[test]
fn a_failed_call_leaves_the_scene_as_it_was() {
    let mut scene = support::scene_of(&support::swarm(1, 6, 20.0));
    let before = support::bits(&support::screen(&scene, Window::ALL, 5.0));
    let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
    let removed = scene.remove(ids[5]).unwrap();
    let gone = ids[5];
    assert_eq!(
        scene.remove(gone).unwrap_err(),
        Error::UnknownBody { id: gone }
    );
    assert!(scene.body(gone).is_none());
    let trajectory = removed.trajectory.clone();
    assert_eq!(
        scene.set_trajectory(gone, trajectory).unwrap_err(),
        Error::UnknownBody { id: gone }
    );
    assert!(scene.set_hitbox(gone, Hitbox::POINT).is_err());
    assert!(scene.set_layers(gone, nearmiss::Layers::NONE).is_err());
    assert!(scene.ignore_pair(ids[0], gone).is_err());
    assert_eq!(
        scene.ignore_pair(ids[0], ids[0]).unwrap_err(),
        Error::SameBody { id: ids[0] }
    );
    assert!(scene.closest_approach(ids[0], gone, Window::ALL).is_err());
    // A reused slot is another body: the old id stays invalid.
    let new = scene.insert(removed).unwrap();
    assert_eq!(new.slot(), gone.slot());
    assert!(scene.body(gone).is_none());
    assert_eq!(
        support::bits(&support::screen(&scene, Window::ALL, 5.0)),
        before
    );
}

#[test]
fn endless_bodies_need_a_closed_window() {
    let mut scene = Scene::new();
    let plan = support::line(0.0, 1.0, DVec3::ZERO, DVec3::X).with_outside(Outside::Coast);
    let body = Body::new(plan).with_tag(77);
    let id = scene.insert(body.clone()).unwrap();
    let closed = Query::new(Window::new(0.0, 1e9).unwrap());
    assert!(scene.screen(&closed).is_ok());
    for window in [Window::ALL, Window::new(0.0, f64::INFINITY).unwrap()] {
        let query = Query::new(window);
        let refused = scene.screen(&query).unwrap_err();
        let id = Some(id);
        assert_eq!(refused, Error::WindowNotClosed { body: 77, id });
        assert!(
            refused
                .to_string()
                .starts_with("body 0v0 (tag 77) exists beyond its knots")
        );
        // Of two bodies the one in the scene has an id, the one asked about has none.
        let resting = Body::new(support::line(0.0, 1.0, DVec3::ZERO, DVec3::X));
        assert_eq!(scene.conflicts_with(&resting, &query).unwrap_err(), refused);
        let asked = Scene::new().conflicts_with(&body, &query).unwrap_err();
        assert_eq!(asked, Error::WindowNotClosed { body: 77, id: None });
    }
}

#[test]
fn an_extrapolation_out_of_range_is_an_error() {
    let mut scene = Scene::new();
    let plan = Trajectory::from_states(&[
        State::new(0.0, DVec3::ZERO, DVec3::X),
        State::new(1.0, DVec3::ZERO, DVec3::X),
    ])
    .unwrap()
    .with_outside(Outside::Extrapolate);
    scene.insert(Body::new(plan).with_tag(5)).unwrap();
    let far = Query::new(Window::new(0.0, 1e120).unwrap());
    assert!(matches!(
        scene.screen(&far).unwrap_err(),
        Error::InBody { body: 5, error, .. } if matches!(*error, Error::OutOfRange { .. })
    ));
}

/// What a monitor is to keep to, a clock, and levels: refused by name, and nothing has changed.
#[test]
fn what_a_monitor_refuses() {
    let line = |start: f64| {
        let states = [0.0, 10.0].map(|t| State::new(start + t, DVec3::X * t, DVec3::X));
        Trajectory::from_states(&states).unwrap()
    };
    let mut scene = Scene::new();
    let id = scene.insert(Body::new(line(0.0)).with_tag(7)).unwrap();
    let levels = [AlertLevel::at(1.0)];
    for now in [f64::NAN, f64::INFINITY, 1.1e300] {
        let refused = Monitor::new(scene.clone(), now, 1.0, &levels).unwrap_err();
        assert!(matches!(refused, Error::Clock { .. }), "{refused}");
    }
    for lookahead in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let refused = Monitor::new(scene.clone(), 0.0, lookahead, &levels).unwrap_err();
        assert!(matches!(refused, Error::Lookahead { .. }), "{refused}");
    }
    let refused = Monitor::new(scene.clone(), 0.0, 1.0, &[]).unwrap_err();
    assert_eq!(refused, Error::NoAlertLevel);

    let mut monitor = Monitor::new(scene, 0.0, 5.0, &levels).unwrap();
    for value in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        let least = |time, separation| {
            RevisionThreshold::default()
                .with_time(time)
                .with_separation(separation)
        };
        for refused in [
            monitor.set_history(value),
            monitor.set_revision_threshold(least(value, 0.0)),
            monitor.set_revision_threshold(least(0.0, value)),
        ] {
            assert!(matches!(refused, Err(Error::Setting { .. })), "{value}");
        }
    }
    let default = RevisionThreshold::default();
    assert_eq!(
        (monitor.history(), monitor.revision_threshold()),
        (0.0, default)
    );
    monitor.set_history(f64::INFINITY).unwrap();

    monitor.advance(1.0, &mut Vec::new()).unwrap();
    let missing = Error::UnknownAlertLevel { level: 1 };
    assert_eq!(monitor.what_if(id, &line(0.0), 1).unwrap_err(), missing);
    assert_eq!(monitor.conflicts(1).unwrap_err(), missing);
    assert_eq!(monitor.conflicts_of(id, 1).err(), Some(missing.clone()));
    assert_eq!(monitor.next_conflict(id, 1).unwrap_err(), missing);
    assert_eq!(monitor.conflicts(0), Ok(&[][..]));
    // One that is gone is not one that meets nobody.
    let gone = monitor.insert(Body::new(line(90.0))).unwrap();
    monitor.remove(gone).unwrap();
    let unknown = Error::UnknownBody { id: gone };
    assert_eq!(monitor.conflicts_of(gone, 0).err(), Some(unknown.clone()));
    assert_eq!(monitor.next_conflict(gone, 0).unwrap_err(), unknown);
    // Over, or not begun: no plan to follow from now on, as a replan would say.
    for start in [-20.0, 1.5] {
        let refused = monitor.what_if(id, &line(start), 0).unwrap_err();
        assert_eq!(
            refused,
            Error::NoNewPlan {
                time: 1.0,
                start,
                end: start + 10.0,
            }
            .in_body(7)
            .with_id(id)
        );
        let replanned = monitor.replan(id, 1.0, line(start)).unwrap_err();
        assert_eq!(replanned, refused);
    }
    assert_eq!(monitor.what_if(id, &line(0.5), 0).unwrap(), []);
    // Also where the lookahead could be told apart.
    let mut far = Monitor::new(Scene::new(), 0.0, 1e300, &levels).unwrap();
    for now in [f64::NAN, 1.1e300, f64::MAX, f64::INFINITY] {
        let refused = far.advance(now, &mut Vec::new()).unwrap_err();
        assert!(matches!(refused, Error::Clock { .. }), "{now} {refused}");
    }
    far.advance(1e300, &mut Vec::new()).unwrap();
    let text = Error::Margin { margin: 1e301 }.to_string();
    assert_eq!(text, "margin 1e301 m is not a number within ±1e300");
}

/// A velocity that nobody gave is not blamed.
#[test]
fn positions_too_far_apart_are_refused() {
    let far = DVec3::X * 1e200;
    for positions in [
        &[(0.0, DVec3::ZERO), (1e-200, far)][..],
        &[(0.0, DVec3::ZERO), (1e-200, far), (1.0, far)],
    ] {
        let refused = Trajectory::from_positions(positions).unwrap_err();
        assert!(
            matches!(
                refused,
                Error::OutOfRange {
                    quantity: Quantity::Speed,
                    ..
                }
            ),
            "{refused}"
        );
    }
}

/// Those of the scene, also where the window meets none of them.
#[test]
fn all_bodies_are_counted() {
    let mut scene = Scene::new();
    for place in 0..20 {
        let plan = support::line(0.0, 1.0, DVec3::X * f64::from(place), DVec3::X);
        scene.insert(Body::new(plan)).unwrap();
    }
    let late = Query::new(Window::new(5.0, 9.0).unwrap());
    assert_eq!(scene.screen(&late).unwrap().stats.bodies, 20);
}

/// A value that has left the range of f64 is named as infinite, not as NaN or as that of another axis.
#[test]
fn what_leaves_the_range_is_named() {
    let large = 1e100;
    for axes in [DVec3::X, DVec3::Y, DVec3::ONE] {
        let cubic = [DVec3::ZERO, large * axes, DVec3::ZERO, DVec3::ZERO];
        for base in [TimeBase::Absolute, TimeBase::SegmentLocal] {
            assert_eq!(
                Trajectory::from_coefficients(&[0.0, 1e150], &[cubic], base),
                Err(Error::OutOfRange {
                    knot: 0,
                    quantity: Quantity::Distance,
                    value: f64::INFINITY
                })
            );
        }
    }
    let turns = [0.0, 1e-320].map(|time| (time, DQuat::IDENTITY));
    for refused in [
        Orientation::slerp(&turns),
        Orientation::normalized_cubic(&turns),
    ] {
        assert_eq!(
            refused,
            Err(Error::OutOfRange {
                knot: 1,
                quantity: Quantity::AngularSpeed,
                value: f64::INFINITY
            })
        );
    }
}
