//! The bodies of the game: a swarm at constant density whose plans are made up as it flies.
//!
//! The same kind of motion as the stress scene `swarm`: 32 cubics over 60 s at irregular knots,
//! smooth random velocities (Ornstein-Uhlenbeck), 1 m radius; other settings have bodies that turn.

use crate::floor::Floor;
use glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyId, BodyPlan, Command, Encounter, Error, Event, EventKind, Hitbox,
    Monitor, Orientation, Scene, State, Trajectory,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::error::Error as StdError;

type Failure = Box<dyn StdError + Send + Sync>;

/// Cubics in a plan.
const SEGMENTS: u32 = 32;
/// Duration of a new plan, s.
const HORIZON: f64 = 60.0;
/// Root mean square speed, m/s.
pub(crate) const SPEED: f64 = 10.0;
/// Time in which a velocity is forgotten, s.
const MEMORY: f64 = 10.0;
/// m.
pub(crate) const RADIUS: f64 = 1.0;
/// Lookahead of the monitor, s.
pub(crate) const LOOKAHEAD: f64 = 10.0;

/// The kinds of bodies, their density, and the alert levels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    /// In turns.
    pub(crate) kinds: &'static [Kind],
    pub(crate) hitbox: fn(Kind) -> Result<Hitbox, Failure>,
    /// Side of the cube for one body, m.
    pub(crate) spacing: f64,
    /// Bodies do not come nearer than this to others within `BORN_CLEAR`, m, if all keep their first velocities.
    pub(crate) clearance: f64,
    /// Height above the floor, the bottom of the cube, that bodies come back to, m; without a floor, none.
    pub(crate) headroom: Option<f64>,
    pub(crate) levels: &'static [AlertLevel],
    /// Places of two of the levels.
    pub(crate) warning: usize,
    pub(crate) contact: usize,
}

/// Time for which bodies are clear of others when they appear, s.
const BORN_CLEAR: f64 = 2.5;
/// Places that are tried for a body that appears.
const MAX_BIRTHS: u32 = 1_000;

impl Setting {
    /// The stress scene: spheres of 1 m at constant density.
    pub(crate) const STRESS: Self = Self {
        kinds: &[Kind::Sphere],
        hitbox: |_| Ok(Hitbox::sphere(RADIUS)?),
        spacing: 65.6,
        clearance: 0.0,
        headroom: None,
        levels: &[AlertLevel::at(3.0), AlertLevel::at(0.0)],
        warning: 0,
        contact: 1,
    };
}

/// Kind of body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Sphere,
    Ship,
    Drone,
    Asteroid,
}

impl Kind {
    const fn attitude(self) -> Attitude {
        match self {
            Self::Sphere => Attitude::Fixed,
            Self::Ship => Attitude::AlongFlight,
            Self::Drone | Self::Asteroid => Attitude::Spin,
        }
    }
}

/// The rotation of a body over its plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Attitude {
    Fixed,
    /// Its axis x points where it flies.
    AlongFlight,
    /// At a constant angular velocity of its own.
    Spin,
}

/// All bodies under one monitor, and the dice that their plans are made with.
#[derive(Debug)]
pub(crate) struct Fleet {
    pub(crate) monitor: Monitor,
    pub(crate) bodies: Vec<BodyId>,
    pub(crate) floor: Option<Floor>,
    pub(crate) setting: Setting,
    planner: Planner,
}

/// Makes plans.
#[derive(Debug)]
pub(crate) struct Planner {
    rng: ChaCha8Rng,
    /// Half the side of the cube that the bodies keep to, m.
    half: f64,
    /// Height that they keep above, m.
    bottom: f64,
}

impl Fleet {
    /// `count` bodies at time 0, each with a plan.
    pub(crate) fn new(setting: Setting, count: usize, seed: u64) -> Result<Self, Failure> {
        let number = f64::from(u32::try_from(count).unwrap_or(u32::MAX));
        let half = setting.spacing * number.cbrt() / 2.0;
        let mut planner = Planner {
            rng: ChaCha8Rng::seed_from_u64(seed),
            half,
            bottom: setting.headroom.unwrap_or_default() - half,
        };
        let mut scene = Scene::new();
        let (mut bodies, mut starts) = (Vec::with_capacity(count), Vec::new());
        for index in 0..count {
            let Some(start) = planner.clear_start(&setting, 0.0, &starts) else {
                let problem = format!(
                    "--bodies: there is no room for {count} that stay clear of each other; take fewer"
                );
                return Err(problem.into());
            };
            if setting.clearance > 0.0 {
                starts.push(start);
            }
            bodies.push(scene.insert(planner.body(&setting, index, start)?)?);
        }
        let floor = match setting.headroom {
            Some(_) => Some(Floor {
                id: scene.insert(Floor::body(-half)?)?,
                height: -half,
            }),
            None => None,
        };
        Ok(Self {
            monitor: Monitor::new(scene, 0.0, LOOKAHEAD, setting.levels)?,
            bodies,
            floor,
            setting,
            planner,
        })
    }

    /// Another body, from now on; false if there is no room for one.
    pub(crate) fn add(&mut self) -> Result<bool, Failure> {
        let now = self.monitor.now();
        let others: Vec<State> = self
            .bodies
            .iter()
            .filter_map(|&id| self.state(id))
            .collect();
        let Some(start) = self.planner.clear_start(&self.setting, now, &others) else {
            return Ok(false);
        };
        let body = self.planner.body(&self.setting, self.bodies.len(), start)?;
        self.bodies.push(self.monitor.insert(body)?);
        Ok(true)
    }

    /// Returns the place of a body at the monitor's clock.
    pub(crate) fn state(&self, id: BodyId) -> Option<State> {
        let body = self.monitor.scene().body(id)?;
        body.trajectory.state(self.monitor.now())
    }

    /// The kind of a body that flies.
    pub(crate) fn kind(&self, id: BodyId) -> Kind {
        let tag = self.monitor.scene().body(id).map_or(0, |body| body.tag);
        self.setting.kind(usize::try_from(tag).unwrap_or_default())
    }

    pub(crate) fn is_floor(&self, id: BodyId) -> bool {
        self.floor.is_some_and(|floor| floor.id == id)
    }

    /// The number of a body as it is shown.
    pub(crate) fn name(&self, id: BodyId) -> String {
        if self.is_floor(id) {
            "floor".to_owned()
        } else {
            format!("#{}", id.slot())
        }
    }

    /// Both places of a closest approach, m: of a floor, the point below the other body.
    pub(crate) fn closest_places(&self, encounter: &Encounter) -> [DVec3; 2] {
        let (a, b) = (encounter.closest.position_a, encounter.closest.position_b);
        match self.floor {
            Some(floor) if floor.id == encounter.a => [floor.foot(b), b],
            Some(floor) if floor.id == encounter.b => [a, floor.foot(a)],
            _ => [a, b],
        }
    }

    /// New plans from now on for a share of the bodies, picked at random, as a whim would.
    pub(crate) fn whims(&mut self, share: f64) -> Result<Vec<(BodyId, BodyPlan)>, Error> {
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
    pub(crate) fn fresh_plan(&mut self, id: BodyId) -> Result<Option<(BodyId, BodyPlan)>, Error> {
        let Some(state) = self.state(id) else {
            return Ok(None);
        };
        let plan = self.planner.plan(state)?;
        Ok(Some((id, self.turned(id, plan)?)))
    }

    /// The plan with the way in which the body turns: from its rotation at the monitor's clock on.
    pub(crate) fn turned(&self, id: BodyId, plan: Trajectory) -> Result<BodyPlan, Error> {
        let Some(body) = self.monitor.scene().body(id) else {
            return Ok(plan.into());
        };
        // A spin goes on as it is.
        if self.kind(id).attitude() != Attitude::AlongFlight {
            return Ok(plan.into());
        }
        let start = body.orientation.rotation(self.monitor.now());
        let orientation = along(&plan, start)?;
        Ok(BodyPlan::new(plan, orientation))
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
    pub(crate) fn commands(&self, plans: Vec<(BodyId, BodyPlan)>) -> Vec<Command> {
        let now = self.monitor.now();
        let commands = plans.into_iter();
        commands
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

/// The least distance of two bodies that keep their velocities, within `BORN_CLEAR`, m.
fn nearest(a: &State, b: &State) -> f64 {
    let (position, velocity) = (a.position - b.position, a.velocity - b.velocity);
    let time = -position.dot(velocity) / velocity.length_squared().max(1e-12);
    (position + velocity * time.clamp(0.0, BORN_CLEAR)).length()
}

/// The least height of a body that keeps its velocity, within `BORN_CLEAR`, m.
fn lowest(state: &State) -> f64 {
    state.position.y + BORN_CLEAR * state.velocity.y.min(0.0)
}

/// From a rotation on, the axis x turns after the velocity the shortest way, which does not roll.
fn along(plan: &Trajectory, start: DQuat) -> Result<Orientation, Error> {
    /// From knot to knot, s.
    const STEP: f64 = 0.6;
    let (Some(&first), Some(&last)) = (plan.knots().first(), plan.knots().last()) else {
        return Ok(Orientation::FIXED);
    };
    let (mut time, mut rotation) = (first, start);
    let mut knots = vec![(time, rotation)];
    while time < last {
        time = (time + STEP).min(last);
        let heading = rotation * DVec3::X;
        let velocity = plan.velocity(time).unwrap_or_default();
        let wanted = velocity.normalize_or(heading);
        // There is no shortest way to the opposite: it flies backwards for a moment.
        if heading.dot(wanted) > -0.99 {
            rotation = (DQuat::from_rotation_arc(heading, wanted) * rotation).normalize();
        }
        knots.push((time, rotation));
    }
    Orientation::slerp(&knots)
}

impl Planner {
    /// The body with this number.
    fn body(&mut self, setting: &Setting, index: usize, start: State) -> Result<Body, Failure> {
        let plan = self.plan(start)?;
        let kind = setting.kind(index);
        let orientation = match kind.attitude() {
            Attitude::Fixed => Orientation::FIXED,
            Attitude::AlongFlight => {
                let heading = start.velocity.normalize_or(DVec3::X);
                along(&plan, DQuat::from_rotation_arc(DVec3::X, heading))?
            }
            Attitude::Spin => {
                let rotation =
                    DQuat::from_rotation_arc(DVec3::X, self.gust(1.0).normalize_or(DVec3::X));
                Orientation::spin(start.time, rotation, self.gust(0.6))?
            }
        };
        Ok(Body::new(plan)
            .with_hitbox((setting.hitbox)(kind)?)
            .with_orientation(orientation)
            .with_tag(index as u64))
    }

    /// A start that keeps clear of others for a while; none where that is too hard to find.
    fn clear_start(&mut self, setting: &Setting, time: f64, others: &[State]) -> Option<State> {
        let bottom = self.bottom;
        (0..MAX_BIRTHS).map(|_| self.start(time)).find(|start| {
            let is_high = setting.headroom.is_none() || lowest(start) >= bottom;
            let is_apart = |other| nearest(start, other) >= setting.clearance;
            is_high && others.iter().all(is_apart)
        })
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
            let low = DVec3::new(-self.half, self.bottom, -self.half);
            let overshoot = state.position - state.position.clamp(low, DVec3::splat(self.half));
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
