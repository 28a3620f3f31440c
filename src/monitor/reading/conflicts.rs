//! The conflicts of one alert level.

use super::{CacheSlot, WindowEdges, WindowSide};
use crate::conflict::Conflict;
use crate::monitor::solved_spans::SlotPair;
use crate::monitor::sorted_slab::SortedSlab;
use crate::monitor::time_key::TimeKey;

/// The conflicts of one alert level.
#[derive(Debug, Default)]
pub(in crate::monitor) struct ConflictCache {
    /// Conflicts whatever the window, by their beginning and their pair: the order of reports.
    always: SortedSlab<TimeKey<SlotPair>, Conflict>,
    /// Conflicts at an edge of the window, as this tick sees them.
    at_edge: Vec<Conflict>,
    /// Places of all conflicts of the window, in the order of reports.
    listed: Vec<CacheSlot>,
}

impl ConflictCache {
    /// Drops those of some pairs (sorted), and those that have ended before an instant.
    pub(in crate::monitor) fn drop_changed(&mut self, changed: &[SlotPair], before: f64) {
        self.always.retain(|entry, _| {
            entry.interval.1 >= before && changed.binary_search(&entry.key.what).is_err()
        });
    }

    /// Adds a conflict of a pair that has none yet, or only earlier ones.
    pub(in crate::monitor) fn add(&mut self, slots: SlotPair, conflict: Conflict) {
        let enter = conflict.enter;
        let interval = (enter, conflict.exit);
        self.always.add(
            TimeKey {
                time: enter,
                what: slots,
            },
            interval,
            conflict,
        );
    }

    /// Puts all added conflicts in their places.
    pub(in crate::monitor) fn settle(&mut self) {
        self.always.settle();
    }

    /// Lists all conflicts of a window, in the order of reports. `again` reads the part in the window of a
    /// conflict at its edge, given the pair and the interval in which it lasts whatever the window (s).
    pub(in crate::monitor) fn list(
        &mut self,
        window: (f64, f64),
        mut again: impl FnMut(SlotPair, (f64, f64), &mut Vec<Conflict>),
    ) -> impl Iterator<Item = &Conflict> {
        let Self {
            always,
            at_edge,
            listed,
        } = self;
        at_edge.clear();
        listed.clear();
        let edges = WindowEdges {
            within: window,
            around: window,
        };
        let mut begun = 0;
        for entry in always.entries() {
            match edges.place(entry.interval) {
                WindowSide::Within => listed.push(CacheSlot::Always(entry.place)),
                WindowSide::Beyond => {}
                WindowSide::AtEdge => {
                    let first = at_edge.len();
                    again(entry.key.what, entry.interval, at_edge);
                    listed.extend((first..at_edge.len()).map(CacheSlot::AtEdge));
                    if entry.key.time <= window.0 {
                        begun = at_edge.len();
                    }
                }
            }
        }
        // All that had begun now begin with the window; the others begin as ever.
        at_edge[..begun].sort_unstable_by(Conflict::order);
        let (always, at_edge) = (&*always, &*at_edge);
        listed.iter().map(|origin| match *origin {
            CacheSlot::Always(place) => always.at(place),
            CacheSlot::AtEdge(number) => &at_edge[number],
        })
    }
}
