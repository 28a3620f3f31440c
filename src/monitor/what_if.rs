//! `what_if`: the conflicts that a hypothetical plan would cause.

use super::Monitor;
use crate::broad_phase::PairFilter;
use crate::conflict::Conflict;
use crate::error::Error;
use crate::id::BodyId;
use crate::scene::{Body, BodyPlanRef, PairAdmission};
use crate::screen::conflict;
use crate::shape::BodyShape;
use crate::spans::in_order;
use crate::trajectory::Trajectory;

impl Monitor {
    /// Returns the conflicts at a level, from now to [`complete_until`](Self::complete_until), that a body
    /// would have if it followed `plan` from now on. Nothing is changed.
    ///
    /// - The level's margin counts, as for [`conflicts`](Self::conflicts), not its release; so do layers and
    ///   ignored pairs.
    /// - A plan that began before now is followed from now on, as a [late](Self::replan) one. For a plan that
    ///   begins later, ask about the body's trajectory [spliced](crate::Trajectory::spliced) with it.
    /// - A body that does not exist now is taken to get the plan as a whole, as by
    ///   [`set_trajectory`](Self::set_trajectory). Then the plan may begin later.
    /// - Without an orientation in the plan, the body turns as it does.
    /// - Changes since the last tick count. Before the first tick (also of a [restored](Self::restore) monitor that had
    ///   changes), and while a [budget](Self::advance_within) leaves the monitor behind its clock, nothing is known:
    ///   [`Error::NothingKnown`], not an empty answer.
    /// - Numbers may differ from those after a real [`replan`](Self::replan) by rounding. A place that a body leaves by
    ///   a jump at this very instant does not count.
    ///
    /// [`what_if_body`](Self::what_if_body) asks about a body that is not there yet.
    ///
    /// A question about a ball takes some microseconds, one about a turning cluster a hundred. After a tick in which
    /// [many bodies](Self#cost) changed, the first one forms boxes of all bodies: it takes about two thirds of such a tick.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::InBody`]; [`Error::UnknownAlertLevel`]; in a body [`Error::NoNewPlan`] if the body
    /// exists now and the plan does not, or if the plan has ended by now; [`Error::NothingKnown`].
    pub fn what_if<'p>(
        &self,
        id: BodyId,
        plan: impl Into<BodyPlanRef<'p>>,
        level: usize,
    ) -> Result<Vec<Conflict>, Error> {
        let BodyPlanRef {
            trajectory: plan,
            orientation,
        } = plan.into();
        let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        let alert = self.levels.get(level);
        let alert = alert.ok_or(Error::UnknownAlertLevel { level })?;
        let begin = if body.trajectory.domain().contains(self.now) {
            self.now
        } else {
            self.now.max(plan.domain().start())
        };
        let goes_on = plan.check_goes_on_from(begin);
        goes_on.map_err(|error| error.in_body(body.tag).with_id(id))?;
        let orientation = orientation.unwrap_or(&body.orientation);
        let checked = Body::check_turning(&body.hitbox, orientation, body.tag);
        checked.map_err(|error| error.with_id(id))?;
        let shape = BodyShape::new(&body.hitbox, orientation.turning(), body.model_error());
        let margin = self.search.grid.margin;
        let filter = PairAdmission::of(&self.scene, margin, &|| false);
        let admits = |other: u32| filter.admits(id.slot.min(other), id.slot.max(other));
        let found = self.conflicts_on((id, body.tag), (plan, shape), alert.margin, &admits);
        found.map_err(|error| error.with_id(id))
    }

    /// Returns the conflicts at a level, from now to [`complete_until`](Self::complete_until), that a body
    /// would have which is not there yet. Nothing is changed.
    ///
    /// The answer is bit for bit that of [`conflicts_of`](Self::conflicts_of) once the body is
    /// [inserted](Self::insert) and a tick at the same clock has looked as far. The body's id in the answer is
    /// the one that it would have. Changes since the last tick count. Where [`what_if`](Self::what_if) knows nothing,
    /// this is an error as well.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::{AlertLevel, Body, Monitor, Scene, State, Trajectory};
    /// let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
    /// let wall = monitor.insert(Body::new(Trajectory::at_rest(9.0 * DVec3::X)?))?;
    /// monitor.advance(0.0, &mut Vec::new())?;
    /// let ahead = Trajectory::coasting(State::new(0.0, DVec3::ZERO, DVec3::X))?;
    /// let conflicts = monitor.what_if_body(&Body::new(ahead), 0)?;
    /// assert_eq!((conflicts[0].a, conflicts[0].enter), (wall, 7.0));
    /// assert_eq!(monitor.scene().len(), 1);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::UnknownAlertLevel`]; [`Error::InBody`] and [`Error::SceneFull`] as for
    /// [`insert`](Self::insert); [`Error::NothingKnown`].
    pub fn what_if_body(&self, body: &Body, level: usize) -> Result<Vec<Conflict>, Error> {
        let alert = self.levels.get(level);
        let alert = alert.ok_or(Error::UnknownAlertLevel { level })?;
        Body::check_turning(&body.hitbox, &body.orientation, body.tag)?;
        let id = self.scene.next_id()?;
        let admits = |other: u32| {
            let other = self.scene.in_slot(other);
            other.is_some_and(|(_, entry)| entry.body.layers.admits(body.layers))
        };
        let own = (&body.trajectory, body.shape());
        self.conflicts_on((id, body.tag), own, alert.margin, &admits)
    }

    /// Returns the conflicts within a margin (m) of a body of this name, plan and shape with the others
    /// that `admits` allows, from now on.
    fn conflicts_on(
        &self,
        (id, tag): (BodyId, u64),
        (plan, shape): (&Trajectory, BodyShape<'_>),
        margin: f64,
        admits: &dyn Fn(u32) -> bool,
    ) -> Result<Vec<Conflict>, Error> {
        let monitored = self.change_context()?.monitored_body(plan, shape, tag)?;
        let own = monitored.view(plan, shape);
        let window = (self.now, self.known);
        // An empty answer would look like a free way.
        if window.1 <= window.0 {
            return Err(Error::NothingKnown {
                now: self.now,
                complete_until: self.complete_until(),
            });
        }
        let mut conflicts = Vec::new();
        self.search.contacts_with(
            &self.scene,
            (id.slot, &monitored, &own),
            margin,
            window,
            admits,
            |other, window, theirs, contact| {
                let Some((other, entry)) = self.scene.in_slot(other) else {
                    return;
                };
                let (own_name, name) = ((id, tag), (other, entry.body.tag));
                let [(a, view_a), (b, view_b)] = in_order((own_name, &own), (name, theirs));
                conflicts.push(conflict(contact, [a, b], (view_a, view_b), window));
            },
        );
        conflicts.sort_unstable_by(Conflict::order);
        Ok(conflicts)
    }
}
