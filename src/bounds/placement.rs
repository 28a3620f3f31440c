//! The place of a body's cubics in the frame, and what is the same for all its boxes.

use super::frame::{Frame, Padding};
use super::{FAR, ROUNDING, nearest};
use glam::{DVec3, Vec4};

/// Where a body's cubics are measured from, and how much larger than their hull its boxes are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FramePlacement {
    /// What the cubics are relative to, in the frame's unit.
    pub(super) anchor: Frame,
    /// From the unit of those that are drawn to the frame's.
    pub(super) factor: f32,
    /// Of the anchor in the frame.
    pub(super) place: Vec4,
    /// The same with the extremes of the hitbox.
    pub(super) low: Vec4,
    pub(super) high: Vec4,
    pub(super) reach: f32,
    /// Rounding that is the same for all boxes, in the frame's unit; infinite where the frame does
    /// not serve the body's coordinates. (It always does where it was chosen for all bodies.)
    pub(super) steady: f32,
}

impl FramePlacement {
    pub(super) const NONE: Self = Self {
        anchor: Frame::OF_NOTHING,
        factor: 1.0,
        place: Vec4::ZERO,
        low: Vec4::ZERO,
        high: Vec4::ZERO,
        reach: 0.0,
        steady: 0.0,
    };

    /// Of a body whose coordinates the frame does not serve. Nothing overflows on the way to a box
    /// that is everywhere.
    const ANYWHERE: Self = Self {
        factor: 0.0,
        steady: f32::INFINITY,
        ..Self::NONE
    };

    /// Of cubics no coordinate of which is larger than `size`, as far as that is known.
    pub(super) fn new(anchor: Frame, size: f64, padding: &Padding, frame: &Frame) -> Self {
        let lanes = |DVec3 { x, y, z }: DVec3| Vec4::new(nearest(x), nearest(y), nearest(z), 0.0);
        let place = lanes((anchor.origin - frame.origin) * frame.power);
        let factor = frame.power / anchor.power;
        let largest =
            f64::from(place.abs().max_element()) + size * factor + f64::from(padding.size);
        if largest.is_nan() || largest >= FAR {
            return Self::ANYWHERE;
        }
        // Too large only where all coordinates are zero.
        let factor = nearest(factor).min(f32::MAX);
        Self {
            anchor: Frame {
                power: frame.power,
                ..anchor
            },
            factor,
            place,
            low: place + padding.low,
            high: place + padding.high,
            reach: padding.reach,
            // What underflows on either side of the factor is below a smallest normal number.
            steady: 8.0 * ROUNDING * padding.size + f32::MIN_POSITIVE * factor.max(1.0),
        }
    }

    /// Largest distance from the body's position that its hitbox and half the margin reach, in the
    /// frame's unit.
    pub(crate) fn reach(&self) -> f64 {
        f64::from(self.reach)
    }
}
