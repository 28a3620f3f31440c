//! The space that a body occupies around its position as it turns.

use crate::hitbox::{Hitbox, Sphere};
use crate::orientation::Turning;
use crate::rounding::sum_above;
use glam::DVec3;

/// A hitbox with the turning motion of its body, and the body's model error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyShape<'a> {
    hitbox: &'a Hitbox,
    /// `None` if turning changes nothing.
    turning: Option<&'a Turning>,
    /// [Model error](crate::Body::with_model_error) of the body, m.
    model_error: f64,
}

impl<'a> BodyShape<'a> {
    #[inline]
    pub(crate) fn new(hitbox: &'a Hitbox, turning: Option<&'a Turning>, model_error: f64) -> Self {
        Self {
            hitbox,
            // A sphere around the position does not change.
            turning: turning.filter(|_| hitbox.arm() > 0.0),
            model_error,
        }
    }

    #[inline]
    pub(crate) const fn model_error(&self) -> f64 {
        self.model_error
    }

    #[inline]
    pub(crate) const fn turning(&self) -> Option<&'a Turning> {
        self.turning
    }

    #[inline]
    pub(crate) const fn hitbox(&self) -> &'a Hitbox {
        self.hitbox
    }

    /// Returns true if the body [has long arms](Hitbox::has_long_arms), and turns.
    #[inline]
    pub(crate) fn has_long_arms(&self) -> bool {
        self.turning.is_some() && self.hitbox.has_long_arms()
    }

    /// Returns the spheres in the body's frame.
    #[inline]
    pub(crate) fn spheres(&self) -> &'a [Sphere] {
        self.hitbox.spheres()
    }

    /// Returns a sphere that contains all others at all times, those of a turning body enlarged by
    /// the error of their centres, and all by the model error; for a half-space its normal, with an
    /// infinite radius.
    #[inline]
    pub(crate) fn bounding(&self) -> Sphere {
        let Sphere { offset, radius } = match self.turning {
            None => self.hitbox.bounding_or_normal(),
            Some(turning) => Sphere {
                offset: DVec3::ZERO,
                radius: self.radius_of(turning),
            },
        };
        Sphere {
            offset,
            radius: self.enlarged(radius),
        }
    }

    /// Returns the corners of the box around all spheres at all times, enlarged by the model error
    /// (m).
    #[inline]
    pub(crate) fn corners(&self) -> (DVec3, DVec3) {
        let (low, high) = match self.turning {
            None => self.hitbox.corners(),
            Some(turning) => {
                let half = DVec3::splat(self.radius_of(turning));
                (-half, half)
            }
        };
        (low - self.model_error, high + self.model_error)
    }

    /// Returns the largest distance of the bounding sphere's points from the body's position, m.
    #[inline]
    pub(crate) fn reach(&self) -> f64 {
        self.enlarged(match self.turning {
            None => self.hitbox.reach(),
            Some(turning) => self.radius_of(turning),
        })
    }

    /// Returns a radius enlarged by the model error, rounded up.
    #[inline]
    fn enlarged(&self, radius: f64) -> f64 {
        if self.model_error > 0.0 {
            sum_above(radius, self.model_error)
        } else {
            radius
        }
    }

    /// Returns the smallest radius, m.
    #[inline]
    pub(crate) fn smallest_radius(&self) -> f64 {
        self.hitbox.smallest_radius()
    }

    pub(crate) const fn is_half_space(&self) -> bool {
        self.hitbox.is_half_space()
    }

    fn radius_of(&self, turning: &Turning) -> f64 {
        turning.reach(self.hitbox.radius_around_position(), self.hitbox.arm())
    }
}

impl<'a> From<&'a Hitbox> for BodyShape<'a> {
    fn from(hitbox: &'a Hitbox) -> Self {
        Self::new(hitbox, None, 0.0)
    }
}
