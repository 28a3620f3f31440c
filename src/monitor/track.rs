//! Straight motions of many bodies, told in one call.

use super::Monitor;
use super::monitored_bodies::MonitoredBody;
#[cfg(feature = "recording")]
use super::recording::Record;
use crate::error::Error;
use crate::id::BodyId;
use crate::scene::BodyState;
use crate::trajectory::{Segment, Trajectory};

/// What becomes of the bodies of one call. Its memory is used again and again.
#[derive(Debug, Default)]
pub(super) struct TrackedMotions {
    /// One for each body.
    motions: Vec<TrackedMotion>,
    /// By slot: the place of its motion in `motions`, if that is of this slot.
    place_of: Vec<usize>,
}

impl TrackedMotions {
    /// Takes a motion in. It replaces that of the same body, if there is one.
    fn put(&mut self, motion: TrackedMotion) {
        let slot = motion.id.slot as usize;
        if self.place_of.len() <= slot {
            self.place_of.resize(slot + 1, 0);
        }
        let place = &mut self.place_of[slot];
        match self.motions.get_mut(*place) {
            Some(known) if known.id == motion.id => *known = motion,
            _ => {
                *place = self.motions.len();
                self.motions.push(motion);
            }
        }
    }
}

/// What becomes of a body.
#[derive(Debug)]
struct TrackedMotion {
    id: BodyId,
    /// From when on, s.
    from: f64,
    /// Straight motion from then on.
    line: Segment,
    /// The whole plan, where the body's own cannot be turned in place.
    replanned: Option<Box<(Trajectory, MonitoredBody)>>,
}

impl Monitor {
    /// From `now` (s) on each of these bodies follows [`Trajectory::coasting`] from its state, whatever the
    /// state's own time; until then it keeps its old plan. That is what [`replan`](Self::replan) does for each,
    /// in one call: what a physics engine or a network tells of all bodies, each frame.
    ///
    /// A body that is left out keeps its course. One that already follows that very motion is not changed. Of a
    /// body that is named twice the last state counts. In steady state nothing is allocated.
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
    /// [`Error::TooFar`] or [`Error::NoPlanAt`], as for [`replan`](Self::replan). The error of the first state
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
        let done = done.and_then(|()| self.take_motions(&mut tracked.motions));
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
        let terms = self.terms()?;
        for (id, state) in states {
            let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
            let line = state.line(body.tag)?;
            let flown = &body.trajectory;
            let in_body = |error: Error| error.in_body(body.tag);
            let from = terms
                .follows_from(flown, &Trajectory::of_line(line), now)
                .map_err(in_body)?;
            let mut replanned = None;
            if !flown.follows(&line, from) && !flown.can_turn(from, &line, terms.window) {
                let mut plan = Trajectory::of_line(line);
                let since = terms.forget_before;
                plan.precede_by(flown, from, since).map_err(in_body)?;
                let flight = terms.flight(&plan, &body.hitbox, body.tag)?;
                replanned = Some(Box::new((plan, flight)));
            }
            tracked.put(TrackedMotion {
                id,
                from,
                line,
                replanned,
            });
        }
        Ok(())
    }

    /// Lets it take effect. Nothing is refused.
    fn take_motions(&mut self, motions: &mut Vec<TrackedMotion>) -> Result<(), Error> {
        let terms = self.terms()?;
        let (window, since) = (terms.window, terms.forget_before);
        for TrackedMotion {
            id,
            from,
            line,
            replanned,
        } in motions.drain(..)
        {
            let flown = self.scene.body(id).map(|body| &body.trajectory);
            if flown.is_some_and(|flown| flown.follows(&line, from)) {
                continue;
            }
            if let Some(replanned) = replanned {
                let (mut plan, flight) = *replanned;
                self.scene.swap_trajectory(id, &mut plan)?;
                self.place(id, Some(flight));
            } else {
                let turned = self.scene.turn(id, (from, &line, since))?;
                self.search.replan(id.slot, turned, window)?;
                self.count_change();
            }
            self.plan_ends.set(id.slot, f64::INFINITY);
        }
        Ok(())
    }
}
