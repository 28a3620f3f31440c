//! The conflicts of one alert level.

use super::{CacheSlot, WindowEdges, WindowSide};
use crate::conflict::Conflict;
use crate::monitor::solved_spans::SlotPair;
use crate::monitor::sorted_slab::SortedSlab;
use crate::monitor::time_key::TimeKey;

/// See the module.
#[derive(Debug, Default)]
pub(in crate::monitor) struct ConflictCache {
    /// Whatever the window, by when a conflict begins, and whose it is: the order of reports.
    always: SortedSlab<TimeKey<SlotPair>, Conflict>,
    /// Conflicts at an edge of the window, as this tick sees them.
    at_edge: Vec<Conflict>,
    /// All of the window, in the order of reports.
    listed: Vec<CacheSlot>,
}

impl ConflictCache {
    /// Drops those of some pairs (sorted), and those that have ended before an instant.
    pub(in crate::monitor) fn drop_changed(&mut self, changed: &[SlotPair], before: f64) {
        self.always.retain(|entry, _| {
            entry.interval.1 >= before && changed.binary_search(&entry.key.what).is_err()
        });
    }

    /// Adds one of a pair of which there is none, or one that is earlier.
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

    /// All were added.
    pub(in crate::monitor) fn settle(&mut self) {
        self.always.settle();
    }

    /// All of a window, in the order of reports. `again` reads what the window has of one that is
    /// at its edge, given the pair and when it lasts (s) whatever the window.
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
