//! rapier's collision pipeline, told where all bodies are: their present overlaps, nothing ahead.

use super::games::Game;
use super::sensors::Sensors;
use super::world::{MovingBodies, World};
use nearmiss::glam::Vec3;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Radius of a body, m.
const BALL: f32 = 0.5;

/// Sensors that overlap while their bodies do.
pub(crate) struct Overlaps {
    world: World,
    /// Factor of all positions.
    scale: f32,
    positions: Vec<Vec3>,
    sensors: Sensors,
    counts: [u64; 2],
}

impl Overlaps {
    /// Returns the game, after checking that a crowded one finds the overlaps that brute force finds.
    pub(crate) fn new(count: u32) -> Self {
        let mut crowd = Self::of(2_000, 1.0 / 32.0);
        for _ in 0..5 {
            crowd.frame();
            let overlaps = crowd.brute_force();
            assert!(overlaps > 100, "{overlaps} overlaps check little");
            assert_eq!(crowd.counts[1], overlaps, "rapier and brute force differ");
        }
        Self::of(count, 1.0)
    }

    fn of(count: u32, scale: f32) -> Self {
        let (world, _) = World::new(count);
        Self {
            scale,
            positions: Vec::new(),
            sensors: Sensors::new(world.states().iter().map(|_| f64::from(BALL))),
            world,
            counts: [0; 2],
        }
    }

    /// Returns the number of balls that overlap where they were last told.
    fn brute_force(&self) -> u64 {
        let others = |number: usize| &self.positions[number + 1..];
        let overlaps = self.positions.iter().enumerate().map(|(number, one)| {
            let met = others(number)
                .iter()
                .filter(|other| one.distance(**other) <= 2.0 * BALL);
            met.count() as u64
        });
        overlaps.sum()
    }
}

impl Game for Overlaps {
    fn frame(&mut self) -> Duration {
        self.world.step();
        let states = self.world.states().iter();
        self.positions.clear();
        self.positions
            .extend(states.map(|(_, state)| self.scale * state.position.as_vec3()));
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
