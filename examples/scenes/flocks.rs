//! Flocks of birds that fly through each other.

use super::{Actor, Generated, generator, irregular_knots, normal_vector, uniform_vector};
use glam::DVec3;
use nearmiss::State;
use rand::RngExt;

const DURATION: f64 = 60.0;
const BIRDS_PER_FLOCK: usize = 60;
/// Metres from bird to bird, about.
const SPACING: f64 = 2.5;

/// `count` birds of 0.2 m in flocks of sixty on crossing ways, margin 0.3 m.
pub(crate) fn flocks(count: usize, seed: u64) -> Generated {
    let mut rng = generator(seed);
    let flocks = f64::from(u32::try_from(count.div_ceil(BIRDS_PER_FLOCK)).unwrap_or(u32::MAX));
    // The sky grows with the flocks, so that they keep crossing at the same rate.
    let half = 90.0 * flocks.cbrt();
    let mut actors = Vec::with_capacity(count);
    while actors.len() < count {
        let start = uniform_vector(&mut rng, half);
        let heading = (uniform_vector(&mut rng, half) - start).normalize_or(DVec3::X);
        let speed = rng.random_range(9.0..14.0);
        // The whole flock turns and climbs along one gentle curve.
        let side = heading.cross(DVec3::Z).normalize_or(DVec3::Y);
        let up = side.cross(heading);
        let (sway, rise) = (rng.random_range(5.0..25.0), rng.random_range(2.0..8.0));
        let pace = rng.random_range(0.1..0.25);
        let lead = |time: f64| {
            let (sin, cos) = (pace * time).sin_cos();
            let position =
                start + heading * (speed * time) + side * (sway * sin) + up * (rise * cos);
            let velocity = heading * speed + side * (sway * pace * cos) - up * (rise * pace * sin);
            (position, velocity)
        };
        for _ in 0..BIRDS_PER_FLOCK.min(count - actors.len()) {
            let place = normal_vector(&mut rng, SPACING * 1.8);
            // Each bird jostles around its place: two turns of its own.
            let (wobble, turn) = (normal_vector(&mut rng, 0.6), rng.random_range(0.4..1.1));
            let shift = rng.random_range(0.0..std::f64::consts::TAU);
            let states = irregular_knots(&mut rng, DURATION, 40, count)
                .into_iter()
                .map(|time| {
                    let (position, velocity) = lead(time);
                    let (sin, cos) = (turn * time + shift).sin_cos();
                    State::new(
                        time,
                        position + place + wobble * sin,
                        velocity + wobble * (turn * cos),
                    )
                })
                .collect();
            actors.push(Actor {
                states,
                radius: 0.2,
            });
        }
    }
    Generated {
        actors,
        margin: 0.3,
    }
}
