//! Ids that never name the wrong thing: a slot and the generation that lives in it.

use std::fmt;

/// Names one body of one scene. An id whose body was removed is never valid again.
///
/// Ordered by slot, then generation: bodies inserted into a fresh scene are in insertion order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyId {
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl BodyId {
    /// No id comes before this one.
    pub(crate) const FIRST: Self = Self {
        slot: 0,
        generation: 0,
    };
    /// No id comes after this one.
    pub(crate) const LAST: Self = Self {
        slot: u32::MAX,
        generation: u32::MAX,
    };

    /// The slot: small, dense, reused after a removal (with another generation).
    #[must_use]
    pub const fn slot(self) -> u32 {
        self.slot
    }

    /// How often the slot had been used before this body.
    #[must_use]
    pub const fn generation(self) -> u32 {
        self.generation
    }
}

impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "body {}v{}", self.slot, self.generation)
    }
}
