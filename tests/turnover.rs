//! Bodies that come, go, and fly on otherwise: a scene is what is in it, not how it came to be.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::{Body, BodyId, Conflict, Hitbox, Query, Scene, Trajectory};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use support::{rng, wander};

/// A plan with any number of cubics, often few, sometimes many.
fn plan(rng: &mut ChaCha8Rng) -> Trajectory {
    let cubics = match rng.random_range(0..10) {
        0 => rng.random_range(1..600_u32),
        1..4 => rng.random_range(1..60),
        _ => rng.random_range(1..6),
    };
    let start = rng.random_range(0.0..10.0);
    let states = wander(
        rng,
        start,
        cubics as usize,
        20.0 / f64::from(cubics),
        40.0,
        5.0,
    );
    Trajectory::from_states(&states).unwrap()
}

fn body(rng: &mut ChaCha8Rng) -> Body {
    Body::new(plan(rng)).with_hitbox(Hitbox::sphere(0.3).unwrap())
}

/// The conflicts, bodies by their order in the scene: no two bits differ.
fn found(scene: &Scene) -> Vec<[u64; 6]> {
    let query = Query::default().with_margin(1.0);
    let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
    let place = |id: BodyId| ids.binary_search(&id).unwrap() as u64;
    let conflicts = scene.screen(&query).unwrap().conflicts;
    let bits = |conflict: &Conflict| {
        [
            place(conflict.a),
            place(conflict.b),
            conflict.enter.to_bits(),
            conflict.exit.to_bits(),
            conflict.closest.time.to_bits(),
            conflict.closest.separation.to_bits(),
        ]
    };
    conflicts.iter().map(bits).collect()
}

/// The same bodies in a scene that never had others.
fn fresh(scene: &Scene) -> Scene {
    let mut fresh = Scene::new();
    for (_, body) in scene.bodies() {
        fresh.insert(body.clone()).unwrap();
    }
    fresh
}

#[test]
fn a_scene_is_what_is_in_it() {
    let mut rng = rng(31);
    let mut scene = Scene::new();
    let mut ids: Vec<BodyId> = (0..60)
        .map(|_| scene.insert(body(&mut rng)).unwrap())
        .collect();
    // Copies, and what was found in them when they were made.
    let mut copies: Vec<(Scene, Vec<[u64; 6]>)> = Vec::new();
    let mut conflicts = 0;
    for round in 0..120 {
        for _ in 0..rng.random_range(1..12) {
            let number = rng.random_range(0..ids.len());
            match rng.random_range(0..3) {
                0 => ids.push(scene.insert(body(&mut rng)).unwrap()),
                1 if ids.len() > 40 => drop(scene.remove(ids.swap_remove(number)).unwrap()),
                _ => drop(scene.set_trajectory(ids[number], plan(&mut rng)).unwrap()),
            }
        }
        let now = found(&scene);
        assert_eq!(now, found(&fresh(&scene)), "round {round}");
        conflicts += now.len();
        for (copy, before) in &copies {
            assert_eq!(&found(copy), before, "round {round}");
        }
        // Some of the time it goes on with the copy, and the original stays.
        if copies.len() == 3 {
            copies.remove(rng.random_range(0..3));
        }
        let copy = scene.clone();
        if rng.random_bool(0.5) {
            copies.push((copy, now));
        } else {
            copies.push((std::mem::replace(&mut scene, copy), now));
        }
    }
    assert!(conflicts > 1_000, "{conflicts}");
    // Empty, and filled again.
    for id in ids {
        drop(scene.remove(id).unwrap());
    }
    assert!(found(&scene).is_empty());
    for _ in 0..60 {
        scene.insert(body(&mut rng)).unwrap();
    }
    assert_eq!(found(&scene), found(&fresh(&scene)));
}
