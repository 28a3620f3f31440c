//! A box with rounded edges that contains the spheres of a body and turns with it.
//!
//! In a short step of time its centre and its axes change along straight lines, but for a bound of second order: half the
//! square of the angle, times the distance from the body's position.

use crate::hitbox::Hitbox;
use crate::orientation::SteadyTurn;
use glam::{DMat3, DVec3};

/// The box in a step.
pub(crate) struct TurningBox {
    /// Its centre, relative to the body's position, in the middle of the step, and the velocity of that.
    pub(crate) centre: DVec3,
    pub(crate) rate: DVec3,
    /// Half of its inner edges, m, as vectors.
    pub(crate) axes: DMat3,
    /// rad/s.
    pub(crate) angular_velocity: DVec3,
    /// Radius of the edges, and what is of second order; errors included, m.
    pub(crate) radius: f64,
}

impl TurningBox {
    /// Largest angle of a step from its middle on, rad.
    pub(crate) const WIDE: f64 = 0.6;

    /// Returns the box in a step around its middle (s), up to so long before and after it (s). Without a turn it rests.
    #[inline(always)]
    pub(crate) fn of(
        hitbox: &Hitbox,
        model_error: f64,
        turn: Option<&SteadyTurn<'_>>,
        (middle, after): (f64, f64),
    ) -> Self {
        let ((low, high), smallest) = (hitbox.corners(), hitbox.smallest_radius());
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5 - smallest);
        let radius = smallest + model_error;
        let Some(turn) = turn else {
            return Self::resting((centre, half), radius);
        };
        let rotation = turn.matrix(middle);
        let angular_velocity = turn.velocity();
        let centre = rotation * centre;
        Self {
            centre,
            rate: angular_velocity.cross(centre),
            axes: DMat3::from_cols(
                rotation.x_axis * half.x,
                rotation.y_axis * half.y,
                rotation.z_axis * half.z,
            ),
            angular_velocity,
            // A sphere's centre is so far from where the linear motion takes it.
            radius: radius + hitbox.arm() * (turn.bend(after) + turn.error),
        }
    }

    /// Returns a box at rest with its centre and half of its inner edges, m.
    pub(crate) fn resting((centre, half): (DVec3, DVec3), radius: f64) -> Self {
        Self {
            centre,
            rate: DVec3::ZERO,
            axes: DMat3::from_diagonal(half),
            angular_velocity: DVec3::ZERO,
            radius,
        }
    }
}
