//! Straight motions of many bodies, told in one call.

use super::Monitor;
use super::command::CommandBatch;
use super::pending_change::ChangeContext;
#[cfg(feature = "recording")]
use super::recording::Record;
use super::told_motions::{ToldMotions, ToldPlan};
use crate::error::{Error, MAX_MAGNITUDE};
use crate::id::BodyId;
use crate::orientation::ToldSpin;
use crate::parallel;
use crate::scene::BodyState;
use crate::simd::{prefetch, prefetch_first};
use crate::trajectory::{StraightMotion, Trajectory};
use crate::window::Window;
use std::slice::from_ref;

impl Monitor {
    /// Lets each of these bodies follow [`Trajectory::coasting`] from its state, from `now` (s) on, whatever the
    /// state's own time; until then it keeps its old plan. The call does for all bodies what
    /// [`replan`](Self::replan) does for one: a physics engine or a network tells them each frame.
    ///
    /// A body is at its state's position at the state's own time: a state of another count of time puts it far away,
    /// without an error. Give [`advance`](Self::advance) the same `now`.
    ///
    /// - A state with a [spin](BodyState::with_spin) sets the orientation as well, from `now` on; without one the
    ///   body goes on turning as it does.
    /// - A body that is left out keeps its plan. A body that already follows that very motion, from a state of that
    ///   very time, is not changed; nor is one that rests, and is told to rest there. (So bodies that sleep may be
    ///   left out.) The last knot of an unchanged body stays where it was, so [`extend`](Self::extend) refuses what
    ///   begins at `now`: use [`replan`](Self::replan).
    /// - A state is late if `now` lies before the clock of the last tick. The body then follows it from the instant
    ///   given by the rule at [`replan`](Self::replan): later than `now` if its motion at `now` was forgotten.
    /// - The last state of a body that is named twice counts, and so does the last call: a state that is older than one told
    ///   before replaces that one, too. Drop messages that were overtaken.
    /// - Between two ticks it may be called several times, as by an engine that takes several steps, and `now` may lie ahead of
    ///   the clock. A body that keeps more than five of its motions takes longer: told in eight steps a tick five times as
    ///   long, told for half a second ahead of the clock six times.
    /// - In steady state nothing is allocated on one thread. Several threads share lists that are made anew.
    ///
    /// States that came through `f32` are off by a different rounding each frame. Two bodies that stay at a margin
    /// then seem to cross it again and again: give the level a [release](crate::AlertLevel::release) above its margin.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{AlertLevel, Body, EventKind, Monitor, Scene, State, Trajectory};
    ///
    /// let mut monitor = Monitor::new(Scene::new(), 0.0, 2.0, &[AlertLevel::at(1.0)])?;
    /// let wall = monitor.insert(Body::new(Trajectory::at_rest(9.0 * DVec3::X)?))?;
    /// let player = monitor.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    /// let mut events = Vec::new();
    /// for frame in 1..=60 {
    ///     let now = f64::from(frame) / 60.0;
    ///     let state = State::new(now, 6.0 * now * DVec3::X, 6.0 * DVec3::X);
    ///     monitor.track(now, [(player, state)])?;
    ///     monitor.advance(now, &mut events)?;
    /// }
    /// // The first tick predicts it, 1.3 s before they come within 1 m.
    /// assert!(matches!(events[0].kind, EventKind::Predicted(encounter) if encounter.a == wall));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Clock`]; [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::NotFinite`], [`Error::OutOfRange`],
    /// [`Error::TooFar`], [`Error::NoOldPlan`], [`Error::RotationLength`] or [`Error::AngularSpeed`], as for
    /// [`replan`](Self::replan) and [`Orientation::spin`](crate::Orientation::spin), or with
    /// [`Error::TurningHalfSpace`] where a half-space is given a spin. Nothing was changed then.
    ///
    /// - A state whose numbers are unusable by themselves is refused, also where a later one of its body would count.
    /// - What depends on the monitor is judged of each body's last state, in the order in which bodies were first named.
    ///   That is its clock, its lookahead, and the body's plan. States after an unusable one are not judged.
    /// - The error is that of the first state, or body, that is refused. The told state is knot 0; other knots are
    ///   those of the body's plan so far.
    pub fn track<S: Into<BodyState>>(
        &mut self,
        now: f64,
        states: impl IntoIterator<Item = (BodyId, S)>,
    ) -> Result<(), Error> {
        let states = states.into_iter().map(|(id, state)| (id, state.into()));
        #[cfg(feature = "recording")]
        if self.recorder.is_some() {
            let states: Vec<(BodyId, BodyState)> = states.collect();
            self.follow_states(now, states.iter().copied())?;
            self.write_down(|| Record::Track(now, states));
            return Ok(());
        }
        self.follow_states(now, states)
    }

    fn follow_states(
        &mut self,
        now: f64,
        states: impl Iterator<Item = (BodyId, BodyState)>,
    ) -> Result<(), Error> {
        if now.is_nan() || now.abs() > MAX_MAGNITUDE {
            return Err(Error::Clock { time: now });
        }
        let mut told = std::mem::take(&mut self.told);
        told.clear();
        let listed = self.list_changes(now, states, &mut told);
        let done = listed.and_then(|()| self.take_changes(now, &mut told));
        self.told = told;
        done
    }

    /// Finds the change of each body.
    fn list_changes(
        &self,
        now: f64,
        states: impl Iterator<Item = (BodyId, BodyState)>,
        told: &mut ToldMotions,
    ) -> Result<(), Error> {
        /// Bodies that one thread looks at together.
        const CHUNK: usize = 64;
        let mut refused = Ok(());
        for (id, state) in states {
            let is_known = (id.slot as usize) < self.scene.slots();
            if let Some(motion) = state.ordinary_motion()
                && is_known
            {
                told.states.put((id, motion), None);
                continue;
            }
            let taken = self.list_motion(id, state, told);
            if taken.is_err() {
                // One before it may be refused as well.
                refused = taken;
                break;
            }
        }
        let context = self.change_context()?;
        self.find_in_place(now, told, &context);
        told.list_others();
        let ToldMotions { states, others, .. } = told;
        let few = (others.len(), CommandBatch::FEW);
        parallel::for_each_chunk(others, CHUNK, few, |_, some| {
            for (place, plan) in some {
                let (id, motion) = (states.ids[*place], &states.motions[*place]);
                let found = self.work_out_plan(now, (id, motion), &context);
                *plan = found.map_err(|error| error.with_id(id));
            }
        });
        match others.iter().position(|(_, plan)| plan.is_err()) {
            Some(first) => others.swap_remove(first).1.map(drop),
            None => refused,
        }
    }

    /// Lists the motion, and maybe the orientation, of one body.
    #[inline(never)]
    fn list_motion(
        &self,
        id: BodyId,
        state: BodyState,
        told: &mut ToldMotions,
    ) -> Result<(), Error> {
        let in_body = |error: Error| {
            let body = self.scene.body(id);
            body.map_or(Error::UnknownBody { id }, |body| {
                error.in_body(body.tag).with_id(id)
            })
        };
        if id.slot as usize >= self.scene.slots() {
            return Err(Error::UnknownBody { id });
        }
        let motion = state.motion().map_err(in_body)?;
        let spin = state.told_spin().map_err(in_body)?;
        let body = self.scene.body(id).filter(|_| spin.is_some());
        if body.is_some_and(|body| body.hitbox.is_half_space()) {
            return Err(in_body(Error::TurningHalfSpace));
        }
        told.states.put((id, motion), spin);
        Ok(())
    }

    /// Notes which motions are replaced in place, by the test of
    /// [`LastMotion`](crate::trajectory::LastMotion::is_replaced_by).
    fn find_in_place(&self, now: f64, told: &mut ToldMotions, context: &ChangeContext<'_>) {
        /// Bodies that one thread looks at together.
        const CHUNK: usize = 1024;
        let few = (told.states.ids.len(), CommandBatch::FEW);
        let monitored = &self.search.monitored;
        let (states, is_in_place) = (&told.states, &mut told.is_in_place);
        is_in_place.resize(states.ids.len(), false);
        parallel::for_each_chunk(is_in_place, CHUNK, few, |number, some| {
            let first = number * CHUNK;
            let (ids, motions) = (&states.ids[first..], &states.motions[first..]);
            for (place, is_replaced) in some.iter_mut().enumerate() {
                if let Some(later) = ids.get(place + CommandBatch::AHEAD) {
                    monitored.prefetch_plan(later.slot);
                }
                let (id, motion) = (ids[place], &motions[place]);
                *is_replaced = self.scene.has(id)
                    && monitored.is_replaced(id.slot, motion, now, context.window);
            }
        });
    }

    /// Returns the way in which a body comes to follow a motion that it is told at an instant (s).
    fn work_out_plan(
        &self,
        now: f64,
        (id, motion): (BodyId, &StraightMotion),
        context: &ChangeContext<'_>,
    ) -> Result<ToldPlan, Error> {
        let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        let old = &body.trajectory;
        let in_body = |error: Error| error.in_body(body.tag);
        let mut plan = Trajectory::of_straight(*motion);
        let from = context.takes_effect_at(old, &plan, now);
        let from = from.map_err(in_body)?;
        if old.follows(motion, from) {
            return Ok(ToldPlan::Same(from));
        }
        let since = context.forget_before(from);
        if old.can_replace((from, since), motion, context.window) {
            return Ok(ToldPlan::InPlace(from));
        }
        let done = plan.precede_by(old, from, since);
        done.map_err(in_body)?;
        let monitored = context.monitored_body(&plan, body.shape(), body.tag);
        // The state is the last knot.
        let before = plan.knots().len().saturating_sub(1);
        let monitored = monitored.map_err(|error| error.after_knots(before))?;
        Ok(ToldPlan::Replan(from, Box::new((plan, monitored))))
    }

    /// Lets all take effect. Nothing is refused.
    fn take_changes(&mut self, now: f64, told: &mut ToldMotions) -> Result<(), Error> {
        self.replace_in_place(now, told)?;
        let since = self.change_context()?.history_end;
        for (place, plan) in told.others.drain(..) {
            let id = told.states.ids[place];
            let plan = plan?;
            // Those that were not listed here are followed from `now` on.
            if now < plan.from() {
                told.late.push((id, plan.from()));
            }
            match plan {
                ToldPlan::Same(_) => told.unchanged.push(place),
                ToldPlan::InPlace(from) => {
                    self.replace_motion(id, (from, &told.states.motions[place]))?;
                }
                ToldPlan::Replan(_, replanned) => {
                    let (mut plan, monitored) = *replanned;
                    self.scene.swap_trajectory(id, &mut plan)?;
                    self.update_monitored(id, Some(monitored));
                    self.plan_ends.set(id.slot, f64::INFINITY);
                }
            }
        }
        // Last: what a body takes with another plan was worked out for the old shape.
        for (place, spin) in told.states.spins.iter().enumerate() {
            self.prefetch_turning(told, place);
            if let Some(spin) = spin {
                let is_changed = self.take_spin(told.states.ids[place], spin, (now, since))?;
                // A body whose motion changes was counted with that.
                let is_alone = is_changed && told.unchanged.binary_search(&place).is_ok();
                self.count_changes(usize::from(is_alone));
            }
        }
        Ok(())
    }

    /// Prefetches orientations that are changed later.
    fn prefetch_turning(&self, told: &ToldMotions, place: usize) {
        const AHEAD: usize = CommandBatch::AHEAD;
        let later = |ahead: usize| {
            told.states.spins.get(place + ahead)?.as_ref()?;
            let (_, entry) = self.scene.in_slot(told.states.ids[place + ahead].slot)?;
            entry.body.orientation.turning()
        };
        if let Some(turning) = later(2 * AHEAD) {
            prefetch(from_ref(turning));
        }
        if let Some(turning) = later(AHEAD) {
            turning.prefetch_parts();
        }
    }

    /// Lets a body follow a spin from an instant (s) on, and forgets what ends before another one. Returns true if
    /// that changes where its spheres are.
    fn take_spin(
        &mut self,
        id: BodyId,
        spin: &ToldSpin,
        (from, since): (f64, f64),
    ) -> Result<bool, Error> {
        let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        let turned = !body.orientation.is_fixed();
        let is_same_at_all_times = body.hitbox.arm() <= 0.0;
        if !self.scene.follow_spin(id, spin, (from, since))? || is_same_at_all_times {
            return Ok(false);
        }
        if turned {
            // A shape depends on the tolerance, which a spin leaves as it is, and not on how the body turns.
            self.search.mark_changed(id.slot);
        } else {
            let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
            self.search.reshape(id.slot, body.shape());
        }
        Ok(true)
    }

    /// Replaces the motions that can be replaced in place.
    fn replace_in_place(&mut self, now: f64, told: &ToldMotions) -> Result<(), Error> {
        let context = self.change_context()?;
        let (window, since) = (context.window, context.forget_before(now));
        if parallel::threads() > 1 && 2 * told.states.ids.len() > self.scene.slots() {
            self.share_replacements((now, since), window, told);
        } else {
            self.replace_each((now, since), window, told);
        }
        let count = self.search.mark_all_changed(told.slots_in_place());
        self.count_changes(count);
        Ok(())
    }

    /// Replaces them in the order in which they were told.
    fn replace_each(&mut self, (now, since): (f64, f64), window: Window, told: &ToldMotions) {
        const AHEAD: usize = CommandBatch::AHEAD;
        let (slots, monitored) = (self.scene.slots_mut(), &mut self.search.monitored);
        for (place, is_replaced) in told.is_in_place.iter().enumerate() {
            // Bodies lie anywhere in memory.
            if let Some(later) = told.states.ids.get(place + 2 * AHEAD) {
                prefetch_first(&slots[later.slot as usize]);
                monitored.prefetch_plan(later.slot);
            }
            if let Some(later) = told.states.ids.get(place + AHEAD) {
                slots[later.slot as usize].prefetch_motion();
            }
            if !is_replaced {
                continue;
            }
            let slot = told.states.ids[place].slot;
            let body = &mut slots[slot as usize];
            let motion = &told.states.motions[place];
            if let Some((trajectory, last)) = body.replace_checked((now, motion, since)) {
                monitored.replace(slot, trajectory, last, window);
            }
        }
    }

    /// Replaces them on several threads.
    fn share_replacements(&mut self, (now, since): (f64, f64), window: Window, told: &ToldMotions) {
        /// Slots that one thread goes through together.
        const CHUNK: usize = 1024;
        let slots = self.scene.slots_mut();
        let (by_slot, until) = self.search.monitored.by_slot_mut();
        let count = slots.len().min(by_slot.len());
        let slots = slots[..count].chunks_mut(CHUNK);
        let lists = slots.zip(by_slot[..count].chunks_mut(CHUNK));
        let mut chunks: Vec<_> = lists.map(|lists| (lists, f64::INFINITY)).collect();
        parallel::for_each(&mut chunks, |number, ((slots, by_slot), end)| {
            for (place, monitored) in by_slot.iter_mut().enumerate() {
                if let Some(later) = slots.get(place + CommandBatch::AHEAD) {
                    later.prefetch_motion();
                }
                let motion = told.in_place(number * CHUNK + place);
                let (Some(motion), Some(monitored)) = (motion, monitored) else {
                    continue;
                };
                if let Some((trajectory, last)) = slots[place].replace_checked((now, motion, since))
                {
                    monitored.replace(trajectory, last, window);
                    *end = end.min(monitored.until());
                }
            }
        });
        let ends = chunks.into_iter().map(|(_, end)| end);
        *until = ends.fold(*until, f64::min);
    }
}
