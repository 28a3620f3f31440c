//! Where a body's sketch lies in the frame, and how much larger its box is.

use super::sketch::{Sketch, Stroke};
use super::track::Piece;
use super::{Frame, Inflation, ROUNDING, nearest};
use glam::{DVec3, Vec4};

/// Where a body's sketch lies in the frame, and how much larger its box is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose<'a> {
    strokes: &'a [Stroke],
    /// From the sketch's unit to the frame's.
    factor: f32,
    /// Of the sketch's middle in the frame.
    pub(super) place: Vec4,
    /// The same with the extremes of the hitbox.
    pub(super) low: Vec4,
    pub(super) high: Vec4,
    pub(super) reach: f32,
    /// Rounding that is the same for all boxes, in the frame's unit; infinite where the frame does
    /// not serve the body's coordinates. (It always does where it was chosen for all bodies.)
    pub(super) steady: f32,
}

impl<'a> Pose<'a> {
    pub(crate) fn new(sketch: &'a Sketch, inflation: &Inflation, frame: &Frame) -> Self {
        const FAR: f64 = 1e37;
        let lanes = |DVec3 { x, y, z }: DVec3| Vec4::new(nearest(x), nearest(y), nearest(z), 0.0);
        let place = lanes((sketch.frame.origin - frame.origin) * frame.power);
        let factor = frame.power / sketch.frame.power;
        let largest =
            f64::from(place.abs().max_element()) + sketch.size * factor + f64::from(inflation.size);
        let is_served = largest < FAR;
        Self {
            strokes: sketch.strokes(),
            // Nothing overflows on the way to a box that is everywhere.
            factor: if is_served { nearest(factor) } else { 0.0 },
            place: if is_served { place } else { Vec4::ZERO },
            low: place + inflation.low,
            high: place + inflation.high,
            reach: inflation.reach,
            steady: if is_served {
                8.0 * ROUNDING * inflation.size + f32::MIN_POSITIVE
            } else {
                f32::INFINITY
            },
        }
    }

    /// Largest distance from the body's position that its hitbox and half the margin reach, in the
    /// frame's unit.
    pub(crate) fn reach(&self) -> f64 {
        f64::from(self.reach)
    }

    pub(crate) const fn strokes(&self) -> &'a [Stroke] {
        self.strokes
    }

    /// A whole cubic, between its knots.
    #[inline(always)]
    pub(crate) fn piece(&self, number: usize, knots: (f64, f64)) -> Piece {
        Piece::whole(&self.strokes[number], knots, self.factor)
    }
}
