//! Changes between ticks: one, or several that take effect together or not at all.

use super::grid::Grid;
use super::monitored_bodies::MonitoredBody;
use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::orientation::Orientation;
use crate::parallel;
use crate::scene::{Body, BodyPlan, Scene, checked_model_error};
use crate::shape::BodyShape;
use crate::trajectory::{StraightMotion, Trajectory};
use crate::window::Window;

/// A change to a monitor's scene, for [`Monitor::apply`](crate::Monitor::apply) or to be sent to a
/// live monitor.
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

/// The context in which all changes are prepared.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChangeContext<'m> {
    pub(super) grid: &'m Grid,
    /// Window over which plans are followed.
    pub(super) window: Window,
    /// The clock of the last tick, s.
    pub(super) now: f64,
    /// End of the history, s: replans drop older cubics.
    pub(super) forget_before: f64,
}

impl ChangeContext<'_> {
    /// Returns the monitored body of a plan over the lookahead.
    pub(super) fn monitored_body(
        &self,
        trajectory: &Trajectory,
        shape: BodyShape<'_>,
        tag: u64,
    ) -> Result<MonitoredBody, Error> {
        let monitored = MonitoredBody::of(trajectory, shape, self.grid, self.window);
        monitored.map_err(|error| error.in_body(tag))
    }

    /// Returns the instant from which a body follows a plan requested from `from` on, s. If `from` lies
    /// before the clock, the plan is late: it is followed from the first instant at which both the plan and the
    /// body's old motion exist.
    ///
    /// # Errors
    ///
    /// [`Error::ChangeTime`]; [`Error::NoNewPlan`] if a plan for the past is over, and the body is not.
    pub(super) fn follows_from(
        &self,
        old: &Trajectory,
        plan: &Trajectory,
        from: f64,
    ) -> Result<f64, Error> {
        if !from.is_finite() {
            return Err(Error::ChangeTime { time: from });
        }
        if from > self.now {
            return Ok(from);
        }
        if old.domain().contains(self.now) {
            plan.check_goes_on_from(self.now)?;
        }
        let both_exist = old.domain().start().max(plan.domain().start());
        Ok(from.max(both_exist).min(self.now))
    }

    /// Returns the monitored body of a body with its current plan.
    pub(super) fn monitored_body_of(&self, body: &Body) -> Result<MonitoredBody, Error> {
        Body::check_turning(&body.hitbox, &body.orientation, body.tag)?;
        self.monitored_body(&body.trajectory, body.shape(), body.tag)
    }
}

/// The outcome of a batch: changed bodies and new ones. Its memory is reused.
#[derive(Debug, Default)]
pub(super) struct CommandBatch {
    /// Changes, one for each body, in the order of the commands.
    pub(super) changed: Vec<PendingChange>,
    /// Index in `changed` of each slot's change, valid if that entry is of this slot.
    place_of: Vec<usize>,
    pub(super) inserted: Vec<(Body, MonitoredBody)>,
    /// Pairs to ignore, or to stop ignoring, in the order of the commands.
    pub(super) pairs: Vec<(BodyId, BodyId, PairRule)>,
}

/// The rule for a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairRule {
    Ignored,
    Unignored,
}

/// The parts of a body that a batch replaces.
#[derive(Debug)]
pub(super) struct PendingChange {
    pub(super) id: BodyId,
    pub(super) is_removed: bool,
    pub(super) trajectory: Option<Trajectory>,
    /// A straight motion that replaces the body's own in place; nothing else changes.
    pub(super) motion: Option<PendingMotion>,
    /// Number of knots of the last plan as it was given: before these come those of the motion so far.
    own_knots: usize,
    /// Set while the trajectory is a bare plan, which the past motion must precede.
    splice: Option<PendingSplice>,
    /// Instant from which the body follows its last plan, if that was late, s.
    late: Option<f64>,
    pub(super) hitbox: Option<Hitbox>,
    pub(super) orientation: Option<Orientation>,
    pub(super) layers: Option<Layers>,
    pub(super) model_error: Option<f64>,
    /// Numbers of the first and the last command that concern the body.
    first: usize,
    last: usize,
    /// The monitored body with these parts; none once taken, and for removed bodies.
    pub(super) monitored: Option<MonitoredBody>,
    refusal: Option<Rejection>,
}

/// A straight motion, from an instant (s) on.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingMotion {
    pub(super) from: f64,
    pub(super) motion: StraightMotion,
    command: usize,
}

/// Instant from which a plan is followed (none: the last knot of the one before), s.
#[derive(Clone, Copy, Debug)]
struct PendingSplice {
    from: Option<f64>,
    command: usize,
}

/// The number of a refused command, and the reason.
type Rejection = (usize, Error);

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
    ) -> Result<(), Error> {
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
        first.map_or(Ok(()), |(_, error)| Err(error))
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
    ) -> Result<(), Rejection> {
        let refuse = |error| (number, error);
        let id = match command {
            Command::Insert(body) => {
                let monitored = context.monitored_body_of(&body).map_err(refuse)?;
                self.inserted.push((body, monitored));
                return Ok(());
            }
            Command::IgnorePair(a, b) => {
                return self.pair(scene, (a, b), PairRule::Ignored).map_err(refuse);
            }
            Command::UnignorePair(a, b) => {
                return self
                    .pair(scene, (a, b), PairRule::Unignored)
                    .map_err(refuse);
            }
            Command::Remove(id)
            | Command::SetTrajectory(id, _)
            | Command::SetHitbox(id, _)
            | Command::SetOrientation(id, _)
            | Command::SetLayers(id, _)
            | Command::SetModelError(id, _)
            | Command::Orient(id, ..)
            | Command::Replan(id, ..)
            | Command::Extend(id, _) => id,
        };
        let change = self.change_of(scene, id, number).map_err(refuse)?;
        match command {
            Command::Insert(_) | Command::IgnorePair(..) | Command::UnignorePair(..) => {}
            Command::Remove(_) => change.is_removed = true,
            Command::SetTrajectory(_, trajectory) => {
                change.motion_to_splice();
                change.splice(scene, context)?;
                change.own_knots = trajectory.knots().len();
                change.trajectory = Some(trajectory);
                change.late = None;
            }
            Command::SetHitbox(_, hitbox) => change.hitbox = Some(hitbox),
            Command::SetOrientation(_, orientation) => change.orientation = Some(orientation),
            Command::SetLayers(_, layers) => change.layers = Some(layers),
            Command::SetModelError(_, metres) => {
                let tag = change.body(scene)?.tag;
                let checked = checked_model_error(metres);
                let checked = checked.map_err(|error| refuse(error.in_body(tag).with_id(id)))?;
                change.model_error = Some(checked);
            }
            Command::Orient(_, from, next) => change.orient(scene, (from, &next), context)?,
            Command::Replan(_, from, plan) => {
                let is_first = change.trajectory.is_none() && change.motion.is_none();
                match plan.trajectory.straight() {
                    Some((&motion, _)) if is_first => {
                        let command = number;
                        change.motion = Some(PendingMotion {
                            from,
                            motion,
                            command,
                        });
                    }
                    _ => change.follow(scene, Some(from), plan.trajectory, context)?,
                }
                if let Some(next) = &plan.orientation {
                    change.orient(scene, (from, next), context)?;
                }
            }
            Command::Extend(_, plan) => {
                let turn = match &plan.orientation {
                    Some(next) => Some((change.last_knot(scene, context)?, next)),
                    None => None,
                };
                change.follow(scene, None, plan.trajectory, context)?;
                if let Some(turn) = turn {
                    change.orient(scene, turn, context)?;
                }
            }
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
            let place = self.place_of.get(id.slot as usize);
            let change = place.and_then(|&place| self.changed.get(place));
            if change.is_some_and(|change| change.id == id && change.is_removed) {
                return Err(Error::UnknownBody { id });
            }
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
    ) -> Result<&mut PendingChange, Error> {
        if self.place_of.len() < scene.slots() {
            self.place_of.resize(scene.slots(), 0);
        }
        let place = self.place_of.get_mut(id.slot as usize);
        let place = place.ok_or(Error::UnknownBody { id })?;
        let change = self.changed.get(*place);
        if change.is_none_or(|change| change.id != id) {
            *place = self.changed.len();
            self.changed.push(PendingChange::nothing(id, command));
        }
        let change = &mut self.changed[*place];
        if change.is_removed {
            return Err(Error::UnknownBody { id });
        }
        change.last = command;
        Ok(change)
    }
}

impl PendingChange {
    const fn nothing(id: BodyId, command: usize) -> Self {
        Self {
            id,
            is_removed: false,
            trajectory: None,
            motion: None,
            own_knots: usize::MAX,
            splice: None,
            late: None,
            hitbox: None,
            orientation: None,
            layers: None,
            model_error: None,
            first: command,
            last: command,
            monitored: None,
            refusal: None,
        }
    }

    /// Returns the current body.
    fn body<'s>(&self, scene: &'s Scene) -> Result<&'s Body, Rejection> {
        let unknown = (self.first, Error::UnknownBody { id: self.id });
        scene.body(self.id).ok_or(unknown)
    }

    /// Joins the plan so far, up to `from` (none: its last knot), and `plan`.
    fn follow(
        &mut self,
        scene: &Scene,
        from: Option<f64>,
        plan: Trajectory,
        context: &ChangeContext<'_>,
    ) -> Result<(), Rejection> {
        self.motion_to_splice();
        self.splice(scene, context)?;
        self.own_knots = plan.knots().len();
        let old = self.trajectory.replace(plan);
        self.splice = Some(PendingSplice {
            from,
            command: self.last,
        });
        // An earlier plan of this batch is joined now, the body's own in `prepare`.
        old.map_or(Ok(()), |old| {
            self.precede_by(&old, self.body(scene)?.tag, context)
        })
    }

    /// Returns the last knot of the plan so far, s.
    fn last_knot(&mut self, scene: &Scene, context: &ChangeContext<'_>) -> Result<f64, Rejection> {
        self.motion_to_splice();
        self.splice(scene, context)?;
        let own = &self.body(scene)?.trajectory;
        let plan = self.trajectory.as_ref().unwrap_or(own);
        Ok(plan.knots().last().copied().unwrap_or(0.0))
    }

    /// Lets the body turn as `next` says from `from` (s) on.
    fn orient(
        &mut self,
        scene: &Scene,
        (from, next): (f64, &Orientation),
        context: &ChangeContext<'_>,
    ) -> Result<(), Rejection> {
        let body = self.body(scene)?;
        let before = self.orientation.as_ref().unwrap_or(&body.orientation);
        let both = before.followed_by(next, from, context.forget_before);
        let both = both.map_err(|error| (self.last, error.in_body(body.tag).with_id(self.id)))?;
        self.orientation = Some(both);
        Ok(())
    }

    /// Converts a pending motion to a plan, since more than the motion changes.
    fn motion_to_splice(&mut self) {
        if let Some(pending) = self.motion.take() {
            self.own_knots = 1;
            self.trajectory = Some(Trajectory::of_straight(pending.motion));
            self.splice = Some(PendingSplice {
                from: Some(pending.from),
                command: pending.command,
            });
        }
    }

    /// Returns true if the body's motion can be replaced in place; notes from when on (s).
    fn can_replace(&mut self, body: &Body, context: &ChangeContext<'_>) -> Result<bool, Rejection> {
        let Some(pending) = &mut self.motion else {
            return Ok(false);
        };
        let (old, plan) = (&body.trajectory, Trajectory::of_straight(pending.motion));
        let from = context.follows_from(old, &plan, pending.from);
        let from = from.map_err(|error| {
            let error = error.in_body(body.tag).with_id(self.id);
            (pending.command, error)
        })?;
        let keeps_shape =
            self.hitbox.is_none() && self.orientation.is_none() && self.model_error.is_none();
        let can = keeps_shape && old.can_replace(from, &pending.motion, context.window);
        if can {
            self.late = Some(from).filter(|from| pending.from < *from);
            pending.from = from;
        }
        Ok(can)
    }

    /// Joins the body's own trajectory and the plan, if that is pending.
    fn splice(&mut self, scene: &Scene, context: &ChangeContext<'_>) -> Result<(), Rejection> {
        if self.splice.is_none() {
            return Ok(());
        }
        let body = self.body(scene)?;
        self.precede_by(&body.trajectory, body.tag, context)
    }

    fn precede_by(
        &mut self,
        old: &Trajectory,
        tag: u64,
        context: &ChangeContext<'_>,
    ) -> Result<(), Rejection> {
        let (Some(plan), Some(splice)) = (&mut self.trajectory, self.splice.take()) else {
            return Ok(());
        };
        let from = match splice.from {
            Some(from) => context.follows_from(old, plan, from),
            None => Ok(old.knots().last().copied().unwrap_or(0.0)),
        };
        let spliced = from.and_then(|from| {
            self.late = splice.from.filter(|asked| *asked < from).map(|_| from);
            plan.precede_by(old, from, context.forget_before)
        });
        spliced.map_err(|error| (splice.command, error.in_body(tag).with_id(self.id)))
    }

    /// Prepares the outcome for the body.
    fn prepare(&mut self, scene: &Scene, context: &ChangeContext<'_>) -> Result<(), Rejection> {
        let body = self.body(scene)?;
        if !self.is_removed && self.can_replace(body, context)? {
            return Ok(());
        }
        self.motion_to_splice();
        self.splice(scene, context)?;
        if !self.is_removed {
            let trajectory = self.trajectory.as_ref().unwrap_or(&body.trajectory);
            let hitbox = self.hitbox.as_ref().unwrap_or(&body.hitbox);
            let orientation = self.orientation.as_ref().unwrap_or(&body.orientation);
            let model_error = self.model_error.unwrap_or(body.model_error());
            let shape = BodyShape::new(hitbox, orientation.turning(), model_error);
            let turns = Body::check_turning(hitbox, orientation, body.tag);
            turns.map_err(|error| (self.last, error.with_id(self.id)))?;
            let monitored = context.monitored_body(trajectory, shape, body.tag);
            let before = trajectory.knots().len().saturating_sub(self.own_knots);
            let monitored = monitored.map_err(|error| {
                let error = error.after_knots(before).with_id(self.id);
                (self.last, error)
            });
            self.monitored = Some(monitored?);
        }
        Ok(())
    }
}
