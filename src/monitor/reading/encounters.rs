//! The planned encounters of one alert level, as far as they may have changed.
//!
//! Most are the same from tick to tick, and no event can follow from them.

use super::{WindowEdges, WindowSide};
use crate::monitor::encounters::PlannedEncounter;
use crate::monitor::solved_conflict::SolvedConflict;
use crate::monitor::solved_spans::SlotPair;
use crate::monitor::sorted_slab::{IndexEntry, SortedSlab};

/// The planned encounters of all pairs at one alert level, and a list of those that may have changed.
#[derive(Debug, Default)]
pub(in crate::monitor) struct EncounterCache {
    /// All encounters, whatever the window.
    all: SortedSlab<SlotPair, PlannedEncounter>,
    /// Pairs that were dropped, or added, since the last listing.
    touched: Vec<SlotPair>,
    /// Encounters of the listed pairs in the window.
    listed: Vec<PlannedEncounter>,
    /// The pairs, and where the list of each ends.
    pairs: Vec<(SlotPair, usize)>,
    /// Edges of the last listing's window; none if all are to be listed.
    before: Option<WindowEdges>,
}

impl EncounterCache {
    /// Drops the encounters of some pairs (sorted), and those that have ended before an instant (s).
    pub(in crate::monitor) fn drop_changed(&mut self, changed: &[SlotPair], before: f64) {
        let (mut changed, touched) = (changed.iter().peekable(), &mut self.touched);
        self.all.retain(|entry, _| {
            while changed.next_if(|slots| **slots < entry.key).is_some() {}
            let keeps = entry.interval.1 >= before && changed.peek() != Some(&&entry.key);
            if !keeps {
                touched.push(entry.key);
            }
            keeps
        });
    }

    /// Adds the planned encounters of a pair; pairs come in order.
    pub(in crate::monitor) fn add(&mut self, slots: SlotPair, planned: PlannedEncounter) {
        self.touched.push(slots);
        let conflict = &planned.solved.conflict;
        let interval = (conflict.enter, conflict.exit);
        self.all.add(slots, interval, planned);
    }

    /// Returns the pairs of the encounters that last at an instant (s).
    pub(in crate::monitor) fn lasting_at(&self, time: f64) -> impl Iterator<Item = SlotPair> {
        let entries = self.all.entries().iter();
        let lasting =
            entries.filter(move |entry| entry.interval.0 <= time && time <= entry.interval.1);
        lasting.map(|entry| entry.key)
    }

    /// Sorts the added encounters in.
    pub(in crate::monitor) fn merge_added(&mut self) {
        /// So many are not too many, whatever there is.
        const FEW: usize = 1024;
        self.all.merge_added();
        // `touched` grows as long as nothing is listed: while nothing is known beyond the reported time.
        let most = FEW + 2 * self.all.entries().len();
        if self.lists_all() || self.touched.len() > most {
            self.list_all();
        }
    }

    /// Notes that all are to be listed next, whether they have changed or not, and pairs that are gone too.
    pub(in crate::monitor) fn list_all(&mut self) {
        self.before = None;
        self.touched.clear();
    }

    /// Returns true if all are listed next.
    pub(in crate::monitor) const fn lists_all(&self) -> bool {
        self.before.is_none()
    }

    /// Lists each pair whose encounters in the window may differ from those when it was listed last:
    ///
    /// - encounters were added or dropped (not if [all are listed](Self::lists_all));
    /// - an encounter is at an edge of the window, or has passed one; but not one at both edges of this window and of the
    ///   last one, of bodies that rest;
    /// - the pair is one of `wait`.
    ///
    /// `clipped` returns what the window has of a pair's encounter at its edge.
    pub(in crate::monitor) fn list(
        &mut self,
        edges: WindowEdges,
        wait: &[SlotPair],
        mut clipped: impl FnMut(SlotPair, &PlannedEncounter) -> Option<PlannedEncounter>,
    ) {
        let Self {
            all,
            touched,
            listed,
            pairs,
            before,
        } = self;
        listed.clear();
        pairs.clear();
        touched.extend_from_slice(wait);
        touched.sort_unstable();
        touched.dedup();
        let mut touched = touched.drain(..).peekable();
        let before = before.replace(edges);
        for entries in all.entries().chunk_by(|x, y| x.key == y.key) {
            let slots = entries[0].key;
            while let Some(gone) = touched.next_if(|other| *other < slots) {
                pairs.push((gone, listed.len()));
            }
            let is_touched = touched.next_if_eq(&slots).is_some();
            let may_differ = |entry: &IndexEntry<SlotPair>| {
                let side = edges.side_of(entry.interval);
                let was = before.map(|before| before.side_of(entry.interval));
                let stays =
                    || before.is_some_and(|before| stays(all.at(entry.place), before, edges));
                side == WindowSide::AtEdge && !stays() || was != Some(side)
            };
            if !is_touched && !entries.iter().any(may_differ) {
                continue;
            }
            for entry in entries {
                match edges.side_of(entry.interval) {
                    WindowSide::Within => listed.push(*all.at(entry.place)),
                    WindowSide::Beyond => {}
                    WindowSide::AtEdge => listed.extend(clipped(slots, all.at(entry.place))),
                }
            }
            pairs.push((slots, listed.len()));
        }
        pairs.extend(touched.map(|gone| (gone, listed.len())));
    }

    /// Returns the listed pairs, sorted, each with all its planned encounters in the window, sorted by time.
    pub(in crate::monitor) fn listed(
        &self,
    ) -> impl Iterator<Item = (SlotPair, impl Iterator<Item = &PlannedEncounter>)> {
        let mut first = 0;
        self.pairs.iter().map(move |&(slots, end)| {
            let start = std::mem::replace(&mut first, end);
            (slots, self.listed[start..end].iter())
        })
    }
}

/// Returns true if a tick sees of an encounter what the tick before saw, but for the end of the known time: it began before
/// the windows of both and ends after them, and neither body has moved meanwhile.
fn stays(planned: &PlannedEncounter, before: WindowEdges, now: WindowEdges) -> bool {
    let SolvedConflict {
        conflict,
        rests_from,
        ..
    } = &planned.solved;
    let end = before.around.1.max(now.around.1);
    conflict.enter.max(*rests_from) <= before.around.0 && conflict.exit > end
}
