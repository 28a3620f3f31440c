//! What must not matter does not: the order of bodies, what else there is, earlier plans, the origin of space and
//! time, extra knots. And a dense sampling that would see a conflict that was lost.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Body, Conflict, Hitbox, Outside, Query, Scene, State, Trajectory, Window};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::num::NonZeroU32;
use support::{bits, line, scene_of, screen, swarm};

const MARGIN: f64 = 1.5;

/// A swarm with some hundred conflicts.
fn bodies(seed: u64) -> Vec<(Vec<State>, f64)> {
    swarm(seed, 60, 40.0)
}

/// The same conflicts up to rounding: times to `time` s, lengths to `length` m.
fn assert_alike(found: &[Conflict], expected: &[Conflict], time: f64, length: f64) {
    assert_eq!(found.len(), expected.len());
    assert!(!expected.is_empty());
    for (x, y) in found.iter().zip(expected) {
        assert_eq!((x.a.slot(), x.b.slot()), (y.a.slot(), y.b.slot()));
        assert!((x.enter - y.enter).abs() < time, "{x:?} {y:?}");
        assert!((x.exit - y.exit).abs() < time, "{x:?} {y:?}");
        assert!((x.closest.time - y.closest.time).abs() < 1e3 * time);
        assert!((x.closest.separation - y.closest.separation).abs() < length);
        assert_eq!(x.clip, y.clip);
    }
}

#[test]
fn the_order_of_bodies() {
    let bodies = bodies(1);
    let mut reversed = bodies.clone();
    reversed.reverse();
    let expected = screen(&scene_of(&bodies), Window::ALL, MARGIN);
    let mut found = screen(&scene_of(&reversed), Window::ALL, MARGIN);
    let last = u32::try_from(bodies.len() - 1).unwrap();
    let key = |c: &Conflict, flip: bool| {
        let slots = if flip {
            (last - c.b.slot(), last - c.a.slot())
        } else {
            (c.a.slot(), c.b.slot())
        };
        (slots, c.enter.to_bits(), c.exit.to_bits())
    };
    // h and -h have the same rounding: even the bits agree.
    let mut a: Vec<_> = expected.iter().map(|c| key(c, false)).collect();
    let mut b: Vec<_> = found.drain(..).map(|c| key(&c, true)).collect();
    a.sort_unstable();
    b.sort_unstable();
    assert_eq!(a, b);
}

/// Whether a pair is in contact at the very instant at which the window begins, where its separation is
/// the margin up to rounding, is not for other bodies to decide, nor for the number of slices.
#[test]
fn what_else_is_in_the_scene() {
    let (start, end) = (1e6, 1e6 + 60.0);
    let flight = |(from, to): (DVec3, DVec3), (first, last): (DVec3, DVec3)| {
        let states = [State::new(start, from, first), State::new(end, to, last)];
        (states.to_vec(), 50.0)
    };
    for step in 0..100 {
        let y = 0.1 * f64::from(step);
        let (x, z) = (10.0 * DVec3::X, DVec3::Z);
        let pair = [
            flight((-30.0 * x, 30.0 * x), (x, x)),
            flight(
                (DVec3::new(0.0, -300.0, y), DVec3::new(0.0, 300.0, y + 3.0)),
                (10.0 * DVec3::Y + 0.3 * z, 10.0 * DVec3::Y + 0.1 * z),
            ),
        ];
        let mut bodies = Vec::new();
        for place in 0..8 {
            let position = DVec3::new(1e4 * f64::from(place), 1e6, 0.0);
            let rest = [50.0, 60.0].map(|time| State::new(start + time, position, DVec3::ZERO));
            bodies.extend([(rest.to_vec(), 1.0), (rest.to_vec(), 1.0)]);
        }
        bodies.extend(pair.clone());
        let (alone, crowd) = (scene_of(&pair), scene_of(&bodies));
        let found = screen(&alone, Window::ALL, 0.0);
        let window = Window::new(found[0].exit, end).unwrap();
        let expected = screen(&alone, window, 0.0).len();
        for method in Method::EVERY {
            for count in [1, 4] {
                let slices = NonZeroU32::new(count).unwrap();
                let query = Query::new(window).with_slices(slices).with_method(method);
                let found = crowd.screen(&query).unwrap().conflicts;
                assert_eq!(found.len() - 8, expected, "{y} {method:?} {count}");
            }
        }
    }
}

/// A body that was given another plan is where that says, at any of its knots: plans of the same
/// number of knots, of more and of fewer take each other's place.
#[test]
fn what_a_body_followed_before() {
    let later = |mut bodies: Vec<(Vec<State>, f64)>| {
        for (states, _) in &mut bodies {
            states.iter_mut().for_each(|state| state.time += 1.3);
        }
        bodies
    };
    let halved = |mut bodies: Vec<(Vec<State>, f64)>| {
        for (states, _) in &mut bodies {
            states.truncate(states.len().div_ceil(2));
        }
        bodies
    };
    let mut scene = scene_of(&bodies(6));
    for next in [
        later(bodies(6)),
        halved(bodies(7)),
        bodies(8),
        later(bodies(7)),
    ] {
        let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
        for (id, (states, radius)) in ids.into_iter().zip(&next) {
            let plan = Trajectory::from_states(states).unwrap();
            scene.set_trajectory(id, plan).unwrap();
            let hitbox = Hitbox::sphere(*radius).unwrap();
            scene.set_hitbox(id, hitbox).unwrap();
        }
        let expected = screen(&scene_of(&next), Window::ALL, MARGIN);
        assert!(!expected.is_empty());
        assert_eq!(bits(&screen(&scene, Window::ALL, MARGIN)), bits(&expected));
    }
}

#[test]
fn the_origin_of_space_and_time() {
    let original = bodies(2);
    let expected = screen(&scene_of(&original), Window::ALL, MARGIN);
    // Exact shifts would change nothing at all; these round the states (1e9 m: 1.2e-7 m, which
    // moves a crossing at 0.1 m/s by a microsecond).
    let moved = |time: f64, space: DVec3| -> Vec<(Vec<State>, f64)> {
        let shift = |state: &State| State {
            time: state.time + time,
            position: state.position + space,
            velocity: state.velocity,
        };
        original
            .iter()
            .map(|(states, radius)| (states.iter().map(shift).collect(), *radius))
            .collect()
    };
    let far = screen(
        &scene_of(&moved(0.0, DVec3::new(1e9, -2e9, 5e8))),
        Window::ALL,
        MARGIN,
    );
    assert_alike(&far, &expected, 1e-5, 1e-6);
    let mut late = screen(&scene_of(&moved(1.7e9, DVec3::ZERO)), Window::ALL, MARGIN);
    for conflict in &mut late {
        conflict.enter -= 1.7e9;
        conflict.exit -= 1.7e9;
        conflict.closest.time -= 1.7e9;
    }
    // The knots themselves move by an ulp of 1.7e9 s: 2.4e-7 s.
    assert_alike(&late, &expected, 5e-6, 1e-5);
}

#[test]
fn a_knot_more_changes_nothing_but_roundings() {
    let original = bodies(3);
    let expected = screen(&scene_of(&original), Window::ALL, MARGIN);
    let split: Vec<_> = original
        .iter()
        .map(|(states, radius)| {
            let trajectory = Trajectory::from_states(states).unwrap();
            let mut more = Vec::new();
            for pair in states.windows(2) {
                let time = pair[0].time * 0.3 + pair[1].time * 0.7;
                more.push(pair[0]);
                more.push(State::new(
                    time,
                    trajectory.position(time).unwrap(),
                    trajectory.velocity(time).unwrap(),
                ));
            }
            more.push(*states.last().unwrap());
            (more, *radius)
        })
        .collect();
    let found = screen(&scene_of(&split), Window::ALL, MARGIN);
    assert_alike(&found, &expected, 1e-9, 1e-12);
}

/// A splice far beyond the knots of a plan: what was flown there keeps its bits, and a cubic that was
/// to come from there is not looked at as a whole, which would drown all else in rounding.
#[test]
fn splices_far_beyond_the_knots() {
    let hitbox = || Hitbox::sphere(0.5).unwrap();
    let (still, away) = (DVec3::new(60.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 3.0));
    for outside in [Outside::Coast, Outside::Extrapolate] {
        let flown = line(0.0, 1.0, DVec3::ZERO, DVec3::X).with_outside(outside);
        let spliced = flown.spliced(100.0, &line(0.0, 200.0, away * 10.0, DVec3::Y));
        let bits = [flown, spliced.unwrap()].map(|plan| {
            let mut scene = Scene::new();
            for plan in [plan, line(-1e3, 1e3, still, DVec3::ZERO)] {
                scene.insert(Body::new(plan).with_hitbox(hitbox())).unwrap();
            }
            bits(&screen(&scene, Window::new(0.0, 90.0).unwrap(), 0.25))
        });
        assert_eq!((bits[0].len(), &bits[0]), (1, &bits[1]));
    }
    for far in [1e2, 1e4, 1e6] {
        let state = |time, x, velocity| State::new(time, DVec3::X * x, velocity);
        let states = [
            state(far, 7.0, DVec3::new(1.0, 0.3, 0.2)),
            state(far + 1.0, 8.5, DVec3::new(2.0, 1.0, 0.1)),
        ];
        let plan = Trajectory::from_states(&states).unwrap();
        let plan = plan.with_outside(Outside::Extrapolate);
        let spliced = Trajectory::at_rest(away).unwrap().spliced(0.0, &plan);
        let mut scene = Scene::new();
        for plan in [spliced.unwrap(), Trajectory::at_rest(DVec3::ZERO).unwrap()] {
            scene.insert(Body::new(plan).with_hitbox(hitbox())).unwrap();
        }
        let window = Window::new(far - 0.5, far + 0.5).unwrap();
        assert_eq!(screen(&scene, window, 2.0), []);
    }
}

/// What bodies do beyond their knots is kept from screening to screening: that changes no answer,
/// whatever the windows were before, and whichever plans were replaced.
#[test]
fn earlier_screenings_do_not_matter() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let (mut scene, mut found) = (Scene::new(), 0);
    let (states, _): (Vec<_>, Vec<_>) = swarm(8, 40, 12.0).into_iter().unzip();
    let mut plan = |number: usize| {
        let shift = rng.random_range(-20.0..20.0);
        let moved = |state: &State| State::new(state.time + shift, state.position, state.velocity);
        let states: Vec<State> = states[number].iter().map(moved).collect();
        match rng.random_range(0..5) {
            0 => Trajectory::at_rest(states[0].position),
            4 => Trajectory::coasting(states[4]),
            1 => Trajectory::from_states(&states),
            2 => Trajectory::from_states(&states).map(|plan| plan.with_outside(Outside::Coast)),
            _ => Trajectory::from_states(&states[..3])
                .map(|plan| plan.with_outside(Outside::Extrapolate)),
        }
        .unwrap()
    };
    let ids: Vec<_> = (0..40)
        .map(|number| scene.insert(Body::new(plan(number))).unwrap())
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for round in 0..60 {
        if round % 3 == 0 {
            let number = rng.random_range(0..ids.len());
            scene.set_trajectory(ids[number], plan(number)).unwrap();
        }
        let start = rng.random_range(-30.0..40.0);
        let window = Window::new(start, start + rng.random_range(0.0..30.0)).unwrap();
        // As if it had never been screened.
        let mut fresh = Scene::new();
        for (_, body) in scene.bodies() {
            fresh.insert(body.clone()).unwrap();
        }
        let query = Query::new(window).with_margin(MARGIN);
        let [kept, new] = [&scene.clone(), &fresh].map(|scene| scene.screen(&query).unwrap());
        assert_eq!(bits(&kept.conflicts), bits(&new.conflicts));
        assert_eq!(
            (kept.stats.slices, kept.stats.boxes),
            (new.stats.slices, new.stats.boxes)
        );
        assert_eq!(bits(&screen(&scene, window, MARGIN)), bits(&new.conflicts));
        let [a, b] = [ids[round % 40], ids[(round + 7) % 40]];
        let [kept, new] = [&scene, &fresh].map(|scene| scene.closest_approach(a, b, window));
        assert_eq!(kept, new);
        found += screen(&scene, window, MARGIN).len();
    }
    assert!(found > 500, "{found}");
}

#[test]
fn the_closest_approach_agrees_with_the_conflicts() {
    let scene = scene_of(&bodies(5));
    let conflicts = screen(&scene, Window::ALL, MARGIN);
    for conflict in &conflicts {
        let window = Window::new(conflict.enter, conflict.exit).unwrap();
        let within = scene.closest_approach(conflict.a, conflict.b, window);
        assert_eq!(within.unwrap(), Some(conflict.closest));
        let ever = scene
            .closest_approach(conflict.a, conflict.b, Window::ALL)
            .unwrap()
            .unwrap();
        assert!(ever.separation <= conflict.closest.separation);
        let least = conflicts
            .iter()
            .filter(|other| (other.a, other.b) == (conflict.a, conflict.b))
            .map(|other| other.closest.separation)
            .fold(f64::INFINITY, f64::min);
        assert_eq!(ever.separation.to_bits(), least.to_bits());
    }
}

#[test]
fn dense_sampling_finds_no_conflict_that_was_lost() {
    let bodies = bodies(6);
    let scene = scene_of(&bodies);
    let conflicts = screen(&scene, Window::ALL, MARGIN);
    let trajectories: Vec<_> = bodies
        .iter()
        .map(|(states, radius)| (Trajectory::from_states(states).unwrap(), *radius))
        .collect();
    let mut inside = 0;
    for step in 0..6000 {
        let time = f64::from(step) * 0.004;
        let present: Vec<(u32, DVec3, f64)> = (0..)
            .zip(&trajectories)
            .filter_map(|(slot, (t, radius))| Some((slot, t.position(time)?, *radius)))
            .collect();
        for (k, &(a, position_a, radius_a)) in present.iter().enumerate() {
            for &(b, position_b, radius_b) in &present[k + 1..] {
                let separation = position_a.distance(position_b) - radius_a - radius_b;
                let reported = conflicts.iter().any(|c| {
                    (c.a.slot(), c.b.slot()) == (a, b) && c.enter <= time && time <= c.exit
                });
                // Sampling itself rounds: at the margin to within 1e-12 m either is right.
                if (separation - MARGIN).abs() > 1e-12 {
                    assert_eq!(
                        reported,
                        separation < MARGIN,
                        "{a} {b} at {time}: {separation}"
                    );
                }
                inside += u32::from(reported);
            }
        }
    }
    assert!(inside > 1000);
}
