//! Boxes: the Bézier hull of a part of a trajectory, rounded outward to a parry3d `Aabb` (f32).
//!
//! A box contains every position from which the exact solver would report a contact, the solver's
//! own rounding included: it is inflated by the hitbox, half the margin and the clearance that
//! every filter keeps (see `rounding`).

use crate::hitbox::Sphere;
use crate::rounding::{CLEARANCE, norm, normalising_power};
use crate::trajectory::Segment;
use glam::{DVec3, Vec3A};
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
    /// Extremes of the hitbox in the body's frame, half the margin included.
    hitbox: Extremes,
    /// Its size, which its rounding is relative to.
    size: f64,
}

impl Inflation {
    pub(crate) fn of(spheres: &[Sphere], margin: f64) -> Self {
        let mut hitbox = Extremes::NOTHING;
        for sphere in spheres {
            // Never inverted: a negative margin that swallows one body's radius leaves a point,
            // and the other body's box is then at worst too large.
            let reach = DVec3::splat((sphere.radius + 0.5 * margin).max(0.0));
            hitbox.include(Extremes {
                low: sphere.offset - reach,
                high: sphere.offset + reach,
            });
        }
        let size = norm(hitbox.low.abs().max(hitbox.high.abs())) + margin.abs();
        Self { hitbox, size }
    }

    /// Largest distance from the body's position that it adds, m.
    pub(crate) const fn size(&self) -> f64 {
        self.size
    }
}

/// The part of a segment that is still to be boxed, in f32 relative to the segment's origin, in the
/// frame's unit.
///
/// Relative to the origin f32 is fine enough: its error is a share of the segment's own extent,
/// wherever the segment lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    points: [Vec3A; 4],
    from: f64,
    to: f64,
    /// Position of the origin in the frame.
    base: DVec3,
    /// How much rounding can have moved the points.
    error: f64,
}

/// Roundings of f32, of the segment's reach, that a part's points can carry: one from the
/// conversion and 9 from each of the splits before it (three levels of two weights and a sum).
const PART_ERROR: f64 = (1.0 + 9.0 * MOST_SPLITS as f64) * (f32::EPSILON as f64 / 2.0) * 1.01;

/// How often a part may be split.
pub(crate) const MOST_SPLITS: u32 = 8;

impl Part {
    /// The part of a segment over `from..=to`.
    pub(crate) fn of(segment: &Segment, (from, to): (f64, f64), frame: &Frame) -> Self {
        let base = (segment.origin() - frame.origin) * frame.power;
        let reach = segment.reach(from, to).max(segment.extent()) * frame.power;
        let scale = segment.rounding_scale(from, to).max(segment.extent()) * frame.power;
        let points = segment.restrict(from, to).points;
        Self {
            points: points.map(|point| (point * frame.power).as_vec3a()),
            from,
            to,
            base,
            error: PART_ERROR * reach
                + 4.0 * CLEARANCE * (scale + base.abs().element_sum())
                + f64::from(f32::MIN_POSITIVE),
        }
    }

    /// Last instant, s.
    pub(crate) const fn end(&self) -> f64 {
        self.to
    }

    /// Splits off what lies before `cut`, by de Casteljau; the rest stays.
    pub(crate) fn split_off(&mut self, cut: f64) -> Self {
        let duration = self.to - self.from;
        let (first, second) = (
            nearest((self.to - cut) / duration),
            nearest((cut - self.from) / duration),
        );
        let mix = |x: Vec3A, y: Vec3A| x * first + y * second;
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

/// A box under construction, in the frame's coordinates and unit: hulls of one body's parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    extremes: Extremes,
}

impl Hull {
    pub(crate) const EMPTY: Self = Self {
        extremes: Extremes::NOTHING,
    };

    /// Includes a part, its rounding included.
    pub(crate) fn include(&mut self, part: &Part) {
        let [p0, p1, p2, p3] = part.points;
        let low = p0.min(p1).min(p2.min(p3)).as_dvec3();
        let high = p0.max(p1).max(p2.max(p3)).as_dvec3();
        self.extremes.include(Extremes {
            low: part.base + low - part.error,
            high: part.base + high + part.error,
        });
    }

    /// The outward-rounded box.
    pub(crate) fn inflated(&self, inflation: &Inflation, frame: &Frame) -> Aabb {
        let pad = DVec3::splat(4.0 * CLEARANCE * inflation.size);
        let low = self.extremes.low + (inflation.hitbox.low - pad) * frame.power;
        let high = self.extremes.high + (inflation.hitbox.high + pad) * frame.power;
        Aabb::new(
            Vector::from(low.to_array().map(below)),
            Vector::from(high.to_array().map(above)),
        )
    }
}

/// An f32 that is certainly not above `value`.
fn below(value: f64) -> f32 {
    nearest(value).next_down().max(f32::MIN)
}

/// An f32 that is certainly not below `value`.
fn above(value: f64) -> f32 {
    nearest(value).next_up().min(f32::MAX)
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "rounding to f32 is the purpose; callers round outward"
)]
fn nearest(value: f64) -> f32 {
    value as f32
}
