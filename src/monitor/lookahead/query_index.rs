//! Boxes for questions about slices that have none: a search from nothing has compared all bodies there, and kept none.

use super::super::bodies::BodyTable;
use super::super::slice::{BoxIndex, LookaheadSlice, NearBody, SliceScratch};
use crate::bounds::CubicSource;
use crate::trajectory::Segment;
use std::sync::{PoisonError, RwLock};

/// Boxes for questions between two ticks, over some consecutive slices at a time: formed by the first question. Each
/// has the number of its first slice; without one it is not valid, and its memory is used again.
#[derive(Debug, Default)]
pub(super) struct QueryIndexes(RwLock<Vec<(Option<i64>, BoxIndex)>>);

impl QueryIndexes {
    /// Forgets all boxes: there is another tick.
    pub(super) fn clear(&mut self) {
        let indexes = self.0.get_mut().unwrap_or_else(PoisonError::into_inner);
        indexes.iter_mut().for_each(|(first, _)| *first = None);
    }

    /// Lists the bodies that may be near the body of a source within consecutive slices and a window (s), as
    /// [`BoxIndex::neighbours`] does. Between two ticks, the window is always the same, and so are the slices that
    /// begin with one.
    pub(super) fn neighbours(
        &self,
        bodies: &BodyTable<'_>,
        (slices, window): (&[&LookaheadSlice], (f64, f64)),
        source: &CubicSource<'_, Segment>,
        scratch: &mut SliceScratch,
        neighbours: &mut Vec<NearBody>,
    ) {
        let (Some(first), Some(last)) = (slices.first(), slices.last()) else {
            return;
        };
        // What the clock has passed may have many knots.
        let start = first.interval.0.max(window.0);
        let interval = (
            if start < last.interval.1 {
                start
            } else {
                first.interval.0
            },
            last.interval.1,
        );
        let of_slices = |(number, _): &(Option<i64>, BoxIndex)| *number == Some(first.number);
        let mut indexes = self.0.read().unwrap_or_else(PoisonError::into_inner);
        if !indexes.iter().any(of_slices) {
            drop(indexes);
            let mut to_form = self.0.write().unwrap_or_else(PoisonError::into_inner);
            // Another thread may have formed it.
            if !to_form.iter().any(of_slices) {
                let unused = to_form.iter().position(|(number, _)| number.is_none());
                let (_, mut index) =
                    unused.map_or_else(Default::default, |at| to_form.swap_remove(at));
                index.form(bodies, interval);
                to_form.push((Some(first.number), index));
            }
            drop(to_form);
            indexes = self.0.read().unwrap_or_else(PoisonError::into_inner);
        }
        if let Some((_, index)) = indexes.iter().find(|one| of_slices(one)) {
            index.neighbours(bodies, interval, source, scratch, neighbours);
        }
    }
}
