//! One body against all others of a scene.

use super::pair::push_all_conflicts;
use super::prepared::{checked_margin, lone_view};
use super::solve::{PairQuestion, SolveScratch};
use crate::bounds::DAabb;
use crate::conflict::Conflict;
use crate::error::Error;
use crate::hitbox::Sphere;
use crate::id::BodyId;
use crate::narrow_phase::BodyView;
use crate::parallel;
use crate::query::Query;
use crate::rounding::{CLEARANCE, exact_interval};
use crate::scene::{Body, BodyPlanRef, Scene, SceneEntry, planned};
use crate::spans::in_order;
use std::iter::once;
use std::slice::from_ref;

/// Bodies that one thread examines at a time.
const CHUNK: usize = 256;

/// The shape that bodies have in a question.
#[derive(Clone, Copy, Debug)]
pub(super) enum AskedShape {
    Hitbox,
    /// One sphere, with the model error. A half-space stays one.
    BoundingSphere,
}

impl AskedShape {
    fn of<'v>(self, view: BodyView<'v>, bounding: &'v Sphere) -> BodyView<'v> {
        match self {
            Self::BoundingSphere if !view.is_half_space() => BodyView {
                spheres: from_ref(bounding),
                hitbox: None,
                turning: None,
                model_error: 0.0,
                ..view
            },
            Self::Hitbox | Self::BoundingSphere => view,
        }
    }
}

impl Scene {
    /// Returns all conflicts of a body that is not in the scene with those that are, within the
    /// query's window and margin, sorted by (enter, a, b): may it fly this? Nothing is changed.
    ///
    /// The bits are those that a [screening](Self::screen) of the scene with the body
    /// [inserted](Self::insert) would report of its pairs; [`pair`](crate::pair) names an exception. Its id in the answer is the one that it
    /// would have. A query without a window asks about the time that all plans cover, its own
    /// included. Layers count. The query's limit of spans does not: each pair is examined by
    /// itself. The cost is proportional to the number of bodies, and to that of their cubics in the window: of long
    /// plans it may be that of a screening.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Body, Query, Scene, State, Trajectory};
    ///
    /// let mut scene = Scene::new();
    /// let towers: Vec<_> = [40.0, 70.0]
    ///     .into_iter()
    ///     .map(|x| scene.insert(Body::new(Trajectory::at_rest(x * DVec3::X)?)))
    ///     .collect::<Result<_, _>>()?;
    /// let fly = [0.0, 9.0].map(|t| State::new(t, t * 5.0 * DVec3::X, 5.0 * DVec3::X));
    /// let drone = Body::new(Trajectory::from_states(&fly)?);
    /// let conflicts = scene.conflicts_with(&drone, &Query::default().with_margin(2.0))?;
    /// // It comes to 45 m: past one tower.
    /// assert_eq!((conflicts.len(), conflicts[0].a), (1, towers[0]));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`screen`](Self::screen), except [`Error::TooCrowded`]; [`Error::InBody`] with [`Error::TurningHalfSpace`];
    /// [`Error::SceneFull`].
    pub fn conflicts_with(&self, body: &Body, query: &Query) -> Result<Vec<Conflict>, Error> {
        self.conflicts_of_one((self.next_id()?, body), query, AskedShape::Hitbox)
    }

    /// Returns all conflicts that a body would have with the others if it followed another plan, within the query's window
    /// and margin, sorted by (enter, a, b): may it fly that instead? Nothing is changed.
    ///
    /// The bits are those that a [screening](Self::screen) would report of its pairs if the scene had this plan for the
    /// body; [`pair`](crate::pair) names an exception. Without an orientation in the plan, the body turns as it does. A
    /// query without a window asks about the time that all plans cover, this one in place of the body's own. Layers and
    /// ignored pairs count. The query's limit of spans does not. The cost is proportional to the number of bodies, and to that of
    /// their cubics in the window: of long plans it may be that of a screening.
    ///
    /// Asked with the plan that the body has, it tells which conflicts one body of the scene has with all others.
    ///
    /// [`Monitor::what_if`](crate::Monitor::what_if) asks about the lookahead of a monitor, and takes less time.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Body, Query, Scene, State, Trajectory};
    ///
    /// let line = |y: f64, velocity: f64| {
    ///     let state = |t: f64| State::new(t, DVec3::new(velocity * t, y, 0.0), velocity * DVec3::X);
    ///     Trajectory::from_states(&[state(0.0), state(10.0)])
    /// };
    /// let mut scene = Scene::new();
    /// let drone = scene.insert(Body::new(line(0.0, 3.0)?))?;
    /// scene.insert(Body::new(line(8.0, 3.0)?))?;
    /// let query = Query::default().with_margin(2.0);
    /// assert!(scene.screen(&query)?.conflicts.is_empty());
    /// // Another lane would be too near.
    /// assert!(scene.what_if(drone, &line(4.0, 3.0)?, &query)?.is_empty());
    /// assert_eq!(scene.what_if(drone, &line(7.0, 3.0)?, &query)?.len(), 1);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`screen`](Self::screen), except [`Error::TooCrowded`]; [`Error::InBody`] with [`Error::TurningHalfSpace`]
    /// or [`Error::ModelError`]; [`Error::UnknownBody`].
    pub fn what_if<'p>(
        &self,
        id: BodyId,
        plan: impl Into<BodyPlanRef<'p>>,
        query: &Query,
    ) -> Result<Vec<Conflict>, Error> {
        let body = self.body(id).ok_or(Error::UnknownBody { id })?;
        let plan = plan.into();
        let model_error = plan.model_error_of(body);
        let model_error = model_error.map_err(|error| error.with_id(id))?;
        let mut changed = body.clone().with_model_error(model_error)?;
        changed.trajectory.clone_from(plan.trajectory);
        if let Some(orientation) = plan.orientation {
            changed.orientation.clone_from(orientation);
        }
        self.conflicts_of_one((id, &changed), query, AskedShape::Hitbox)
    }

    /// Returns all conflicts of a body with those of the scene that have another id.
    pub(super) fn conflicts_of_one(
        &self,
        (own_id, body): (BodyId, &Body),
        query: &Query,
        shape: AskedShape,
    ) -> Result<Vec<Conflict>, Error> {
        let margin = checked_margin(query)?;
        let entries: Vec<_> = self.entries().filter(|&(id, _)| id != own_id).collect();
        let others = entries.iter().map(|(_, entry)| &entry.body);
        let asked = query.window().or_else(|| planned(others.chain(once(body))));
        let window = asked.ok_or(Error::NoPlan)?;
        let own = lone_view(body, window).map_err(|error| match self.body(own_id) {
            Some(_) => error.with_id(own_id),
            None => error,
        })?;
        let bounding = own.bounding;
        let own = shape.of(own, &bounding);
        // What happens within a rounding of an end is reported at the end.
        let exact = exact_interval(window.ends());
        let range = extremes_of(&own, exact);
        let chunks: Vec<_> = entries.chunks(CHUNK).collect();
        let found = parallel::map(chunks.len(), SolveScratch::default, |scratch, chunk| {
            let mut found = Vec::new();
            for &(id, entry) in chunks[chunk] {
                let other = &entry.body;
                // What would make a screening fail does so here.
                let view = lone_view(other, window).map_err(|error| error.with_id(id))?;
                let reaches = [body.shape().reach(), other.shape().reach(), margin];
                let is_far = || is_apart(&range, &extremes_in(entry, &view, exact), reaches);
                let admits = body.layers.admits(other.layers) && !self.ignores(own_id, id);
                if !admits || is_far() {
                    continue;
                }
                let bounding = view.bounding;
                let view = shape.of(view, &bounding);
                let (own_name, name) = ((own_id, body.tag), (id, other.tag));
                let [(a, view_a), (b, view_b)] = in_order((own_name, &own), (name, &view));
                let (views, asked) = ((view_a, view_b), (margin, query.accuracy()));
                if let Some(question) = PairQuestion::of([a, b], views, asked, window.ends()) {
                    push_all_conflicts(&question, scratch, &mut found);
                }
            }
            Ok(found)
        });
        let found: Result<Vec<_>, Error> = found.into_iter().collect();
        let mut conflicts = found?.concat();
        conflicts.sort_by(Conflict::order);
        Ok(conflicts)
    }
}

/// Returns a box around a body's motion between two instants (s), m; to rounding.
fn extremes_in(entry: &SceneEntry, view: &BodyView<'_>, interval: (f64, f64)) -> DAabb {
    if view.knots.has_unlisted_cubics() || !entry.body.trajectory.straight_motions().is_empty() {
        extremes_of(view, interval)
    } else {
        // Known: that of the whole plan.
        entry.summary().around()
    }
}

/// Returns a box around a motion between two instants (s), cubic by cubic, m. It holds all that is reported as a contact
/// there: the solver's rounding is relative to the whole of a cubic.
pub(crate) fn extremes_of(view: &BodyView<'_>, (start, end): (f64, f64)) -> DAabb {
    let knots = &view.knots;
    let mut extremes = DAabb::NOTHING;
    for cubic in knots.count(|knot| knot < start).max(1) - 1..knots.cubics() {
        let (begins, ends) = (knots.at(cubic), knots.at(cubic + 1));
        if begins > end {
            break;
        }
        let (from, to) = (begins.max(start), ends.min(end));
        if from > to {
            continue;
        }
        let segment = view.segment(cubic);
        let part = segment.restrict(from, to);
        // The scale of a pair is at most the gap and twice the extents of both cubics. Of the gap the test takes account.
        let error = part.error + 2.0 * CLEARANCE * segment.rounding_scale(begins, ends);
        for point in part.points {
            let point = segment.origin() + point;
            extremes.include(DAabb {
                low: point - error,
                high: point + error,
            });
        }
    }
    extremes
}

/// Returns true if two boxes are certainly farther apart on some axis than two reaches and a margin, which may be
/// negative, add up to (m).
pub(crate) fn is_apart(one: &DAabb, other: &DAabb, reaches: [f64; 3]) -> bool {
    /// Bound of the rounding of the boxes and the sum, relative to their numbers: far above the true one.
    const ROUNDING: f64 = 1e-12;
    let size = [one.low, one.high, other.low, other.high].map(|corner| corner.abs().max_element());
    let sizes = size.into_iter().chain(reaches.map(f64::abs));
    let room = reaches.iter().sum::<f64>() + ROUNDING * sizes.fold(0.0, f64::max);
    let gap = (one.low - other.high).max(other.low - one.high);
    gap.max_element() > room
}
