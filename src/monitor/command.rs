//! Changes between ticks: one, or several that take effect together or not at all.

use super::monitored_bodies::MonitoredBody;
use super::pending_change::{ChangeContext, PendingChange, Refusal};
use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::orientation::Orientation;
use crate::parallel;
use crate::scene::{Body, BodyPlan, Scene};
use crate::trajectory::Trajectory;

/// A change to a monitor's scene, for [`Monitor::apply`](crate::Monitor::apply) or to be sent to a
/// live monitor.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Command {
    /// Adds a body.
    Insert(Body),
    /// Adds a body that ignores some others from the beginning, as a shot does the one who fires it: see
    /// [`Monitor::ignore_pair`](crate::Monitor::ignore_pair).
    InsertIgnoring(Body, Vec<BodyId>),
    /// Takes a body out.
    Remove(BodyId),
    /// Replaces a trajectory as a whole.
    SetTrajectory(BodyId, Trajectory),
    /// Replaces a hitbox.
    SetHitbox(BodyId, Hitbox),
    /// Replaces an orientation as a whole.
    SetOrientation(BodyId, Orientation),
    /// Replaces layers.
    SetLayers(BodyId, Layers),
    /// Replaces a model error (m): see [`Body::with_model_error`].
    SetModelError(BodyId, f64),
    /// Keeps the old plan up to the time (s), then follows the new one: see
    /// [`Monitor::replan`](crate::Monitor::replan). A trajectory alone is `trajectory.into()`.
    Replan(BodyId, f64, BodyPlan),
    /// Keeps the old orientation up to the time (s), then follows the new one: see
    /// [`Monitor::orient`](crate::Monitor::orient).
    Orient(BodyId, f64, Orientation),
    /// Appends a plan after the last knot: see [`Monitor::extend`](crate::Monitor::extend). A trajectory alone is
    /// `trajectory.into()`.
    Extend(BodyId, BodyPlan),
    /// Ignores a pair: see [`Monitor::ignore_pair`](crate::Monitor::ignore_pair).
    IgnorePair(BodyId, BodyId),
    /// Stops ignoring a pair.
    UnignorePair(BodyId, BodyId),
}

/// The outcome of a batch: changed bodies and new ones. Its memory is reused.
#[derive(Debug, Default)]
pub(super) struct CommandBatch {
    /// Changes, one for each body, in the order of the commands.
    pub(super) changed: Vec<PendingChange>,
    /// Index in `changed` of each slot's change, valid if that entry is of this slot.
    place_of: Vec<usize>,
    pub(super) inserted: Vec<NewBody>,
    /// Pairs to ignore, or to stop ignoring, in the order of the commands.
    pub(super) pairs: Vec<(BodyId, BodyId, PairRule)>,
}

/// A body that is inserted, and those that it ignores.
pub(super) type NewBody = (Body, MonitoredBody, Vec<BodyId>);

/// The rule for a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairRule {
    Ignored,
    Unignored,
}

impl CommandBatch {
    /// Number of changes that one thread prepares at a time.
    const CHUNK: usize = 64;
    /// Number of changes not worth another thread: 0.3 ms of preparing or dropping.
    pub(super) const FEW: usize = 1024;
    /// Distance of prefetches, in changes: bodies lie anywhere in memory.
    pub(super) const AHEAD: usize = 4;

    /// Prepares the commands in order, each on the outcome of those before. Returns the first
    /// refusal.
    pub(super) fn work_out(
        &mut self,
        scene: &Scene,
        commands: impl IntoIterator<Item = Command>,
        context: &ChangeContext<'_>,
    ) -> Result<(), Refusal> {
        self.clear();
        let mut refused = None;
        for (number, command) in commands.into_iter().enumerate() {
            if let Err(refusal) = self.take(scene, (number, command), context) {
                refused = Some(refusal);
                break;
            }
        }
        let few = (self.changed.len(), Self::FEW);
        parallel::for_each_chunk(&mut self.changed, Self::CHUNK, few, |_, changes| {
            for index in 0..changes.len() {
                if let Some(later) = changes.get(index + 2 * Self::AHEAD) {
                    scene.prefetch(later.id.slot);
                }
                if let Some(later) = changes.get(index + Self::AHEAD) {
                    let old = scene.body(later.id).map(|body| &body.trajectory);
                    let both = old.into_iter().chain(&later.trajectory);
                    both.for_each(Trajectory::prefetch);
                }
                let change = &mut changes[index];
                change.refusal = change.prepare(scene, context).err();
            }
        });
        let changed = self.changed.iter_mut();
        let refusals = changed.filter_map(|change| change.refusal.take());
        let first = refusals.chain(refused).min_by_key(|refusal| refusal.0);
        // A game may write all that it knows of a body in each frame.
        self.changed.retain(|change| !change.is_in_vain);
        first.map_or(Ok(()), Err)
    }

    /// Returns the bodies whose last plan was late, and from when on they follow it (s).
    pub(super) fn late(&self) -> impl Iterator<Item = (BodyId, f64)> {
        let there = self.changed.iter().filter(|changed| !changed.is_removed);
        there.filter_map(|changed| Some((changed.id, changed.late?)))
    }

    /// Drops all changes, and the values they replaced.
    pub(super) fn clear(&mut self) {
        // Freeing memory reads both of its ends, which lie anywhere.
        for index in 0..self.changed.len() {
            let later = self.changed.get(index + 2 * Self::AHEAD);
            if let Some(later) = later.and_then(|later| later.trajectory.as_ref()) {
                later.prefetch_ends();
            }
            self.changed[index].trajectory = None;
        }
        self.changed.clear();
        self.inserted.clear();
        self.pairs.clear();
    }

    fn take(
        &mut self,
        scene: &Scene,
        (number, command): (usize, Command),
        context: &ChangeContext<'_>,
    ) -> Result<(), Refusal> {
        let refuse = |error| (number, error);
        match command {
            Command::Insert(body) => {
                let new = (body, Vec::new());
                self.insert(scene, new, context).map_err(refuse)?;
            }
            Command::InsertIgnoring(body, ignored) => {
                let new = (body, ignored);
                self.insert(scene, new, context).map_err(refuse)?;
            }
            Command::IgnorePair(a, b) => {
                self.pair(scene, (a, b), PairRule::Ignored)
                    .map_err(refuse)?;
            }
            Command::UnignorePair(a, b) => {
                self.pair(scene, (a, b), PairRule::Unignored)
                    .map_err(refuse)?;
            }
            Command::Remove(id) => self.change_of(scene, id, number)?.is_removed = true,
            Command::SetTrajectory(id, trajectory) => {
                let change = self.change_of(scene, id, number)?;
                change.splice(scene, context)?;
                change.own_knots = trajectory.knots().len();
                change.trajectory = Some(trajectory);
                change.late = None;
            }
            Command::SetHitbox(id, hitbox) => {
                self.change_of(scene, id, number)?.hitbox = Some(hitbox);
            }
            Command::SetOrientation(id, orientation) => {
                self.change_of(scene, id, number)?.orientation = Some(orientation);
            }
            Command::SetLayers(id, layers) => {
                self.change_of(scene, id, number)?.layers = Some(layers);
            }
            Command::SetModelError(id, metres) => {
                let change = self.change_of(scene, id, number)?;
                change.set_model_error(scene, Some(metres))?;
            }
            Command::Orient(id, from, next) => {
                let change = self.change_of(scene, id, number)?;
                change.orient(scene, (from, &next), context)?;
            }
            Command::Replan(id, from, plan) => {
                let change = self.change_of(scene, id, number)?;
                change.follow(scene, Some(from), plan.trajectory, context)?;
                if let Some(next) = &plan.orientation {
                    change.orient(scene, (from, next), context)?;
                }
                change.set_model_error(scene, plan.model_error)?;
            }
            Command::Extend(id, plan) => {
                let change = self.change_of(scene, id, number)?;
                let turn = match &plan.orientation {
                    Some(next) => Some((change.last_knot(scene, context)?, next)),
                    None => None,
                };
                change.follow(scene, None, plan.trajectory, context)?;
                if let Some(turn) = turn {
                    change.orient(scene, turn, context)?;
                }
                change.set_model_error(scene, plan.model_error)?;
            }
        }
        Ok(())
    }

    /// Notes a new body, and those that it ignores.
    fn insert(
        &mut self,
        scene: &Scene,
        (body, ignored): (Body, Vec<BodyId>),
        context: &ChangeContext<'_>,
    ) -> Result<(), Error> {
        let monitored = context.monitored_body_of(&body)?;
        for &id in &ignored {
            self.check_not_removed(id)?;
            scene.body(id).ok_or(Error::UnknownBody { id })?;
        }
        self.inserted.push((body, monitored, ignored));
        Ok(())
    }

    /// Checks that no command before has removed a body.
    fn check_not_removed(&self, id: BodyId) -> Result<(), Error> {
        let place = self.place_of.get(id.slot as usize);
        let change = place.and_then(|&place| self.changed.get(place));
        if change.is_some_and(|change| change.id == id && change.is_removed) {
            return Err(Error::UnknownBody { id });
        }
        Ok(())
    }

    /// Notes the rule for a pair.
    fn pair(
        &mut self,
        scene: &Scene,
        (a, b): (BodyId, BodyId),
        rule: PairRule,
    ) -> Result<(), Error> {
        for id in [a, b] {
            self.check_not_removed(id)?;
        }
        let (a, b) = scene.pair(a, b)?;
        self.pairs.push((a, b, rule));
        Ok(())
    }

    /// Returns the pending change of a body. `prepare`, after the prefetch, checks that the body
    /// exists.
    fn change_of(
        &mut self,
        scene: &Scene,
        id: BodyId,
        command: usize,
    ) -> Result<&mut PendingChange, Refusal> {
        let unknown = || (command, Error::UnknownBody { id });
        if self.place_of.len() < scene.slots() {
            self.place_of.resize(scene.slots(), 0);
        }
        let place = self.place_of.get_mut(id.slot as usize);
        let place = place.ok_or_else(unknown)?;
        let change = self.changed.get(*place);
        if change.is_none_or(|change| change.id != id) {
            *place = self.changed.len();
            self.changed.push(PendingChange::nothing(id, command));
        }
        let change = &mut self.changed[*place];
        if change.is_removed {
            return Err(unknown());
        }
        change.last = command;
        Ok(change)
    }
}
