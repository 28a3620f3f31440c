//! Frames of f32 coordinates, and the padding of boxes.

use super::slice_interval::SliceInterval;
use super::{nearest, nearest_vector};
use crate::rounding::scale_to_one;
use crate::shape::BodyShape;
use glam::{DVec3, Vec4};
use std::ops::{Deref, Range};

/// Origin and unit (a power of two) of f32 coordinates.
///
/// Far from the origin f32 coordinates lose precision, and beyond 3e38 they overflow. An origin near
/// most of the bodies, and a unit that suits the extent of the scene, avoid both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// m.
    pub(super) origin: DVec3,
    /// Units in a metre: a power of two.
    pub(super) power: f64,
}

/// A frame whose boxes move. Only relative motion matters to a pair. In a slice, a box bounds its
/// body relative to a point that moves with the common velocity of the bodies from the slice's
/// start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MovingFrame {
    frame: Frame,
    velocity: DVec3,
}

impl MovingFrame {
    /// Returns the common velocity, m/s.
    pub(crate) const fn velocity(&self) -> DVec3 {
        self.velocity
    }

    pub(crate) fn moves(&self) -> bool {
        self.velocity != DVec3::ZERO
    }

    /// Returns the frame with another origin, given in this frame, whose boxes move by `displacement` in an interval (s). Its
    /// unit is the same.
    pub(crate) fn placed_at(
        &self,
        origin: DVec3,
        displacement: DVec3,
        (from, to): (f64, f64),
    ) -> Self {
        let frame = Frame {
            origin: self.frame.origin + origin / self.frame.power,
            ..self.frame
        };
        let velocity = displacement / self.frame.power / (to - from);
        frame.moving(if velocity.is_finite() {
            velocity
        } else {
            DVec3::ZERO
        })
    }

    /// Returns a slice interval with the displacement of its boxes.
    pub(crate) fn slice_interval(&self, from: f64, to: f64) -> SliceInterval<true> {
        let displacement = self.velocity * ((to - from) * self.frame.power);
        SliceInterval::new(from, to).moving(displacement)
    }
}

impl Deref for MovingFrame {
    type Target = Frame;

    fn deref(&self) -> &Frame {
        &self.frame
    }
}

/// A box in f64, in the scene's own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DAabb {
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
}

impl DAabb {
    pub(crate) const NOTHING: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };

    /// Returns the box that is a point.
    pub(crate) const fn of_point(point: DVec3) -> Self {
        Self {
            low: point,
            high: point,
        }
    }

    #[inline]
    pub(crate) fn include(&mut self, other: Self) {
        self.low = smaller(self.low, other.low);
        self.high = larger(self.high, other.high);
    }

    /// Returns the range of the middle half of `positions` on each axis, which ignores outliers.
    pub(crate) fn of_middle_half(positions: &mut [DVec3]) -> Self {
        let mut middle = Self::NOTHING;
        let Some(last) = positions.len().checked_sub(1) else {
            return middle;
        };
        let quarter = positions.len() / 4;
        for axis in 0..3 {
            positions.sort_unstable_by(|x, y| x[axis].total_cmp(&y[axis]));
            middle.low[axis] = positions[quarter][axis];
            middle.high[axis] = positions[last - quarter][axis];
        }
        middle
    }

    fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    pub(crate) fn middle(&self) -> DVec3 {
        self.low * 0.5 + self.high * 0.5
    }

    /// Returns the box within `reach` of a position (m), for choosing a frame: not rounded outward.
    pub(super) fn about(position: DVec3, reach: f64) -> Self {
        Self {
            low: position - reach,
            high: position + reach,
        }
    }
}

/// Returns the smaller coordinates; the first ones where the others are NaN.
#[inline(always)]
fn smaller(one: DVec3, other: DVec3) -> DVec3 {
    let smaller = |one: f64, other: f64| if other < one { other } else { one };
    DVec3::new(
        smaller(one.x, other.x),
        smaller(one.y, other.y),
        smaller(one.z, other.z),
    )
}

/// Returns the larger coordinates; the first ones where the others are NaN.
///
/// The minimum and maximum of f64 take four instructions where this takes one.
#[inline(always)]
fn larger(one: DVec3, other: DVec3) -> DVec3 {
    let larger = |one: f64, other: f64| if other > one { other } else { one };
    DVec3::new(
        larger(one.x, other.x),
        larger(one.y, other.y),
        larger(one.z, other.z),
    )
}

impl Frame {
    pub(super) const OF_NOTHING: Self = Self {
        origin: DVec3::ZERO,
        power: 1.0,
    };

    /// Returns a frame for positions within a box (m), and boxes that exceed them by up to `padding` (m). Its origin
    /// is the middle of the box.
    pub(crate) fn around(extremes: DAabb, padding: f64) -> Self {
        Self::amid(extremes, extremes, padding)
    }

    /// Returns a frame for positions within `world`, and boxes that exceed them by up to `padding` (m). `most` is a box
    /// around most of the positions. The origin lies near these, where f32 is finest: a few outliers then cost
    /// the other bodies no precision.
    pub(crate) fn amid(world: DAabb, most: DAabb, padding: f64) -> Self {
        if !world.is_finite() {
            return Self::OF_NOTHING;
        }
        /// Half extents that f32 serves in metres (m): with room beyond, up to [`FAR`](super::FAR).
        const USUAL: Range<f64> = 1e-10..1e30;
        let (origin, half_of_most) = middle(world, most, padding);
        let half = (world.high - origin).max(origin - world.low);
        let half = half.max_element() + padding;
        // A few outliers that f32 does not serve then have boxes that meet all others.
        let is_served = half <= 0.0 || USUAL.contains(&half);
        let power = if is_served || half >= USUAL.end && USUAL.contains(&half_of_most) {
            1.0
        } else {
            scale_to_one(half)
        };
        Self { origin, power }
    }

    /// Returns the frame with boxes that move with a velocity (m/s).
    pub(crate) const fn moving(self, velocity: DVec3) -> MovingFrame {
        MovingFrame {
            frame: self,
            velocity,
        }
    }

    /// Returns true if this frame serves positions about as well as a new one from
    /// [`amid`](Self::amid), given the same arguments.
    pub(crate) fn suits(&self, world: DAabb, most: DAabb, padding: f64) -> bool {
        /// Largest ratio of the units of both frames, either way: the exponents of f32 leave room for it.
        const MANY: f64 = 65536.0;
        if !world.is_finite() {
            return true;
        }
        let best = Self::amid(world, most, padding);
        let (_, half) = middle(world, most, padding);
        let away = (best.origin - self.origin).abs().max_element();
        (1.0 / MANY..=MANY).contains(&(self.power / best.power)) && away <= FEW * half
    }
}

/// Largest distance of the origin from the middle of most positions, in half extents of these: sixteen cost f32 four
/// bits.
const FEW: f64 = 16.0;

/// Returns the origin of a frame [amid](Frame::amid) a world, and the half extent of the box around most of it, m.
fn middle(world: DAabb, most: DAabb, padding: f64) -> (DVec3, f64) {
    let origin = world.middle();
    let half_of = |part: &DAabb| (part.high - part.middle()).max_element() + padding;
    let (half, half_of_most) = (half_of(&world), half_of(&most));
    let away = (origin - most.middle()).abs().max_element();
    // Nothing is gained where most are in one place, and that is the middle.
    if most.is_finite() && away > FEW * half_of_most {
        (most.middle(), half_of_most)
    } else {
        (origin, half)
    }
}

/// The excess of a body's box over its hull, in the frame's unit. The fourth lane is unused.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Padding {
    /// Extremes of the hitbox in the body's frame, half the margin included.
    pub(super) low: Vec4,
    pub(super) high: Vec4,
    /// Largest distance from the body's position within bounding sphere and half the margin.
    pub(super) reach: f32,
    /// True if the body turns and has long arms.
    pub(super) has_long_arms: bool,
    /// The magnitude to which the rounding of the padding is relative.
    pub(super) size: f32,
}

impl Padding {
    pub(crate) const NONE: Self = Self {
        low: Vec4::ZERO,
        high: Vec4::ZERO,
        reach: 0.0,
        has_long_arms: false,
        size: 0.0,
    };

    /// Returns the padding by a body's shape and half a margin (m), in a frame's unit.
    #[inline(always)]
    pub(crate) fn of<'a>(shape: impl Into<BodyShape<'a>>, margin: f64, frame: &Frame) -> Self {
        let shape = shape.into();
        let mut half = 0.5 * margin;
        // A margin that swallows one body's radius leaves a point; the other body's box is then at worst
        // too large.
        if half < 0.0 {
            half = half.max(-shape.smallest_radius());
        }
        let (low, high) = shape.corners();
        Self {
            low: nearest_vector((low - half) * frame.power, 0.0),
            high: nearest_vector((high + half) * frame.power, 0.0),
            reach: nearest((shape.reach() + half) * frame.power),
            has_long_arms: shape.has_long_arms(),
            size: nearest(Self::size(shape, margin) * frame.power),
        }
    }

    /// Returns the largest distance from the body's position within bounding sphere and half the margin, in the frame's unit.
    pub(crate) const fn reach(&self) -> f32 {
        self.reach
    }

    /// Returns true if the body turns and has long arms.
    pub(crate) const fn has_long_arms(&self) -> bool {
        self.has_long_arms
    }

    /// Returns a bound on the padding, m, that is not reduced by cancellation.
    #[inline]
    pub(crate) fn size<'a>(shape: impl Into<BodyShape<'a>>, margin: f64) -> f64 {
        shape.into().reach() + margin.abs()
    }
}
