//! Windows, margins, slices, threads and the order of bodies change no bit.

use super::moving;
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, Body, Conflict, Hitbox, Layers, Orientation, Query, Scene, Sphere, State, Trajectory,
    Window,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn scene(seed: u64) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut scene = Scene::new();
    for number in 0..40_u8 {
        let mut body = moving(&mut rng, usize::from(number), (0.0, 10.0)).body;
        let shift = DVec3::new(f64::from(number % 8), 0.0, 0.0);
        let states = body.trajectory.knots().to_vec();
        let states: Vec<State> = states
            .iter()
            .filter_map(|&time| body.trajectory.state(time))
            .map(|state| State::new(state.time, state.position + shift, state.velocity))
            .collect();
        let plan = Trajectory::from_states(&states).unwrap();
        body.trajectory = plan;
        scene.insert(body).unwrap();
    }
    scene
}

fn query(accuracy: Accuracy) -> Query {
    Query::new(Window::new(0.0, 10.0).unwrap())
        .with_margin(0.2)
        .with_accuracy(accuracy)
}

#[test]
fn windows_clip_and_change_nothing() {
    let scene = scene(1);
    let all = scene.screen(&query(Accuracy::Exact)).unwrap().conflicts;
    assert!(all.len() > 100, "{}", all.len());
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..40 {
        let start = rng.random_range(0.0..9.0);
        let end = start + rng.random_range(0.0..3.0);
        let window = Window::new(start, end).unwrap();
        let part = Query::new(window).with_margin(0.2);
        let found = scene.screen(&part).unwrap().conflicts;
        let inside = |conflict: &&Conflict| start < conflict.enter && conflict.exit < end;
        let expected: Vec<_> = all.iter().filter(inside).collect();
        assert_eq!(found.iter().filter(inside).collect::<Vec<_>>(), expected);
        let overlapping = all
            .iter()
            .filter(|one| one.enter <= end && one.exit >= start);
        assert_eq!(found.len(), overlapping.count());
        for conflict in &found {
            let whole = all.iter().find(|one| {
                (one.a, one.b) == (conflict.a, conflict.b)
                    && one.enter <= conflict.enter
                    && conflict.exit <= one.exit
            });
            let whole = whole.unwrap();
            assert!(conflict.enter.to_bits() == whole.enter.max(start).to_bits());
            assert!(conflict.exit.to_bits() == whole.exit.min(end).to_bits());
        }
    }
}

#[test]
fn threads_and_orders_change_nothing() {
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let scene = scene(3);
        let one = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| scene.screen(&query(accuracy)).unwrap().conflicts)
        };
        let first = one(1);
        assert!(!first.is_empty());
        for threads in [2, 3, 8] {
            assert_eq!(one(threads), first);
        }
        // Pairs asked alone, in any order.
        let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
        for conflict in first.iter().rev().step_by(7) {
            let [a, b] = [conflict.a, conflict.b];
            let mut alone = Scene::new();
            for &id in &ids {
                let mut body = scene.body(id).unwrap().clone();
                if id != a && id != b {
                    body = body.with_layers(Layers::NONE);
                }
                alone.insert(body).unwrap();
            }
            let found = alone.screen(&query(accuracy)).unwrap().conflicts;
            assert!(found.contains(conflict));
        }
    }
}

/// A larger margin finds more, and what it finds at the smaller one is the same.
#[test]
fn margins_select_and_change_nothing() {
    let scene = scene(4);
    let all = scene.screen(&query(Accuracy::Exact)).unwrap().conflicts;
    for margin in [-0.2, 0.0, 1.0] {
        let found = scene
            .screen(&query(Accuracy::Exact).with_margin(margin))
            .unwrap()
            .conflicts;
        for one in &found {
            let holds = |other: &&Conflict| {
                (one.a, one.b) == (other.a, other.b)
                    && other.enter <= one.enter
                    && one.exit <= other.exit
            };
            let other = if margin < 0.2 {
                all.iter().find(holds)
            } else {
                None
            };
            if let Some(other) = other {
                assert!(other.closest.separation <= one.closest.separation);
                if other.closest.time.to_bits() == one.closest.time.to_bits() {
                    assert_eq!(other.closest, one.closest);
                }
            } else {
                assert!(margin > 0.2, "{margin} {one:?}");
            }
        }
    }
}

/// A body that turns about its only sphere's centre is one that does not turn.
#[test]
fn a_sphere_at_the_centre_does_not_turn() {
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, 7.0 * DVec3::Z).unwrap();
    let scene = |orientation: &Orientation| {
        let mut scene = Scene::new();
        for x in [0.0, 5.0] {
            let states = [0.0, 10.0].map(|time| {
                let place = DVec3::new(x + (1.0 - 0.3 * x) * time, 0.1 * x, 0.0);
                State::new(time, place, DVec3::new(1.0 - 0.3 * x, 0.0, 0.0))
            });
            let plan = Trajectory::from_states(&states).unwrap();
            let hitbox = Hitbox::cluster(vec![Sphere {
                offset: DVec3::ZERO,
                radius: 0.5,
            }]);
            let body = Body::new(plan).with_hitbox(hitbox.unwrap());
            scene
                .insert(body.with_orientation(orientation.clone()))
                .unwrap();
        }
        scene.screen(&query(Accuracy::Exact)).unwrap().conflicts
    };
    let found = scene(&Orientation::FIXED);
    assert_eq!(found.len(), 1);
    assert_eq!(scene(&spin), found);
}
