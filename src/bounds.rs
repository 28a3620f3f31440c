//! Boxes: the Bézier hull of a part of a trajectory, rounded outward to a parry3d `Aabb` (f32).
//!
//! A box contains every position from which the exact solver would report a contact, the solver's
//! own rounding included: it is inflated by the hitbox, half the margin and the clearance that
//! every filter keeps (see `rounding`).

use crate::hitbox::Sphere;
use crate::rounding::{CLEARANCE, norm, normalising_power};
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

    fn include_point(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
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

/// A box under construction, in the frame's f64 coordinates: hulls of one body's pieces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    extremes: Extremes,
    /// Largest size that rounding is relative to, over the pieces, m.
    scale: f64,
}

impl Hull {
    pub(crate) const EMPTY: Self = Self {
        extremes: Extremes::NOTHING,
        scale: 0.0,
    };

    /// Includes the part of a segment over `from..=to`.
    pub(crate) fn include(&mut self, segment: &Segment, (from, to): (f64, f64), frame: &Frame) {
        let base = segment.origin() - frame.origin;
        let [p0, p1, p2, p3] = segment.restrict(from, to).points;
        self.extremes
            .include_point(base + p0.min(p1).min(p2.min(p3)));
        self.extremes
            .include_point(base + p0.max(p1).max(p2.max(p3)));
        self.scale = self
            .scale
            .max(base.abs().element_sum() + segment.reach(from, to).max(segment.extent()));
    }

    /// The outward-rounded box.
    pub(crate) fn inflated(&self, inflation: &Inflation, frame: &Frame) -> Aabb {
        let pad = DVec3::splat(4.0 * CLEARANCE * (self.scale + inflation.size) + f64::MIN_POSITIVE);
        let low = (self.extremes.low + inflation.hitbox.low - pad) * frame.power;
        let high = (self.extremes.high + inflation.hitbox.high + pad) * frame.power;
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
