//! Generational ids of bodies.

use std::fmt;

/// Names one body of one scene. An id whose body was removed is never valid again.
///
/// A copy of a scene, and a monitor that is [restored](crate::Monitor::restore), give the ids again that the original has given
/// since: forget those.
///
/// Ids are ordered by slot, then generation: bodies inserted into a fresh scene are in insertion order. `serde` writes
/// [one number](Self::to_bits), which can be a key of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId {
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl BodyId {
    /// The lowest id.
    pub(crate) const FIRST: Self = Self {
        slot: 0,
        generation: 0,
    };
    /// The highest id.
    pub(crate) const LAST: Self = Self {
        slot: u32::MAX,
        generation: u32::MAX,
    };

    /// Returns the slot: small, dense, reused after a removal (with another generation).
    #[must_use]
    pub const fn slot(self) -> u32 {
        self.slot
    }

    /// Returns the id as one number: the generation in the upper 32 bits, the slot in the lower.
    ///
    /// [`from_bits`](Self::from_bits) is the inverse. The number is valid where the id is: in its
    /// scene, in copies of it, and in scenes restored from it by `serde`. Numbers are not ordered
    /// as ids are.
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        (self.generation as u64) << 32 | self.slot as u64
    }

    /// Returns the id with this number: the inverse of
    /// [`to_bits`](Self::to_bits), for any number. A scene without
    /// such a body answers with [`Error::UnknownBody`](crate::Error::UnknownBody).
    #[must_use]
    #[allow(clippy::cast_possible_truncation, reason = "the lower half is meant")]
    pub const fn from_bits(bits: u64) -> Self {
        Self {
            slot: bits as u32,
            generation: (bits >> 32) as u32,
        }
    }

    /// Returns the number of bodies that used the slot before this one.
    #[must_use]
    pub const fn generation(self) -> u32 {
        self.generation
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for BodyId {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(self.to_bits())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for BodyId {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        u64::deserialize(deserializer).map(Self::from_bits)
    }
}

impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "body {}v{}", self.slot, self.generation)
    }
}

/// A body as answers name it: by its id, and by its tag where it has one.
pub(crate) struct TaggedBody(pub(crate) BodyId, pub(crate) u64);

/// A body as errors name it: by its tag alone while it has no id.
pub(crate) struct NamedBody(pub(crate) Option<BodyId>, pub(crate) u64);

impl fmt::Display for NamedBody {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self(Some(id), tag) => TaggedBody(id, tag).fmt(f),
            Self(None, tag) => write!(f, "body {tag}"),
        }
    }
}

impl fmt::Display for TaggedBody {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self(id, 0) => id.fmt(f),
            Self(id, tag) => write!(f, "{id} (tag {tag})"),
        }
    }
}
