//! The crowd that an error tells of.

use crate::id::{BodyId, TaggedBody};
use std::fmt;

/// An example from a crowd: the body of a sample that is near most others at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Crowd {
    /// The body's id.
    pub id: BodyId,
    /// The body's tag: 0 without [`Body::with_tag`](crate::Body::with_tag).
    pub tag: u64,
    /// Instant, s.
    pub time: f64,
    /// Number of other bodies whose bounding spheres come within the margin of the body's then. Pairs that the scene
    /// leaves out do not count.
    pub others: usize,
}

impl fmt::Display for Crowd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (body, plural) = (
            TaggedBody(self.id, self.tag),
            if self.others == 1 { "" } else { "s" },
        );
        write!(
            f,
            "{body} is near {} other{plural} at {:?} s",
            self.others, self.time
        )
    }
}
