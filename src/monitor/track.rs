//! Straight motions of many bodies, told in one call.

use super::Monitor;
use super::command::{ChangeContext, CommandBatch};
#[cfg(feature = "recording")]
use super::recording::Record;
use super::tracked_motions::{TrackedChange, TrackedMotion, TrackedMotions};
use crate::error::Error;
use crate::id::BodyId;
use crate::parallel;
use crate::scene::{Body, BodyState};
use crate::trajectory::Trajectory;

impl Monitor {
    /// From `now` (s) on each of these bodies follows [`Trajectory::coasting`] from its state, whatever the
    /// state's own time; until then it keeps its old plan. That is what [`replan`](Self::replan) does for each,
    /// in one call: what a physics engine or a network tells of all bodies, each frame.
    ///
    /// A state with a [spin](BodyState::with_spin) sets the orientation as well, from `now` on; without one the
    /// body goes on turning as it does. A body that is left out keeps its course. One that already follows that very motion, from a state of that
    /// very time, is not changed: leave out bodies that sleep. Of a body that is named twice the last state
    /// counts. In steady state nothing is allocated.
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
    /// // Two seconds ahead of the wall it was foreseen.
    /// assert!(matches!(events[0].kind, EventKind::Predicted(encounter) if encounter.a == wall));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::NotFinite`], [`Error::OutOfRange`],
    /// [`Error::TooFar`], [`Error::NoPlanAt`], [`Error::RotationLength`] or [`Error::AngularSpeed`], as for
    /// [`replan`](Self::replan) and [`Orientation::spin`](crate::Orientation::spin). The error of the first state
    /// that is refused; nothing was changed then.
    pub fn track<S: Into<BodyState>>(
        &mut self,
        now: f64,
        states: impl IntoIterator<Item = (BodyId, S)>,
    ) -> Result<(), Error> {
        let states = states.into_iter().map(|(id, state)| (id, state.into()));
        #[cfg(feature = "recording")]
        if self.tape.is_some() {
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
        let mut tracked = std::mem::take(&mut self.tracked);
        tracked.motions.clear();
        let done = self.list_motions(now, states, &mut tracked);
        let done = done.and_then(|()| self.take_motions(&mut tracked));
        self.tracked = tracked;
        done
    }

    /// Works out what becomes of each body.
    fn list_motions(
        &self,
        now: f64,
        states: impl Iterator<Item = (BodyId, BodyState)>,
        tracked: &mut TrackedMotions,
    ) -> Result<(), Error> {
        /// Bodies that one thread looks at together.
        const CHUNK: usize = 64;
        let mut refused = Ok(());
        for (id, state) in states {
            let motion = state.motion();
            let motion = motion.and_then(|motion| Ok((motion, state.orientation()?)));
            let is_known = (id.slot as usize) < self.scene.slots();
            match motion {
                Ok((motion, orientation)) if is_known => tracked.put(TrackedMotion {
                    id,
                    from: now,
                    motion,
                    orientation,
                    change: TrackedChange::Turn,
                }),
                motion => {
                    // One before it may be refused as well.
                    let body = self.scene.body(id).ok_or(Error::UnknownBody { id });
                    let tag = body.map(|body| body.tag);
                    refused =
                        tag.and_then(|tag| motion.map(drop).map_err(|error| error.in_body(tag)));
                    break;
                }
            }
        }
        let tracked = &mut tracked.motions;
        let terms = self.terms()?;
        let few = (tracked.len(), CommandBatch::FEW);
        parallel::for_each_chunk(tracked, CHUNK, few, |some| {
            for place in 0..some.len() {
                self.prefetch_motion(some, place);
                let one = &mut some[place];
                if let Err(error) = self.work_out_motion(one, &terms) {
                    one.change = TrackedChange::Refused(Box::new(error));
                }
            }
        });
        let is_refused = |one: &&mut TrackedMotion| matches!(one.change, TrackedChange::Refused(_));
        let first = tracked.iter_mut().find(is_refused);
        match first.map(|one| std::mem::replace(&mut one.change, TrackedChange::Turn)) {
            Some(TrackedChange::Refused(error)) => Err(*error),
            _ => refused,
        }
    }

    /// Fetches bodies that are looked at later into the caches: they lie anywhere in memory.
    fn prefetch_motion(&self, some: &[TrackedMotion], place: usize) {
        const AHEAD: usize = CommandBatch::AHEAD;
        if let Some(later) = some.get(place + 2 * AHEAD) {
            self.scene.prefetch(later.id.slot);
            self.search.flights.prefetch(later.id.slot);
        }
        let later = some.get(place + AHEAD);
        if let Some(later) = later.and_then(|later| self.scene.body(later.id)) {
            later.trajectory.prefetch();
        }
    }

    fn work_out_motion(
        &self,
        tracked: &mut TrackedMotion,
        terms: &ChangeContext<'_>,
    ) -> Result<(), Error> {
        let id = tracked.id;
        let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        let (flown, motion) = (&body.trajectory, tracked.motion);
        let in_body = |error: Error| error.in_body(body.tag);
        let plan = || Trajectory::of_straight(motion);
        let from = terms.follows_from(flown, &plan(), tracked.from);
        if let Some(next) = &tracked.orientation {
            let both = body
                .orientation
                .followed_by(next, tracked.from, terms.forget_before);
            let both = both.map_err(in_body)?;
            Body::check_turning(&body.hitbox, &both, body.tag)?;
            tracked.orientation = Some(both);
        }
        tracked.from = from.map_err(in_body)?;
        let from = tracked.from;
        if flown.follows(&motion, from) {
            tracked.change = TrackedChange::Same;
        } else if flown.can_turn(from, &motion, terms.window) {
            if flown.turns_in_place(from, &motion, terms.forget_before) {
                tracked.change = TrackedChange::TurnInPlace;
            }
        } else {
            let mut plan = plan();
            let since = terms.forget_before;
            plan.precede_by(flown, from, since).map_err(in_body)?;
            let flight = terms.flight(&plan, body.shape(), body.tag)?;
            tracked.change = TrackedChange::Replan(Box::new((plan, flight)));
        }
        Ok(())
    }

    /// Gives the body its new orientation, if that is another one.
    fn take_orientation(&mut self, tracked: &mut TrackedMotion) -> Result<(), Error> {
        let (id, Some(orientation)) = (tracked.id, tracked.orientation.take()) else {
            return Ok(());
        };
        let before = self.scene.set_orientation(id, orientation)?;
        let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        if before != body.orientation {
            self.search.reshape(id.slot, body.shape());
            self.count_change();
        }
        Ok(())
    }

    /// Lets it take effect. Nothing is refused.
    fn take_motions(&mut self, tracked: &mut TrackedMotions) -> Result<(), Error> {
        let is_shared = parallel::threads() > 1 && 2 * tracked.motions.len() > self.scene.slots();
        if is_shared {
            self.turn_in_place(tracked)?;
        }
        let tracked = &mut tracked.motions;
        for place in 0..tracked.len() {
            if !is_shared {
                self.prefetch_motion(tracked, place);
            }
            let tracked = &mut tracked[place];
            let (id, motion) = (tracked.id, (tracked.from, &tracked.motion));
            match std::mem::replace(&mut tracked.change, TrackedChange::Same) {
                TrackedChange::TurnInPlace if is_shared => {
                    self.search.forget(id.slot);
                    self.count_change();
                }
                TrackedChange::Turn | TrackedChange::TurnInPlace => self.turn(id, motion)?,
                TrackedChange::Replan(replanned) => {
                    let (mut plan, flight) = *replanned;
                    self.scene.swap_trajectory(id, &mut plan)?;
                    self.place(id, Some(flight));
                    self.plan_ends.set(id.slot, f64::INFINITY);
                }
                TrackedChange::Same | TrackedChange::Refused(_) => {}
            }
            // Last: what the body takes with another plan was worked out for the old one.
            self.take_orientation(tracked)?;
        }
        Ok(())
    }

    /// Turns the motions that are turned in place, on several threads.
    fn turn_in_place(&mut self, tracked: &TrackedMotions) -> Result<(), Error> {
        /// Slots that one thread goes through together.
        const SHARE: usize = 1024;
        let terms = self.terms()?;
        let (window, since) = (terms.window, terms.forget_before);
        let slots = self.scene.slots_mut();
        let (flights, until) = self.search.flights.by_slot_mut();
        let count = slots.len().min(flights.len());
        let mut ends = vec![Ok(f64::INFINITY); count.div_ceil(SHARE)];
        let lists = (&mut slots[..count], &mut flights[..count]);
        parallel::for_each_share(lists, &mut ends, SHARE, |share, (slots, flights), end| {
            let bodies = slots.iter_mut().zip(flights).enumerate();
            for (place, (slot, flight)) in bodies {
                let motion = tracked.in_place(share * SHARE + place);
                let (Some(motion), Some(flight)) = (motion, flight) else {
                    continue;
                };
                let turned = slot.turn_in_place((motion.from, &motion.motion, since));
                let followed = turned.map_or(Ok(()), |turned| flight.replan(turned, window));
                match (&mut *end, followed) {
                    (Ok(end), Ok(())) => *end = end.min(flight.until),
                    (_, Err(error)) => *end = Err(error),
                    (Err(_), Ok(())) => {}
                }
            }
        });
        for end in ends {
            *until = until.min(end?);
        }
        Ok(())
    }
}
