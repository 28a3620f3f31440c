//! A body's box and course in one slice, under construction.

use super::course::Course;
use super::piece::Piece;
use super::pose::Stance;
use super::{ROUNDING, nearest};
use glam::Vec4;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;

/// The time of a slice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    /// First and last instant, s.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// The inverse of its duration; 0 if that is too short to be divided.
    rate: f64,
}

impl Stretch {
    pub(crate) fn new(from: f64, to: f64) -> Self {
        let duration = to - from;
        let rate = if duration >= f64::MIN_POSITIVE {
            1.0 / duration
        } else {
            0.0
        };
        Self { from, to, rate }
    }

    /// Which share of it has passed at an instant.
    #[inline(always)]
    fn share(&self, time: f64) -> f32 {
        nearest((time - self.from) * self.rate)
    }
}

/// What is known of a body in a slice from the pieces of its motion so far, relative to the body's
/// place. (Of four lanes, the last holds nothing of use.)
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trace {
    low: Vec4,
    high: Vec4,
    /// What rounding is relative to, besides these, and how often a piece was split at most.
    near: f32,
    splits: f32,
    /// Largest distance from the line on each axis.
    stray: Vec4,
    /// The line from where the first piece begins to where the last one ends.
    start: Vec4,
    change: Vec4,
    /// Where it is at the end of the pieces so far.
    line: Vec4,
    stretch: Stretch,
}

impl Trace {
    /// From the first piece of a slice to the last.
    #[inline(always)]
    pub(crate) fn between(head: &Piece, tail: &Piece, stretch: &Stretch) -> Self {
        let start = head.points[0];
        // In no time there is no change: what is elsewhere strays.
        let change = if stretch.rate > 0.0 {
            tail.points[3] - start
        } else {
            Vec4::ZERO
        };
        let line = start + change * stretch.share(head.from);
        let mut trace = Self {
            low: start,
            high: start,
            near: 0.0,
            splits: 0.0,
            stray: (start - line).abs(),
            start,
            change,
            line,
            stretch: *stretch,
        };
        trace.follow(head);
        trace
    }

    /// Goes on with a piece that begins when the one before ends, wherever that is.
    #[inline(always)]
    pub(crate) fn follow_from_start(&mut self, piece: &Piece) {
        let start = piece.points[0];
        self.low = self.low.min(start);
        self.high = self.high.max(start);
        self.stray = self.stray.max((start - self.line).abs());
        self.follow(piece);
    }

    /// Goes on with a piece from its start, which is known. Its difference to the line is a cubic
    /// as well, whose control points are those differences at every third of the piece.
    #[inline(always)]
    fn follow(&mut self, piece: &Piece) {
        let [_, p1, p2, p3] = piece.points;
        self.low = self.low.min(p1.min(p2).min(p3));
        self.high = self.high.max(p1.max(p2).max(p3));
        self.near = self.near.max(piece.near);
        self.splits = self.splits.max(piece.splits);
        let line_3 = self.start + self.change * self.stretch.share(piece.to);
        let third = (line_3 - self.line) * (1.0 / 3.0);
        let (line_1, line_2) = (self.line + third, line_3 - third);
        let stray = (p1 - line_1).abs().max((p2 - line_2).abs());
        self.stray = self.stray.max(stray.max((p3 - line_3).abs()));
        self.line = line_3;
    }

    /// The course, and the box rounded outward, in the frame's unit; everywhere, where the frame
    /// does not serve. `first` is the cubic that the body follows first.
    #[inline(always)]
    pub(crate) fn finish(&self, stance: &Stance, first: u32) -> (Course, Aabb) {
        let Self { low, high, .. } = *self;
        // How far rounding can have moved each coordinate.
        let count = |[once, each]: [f32; 2]| ROUNDING * (once + each * self.splits);
        let rounding = low.abs().max(high.abs()) * count(Piece::FAR)
            + Vec4::splat(self.near * count(Piece::NEAR) + stance.steady);
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
        + (rounding.x + rounding.y + rounding.z);
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
