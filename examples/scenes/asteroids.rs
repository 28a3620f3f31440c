//! A field of slow rocks of all sizes, crossed by a few fast ones.

use super::{Actor, Generated, generator, irregular_knots, normal_vector, uniform_vector};
use glam::DVec3;
use nearmiss::State;
use rand::RngExt;

const DURATION: f64 = 600.0;

/// `count` rocks with radii from 2 m by a power law up to 200 m, margin 20 m.
pub(crate) fn asteroids(count: usize, seed: u64) -> Generated {
    let mut rng = generator(seed);
    let half = 260.0 * f64::from(u32::try_from(count).unwrap_or(u32::MAX)).cbrt();
    let actors = (0..count)
        .map(|index| {
            // Cumulative numbers fall with radius to the power of 2.5, as in the main belt.
            let radius = (2.0 / (1.0 - rng.random::<f64>()).powf(1.0 / 2.5)).min(200.0);
            let intruder = index % 50 == 0;
            let (place, drift) = if intruder {
                let place = uniform_vector(&mut rng, half);
                (place, normal_vector(&mut rng, 25.0))
            } else {
                (uniform_vector(&mut rng, half), normal_vector(&mut rng, 1.5))
            };
            // All circle slowly around the middle of the field.
            let spin = DVec3::Z * 4e-4;
            let states = irregular_knots(&mut rng, DURATION, 12, count)
                .into_iter()
                .map(|time| {
                    let angle = spin.z * time;
                    let turn = |v: DVec3| {
                        let (sin, cos) = angle.sin_cos();
                        DVec3::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos, v.z)
                    };
                    let position = turn(place + drift * time);
                    State::new(time, position, turn(drift) + spin.cross(position))
                })
                .collect();
            Actor { states, radius }
        })
        .collect();
    Generated {
        actors,
        margin: 20.0,
    }
}
