//! A body's box and course in one slice, under construction.

use super::course::Course;
use super::pose::Stance;
use super::track::Piece;
use super::{ROUNDING, nearest};
use glam::Vec4;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;

/// What is known of a body in a slice from the pieces of its motion so far, relative to the body's
/// place. (Of four lanes, the last holds nothing of use.)
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trace {
    low: Vec4,
    high: Vec4,
    /// What rounding is relative to, besides these.
    near: f32,
    /// Largest distance from the line on each axis.
    stray: Vec4,
    /// The line from where the first piece begins to where the last one ends.
    start: Vec4,
    change: Vec4,
    /// The slice: from when, and the inverse of its duration.
    from: f64,
    rate: f64,
}

impl Trace {
    /// From the first piece of a slice that begins at `from` to the last; `rate` is the inverse of
    /// its duration, or 0 for a single instant.
    #[inline(always)]
    pub(crate) fn between(head: &Piece, tail: &Piece, (from, rate): (f64, f64)) -> Self {
        Self {
            low: Vec4::INFINITY,
            high: Vec4::NEG_INFINITY,
            near: 0.0,
            stray: Vec4::ZERO,
            start: head.points[0],
            change: tail.points[3] - head.points[0],
            from,
            rate,
        }
    }

    /// Takes a piece into account. Its difference to the line is a cubic as well, whose control
    /// points are those differences at every third of the piece.
    #[inline(always)]
    pub(crate) fn follow(&mut self, piece: &Piece) {
        let [p0, p1, p2, p3] = piece.points;
        self.low = self.low.min(p0.min(p1).min(p2.min(p3)));
        self.high = self.high.max(p0.max(p1).max(p2.max(p3)));
        self.near = self.near.max(piece.near);
        let begin = nearest((piece.from - self.from) * self.rate);
        let third = nearest((piece.to - piece.from) * (self.rate * (1.0 / 3.0)));
        let step = self.change * third;
        let line = self.start + self.change * begin;
        let (line_1, line_2) = (line + step, line + (step + step));
        let line_3 = line_1 + (step + step);
        let first = (p0 - line).abs().max((p1 - line_1).abs());
        let second = (p2 - line_2).abs().max((p3 - line_3).abs());
        self.stray = self.stray.max(first.max(second));
    }

    /// The course, and the box rounded outward, in the frame's unit; everywhere, where the frame
    /// does not serve. `first` is the cubic that the body follows first.
    #[inline(always)]
    pub(crate) fn finish(&self, stance: &Stance, first: u32) -> (Course, Aabb) {
        let Self { low, high, .. } = *self;
        // How far rounding can have moved each coordinate.
        let rounding = low.abs().max(high.abs()) * (ROUNDING * Piece::FAR)
            + Vec4::splat(self.near * (ROUNDING * Piece::NEAR) + stance.steady);
        let (start, change) = (stance.place + self.start, self.change);
        let course = course(start, change, (self.stray, rounding), stance.reach, first);
        // Of the place, of the two sums with it, and of the subtraction below: 4; and more than the
        // clearance of filters.
        let rounding = rounding + stance.place.abs() * (6.0 * ROUNDING);
        let low = (stance.low + low - rounding).max(Vec4::splat(f32::MIN));
        let high = (stance.high + high + rounding).min(Vec4::splat(f32::MAX));
        let aabb = Aabb::new(
            Vector::new(low.x, low.y, low.z),
            Vector::new(high.x, high.y, high.z),
        );
        (course, aabb)
    }
}

/// A line from which a body's control points stray this far on each axis, as far as rounding can
/// tell.
#[inline(always)]
fn course(
    start: Vec4,
    change: Vec4,
    (stray, rounding): (Vec4, Vec4),
    reach: f32,
    first: u32,
) -> Course {
    let stray = stray * stray;
    let rounding = rounding + (start.abs() + change.abs()) * (8.0 * ROUNDING);
    let slack = (stray.x + stray.y + stray.z).sqrt()
        + VANISHING
        + reach
        + 4.0 * (rounding.x + rounding.y + rounding.z);
    Course {
        start: [start.x, start.y, start.z],
        change: [change.x, change.y, change.z],
        // A few roundings of itself.
        slack: slack * (1.0 + 8.0 * ROUNDING),
        first,
    }
}

/// Lengths below this may vanish when they are squared. The frame's unit is such that worlds are no
/// smaller than 1e-10.
const VANISHING: f32 = 1e-18;
