//! Scenes made so that the answer is known, where monitors go wrong: minima on knots, formations,
//! long plans, bodies that begin and end in each other's way.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "exact cases are exact; a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::{Body, Scene, State, Trajectory, Window};
use rand::RngExt;
use support::{rng, screen, vector};

fn insert(scene: &mut Scene, states: &[State]) {
    let trajectory = Trajectory::from_states(states).unwrap();
    scene.insert(Body::new(trajectory)).unwrap();
}

/// Thousands of pairs, each with its minimum exactly on a knot that both share: each once.
#[test]
fn minima_on_shared_knots() {
    const PAIRS: u32 = 3000;
    const MARGIN: f64 = 1.0;
    let mut rng = rng(21);
    let mut scene = Scene::new();
    let mut expected = Vec::new();
    for pair in 0..PAIRS {
        // 200 m apart from all other pairs.
        let grid = [pair % 20, pair / 20 % 20, pair / 400].map(|cell| f64::from(cell) * 200.0);
        let centre = DVec3::from_array(grid);
        let apart = vector(&mut rng, 1.0).normalize() * rng.random_range(0.05..0.95);
        let velocity = vector(&mut rng, 5.0);
        // Perpendicular to the separation: the knot is where the distance is least.
        let relative = apart.cross(vector(&mut rng, 1.0)).normalize() * rng.random_range(1.0..8.0);
        let knot = rng.random_range(4.0..6.0);
        let plan = |position: DVec3, velocity: DVec3| {
            [-4.0, -1.5, 0.0, 2.5, 4.0]
                .map(|time| State::new(knot + time, position + velocity * time, velocity))
        };
        insert(&mut scene, &plan(centre, velocity));
        insert(&mut scene, &plan(centre + apart, velocity + relative));
        expected.push((knot, apart.length()));
    }
    let found = screen(&scene, Window::ALL, MARGIN);
    assert_eq!(found.len(), expected.len());
    let mut by_pair = found.clone();
    by_pair.sort_by_key(|conflict| conflict.a);
    for (pair, (conflict, (knot, distance))) in (0..).zip(by_pair.iter().zip(expected)) {
        assert_eq!(
            (conflict.a.slot(), conflict.b.slot()),
            (2 * pair, 2 * pair + 1)
        );
        // Straight lines of 10 m: a few roundings of that, and of the perpendicular direction.
        assert!((conflict.closest.time - knot).abs() < 1e-11);
        assert!((conflict.closest.separation - distance).abs() < 1e-12);
    }
}

/// Formations inside and outside the margin, at rest and flying, each one interval or none.
#[test]
fn formations_and_rest() {
    let mut rng = rng(22);
    let mut scene = Scene::new();
    let mut inside = 0;
    for pair in 0..400 {
        let centre = DVec3::new(f64::from(pair) * 500.0, 0.0, 0.0);
        // Multiples of 1/1024: the offset is kept exactly.
        let offset = (vector(&mut rng, 3.0) * 1024.0).round() / 1024.0;
        let states: Vec<State> = if pair % 2 == 0 {
            [0.0, 7.0]
                .map(|time| State::new(time, centre, DVec3::ZERO))
                .to_vec()
        } else {
            (0..9)
                .map(|k| {
                    let wander = (vector(&mut rng, 20.0) * 1024.0).round() / 1024.0;
                    let velocity = (vector(&mut rng, 8.0) * 1024.0).round() / 1024.0;
                    State::new(f64::from(k) * 0.75, centre + wander, velocity)
                })
                .collect()
        };
        let wing: Vec<State> = states
            .iter()
            .map(|state| State {
                position: state.position + offset,
                ..*state
            })
            .collect();
        insert(&mut scene, &states);
        insert(&mut scene, &wing);
        inside += usize::from(offset.length() <= 2.5);
    }
    let found = screen(&scene, Window::ALL, 2.5);
    assert_eq!(found.len(), inside);
    assert!(inside > 50);
    for conflict in found {
        assert_eq!(conflict.enter, 0.0);
        assert_eq!(conflict.closest.time, 0.0);
        assert_eq!(conflict.clip.bits(), 3);
    }
}

/// Two plans of 10,000 knots that weave around each other: every crossing, each once.
#[test]
fn ten_thousand_knots() {
    const KNOTS: u32 = 10_000;
    let weave = |phase: f64, offset: f64| -> Vec<State> {
        (0..KNOTS)
            .map(|k| {
                let time = f64::from(k) * 0.1 + offset;
                let position = DVec3::new(time, (time + phase).sin(), (time + phase).cos());
                let velocity = DVec3::new(1.0, (time + phase).cos(), -(time + phase).sin());
                State::new(time, position, velocity)
            })
            .collect()
    };
    let straight: Vec<State> = (0..KNOTS)
        .map(|k| {
            let time = f64::from(k) * 0.1;
            State::new(time, DVec3::new(time, 1.0, 0.0), DVec3::X)
        })
        .collect();
    let mut scene = Scene::new();
    insert(&mut scene, &weave(0.0, 0.05));
    insert(&mut scene, &straight);
    // y = sin t, z = cos t against (1, 0): distance 2 |sin((t - π/2) / 2)| <= 1/2, once a turn.
    let found = screen(&scene, Window::ALL, 0.5);
    let turns = 999.9 / std::f64::consts::TAU;
    assert!((f64::from(u32::try_from(found.len()).unwrap()) - turns).abs() < 1.0);
    let half_width = 2.0 * 0.25_f64.asin();
    for (turn, conflict) in (0..).zip(&found) {
        let middle = std::f64::consts::FRAC_PI_2 + std::f64::consts::TAU * f64::from(turn);
        // The Hermite cubic follows the circle to h⁴/384 = 2.6e-7 m.
        assert!((conflict.enter - (middle - half_width)).abs() < 2e-6);
        assert!((conflict.exit - (middle + half_width)).abs() < 2e-6);
    }
}

/// Bodies of one segment that begin and end at any time, in each other's way.
#[test]
fn short_lives() {
    let mut scene = Scene::new();
    for k in 0..200 {
        let start = f64::from(k) * 0.5;
        let plan = [start, start + 1.0].map(|time| State::new(time, DVec3::ZERO, DVec3::ZERO));
        insert(&mut scene, &plan);
    }
    let found = screen(&scene, Window::ALL, 0.0);
    // Each meets the next for half a second and touches the one after at one instant.
    assert_eq!(found.len(), 199 + 198);
    for conflict in found {
        let (a, b) = (f64::from(conflict.a.slot()), f64::from(conflict.b.slot()));
        assert_eq!(conflict.enter, b * 0.5);
        assert_eq!(conflict.exit, a * 0.5 + 1.0);
    }
}
