//! Serialised scenes: bodies with their slots, so that ids stay valid.

use super::{Body, Scene, SceneEntry, Slot, SlotKey};
use crate::error::Error;
use crate::id::BodyId;
use crate::layers::Layers;
use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// The serialised fields of a scene.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SerialScene {
    /// All slots, in order.
    #[serde(deserialize_with = "read_slots")]
    slots: Vec<SerialSlot>,
    /// Empty slots; the last one is used next.
    free: Vec<u32>,
    ignored: Vec<(BodyId, BodyId)>,
}

/// Generation and body of a slot.
type SerialSlot = (u32, Option<Body>);

/// Reads the slots of a scene. An error names the slot, since that of a plan names a knot alone.
fn read_slots<'de, D: Deserializer<'de>>(source: D) -> Result<Vec<SerialSlot>, D::Error> {
    struct Slots;

    impl<'de> Visitor<'de> for Slots {
        type Value = Vec<SerialSlot>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a list of slots")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
            let mut slots = Vec::new();
            loop {
                let next = list.next_element();
                let named = next.map_err(|error| {
                    A::Error::custom(format_args!("slot {}: {error}", slots.len()))
                });
                match named? {
                    Some(slot) => slots.push(slot),
                    None => return Ok(slots),
                }
            }
        }
    }

    source.deserialize_seq(Slots)
}

impl From<Scene> for SerialScene {
    fn from(scene: Scene) -> Self {
        let slots = scene.keys.iter().zip(scene.slots);
        let body = |slot: Slot| slot.entry.map(|entry| entry.body);
        Self {
            ignored: scene.ignored.iter().collect(),
            slots: slots
                .map(|(key, slot)| (key.generation, body(slot)))
                .collect(),
            free: scene.free,
        }
    }
}

impl TryFrom<SerialScene> for Scene {
    type Error = Box<dyn std::error::Error>;

    fn try_from(parts: SerialScene) -> Result<Self, Self::Error> {
        if u32::try_from(parts.slots.len()).is_err() {
            return Err(Error::SceneFull.into());
        }
        let mut scene = Self::default();
        for (generation, body) in parts.slots {
            if let Some(body) = &body {
                Body::check_turning(&body.hitbox, &body.orientation, body.tag)?;
            }
            scene.len += usize::from(body.is_some());
            body.iter().for_each(|body| scene.kinds.add(body));
            scene.keys.push(SlotKey {
                generation,
                is_taken: body.is_some(),
            });
            let layers = body.as_ref().map(|body| body.layers);
            scene.layers.push(layers.unwrap_or(Layers::NONE));
            scene.slots.push(Slot {
                entry: body.map(|body| SceneEntry::new(body, &mut scene.arena)),
            });
        }
        // Each free slot is one that is empty, once.
        let mut is_free = vec![false; scene.slots.len()];
        for &slot in &parts.free {
            let place = slot as usize;
            let is_empty = |slot: &Slot| slot.entry.is_none();
            let taken = is_free
                .get_mut(place)
                .is_none_or(|free| std::mem::replace(free, true));
            if taken || !scene.slots.get(place).is_some_and(is_empty) {
                return Err(format!("slot {slot} is not free, or listed as free twice").into());
            }
        }
        scene.free = parts.free;
        for (a, b) in parts.ignored {
            scene.ignore_pair(a, b)?;
        }
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slot is named, and no body, which may be in the scene.
    #[test]
    fn slots_that_are_not_free_are_named() {
        for (slots, free) in [("", "3"), ("[1,null]", "0,0")] {
            let file = format!(r#"{{"slots":[{slots}],"free":[{free}],"ignored":[]}}"#);
            let refused = serde_json::from_str::<Scene>(&file).map(drop).err();
            let refused = refused.map(|error| error.to_string()).unwrap_or_default();
            let slot = format!("slot {} is not free", &free[..1]);
            assert!(refused.starts_with(&slot), "{refused}");
        }
    }

    /// A damaged plan is named by its slot, and within it by the knot and the value.
    #[test]
    fn slots_of_damaged_bodies_are_named() {
        use crate::{State, Trajectory};
        use glam::DVec3;

        let mut scene = Scene::new();
        for start in [0.0, 1.0, 2.0] {
            let states = [start, start + 5.0].map(|t| State::new(t, DVec3::ZERO, DVec3::X));
            let plan = Trajectory::from_states(&states);
            plan.and_then(|plan| scene.insert(plan.into()))
                .map(drop)
                .unwrap_or_default();
        }
        let text = serde_json::to_string(&scene).unwrap_or_default();
        let damaged = text.replace("7.0", "1.5");
        assert_ne!(damaged, text);
        let refused = serde_json::from_str::<Scene>(&damaged).map(drop).err();
        let refused = refused.map(|error| error.to_string()).unwrap_or_default();
        assert!(
            refused.starts_with("slot 2: ") && refused.contains("1.5"),
            "{refused}"
        );
    }
}
