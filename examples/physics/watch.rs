//! The monitor: told all states each frame, in one call.

use crate::Failure;
use crate::world::{HALF_SIDES, Kind, Motion, RADIUS, instant};
use nearmiss::parry3d::shape::Cuboid;
use nearmiss::{
    AlertLevel, Body, BodyId, BodyState, CoverOptions, Event, Hitbox, Monitor, Scene, SphereCover,
    State, Trajectory,
};

/// Time ahead that the monitor looks at, s.
pub(crate) const LOOKAHEAD: f64 = 2.0;

/// Largest number of spheres that stand in for a box.
const SPHERES: usize = 16;

/// The monitor, and what it was told of.
#[derive(Debug)]
pub(crate) struct Watch {
    monitor: Monitor,
    ids: Vec<BodyId>,
    /// The spheres of a box.
    pub(crate) cover: SphereCover,
    /// Memory of a frame.
    events: Vec<Event>,
}

impl Watch {
    /// Bodies do not turn before the first frame is told.
    pub(crate) fn new(states: &[Motion]) -> Result<Self, Failure> {
        let cover = SphereCover::fit(&Cuboid::new(HALF_SIDES), &CoverOptions::new(SPHERES))?;
        let ball = Hitbox::sphere(f64::from(RADIUS))?;
        let cluster = Hitbox::from(cover.clone());
        let mut scene = Scene::new();
        let bodies = (0..).zip(states).map(|(number, motion)| {
            let hitbox = match motion.kind {
                Kind::Ball => &ball,
                Kind::Box => &cluster,
            };
            let body = Body::new(Trajectory::coasting(told(0, motion).state)?);
            scene.insert(body.with_hitbox(hitbox.clone()).with_tag(number))
        });
        let ids = bodies.collect::<Result<_, nearmiss::Error>>()?;
        Ok(Self {
            monitor: Monitor::new(scene, 0.0, LOOKAHEAD, &[AlertLevel::at(0.0)])?,
            ids,
            cover,
            events: Vec::new(),
        })
    }

    /// Tells the monitor the states of a frame. Returns the events up to its instant.
    pub(crate) fn tell(&mut self, frame: u32, states: &[Motion]) -> Result<&[Event], Failure> {
        let now = instant(frame);
        let states = states.iter().map(|motion| told(frame, motion));
        self.events.clear();
        self.monitor
            .track(now, self.ids.iter().copied().zip(states))?;
        self.monitor.advance(now, &mut self.events)?;
        Ok(&self.events)
    }
}

/// The state as the monitor takes it: in f64.
fn told(frame: u32, motion: &Motion) -> BodyState {
    let position = motion.position.as_dvec3();
    let velocity = motion.velocity.as_dvec3();
    let state = BodyState::from(State::new(instant(frame), position, velocity));
    match motion.kind {
        Kind::Ball => state,
        // The length of an f32 quaternion is 1 to seven digits.
        Kind::Box => state.with_spin(
            motion.rotation.as_dquat().normalize(),
            motion.angular_velocity.as_dvec3(),
        ),
    }
}
