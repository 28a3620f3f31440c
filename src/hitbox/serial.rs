//! Serialised hitboxes: a list of spheres, or the normal of a half-space.

use super::{Hitbox, Sphere};
use crate::error::Error;
use glam::DVec3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The numbers of a hitbox as they were given; derived is the form of binary formats, which must say what follows.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) enum HitboxNumbers {
    Spheres(Vec<Sphere>),
    HalfSpace(DVec3),
}

/// The form of people's formats: spheres are a plain list.
#[derive(Serialize, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
enum TextForm {
    Spheres(Vec<Sphere>),
    HalfSpace {
        /// Unit vector out of it.
        half_space: DVec3,
    },
}

impl Serialize for HitboxNumbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !serializer.is_human_readable() {
            return Self::serialize(self, serializer);
        }
        let text = match self.clone() {
            Self::Spheres(spheres) => TextForm::Spheres(spheres),
            Self::HalfSpace(half_space) => TextForm::HalfSpace { half_space },
        };
        text.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for HitboxNumbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            return Self::deserialize(deserializer);
        }
        Ok(match TextForm::deserialize(deserializer)? {
            TextForm::Spheres(spheres) => Self::Spheres(spheres),
            TextForm::HalfSpace { half_space } => Self::HalfSpace(half_space),
        })
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
