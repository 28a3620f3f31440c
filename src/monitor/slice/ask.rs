//! Who may come near a plan that is not in place.

use super::Slice;
use crate::bounds::{MovingFrame, Pose};
use crate::monitor::bodies::form;
use crate::monitor::boxes::Search;
use crate::narrow_phase::approaching;
use crate::search::Block;
use crate::simd::prefetch;
use crate::trajectory::Segment;
use std::slice::from_ref;

/// Another body, and when it may be near (s).
#[derive(Clone, Copy, Debug)]
pub(in crate::monitor) struct Neighbour {
    pub(in crate::monitor) slot: u32,
    pub(in crate::monitor) from: f64,
    pub(in crate::monitor) to: f64,
}

/// What questions to slices write to.
#[derive(Debug, Default)]
pub(in crate::monitor) struct Answer {
    /// In any order; a body may be listed several times.
    pub(in crate::monitor) neighbours: Vec<Neighbour>,
    pub(in crate::monitor) block: Block,
    search: Search,
    met: Vec<u32>,
}

impl Slice {
    /// Lists the bodies that may be near one in this pose within the slice. What has changed since it
    /// was boxed here may be anywhere.
    pub(in crate::monitor) fn neighbours(
        &self,
        frame: &MovingFrame,
        pose: &Pose<'_, Segment>,
        answer: &mut Answer,
    ) {
        let Answer {
            neighbours,
            block,
            search,
            met,
        } = answer;
        form(frame, from_ref(pose), &self.ends(), block);
        let own = &block.slices[0];
        met.clear();
        self.boxes.meeting(&own.boxes, search, |_, slot| {
            // They lie anywhere in memory, and are read when all are known.
            prefetch(from_ref(&self.courses[slot as usize]));
            met.push(slot);
        });
        for course in &own.courses {
            neighbours.extend(met.iter().filter_map(|&slot| {
                let theirs = &self.courses[slot as usize];
                let (from, to) = approaching(course, theirs, self.interval)?;
                Some(Neighbour { slot, from, to })
            }));
        }
        let (from, to) = self.interval;
        let changed = self.changed.iter();
        neighbours.extend(changed.map(|&slot| Neighbour { slot, from, to }));
    }

    /// Whether the slice has all boxes, and a time in common with an interval.
    pub(in crate::monitor) fn covers_some_of(&self, (from, to): (f64, f64)) -> bool {
        self.is_placed() && self.interval.0 <= to && self.interval.1 >= from
    }
}
