//! Courses: the straight line that a body nearly follows through a slice, closer than any box.

use super::{Anchor, Hull, Inflation, Part, ROUNDING, nearest};
use glam::Vec4;

/// A straight line through a slice of time, and how far a body strays from it, in the frame's unit.
///
/// At the share `s` of the slice, 0..=1, every sphere of the body with half the margin around it is
/// within `slack` of `start + s change`, what the exact solver's rounding can add included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    pub(crate) start: [f32; 3],
    pub(crate) change: [f32; 3],
    /// Infinite where the frame does not serve.
    pub(crate) slack: f32,
    /// The cubic that the body follows first in the slice.
    pub(crate) first: u32,
}

/// A [`Course`] under construction, relative to the anchor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    start: Vec4,
    change: Vec4,
    /// Largest deviation on each axis.
    deviation: Vec4,
    /// The slice: from when, and the inverse of its duration.
    from: f64,
    rate: f64,
}

impl Chord {
    /// From where one part begins to where another ends, in a slice that begins at `from`; `rate`
    /// is the inverse of its duration, or 0 for a single instant.
    #[inline(always)]
    pub(crate) fn between(head: &Part, tail: &Part, from: f64, rate: f64) -> Self {
        Self {
            start: head.points[0],
            change: tail.points[3] - head.points[0],
            deviation: Vec4::ZERO,
            from,
            rate,
        }
    }

    /// Takes a part's deviation into account. The difference to the line is a cubic as well, whose
    /// control points are those differences at every third of the part.
    #[inline(always)]
    pub(crate) fn follow(&mut self, part: &Part) {
        let begin = nearest((part.from - self.from) * self.rate);
        let third = nearest((part.to - part.from) * (self.rate * (1.0 / 3.0)));
        let step = self.change * third;
        let line = self.start + self.change * begin;
        let [p0, p1, p2, p3] = part.points;
        let (line_1, line_2) = (line + step, line + (step + step));
        let line_3 = line_1 + (step + step);
        let first = (p0 - line).abs().max((p1 - line_1).abs());
        let second = (p2 - line_2).abs().max((p3 - line_3).abs());
        self.deviation = self.deviation.max(first.max(second));
    }

    /// The line for a body whose parts have this hull.
    #[inline(always)]
    pub(crate) fn course(
        &self,
        hull: &Hull,
        inflation: &Inflation,
        anchor: &Anchor,
        first: u32,
    ) -> Course {
        let start = anchor.place + self.start;
        let change = self.change;
        let stray = self.deviation * self.deviation;
        let rounding = hull.rounding(inflation) + (start.abs() + change.abs()) * (8.0 * ROUNDING);
        let slack = if hull.is_served(inflation, anchor) {
            (stray.x + stray.y + stray.z).sqrt()
                + VANISHING
                + inflation.reach
                + 4.0 * (rounding.x + rounding.y + rounding.z)
        } else {
            f32::INFINITY
        };
        Course {
            start: [start.x, start.y, start.z],
            change: [change.x, change.y, change.z],
            // A few roundings of itself.
            slack: slack * (1.0 + 8.0 * ROUNDING),
            first,
        }
    }
}

/// Lengths below this may vanish when they are squared. The frame's unit is such that worlds are no
/// smaller than 1e-10.
const VANISHING: f32 = 1e-18;
