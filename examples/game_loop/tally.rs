//! Encounters, counted twice: from the monitor's events, and from the bodies' plain positions.

use crate::fleet::{Fleet, RADIUS};
use glam::DVec3;
use nearmiss::{BodyId, EncounterId, Error, Event, EventKind};
use std::collections::BTreeSet;

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
    /// Places of bodies, in the order of x.
    places: Vec<(BodyId, DVec3)>,
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
    pub(crate) fn check(&mut self, fleet: &Fleet) -> Result<(), Error> {
        let now = fleet.monitor.now();
        let known: BTreeSet<(BodyId, BodyId)> = fleet
            .monitor
            .conflicts(fleet.setting.contact)?
            .iter()
            .filter(|conflict| conflict.enter <= now)
            .map(|conflict| (conflict.a, conflict.b))
            .collect();
        self.places.clear();
        let places = fleet.bodies.iter();
        self.places
            .extend(places.filter_map(|&id| Some((id, fleet.state(id)?.position))));
        self.places
            .sort_unstable_by(|(_, one), (_, other)| one.x.total_cmp(&other.x));
        // Overlaps shallower than rounding may be told either way.
        let reach = 2.0 * RADIUS * (1.0 - 1e-9);
        for (index, &(id, position)) in self.places.iter().enumerate() {
            let rest = self.places[index + 1..].iter();
            for &(other, place) in rest.take_while(|(_, place)| place.x - position.x < reach) {
                let pair = (id.min(other), id.max(other));
                if position.distance(place) < reach && !known.contains(&pair) {
                    self.lost += 1;
                }
            }
        }
        Ok(())
    }

    /// After the monitor is closed nothing may be under way.
    pub(crate) fn finish(&mut self) {
        self.lost += self.under_way.len() as u64;
    }
}
