//! Changes between ticks: one, or several that take effect together or not at all.

use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::scene::{Body, Scene};
use crate::trajectory::Trajectory;
use std::collections::BTreeMap;

/// One change to a monitor's scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Command {
    /// Adds a body.
    Insert(Body),
    /// Takes a body out.
    Remove(BodyId),
    /// Replaces a trajectory as a whole.
    SetTrajectory(BodyId, Trajectory),
    /// Replaces a hitbox.
    SetHitbox(BodyId, Hitbox),
    /// Replaces layers.
    SetLayers(BodyId, Layers),
    /// Keeps the old plan up to the time (s), then follows the new one: see
    /// [`Trajectory::spliced`].
    Replan(BodyId, f64, Trajectory),
    /// Appends: the old plan to its last knot, then the new one.
    Extend(BodyId, Trajectory),
}

/// What a batch comes to: the changed bodies as they will be, and the new ones.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    pub(super) changed: BTreeMap<BodyId, Option<Body>>,
    pub(super) inserted: Vec<Body>,
}

impl Outcome {
    /// Goes through the commands in order, each on what the ones before it left.
    ///
    /// `forget_before` (s) is where history ends: replanned bodies drop what is older.
    pub(super) fn of(
        scene: &Scene,
        commands: impl IntoIterator<Item = Command>,
        forget_before: f64,
    ) -> Result<Self, Error> {
        let mut outcome = Self::default();
        for command in commands {
            match command {
                Command::Insert(body) => outcome.inserted.push(body),
                Command::Remove(id) => {
                    outcome.body(scene, id)?;
                    outcome.changed.insert(id, None);
                }
                Command::SetTrajectory(id, trajectory) => {
                    outcome.body(scene, id)?.trajectory = trajectory;
                }
                Command::SetHitbox(id, hitbox) => outcome.body(scene, id)?.hitbox = hitbox,
                Command::SetLayers(id, layers) => outcome.body(scene, id)?.layers = layers,
                Command::Replan(id, from, plan) => {
                    let body = outcome.body(scene, id)?;
                    let spliced = body.trajectory.spliced(from, &plan);
                    let spliced = spliced.map_err(|error| error.in_body(body.tag))?;
                    body.trajectory = spliced.since(forget_before);
                }
                Command::Extend(id, plan) => {
                    let body = outcome.body(scene, id)?;
                    let from = body.trajectory.knots().last().copied().unwrap_or(0.0);
                    let spliced = body.trajectory.spliced(from, &plan);
                    let spliced = spliced.map_err(|error| error.in_body(body.tag))?;
                    body.trajectory = spliced.since(forget_before);
                }
            }
        }
        Ok(outcome)
    }

    /// The body as the commands so far have left it.
    fn body(&mut self, scene: &Scene, id: BodyId) -> Result<&mut Body, Error> {
        let entry = self
            .changed
            .entry(id)
            .or_insert_with(|| scene.body(id).cloned());
        entry.as_mut().ok_or(Error::UnknownBody { id })
    }
}
