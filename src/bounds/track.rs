//! A cubic of a sketch that is cut at several instants: each cut serves the parts on both sides.

use super::sketch::Stroke;
use super::{ROUNDING, nearest};
use glam::Vec4;

/// A part of a cubic: control points relative to a body's place, in the frame's unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(super) points: [Vec4; 4],
    /// What their rounding is relative to, besides their own size.
    pub(super) near: f32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Piece {
    /// Roundings that the points can carry, relative to their coordinates and to `near`.
    ///
    /// Far: one of each point of a sketch. A point on the cubic ([`Track::cut`]) is the first one
    /// and a mean of differences to it: a mean of all four, 1, and the sum's own, 1. A lever is a
    /// difference of two such means, 2; an inner control point is the sum of both, 1 more: 5. Two
    /// for the sums of a box, or three for the line of a course and one for its place: 9 at most.
    /// Near: a difference has 1; de Casteljau's three levels have 3 each, of two rounded weights,
    /// two products and a sum. A lever is the difference of two points one level below, 2 (1 + 6)
    /// and 2 of its own, being no longer than 2; its product with a rounded share has 4 more. An
    /// inner control point is the sum of a point and such a product, 10 + 20; and 8 more, since
    /// coordinates in the slice may be smaller than those of the whole cubic by `near`.
    pub(super) const FAR: f32 = 9.0 + 3.0;
    pub(super) const NEAR: f32 = 38.0 + 2.0;

    /// One that `f32` does not serve.
    pub(super) const fn anywhere((from, to): (f64, f64)) -> Self {
        Self {
            points: [Vec4::ZERO; 4],
            near: f32::INFINITY,
            from,
            to,
        }
    }

    /// A whole cubic.
    #[inline(always)]
    pub(super) fn whole(stroke: &Stroke, (from, to): (f64, f64), factor: f32) -> Self {
        let (points, near) = stroke.points(factor);
        Self {
            points,
            near,
            from,
            to,
        }
    }
}

/// A cubic from which parts are taken.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Track {
    whole: Piece,
    /// The inverse of its duration; 0 if that is too short to be divided.
    rate: f64,
}

/// A body at an instant of a track.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    time: f64,
    point: Vec4,
    /// A third of the velocity, by the track's own parameter.
    lever: Vec4,
}

impl Track {
    #[inline(always)]
    pub(crate) fn new(mut whole: Piece) -> Self {
        let duration = whole.to - whole.from;
        let rate = if duration >= f64::MIN_POSITIVE {
            1.0 / duration
        } else {
            // It is taken to stand still; where it may be instead is accounted for as rounding.
            whole.near *= 1.0 / ROUNDING;
            0.0
        };
        Self { whole, rate }
    }

    /// Last instant, s.
    #[inline(always)]
    pub(crate) const fn end(&self) -> f64 {
        self.whole.to
    }

    /// The body at an instant of the track (s), by de Casteljau on differences from the first
    /// point.
    #[inline(always)]
    pub(crate) fn cut(&self, time: f64) -> Cut {
        let first = nearest((self.whole.to - time) * self.rate);
        let second = nearest((time - self.whole.from) * self.rate);
        let mix = |x: Vec4, y: Vec4| x * first + y * second;
        let [p0, p1, p2, p3] = self.whole.points;
        let (b1, b2, b3) = (p1 - p0, p2 - p0, p3 - p0);
        let (q0, q1, q2) = (b1 * second, mix(b1, b2), mix(b2, b3));
        let (r0, r1) = (mix(q0, q1), mix(q1, q2));
        Cut {
            time,
            point: p0 + mix(r0, r1),
            lever: r1 - r0,
        }
    }

    /// The part between two cuts.
    #[inline(always)]
    pub(crate) fn between(&self, from: &Cut, to: &Cut) -> Piece {
        let share = nearest((to.time - from.time) * self.rate);
        Piece {
            points: [
                from.point,
                from.point + from.lever * share,
                to.point - to.lever * share,
                to.point,
            ],
            near: self.whole.near,
            from: from.time,
            to: to.time,
        }
    }

    /// The part before a cut.
    #[inline(always)]
    pub(crate) fn before(&self, to: &Cut) -> Piece {
        let [p0, p1, ..] = self.whole.points;
        let start = Cut {
            time: self.whole.from,
            point: p0,
            lever: p1 - p0,
        };
        self.between(&start, to)
    }

    /// The part after a cut.
    #[inline(always)]
    pub(crate) fn after(&self, from: &Cut) -> Piece {
        let [_, _, p2, p3] = self.whole.points;
        let end = Cut {
            time: self.whole.to,
            point: p3,
            lever: p3 - p2,
        };
        self.between(from, &end)
    }
}
