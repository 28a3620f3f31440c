//! The parts of a span in which both rotations are cubics.

use crate::accuracy::Accuracy;
use crate::enclosure::UncertainCubic;
use crate::narrow_phase::BodyView;
use crate::narrow_phase::relative::RelativeCubic;
use crate::orientation::{BakedRotation, Turning, TurningCell};
use crate::spans::{Span, common_part};

/// A part of a span between neighbouring cuts of both bodies' rotations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) span: Span,
    /// Cells of the rotations; `None` for a body that does not turn.
    turns: [Option<TurningCell>; 2],
}

/// Calls `visit` with the parts of a walk that have a distance, those with a small one first: they
/// rule out most others.
pub(super) fn nearest_first<'a>(
    cells: Cells<'a>,
    distance: &dyn Fn(&Cell) -> Option<f64>,
    visit: &mut dyn FnMut(&Cell),
) {
    let mut cells = cells.filter_map(|cell| distance(&cell).map(|distance| (distance, cell)));
    let Some(first) = cells.next() else {
        return;
    };
    let Some(second) = cells.next() else {
        // Most bodies do not turn.
        return visit(&first.1);
    };
    let mut order: Vec<(f64, Cell)> = Vec::with_capacity(Cells::USUAL);
    order.extend([first, second]);
    while !order.is_empty() {
        order.extend(cells.by_ref().take(Cells::BLOCK - order.len()));
        order.sort_by(|x, y| x.0.total_cmp(&y.0));
        order.drain(..).for_each(|(_, cell)| visit(&cell));
        order.extend(cells.next());
    }
}

/// Calls `visit` once with each part of a span that does not begin before `after` (s) and meets an
/// interval (s). If there are many, only parts matter in which a bounding sphere is within a distance (m):
/// `near` returns its motion and that distance, or `None` if that is never so.
pub(super) fn each_near<'a>(
    cells: &dyn Fn((f64, f64)) -> Cells<'a>,
    (interval, after): ((f64, f64), f64),
    near: &dyn Fn() -> Option<(RelativeCubic, UncertainCubic, f64)>,
    visit: &mut dyn FnMut(&Cell),
) {
    let mut visited = after;
    let mut visit_all = |times: (f64, f64)| {
        for cell in cells(times) {
            if cell.span.start >= visited {
                visited = cell.span.end.max(cell.span.start.next_up());
                visit(&cell);
            }
        }
    };
    if cells(interval).nth(Cells::FEW).is_none() {
        visit_all(interval);
    } else if let Some((cubic, enclosed, distance)) = near() {
        cubic.each_time_within(&enclosed, distance, |time| {
            if let Some(times) = common_part((time.earliest, time.latest), interval) {
                visit_all(times);
            }
        });
    }
}

/// Iterator over the parts of a span between cuts of either body's rotation, in time order: those
/// that overlap or touch an interval.
#[derive(Debug)]
pub(super) struct Cells<'a> {
    span: Span,
    turning: [Option<&'a Turning>; 2],
    accuracy: Accuracy,
    turns: [Option<TurningCell>; 2],
    /// An instant of the next part, s.
    time: f64,
    until: f64,
    is_done: bool,
}

impl<'a> Cells<'a> {
    /// Parts of a span that are put in order at a time: a span may have any number.
    const BLOCK: usize = 1024;
    /// Room for those of one revolution of each body, and more.
    const USUAL: usize = 24;
    /// Largest number of parts of which each is tested by itself.
    const FEW: usize = 4;

    /// Returns the walk through the parts of a span that meet an interval (s).
    pub(super) fn of(
        (a, b): (&BodyView<'a>, &BodyView<'a>),
        span: Span,
        accuracy: Accuracy,
        (from, to): (f64, f64),
    ) -> Self {
        Self {
            span,
            turning: [a.turning, b.turning],
            accuracy,
            turns: [None; 2],
            // One step of f64 early, so that a part that ends at `from` is included. Parts that end earlier have no
            // results in the interval: results are rounded to instants of their part.
            time: from.next_down().max(span.start),
            until: to.min(span.end),
            is_done: from > span.end || to < span.start,
        }
    }
}

impl Cell {
    /// Returns the middle of the part that lies within an interval (s), if it meets that.
    pub(super) fn middle(&self, (from, to): (f64, f64)) -> Option<f64> {
        let (start, end) = (from.max(self.span.start), to.min(self.span.end));
        (start <= end).then_some(start + 0.5 * (end - start))
    }
}

impl Iterator for Cells<'_> {
    type Item = Cell;

    fn next(&mut self) -> Option<Cell> {
        if self.is_done {
            return None;
        }
        let (mut start, mut end) = (self.span.start, self.span.end);
        for (turn, turning) in self.turns.iter_mut().zip(self.turning) {
            let Some(turning) = turning else {
                continue;
            };
            let known = turn.filter(|cell| cell.start <= self.time && self.time < cell.end);
            let cell = known.unwrap_or_else(|| turning.cell_at(self.time, self.accuracy));
            (start, end) = (start.max(cell.start), end.min(cell.end));
            *turn = Some(cell);
        }
        self.is_done = end >= self.span.end || end > self.until;
        self.time = end;
        let span = Span {
            start,
            end,
            ..self.span
        };
        let turns = self.turns;
        Some(Cell { span, turns })
    }
}

/// The cubics of both bodies' rotations, over the cells met last and over the parts of these.
#[derive(Debug, Default)]
pub(super) struct Rotations {
    cells: [Option<(TurningCell, BakedRotation)>; 2],
    /// `None` for a part that is the whole cell.
    parts: [Option<BakedRotation>; 2],
}

impl Rotations {
    /// Returns the rotations over a part, `None` for a body that does not turn.
    pub(super) fn over(
        &mut self,
        views: [&BodyView<'_>; 2],
        cell: &Cell,
        accuracy: Accuracy,
    ) -> [Option<&BakedRotation>; 2] {
        let ends = (cell.span.start, cell.span.end);
        for (body, view) in views.iter().enumerate() {
            let (Some(turning), Some(turn)) = (view.turning, &cell.turns[body]) else {
                continue;
            };
            if self.cells[body].as_ref().is_none_or(|(met, _)| met != turn) {
                self.cells[body] = Some((*turn, turning.bake(turn, accuracy)));
            }
            let whole = self.cells[body].as_ref().map(|(_, baked)| baked);
            let cut = whole.filter(|_| ends != (turn.start, turn.end));
            self.parts[body] = cut.map(|baked| baked.part(ends));
        }
        [0, 1].map(|body| {
            let whole = self.cells[body].as_ref().map(|(_, baked)| baked);
            self.parts[body].as_ref().or(whole)
        })
    }
}
