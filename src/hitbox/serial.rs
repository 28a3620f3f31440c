//! Serialised hitboxes: a list of spheres, or the normal of a half-space.

use super::{Hitbox, Sphere};
use crate::error::Error;
use glam::DVec3;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// The numbers of a hitbox as they were given; derived is the form of binary formats, which must say what follows.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) enum HitboxNumbers {
    Spheres(Vec<Sphere>),
    HalfSpace(DVec3),
}

/// A half-space in people's formats, where spheres are a plain list.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct HalfSpaceEntry {
    /// Unit vector out of it.
    half_space: DVec3,
}

impl Serialize for HitboxNumbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            _ if !serializer.is_human_readable() => Self::serialize(self, serializer),
            Self::Spheres(spheres) => spheres.serialize(serializer),
            &Self::HalfSpace(half_space) => HalfSpaceEntry { half_space }.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for HitboxNumbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_any(TextVisitor)
        } else {
            Self::deserialize(deserializer)
        }
    }
}

/// Reads the form of people's formats as it comes: numbers that are kept until it is known may have lost their type.
struct TextVisitor;

impl<'de> Visitor<'de> for TextVisitor {
    type Value = HitboxNumbers;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of spheres, or half_space and its normal")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, spheres: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(spheres)).map(HitboxNumbers::Spheres)
    }

    fn visit_map<A: MapAccess<'de>>(self, entry: A) -> Result<Self::Value, A::Error> {
        let entry = HalfSpaceEntry::deserialize(MapAccessDeserializer::new(entry))?;
        Ok(HitboxNumbers::HalfSpace(entry.half_space))
    }
}

impl From<Hitbox> for HitboxNumbers {
    fn from(hitbox: Hitbox) -> Self {
        match hitbox.normal() {
            Some(normal) => Self::HalfSpace(normal),
            None => Self::Spheres(hitbox.spheres().to_vec()),
        }
    }
}

impl TryFrom<HitboxNumbers> for Hitbox {
    type Error = Error;

    fn try_from(numbers: HitboxNumbers) -> Result<Self, Error> {
        match numbers {
            HitboxNumbers::Spheres(spheres) => Self::cluster(spheres),
            HitboxNumbers::HalfSpace(normal) => Self::half_space(normal),
        }
    }
}
