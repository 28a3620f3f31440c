//! Plans that are only thought of: what would they lead into?

use super::{Monitor, SlotAdmission};
use crate::conflict::Conflict;
use crate::error::Error;
use crate::id::BodyId;
use crate::scene::{Body, BodyPlanRef};
use crate::screen::conflict;
use crate::shape::BodyShape;

impl Monitor {
    /// Which conflicts at a level the body would have from now to
    /// [`complete_until`](Self::complete_until) if it followed `plan` from now on. Changes
    /// nothing. The level's margin counts, as for [`conflicts`](Self::conflicts), not its release
    /// margin; so do layers and ignored pairs. A plan that began before now is followed from now on, as one
    /// that is [late](Self::replan) would be. What has changed since the last tick counts; before the
    /// first tick nothing is known, and nothing found. For a body that is not there yet, put it in at
    /// rest where nobody comes, ask, and [set its trajectory](Self::set_trajectory) if the answer pleases. For a plan that begins later, ask about what
    /// [`replan`](Self::replan) would make of it: the body's trajectory
    /// [spliced](crate::Trajectory::spliced) with it. Without an orientation in the plan, the body turns as it
    /// does.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::InBody`]; [`Error::UnknownAlertLevel`]; in a body [`Error::NoPlanAt`] if
    /// the plan does not exist now, as [`replan`](Self::replan) would say.
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
        if !body.trajectory.domain().contains(self.now) || !plan.goes_on_from(self.now) {
            return Err(Error::NoPlanAt { time: self.now }.in_body(body.tag));
        }
        let orientation = orientation.unwrap_or(&body.orientation);
        Body::check_turning(&body.hitbox, orientation, body.tag)?;
        let shape = BodyShape::new(&body.hitbox, orientation.turning());
        let flight = self.terms()?.flight(plan, shape, body.tag)?;
        let own = flight.view(plan, shape);
        let window = (self.now, self.known);
        if window.1 < window.0 {
            return Ok(Vec::new());
        }
        let (margin, _) = self.search.reach();
        let filter = SlotAdmission::of(&self.scene, margin, None);
        let mut conflicts = Vec::new();
        self.search.contacts_with(
            &self.scene,
            (id.slot, &flight, &own),
            alert.margin,
            window,
            &filter,
            |other, clip, theirs, contact| {
                let Some((other, entry)) = self.scene.in_slot(other) else {
                    return;
                };
                let (own_name, other_name) = ((id, body.tag), (other, entry.body.tag));
                conflicts.push(if id.slot < other.slot {
                    conflict(contact, [own_name, other_name], (&own, theirs), clip)
                } else {
                    conflict(contact, [other_name, own_name], (theirs, &own), clip)
                });
            },
        );
        conflicts.sort_unstable_by(Conflict::order);
        Ok(conflicts)
    }
}
