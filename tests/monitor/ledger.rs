//! The encounters of a monitor, followed through its events.

use nearmiss::{Encounter, EncounterId, EndReason, Event, EventKind, Monitor};
use std::collections::BTreeMap;

/// Follows every encounter through its events.
#[derive(Default)]
pub(crate) struct Ledger {
    pub(crate) open: BTreeMap<EncounterId, bool>,
    pub(crate) closed: BTreeMap<EncounterId, EndReason>,
    /// Those that are not closed, as their last events had them.
    told: BTreeMap<EncounterId, Encounter>,
}

impl Ledger {
    pub(crate) fn read(&mut self, events: &[Event]) {
        for event in events {
            if let Some(encounter) = event.kind.encounter() {
                self.told.insert(encounter.id, *encounter);
            }
            match event.kind {
                EventKind::Predicted(encounter) => {
                    assert!(self.open.insert(encounter.id, false).is_none());
                }
                EventKind::Revised(encounter) => assert!(self.open.contains_key(&encounter.id)),
                EventKind::Withdrawn(encounter) => {
                    assert_eq!(self.open.remove(&encounter.id), Some(false), "{event:?}");
                }
                EventKind::Began(encounter) => {
                    assert_ne!(
                        self.open.insert(encounter.id, true),
                        Some(true),
                        "{event:?}"
                    );
                    assert_eq!(event.time, encounter.enter);
                }
                EventKind::Ended(encounter, reason) => {
                    assert_eq!(self.open.remove(&encounter.id), Some(true), "{event:?}");
                    assert!(self.closed.insert(encounter.id, reason).is_none());
                    assert!(encounter.enter <= encounter.exit);
                }
                _ => {}
            }
        }
        self.told.retain(|id, _| self.open.contains_key(id));
    }

    /// An exit that is known was told.
    pub(crate) fn knows_exits_of(&self, monitor: &Monitor) {
        for one in monitor.encounters().filter(|one| !one.open) {
            let told = &self.told[&one.id];
            assert_eq!((told.open, told.exit), (false, one.exit));
        }
    }
}
