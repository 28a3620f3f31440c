//! Scenes that are looked at: bodies in a cube, or those of a file.

use crate::Failure;
use crate::scenes::{Shape, swarm};
use nearmiss::{Body, Hitbox, Scene, State, Trajectory, Window};

/// Bodies with their scene, and the time in which they are looked at.
pub(crate) struct World {
    pub(crate) scene: Scene,
    pub(crate) radius: f64,
    pub(crate) margin: f64,
    pub(crate) window: Window,
}

impl World {
    /// Balls of 0.5 m, about 10 m/s fast, one in `spacing`³ m³, that touch each other.
    pub(crate) fn swarm(count: usize, spacing: f64, duration: f64) -> Result<Self, Failure> {
        /// Radius, m.
        const RADIUS: f64 = 0.5;
        /// Side of the cube for one body in the scene that is drawn together, m.
        const DRAWN: f64 = 65.6;
        let mut scene = Scene::new();
        for actor in swarm(count, Shape::Cube, 1).actors {
            let moved = actor.states[0].position * (spacing / DRAWN - 1.0);
            let states = actor.states.iter().map(|state| State {
                position: state.position + moved,
                ..*state
            });
            let plan = Trajectory::from_states(&states.collect::<Vec<_>>())?;
            scene.insert(Body::new(plan).with_hitbox(Hitbox::sphere(RADIUS)?))?;
        }
        Ok(Self {
            scene,
            radius: RADIUS,
            margin: 0.0,
            window: Window::new(0.0, duration)?,
        })
    }

    /// Returns the bodies' trajectories, in the order of their numbers.
    pub(crate) fn plans(&self) -> Vec<&Trajectory> {
        self.scene
            .bodies()
            .map(|(_, body)| &body.trajectory)
            .collect()
    }
}
