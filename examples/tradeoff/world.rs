//! Scenes that are looked at: bodies in a cube, or those of a file.

use crate::read::{self, FileBody};
use crate::scenes::{Shape, swarm};
use crate::{Failure, terminal};
use nearmiss::{Body, Hitbox, Scene, State, Trajectory, Window};
use std::path::Path;

/// Bodies with their scene, and the time in which they are looked at.
pub(crate) struct World {
    pub(crate) scene: Scene,
    pub(crate) radius: f64,
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
            scene,
            radius: RADIUS,
            margin: 0.0,
            window: Window::new(0.0, duration)?,
        })
    }

    /// The bodies of a file of states, all with one radius (m): the one that is given, or that of the file.
    pub(crate) fn of_file(file: &Path, radius: Option<f64>, margin: f64) -> Result<Self, Failure> {
        let found = read::bodies(file)?;
        terminal::tell_unused(&found.unused);
        let radius = common_radius(&found.bodies, radius, &terminal::name(file))?;
        let reach = radius + 0.5 * margin;
        if reach > MAX_RADIUS {
            return Err(format!(
                "--margin: a radius of {radius} m and half of {margin:e} m are above {MAX_RADIUS:e} m"
            )
            .into());
        }
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

/// Returns the radius that all bodies of a file of this name have (m). The steppers know one only.
fn common_radius(bodies: &[FileBody], given: Option<f64>, name: &str) -> Result<f64, String> {
    let mut radii: Vec<f64> = bodies.iter().filter_map(|body| body.radius).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup();
    match (given, &radii[..]) {
        (_, []) => Ok(given.unwrap_or(RADIUS)),
        (Some(_), _) => Err(format!(
            "--radius: {name} has a column radius; leave one of the two out"
        )),
        (None, &[radius]) if radius <= MAX_RADIUS => Ok(radius),
        (None, &[radius]) => Err(format!(
            "{name}: column radius: {radius} is above {MAX_RADIUS:e} m"
        )),
        (None, &[least, .., largest]) => Err(format!(
            "{name}: column radius: bodies have radii from {least} to {largest} m, and the steppers know one \
             only; leave the column out and give --radius"
        )),
    }
}
