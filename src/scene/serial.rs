//! Serialised scenes: bodies with their slots, so that ids stay valid.

use super::{Body, Scene, SceneEntry, Slot, SlotKey};
use crate::error::Error;
use crate::id::BodyId;
use crate::layers::Layers;
use serde::{Deserialize, Serialize};

/// The serialised fields of a scene.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SerialScene {
    /// Generation and body of each slot.
    slots: Vec<(u32, Option<Body>)>,
    /// Empty slots; the last one is used next.
    free: Vec<u32>,
    ignored: Vec<(BodyId, BodyId)>,
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
}
