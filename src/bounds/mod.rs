//! Boxes: the Bézier hull of a part of a trajectory, rounded outward to a parry3d `Aabb` (f32).
//!
//! A box contains every position from which the exact solver would report a contact, the solver's
//! own rounding included: it is inflated by the hitbox, half the margin and the clearance that
//! every filter keeps (see `rounding`). A [`Course`] says the same more closely: a straight line,
//! and how far from it.
//!
//! Computed in f32 relative to an anchor near the body, so that rounding is a share of how far the
//! body comes in a few slices, wherever in the world it is. That rounding is accounted for with
//! more than a hundred units of 2^-24; next to it the clearance of filters, 2^-44, is nothing.

mod course;

pub(crate) use course::{Chord, Course};

use crate::hitbox::Sphere;

use crate::rounding::{norm, normalising_power};
use crate::trajectory::Segment;
use glam::{DVec3, Vec4};
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

/// How much larger than its hull a body's box is, in the frame's unit. (Of four lanes, the last
/// holds nothing of use, here and in what follows.)
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inflation {
    /// Extremes of the hitbox in the body's frame, half the margin included.
    low: Vec4,
    high: Vec4,
    /// Largest distance from the body's position that the bounding sphere and half the margin
    /// reach.
    reach: f32,
    /// What the rounding of these is relative to.
    size: f32,
}

impl Inflation {
    /// Of a point without a margin.
    pub(crate) const NONE: Self = Self {
        low: Vec4::ZERO,
        high: Vec4::ZERO,
        reach: 0.0,
        size: 0.0,
    };

    /// Of a hitbox and its bounding sphere (m).
    pub(crate) fn of(spheres: &[Sphere], bounding: Sphere, margin: f64, frame: &Frame) -> Self {
        let mut hitbox = Extremes::NOTHING;
        for sphere in spheres {
            let reach = half_size(sphere, margin);
            hitbox.include(Extremes {
                low: sphere.offset - reach,
                high: sphere.offset + reach,
            });
        }
        let lanes = |DVec3 { x, y, z }: DVec3| scaled([x, y, z, 0.0], frame.power);
        let reach = norm(bounding.offset) + half_size(&bounding, margin);
        Self {
            low: lanes(hitbox.low),
            high: lanes(hitbox.high),
            reach: nearest(reach * frame.power),
            size: nearest(Self::size(spheres, bounding, margin) * frame.power),
        }
    }

    /// Largest distance from the body's position that it adds, in the frame's unit.
    pub(crate) fn reach(&self) -> f64 {
        f64::from(self.reach)
    }

    /// Largest distance from the body's position that it adds, and more where numbers cancel, m.
    pub(crate) fn size(spheres: &[Sphere], bounding: Sphere, margin: f64) -> f64 {
        let largest = |sphere: &Sphere| norm(sphere.offset) + sphere.radius;
        spheres
            .iter()
            .map(largest)
            .fold(largest(&bounding), f64::max)
            + margin.abs()
    }
}

/// The radius and half the margin. Never negative: a margin that swallows one body's radius leaves
/// a point, and the other body's box is then at worst too large.
fn half_size(sphere: &Sphere, margin: f64) -> f64 {
    (sphere.radius + 0.5 * margin).max(0.0)
}

/// What a body's coordinates are relative to for a few slices: a position near it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Anchor {
    position: [f64; 4],
    power: f64,
    /// The position in the frame and its unit, rounded to the nearest.
    place: Vec4,
}

impl Anchor {
    /// At the origin of a segment.
    #[inline(always)]
    pub(crate) fn at(segment: &Segment, frame: &Frame) -> Self {
        let position = segment.lanes()[0];
        let DVec3 { x, y, z } = frame.origin;
        Self {
            position,
            power: frame.power,
            place: scaled(difference(position, [x, y, z, 0.0]), frame.power),
        }
    }

    /// A position relative to the anchor, in the frame's unit.
    #[inline(always)]
    fn offset(&self, position: [f64; 4]) -> Vec4 {
        self.scaled(difference(position, self.position))
    }

    /// A vector in the frame's unit.
    #[inline(always)]
    fn scaled(&self, vector: [f64; 4]) -> Vec4 {
        scaled(vector, self.power)
    }
}

/// A part of a cubic, as control points relative to an anchor, in the frame's unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    points: [Vec4; 4],
    /// What the rounding of the points is relative to on each axis: none of the segment is farther
    /// away; more where the segment itself is known less well than f32 could tell.
    size: Vec4,
    from: f64,
    to: f64,
}

/// How often a part may be split: each time rounds its points 9 times more (three levels of two
/// weights and a sum).
pub(crate) const MOST_SPLITS: u32 = 9;

impl Part {
    /// Roundings of the size that the points can carry: from the conversion, all splits, and
    /// some more than what follows until a box or a course is made.
    const ROUNDINGS: f32 = 3.0 + 9.0 * MOST_SPLITS as f32 + 36.0;

    /// The part of a segment over `from..=to`, within its knots or not.
    pub(crate) fn of(segment: &Segment, (from, to): (f64, f64), anchor: &Anchor) -> Self {
        let reach = segment.reach(from, to).max(segment.extent())
            + segment.own_error(from, to) / f64::from(ROUNDING);
        let points = segment.restrict(from, to).points;
        let offset = anchor.offset(segment.lanes()[0]);
        Self {
            points: points.map(|point| offset + anchor.scaled([point.x, point.y, point.z, 0.0])),
            size: offset.abs() + Vec4::splat(nearest(reach * anchor.power)),
            from,
            to,
        }
    }

    /// A whole segment.
    #[inline(always)]
    pub(crate) fn whole(segment: &Segment, anchor: &Anchor) -> Self {
        let [origin, first, second, third] = segment.lanes();
        let offset = anchor.offset(origin);
        let size = segment.extent() + segment.error() / f64::from(ROUNDING);
        Self {
            points: [
                offset,
                offset + anchor.scaled(first),
                offset + anchor.scaled(second),
                offset + anchor.scaled(third),
            ],
            size: offset.abs() + Vec4::splat(nearest(size * anchor.power)),
            from: segment.start(),
            to: segment.end(),
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
        let rate = 1.0 / (self.to - self.from);
        let first = Vec4::splat(nearest((self.to - cut) * rate));
        let second = Vec4::splat(nearest((cut - self.from) * rate));
        let mix = |x: Vec4, y: Vec4| x * first + y * second;
        let [p0, p1, p2, p3] = self.points;
        let (q0, q1, q2) = (mix(p0, p1), mix(p1, p2), mix(p2, p3));
        let (r0, r1) = (mix(q0, q1), mix(q1, q2));
        let middle = mix(r0, r1);
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

/// A box under construction: the hull of one body's parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    low: Vec4,
    high: Vec4,
    size: Vec4,
}

impl Hull {
    pub(crate) const EMPTY: Self = Self {
        low: Vec4::INFINITY,
        high: Vec4::NEG_INFINITY,
        size: Vec4::ZERO,
    };

    #[inline(always)]
    pub(crate) fn include(&mut self, part: &Part) {
        let [p0, p1, p2, p3] = part.points;
        self.low = self.low.min(p0.min(p1).min(p2.min(p3)));
        self.high = self.high.max(p0.max(p1).max(p2.max(p3)));
        self.size = self.size.max(part.size);
    }

    /// How far rounding can have moved each coordinate, in the frame's unit.
    #[inline(always)]
    fn rounding(&self, inflation: &Inflation) -> Vec4 {
        self.size * (ROUNDING * Part::ROUNDINGS)
            + Vec4::splat(8.0 * ROUNDING * inflation.size + f32::MIN_POSITIVE)
    }

    /// Whether a body is where the frame serves its coordinates: it always is where the frame was
    /// chosen for all bodies.
    #[inline(always)]
    fn is_served(&self, inflation: &Inflation, anchor: &Anchor) -> bool {
        const FAR: f32 = 1e37;
        let far = self.size + anchor.place.abs() + Vec4::splat(inflation.size);
        // Not so for NaN.
        (far.x < FAR) & (far.y < FAR) & (far.z < FAR)
    }

    /// The outward-rounded box in the frame's unit; everywhere, where the frame does not serve.
    #[inline(always)]
    pub(crate) fn inflated(&self, inflation: &Inflation, anchor: &Anchor) -> Aabb {
        if !self.is_served(inflation, anchor) {
            return Aabb::new(Vector::splat(f32::MIN), Vector::splat(f32::MAX));
        }
        // Of the anchor, of the sum with it, and of the subtraction below.
        let rounding = self.rounding(inflation) + anchor.place.abs() * (4.0 * ROUNDING);
        let low = anchor.place + (self.low + inflation.low) - rounding;
        let high = anchor.place + (self.high + inflation.high) + rounding;
        Aabb::new(
            Vector::new(low.x, low.y, low.z),
            Vector::new(high.x, high.y, high.z),
        )
    }
}

/// Half a unit in the last place of f32, relative.
const ROUNDING: f32 = 0.5 * f32::EPSILON;

#[inline(always)]
fn difference(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// The nearest f32 vector in another unit.
#[inline(always)]
fn scaled(vector: [f64; 4], power: f64) -> Vec4 {
    Vec4::new(
        nearest(vector[0] * power),
        nearest(vector[1] * power),
        nearest(vector[2] * power),
        nearest(vector[3] * power),
    )
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "rounding to f32 is the purpose; callers round outward"
)]
#[inline(always)]
fn nearest(value: f64) -> f32 {
    value as f32
}
