//! Model errors of a scene's bodies.

use super::Scene;
use super::body::checked_model_error;
use crate::error::Error;
use crate::id::BodyId;
use crate::narrow_phase::{pair_error, widened};

impl Scene {
    /// Replaces a body's [model error](crate::Body::with_model_error) (m) and returns the old one.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::ModelError`].
    pub fn set_model_error(&mut self, id: BodyId, metres: f64) -> Result<f64, Error> {
        let body = &mut self.entry_mut(id)?.0.body;
        let checked =
            checked_model_error(metres).map_err(|error| error.in_body(body.tag).with_id(id))?;
        let old = std::mem::replace(&mut body.model_error, checked);
        self.count_shape(id);
        Ok(old)
    }

    /// Notes that the hitbox or the model error of a body has changed.
    pub(super) fn count_shape(&mut self, id: BodyId) {
        let slot = self.slots.get(id.slot as usize);
        if let Some(entry) = slot.and_then(|slot| slot.entry.as_ref()) {
            self.kinds.add_shape(&entry.body);
        }
    }

    /// Returns a margin (m) plus the model errors of the bodies of two slots: the largest separation of the
    /// splines at which the bodies may be within the margin.
    pub(crate) fn widened(&self, (a, b): (u32, u32), margin: f64) -> f64 {
        if !self.kinds.has_model_errors {
            return margin;
        }
        let error = |slot| {
            let body = self.in_slot(slot);
            body.map_or(0.0, |(_, entry)| entry.body.model_error())
        };
        widened(margin, pair_error(error(a), error(b)))
    }
}
