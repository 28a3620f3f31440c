//! Ships that fire streams of fast shots, all told each frame.

use super::world::{MovingBodies, STEP};
use crate::scenes::{generator, normal_vector, uniform_vector};
use nearmiss::glam::DVec3;
use nearmiss::{Body, BodyId, Hitbox, Layers, Scene, State, Trajectory};
use rand::rngs::ChaCha8Rng;

/// Bodies for each ship: the ship, and shots on their way.
const PER_SHIP: u32 = 51;
/// Side of the cube for one ship, m.
const SPACING: f64 = 80.0;
/// Largest speed of a ship along each axis, and speed of a shot, m/s.
const SPEEDS: [f64; 2] = [20.0, 300.0];
/// Radii of ships and shots, m.
const RADII: [f64; 2] = [2.0, 0.05];
/// Frames from one shot of a body to its next.
const FLIGHT: u32 = 120;

/// Ships, each with a stream of shots: a shot that has flown for 2 s is fired once more.
#[derive(Debug)]
pub(crate) struct Shots {
    rng: ChaCha8Rng,
    frame: u32,
    states: Vec<(BodyId, State)>,
    /// The direction in which each ship fires.
    aims: Vec<DVec3>,
}

impl Shots {
    /// Returns about `count` bodies. With layers, shots ignore each other.
    pub(crate) fn new(count: u32, with_layers: bool) -> (Self, Scene) {
        let mut world = Self {
            rng: generator(3),
            frame: 0,
            states: Vec::new(),
            aims: Vec::new(),
        };
        let layers = if with_layers {
            [Layers::new(1, 3), Layers::new(2, 1)]
        } else {
            [Layers::ALL; 2]
        };
        let mut scene = Scene::new();
        let mut insert = |state, is_shot: usize| {
            let hitbox = Hitbox::sphere(RADII[is_shot])?;
            let body = Body::new(Trajectory::coasting(state)?).with_hitbox(hitbox);
            scene.insert(body.with_layers(layers[is_shot]))
        };
        let ships = count / PER_SHIP;
        let half = 0.5 * SPACING * f64::from(ships).cbrt();
        for number in 0..ships * PER_SHIP {
            let is_shot = number % PER_SHIP > 0;
            let state = if is_shot {
                let mut state = world.fired(number);
                state.position += state.velocity * STEP * f64::from(Self::age(number, 0));
                state
            } else {
                let aim = normal_vector(&mut world.rng, 1.0);
                world.aims.push(aim.normalize());
                let place = uniform_vector(&mut world.rng, half);
                State::new(0.0, place, uniform_vector(&mut world.rng, SPEEDS[0]))
            };
            let inserted = insert(state, usize::from(is_shot));
            let id = inserted.unwrap_or_else(|error| panic!("a body is refused: {error}"));
            world.states.push((id, state));
        }
        (world, scene)
    }

    /// Returns the state of a shot that its ship fires now.
    fn fired(&mut self, number: u32) -> State {
        let ship = number / PER_SHIP;
        let (_, from) = self.states[(ship * PER_SHIP) as usize];
        let aim = self.aims[ship as usize] + normal_vector(&mut self.rng, 0.01);
        let velocity = from.velocity + SPEEDS[1] * aim.normalize();
        State::new(self.now(), from.position + 3.0 * aim, velocity)
    }

    /// Returns the number of frames since a body was fired.
    const fn age(number: u32, frame: u32) -> u32 {
        (number % PER_SHIP * FLIGHT / PER_SHIP + frame) % FLIGHT
    }
}

impl MovingBodies for Shots {
    fn now(&self) -> f64 {
        f64::from(self.frame) * STEP
    }

    fn states(&self) -> &[(BodyId, State)] {
        &self.states
    }

    fn step(&mut self) {
        self.frame += 1;
        for number in 0..self.states.len() {
            let (id, state) = self.states[number];
            let moved = state.position + STEP * state.velocity;
            let number = u32::try_from(number).unwrap_or(u32::MAX);
            let is_fired = number % PER_SHIP > 0 && Self::age(number, self.frame) == 0;
            let state = if is_fired {
                self.fired(number)
            } else {
                State::new(self.now(), moved, state.velocity)
            };
            self.states[number as usize] = (id, state);
        }
    }
}
