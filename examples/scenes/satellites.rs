//! Low-orbit constellations: Walker shells on two-body orbits.

use super::{Actor, Generated, generator, irregular_knots};
use glam::DVec3;
use nearmiss::State;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::f64::consts::TAU;

/// Gravitational parameter of the Earth, m³/s².
const GRAVITY: f64 = 3.986_004_418e14;
const EARTH_RADIUS: f64 = 6.378_137e6;
/// About one revolution, s.
const DURATION: f64 = 5_400.0;

/// Altitude (m), inclination (degrees), planes, share of the satellites.
const SHELLS: [(f64, f64, u32, f64); 5] = [
    (550e3, 53.0, 72, 0.34),
    (553e3, 97.6, 10, 0.12),
    (560e3, 70.0, 36, 0.16),
    (547e3, 43.0, 48, 0.28),
    (556e3, 86.4, 12, 0.10),
];

/// `count` satellites in shells a few kilometres apart. The margin is 5 km, but where there are more
/// than 10,000 so much less that each has about as many encounters.
pub(crate) fn satellites(count: usize, seed: u64) -> Generated {
    let mut rng = generator(seed);
    let total = f64::from(u32::try_from(count).unwrap_or(u32::MAX));
    let mut actors = Vec::with_capacity(count);
    let mut share_so_far = 0.0;
    for (altitude, inclination, planes, share) in SHELLS {
        share_so_far += share;
        let mut place = 0;
        while f64::from(u32::try_from(actors.len()).unwrap_or(u32::MAX)) < share_so_far * total
            && actors.len() < count
        {
            let orbit = Orbit {
                // Station keeping is good to some hundreds of metres.
                semi_axis: EARTH_RADIUS + altitude + rng.random_range(-400.0..400.0),
                eccentricity: rng.random_range(0.0..1e-3),
                inclination: inclination.to_radians(),
                node: TAU * f64::from(place % planes) / f64::from(planes),
                // Walker phasing: neighbours in the next plane are shifted.
                phase: TAU * (f64::from(place / planes) * 0.618 + f64::from(place % planes) * 0.37),
            };
            actors.push(orbit.fly(&mut rng, count));
            place += 1;
        }
    }
    Generated {
        actors,
        margin: 5_000.0 * (1e4 / total).sqrt().min(1.0),
    }
}

struct Orbit {
    semi_axis: f64,
    eccentricity: f64,
    inclination: f64,
    node: f64,
    phase: f64,
}

impl Orbit {
    /// States every 60 to 200 s, fine enough that the cubic follows the orbit to metres.
    fn fly(&self, rng: &mut ChaCha8Rng, bodies: usize) -> Actor {
        let states = irregular_knots(rng, DURATION, 50, bodies)
            .into_iter()
            .map(|time| self.state(time))
            .collect();
        Actor {
            states,
            radius: 5.0,
        }
    }

    fn state(&self, time: f64) -> State {
        let motion = (GRAVITY / self.semi_axis.powi(3)).sqrt();
        let mean = self.phase + motion * time;
        // Kepler's equation by fixed-point steps: at e < 1e-3 each gains three digits.
        let e = self.eccentricity;
        let anomaly = (0..8).fold(mean, |anomaly: f64, _| mean + e * anomaly.sin());
        let minor = (1.0 - e * e).sqrt();
        let (sin, cos) = anomaly.sin_cos();
        let rate = motion / (1.0 - e * cos);
        let place = |x: f64, y: f64| self.orient(x * self.semi_axis, y * self.semi_axis);
        State::new(
            time,
            place(cos - e, minor * sin),
            place(-sin * rate, minor * cos * rate),
        )
    }

    /// From the orbit's plane into space.
    fn orient(&self, x: f64, y: f64) -> DVec3 {
        let (tilted, high) = (y * self.inclination.cos(), y * self.inclination.sin());
        let (sin, cos) = self.node.sin_cos();
        DVec3::new(x * cos - tilted * sin, x * sin + tilted * cos, high)
    }
}
