//! The stress scene: smooth random motion at constant density.

use super::{Actor, Generated, generator, irregular_knots, normal_vector, uniform_vector};
use glam::DVec3;
use nearmiss::State;
use rand::rngs::ChaCha8Rng;

const DURATION: f64 = 60.0;
const SEGMENTS: usize = 32;
/// Root mean square speed, m/s.
const SPEED: f64 = 10.0;
/// Time in which a velocity is forgotten (Ornstein-Uhlenbeck), s.
const MEMORY: f64 = 10.0;
/// m.
const MARGIN: f64 = 5.0;
/// Side of the cube for one body, m.
const SPACING: f64 = 65.6;

/// The shape of space that the swarm fills.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Uniform in a cube.
    Cube,
    /// Ten balls of the same density, 3,000 km apart.
    Clusters,
    /// z flattened by 1,000, x and y widened so that about as many come close.
    Flat,
    /// 5 % of the bodies are 30 times faster.
    FastFew,
}

/// `count` points with 32 segments over 60 s, about 10 m/s, margin 5 m. (From 250,000 on the first
/// of these segments only.)
pub(crate) fn swarm(count: usize, shape: Shape, seed: u64) -> Generated {
    let mut rng = generator(seed);
    let side = SPACING * number(count).cbrt();
    let actors = (0..count)
        .map(|index| {
            let place = match shape {
                Shape::Clusters => ball(&mut rng, index, count),
                Shape::Cube | Shape::FastFew => uniform_vector(&mut rng, side / 2.0),
                Shape::Flat => uniform_vector(&mut rng, side / 2.0) * widening(side),
            };
            let speed = match shape {
                Shape::FastFew if index % 20 == 0 => 30.0 * SPEED,
                _ => SPEED,
            };
            let mut states = wander(&mut rng, place, speed, count);
            if shape == Shape::Flat {
                flatten(&mut states);
            }
            Actor {
                states,
                radius: 0.0,
            }
        })
        .collect();
    Generated {
        actors,
        margin: MARGIN,
    }
}

fn wander(rng: &mut ChaCha8Rng, place: DVec3, speed: f64, bodies: usize) -> Vec<State> {
    let deviation = speed / 3_f64.sqrt();
    let knots = irregular_knots(rng, DURATION, SEGMENTS, bodies);
    let mut state = State::new(knots[0], place, normal_vector(rng, deviation));
    let mut states = vec![state];
    for &time in &knots[1..] {
        let gap = time - state.time;
        let kept = (-gap / MEMORY).exp();
        let velocity =
            state.velocity * kept + normal_vector(rng, deviation * (1.0 - kept * kept).sqrt());
        let position = state.position + (state.velocity + velocity) * (gap / 2.0);
        state = State::new(time, position, velocity);
        states.push(state);
    }
    states
}

/// Ten balls on a coarse lattice, each with a tenth of the bodies at the swarm's density.
fn ball(rng: &mut ChaCha8Rng, index: usize, count: usize) -> DVec3 {
    let corner = u32::try_from(index % 10).unwrap_or(0);
    let centre = DVec3::new(
        f64::from(corner % 3),
        f64::from(corner / 3 % 3),
        f64::from(corner / 9),
    ) * 3e6;
    let volume = number(count) / 10.0 * SPACING.powi(3);
    let radius = (volume * 3.0 / (4.0 * std::f64::consts::PI)).cbrt();
    loop {
        let offset = uniform_vector(rng, 1.0);
        if offset.length_squared() <= 1.0 {
            return centre + offset * radius;
        }
    }
}

/// Returns the factor by which a flat world is wider, so that about as many bodies come within the margin: a body
/// sweeps a tube of section π D² at a density of N / side³, and in the plane a band of width 2 D at
/// N / (w side)².
fn widening(side: f64) -> DVec3 {
    let wider = (2.0 * side / (std::f64::consts::PI * MARGIN)).sqrt();
    DVec3::new(wider, wider, 1.0)
}

fn flatten(states: &mut [State]) {
    const FLATTENING: DVec3 = DVec3::new(1.0, 1.0, 1e-3);
    for state in states {
        state.position *= FLATTENING;
        state.velocity *= FLATTENING;
    }
}

fn number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}
