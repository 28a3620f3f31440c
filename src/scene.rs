//! Scenes: bodies under ids.
//!
//! Words: [`internals`](crate::internals).

mod admission;
mod arena;
mod body;
mod body_plan;
mod entry;
mod heights;
mod ignored;
mod layer_groups;
mod model_error;
mod partners;
mod planned;
mod sample;
#[cfg(feature = "serde")]
mod serial;
mod slot;
mod told_states;
mod update;

pub(crate) use admission::PairAdmission;
pub(crate) use arena::CubicArena;
pub use body::Body;
pub(crate) use body::checked_model_error;
pub use body_plan::{BodyPlan, BodyPlanRef};
pub(crate) use entry::SceneEntry;
pub(crate) use heights::{PlaneHeights, PositionBox};
use ignored::IgnoredPairs;
use partners::Kinds;
pub(crate) use planned::planned;
pub(crate) use slot::Slot;
use slot::SlotKey;
pub(crate) use told_states::ToldStates;
pub use update::{BodyState, Spin};

use crate::bounds::DAabb;
use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::pool::Pool;
use crate::search::SearchScratch;
use crate::simd::{prefetch, prefetch_first};
use crate::trajectory::{StraightMotion, Trajectory};
use std::slice::from_ref;

/// The bodies that are screened against each other.
///
/// # Memory
///
/// A body takes about 1,000 bytes, and 230 per segment: a million bodies with plans of 8 segments
/// take 2.9 GB. Motion beyond the knots ([`Outside`](crate::Outside)) takes no memory of its own. A body at
/// rest, or one that coasts from a single state, takes its record only.
///
/// | per body | bytes |
/// |---|---|
/// | record of the body (its slot) | 192 |
/// | summary of its plan | 150 |
/// | cubics on which its plan may go on before and after its knots | 260 |
/// | room for two more segments in front, for a monitor's splices | 270 |
/// | lists | 80 |
///
/// | per segment | bytes |
/// |---|---|
/// | segment | 128 |
/// | copy in f32, for boxes | 64 |
/// | bounds of four cubics, and of four such bounds, at a time | 22 |
/// | knot, twice | 16 |
///
/// The f32 copies, bounds and copied knots are stored contiguously, in large pages if the system
/// has them. Freed storage is not reused at once. When more is free than in use, by more than 1
/// MiB, live data is moved to new memory and the rest is returned to the system. A monitor's
/// replans copy nothing. Apart from those, at most five times the bodies' need and 3 MiB are
/// written at any time. The last allocation has an unwritten end, as large as the data in use, up
/// to 32 MiB. An empty scene holds none. Slots of 192 bytes, for the largest number of bodies so
/// far, are reused and freed with the scene.
///
/// A screening adds some 190 bytes a body where more than one body in eight has a plan of several states, else 30. For
/// each thread it adds at most 64 MiB of boxes (64 bytes each, for up to 2^20 boxes, or one slice if
/// that has more). It also adds 40 to 130 bytes a box of one slice for the sweep, 8 for each of a
/// slice's candidates, and 16 for each span that is solved. Boxes, candidates and the sweep's lists are
/// reused by the next screening.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Body, Hitbox, Query, Scene, State, Trajectory};
///
/// let fly = |from: DVec3, to: DVec3| {
///     let velocity = (to - from) / 10.0;
///     Trajectory::from_states(&[State::new(0.0, from, velocity), State::new(10.0, to, velocity)])
/// };
/// let mut scene = Scene::new();
/// let hitbox = Hitbox::sphere(0.5)?;
/// let a = scene.insert(
///     Body::new(fly(DVec3::ZERO, DVec3::new(10.0, 0.0, 0.0))?).with_hitbox(hitbox.clone()),
/// )?;
/// let b = scene.insert(
///     Body::new(fly(DVec3::new(5.0, -5.0, 0.0), DVec3::new(5.0, 5.0, 0.0))?).with_hitbox(hitbox),
/// )?;
/// let conflicts = scene.screen(&Query::default())?.conflicts;
/// assert_eq!((conflicts[0].a, conflicts[0].b), (a, b));
/// assert_eq!(conflicts[0].closest.time, 5.0);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serial::SerialScene", into = "serial::SerialScene")
)]
pub struct Scene {
    slots: Vec<Slot>,
    /// The key of each slot: ids are checked without fetching bodies.
    keys: Vec<SlotKey>,
    /// The layers of the body in each slot, none of an empty one: those of pairs are compared without fetching bodies.
    layers: Vec<Layers>,
    free: Vec<u32>,
    ignored: IgnoredPairs,
    len: usize,
    /// Counts of all bodies, which tell those of them that can be part of a pair.
    kinds: Kinds,
    /// Memory of the bodies' compact trajectories.
    arena: CubicArena,
    /// Buffers of screenings; no part of the scene's value.
    pool: Pool<SearchScratch>,
    /// Memory of [`update`](Self::update); no part of the scene's value.
    told: ToldStates,
}

impl Scene {
    /// Returns an empty scene.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    pub(crate) const fn pool(&self) -> &Pool<SearchScratch> {
        &self.pool
    }

    pub(crate) const fn arena(&self) -> &CubicArena {
        &self.arena
    }

    /// Returns the number of bodies.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Returns true if there are no bodies.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Adds a body; its id stays valid until it is removed.
    ///
    /// # Errors
    ///
    /// [`Error::SceneFull`] after 2^32 - 1 bodies; [`Error::InBody`] with
    /// [`Error::TurningHalfSpace`].
    pub fn insert(&mut self, body: Body) -> Result<BodyId, Error> {
        Body::check_turning(&body.hitbox, &body.orientation, body.tag)?;
        let id = self.next_id()?;
        if self.free.pop().is_none() {
            self.slots.push(Slot::default());
            self.keys.push(SlotKey::default());
            self.layers.push(body.layers);
        }
        self.kinds.add(&body);
        let place = id.slot as usize;
        self.keys[place].is_taken = true;
        self.layers[place] = body.layers;
        self.slots[place].entry = Some(SceneEntry::new(body, &mut self.arena));
        self.len += 1;
        self.tidy();
        Ok(id)
    }

    /// Returns the id that the next body will have.
    ///
    /// # Errors
    ///
    /// [`Error::SceneFull`].
    pub(crate) fn next_id(&self) -> Result<BodyId, Error> {
        if let Some(&slot) = self.free.last() {
            let generation = self.keys[slot as usize].generation;
            return Ok(BodyId { slot, generation });
        }
        let slot = u32::try_from(self.slots.len()).ok();
        let slot = slot.filter(|&slot| slot < u32::MAX);
        Ok(BodyId {
            slot: slot.ok_or(Error::SceneFull)?,
            generation: 0,
        })
    }

    /// Removes a body. Its id, and the pairs ignored with it, become invalid for good.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub fn remove(&mut self, id: BodyId) -> Result<Body, Error> {
        let slot = self.has(id).then(|| &mut self.slots[id.slot as usize]);
        let entry = slot.and_then(|slot| slot.entry.take());
        let entry = entry.ok_or(Error::UnknownBody { id })?;
        let key = &mut self.keys[id.slot as usize];
        key.is_taken = false;
        // A slot whose generations are used up is never handed out again.
        if let Some(generation) = key.generation.checked_add(1) {
            key.generation = generation;
            self.free.push(id.slot);
        }
        self.ignored.forget(id);
        self.len -= 1;
        let body = entry.leave(&mut self.arena);
        self.kinds.remove_layers(body.layers);
        self.layers[id.slot as usize] = Layers::NONE;
        self.tidy();
        Ok(body)
    }

    /// Returns the body with this id, or `None` if it was removed.
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.entry(id).map(|entry| &entry.body)
    }

    pub(crate) fn entry(&self, id: BodyId) -> Option<&SceneEntry> {
        if !self.has(id) {
            return None;
        }
        self.slots[id.slot as usize].entry.as_ref()
    }

    /// Returns true if there is a body with this id.
    #[inline]
    pub(crate) fn has(&self, id: BodyId) -> bool {
        let key = SlotKey {
            generation: id.generation,
            is_taken: true,
        };
        self.keys.get(id.slot as usize) == Some(&key)
    }

    /// Returns all bodies, in the order of their ids' slots.
    pub fn bodies(&self) -> impl Iterator<Item = (BodyId, &Body)> {
        self.entries().map(|(id, entry)| (id, &entry.body))
    }

    /// Replaces a body's trajectory and returns the old one.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub fn set_trajectory(
        &mut self,
        id: BodyId,
        trajectory: Trajectory,
    ) -> Result<Trajectory, Error> {
        let (entry, arena) = self.entry_mut(id)?;
        let old = entry.follow(trajectory, arena);
        self.tidy();
        Ok(old)
    }

    /// Replaces a body's trajectory in place; its summary is computed when needed.
    pub(crate) fn swap_trajectory(
        &mut self,
        id: BodyId,
        trajectory: &mut Trajectory,
    ) -> Result<&SceneEntry, Error> {
        let (entry, arena) = self.entry_mut(id)?;
        // A monitor's ticks have no time to copy what is left.
        entry.swap(trajectory, arena);
        Ok(entry)
    }

    /// Replaces a body's motion: see [`Trajectory::replace`].
    pub(crate) fn replace_motion(
        &mut self,
        id: BodyId,
        (from, motion, since): (f64, &StraightMotion, f64),
    ) -> Result<&Trajectory, Error> {
        let (entry, arena) = self.entry_mut(id)?;
        Ok(entry.replace_motion((from, motion, since), arena))
    }

    /// Replaces a body's hitbox and returns the old one.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::TurningHalfSpace`].
    pub fn set_hitbox(&mut self, id: BodyId, hitbox: Hitbox) -> Result<Hitbox, Error> {
        let body = &mut self.entry_mut(id)?.0.body;
        let checked = Body::check_turning(&hitbox, &body.orientation, body.tag);
        checked.map_err(|error| error.with_id(id))?;
        let old = std::mem::replace(&mut body.hitbox, hitbox);
        self.count_shape(id);
        Ok(old)
    }

    /// Replaces a body's layers and returns the old ones.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub fn set_layers(&mut self, id: BodyId, layers: Layers) -> Result<Layers, Error> {
        let old = std::mem::replace(&mut self.entry_mut(id)?.0.body.layers, layers);
        self.layers[id.slot as usize] = layers;
        self.kinds.add_layers(layers);
        self.kinds.remove_layers(old);
        Ok(old)
    }

    /// Excludes this pair from all screenings (a tug and its tow). No effect if it already is.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`].
    pub fn ignore_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        let pair = self.pair(a, b)?;
        self.ignored.insert(pair);
        Ok(())
    }

    /// Includes this pair again. No effect if it was not ignored.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`].
    pub fn unignore_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        let pair = self.pair(a, b)?;
        self.ignored.remove(pair);
        Ok(())
    }

    /// Returns the ignored pairs, smaller id first.
    pub fn ignored_pairs(&self) -> impl Iterator<Item = (BodyId, BodyId)> {
        self.ignored.iter()
    }

    /// Checks a pair of different bodies of the scene; returns it with the smaller id first.
    pub(crate) fn pair(&self, a: BodyId, b: BodyId) -> Result<(BodyId, BodyId), Error> {
        for id in [a, b] {
            if self.body(id).is_none() {
                return Err(Error::UnknownBody { id });
            }
        }
        if a == b {
            return Err(Error::SameBody { id: a });
        }
        Ok((a.min(b), a.max(b)))
    }

    pub(crate) fn entries(&self) -> impl Iterator<Item = (BodyId, &SceneEntry)> {
        let slots = (0_u32..).zip(&self.slots).zip(&self.keys);
        slots.filter_map(|((slot, place), key)| {
            let generation = key.generation;
            let entry = place.entry.as_ref()?;
            Some((BodyId { slot, generation }, entry))
        })
    }

    /// Returns the approximate extremes of all plans of bodies that may be part of a pair, m.
    pub(crate) fn extremes(&self) -> DAabb {
        let mut extremes = DAabb::NOTHING;
        let partners = self.partners(0.0);
        for (_, entry) in self.entries() {
            if partners.has(&entry.body) {
                extremes.include(entry.extremes());
            }
        }
        extremes
    }

    /// Prefetches a body, without its segments.
    pub(crate) fn prefetch(&self, slot: u32) {
        if let Some(slot) = self.slots.get(slot as usize) {
            prefetch(from_ref(slot));
        }
    }

    /// Prefetches the first cache line of a body: its motion begins there.
    pub(crate) fn prefetch_first(&self, slot: u32) {
        if let Some(slot) = self.slots.get(slot as usize) {
            prefetch_first(slot);
        }
    }

    /// Returns all slots.
    pub(crate) fn slots_mut(&mut self) -> &mut [Slot] {
        &mut self.slots
    }

    /// Returns the number of slots, free ones included.
    pub(crate) fn slots(&self) -> usize {
        self.slots.len()
    }

    /// Returns the body in a slot, if there is one.
    pub(crate) fn in_slot(&self, slot: u32) -> Option<(BodyId, &SceneEntry)> {
        let entry = self.slots.get(slot as usize)?.entry.as_ref()?;
        let generation = self.keys[slot as usize].generation;
        Some((BodyId { slot, generation }, entry))
    }

    /// Moves all compact trajectories to new memory, if most of the old one is garbage.
    fn tidy(&mut self) {
        if !self.arena.is_mostly_garbage() {
            return;
        }
        let old = std::mem::take(&mut self.arena);
        for slot in &mut self.slots {
            if let Some(entry) = &mut slot.entry {
                entry.move_compact(&old, &mut self.arena);
            }
        }
    }

    /// Returns a body's entry and the arena of its compact trajectory.
    fn entry_mut(&mut self, id: BodyId) -> Result<(&mut SceneEntry, &mut CubicArena), Error> {
        let slot = self.has(id).then(|| &mut self.slots[id.slot as usize]);
        let entry = slot.and_then(|slot| slot.entry.as_mut());
        Ok((entry.ok_or(Error::UnknownBody { id })?, &mut self.arena))
    }
}

impl Clone for Scene {
    fn clone(&self) -> Self {
        let mut arena = CubicArena::default();
        let slots = self.slots.iter().map(|slot| {
            let entry = slot.entry.as_ref();
            Slot {
                entry: entry.map(|entry| entry.copy(&self.arena, &mut arena)),
            }
        });
        Self {
            slots: slots.collect(),
            keys: self.keys.clone(),
            layers: self.layers.clone(),
            free: self.free.clone(),
            ignored: self.ignored.clone(),
            len: self.len,
            kinds: self.kinds.clone(),
            arena,
            pool: self.pool.clone(),
            told: ToldStates::default(),
        }
    }
}
