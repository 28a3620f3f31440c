//! Contacts of spheres that are seen at sampled instants, against what events had told before.

use crate::fleet::Fleet;
use glam::DVec3;
use nearmiss::{Body, BodyId, Encounter, EncounterId, Event, EventKind, Sphere};
use std::collections::{BTreeMap, BTreeSet};

/// Instants of a tick at which spheres are looked at.
const SAMPLES: u32 = 4;
/// Overlaps shallower than rounding may be told either way, m.
const ROUNDING: f64 = 1e-9;
/// Changes of a predicted instant that are not told, with room, s.
const REVISION: f64 = 1e-6;

/// The contacts that were told, and those that were seen without having been told.
#[derive(Debug, Default)]
pub(crate) struct Truth {
    /// Contacts that were told while they lay ahead, and lie ahead or are under way.
    told: BTreeMap<EncounterId, Encounter>,
    /// Contacts that ended in the last tick.
    ended: Vec<Encounter>,
    /// Pairs in contact at the last instant, and those of them that were not told.
    touching: BTreeSet<(BodyId, BodyId)>,
    missed: BTreeSet<(BodyId, BodyId)>,
    /// Contacts seen that no event had predicted.
    pub(crate) unpredicted: u64,
    /// Contacts seen with the floor, predicted or not.
    pub(crate) grounded: u64,
}

impl Truth {
    /// Reads the events of a tick.
    pub(crate) fn read(&mut self, contact: usize, events: &[Event]) {
        self.ended.clear();
        for event in events {
            let Some(encounter) = event.kind.encounter() else {
                continue;
            };
            if encounter.level != contact {
                continue;
            }
            match event.kind {
                EventKind::Withdrawn(_) => {
                    self.told.remove(&encounter.id);
                }
                EventKind::Ended(..) => {
                    if self.told.remove(&encounter.id).is_some() {
                        self.ended.push(*encounter);
                    }
                }
                EventKind::Predicted(_) => {
                    self.told.insert(encounter.id, *encounter);
                }
                // One that is first told when it has begun was not predicted.
                _ => {
                    if let Some(told) = self.told.get_mut(&encounter.id) {
                        *told = *encounter;
                    }
                }
            }
        }
    }

    /// Looks at all spheres within a tick, from `start` to `end` (s): plans are known that far back.
    pub(crate) fn look(&mut self, fleet: &Fleet, (start, end): (f64, f64)) {
        for sample in 1..=SAMPLES {
            let time = start + (end - start) * f64::from(sample) / f64::from(SAMPLES);
            let told: BTreeSet<_> = self
                .told
                .values()
                .chain(&self.ended)
                .filter(|told| told.enter - REVISION <= time)
                .filter(|told| told.open || time <= told.exit + REVISION)
                .map(|told| (told.a, told.b))
                .collect();
            let touching = contacts(fleet, time);
            let missed: BTreeSet<_> = touching.difference(&told).copied().collect();
            self.unpredicted += missed.difference(&self.missed).count() as u64;
            self.missed = missed;
            let begun = touching.difference(&self.touching);
            let grounded = begun.filter(|(a, b)| fleet.is_floor(*a) || fleet.is_floor(*b));
            self.grounded += grounded.count() as u64;
            self.touching = touching;
        }
    }
}

/// One body at an instant.
struct Sample<'f> {
    id: BodyId,
    body: &'f Body,
    position: DVec3,
    /// Largest distance of its spheres' surfaces from its position, m.
    reach: f64,
}

/// All pairs of bodies with spheres that overlap, by their positions and rotations alone; and all bodies with
/// spheres that reach into the floor.
fn contacts(fleet: &Fleet, time: f64) -> BTreeSet<(BodyId, BodyId)> {
    let scene = fleet.monitor.scene();
    let ids = fleet.bodies.iter();
    let mut samples: Vec<Sample<'_>> = ids
        .filter_map(|&id| {
            let body = scene.body(id)?;
            let reach = |sphere: &Sphere| sphere.offset.length() + sphere.radius;
            Some(Sample {
                id,
                body,
                position: body.trajectory.position(time)?,
                reach: body.hitbox.spheres().iter().map(reach).fold(0.0, f64::max),
            })
        })
        .collect();
    samples.sort_unstable_by(|a, b| a.position.x.total_cmp(&b.position.x));
    let widest = samples
        .iter()
        .map(|sample| sample.reach)
        .fold(0.0, f64::max);
    let mut touching = BTreeSet::new();
    if let Some(floor) = fleet.floor {
        let reaches_it = |sample: &&Sample<'_>| {
            let is_near = sample.position.y - sample.reach <= floor.height;
            is_near && reaches_below(sample.body, floor.height, time)
        };
        let low = samples.iter().filter(reaches_it).map(|sample| sample.id);
        touching.extend(low.map(|id| (id.min(floor.id), id.max(floor.id))));
    }
    for (index, one) in samples.iter().enumerate() {
        let limit = one.position.x + one.reach + widest;
        let rest = samples[index + 1..].iter();
        for other in rest.take_while(|other| other.position.x <= limit) {
            let is_near = one.position.distance(other.position) <= one.reach + other.reach;
            if is_near && overlap(one.body, other.body, time) {
                touching.insert((one.id.min(other.id), one.id.max(other.id)));
            }
        }
    }
    touching
}

fn reaches_below(body: &Body, height: f64, time: f64) -> bool {
    let spheres = body.spheres_at(time).unwrap_or_default();
    let low = |sphere: &Sphere| sphere.offset.y - sphere.radius;
    spheres.iter().any(|sphere| low(sphere) + ROUNDING < height)
}

fn overlap(a: &Body, b: &Body, time: f64) -> bool {
    let spheres = |body: &Body| body.spheres_at(time).unwrap_or_default();
    let others = spheres(b);
    spheres(a).iter().any(|one| {
        others.iter().any(|other| {
            let reach = one.radius + other.radius - ROUNDING;
            one.offset.distance(other.offset) < reach
        })
    })
}
