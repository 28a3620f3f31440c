//! Placement of a body's cubics in the frame.

use super::frame::{Frame, Padding};
use super::{FAR, ROUNDING, nearest, nearest_vector};
use glam::Vec4;

/// The transform from a body's cubics to the frame, and the padding of its boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FramePlacement {
    /// The origin of the cubics, in the frame's unit.
    pub(super) anchor: Frame,
    /// Ratio of the cubics' unit to the frame's.
    pub(super) factor: f32,
    /// Position of the anchor in the frame.
    pub(super) origin: Vec4,
    /// Position of the anchor, plus the extremes of the hitbox.
    pub(super) low: Vec4,
    pub(super) high: Vec4,
    pub(super) reach: f32,
    /// True if the body turns and has long arms.
    pub(super) has_long_arms: bool,
    /// Rounding that is the same in all of the body's boxes, in the frame's unit; infinite where the frame
    /// does not serve the body. A frame chosen for all bodies always does.
    pub(super) constant_rounding: f32,
}

impl FramePlacement {
    pub(super) const NONE: Self = Self {
        anchor: Frame::OF_NOTHING,
        factor: 1.0,
        origin: Vec4::ZERO,
        low: Vec4::ZERO,
        high: Vec4::ZERO,
        reach: 0.0,
        has_long_arms: false,
        constant_rounding: 0.0,
    };

    /// The placement of a body that the frame does not serve: leads to a box as large as `f32` allows.
    const ANYWHERE: Self = Self {
        factor: 0.0,
        constant_rounding: f32::INFINITY,
        ..Self::NONE
    };

    /// Returns the placement of cubics with coordinates up to `size`, as far as that is known.
    pub(super) fn new(anchor: Frame, size: f64, padding: &Padding, frame: &Frame) -> Self {
        let origin = nearest_vector((anchor.origin - frame.origin) * frame.power, 0.0);
        let factor = frame.power / anchor.power;
        let largest =
            f64::from(origin.abs().max_element()) + size * factor + f64::from(padding.size);
        if largest.is_nan() || largest >= FAR {
            return Self::ANYWHERE;
        }
        // The factor exceeds the range of f32 only if all coordinates are zero.
        let factor = nearest(factor).min(f32::MAX);
        Self {
            anchor: Frame {
                power: frame.power,
                ..anchor
            },
            factor,
            origin,
            low: origin + padding.low,
            high: origin + padding.high,
            reach: padding.reach,
            has_long_arms: padding.has_long_arms,
            // What underflows on either side of the factor is below a smallest normal number.
            constant_rounding: 8.0 * ROUNDING * padding.size + f32::MIN_POSITIVE * factor.max(1.0),
        }
    }

    /// Returns the placement of motions whose coordinates are those of the frame.
    #[inline]
    pub(super) fn of_frame(padding: &Padding, frame: &Frame) -> Self {
        if padding.size.is_nan() || f64::from(padding.size) >= FAR {
            return Self::ANYWHERE;
        }
        Self {
            anchor: *frame,
            factor: 1.0,
            origin: Vec4::ZERO,
            low: padding.low,
            high: padding.high,
            reach: padding.reach,
            has_long_arms: padding.has_long_arms,
            constant_rounding: 8.0 * ROUNDING * padding.size + f32::MIN_POSITIVE,
        }
    }

    /// Returns the largest distance from the body's position to the surface of its hitbox, half the
    /// margin included, in the frame's unit.
    pub(crate) fn reach(&self) -> f64 {
        f64::from(self.reach)
    }
}
