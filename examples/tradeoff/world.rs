//! Scenes that are looked at: bodies in a cube, or those of a file.

use crate::read;
use crate::scenes::{Shape, swarm};
use crate::{Failure, terminal};
use nearmiss::{Body, Hitbox, Scene, State, Trajectory, Window};
use std::path::Path;

/// Bodies with their scene, and the time in which they are looked at.
pub(crate) struct World {
    pub(crate) scene: Scene,
    /// The radius of each body, m.
    pub(crate) radii: Vec<f64>,
    pub(crate) margin: f64,
    pub(crate) window: Window,
}

/// Radius of bodies that have no other one, m.
const RADIUS: f64 = 0.5;

/// Largest radius, with half of the margin, m: the steppers work in f32.
pub(crate) const MAX_RADIUS: f64 = 1e9;

impl World {
    /// Balls of 0.5 m, about 10 m/s fast, one in `spacing`³ m³, that touch each other.
    pub(crate) fn swarm(count: usize, spacing: f64, duration: f64) -> Result<Self, Failure> {
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
            radii: vec![RADIUS; scene.len()],
            scene,
            margin: 0.0,
            window: Window::new(0.0, duration)?,
        })
    }

    /// The bodies of a file of states. Their radii (m) are those of the file, or all the one that is given.
    pub(crate) fn of_file(file: &Path, radius: Option<f64>, margin: f64) -> Result<Self, Failure> {
        let found = read::bodies(file)?;
        terminal::tell_unused(&found.unused);
        let (mut scene, mut radii) = (Scene::new(), Vec::new());
        for body in found.bodies {
            if radius.is_some() && body.radius.is_some() {
                return Err(format!(
                    "--radius: {} has a column radius; leave one of the two out",
                    terminal::name(file)
                )
                .into());
            }
            let radius = body.radius.or(radius).unwrap_or(RADIUS);
            if radius > MAX_RADIUS {
                let name = terminal::name(file);
                return Err(
                    format!("{name}: column radius: {radius} is above {MAX_RADIUS:e} m").into(),
                );
            }
            let reach = radius + 0.5 * margin;
            if !(0.0..=MAX_RADIUS).contains(&reach) {
                return Err(format!(
                    "--margin: a radius of {radius} m and half of {margin:e} m are not within 0 and {MAX_RADIUS:e} m"
                )
                .into());
            }
            let tag = body.tag;
            let hitbox = Hitbox::sphere(radius)?;
            scene.insert(Body::new(body.trajectory).with_hitbox(hitbox).with_tag(tag))?;
            radii.push(radius);
        }
        let knots = scene.bodies().map(|(_, body)| body.trajectory.domain());
        let ends = knots.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), own| {
            (from.min(own.start()), to.max(own.end()))
        });
        Ok(Self {
            scene,
            radii,
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
