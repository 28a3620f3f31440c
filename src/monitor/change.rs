//! Changes between ticks: each is checked as a whole before any part takes effect.

use super::Monitor;
use super::command::{Command, CommandBatch, NewBody, PairRule};
use super::event::EndReason;
use super::monitored_bodies::MonitoredBody;
use super::pending_change::{ChangeContext, Refusal};
#[cfg(feature = "recording")]
use super::recording::Record;
use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::orientation::Orientation;
use crate::scene::{Body, BodyPlan};
use crate::trajectory::{StraightMotion, Trajectory};
use crate::window::Window;

impl Monitor {
    /// Adds a body. It counts from the clock of the last tick on: one that [coasts](Trajectory::coasting) from a later
    /// state is taken to have flown since, and meets what was on that way. Insert after the tick at whose clock it appears:
    /// see [order of a frame](Self#order-of-a-frame). [`Command::InsertIgnoring`] adds a body that ignores others.
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] with [`Error::OutOfRange`] or [`Error::TooFar`] if its plan cannot be followed
    /// through the lookahead, or with [`Error::TurningHalfSpace`]; [`Error::SceneFull`].
    pub fn insert(&mut self, body: Body) -> Result<BodyId, Error> {
        let ids = self.apply_one(Command::Insert(body))?;
        ids.first().copied().ok_or(Error::SceneFull)
    }

    fn put(&mut self, (body, monitored, ignored): NewBody) -> Result<BodyId, Error> {
        let id = self.scene.insert(body)?;
        self.update_monitored(id, Some(monitored));
        self.watch_plan_end(id);
        // A later command may have removed some.
        for other in ignored {
            if self.scene.body(other).is_some() {
                self.ignore(id, other)?;
            }
        }
        Ok(id)
    }

    /// Removes a body. Its encounters end, or are withdrawn, at the clock of the last tick, or at the instant up to
    /// which its events were reported if a budget ran out before. The next tick reports that; until then
    /// [`conflicts`](Self::conflicts) still has the body. What it met after that clock is not reported: so remove after
    /// the tick at whose clock the body disappears, see [order of a frame](Self#order-of-a-frame).
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub fn remove(&mut self, id: BodyId) -> Result<Body, Error> {
        let body = self.take_out(id)?;
        #[cfg(feature = "recording")]
        self.write_down(|| Record::Apply(vec![Command::Remove(id)]));
        Ok(body)
    }

    fn take_out(&mut self, id: BodyId) -> Result<Body, Error> {
        let body = self.scene.remove(id)?;
        self.update_monitored(id, None);
        self.plan_ends.set(id.slot, f64::INFINITY);
        self.removed.insert(id.slot);
        Ok(body)
    }

    /// Ends the encounters of all removed bodies in one pass.
    pub(super) fn end_of_removed(&mut self, reported: f64) {
        if self.removed.slots().is_empty() {
            return;
        }
        let events = &mut self.pending_events;
        for encounters in &mut self.encounters {
            let is_gone = |slot| self.removed.has(slot);
            encounters.end(reported, EndReason::BodyRemoved, is_gone, events);
        }
        self.removed.clear();
    }

    /// Replaces a body's whole trajectory, including the past. Events already reported stand: the new one counts from the
    /// clock of the last tick on.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::OutOfRange`] or [`Error::TooFar`] if the trajectory cannot
    /// be followed through the lookahead.
    pub fn set_trajectory(&mut self, id: BodyId, trajectory: Trajectory) -> Result<(), Error> {
        self.apply_one(Command::SetTrajectory(id, trajectory))
            .map(drop)
    }

    /// Replaces a body's hitbox, from the clock of the last tick on.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::TurningHalfSpace`].
    pub fn set_hitbox(&mut self, id: BodyId, hitbox: Hitbox) -> Result<(), Error> {
        self.apply_one(Command::SetHitbox(id, hitbox)).map(drop)
    }

    /// Replaces a body's whole orientation, including the past. Events already reported stand: the new one counts from
    /// the clock of the last tick on.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::TurningHalfSpace`].
    pub fn set_orientation(&mut self, id: BodyId, orientation: Orientation) -> Result<(), Error> {
        self.apply_one(Command::SetOrientation(id, orientation))
            .map(drop)
    }

    /// Lets the body turn as `orientation` says from `from` (s) on; until then it turns as before.
    ///
    /// This call drops what ended before the clock of the last tick, unless [`set_history`](Self::set_history) keeps it.
    /// Events already reported stand, also where `from` lies before the clock.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::ChangeTime`] if `from` is not within ±1e300, with
    /// [`Error::RotationVanishes`] if the tolerance of one orientation is too small for the other, or with
    /// [`Error::TurningHalfSpace`].
    pub fn orient(&mut self, id: BodyId, from: f64, orientation: Orientation) -> Result<(), Error> {
        self.apply_one(Command::Orient(id, from, orientation))
            .map(drop)
    }

    /// Replaces a body's layers, from the clock of the last tick on.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub fn set_layers(&mut self, id: BodyId, layers: Layers) -> Result<(), Error> {
        self.apply_one(Command::SetLayers(id, layers)).map(drop)
    }

    /// Replaces a body's [model error](Body::with_model_error) (m), from the clock of the last tick on.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::ModelError`].
    pub fn set_model_error(&mut self, id: BodyId, metres: f64) -> Result<(), Error> {
        self.apply_one(Command::SetModelError(id, metres)).map(drop)
    }

    /// Lets the body follow `plan` from `from` (s) on; until then it keeps its old plan. See
    /// [`Trajectory::spliced`]. Returns the instant from which `plan` is followed, s: `from`,
    /// unless the plan is late. An orientation in the plan is followed from `from` on in any case,
    /// as by [`orient`](Self::orient); without one the body goes on turning as it does.
    ///
    /// This call drops cubics that ended before the clock of the last tick, unless [`set_history`](Self::set_history) keeps
    /// them. Those that ended at that very clock are dropped as well, if `from` is later.
    ///
    /// A plan is late if `from` lies before the clock. A late plan is accepted if it continues from the clock on. The
    /// returned instant is then the latest of `from`, the start of the plan's [domain](Trajectory::domain) and the start of
    /// the body's. The body keeps its known motion before that instant. A body that does not exist yet at the clock takes no
    /// late plan ([`Error::NoOldPlan`]). Events already reported stand: no event is reported for a change before the clock of
    /// the last tick.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::{AlertLevel, Body, Monitor, Scene, State, Trajectory};
    /// # let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
    /// # let id = monitor.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    /// monitor.advance(2.2, &mut Vec::new())?;
    /// // At rest, 10 s long.
    /// let rest = |time| State::new(time, DVec3::ZERO, DVec3::ZERO);
    /// let plan = |time| Trajectory::from_states(&[rest(time), rest(time + 10.0)]);
    /// assert_eq!(monitor.replan(id, 2.15, plan(2.15)?)?, 2.15);
    /// // What the body did before 2.15 s is forgotten.
    /// assert_eq!(monitor.replan(id, 2.0, plan(2.0)?)?, 2.15);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// A plan that the body follows already is taken over like any other: `from` becomes a knot, and the body counts as
    /// [changed](crate::Stats::changed). ([`track`](Self::track) leaves such a body as it is.)
    ///
    /// Cost: the plan stays in its own memory, which has room for two preceding cubics. Usually one
    /// or two are needed, and nothing is allocated. More are needed with a history, if `from` lies
    /// several knots ahead, or if the plan extends far from its first knot back to `from`. A plan
    /// that was itself [spliced](Trajectory::spliced) has less room.
    ///
    /// A replan from the present clock on does not undo what [`set_trajectory`](Self::set_trajectory) or an insertion gave
    /// at that clock: at this instant the body is at both places.
    ///
    /// The plan may begin elsewhere, but a great distance to that place is expensive: until the change is past, all bodies
    /// between the two places are neighbours. For a body that reappears elsewhere,
    /// [`set_trajectory`](Self::set_trajectory) is cheaper.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::ChangeTime`], [`Error::OutOfRange`], [`Error::TooFar`] or
    /// one of these two:
    ///
    /// - [`Error::NoOldPlan`]: the body does not exist at that instant.
    ///   ([`set_trajectory`](Self::set_trajectory) needs no old plan.)
    /// - [`Error::NoNewPlan`]: the new plan does not exist at that instant, or ends there; or it is late and does not
    ///   go on from the clock, where the body's plan still exists.
    ///
    /// Knots are counted in `plan`. Where the body cannot be followed from its last knot up to that instant, they are
    /// those of its plan so far.
    ///
    /// With an orientation in the plan, the errors of [`orient`](Self::orient), too.
    pub fn replan(
        &mut self,
        id: BodyId,
        from: f64,
        plan: impl Into<BodyPlan>,
    ) -> Result<f64, Error> {
        self.apply_one(Command::Replan(id, from, plan.into()))?;
        Ok(self.batch.late().next().map_or(from, |(_, late)| late))
    }

    /// Appends `plan` to the body's plan: the body follows it from its last knot on, where `plan`
    /// must exist. The last knot may lie before the clock, and `plan` may end before it. Cubics are
    /// dropped as by [`replan`](Self::replan). An orientation in the plan is followed from that knot on.
    ///
    /// The call copies what lies ahead in the body's plan: give a long plan as a whole, not knot by knot.
    ///
    /// A body that continues beyond its knots may have passed the last one long ago (a body [at
    /// rest](Trajectory::at_rest) has a single knot, at 0 s). A plan that begins later is then
    /// refused with [`Error::NoNewPlan`]: use [`replan`](Self::replan).
    ///
    /// # Errors
    ///
    /// The errors of [`replan`](Self::replan).
    pub fn extend(&mut self, id: BodyId, plan: impl Into<BodyPlan>) -> Result<(), Error> {
        self.apply_one(Command::Extend(id, plan.into())).map(drop)
    }

    /// Applies several changes together, or none if one is refused. Returns the ids of the inserted
    /// bodies, in order. A late plan is followed from the instant given by the rule at [`replan`](Self::replan).
    /// The body's trajectory is then that after the commands before, which may have dropped cubics.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::{AlertLevel, Body, Command, Monitor, Scene, Trajectory};
    /// # let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
    /// let body = Body::new(Trajectory::at_rest(DVec3::ZERO)?);
    /// let old = monitor.insert(body.clone())?;
    /// let new = monitor.apply([Command::Remove(old), Command::Insert(body.clone())])?;
    /// assert_eq!(new.len(), 1);
    /// // The old one is gone: nothing is inserted either.
    /// assert!(monitor.apply([Command::Insert(body), Command::Remove(old)]).is_err());
    /// assert_eq!(monitor.scene().len(), 1);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::InCommand`] with the number and the error of the first refused command; nothing was changed then.
    pub fn apply(
        &mut self,
        commands: impl IntoIterator<Item = Command>,
    ) -> Result<Vec<BodyId>, Error> {
        self.apply_all(commands)
            .map_err(|(command, error)| Error::InCommand {
                command,
                error: Box::new(error),
            })
    }

    /// Applies one change. Returns the id of the body if one is inserted.
    pub(super) fn apply_one(&mut self, command: Command) -> Result<Vec<BodyId>, Error> {
        self.apply_all([command]).map_err(|(_, error)| error)
    }

    fn apply_all(
        &mut self,
        commands: impl IntoIterator<Item = Command>,
    ) -> Result<Vec<BodyId>, Refusal> {
        #[cfg(feature = "recording")]
        if self.recorder.is_some() {
            let commands: Vec<Command> = commands.into_iter().collect();
            let record = Record::Apply(commands.clone());
            let ids = self.carry_out(commands)?;
            self.write_down(|| record);
            return Ok(ids);
        }
        self.carry_out(commands)
    }

    fn carry_out(
        &mut self,
        commands: impl IntoIterator<Item = Command>,
    ) -> Result<Vec<BodyId>, Refusal> {
        let mut batch = std::mem::take(&mut self.batch);
        // Of no command in particular.
        let of_all = |error| (0, error);
        let context = self.change_context().map_err(of_all)?;
        let ids = match batch.work_out(&self.scene, commands, &context) {
            Ok(()) => self.take_over(&mut batch).map_err(of_all),
            Err(refusal) => Err(refusal),
        };
        // The next tick drops what was replaced, while another thread searches.
        self.batch = batch;
        ids
    }

    /// Applies a batch that was checked. No step fails: all ids were found, and a scene has more slots than fit into memory.
    fn take_over(&mut self, batch: &mut CommandBatch) -> Result<Vec<BodyId>, Error> {
        // Of bodies, some of which may be removed below.
        for &(a, b, rule) in &batch.pairs {
            match (rule, self.scene.ignores(a, b)) {
                (PairRule::Ignored, true) | (PairRule::Unignored, false) => {}
                (PairRule::Ignored, false) => self.ignore(a, b)?,
                (PairRule::Unignored, true) => self.unignore(a, b)?,
            }
        }
        for place in 0..batch.changed.len() {
            if let Some(later) = batch.changed.get(place + CommandBatch::AHEAD) {
                self.scene.prefetch(later.id.slot);
                self.search.monitored.prefetch(later.id.slot);
            }
            let change = &mut batch.changed[place];
            let id = change.id;
            if change.is_removed {
                drop(self.take_out(id)?);
                continue;
            }
            if let Some((from, motion)) = &change.in_place {
                if let Some(layers) = change.layers {
                    self.scene.set_layers(id, layers)?;
                }
                self.replace_motion(id, (*from, motion))?;
                self.search.find_partners(&self.scene, Some(id.slot));
                continue;
            }
            if let Some(trajectory) = &mut change.trajectory {
                self.scene.swap_trajectory(id, trajectory)?;
                self.watch_plan_end(id);
            }
            // They were checked together: either alone may contradict the old other one.
            let (hitbox, orientation) = (change.hitbox.take(), change.orientation.take());
            self.scene.set_shape(id, hitbox, orientation)?;
            if let Some(layers) = change.layers {
                self.scene.set_layers(id, layers)?;
            }
            if let Some(model_error) = change.model_error {
                self.scene.set_model_error(id, model_error)?;
            }
            self.update_monitored(id, change.monitored.take());
        }
        batch.inserted.drain(..).map(|new| self.put(new)).collect()
    }

    /// Ignores a pair, from the clock of the last tick on. At the next tick its encounters end with [`EndReason::PlanChanged`], or are
    /// withdrawn if they had not begun.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`].
    pub fn ignore_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.apply_one(Command::IgnorePair(a, b)).map(drop)
    }

    fn ignore(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.scene.ignore_pair(a, b)?;
        let slots = (a.slot.min(b.slot), a.slot.max(b.slot));
        self.search.leave_out(slots);
        Ok(())
    }

    /// Stops ignoring a pair, from the clock of the last tick on.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`].
    pub fn unignore_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.apply_one(Command::UnignorePair(a, b)).map(drop)
    }

    fn unignore(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.scene.unignore_pair(a, b)?;
        // Either body will do: the one that costs less to compare.
        let cost = |id| {
            let hitbox = self.scene.body(id).map(|body| &body.hitbox);
            // A half-space is compared with all bodies.
            hitbox.map(|hitbox| (hitbox.is_half_space(), hitbox.spheres().len()))
        };
        let simpler = if cost(a) <= cost(b) { a } else { b };
        self.search.mark_changed(simpler.slot);
        Ok(())
    }

    /// Returns the context in which changes are prepared now.
    pub(super) fn change_context(&self) -> Result<ChangeContext<'_>, Error> {
        let end = self.search.plans_needed_until(self.now + self.lookahead);
        Ok(ChangeContext {
            grid: &self.search.grid,
            window: Window::new(self.reported, end)?,
            now: self.now,
            history_end: self.reported - self.history,
            is_end_reported: self.history <= 0.0,
        })
    }

    /// Lets a body follow a straight motion from an instant (s) on, in the memory of its plan:
    /// [`Trajectory::can_replace`] must be true.
    pub(super) fn replace_motion(
        &mut self,
        id: BodyId,
        (from, motion): (f64, &StraightMotion),
    ) -> Result<(), Error> {
        let context = self.change_context()?;
        let (window, since) = (context.window, context.forget_before(from));
        let trajectory = self.scene.replace_motion(id, (from, motion, since))?;
        self.search.replan(id.slot, trajectory, window)?;
        self.plan_ends.set(id.slot, f64::INFINITY);
        self.count_changes(1);
        Ok(())
    }

    pub(super) const fn count_changes(&mut self, count: usize) {
        self.changed_bodies += count as u64;
        self.grid_review.changes += count;
    }

    pub(super) fn update_monitored(&mut self, id: BodyId, monitored: Option<MonitoredBody>) {
        self.count_changes(1);
        self.search.set(id.slot, monitored);
        self.search.find_partners(&self.scene, Some(id.slot));
    }
}
