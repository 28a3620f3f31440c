//! Bodies that may come near a plan that no body follows.

use super::state::{BoxIndex, LookaheadSlice, SliceScratch};
use crate::bounds::{CubicSource, FatLine};
use crate::broad_phase::BodyBox;
use crate::monitor::bodies::BodyTable;
use crate::narrow_phase::approaching;
use crate::simd::prefetch;
use crate::trajectory::Segment;
use std::slice::from_ref;

/// Another body, and the time in which it may be near (s).
#[derive(Clone, Copy, Debug)]
pub(in crate::monitor) struct NearBody {
    pub(in crate::monitor) slot: u32,
    pub(in crate::monitor) from: f64,
    pub(in crate::monitor) to: f64,
}

impl LookaheadSlice {
    /// Lists the bodies that have changed since their boxes were formed: each may be anywhere.
    pub(in crate::monitor) fn list_changed(&self, neighbours: &mut Vec<NearBody>) {
        let (from, to) = self.interval;
        let changed = self.changed.slots().iter();
        neighbours.extend(changed.map(|&slot| NearBody { slot, from, to }));
    }

    /// Returns true if all bodies were boxed or compared in the slice, and it has a time in common with an
    /// interval.
    pub(in crate::monitor) fn covers_some_of(&self, (from, to): (f64, f64)) -> bool {
        (self.is_placed() || self.stage.is_compared())
            && self.interval.0 <= to
            && self.interval.1 >= from
    }
}

impl BoxIndex {
    /// Stands for the fat line of a body without a box: nobody asks for it.
    pub(super) const NO_FAT_LINE: FatLine = FatLine {
        start: [0.0; 3],
        change: [0.0; 3],
        radius: f32::INFINITY,
        first: 0,
    };

    /// Forms the boxes of all bodies in an interval (s).
    pub(in crate::monitor) fn form(&mut self, bodies: &BodyTable<'_>, (from, to): (f64, f64)) {
        let (mut listed, mut present) = (Vec::new(), Vec::new());
        bodies.list_present(0..bodies.monitored.len(), (from, to), &mut present);
        self.list_boxes(bodies, present.iter().copied(), (from, to), &mut listed);
        self.boxes.build(&listed);
    }

    /// Lists the boxes of some bodies in an interval (s), and keeps their fat lines.
    pub(super) fn list_boxes(
        &mut self,
        bodies: &BodyTable<'_>,
        slots: impl Iterator<Item = u32> + Clone,
        (from, to): (f64, f64),
        listed: &mut Vec<BodyBox>,
    ) {
        let fat_lines = &mut self.fat_lines;
        fat_lines.resize(bodies.monitored.len(), Self::NO_FAT_LINE);
        bodies.boxes(slots, &[from, to], &mut |_, boxed, fat_line| {
            fat_lines[boxed.body as usize] = *fat_line;
            listed.push(boxed);
        });
    }

    /// Lists the bodies that may be near the body of a source within the interval of the boxes (s).
    pub(in crate::monitor) fn neighbours(
        &self,
        bodies: &BodyTable<'_>,
        interval: (f64, f64),
        source: &CubicSource<'_, Segment>,
        scratch: &mut SliceScratch,
        neighbours: &mut Vec<NearBody>,
    ) {
        let SliceScratch {
            block,
            search,
            slots,
            ..
        } = scratch;
        block.form_one(&bodies.grid.frame, source, &[interval.0, interval.1]);
        let own = &block.slices[0];
        slots.clear();
        self.boxes.meeting(&own.boxes, search, |_, slot| {
            // They lie anywhere in memory, and are read when all are known.
            prefetch(from_ref(&self.fat_lines[slot as usize]));
            slots.push(slot);
        });
        for fat_line in &own.fat_lines {
            neighbours.extend(slots.iter().filter_map(|&slot| {
                let theirs = &self.fat_lines[slot as usize];
                let (from, to) = approaching(fat_line, theirs, interval)?;
                Some(NearBody { slot, from, to })
            }));
        }
    }
}
