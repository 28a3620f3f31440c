//! The body or the command that an error is about, and the sentence that a program prints.

use super::Error;
use crate::id::BodyId;
use std::fmt;

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

    /// Returns the error of a plan that follows others, with its knot counted in the last plan: `before` knots precede
    /// that one's. The first one stands for all of them.
    pub(crate) fn after_knots(mut self, before: usize) -> Self {
        self.skip_knots(before);
        self
    }

    fn skip_knots(&mut self, before: usize) {
        match self {
            Self::InBody { error, .. } => error.skip_knots(before),
            Self::OutOfRange { knot, .. } | Self::TooFar { knot, .. } => {
                *knot = knot.saturating_sub(before);
            }
            _ => {}
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

/// A program that unwraps an error, or returns one from `main`, prints this: the sentence of `Display`.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
