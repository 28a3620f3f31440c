//! Boxes: the Bézier hull of a part of a trajectory, rounded outward to a parry3d `Aabb` (f32).
//!
//! A box contains every position from which the exact solver would report a contact, the solver's
//! own rounding included: it is inflated by the hitbox, half the margin and the clearance that
//! every filter keeps (see `rounding`). A [`Course`] says the same more closely: a straight line,
//! and how far from it.
//!
//! All is computed in f64 relative to the frame's origin. What rounding can have moved (a share of
//! 2^-53 a step, of the segment's reach or of the coordinates, some 120 steps at most) is within
//! the clearance.

use crate::hitbox::Sphere;
use crate::quad::{Quad, difference, least, most, quad, size, sum, times};
use crate::rounding::{CLEARANCE, UNDERFLOW, norm, normalising_power};
use crate::trajectory::Segment;
use glam::DVec3;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;

/// Where f32 coordinates are measured from, and in which unit.
///
/// Far from the origin f32 boxes go blind, and beyond 3e38 they overflow; relative to the middle
/// of the scene, in a power of two that suits its size, they do neither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    origin: DVec3,
    power: f64,
}

/// A box in f64, in the scene's own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extremes {
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
}

impl Extremes {
    pub(crate) const NOTHING: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    pub(crate) fn include(&mut self, other: Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    /// Rough extremes of a whole segment, for choosing a frame: no rounding is accounted for.
    pub(crate) fn of_segment(segment: &Segment, reach: f64) -> Self {
        Self {
            low: segment.origin() - reach,
            high: segment.origin() + reach,
        }
    }
}

impl Frame {
    /// A frame for coordinates within `extremes` and inflations up to `inflation` (m).
    pub(crate) fn around(extremes: Extremes, inflation: f64) -> Self {
        if !(extremes.low.is_finite() && extremes.high.is_finite()) {
            return Self {
                origin: DVec3::ZERO,
                power: 1.0,
            };
        }
        let origin = extremes.low * 0.5 + extremes.high * 0.5;
        let half = (extremes.high - origin).max_element() + inflation;
        let power = if half <= 0.0 || (1e-10..1e30).contains(&half) {
            1.0
        } else {
            normalising_power(half)
        };
        Self { origin, power }
    }
}

/// How much larger than its hull a body's box is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inflation {
    /// Extremes of the hitbox in the body's frame, half the margin and its own clearance included.
    low: Quad,
    high: Quad,
    /// Largest distance from the body's position that the bounding sphere and half the margin
    /// reach, its own clearance included.
    reach: f64,
    /// The hitbox' size, which its rounding is relative to.
    size: f64,
}

impl Inflation {
    pub(crate) fn of(spheres: &[Sphere], bounding: Sphere, margin: f64) -> Self {
        // Never inverted: a negative margin that swallows one body's radius leaves a point,
        // and the other body's box is then at worst too large.
        let half_size = |sphere: &Sphere| (sphere.radius + 0.5 * margin).max(0.0);
        let mut hitbox = Extremes::NOTHING;
        for sphere in spheres {
            let reach = half_size(sphere);
            hitbox.include(Extremes {
                low: sphere.offset - reach,
                high: sphere.offset + reach,
            });
        }
        let size = norm(hitbox.low.abs().max(hitbox.high.abs()))
            + norm(bounding.offset)
            + bounding.radius
            + margin.abs();
        let pad = 4.0 * CLEARANCE * size;
        Self {
            low: quad(hitbox.low - pad),
            high: quad(hitbox.high + pad),
            reach: norm(bounding.offset) + half_size(&bounding) + pad,
            size,
        }
    }

    /// Largest distance from the body's position that it adds, m.
    pub(crate) const fn size(&self) -> f64 {
        self.size
    }
}

/// A part of a cubic, as control points relative to its segment's origin (m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    points: [Quad; 4],
    /// The segment's origin relative to the frame's, m.
    base: Quad,
    /// What the rounding of the points is relative to, m.
    reach: f64,
    from: f64,
    to: f64,
}

/// How often a part may be split: each time rounds its points 9 times more.
pub(crate) const MOST_SPLITS: u32 = 9;

impl Part {
    /// The part of a segment over `from..=to`, within its knots or not.
    pub(crate) fn of(segment: &Segment, (from, to): (f64, f64), frame: &Frame) -> Self {
        Self {
            points: segment.restrict(from, to).points.map(quad),
            reach: segment.reach(from, to).max(segment.extent()),
            from,
            to,
            base: difference(quad(segment.origin()), quad(frame.origin)),
        }
    }

    /// A whole segment.
    #[inline(always)]
    pub(crate) fn whole(segment: &Segment, frame: &Frame) -> Self {
        Self {
            points: segment.control().map(quad),
            reach: segment.extent(),
            from: segment.start(),
            to: segment.end(),
            base: difference(quad(segment.origin()), quad(frame.origin)),
        }
    }

    /// Last instant, s.
    #[inline(always)]
    pub(crate) const fn end(&self) -> f64 {
        self.to
    }

    /// Splits off what lies before `cut`, by de Casteljau; the rest stays.
    #[inline(always)]
    pub(crate) fn split_off(&mut self, cut: f64) -> Self {
        let duration = self.to - self.from;
        let (first, second) = ((self.to - cut) / duration, (cut - self.from) / duration);
        let [p0, p1, p2, p3] = self.points;
        let (q0, q1, q2) = (
            mix(p0, first, p1, second),
            mix(p1, first, p2, second),
            mix(p2, first, p3, second),
        );
        let (r0, r1) = (mix(q0, first, q1, second), mix(q1, first, q2, second));
        let middle = mix(r0, first, r1, second);
        let before = Self {
            points: [p0, q0, r0, middle],
            to: cut,
            ..*self
        };
        self.points = [middle, r1, q2, p3];
        self.from = cut;
        before
    }
}

#[inline(always)]
fn mix(a: Quad, first: f64, b: Quad, second: f64) -> Quad {
    sum(times(a, first), times(b, second))
}

/// A box under construction: the hull of one body's parts, relative to the frame's origin (m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    low: Quad,
    high: Quad,
    reach: f64,
}

impl Hull {
    pub(crate) const EMPTY: Self = Self {
        low: [f64::INFINITY; 4],
        high: [f64::NEG_INFINITY; 4],
        reach: 0.0,
    };

    #[inline(always)]
    pub(crate) fn include(&mut self, part: &Part) {
        let [p0, p1, p2, p3] = part.points;
        let low = least(least(p0, p1), least(p2, p3));
        let high = most(most(p0, p1), most(p2, p3));
        self.low = least(self.low, sum(part.base, low));
        self.high = most(self.high, sum(part.base, high));
        if part.reach > self.reach {
            self.reach = part.reach;
        }
    }

    /// The clearance that contacts are seen within, m: of the parts' own sizes and of the
    /// distance of their origins, which is at most that of the hull's farther side and a reach.
    #[inline(always)]
    fn clearance(&self) -> f64 {
        let far = most(size(self.low), size(self.high));
        CLEARANCE * (24.0 * self.reach + 4.0 * (far[0] + far[1] + far[2])) + UNDERFLOW
    }

    /// The outward-rounded box in the frame's unit.
    #[inline(always)]
    pub(crate) fn inflated(&self, inflation: &Inflation, frame: &Frame) -> Aabb {
        let clearance = [self.clearance(); 4];
        let low = difference(sum(self.low, inflation.low), clearance);
        let high = sum(sum(self.high, inflation.high), clearance);
        let (low, high) = (
            representable(times(low, frame.power)),
            representable(times(high, frame.power)),
        );
        // Wider by two roundings to f32, so that rounding to the nearest is outward.
        Aabb::new(
            corner(difference(low, slack_of(low))),
            corner(sum(high, slack_of(high))),
        )
    }
}

/// Beyond the largest f32 only as far as is seen to be beyond it.
#[inline(always)]
fn representable(lanes: Quad) -> Quad {
    const BEYOND: f64 = 2.0 * f32::MAX as f64;
    least(most(lanes, [-BEYOND; 4]), [BEYOND; 4])
}

/// The nearest corner of finite numbers.
#[inline(always)]
fn corner(lanes: Quad) -> Vector {
    let finite = |lane: f64| nearest(lane).max(f32::MIN).min(f32::MAX);
    Vector::new(finite(lanes[0]), finite(lanes[1]), finite(lanes[2]))
}

/// Two roundings to f32 of each lane: of its size, or of the smallest normal number.
#[inline(always)]
fn slack_of(lanes: Quad) -> Quad {
    const TWO_ROUNDINGS: f64 = f32::EPSILON as f64;
    sum(
        times(size(lanes), TWO_ROUNDINGS),
        [f32::MIN_POSITIVE as f64; 4],
    )
}

/// A straight line through a slice of time, and how far a body strays from it, in the frame's unit.
///
/// At the share `s` of the slice, 0..=1, every sphere of the body with half the margin around it is
/// within `slack` of `start + s change`, what the exact solver's rounding can add included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    pub(crate) start: [f32; 3],
    pub(crate) change: [f32; 3],
    pub(crate) slack: f32,
    /// The cubic that the body follows first in the slice.
    pub(crate) first: u32,
}

/// A [`Course`] under construction (m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    start: Quad,
    change: Quad,
    /// Largest deviation on each axis.
    deviation: Quad,
    /// The slice: from when, and the inverse of its duration.
    from: f64,
    rate: f64,
}

impl Chord {
    /// From where one part begins to where another ends; any line would do, but this one is close.
    #[inline(always)]
    pub(crate) fn between(head: &Part, tail: &Part, (from, to): (f64, f64)) -> Self {
        let start = sum(head.points[0], head.base);
        let end = sum(tail.points[3], tail.base);
        let duration = to - from;
        Self {
            start,
            change: difference(end, start),
            deviation: [0.0; 4],
            from,
            // At a single instant the line is a point.
            rate: if duration > 0.0 { 1.0 / duration } else { 0.0 },
        }
    }

    /// Takes a part's deviation into account. The difference to the line is a cubic as well, whose
    /// control points are those differences at every third of the part.
    #[inline(always)]
    pub(crate) fn follow(&mut self, part: &Part) {
        let begin = (part.from - self.from) * self.rate;
        let third = (part.to - part.from) * self.rate * (1.0 / 3.0);
        let step = times(self.change, third);
        let offset = difference(sum(self.start, times(self.change, begin)), part.base);
        let [p0, p1, p2, p3] = part.points;
        let (one, two) = (sum(offset, step), sum(offset, times(step, 2.0)));
        let three = sum(offset, times(step, 3.0));
        let first = most(size(difference(p0, offset)), size(difference(p1, one)));
        let second = most(size(difference(p2, two)), size(difference(p3, three)));
        self.deviation = most(self.deviation, most(first, second));
    }

    /// The line for a body whose parts have this hull.
    #[inline(always)]
    pub(crate) fn course(
        &self,
        hull: &Hull,
        inflation: &Inflation,
        frame: &Frame,
        first: u32,
    ) -> Course {
        let [x, y, z, _] = self.deviation;
        // Scaled before it is squared: neither overflows nor vanishes.
        let [x, y, z] = [x * frame.power, y * frame.power, z * frame.power];
        let stray = (x * x + y * y + z * z).sqrt();
        let (start, change) = (
            times(self.start, frame.power),
            times(self.change, frame.power),
        );
        let rounding = sum(slack_of(start), slack_of(change));
        let around = (inflation.reach + hull.clearance()) * frame.power;
        let slack = (stray + around) * (1.0 + 2.0 * f64::from(f32::EPSILON))
            + 4.0 * (rounding[0] + rounding[1] + rounding[2]);
        Course {
            start: [nearest(start[0]), nearest(start[1]), nearest(start[2])],
            change: [nearest(change[0]), nearest(change[1]), nearest(change[2])],
            slack: nearest(slack),
            first,
        }
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "rounding to f32 is the purpose; callers round outward"
)]
#[inline(always)]
fn nearest(value: f64) -> f32 {
    value as f32
}
