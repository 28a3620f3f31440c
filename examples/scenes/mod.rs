//! Seeded many-body scenes for examples, benchmarks and tests: the same seed, the same bits.

#![allow(
    dead_code,
    unused_imports,
    reason = "each example, benchmark or test uses some of the scenes"
)]

mod asteroids;
mod drones;
mod flocks;
mod satellites;
mod swarm;

pub(crate) use asteroids::asteroids;
pub(crate) use drones::drones;
pub(crate) use flocks::flocks;
pub(crate) use satellites::satellites;
pub(crate) use swarm::{Shape, swarm};

use glam::DVec3;
use nearmiss::State;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// One body of a generated scene.
#[derive(Clone, Debug)]
pub(crate) struct Actor {
    /// States of the body, s, m, m/s.
    pub(crate) states: Vec<State>,
    /// m.
    pub(crate) radius: f64,
}

/// A generated scene with the margin that makes it interesting.
#[derive(Clone, Debug)]
pub(crate) struct Generated {
    pub(crate) actors: Vec<Actor>,
    /// m.
    pub(crate) margin: f64,
}

pub(crate) fn generator(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// A standard normal number (Box and Muller).
pub(crate) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}

/// Three independent normal numbers with this standard deviation.
pub(crate) fn normal_vector(rng: &mut ChaCha8Rng, deviation: f64) -> DVec3 {
    DVec3::new(normal(rng), normal(rng), normal(rng)) * deviation
}

/// Uniform in a cube around the origin with this half side.
pub(crate) fn uniform_vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::new(
        rng.random_range(-half..half),
        rng.random_range(-half..half),
        rng.random_range(-half..half),
    )
}

/// Cubics of a whole scene: 1 GiB.
const MAX_SEGMENTS: usize = 8_000_000;

/// `count + 1` knots from 0 to `end`: gaps uniform between 0.4 and 1.6 of their mean. Of a scene of
/// so many bodies that their cubics would not fit into memory, the first part.
pub(crate) fn irregular_knots(
    rng: &mut ChaCha8Rng,
    end: f64,
    count: usize,
    bodies: usize,
) -> Vec<f64> {
    let gaps: Vec<f64> = (0..count).map(|_| rng.random_range(0.4..1.6)).collect();
    let unit = end / gaps.iter().sum::<f64>();
    let mut time = 0.0;
    std::iter::once(0.0)
        .chain(gaps.iter().map(|gap| {
            time += gap * unit;
            time
        }))
        .take(1 + (MAX_SEGMENTS / bodies.max(1)).max(1))
        .collect()
}
