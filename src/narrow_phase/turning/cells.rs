//! The parts of a span in which both rotations are cubics.

use crate::accuracy::Accuracy;
use crate::narrow_phase::BodyView;
use crate::orientation::{BakedRotation, Turning, TurningCell};
use crate::spans::Span;

/// Iterator over the parts of a span between cuts of either body's rotation, in time order: those
/// that overlap or touch an interval.
#[derive(Debug)]
pub(super) struct Cells<'a> {
    span: Span,
    rotations: [RotationWalk<'a>; 2],
    /// An instant of the next part, s.
    time: f64,
    until: f64,
    is_done: bool,
}

/// One body's rotation, walked from cell to cell.
#[derive(Debug)]
struct RotationWalk<'a> {
    turning: Option<&'a Turning>,
    accuracy: Accuracy,
    cell: Option<TurningCell>,
    baked: Option<BakedRotation>,
}

impl<'a> Cells<'a> {
    /// Returns the walk through the parts of a span that meet an interval (s).
    pub(super) fn of(
        (a, b): (&BodyView<'a>, &BodyView<'a>),
        span: Span,
        accuracy: Accuracy,
        (from, to): (f64, f64),
    ) -> Self {
        let walk = |view: &BodyView<'a>| RotationWalk {
            turning: view.turning,
            accuracy,
            cell: None,
            baked: None,
        };
        Self {
            span,
            rotations: [walk(a), walk(b)],
            // The part that ends there is included.
            time: from.next_down().max(span.start),
            until: to.min(span.end),
            is_done: from > span.end || to < span.start,
        }
    }

    /// Returns the next part.
    pub(super) fn next(&mut self) -> Option<Span> {
        if self.is_done {
            return None;
        }
        let (mut start, mut end) = (self.span.start, self.span.end);
        for walk in &mut self.rotations {
            if let Some(cell) = walk.cell_at(self.time) {
                (start, end) = (start.max(cell.start), end.min(cell.end));
            }
        }
        self.is_done = end >= self.span.end || end > self.until;
        self.time = end;
        Some(Span {
            start,
            end,
            ..self.span
        })
    }

    /// Returns the rotations over the part that was returned last, `None` for a body that does not
    /// turn.
    pub(super) fn rotations(&mut self, part: Span) -> [Option<BakedRotation>; 2] {
        let [a, b] = &mut self.rotations;
        [a, b].map(|walk| walk.over((part.start, part.end)))
    }
}

impl RotationWalk<'_> {
    fn cell_at(&mut self, time: f64) -> Option<TurningCell> {
        let turning = self.turning?;
        if let Some(cell) = self.cell
            && cell.start <= time
            && time < cell.end
        {
            return Some(cell);
        }
        self.baked = None;
        self.cell = Some(turning.cell_at(time, self.accuracy));
        self.cell
    }

    fn over(&mut self, part: (f64, f64)) -> Option<BakedRotation> {
        let (turning, cell) = (self.turning?, self.cell?);
        let baked = self
            .baked
            .get_or_insert_with(|| turning.bake(&cell, self.accuracy));
        Some(baked.part(part))
    }
}
