//! rapier's collision pipeline, told where all bodies are: their present overlaps, nothing ahead.

use super::games::Game;
use super::sensors::Sensors;
use super::world::World;
use nearmiss::glam::Vec3;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Radius of a body and half the margin, m.
const BALL: f64 = 0.5 + 2.5;

/// Two sensors overlap while their bodies are within the margin.
pub(crate) struct Overlaps {
    world: World,
    positions: Vec<Vec3>,
    sensors: Sensors,
    counts: [u64; 2],
}

impl Overlaps {
    pub(crate) fn new(count: u32) -> Self {
        let (world, _) = World::new(count);
        Self {
            positions: Vec::new(),
            sensors: Sensors::new(BALL, world.states.len()),
            world,
            counts: [0; 2],
        }
    }
}

impl Game for Overlaps {
    fn frame(&mut self) -> Duration {
        self.world.step();
        let states = self.world.states.iter();
        self.positions.clear();
        self.positions
            .extend(states.map(|(_, state)| state.position.as_vec3()));
        let begin = Instant::now();
        self.sensors.step(self.positions.iter().copied());
        let mut counts = [0; 2];
        for (_, overlap) in self.sensors.pairs() {
            counts[0] += 1;
            counts[1] += u64::from(overlap);
        }
        self.counts = black_box(counts);
        begin.elapsed()
    }

    fn counts(&self) -> [(u64, &'static str); 2] {
        [(self.counts[0], "candidates"), (self.counts[1], "overlaps")]
    }
}
