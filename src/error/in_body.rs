//! The body that an error is about.

use super::Error;
use crate::id::BodyId;

impl Error {
    /// Returns the error wrapped in that of a body with this tag. An error of a body stays as it is.
    #[must_use]
    pub fn in_body(self, body: u64) -> Self {
        match self {
            Self::InBody { .. } => self,
            other => Self::InBody {
                body,
                id: None,
                error: Box::new(other),
            },
        }
    }

    /// Returns an error that names a body with the body's id. Errors that name none, or only an id, stay as they are.
    #[must_use]
    pub fn with_id(mut self, of: BodyId) -> Self {
        if let Self::InBody { id, .. } | Self::WindowNotClosed { id, .. } = &mut self {
            *id = Some(of);
        }
        self
    }
}
