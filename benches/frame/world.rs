//! A world as a physics engine steps it: all bodies move, some change their velocity.

use crate::scenes::{generator, uniform_vector};
use nearmiss::glam::DVec3;
use nearmiss::{Body, BodyId, Hitbox, Scene, State, Trajectory};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// Duration of a frame, s.
pub(crate) const STEP: f64 = 1.0 / 60.0;
/// m.
const RADIUS: f64 = 0.5;
/// m.
pub(crate) const MARGIN: f64 = 5.0;
/// Side of the cube for one body, m, as in the generated swarm.
const SPACING: f64 = 65.6;
/// Largest speed along each axis, m/s: 17 m/s along a diagonal.
const SPEED: f64 = 10.0;
/// One body in so many changes its velocity in a frame.
const STEADY: u32 = 20;

/// Bodies that move by frames.
pub(crate) trait MovingBodies {
    /// Returns the time of the present frame, s.
    fn now(&self) -> f64;

    /// Returns all bodies and their present states.
    fn states(&self) -> &[(BodyId, State)];

    /// Moves all bodies by a frame.
    fn step(&mut self);
}

/// Bodies in a cube at constant density.
#[derive(Debug)]
pub(crate) struct World {
    rng: ChaCha8Rng,
    /// Half the side of the cube, m.
    half: f64,
    /// 1 along the axes in which bodies move, else 0.
    axes: DVec3,
    /// Velocity of the cube, m/s.
    common: DVec3,
    /// Middles of the cubes, in which bodies are in turns, m.
    middles: Vec<DVec3>,
    /// Bodies that have another place in each frame: so many from the first one on.
    restless: usize,
    frame: u32,
    states: Vec<(BodyId, State)>,
}

impl World {
    /// Returns `count` bodies, and a scene in which they coast from time 0 on.
    pub(crate) fn new(count: u32) -> (Self, Scene) {
        Self::of((count, SPACING), DVec3::ONE, DVec3::ZERO, |_| false)
    }

    #[allow(dead_code, reason = "the benchmark `frame` uses it")]
    /// Returns bodies as those of [`new`](Self::new), of which every other one rests.
    pub(crate) fn half_at_rest(count: u32) -> (Self, Scene) {
        Self::of((count, SPACING), DVec3::ONE, DVec3::ZERO, |number| {
            number % 2 > 0
        })
    }

    #[allow(dead_code, reason = "the benchmark `frame` uses it")]
    /// Returns bodies as those of [`new`](Self::new), one in 20^3 m, in a cube that moves.
    pub(crate) fn convoy(count: u32) -> (Self, Scene) {
        Self::of(
            (count, 20.0),
            DVec3::ONE,
            DVec3::new(300.0, 100.0, 0.0),
            |_| false,
        )
    }

    #[allow(dead_code, reason = "the benchmark `frame` uses it")]
    /// Returns bodies as those of [`new`](Self::new), one in a cube of this side (m).
    pub(crate) fn with_spacing(count: u32, spacing: f64) -> (Self, Scene) {
        Self::of((count, spacing), DVec3::ONE, DVec3::ZERO, |_| false)
    }

    #[allow(dead_code, reason = "the benchmark `frame` uses it")]
    /// Returns bodies as those of [`new`](Self::new), but on a plane, one in a square of this side (m).
    pub(crate) fn flat(count: u32, spacing: f64) -> (Self, Scene) {
        let axes = DVec3::new(1.0, 1.0, 0.0);
        Self::of((count, spacing), axes, DVec3::ZERO, |_| false)
    }

    #[allow(dead_code, reason = "the benchmark `frame` uses it")]
    /// Returns bodies as those of [`with_spacing`](Self::with_spacing), in ten cubes up to 1e9 m from each other on each
    /// axis.
    pub(crate) fn islands(count: u32, spacing: f64) -> (Self, Scene) {
        const ISLANDS: usize = 10;
        const HALF: f64 = 5e8;
        let mut rng = generator(2);
        let mut middle = || uniform_vector(&mut rng, HALF);
        let middles = (0..ISLANDS).map(|_| middle()).collect();
        Self::about(middles, (count, spacing), DVec3::ONE, DVec3::ZERO, |_| {
            false
        })
    }

    #[allow(dead_code, reason = "the benchmark `frame` uses it")]
    /// Returns bodies as those of [`with_spacing`](Self::with_spacing), so many of which have another place in each frame.
    pub(crate) fn restless(count: u32, spacing: f64, restless: usize) -> (Self, Scene) {
        let (world, scene) = Self::with_spacing(count, spacing);
        (Self { restless, ..world }, scene)
    }

    fn of(bodies: (u32, f64), axes: DVec3, common: DVec3, rests: fn(u32) -> bool) -> (Self, Scene) {
        Self::about(vec![DVec3::ZERO], bodies, axes, common, rests)
    }

    fn about(
        middles: Vec<DVec3>,
        (count, spacing): (u32, f64),
        axes: DVec3,
        common: DVec3,
        rests: fn(u32) -> bool,
    ) -> (Self, Scene) {
        let mut rng = generator(1);
        let of_one = f64::from(count) / middles.len() as f64;
        let half = 0.5 * spacing * of_one.powf(1.0 / axes.element_sum());
        let mut scene = Scene::new();
        let mut insert = |state| {
            let body = Body::new(Trajectory::coasting(state)?).with_hitbox(Hitbox::sphere(RADIUS)?);
            scene.insert(body)
        };
        let states = (0..count)
            .zip(middles.iter().cycle())
            .map(|(number, middle)| {
                let position = middle + axes * uniform_vector(&mut rng, half);
                let velocity = axes * uniform_vector(&mut rng, SPEED);
                let velocity = velocity * f64::from(u8::from(!rests(number)));
                let state = State::new(0.0, position, velocity + common);
                let inserted = insert(state);
                let id = inserted.unwrap_or_else(|error| panic!("a body is refused: {error}"));
                (id, state)
            });
        let states = states.collect();
        let world = Self {
            rng,
            half,
            axes,
            common,
            middles,
            restless: 0,
            frame: 0,
            states,
        };
        (world, scene)
    }

    #[allow(dead_code, reason = "the benchmark `frame` uses it")]
    /// Returns `count` bodies as those of [`new`](Self::new), and walls on all six sides of their cube.
    pub(crate) fn with_walls(count: u32) -> (Self, Scene) {
        let (world, mut scene) = Self::new(count);
        let mut insert = |normal: DVec3| {
            let wall = Body::new(Trajectory::at_rest(-world.half * normal)?);
            scene.insert(wall.with_hitbox(Hitbox::half_space(normal)?))
        };
        for normal in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
            insert(normal).unwrap_or_else(|error| panic!("a wall is refused: {error}"));
        }
        (world, scene)
    }
}

impl MovingBodies for World {
    fn now(&self) -> f64 {
        f64::from(self.frame) * STEP
    }

    fn states(&self) -> &[(BodyId, State)] {
        &self.states
    }

    /// A body that changes its velocity outside of the cube turns back. One that rests goes on resting.
    fn step(&mut self) {
        self.frame += 1;
        let now = self.now();
        let bodies = self.states.iter_mut().zip(self.middles.iter().cycle());
        for (number, ((_, state), middle)) in bodies.enumerate() {
            state.time = now;
            state.position += STEP * state.velocity;
            if state.velocity != self.common && self.rng.random_ratio(1, STEADY) {
                let velocity = self.axes * uniform_vector(&mut self.rng, SPEED);
                let place = state.position - now * self.common - middle;
                let inwards = -velocity.abs() * place.signum();
                let is_outside = place.abs().cmpgt(DVec3::splat(self.half));
                state.velocity = self.common + DVec3::select(is_outside, inwards, velocity);
            }
            if number < self.restless {
                state.position = middle + self.axes * uniform_vector(&mut self.rng, self.half);
            }
        }
    }
}
