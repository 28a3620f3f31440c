//! Scenes that are looked at: bodies in a cube, or those of a file.

use crate::scenes::{Shape, swarm};
use crate::{Failure, read};
use nearmiss::{Body, Hitbox, Scene, State, Trajectory, Window};
use std::path::Path;

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

    /// The bodies of a file of states, all with one radius (m).
    pub(crate) fn of_file(file: &Path, radius: f64, margin: f64) -> Result<Self, Failure> {
        let found = read::bodies(file)?;
        let mut scene = Scene::new();
        for body in found.bodies {
            let tag = body.tag;
            let hitbox = Hitbox::sphere(radius)?;
            scene.insert(Body::new(body.trajectory).with_hitbox(hitbox).with_tag(tag))?;
        }
        let knots = scene.bodies().map(|(_, body)| body.trajectory.domain());
        let ends = knots.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), own| {
            (from.min(own.start()), to.max(own.end()))
        });
        Ok(Self {
            scene,
            radius,
            margin,
            window: Window::new(ends.0, ends.1)?,
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
