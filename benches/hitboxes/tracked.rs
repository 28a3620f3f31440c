//! Bodies of one kind under a monitor that is told of all of them in each frame.

use crate::world::{MARGIN, MovingBodies, World};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{AlertLevel, Body, BodyId, BodyState, Event, Hitbox, Monitor, Scene, Trajectory};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Time ahead of the present frame that is looked at, s.
const LOOKAHEAD: f64 = 2.0;

/// The rotation of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub(crate) rotation: DQuat,
    /// rad/s.
    pub(crate) angular_velocity: DVec3,
}

/// A world, its monitor, and how its bodies turn.
pub(crate) struct Tracked {
    world: World,
    ids: Vec<BodyId>,
    /// None for a body that is told without a spin.
    turns: Vec<Option<Turn>>,
    monitor: Monitor,
    states: Vec<(BodyId, BodyState)>,
    events: Vec<Event>,
}

impl Tracked {
    /// Returns `count` bodies whose lookahead is known.
    pub(crate) fn new(count: u32, mut make: impl FnMut() -> (Hitbox, Option<Turn>)) -> Self {
        let (world, _) = World::new(count);
        let mut scene = Scene::new();
        let (mut ids, mut turns) = (Vec::new(), Vec::new());
        for (_, state) in world.states() {
            let (hitbox, turn) = make();
            let body = Body::new(Trajectory::coasting(*state).unwrap()).with_hitbox(hitbox);
            ids.push(scene.insert(body).unwrap());
            turns.push(turn);
        }
        let monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &[AlertLevel::at(MARGIN)]).unwrap();
        let mut tracked = Self {
            world,
            ids,
            turns,
            monitor,
            states: Vec::new(),
            events: Vec::new(),
        };
        tracked.tell(0.0);
        tracked
    }

    /// Lets the world go on by a frame, and tells it. Returns the time from telling it until the events are
    /// there.
    pub(crate) fn frame(&mut self) -> Duration {
        let before = self.world.now();
        self.world.step();
        let now = self.world.now();
        for turn in self.turns.iter_mut().flatten() {
            let further = DQuat::from_scaled_axis(turn.angular_velocity * (now - before));
            turn.rotation = (further * turn.rotation).normalize();
        }
        self.tell(now)
    }

    fn tell(&mut self, now: f64) -> Duration {
        let told = self.ids.iter().zip(self.world.states()).zip(&self.turns);
        self.states.clear();
        self.states.extend(told.map(|((&id, (_, state)), turn)| {
            let state = BodyState::from(*state);
            let spinning = |turn: Turn| state.with_spin(turn.rotation, turn.angular_velocity);
            (id, turn.map_or(state, spinning))
        }));
        self.events.clear();
        let begin = Instant::now();
        self.monitor
            .track(now, self.states.iter().copied())
            .unwrap();
        self.monitor.advance(now, &mut self.events).unwrap();
        black_box(&self.events);
        begin.elapsed()
    }
}
