//! Boxes for questions about slices that have none: a search from nothing has compared all bodies there, and kept none.

use super::super::bodies::BodyTable;
use super::super::slice::{BoxIndex, LookaheadSlice, NearBody, SliceScratch};
use crate::bounds::CubicSource;
use crate::trajectory::Segment;
use std::sync::{PoisonError, RwLock};

/// Boxes for questions between two ticks, over some consecutive slices at a time: formed by the first question.
#[derive(Debug, Default)]
pub(super) struct QueryIndexes(RwLock<Indexes>);

#[derive(Debug, Default)]
struct Indexes {
    /// The first ones are valid; the memory of the others is reused.
    all: Vec<QueryIndex>,
    count: usize,
}

#[derive(Debug, Default)]
struct QueryIndex {
    /// Number of the first slice.
    first: i64,
    index: BoxIndex,
}

impl QueryIndexes {
    /// Forgets all boxes: there is another tick.
    pub(super) fn clear(&mut self) {
        let indexes = self.0.get_mut().unwrap_or_else(PoisonError::into_inner);
        indexes.count = 0;
    }

    /// Lists the bodies that may be near the body of a source within consecutive slices and a window (s), as
    /// [`LookaheadSlice::neighbours`] does. Between two ticks, the window is always the same, and so are the slices that
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
        let start = first.start().max(window.0);
        let interval = (
            if start < last.end() {
                start
            } else {
                first.start()
            },
            last.end(),
        );
        let mut indexes = self.0.read().unwrap_or_else(PoisonError::into_inner);
        if indexes.of(first.number).is_none() {
            drop(indexes);
            let mut to_form = self.0.write().unwrap_or_else(PoisonError::into_inner);
            to_form.form(first.number, interval, bodies);
            drop(to_form);
            indexes = self.0.read().unwrap_or_else(PoisonError::into_inner);
        }
        if let Some(index) = indexes.of(first.number) {
            index.neighbours(bodies, interval, source, scratch, neighbours);
        }
    }
}

impl Indexes {
    fn of(&self, first: i64) -> Option<&BoxIndex> {
        let valid = self.all[..self.count].iter();
        valid
            .rev()
            .find(|one| one.first == first)
            .map(|one| &one.index)
    }

    /// Forms the boxes of an interval (s) that begins with a slice, unless another thread has.
    fn form(&mut self, first: i64, interval: (f64, f64), bodies: &BodyTable<'_>) {
        if self.of(first).is_some() {
            return;
        }
        if self.count == self.all.len() {
            self.all.push(QueryIndex::default());
        }
        let unused = &mut self.all[self.count];
        unused.first = first;
        unused.index.form(bodies, interval);
        self.count += 1;
    }
}
