//! The bodies of the game: a swarm at constant density whose plans are made up as it flies.
//!
//! The same kind of motion as the stress scene `swarm`: 32 cubics over 60 s at irregular knots,
//! smooth random velocities (Ornstein-Uhlenbeck), 1 m radius.

use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Command, Error, Event, EventKind, Hitbox, Monitor, Scene, Sphere,
    State, Trajectory,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Cubics in a plan.
const SEGMENTS: u32 = 32;
/// How far ahead a body plans, s.
const HORIZON: f64 = 60.0;
/// Root mean square speed, m/s.
pub(crate) const SPEED: f64 = 10.0;
/// Time in which a velocity is forgotten, s.
const MEMORY: f64 = 10.0;
/// m.
pub(crate) const RADIUS: f64 = 1.0;
/// How far ahead the monitor looks, s.
pub(crate) const LOOKAHEAD: f64 = 10.0;

/// Who flies, how densely, and what is watched.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    /// In turns.
    pub(crate) kinds: &'static [Kind],
    /// Side of the cube for one body, m.
    pub(crate) spacing: f64,
    pub(crate) levels: &'static [AlertLevel],
    /// Places of two of the levels.
    pub(crate) warning: usize,
    pub(crate) contact: usize,
}

impl Setting {
    /// The stress scene: spheres of 1 m at constant density.
    pub(crate) const STRESS: Self = Self {
        kinds: &[Kind::Sphere],
        spacing: 65.6,
        levels: &[AlertLevel::at(3.0), AlertLevel::at(0.0)],
        warning: 0,
        contact: 1,
    };

    /// Something to look at: denser, and of three kinds.
    pub(crate) const SHOW: Self = Self {
        kinds: &[
            Kind::Ship,
            Kind::Drone,
            Kind::Drone,
            Kind::Ship,
            Kind::Asteroid,
        ],
        spacing: 26.0,
        levels: &[
            AlertLevel::at(8.0),
            AlertLevel::at(3.0),
            AlertLevel::at(0.0),
        ],
        warning: 1,
        contact: 2,
    };
}

/// What flies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Sphere,
    Ship,
    Drone,
    Asteroid,
}

impl Kind {
    fn hitbox(self) -> Result<Hitbox, Error> {
        let sphere = |x: f64, y: f64, z: f64, radius: f64| Sphere {
            offset: DVec3::new(x, y, z),
            radius,
        };
        match self {
            Self::Sphere => Hitbox::sphere(RADIUS),
            Self::Drone => Hitbox::sphere(0.8),
            Self::Ship => Hitbox::cluster(vec![
                sphere(0.0, 0.0, 0.0, 1.3),
                sphere(1.4, 0.0, 0.0, 0.8),
                sphere(-1.4, 0.0, 0.0, 0.8),
            ]),
            Self::Asteroid => Hitbox::cluster(vec![
                sphere(0.0, 0.0, 0.0, 2.4),
                sphere(1.3, 0.7, -0.4, 1.7),
                sphere(-1.1, -0.5, 0.9, 1.8),
            ]),
        }
    }
}

/// All bodies under one monitor, and the dice that their plans are made with.
#[derive(Debug)]
pub(crate) struct Fleet {
    pub(crate) monitor: Monitor,
    pub(crate) bodies: Vec<BodyId>,
    pub(crate) setting: Setting,
    planner: Planner,
}

/// Makes plans.
#[derive(Debug)]
pub(crate) struct Planner {
    rng: ChaCha8Rng,
    /// Half the side of the cube that the bodies keep to, m.
    half: f64,
}

impl Fleet {
    /// `count` bodies at time 0, each with a plan.
    pub(crate) fn new(setting: Setting, count: usize, seed: u64) -> Result<Self, Error> {
        let number = f64::from(u32::try_from(count).unwrap_or(u32::MAX));
        let mut planner = Planner {
            rng: ChaCha8Rng::seed_from_u64(seed),
            half: setting.spacing * number.cbrt() / 2.0,
        };
        let mut scene = Scene::new();
        let bodies = (0..count)
            .map(|index| {
                let start = planner.start(0.0);
                scene.insert(planner.body(setting.kind(index), start)?)
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            monitor: Monitor::new(scene, 0.0, LOOKAHEAD, setting.levels)?,
            bodies,
            setting,
            planner,
        })
    }

    /// Another body, from now on.
    pub(crate) fn add(&mut self) -> Result<(), Error> {
        let start = self.planner.start(self.monitor.now());
        let kind = self.setting.kind(self.bodies.len());
        let body = self.planner.body(kind, start)?;
        self.bodies.push(self.monitor.insert(body)?);
        Ok(())
    }

    /// Where a body is at the monitor's clock.
    pub(crate) fn state(&self, id: BodyId) -> Option<State> {
        let body = self.monitor.scene().body(id)?;
        body.trajectory.state(self.monitor.now())
    }

    /// New plans from now on for a share of the bodies, picked at random, as a whim would.
    pub(crate) fn whims(&mut self, share: f64) -> Result<Vec<(BodyId, Trajectory)>, Error> {
        let expected = share * f64::from(u32::try_from(self.bodies.len()).unwrap_or(u32::MAX));
        let whole = expected.floor();
        let extra = self
            .planner
            .rng
            .random_bool((expected - whole).clamp(0.0, 1.0));
        let mut left = whole + f64::from(u8::from(extra));
        let mut plans = Vec::new();
        let mut picked = vec![false; self.bodies.len()];
        while left >= 1.0 && plans.len() < self.bodies.len() {
            let index = self.planner.rng.random_range(0..self.bodies.len());
            if std::mem::replace(&mut picked[index], true) {
                continue;
            }
            plans.extend(self.fresh_plan(self.bodies[index])?);
            left -= 1.0;
        }
        Ok(plans)
    }

    /// A new plan from now on for one body.
    pub(crate) fn fresh_plan(&mut self, id: BodyId) -> Result<Option<(BodyId, Trajectory)>, Error> {
        let Some(state) = self.state(id) else {
            return Ok(None);
        };
        Ok(Some((id, self.planner.plan(state)?)))
    }

    /// The bodies whose plans, as the monitor told, end within the lookahead.
    pub(crate) fn running_out(events: &[Event]) -> Vec<BodyId> {
        let ends = |event: &Event| match event.kind {
            EventKind::PlanEnds { body, .. } => Some(body),
            _ => None,
        };
        events.iter().filter_map(ends).collect()
    }

    /// Half the side of the cube that the bodies keep to, m.
    pub(crate) const fn half(&self) -> f64 {
        self.planner.half
    }

    pub(crate) fn planner(&mut self) -> &mut Planner {
        &mut self.planner
    }

    /// The plans as commands that take effect at the monitor's clock.
    pub(crate) fn commands(&self, plans: Vec<(BodyId, Trajectory)>) -> Vec<Command> {
        let now = self.monitor.now();
        plans
            .into_iter()
            .map(|(id, plan)| Command::Replan(id, now, plan))
            .collect()
    }
}

impl Setting {
    /// Of the body with this number.
    pub(crate) fn kind(&self, index: usize) -> Kind {
        self.kinds[index % self.kinds.len()]
    }
}

impl Planner {
    fn body(&mut self, kind: Kind, start: State) -> Result<Body, Error> {
        Ok(Body::new(self.plan(start)?).with_hitbox(kind.hitbox()?))
    }

    fn start(&mut self, time: f64) -> State {
        let half = self.half;
        let position = self.vector(|rng| rng.random_range(-half..half));
        let velocity = self.gust(SPEED);
        State::new(time, position, velocity)
    }

    /// A plan from a state on: its velocity fades into random ones.
    pub(crate) fn plan(&mut self, from: State) -> Result<Trajectory, Error> {
        self.plan_with(from, DVec3::ZERO)
    }

    /// The same, turned by `push` (m/s) within the first knots: a way to steer.
    pub(crate) fn plan_with(&mut self, from: State, push: DVec3) -> Result<Trajectory, Error> {
        let mean = HORIZON / f64::from(SEGMENTS);
        let mut state = from;
        let mut states = Vec::with_capacity(SEGMENTS as usize + 1);
        states.push(state);
        for k in 0..SEGMENTS {
            let gap = mean * self.rng.random_range(0.4..1.6);
            let kept = (-gap / MEMORY).exp();
            let mut velocity =
                state.velocity * kept + self.gust(SPEED * (1.0 - kept * kept).sqrt());
            if k == 0 {
                velocity += push;
            }
            // Back into the cube, at the pace at which velocities are forgotten.
            let overshoot = state.position
                - state
                    .position
                    .clamp(DVec3::splat(-self.half), DVec3::splat(self.half));
            velocity -= overshoot / MEMORY * (1.0 - kept);
            let position = state.position + (state.velocity + velocity) * (gap / 2.0);
            state = State::new(state.time + gap, position, velocity);
            states.push(state);
        }
        Trajectory::from_states(&states)
    }

    /// A random vector with this root mean square length.
    pub(crate) fn gust(&mut self, length: f64) -> DVec3 {
        // Uniform numbers with the right variance: what adds up of them is near enough to normal.
        let half = length;
        self.vector(|rng| rng.random_range(-half..=half))
    }

    fn vector(&mut self, mut number: impl FnMut(&mut ChaCha8Rng) -> f64) -> DVec3 {
        DVec3::new(
            number(&mut self.rng),
            number(&mut self.rng),
            number(&mut self.rng),
        )
    }
}
