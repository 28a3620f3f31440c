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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// What a batch comes to: what becomes of the bodies that it changes, and the new ones.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    pub(super) changed: BTreeMap<BodyId, Revision>,
    pub(super) inserted: Vec<Body>,
}

/// What of a body is replaced.
#[derive(Debug, Default)]
pub(super) struct Revision {
    pub(super) is_removed: bool,
    pub(super) trajectory: Option<Trajectory>,
    pub(super) hitbox: Option<Hitbox>,
    pub(super) layers: Option<Layers>,
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
                Command::Remove(id) => outcome.revision(scene, id)?.1.is_removed = true,
                Command::SetTrajectory(id, trajectory) => {
                    outcome.revision(scene, id)?.1.trajectory = Some(trajectory);
                }
                Command::SetHitbox(id, hitbox) => {
                    outcome.revision(scene, id)?.1.hitbox = Some(hitbox);
                }
                Command::SetLayers(id, layers) => {
                    outcome.revision(scene, id)?.1.layers = Some(layers);
                }
                Command::Replan(id, from, plan) => {
                    let (body, revision) = outcome.revision(scene, id)?;
                    revision.follow(body, Some(from), plan, forget_before)?;
                }
                Command::Extend(id, plan) => {
                    let (body, revision) = outcome.revision(scene, id)?;
                    revision.follow(body, None, plan, forget_before)?;
                }
            }
        }
        Ok(outcome)
    }

    /// The body as it is, and what the commands so far replace of it.
    fn revision<'s>(
        &mut self,
        scene: &'s Scene,
        id: BodyId,
    ) -> Result<(&'s Body, &mut Revision), Error> {
        let body = scene.body(id).ok_or(Error::UnknownBody { id })?;
        let revision = self.changed.entry(id).or_default();
        if revision.is_removed {
            return Err(Error::UnknownBody { id });
        }
        Ok((body, revision))
    }
}

impl Revision {
    /// The plan so far up to `from` (none: its last knot), then `plan`.
    fn follow(
        &mut self,
        body: &Body,
        from: Option<f64>,
        plan: Trajectory,
        forget_before: f64,
    ) -> Result<(), Error> {
        let flown = self.trajectory.as_ref().unwrap_or(&body.trajectory);
        let from = from.or(flown.knots().last().copied()).unwrap_or(0.0);
        let spliced = plan.preceded_by(flown, from, forget_before);
        self.trajectory = Some(spliced.map_err(|error| error.in_body(body.tag))?);
        Ok(())
    }
}
