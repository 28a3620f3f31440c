//! What happened, counted twice: from the monitor's events, and from the bodies' plain positions.

use crate::fleet::{Fleet, RADIUS};
use glam::{DVec3, IVec3};
use nearmiss::{BodyId, EncounterId, Event, EventKind};
use std::collections::{BTreeMap, BTreeSet};

/// Counters of a run.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) predicted: u64,
    pub(crate) revised: u64,
    pub(crate) withdrawn: u64,
    pub(crate) began: u64,
    pub(crate) ended: u64,
    /// Contacts that began.
    pub(crate) collisions: u64,
    /// Overlaps and ends that the monitor should have told and did not.
    pub(crate) lost: u64,
    under_way: BTreeSet<EncounterId>,
    grid: BTreeMap<[i32; 3], Vec<(BodyId, DVec3)>>,
}

impl Tally {
    /// Counts the events of a tick.
    pub(crate) fn read(&mut self, contact: usize, events: &[Event]) {
        for event in events {
            match event.kind {
                EventKind::Predicted(_) => self.predicted += 1,
                EventKind::Revised(_) => self.revised += 1,
                EventKind::Withdrawn(_) => self.withdrawn += 1,
                EventKind::Began(encounter) => {
                    self.began += 1;
                    self.collisions += u64::from(encounter.level == contact);
                    self.under_way.insert(encounter.id);
                }
                EventKind::Ended(encounter, _) => {
                    self.ended += 1;
                    self.lost += u64::from(!self.under_way.remove(&encounter.id));
                }
                _ => {}
            }
        }
    }

    /// Every pair that overlaps at this moment must be known as a contact under way.
    pub(crate) fn check(&mut self, fleet: &Fleet) {
        let now = fleet.monitor.now();
        let known: BTreeSet<(BodyId, BodyId)> = fleet
            .monitor
            .conflicts(fleet.setting.contact)
            .iter()
            .filter(|conflict| conflict.enter <= now)
            .map(|conflict| (conflict.a, conflict.b))
            .collect();
        self.grid.values_mut().for_each(Vec::clear);
        for &id in &fleet.bodies {
            if let Some(state) = fleet.state(id) {
                let cell = cell(state.position);
                self.grid
                    .entry(cell)
                    .or_default()
                    .push((id, state.position));
            }
        }
        self.grid.retain(|_, bodies| !bodies.is_empty());
        // Overlaps shallower than rounding may be told either way.
        let reach = 2.0 * RADIUS * (1.0 - 1e-9);
        for (cell, bodies) in &self.grid {
            for (index, &(id, position)) in bodies.iter().enumerate() {
                let rest = bodies[index + 1..].iter();
                let beyond = forward_neighbours(*cell).filter_map(|cell| self.grid.get(&cell));
                for &(other, place) in rest.chain(beyond.flatten()) {
                    let pair = (id.min(other), id.max(other));
                    if position.distance(place) < reach && !known.contains(&pair) {
                        self.lost += 1;
                    }
                }
            }
        }
    }

    /// After the monitor is closed nothing may be under way.
    pub(crate) fn finish(&mut self) {
        self.lost += self.under_way.len() as u64;
    }
}

/// Cells as wide as two bodies that touch.
fn cell(position: DVec3) -> [i32; 3] {
    let place: IVec3 = (position / (2.0 * RADIUS)).floor().as_ivec3();
    place.to_array()
}

/// Half of the cells around one, so that each pair of cells is looked at once.
fn forward_neighbours([x, y, z]: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    let around =
        (-1..=1).flat_map(|dx| (-1..=1).flat_map(move |dy| (-1..=1).map(move |dz| [dx, dy, dz])));
    around
        .filter(|step| *step > [0, 0, 0])
        .map(move |[dx, dy, dz]| [x + dx, y + dy, z + dz])
}
