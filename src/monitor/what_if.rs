//! `what_if`: the conflicts that hypothetical plans would cause.

use super::Monitor;
use super::monitored_bodies::MonitoredBody;
use crate::accuracy::Accuracy;
use crate::broad_phase::PairFilter;
use crate::conflict::Conflict;
use crate::error::Error;
use crate::id::BodyId;
use crate::narrow_phase::BodyView;
use crate::rounding::exact_interval;
use crate::scene::{Body, BodyPlanRef, PairAdmission};
use crate::screen::{
    PairQuestion, SolveScratch, conflict, extremes_of, is_apart, push_all_conflicts,
};
use crate::shape::BodyShape;
use crate::spans::in_order;
use crate::trajectory::Trajectory;

/// A body with a plan that it does not follow.
struct HypotheticalBody<'a> {
    id: BodyId,
    tag: u64,
    plan: &'a Trajectory,
    shape: BodyShape<'a>,
    monitored: MonitoredBody,
}

impl HypotheticalBody<'_> {
    fn view(&self) -> BodyView<'_> {
        self.monitored.view(self.plan, self.shape)
    }
}

impl Monitor {
    /// Returns the conflicts at a level, from now to [`complete_until`](Self::complete_until), that a body
    /// would have if it followed `plan` from now on. Nothing is changed.
    ///
    /// - The level's margin counts, as for [`conflicts`](Self::conflicts), not its release; so do layers and
    ///   ignored pairs.
    /// - A plan that began before now is followed from now on, as a [late](Self::replan) one. For a plan that
    ///   begins later, ask about the body's trajectory [spliced](crate::Trajectory::spliced) with it. (One that
    ///   [coasts](crate::Outside::Coast) is followed back from its first knot to now: the answer is for another motion.)
    /// - A body that does not exist now is taken to get the plan as a whole, as by
    ///   [`set_trajectory`](Self::set_trajectory). Then the plan may begin later.
    /// - Without an orientation in the plan, the body turns as it does; without a model error, it has the one that it has.
    /// - Changes since the last tick count. Before the first tick (also of a [restored](Self::restore) monitor that had
    ///   changes), and while a [budget](Self::advance_within) leaves the monitor behind its clock, nothing is known:
    ///   [`Error::NothingKnown`], not an empty answer.
    /// - Numbers may differ from those after a real [`replan`](Self::replan) by rounding. A place that a body leaves by
    ///   a jump at this very instant does not count.
    ///
    /// [`what_if_plans`](Self::what_if_plans) asks about several bodies that change their plans together,
    /// [`what_if_body`](Self::what_if_body) about a body that is not there yet.
    ///
    /// A question about a ball takes some microseconds, if few cubics of its plan lie ahead: all of these are compared. One
    /// about a turning cluster takes a hundred. After a tick in which
    /// [many bodies](Self#cost) changed, the first one forms boxes of all bodies: it takes about two thirds of such a tick.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownAlertLevel`]; [`Error::UnknownBody`], [`Error::InBody`]; in a body [`Error::NoNewPlan`] if the body
    /// exists now and the plan does not, or if the plan has ended by now, or [`Error::ModelError`]; if the plan could be
    /// followed, [`Error::NothingKnown`].
    pub fn what_if<'p>(
        &self,
        id: BodyId,
        plan: impl Into<BodyPlanRef<'p>>,
        level: usize,
    ) -> Result<Vec<Conflict>, Error> {
        self.what_if_plans([(id, plan)], level)
    }

    /// Returns the conflicts at a level, from now to [`complete_until`](Self::complete_until), that some bodies would
    /// have if each of them followed its plan from now on: those with each other, and those with all other
    /// bodies. Nothing is changed.
    ///
    /// Each plan is taken as by [`what_if`](Self::what_if). The last plan of a body that is named twice counts; those
    /// before it are checked as well. All pairs of the named bodies are compared by boxes of all of their way: a
    /// question about thousands takes longer than a screening of the scene with their plans.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::{AlertLevel, Body, Monitor, Scene, State, Trajectory};
    /// let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
    /// let rest = |x: f64| Trajectory::at_rest(x * DVec3::X);
    /// let first = monitor.insert(Body::new(rest(0.0)?))?;
    /// let second = monitor.insert(Body::new(rest(9.0)?))?;
    /// monitor.advance(0.0, &mut Vec::new())?;
    /// let ahead = |x: f64| Trajectory::coasting(State::new(0.0, x * DVec3::X, DVec3::X));
    /// // The first alone would run into the second; if both move on, they stay apart.
    /// assert_eq!(monitor.what_if(first, &ahead(0.0)?, 0)?.len(), 1);
    /// let plans = [(first, &ahead(0.0)?), (second, &ahead(9.0)?)];
    /// assert!(monitor.what_if_plans(plans, 0)?.is_empty());
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`what_if`](Self::what_if), for the first plan to which one applies.
    pub fn what_if_plans<'p>(
        &self,
        plans: impl IntoIterator<Item = (BodyId, impl Into<BodyPlanRef<'p>>)>,
        level: usize,
    ) -> Result<Vec<Conflict>, Error> {
        let margin = self.alert_margin(level)?;
        let plans = plans.into_iter();
        let bodies = plans.map(|(id, plan)| self.hypothetical(id, plan.into()));
        let mut bodies: Vec<_> = bodies.collect::<Result<_, _>>()?;
        // The last one of each body, which a stable order puts first.
        bodies.reverse();
        bodies.sort_by_key(|body| body.id.slot);
        bodies.dedup_by_key(|body| body.id.slot);
        let filter = PairAdmission::of(&self.scene, self.search.grid.margin, &|| false);
        let admits = |own: u32, other: u32| filter.admits(own.min(other), own.max(other));
        self.conflicts_of_hypothetical(&bodies, margin, &admits)
    }

    /// Returns a body of the scene as it would be if it followed a plan from now on.
    fn hypothetical<'a>(
        &'a self,
        id: BodyId,
        plan: BodyPlanRef<'a>,
    ) -> Result<HypotheticalBody<'a>, Error> {
        let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        let model_error = plan.model_error_of(body);
        let BodyPlanRef {
            trajectory: plan,
            orientation,
            ..
        } = plan;
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
        let model_error = model_error.map_err(|error| error.with_id(id))?;
        let shape = BodyShape::new(&body.hitbox, orientation.turning(), model_error);
        let hypothetical = self.prepare_hypothetical((id, body.tag), (plan, shape));
        hypothetical.map_err(|error| error.with_id(id))
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
        let margin = self.alert_margin(level)?;
        Body::check_turning(&body.hitbox, &body.orientation, body.tag)?;
        let id = self.scene.next_id()?;
        let admits = |_, other: u32| {
            let other = self.scene.in_slot(other);
            other.is_some_and(|(_, entry)| entry.body.layers.admits(body.layers))
        };
        let own = (&body.trajectory, body.shape());
        let hypothetical = self.prepare_hypothetical((id, body.tag), own)?;
        self.conflicts_of_hypothetical(&[hypothetical], margin, &admits)
    }

    fn alert_margin(&self, level: usize) -> Result<f64, Error> {
        let alert = self.levels.get(level);
        let alert = alert.ok_or(Error::UnknownAlertLevel { level })?;
        Ok(alert.margin)
    }

    fn prepare_hypothetical<'a>(
        &self,
        (id, tag): (BodyId, u64),
        (plan, shape): (&'a Trajectory, BodyShape<'a>),
    ) -> Result<HypotheticalBody<'a>, Error> {
        let monitored = self.change_context()?.monitored_body(plan, shape, tag)?;
        Ok(HypotheticalBody {
            id,
            tag,
            plan,
            shape,
            monitored,
        })
    }

    /// Returns the conflicts within a margin (m) of bodies in ascending order of slots: with each other, and with those
    /// bodies of the scene whose slots they do not have. `admits` says which two slots may be a pair, the first
    /// one that of a body given here.
    fn conflicts_of_hypothetical(
        &self,
        bodies: &[HypotheticalBody<'_>],
        margin: f64,
        admits: &dyn Fn(u32, u32) -> bool,
    ) -> Result<Vec<Conflict>, Error> {
        let window = (self.now, self.known);
        // An empty answer would look like a free way.
        if window.1 <= window.0 {
            return Err(Error::NothingKnown {
                now: self.now,
                complete_until: self.complete_until(),
            });
        }
        let is_given = |slot| bodies.binary_search_by_key(&slot, |body| body.id.slot);
        let (mut conflicts, mut scratch) = (Vec::new(), SolveScratch::default());
        // A single body has no pair here.
        let count = if bodies.len() > 1 { bodies.len() } else { 0 };
        let range = |body: &HypotheticalBody<'_>| extremes_of(&body.view(), exact_interval(window));
        let ranges: Vec<_> = bodies[..count].iter().map(range).collect();
        for (place, body) in bodies.iter().enumerate() {
            let (own_slot, own) = (body.id.slot, body.view());
            let name = (body.id, body.tag);
            self.search.contacts_with(
                &self.scene,
                (own_slot, &body.monitored, &own),
                margin,
                window,
                &|other| is_given(other).is_err() && admits(own_slot, other),
                |other, window, theirs, contact| {
                    let Some((other, entry)) = self.scene.in_slot(other) else {
                        return;
                    };
                    let other = (other, entry.body.tag);
                    let [(a, view_a), (b, view_b)] = in_order((name, &own), (other, theirs));
                    conflicts.push(conflict(contact, [a, b], (view_a, view_b), window));
                },
            );
            for (later, range) in bodies.iter().zip(&ranges).skip(place + 1) {
                let reaches = [body.shape.reach(), later.shape.reach(), margin];
                if is_apart(&ranges[place], range, reaches) || !admits(own_slot, later.id.slot) {
                    continue;
                }
                let name_b = (later.id, later.tag);
                let (views, asked) = ((&own, &later.view()), (margin, Accuracy::Exact));
                if let Some(question) = PairQuestion::of([name, name_b], views, asked, window) {
                    push_all_conflicts(&question, &mut scratch, &mut conflicts);
                }
            }
        }
        conflicts.sort_unstable_by(Conflict::order);
        Ok(conflicts)
    }
}
