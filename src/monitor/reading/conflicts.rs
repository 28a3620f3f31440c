//! The conflicts of one alert level.

use super::{WindowEdges, WindowSide};
use crate::conflict::Conflict;
use crate::monitor::solved_conflict::SolvedConflict;
use crate::monitor::solved_spans::SlotPair;
use crate::monitor::sorted_slab::SortedSlab;
use crate::rounding::total_order;

/// The conflicts of all pairs at one alert level, whatever the window.
#[derive(Debug, Default)]
pub(in crate::monitor) struct ConflictCache {
    /// Sorted by the time at which a conflict begins, and by pair: the order of reports.
    all: SortedSlab<(i64, SlotPair), SolvedConflict>,
}

impl ConflictCache {
    /// Drops the conflicts of some pairs (sorted), and those that have ended before an instant (s).
    pub(in crate::monitor) fn drop_changed(&mut self, changed: &[SlotPair], before: f64) {
        self.all.retain(|entry, _| {
            entry.interval.1 >= before && changed.binary_search(&entry.key.1).is_err()
        });
    }

    /// Adds a conflict of a pair that has none, or only earlier ones.
    pub(in crate::monitor) fn add(&mut self, slots: SlotPair, solved: SolvedConflict) {
        let conflict = &solved.conflict;
        let interval = (conflict.enter, conflict.exit);
        let key = (total_order(conflict.enter), slots);
        self.all.add(key, interval, solved);
    }

    /// Returns the pairs of the conflicts that last at an instant (s).
    pub(in crate::monitor) fn lasting_at(&self, time: f64) -> impl Iterator<Item = SlotPair> {
        let entries = self.all.entries().iter();
        let lasting =
            entries.filter(move |entry| entry.interval.0 <= time && time <= entry.interval.1);
        lasting.map(|entry| entry.key.1)
    }

    /// Sorts the added conflicts in.
    pub(in crate::monitor) fn merge_added(&mut self) {
        self.all.merge_added();
    }

    /// Puts all conflicts of a window into `listed`, in the order of reports. `clipped` returns what the
    /// window has of a pair's conflict at its edge.
    pub(in crate::monitor) fn list(
        &self,
        window: (f64, f64),
        mut clipped: impl FnMut(SlotPair, &SolvedConflict) -> Option<Conflict>,
        listed: &mut Vec<Conflict>,
    ) {
        listed.clear();
        let edges = WindowEdges {
            within: window,
            around: window,
        };
        let mut begun = 0;
        for entry in self.all.entries() {
            match edges.side_of(entry.interval) {
                WindowSide::Within => listed.push(self.all.at(entry.place).conflict),
                WindowSide::Beyond => {}
                WindowSide::AtEdge => {
                    listed.extend(clipped(entry.key.1, self.all.at(entry.place)));
                    if entry.interval.0 <= window.0 {
                        begun = listed.len();
                    }
                }
            }
        }
        // Conflicts that had begun before the window begin with it, clipped; all others are in order.
        listed[..begun].sort_unstable_by(Conflict::order);
    }
}
