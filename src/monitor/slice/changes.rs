//! Bodies that changed since a slice was compared.

use super::state::LimitedAdmission;
use super::{BoxIndex, BuildStage, LookaheadSlice, SliceScratch, SliceTask};
use crate::broad_phase::BodyBox;
use crate::monitor::bodies::{BodyTable, ChangedBounds};

impl LookaheadSlice {
    /// Notes that bodies have changed; each slot once.
    pub(in crate::monitor) fn note(&mut self, slots: &[u32]) {
        let boxed = match self.stage {
            BuildStage::Listing(slots) | BuildStage::Placing(slots) => slots,
            BuildStage::Compared(_) | BuildStage::Joining(..) | BuildStage::Built => usize::MAX,
        };
        for &slot in slots {
            if (slot as usize) < boxed {
                self.changed.insert(slot);
            }
        }
    }

    /// Compares changed bodies with all.
    pub(super) fn compare_changed(
        &mut self,
        task: &SliceTask<'_>,
        filter: &LimitedAdmission<'_>,
        scratch: &mut SliceScratch,
    ) -> usize {
        let changed = self.changed.slots().len();
        self.box_changed(task.bodies, task.moved, scratch);
        self.index.boxes.move_to(&scratch.listed);
        self.index.list_places(&mut scratch.listed);
        let all_changed = std::mem::take(&mut self.changed);
        // Of two changed bodies, the one in the higher slot finds the other one.
        self.list_meeting(filter, scratch, |moved, other| {
            other < moved || other > moved && !all_changed.has(other)
        });
        self.changed = all_changed;
        self.end_at(self.stage, filter);
        changed
    }

    /// Lists the boxes of the changed bodies; takes out those that have none any more.
    pub(super) fn box_changed(
        &mut self,
        bodies: &BodyTable<'_>,
        moved: Option<(&ChangedBounds, usize)>,
        scratch: &mut SliceScratch,
    ) {
        let listed = &mut scratch.listed;
        listed.clear();
        match moved {
            Some((moved, number)) if moved.are(self.changed.slots()) => {
                let fat_lines = &mut self.index.fat_lines;
                fat_lines.resize(bodies.monitored.len(), BoxIndex::NO_FAT_LINE);
                for (boxed, fat_line) in moved.of(number) {
                    fat_lines[boxed.body as usize] = *fat_line;
                    listed.push(*boxed);
                }
            }
            _ => {
                let changed = self.changed.slots().iter().copied();
                self.index
                    .list_boxes(bodies, changed, self.interval, listed);
            }
        }
        self.index.note_places(bodies, listed, self.interval);
        self.stats.boxes += listed.len() as u64;
        // In the order of `changed`, but for those that are missing.
        let mut boxed = listed.iter().map(|boxed| boxed.body).peekable();
        for &slot in self.changed.slots() {
            if boxed.next_if_eq(&slot).is_none() {
                self.index.boxes.remove(slot);
            }
        }
    }
}

impl BoxIndex {
    /// Notes the places of bodies with new boxes that teleport in an interval (s).
    fn note_places(&mut self, bodies: &BodyTable<'_>, boxed: &[BodyBox], interval: (f64, f64)) {
        /// Bodies that tell how large others are.
        const SAMPLED: usize = 8;
        let lines = &self.fat_lines;
        let sample = lines.iter().step_by(lines.len().div_ceil(SAMPLED).max(1));
        let least = sample.fold(f32::INFINITY, |least, line| least.min(line.radius));
        for slot in boxed.iter().map(|boxed| boxed.body) {
            let whole = &self.fat_lines[slot as usize];
            let may_be_far_closer = whole.radius >= 2.0 * least;
            let bounds =
                may_be_far_closer.then(|| bodies.bounds_by_teleport(slot, interval, whole));
            match bounds.flatten() {
                Some(bounds) => self.places.set(slot, bounds),
                None => self.places.remove(slot),
            }
        }
    }

    /// Replaces the boxes of bodies that teleport in a list by those of their places.
    fn list_places(&self, listed: &mut Vec<BodyBox>) {
        for number in 0..listed.len() {
            let body = listed[number].body;
            let places = self.places.of(body).into_iter().flatten();
            let mut boxes = places.map(|&(_, aabb)| BodyBox { aabb, body });
            if let Some(first) = boxes.next() {
                listed[number] = first;
                listed.extend(boxes);
            }
        }
    }
}
