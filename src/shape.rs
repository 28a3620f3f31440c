//! The space that a body occupies around its position as it turns.

use crate::hitbox::{Hitbox, Sphere};
use crate::orientation::Turning;
use glam::DVec3;

/// A hitbox with the turning motion of its body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyShape<'a> {
    hitbox: &'a Hitbox,
    /// `None` if turning changes nothing.
    turning: Option<&'a Turning>,
}

impl<'a> BodyShape<'a> {
    #[inline]
    pub(crate) fn new(hitbox: &'a Hitbox, turning: Option<&'a Turning>) -> Self {
        Self {
            hitbox,
            // A sphere around the position does not change.
            turning: turning.filter(|_| hitbox.arm() > 0.0),
        }
    }

    #[inline]
    pub(crate) const fn turning(&self) -> Option<&'a Turning> {
        self.turning
    }

    /// Returns the spheres in the body's frame.
    #[inline]
    pub(crate) fn spheres(&self) -> &'a [Sphere] {
        self.hitbox.spheres()
    }

    /// Returns a sphere that contains all others at all times, those of a turning body enlarged by
    /// the error of their centres. Of a half-space its normal, with an infinite radius.
    #[inline]
    pub(crate) fn bounding(&self) -> Sphere {
        match self.turning {
            None => self.hitbox.bounding_or_normal(),
            Some(turning) => Sphere {
                offset: DVec3::ZERO,
                radius: self.radius_of(turning),
            },
        }
    }

    /// Returns the corners of the box around all spheres at all times (m).
    pub(crate) fn corners(&self) -> (DVec3, DVec3) {
        match self.turning {
            None => self.hitbox.corners(),
            Some(turning) => {
                let half = DVec3::splat(self.radius_of(turning));
                (-half, half)
            }
        }
    }

    /// Returns the largest distance of the bounding sphere's points from the body's position, m.
    pub(crate) fn reach(&self) -> f64 {
        match self.turning {
            None => self.hitbox.reach(),
            Some(turning) => self.radius_of(turning),
        }
    }

    /// Returns the smallest radius, m.
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
        Self::new(hitbox, None)
    }
}
