//! Serialised hitboxes: a list of spheres, or the normal of a half-space.

use super::{Hitbox, Sphere};
use crate::error::Error;
use glam::DVec3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The numbers of a hitbox as they were given.
#[derive(Clone, Debug)]
pub(super) enum HitboxNumbers {
    Spheres(Vec<Sphere>),
    HalfSpace(DVec3),
}

/// The form of people's formats: spheres are a plain list.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum TextForm {
    Spheres(Vec<Sphere>),
    HalfSpace(NormalEntry),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalEntry {
    /// Unit vector out of it.
    half_space: DVec3,
}

/// The form of binary formats, which must say what follows.
#[derive(Serialize, Deserialize)]
enum Tagged {
    Spheres(Vec<Sphere>),
    HalfSpace(DVec3),
}

impl Serialize for HitboxNumbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let is_readable = serializer.is_human_readable();
        match (self.clone(), is_readable) {
            (Self::Spheres(spheres), true) => TextForm::Spheres(spheres).serialize(serializer),
            (Self::HalfSpace(half_space), true) => {
                TextForm::HalfSpace(NormalEntry { half_space }).serialize(serializer)
            }
            (Self::Spheres(spheres), false) => Tagged::Spheres(spheres).serialize(serializer),
            (Self::HalfSpace(normal), false) => Tagged::HalfSpace(normal).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for HitboxNumbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            Ok(match TextForm::deserialize(deserializer)? {
                TextForm::Spheres(spheres) => Self::Spheres(spheres),
                TextForm::HalfSpace(NormalEntry { half_space }) => Self::HalfSpace(half_space),
            })
        } else {
            Ok(match Tagged::deserialize(deserializer)? {
                Tagged::Spheres(spheres) => Self::Spheres(spheres),
                Tagged::HalfSpace(normal) => Self::HalfSpace(normal),
            })
        }
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
