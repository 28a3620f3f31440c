//! Bodies that may come near a plan that no body follows.

use super::state::{BoxIndex, LookaheadSlice, SliceScratch};
use crate::bounds::CubicSource;
use crate::count::short;
use crate::monitor::bodies::{BodyTable, form};
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
    /// Lists the bodies that may be near the body of a source within the slice, in any order, some several times.
    /// A body that has changed since its box was formed may be anywhere: it is listed as well.
    pub(in crate::monitor) fn neighbours(
        &self,
        bodies: &BodyTable<'_>,
        source: &CubicSource<'_, Segment>,
        scratch: &mut SliceScratch,
        neighbours: &mut Vec<NearBody>,
    ) {
        let SliceScratch {
            block, search, met, ..
        } = scratch;
        let index = if self.is_placed() {
            &self.index
        } else {
            self.query_index.get_or_init(|| self.index_of(bodies))
        };
        form(&bodies.grid.frame, source, &self.ends(), block);
        let own = &block.slices[0];
        met.clear();
        index.boxes.meeting(&own.boxes, search, |_, slot| {
            // They lie anywhere in memory, and are read when all are known.
            prefetch(from_ref(&index.fat_lines[slot as usize]));
            met.push(slot);
        });
        for fat_line in &own.fat_lines {
            neighbours.extend(met.iter().filter_map(|&slot| {
                let theirs = &index.fat_lines[slot as usize];
                let (from, to) = approaching(fat_line, theirs, self.interval)?;
                Some(NearBody { slot, from, to })
            }));
        }
        let (from, to) = self.interval;
        let changed = self.changed.slots().iter();
        neighbours.extend(changed.map(|&slot| NearBody { slot, from, to }));
    }

    /// Returns the boxes of all bodies.
    fn index_of(&self, bodies: &BodyTable<'_>) -> BoxIndex {
        let mut index = BoxIndex::default();
        index
            .fat_lines
            .resize(bodies.monitored.len(), Self::NO_FAT_LINE);
        let (mut listed, fat_lines) = (Vec::new(), &mut index.fat_lines);
        let slots = 0..short(bodies.monitored.len());
        bodies.boxes(slots, &self.ends(), &mut |_, boxed, fat_line| {
            fat_lines[boxed.body as usize] = *fat_line;
            listed.push(boxed);
        });
        index.boxes.build(&listed);
        index
    }

    /// Returns true if all bodies were boxed or compared in the slice, and it has a time in common with an
    /// interval.
    pub(in crate::monitor) fn covers_some_of(&self, (from, to): (f64, f64)) -> bool {
        (self.is_placed() || self.stage.is_compared())
            && self.interval.0 <= to
            && self.interval.1 >= from
    }
}
