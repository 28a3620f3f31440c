//! Worlds of odd shapes: very different sizes, places, lives and speeds take nothing away.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::internals::QueryInternals;
use nearmiss::{
    AlertLevel, Body, Error, Hitbox, Layers, Monitor, Outside, Query, Scene, Screening, State,
    TimeBase, Trajectory, Window,
};
use std::num::NonZeroU32;
use support::{bits, exceeded, rng, vector, with_every_change};

fn line(from: DVec3, to: DVec3) -> Trajectory {
    let states = [(0.0, from), (1.0, to)].map(|(time, place)| State::new(time, place, to - from));
    Trajectory::from_states(&states).unwrap()
}

fn slices(count: u32) -> Query {
    Query::default().with_slices(NonZeroU32::new(count).unwrap())
}

/// Two bodies that meet, within a world that others make larger and larger.
#[test]
fn a_larger_world_around_hides_nothing() {
    let length = 1e20;
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0) * length;
    for far in [1e20, 1e30, 1e44, 1e45, 1e46, 1e60, 1e200, 1e297] {
        let mut scene = Scene::new();
        let mut put = |trajectory: Trajectory| {
            let hitbox = Hitbox::sphere(1.0).unwrap();
            scene
                .insert(Body::new(trajectory).with_hitbox(hitbox))
                .unwrap();
        };
        put(line(at(-1.0, 0.0), at(1.0, 0.0)));
        put(line(at(1.0, -2.0), at(1.0, 0.0)));
        for side in [-1.0, 1.0] {
            let place = |y: f64| DVec3::new(5.0 * side, y, 0.0) * far;
            put(line(place(5.0), place(-5.0)));
        }
        let found = scene.screen(&Query::default()).unwrap().conflicts;
        assert_eq!(found.len(), 1, "{far}");
        assert_eq!(found[0].exit.to_bits(), 1.0_f64.to_bits());
    }
}

/// Bodies that are far away, parked or at rest, make nothing coarse for all others: neither where they
/// are part of no pair, nor where they are gone before the window begins, nor even as they are.
#[test]
fn what_is_parked_far_away_costs_the_others_nothing() {
    let mut rng = rng(3);
    let mut flights = Vec::new();
    for _ in 0..1_000 {
        let from = vector(&mut rng, 40.0);
        flights.push(line(from, from + vector(&mut rng, 4.0)));
    }
    let far = |distance: f64| Trajectory::at_rest(DVec3::new(1.0, -2.0, 0.5) * distance).unwrap();
    let gone = |distance: f64| {
        let states = [-9.0, -8.0].map(|t| State::new(t, DVec3::Y * distance, DVec3::ZERO));
        Trajectory::from_states(&states).unwrap()
    };
    let window = Window::new(0.0, 1.0).unwrap();
    let query = Query::new(window).with_margin(1.0);
    let run = |others: &[(Trajectory, Layers)]| {
        let mut scene = Scene::new();
        for flight in &flights {
            scene.insert(Body::new(flight.clone())).unwrap();
        }
        for (plan, layers) in others {
            let body = Body::new(plan.clone()).with_layers(*layers);
            scene.insert(body).unwrap();
        }
        let screening = scene.screen(&query).unwrap();
        let mut monitor =
            with_every_change(Monitor::new(scene, 0.0, 1.0, &[AlertLevel::at(1.0)]).unwrap());
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        let counts = [screening.stats.candidates, monitor.stats().candidates];
        assert_eq!(
            bits(monitor.conflicts(0).unwrap()),
            bits(&screening.conflicts)
        );
        (screening.conflicts, counts)
    };
    let (alone, counts) = run(&[]);
    assert!(alone.len() > 10, "{}", alone.len());
    // Boxes of bodies beyond the range of f32 meet all others.
    let ranges = [
        (1e7, 500),
        (1e10, 500),
        (1e20, 500),
        (1e45, 12_000),
        (1e290, 12_000),
    ];
    for (distance, more) in ranges {
        for others in [
            vec![(far(distance), Layers::NONE)],
            vec![(far(distance), Layers::ALL)],
            vec![(gone(distance), Layers::ALL); 300],
            vec![(far(distance), Layers::NONE); 3_000],
            vec![
                (far(distance), Layers::ALL),
                (far(-0.3 * distance), Layers::ALL),
            ],
        ] {
            let (found, with_others) = run(&others);
            assert_eq!(bits(&found), bits(&alone));
            for (count, with_others) in counts.into_iter().zip(with_others) {
                assert!(
                    with_others <= 2 * count + more,
                    "{distance}: {count} {with_others}"
                );
            }
        }
    }
}

/// The time in which nobody else exists is not cut into slices for a body that is part of no pair.
#[test]
fn a_long_life_apart_from_all_pairs_adds_no_time() {
    let mut rng = rng(4);
    let mut scene = Scene::new();
    for _ in 0..500 {
        let from = vector(&mut rng, 30.0);
        let plan = line(from, from + vector(&mut rng, 30.0));
        scene.insert(Body::new(plan)).unwrap();
    }
    let query = Query::default().with_margin(1.0);
    let alone = scene.screen(&query).unwrap();
    let (found, slices) = (alone.conflicts.len(), alone.stats.slices);
    assert!(found > 10 && slices > 1, "{found} {slices}");
    let states = [0.0, 1e9].map(|time| State::new(time, DVec3::X * time, DVec3::X));
    let long = Body::new(Trajectory::from_states(&states).unwrap());
    scene.insert(long.with_layers(Layers::NONE)).unwrap();
    let beside = scene.screen(&query).unwrap();
    assert_eq!(bits(&beside.conflicts), bits(&alone.conflicts));
    assert_eq!(beside.stats.slices, alone.stats.slices);
    assert_eq!(beside.stats.boxes, alone.stats.boxes);
}

/// Motions that the resolution of their own coordinates hides, down to the smallest numbers: cut
/// into many slices they meet as they do in one.
#[test]
fn motions_below_the_resolution_of_their_place() {
    let place = DVec3::splat(1000.0);
    for step in 0..60 {
        let length = 1e-44 * 1.1_f64.powi(step);
        let mut scene = Scene::new();
        let bounce = |first: f64, last: f64, speed: f64| {
            let velocity = DVec3::X * (speed * length);
            let states = [(first, velocity), (last, -velocity)];
            Trajectory::from_states(&states.map(|(time, v)| State::new(time, place, v))).unwrap()
        };
        scene.insert(Body::new(bounce(0.0, 1.0, 3.0))).unwrap();
        scene.insert(Body::new(bounce(0.9, 2.0, 30.0))).unwrap();
        // The unit of boxes is that of the hitbox.
        let hitbox = Hitbox::sphere(1e-12).unwrap();
        let later = Body::new(bounce(5.0, 6.0, 0.0)).with_hitbox(hitbox);
        scene.insert(later).unwrap();
        let one = scene.screen(&slices(1)).unwrap().conflicts;
        let many = scene.screen(&slices(5_000)).unwrap().conflicts;
        assert!(!one.is_empty());
        assert_eq!(bits(&one), bits(&many), "{length:e}");
    }
}

/// A body at rest is at rest however long it is looked at, as far as numbers reach.
#[test]
fn rest_for_ever() {
    let screen = |end: f64, margin: f64| {
        let mut scene = Scene::new();
        for x in [0.0, 1.0] {
            let rest = Trajectory::at_rest(DVec3::X * x).unwrap();
            scene.insert(Body::new(rest)).unwrap();
        }
        let query = Query::new(Window::new(-end, end).unwrap());
        scene.screen(&query.with_margin(margin))
    };
    for end in [1e10, 1e99, 1e150, 1e290, 1e300] {
        assert_eq!(screen(end, 1.0).unwrap().conflicts.len(), 1, "{end}");
        assert_eq!(screen(end, 0.5).unwrap().conflicts, []);
    }
    for end in [1e303, f64::MAX] {
        let Err(Error::InBody { error, .. }) = screen(end, 1.0) else {
            panic!("{end} s are beyond the range");
        };
        assert!(matches!(*error, Error::TooFar { time, .. } if time.abs() >= end));
    }
}

/// Parallel straight flights, a hundred metres apart: however long they go on, and however they were
/// given, their boxes stay apart.
#[test]
fn coasting_is_as_straight_from_coefficients() {
    let velocity = DVec3::X * 10.0;
    let from_states = |place: DVec3| {
        let states = [0.0, 1.0].map(|time| State::new(time, place + velocity * time, velocity));
        Trajectory::from_states(&states)
    };
    let from_coefficients = |place: DVec3| {
        let cubic = [[DVec3::ZERO, DVec3::ZERO, velocity, place]];
        Trajectory::from_coefficients(&[0.0, 1.0], &cubic, TimeBase::SegmentLocal)
    };
    let candidates = |make: &dyn Fn(DVec3) -> Result<Trajectory, Error>| {
        let mut scene = Scene::new();
        for k in 0..100_u32 {
            let plan = make(DVec3::Y * (100.0 * f64::from(k))).unwrap();
            let body = Body::new(plan.with_outside(Outside::Coast));
            scene
                .insert(body.with_hitbox(Hitbox::sphere(1.0).unwrap()))
                .unwrap();
        }
        let query = Query::new(Window::new(0.0, 1000.0).unwrap());
        let Screening {
            conflicts, stats, ..
        } = scene.screen(&query).unwrap();
        assert_eq!(conflicts, []);
        stats.candidates
    };
    assert_eq!(candidates(&from_states), 0);
    assert_eq!(candidates(&from_coefficients), 0);
}

/// A crowd that is there for an instant of a long window, where a sample of slices may hit it or not.
#[test]
fn a_short_crowd_is_refused_like_a_long_one() {
    let mut scene = Scene::new();
    for k in 0..3_000_u32 {
        let place = DVec3::X * (1e-3 * f64::from(k));
        let states = [5e5, 5e5 + 1e-3].map(|time| State::new(time, place, DVec3::ZERO));
        let hitbox = Hitbox::sphere(10.0).unwrap();
        let body = Body::new(Trajectory::from_states(&states).unwrap()).with_hitbox(hitbox);
        scene.insert(body).unwrap();
    }
    let ends = [0.0, 1e6].map(|time| State::new(time, DVec3::Z * 50.0, DVec3::ZERO));
    scene
        .insert(Body::new(Trajectory::from_states(&ends).unwrap()))
        .unwrap();
    let refused = scene.screen(&Query::default().with_max_spans(1_000));
    assert_eq!(exceeded(refused), Some(1_000));
}

/// A hundred flights of a few seconds in an hour and a half: slices that are mostly empty would be
/// all that there is to do.
#[test]
fn lonely_flights_are_not_sliced_finely() {
    let mut scene = Scene::new();
    for number in 0..100_u32 {
        let begin = 50.0 * f64::from(number * 37 % 100);
        let states: Vec<State> = (0..9)
            .map(|knot| {
                let time = begin + 0.3 * f64::from(knot);
                let place = DVec3::new(f64::from(number % 10), 10.0 * (time - begin), 0.0);
                State::new(time, place, DVec3::new(0.0, 10.0, 0.0))
            })
            .collect();
        scene
            .insert(Body::new(Trajectory::from_states(&states).unwrap()))
            .unwrap();
    }
    for count in [100, 3] {
        let ids: Vec<_> = scene.bodies().map(|(id, _)| id).skip(count).collect();
        for id in ids {
            scene.remove(id).unwrap();
        }
        let stats = scene.screen(&Query::default()).unwrap().stats;
        assert!(stats.slices <= 2 * stats.bodies, "{stats:?}");
    }
}

/// Dead reckoning: plans of a hundredth of a second, followed for an hour. What there is to cut is an
/// hour of straight flight, not 360,000 plans.
#[test]
fn short_plans_that_go_on_for_long() {
    let mut rng = rng(15);
    for outside in [Outside::Coast, Outside::Extrapolate] {
        let mut scene = Scene::new();
        for _ in 0..200 {
            let (place, velocity) = (vector(&mut rng, 1e5), vector(&mut rng, 30.0));
            let states = [0.0, 0.01].map(|t| State::new(t, place + velocity * t, velocity));
            let plan = Trajectory::from_states(&states).unwrap();
            scene.insert(Body::new(plan.with_outside(outside))).unwrap();
        }
        let query = Query::new(Window::new(0.0, 3600.0).unwrap());
        let query = query.with_margin(50.0);
        let found = scene.screen(&query).unwrap();
        let stats = found.stats;
        assert!(stats.slices < 1_000, "{stats:?}");
        // The rounding of a cubic grows with the third power of time: after 360,000 of its lengths
        // everybody may be anywhere.
        let most = match outside {
            Outside::Coast => 50_000,
            _ => 2_000_000,
        };
        assert!(stats.boxes + stats.candidates < most, "{stats:?}");
        let one = query.with_slices(NonZeroU32::MIN);
        assert_eq!(
            bits(&scene.screen(&one).unwrap().conflicts),
            bits(&found.conflicts)
        );
    }
}

/// Debris in one place, in a layer that ignores itself: a monitor does not list all its pairs.
#[test]
fn debris_that_ignores_itself() {
    let layers = Layers {
        membership: 2,
        filter: 1,
    };
    let mut scene = Scene::new();
    let rest = |x: f64| {
        let place = DVec3::new(x, 0.0, 0.0);
        let states = [0.0, 60.0].map(|time| State::new(time, place, DVec3::ZERO));
        Trajectory::from_states(&states).unwrap()
    };
    let mut ids = Vec::new();
    for number in 0..2_000 {
        let body = Body::new(rest(f64::from(number) * 1e-3)).with_layers(layers);
        ids.push(scene.insert(body).unwrap());
    }
    let mut monitor =
        with_every_change(Monitor::new(scene, 0.0, 3.0, &[AlertLevel::at(5.0)]).unwrap());
    let mut candidates = 0;
    // None, few, and many of them are replanned.
    for (tick, changed) in (0..100).zip([0, 20, 500].into_iter().cycle()) {
        let now = 0.1 * f64::from(tick);
        for &id in &ids[..changed] {
            monitor.replan(id, now, rest(0.5)).unwrap();
        }
        monitor.advance(now, &mut Vec::new()).unwrap();
        candidates += monitor.stats().candidates;
    }
    // There are two million pairs.
    assert!(candidates < 1_000_000, "{candidates}");
    assert!(monitor.conflicts(0).unwrap().is_empty());
}

/// All are in one place in the middle of a long window, and nowhere near each other before and after.
#[test]
fn a_meeting_in_the_midst_of_a_long_window() {
    let mut rng = rng(71);
    let mut scene = Scene::new();
    for _ in 0..1_000 {
        let state = State::new(0.0, vector(&mut rng, 200.0), vector(&mut rng, 10.0));
        scene
            .insert(Body::new(Trajectory::coasting(state).unwrap()))
            .unwrap();
    }
    let screen = |end: f64| {
        let query = Query::new(Window::new(-end, end).unwrap()).with_margin(2.0);
        scene.screen(&query).unwrap()
    };
    let expected = screen(1e4).conflicts;
    assert!(expected.len() > 5, "{}", expected.len());
    for end in [1e6, 1e7, 1e9] {
        let screening = screen(end);
        assert_eq!(bits(&screening.conflicts), bits(&expected), "{end}");
        let stats = screening.stats;
        assert!(stats.spans < 2_000, "{end} {stats}");
    }
}

/// Two spheres that overlap by kilometres, one of which hardly moves: f32 holds few digits of its
/// squared velocity.
#[test]
fn slow_giants_overlap() {
    for step in 0..200 {
        let velocity = DVec3::X * 1e-22 * 1.01_f64.powi(step);
        let place = DVec3::Y * 8.49e6;
        let mut scene = Scene::new();
        for flight in [line(DVec3::ZERO, velocity), line(place, place)] {
            let hitbox = Hitbox::sphere(4.25e6).unwrap();
            scene.insert(Body::new(flight).with_hitbox(hitbox)).unwrap();
        }
        let found = scene.screen(&Query::default()).unwrap().conflicts;
        assert_eq!(found.len(), 1, "{velocity}");
    }
}

/// One that stands still on each cubic, and jumps where the next one begins.
fn jumps(knots: &[f64], places: &[f64]) -> Trajectory {
    let cubics: Vec<_> = places
        .iter()
        .map(|&x| [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::X * x])
        .collect();
    Trajectory::from_coefficients(knots, &cubics, TimeBase::SegmentLocal).unwrap()
}

/// A body that jumps to and fro within less than the smallest normal number of seconds.
#[test]
fn jumps_in_no_time() {
    let mut knots: Vec<f64> = (0..4).map(|k| f64::from(k) * 1e-310).collect();
    knots.extend((0..4).map(|k| 4e-310 + f64::from(k) * 5e-309));
    knots.extend((0..5).map(|k| 2.04e-308 + f64::from(k) * 1e-309));
    let mut places = [0.0; 12];
    places[6] = -100.0;
    places[7..].fill(100.0);
    let mut scene = Scene::new();
    let there = jumps(&[0.0, knots[12]], &[-100.0]);
    for flight in [jumps(&knots, &places), there] {
        let hitbox = Hitbox::sphere(1.0).unwrap();
        scene.insert(Body::new(flight).with_hitbox(hitbox)).unwrap();
    }
    for count in [1, 2, 7] {
        let found = scene.screen(&slices(count)).unwrap().conflicts;
        assert_eq!(found.len(), 1, "{count} slices");
    }
}

/// A body that jumps into contact at the very end of the window, or of a slice.
#[test]
fn a_jump_at_the_end_of_the_window() {
    let mut scene = Scene::new();
    let there = jumps(&[0.0, 4.0], &[5.0]);
    for flight in [jumps(&[0.0, 1.0, 2.0, 4.0], &[0.0, 2.0, 5.0]), there] {
        scene.insert(Body::new(flight)).unwrap();
    }
    for (from, to) in [(0.0, 2.0), (2.0, 2.0), (0.0, 4.0), (2.0, 4.0)] {
        let window = Window::new(from, to).unwrap();
        for count in [1, 2, 3, 4] {
            let query = Query::new(window).with_slices(NonZeroU32::new(count).unwrap());
            let found = scene.screen(&query).unwrap().conflicts;
            assert_eq!(found.len(), 1, "{from}..{to}, {count} slices");
            assert!((found[0].enter, found[0].exit) == (2.0, to));
        }
    }
}

/// Only relative motion matters: a convoy is searched in as many slices as the same bodies without the common motion,
/// whether they are told by states or follow plans.
#[test]
fn a_convoy_is_searched_as_if_it_stood() {
    const LOOKAHEAD: f64 = 15.0;
    let slices = |common: DVec3, has_plans: bool| {
        let mut rng = rng(83);
        let mut scene = Scene::new();
        for _ in 0..1_000 {
            let (place, own) = (vector(&mut rng, 100.0), vector(&mut rng, 1.0));
            let state = |time: f64| {
                // The plans bend a little.
                let bend = (0.3 * time).sin() * own;
                State::new(
                    time,
                    place + time * (own + common) + bend,
                    own + common + (0.3 * time).cos() * 0.3 * own,
                )
            };
            let plan = if has_plans {
                let states: Vec<State> = (0..=8)
                    .map(|knot| state(0.25 * LOOKAHEAD * f64::from(knot)))
                    .collect();
                Trajectory::from_states(&states).unwrap()
            } else {
                Trajectory::coasting(State::new(0.0, place, own + common)).unwrap()
            };
            scene.insert(Body::new(plan)).unwrap();
        }
        let query = Query::new(Window::new(0.0, LOOKAHEAD).unwrap()).with_margin(6.0);
        let monitor = Monitor::new(scene.clone(), 0.0, LOOKAHEAD, &[AlertLevel::at(6.0)]);
        let mut monitor = monitor.unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        [
            scene.screen(&query).unwrap().stats.slices,
            monitor.stats().slices,
        ]
    };
    for has_plans in [false, true] {
        let standing = slices(DVec3::ZERO, has_plans);
        for speed in [30.0, 300.0, 7_500.0] {
            let moving = slices(DVec3::new(speed, 0.3 * speed, 0.0), has_plans);
            let few = standing.map(|count| 2 * count);
            assert!(
                moving[0] <= few[0] && moving[1] <= few[1],
                "{speed}: {moving:?} {standing:?}"
            );
        }
    }
}
