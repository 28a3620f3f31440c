//! Delivery drones over a city: climb, cruise, descend, wait, fly home.

use super::{Actor, Generated, generator};
use glam::DVec3;
use nearmiss::State;
use rand::RngExt;

/// `count` drones of 0.5 m between depots and doors, margin 8 m.
pub(crate) fn drones(count: usize, seed: u64) -> Generated {
    let mut rng = generator(seed);
    let half = 150.0 * f64::from(u32::try_from(count).unwrap_or(u32::MAX)).sqrt();
    let depots: Vec<DVec3> = (0..count.div_ceil(80))
        .map(|_| ground(&mut rng, half))
        .collect();
    let actors = (0..count)
        .map(|index| {
            let depot = depots[index % depots.len()];
            let pad = depot
                + DVec3::new(
                    rng.random_range(-40.0..40.0),
                    rng.random_range(-40.0..40.0),
                    0.0,
                );
            let reach = half.min(2_500.0);
            let door = depot
                + DVec3::new(
                    rng.random_range(-reach..reach),
                    rng.random_range(-reach..reach),
                    0.0,
                );
            let mut flight = Flight::starting(pad, rng.random_range(0.0..240.0));
            let lane = 60.0 + 10.0 * f64::from(rng.random_range(0..6));
            flight.hop(door, lane, rng.random_range(12.0..18.0));
            flight.wait(rng.random_range(15.0..40.0));
            flight.hop(pad, lane + 5.0, rng.random_range(14.0..20.0));
            Actor {
                states: flight.states,
                radius: 0.5,
            }
        })
        .collect();
    Generated {
        actors,
        margin: 8.0,
    }
}

fn ground(rng: &mut rand::rngs::ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::new(
        rng.random_range(-half..half),
        rng.random_range(-half..half),
        0.0,
    )
}

struct Flight {
    states: Vec<State>,
}

impl Flight {
    fn starting(place: DVec3, time: f64) -> Self {
        Self {
            states: vec![State::new(time, place, DVec3::ZERO)],
        }
    }

    /// Flies on to `place` at about `speed`, arriving with `velocity`.
    fn to(&mut self, place: DVec3, velocity: DVec3, speed: f64) {
        let last = self.states[self.states.len() - 1];
        // From or to a standstill the mean speed is about half.
        let slow = if last.velocity == DVec3::ZERO || velocity == DVec3::ZERO {
            1.7
        } else {
            1.0
        };
        let duration = (place.distance(last.position) * slow / speed).max(0.5);
        self.states
            .push(State::new(last.time + duration, place, velocity));
    }

    fn wait(&mut self, duration: f64) {
        let last = self.states[self.states.len() - 1];
        self.states.push(State {
            time: last.time + duration,
            velocity: DVec3::ZERO,
            ..last
        });
    }

    /// Up to the lane, over to above `place` in legs of some hundred metres, and down.
    fn hop(&mut self, place: DVec3, lane: f64, speed: f64) {
        let from = self.states[self.states.len() - 1].position;
        let (above, over) = (from.with_z(lane), place.with_z(lane));
        let way = over - above;
        let cruise = way.normalize_or_zero() * speed;
        self.to(above.lerp(over, 0.01), cruise * 0.3, 5.0);
        let legs = (way.length() / 300.0).ceil().clamp(1.0, 30.0);
        let mut leg = 1.0;
        while leg < legs {
            self.to(above.lerp(over, leg / legs), cruise, speed);
            leg += 1.0;
        }
        self.to(above.lerp(over, 0.99), cruise * 0.3, speed);
        self.to(place, DVec3::ZERO, 4.0);
    }
}
