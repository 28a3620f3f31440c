//! The outcome of a batch for one body, prepared before anything is changed.

use super::grid::Grid;
use super::monitored_bodies::MonitoredBody;
use crate::error::{Error, check_change_time};
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::orientation::Orientation;
use crate::scene::{Body, Scene, checked_model_error};
use crate::shape::BodyShape;
use crate::trajectory::{StraightMotion, Trajectory};
use crate::window::Window;

/// The context in which all changes are prepared.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChangeContext<'m> {
    pub(super) grid: &'m Grid,
    /// Window over which plans are followed.
    pub(super) window: Window,
    /// The clock of the last tick, s.
    pub(super) now: f64,
    /// End of the history, s.
    pub(super) history_end: f64,
    /// True if the history ends at the instant up to which the last tick reported.
    pub(super) is_end_reported: bool,
}

impl ChangeContext<'_> {
    /// Returns the instant before which cubics end that a body forgets when it follows another motion from `from` (s) on, s.
    pub(super) fn forget_before(&self, from: f64) -> f64 {
        // The last tick has seen what ended at that very instant, unless it ends there only now.
        if self.is_end_reported && from > self.history_end {
            self.history_end.next_up()
        } else {
            self.history_end
        }
    }

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
    pub(super) fn takes_effect_at(
        &self,
        old: &Trajectory,
        plan: &Trajectory,
        from: f64,
    ) -> Result<f64, Error> {
        check_change_time(from)?;
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

/// The parts of a body that a batch replaces.
#[derive(Debug)]
pub(super) struct PendingChange {
    pub(super) id: BodyId,
    pub(super) is_removed: bool,
    pub(super) trajectory: Option<Trajectory>,
    /// A straight motion that replaces the body's own in place, from an instant (s) on; only layers may change with it.
    pub(super) in_place: Option<(f64, StraightMotion)>,
    /// Number of knots of the last plan as it was given: before these come those of the motion so far.
    pub(super) own_knots: usize,
    /// Set while the trajectory is a bare plan, which the past motion must precede.
    splice: Option<PendingSplice>,
    /// Instant from which the body follows its last plan, if that was late, s.
    pub(super) late: Option<f64>,
    pub(super) hitbox: Option<Hitbox>,
    pub(super) orientation: Option<Orientation>,
    pub(super) layers: Option<Layers>,
    pub(super) model_error: Option<f64>,
    /// Numbers of the first and the last command that concern the body.
    first: usize,
    pub(super) last: usize,
    /// The monitored body with these parts; none once taken, and for removed bodies.
    pub(super) monitored: Option<MonitoredBody>,
    pub(super) refusal: Option<Refusal>,
    /// True if the body has all of this already.
    pub(super) is_in_vain: bool,
}

/// Instant from which a plan is followed (none: the last knot of the one before), s.
#[derive(Clone, Copy, Debug)]
struct PendingSplice {
    from: Option<f64>,
    command: usize,
}

/// The number of a refused command, and the reason.
pub(super) type Refusal = (usize, Error);

impl PendingChange {
    pub(super) const fn nothing(id: BodyId, command: usize) -> Self {
        Self {
            id,
            is_removed: false,
            trajectory: None,
            in_place: None,
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
            is_in_vain: false,
        }
    }

    /// Returns the current body.
    pub(super) fn body<'s>(&self, scene: &'s Scene) -> Result<&'s Body, Refusal> {
        let unknown = (self.first, Error::UnknownBody { id: self.id });
        scene.body(self.id).ok_or(unknown)
    }

    /// Joins the plan so far, up to `from` (none: its last knot), and `plan`.
    pub(super) fn follow(
        &mut self,
        scene: &Scene,
        from: Option<f64>,
        plan: Trajectory,
        context: &ChangeContext<'_>,
    ) -> Result<(), Refusal> {
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
    pub(super) fn last_knot(
        &mut self,
        scene: &Scene,
        context: &ChangeContext<'_>,
    ) -> Result<f64, Refusal> {
        self.splice(scene, context)?;
        let own = &self.body(scene)?.trajectory;
        let plan = self.trajectory.as_ref().unwrap_or(own);
        Ok(plan.knots().last().copied().unwrap_or(0.0))
    }

    /// Lets the body turn as `next` says from `from` (s) on.
    pub(super) fn orient(
        &mut self,
        scene: &Scene,
        (from, next): (f64, &Orientation),
        context: &ChangeContext<'_>,
    ) -> Result<(), Refusal> {
        let body = self.body(scene)?;
        let before = self.orientation.as_ref().unwrap_or(&body.orientation);
        let both = before.followed_by(next, from, context.history_end);
        let both = both.map_err(|error| (self.last, error.in_body(body.tag).with_id(self.id)))?;
        self.orientation = Some(both);
        Ok(())
    }

    /// Gives the body another model error (m), if there is one.
    pub(super) fn set_model_error(
        &mut self,
        scene: &Scene,
        metres: Option<f64>,
    ) -> Result<(), Refusal> {
        if let Some(metres) = metres {
            let tag = self.body(scene)?.tag;
            let checked = checked_model_error(metres);
            let checked =
                checked.map_err(|error| (self.last, error.in_body(tag).with_id(self.id)))?;
            self.model_error = Some(checked);
        }
        Ok(())
    }

    /// Notes from when on a pending straight motion replaces the body's own in place, if it can.
    fn find_in_place(&mut self, body: &Body, context: &ChangeContext<'_>) -> Result<(), Refusal> {
        let (Some(plan), Some(splice)) = (&self.trajectory, self.splice) else {
            return Ok(());
        };
        let (Some((motion, _)), Some(asked)) = (plan.straight(), splice.from) else {
            return Ok(());
        };
        let from = context.takes_effect_at(&body.trajectory, plan, asked);
        let from =
            from.map_err(|error| (splice.command, error.in_body(body.tag).with_id(self.id)))?;
        let keeps_shape =
            self.hitbox.is_none() && self.orientation.is_none() && self.model_error.is_none();
        let times = (from, context.forget_before(from));
        if keeps_shape && body.trajectory.can_replace(times, motion, context.window) {
            self.late = Some(from).filter(|from| asked < *from);
            self.in_place = Some((from, *motion));
        }
        Ok(())
    }

    /// Joins the body's own trajectory and the plan, if that is pending.
    pub(super) fn splice(
        &mut self,
        scene: &Scene,
        context: &ChangeContext<'_>,
    ) -> Result<(), Refusal> {
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
    ) -> Result<(), Refusal> {
        let (Some(plan), Some(splice)) = (&mut self.trajectory, self.splice.take()) else {
            return Ok(());
        };
        let from = match splice.from {
            Some(from) => context.takes_effect_at(old, plan, from),
            None => Ok(old.knots().last().copied().unwrap_or(0.0)),
        };
        let spliced = from.and_then(|from| {
            self.late = splice.from.filter(|asked| *asked < from).map(|_| from);
            plan.precede_by(old, from, context.forget_before(from))
        });
        spliced.map_err(|error| (splice.command, error.in_body(tag).with_id(self.id)))
    }

    /// Returns true if the body has all of this.
    fn is_as(&self, body: &Body) -> bool {
        let same = |plan: &Trajectory| *plan == body.trajectory;
        self.trajectory.as_ref().is_none_or(same)
            && self
                .hitbox
                .as_ref()
                .is_none_or(|hitbox| *hitbox == body.hitbox)
            && self
                .orientation
                .as_ref()
                .is_none_or(|orientation| *orientation == body.orientation)
            && self.layers.is_none_or(|layers| layers == body.layers)
            && self
                .model_error
                .is_none_or(|metres| metres.to_bits() == body.model_error().to_bits())
    }

    /// Prepares the outcome for the body.
    pub(super) fn prepare(
        &mut self,
        scene: &Scene,
        context: &ChangeContext<'_>,
    ) -> Result<(), Refusal> {
        let body = self.body(scene)?;
        if !self.is_removed {
            self.find_in_place(body, context)?;
            if self.in_place.is_some() {
                return Ok(());
            }
            // A plan that is followed from an instant on may be late, which is told.
            self.is_in_vain = self.splice.is_none() && self.is_as(body);
        }
        self.splice(scene, context)?;
        if !self.is_removed && !self.is_in_vain {
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
