//! The monitor against one-shot screening at every tick, and its events against a plain reference;
//! beside it, scenarios of two bodies, step by step.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "exact cases are exact; a monitor that cannot be built fails the test"
)]

mod batches;
mod both_ways;
mod budgets;
mod change_times;
mod clocks;
mod crowded;
mod equal_distances;
mod grid;
mod instants;
mod late;
mod ledger;
mod overload;
mod partners;
mod questions;
#[cfg(feature = "recording")]
mod recorded;
mod reference;
mod resting;
mod restored;
mod scenarios;
mod skips;
#[path = "../support/mod.rs"]
mod support;
mod teleports;
mod threads;
mod tracked;
mod tracked_calls;
mod unchanged;

use glam::DQuat;
use ledger::Ledger;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Command, EndReason, Error, Hitbox, Layers, Monitor,
    Orientation, Outside, Query, Scene, Sphere, State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use reference::{Reference, order, reported};
use scenarios::tick;
use support::{bits, rng, vector, wander, with_every_change};

const LEVELS: [AlertLevel; 3] = [
    AlertLevel::at(4.0),
    AlertLevel::at(1.0).with_release(2.0),
    AlertLevel::at(-0.1),
];

/// A kind of random world.
#[derive(Clone, Copy)]
struct Kind {
    /// Side of the world, m.
    cube: f64,
    /// Share of bodies that are clusters, and their spheres.
    clusters: f64,
    spheres: usize,
    /// True if clusters turn.
    turns: bool,
}

const SMALL: Kind = Kind {
    cube: 14.0,
    clusters: 0.3,
    spheres: 3,
    turns: false,
};

/// Clusters of so many spheres that a monitor solves two of them for whole contacts alone, until a window cuts one.
const LARGE: Kind = Kind {
    clusters: 0.9,
    spheres: 24,
    turns: true,
    ..SMALL
};

fn hitbox(rng: &mut ChaCha8Rng, kind: Kind) -> Hitbox {
    if rng.random_bool(kind.clusters) {
        let spheres = (0..kind.spheres)
            .map(|_| Sphere {
                offset: vector(rng, 1.0),
                radius: rng.random_range(0.1..0.5),
            })
            .collect();
        Hitbox::cluster(spheres).unwrap()
    } else {
        Hitbox::sphere(rng.random_range(0.0..0.5)).unwrap()
    }
}

fn plan(rng: &mut ChaCha8Rng, start: f64, from: Option<State>, cube: f64) -> Trajectory {
    let segments = rng.random_range(1..8);
    let mut states = wander(rng, start, segments, 1.0, cube, 4.0);
    if let Some(from) = from {
        // Meets where the body is, as a steering game would.
        let shift = from.position - states[0].position;
        for (k, state) in (0..).zip(&mut states) {
            let share: f64 = 1.0 - f64::from(k) / 8.0;
            state.position += shift * share;
        }
        states[0].velocity = from.velocity;
    }
    let outside = match rng.random_range(0..9) {
        0..2 => Outside::Extrapolate,
        2..4 => Outside::Coast,
        4 => return Trajectory::coasting(states[0]).unwrap(),
        _ => Outside::Absent,
    };
    Trajectory::from_states(&states)
        .unwrap()
        .with_outside(outside)
}

fn body(rng: &mut ChaCha8Rng, start: f64, kind: Kind) -> Body {
    let layers = if rng.random_bool(0.2) {
        Layers::new(1 << rng.random_range(0..3), 0b101)
    } else {
        Layers::ALL
    };
    let body = Body::new(plan(rng, start, None, kind.cube))
        .with_hitbox(hitbox(rng, kind))
        .with_layers(layers);
    if kind.turns && rng.random_bool(0.5) {
        let spin = Orientation::spin(start, DQuat::IDENTITY, vector(rng, 2.0));
        body.with_orientation(spin.unwrap())
    } else {
        body
    }
}

/// One random change of plans; refusals (a splice where there is no plan) are part of life.
fn change(rng: &mut ChaCha8Rng, monitor: &mut Monitor, ids: &mut Vec<BodyId>, kind: Kind) {
    let (now, cube) = (monitor.now(), kind.cube);
    let pick = |rng: &mut ChaCha8Rng, ids: &[BodyId]| ids[rng.random_range(0..ids.len())];
    match rng.random_range(0..10) {
        0 => {
            let start = now + rng.random_range(-2.0..3.0);
            let new = body(rng, start, kind);
            ids.push(monitor.insert(new).unwrap());
        }
        1 if ids.len() > 6 => {
            let gone = ids.swap_remove(rng.random_range(0..ids.len()));
            monitor.remove(gone).unwrap();
        }
        2 => {
            let id = pick(rng, ids);
            let hitbox = hitbox(rng, kind);
            monitor.set_hitbox(id, hitbox).unwrap();
        }
        3 => {
            let id = pick(rng, ids);
            let layers = Layers::new(rng.random_range(1..8), rng.random_range(1..8));
            monitor.set_layers(id, layers).unwrap();
        }
        4 => {
            let (a, b) = (pick(rng, ids), pick(rng, ids));
            match rng.random_range(0..4) {
                _ if a == b => {}
                0 => monitor.ignore_pair(a, b).unwrap(),
                1 => monitor.unignore_pair(a, b).unwrap(),
                2 => drop(monitor.apply([Command::IgnorePair(a, b)]).unwrap()),
                _ => drop(monitor.apply([Command::UnignorePair(b, a)]).unwrap()),
            }
        }
        5 => {
            let id = pick(rng, ids);
            let end = *monitor
                .scene()
                .body(id)
                .unwrap()
                .trajectory
                .knots()
                .last()
                .unwrap();
            let more = plan(rng, end, None, cube);
            monitor.extend(id, more).unwrap();
        }
        6 => {
            let id = pick(rng, ids);
            let start = now - 1.0;
            let new = plan(rng, start, None, cube);
            monitor.set_trajectory(id, new).unwrap();
        }
        _ => {
            let id = pick(rng, ids);
            let from = now + rng.random_range(0.0..2.0);
            let old = &monitor.scene().body(id).unwrap().trajectory;
            let state = old
                .position(from)
                .map(|position| State::new(from, position, old.velocity(from).unwrap()));
            let new = plan(rng, from, state, cube);
            match monitor.replan(id, from, new) {
                Ok(used) => assert_eq!(used, from),
                Err(Error::InBody { error, .. }) => {
                    assert!(matches!(
                        *error,
                        Error::NoOldPlan { .. }
                            | Error::NoNewPlan { .. }
                            | Error::OutOfRange { .. }
                    ));
                }
                Err(other) => panic!("{other}"),
            }
        }
    }
}

fn one_shot(monitor: &Monitor, level: AlertLevel, until: f64) -> Vec<Vec<u64>> {
    let window = Window::new(monitor.now(), until).unwrap();
    let query = Query::new(window).with_margin(level.margin);
    bits(&monitor.scene().screen(&query).unwrap().conflicts)
}

/// The first level's conflicts, as of a tick, against a screening.
fn is_as_screened(monitor: &Monitor, level: AlertLevel) {
    let screened = one_shot(monitor, level, monitor.complete_until());
    assert_eq!(bits(monitor.conflicts(0).unwrap()), screened);
}

/// Ticks of a long random run; `NEARMISS_TICKS` asks for more.
fn ticks(default: u32) -> u32 {
    let asked = std::env::var("NEARMISS_TICKS").ok();
    asked.and_then(|text| text.parse().ok()).unwrap_or(default)
}

#[test]
fn equals_one_shot_screening_and_the_reference_at_every_tick() {
    for seed in 31..34 {
        long_run(seed, 3.0, (SMALL, 1_500));
    }
}

/// The lookahead is so short that the clock jumps over many of them at once, now and then.
#[test]
fn equals_one_shot_screening_and_the_reference_after_far_jumps() {
    for seed in 35..37 {
        long_run(seed, 0.05, (SMALL, 1_500));
    }
}

#[test]
fn equals_one_shot_screening_and_the_reference_of_large_clusters() {
    long_run(38, 2.0, (LARGE, 700));
}

fn long_run(seed: u64, lookahead: f64, (kind, default): (Kind, u32)) {
    let mut rng = rng(seed);
    let mut scene = Scene::new();
    let mut ids: Vec<BodyId> = (0..24)
        .map(|_| scene.insert(body(&mut rng, -1.0, kind)).unwrap())
        .collect();
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, lookahead, &LEVELS).unwrap());
    let mut ledger = Ledger::default();
    let mut reference = Reference::new(&LEVELS, 0.0, lookahead);
    let (mut conflicts, mut events) = (0, Vec::new());
    let mut count = 0;
    for tick in 0..ticks(default) {
        for _ in 0..rng.random_range(0..3) {
            change(&mut rng, &mut monitor, &mut ids, kind);
        }
        let step = match rng.random_range(0..40) {
            0 => 0.0,
            1 => rng.random_range(1.0..9.0),
            _ => 1.0 / 60.0 * rng.random_range(0.5..3.0),
        };
        let now = monitor.now() + step;
        // A third of the ticks with so little budget that some of the lookahead stays unknown.
        let budget = match tick % 3 {
            0 => Budget::Work(rng.random_range(0..60)),
            _ => Budget::Unlimited,
        };
        events.clear();
        match monitor.advance_within(now, budget, &mut events) {
            Ok(()) => {}
            Err(Error::InBody { .. }) => {
                // An extrapolated cubic left the range of numbers: take such bodies out.
                for id in std::mem::take(&mut ids) {
                    monitor.remove(id).unwrap();
                }
                continue;
            }
            Err(other) => panic!("{other}"),
        }
        ledger.read(&events);
        ledger.knows_exits_of(&monitor);
        count += events.len();
        assert!(events.is_sorted_by(|x, y| x.order(y).is_le()));
        let known = monitor.complete_until();
        // Two encounters of one pair at one level may change in one tick: their order is open.
        let mut expected = reference.tick(monitor.scene(), now, known);
        expected.sort_by(order);
        let mut found: Vec<_> = events.iter().map(reported).collect();
        found.sort_by(order);
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found, expected, "seed {seed}, tick {tick}");
        }
        assert_eq!(found.len(), expected.len(), "seed {seed}, tick {tick}");
        if budget == Budget::Unlimited {
            assert_eq!(known, now + lookahead);
        }
        for (index, level) in LEVELS.into_iter().enumerate() {
            let expected = if known > now {
                one_shot(&monitor, level, known)
            } else {
                vec![]
            };
            let found = bits(monitor.conflicts(index).unwrap());
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!(found, expected, "seed {seed}, tick {tick}, level {index}");
            }
            assert_eq!(
                found.len(),
                expected.len(),
                "seed {seed}, tick {tick}, level {index}"
            );
            conflicts += expected.len();
        }
        if ids.len() < 12 {
            let start = now - 1.0;
            ids.push(monitor.insert(body(&mut rng, start, kind)).unwrap());
        }
    }
    events.clear();
    monitor.close(&mut events);
    ledger.read(&events);
    assert!(ledger.open.is_empty(), "every encounter has its end");
    assert!(conflicts > 5_000 && count > 1_000, "{conflicts} {count}");
    for reason in [
        EndReason::Separated,
        EndReason::TrajectoryEnded,
        EndReason::PlanChanged,
        EndReason::BodyRemoved,
    ] {
        assert!(
            ledger.closed.values().any(|&found| found == reason),
            "{reason:?}"
        );
    }
}

/// So many that boxes are in trees of several levels, and none to all of them change in a tick.
#[test]
fn equals_one_shot_screening_with_many_bodies() {
    const KIND: Kind = Kind {
        cube: 120.0,
        ..SMALL
    };
    let mut rng = rng(41);
    let mut scene = Scene::new();
    let mut ids: Vec<BodyId> = (0..1500)
        .map(|_| scene.insert(body(&mut rng, -1.0, KIND)).unwrap())
        .collect();
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 2.0, &LEVELS).unwrap());
    let (mut conflicts, mut events) = (0, Vec::new());
    for tick in 0..60 {
        for _ in 0..[0, 5, 60, 300, 2000][tick % 5] {
            change(&mut rng, &mut monitor, &mut ids, KIND);
        }
        let now = monitor.now() + rng.random_range(0.0..0.2);
        let budget = match tick % 7 {
            3 => Budget::Work(1500),
            _ => Budget::Unlimited,
        };
        monitor.advance_within(now, budget, &mut events).unwrap();
        let known = monitor.complete_until();
        for (index, level) in LEVELS.into_iter().enumerate() {
            let expected = if known > now {
                one_shot(&monitor, level, known)
            } else {
                vec![]
            };
            assert_eq!(
                bits(monitor.conflicts(index).unwrap()),
                expected,
                "tick {tick}"
            );
            conflicts += expected.len();
        }
    }
    assert!(conflicts > 50_000, "{conflicts}");
}

/// Bodies changed and boxes formed in each tick of a monitor of 200 bodies, a share of which is
/// replanned before each tick; and how many slices it has a part of in sight.
fn boxes_formed(share: f64) -> (Vec<(u64, u64)>, u64) {
    let mut rng = rng(31);
    let mut scene = Scene::new();
    let mut ids = Vec::new();
    for _ in 0..200 {
        let states = wander(&mut rng, 0.0, 40, 1.0, 60.0, 4.0);
        let plan = Trajectory::from_states(&states).unwrap();
        ids.push(scene.insert(Body::new(plan)).unwrap());
    }
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 6.0, &LEVELS).unwrap());
    tick(&mut monitor, 0.0);
    let slices = monitor.stats().slices;
    let ticks = (1..=120).map(|number| {
        for &id in &ids {
            if rng.random_bool(share) {
                let plan = monitor.scene().body(id).unwrap().trajectory.clone();
                // Another one that does not differ before its end, which is far ahead.
                let other = match plan.outside_after() {
                    Outside::Absent => Outside::Coast,
                    _ => Outside::Absent,
                };
                monitor
                    .set_trajectory(id, plan.with_outside(other))
                    .unwrap();
            }
        }
        tick(&mut monitor, f64::from(number) / 30.0);
        (monitor.stats().changed, monitor.stats().boxes)
    });
    (ticks.collect(), slices)
}

#[test]
fn what_comes_next_is_boxed_little_by_little() {
    let (quiet, slices) = boxes_formed(0.0);
    // In 180 ticks as many slices as the lookahead has; boxes are formed in 3 of 5 of the ticks.
    let most = (slices * 200).div_ceil(180 * 3 / 5);
    assert!(quiet.iter().all(|tick| tick.1 <= most), "{quiet:?}");
    let formed = quiet.iter().map(|tick| tick.1).sum::<u64>();
    // (Of the two at its ends it has only parts.)
    assert!(
        formed >= (slices - 2) * 200 * 120 / 180,
        "{formed} {slices}"
    );
    let (busy, slices) = boxes_formed(0.3);
    let (changed, boxes) = busy
        .iter()
        .fold((0, 0), |sum, tick| (sum.0 + tick.0, sum.1 + tick.1));
    // In the slices of the lookahead; those of the next one, if they were formed all the time, would
    // be an eighth of it more.
    assert!(
        boxes >= (slices - 2) * changed && boxes * 100 <= slices * 107 * changed,
        "{boxes} {changed} {slices}"
    );
    assert!(
        busy.iter()
            .all(|tick| tick.1 <= (slices + 1) * tick.0 + 100),
        "{busy:?}"
    );
}
