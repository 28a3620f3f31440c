//! The crowd that an error tells of.

use crate::id::{BodyId, TaggedBody};
use std::fmt;

/// An example from a crowd: a body that comes near many others, the one with most of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Crowd {
    /// The body's id.
    pub id: BodyId,
    /// The body's tag: 0 without [`Body::with_tag`](crate::Body::with_tag).
    pub tag: u64,
    /// Number of other bodies whose bounding spheres come within the margin of its own, in the time that was searched; or in
    /// a part of it, where plans are long.
    pub others: usize,
    /// The first instant at which most of these are that near, s.
    pub time: f64,
}

impl Crowd {
    pub(crate) fn is_larger_than(&self, other: Option<Self>) -> bool {
        other.is_none_or(|other| self.others > other.others)
    }
}

impl fmt::Display for Crowd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (body, plural) = (
            TaggedBody(self.id, self.tag),
            if self.others == 1 { "" } else { "s" },
        );
        write!(
            f,
            "{body} comes near {} other{plural}, to most at {:?} s",
            self.others, self.time
        )
    }
}
