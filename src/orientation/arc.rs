//! Rotations about a fixed axis at a constant rate.

use super::baked::BakedRotation;
use super::quaternion_cubic::matrix;
use crate::rounding::{UNIT_ROUNDOFF, norm};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// Largest angular speed, rad/s: more than 150,000 revolutions per second.
pub(super) const MAX_SPEED: f64 = 1e6;

/// A rotation about a fixed axis at a constant rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    /// Instant of `rotation`, s.
    pub(super) time: f64,
    /// Unit of time, s.
    pub(super) duration: f64,
    /// Unit quaternion.
    pub(super) rotation: DQuat,
    /// Unit vector in the world's axes.
    pub(super) axis: DVec3,
    /// Angle per unit of time, rad, at least 0.
    pub(super) angle: f64,
    /// Rounding, relative to a point's distance: a constant part, and one per unit of time.
    pub(super) rounding: f64,
    pub(super) drift: f64,
}

impl Arc {
    /// Returns a rotation that is held.
    pub(super) const fn held(rotation: DQuat) -> Self {
        Self {
            time: 0.0,
            duration: 1.0,
            rotation,
            axis: DVec3::X,
            angle: 0.0,
            rounding: BakedRotation::ROUNDING,
            drift: 0.0,
        }
    }

    /// Returns the constant angular velocity (rad/s) from a rotation at an instant (s).
    pub(super) fn spin(time: f64, rotation: DQuat, angular_velocity: DVec3) -> Self {
        let angle = norm(angular_velocity);
        if angle < f64::MIN_POSITIVE {
            return Self::held(rotation);
        }
        Self {
            time,
            axis: angular_velocity / angle,
            angle,
            // The angle has 7 roundings.
            drift: 16.0 * UNIT_ROUNDOFF * angle,
            ..Self::held(rotation)
        }
    }

    /// Returns the shorter way from one unit quaternion to another, of the same sign, between two
    /// instants (s).
    pub(super) fn between((start, end): (f64, f64), from: DQuat, to: DQuat) -> Self {
        let turn = to * from.conjugate();
        let vector = DVec3::new(turn.x, turn.y, turn.z);
        let sine = vector.length();
        let still = Self {
            time: start,
            duration: end - start,
            ..Self::held(from)
        };
        if sine < f64::MIN_POSITIVE {
            return still;
        }
        Self {
            axis: vector / sine,
            angle: 2.0 * libm::atan2(sine, turn.w),
            ..still
        }
    }

    /// Returns the motion that goes on at this rate from an instant (s) at which it has this
    /// rotation. A rate that is rounded to nothing may be none, so that the rotation is known less and less.
    pub(super) fn going_on(&self, time: f64, rotation: DQuat) -> Self {
        // Per unit of time, the angle is known to 64 roundings, and takes 13 more. Rotations by one angle
        // differ by at most that angle times the angle between their axes. An axis is known to 25 roundings
        // over the sine of half the angle, which is at least the angle over pi; that of a cubic's end to 64
        // over the angle. So it adds 79 at most.
        Self {
            time,
            rotation,
            drift: 256.0 * UNIT_ROUNDOFF,
            ..*self
        }
    }

    pub(super) fn is_held(&self) -> bool {
        self.angle <= 0.0 && self.drift <= 0.0
    }

    /// Returns the duration (s) in which rounding takes up a quarter of a tolerance; may be infinite.
    pub(super) fn known_for(&self, tolerance: f64) -> f64 {
        0.25 * tolerance / self.drift * self.duration
    }

    /// Returns the rotation at an instant (s).
    pub(super) fn at(&self, time: f64) -> DQuat {
        if self.is_held() {
            return self.rotation;
        }
        let half = 0.5 * (self.angle * ((time - self.time) / self.duration));
        if !half.is_finite() {
            // Nothing is known of the angle: any rotation is as good.
            return self.rotation;
        }
        let (sine, cosine) = libm::sincos(half);
        let DVec3 { x, y, z } = self.axis * sine;
        DQuat::from_xyzw(x, y, z, cosine) * self.rotation
    }

    /// Returns the error of a cubic over an angle (rad) that ends so many units of time from the instant of `rotation`.
    fn error(&self, angle: f64, away: f64) -> f64 {
        interpolation_error(angle) + self.rounding + self.drift * away
    }

    /// Returns true if all cubics of a duration (s), or of less, that meet an interval (s) have at most this error.
    pub(super) fn is_known(&self, (from, to): (f64, f64), duration: f64, largest: f64) -> bool {
        let away = (from - self.time).abs().max((to - self.time).abs()) + duration;
        // Their ends, and this, have a few roundings.
        let [angle, away] =
            [self.angle * duration, away].map(|one| one / self.duration * (1.0 + 1e-9));
        self.error(angle, away) <= largest
    }

    /// Returns the angular speed, rad/s.
    pub(super) fn speed(&self) -> f64 {
        self.angle / self.duration
    }

    /// Returns the cubic between two instants (s), or the one of an unknown rotation where its
    /// error would exceed `largest`.
    ///
    /// Cubic Hermite interpolation of a circle of radius r over an angle a is wrong by at most
    /// r a⁴ / 384: its fourth derivative by the angle has the length r.
    pub(super) fn bake(&self, ends: (f64, f64), largest: f64) -> BakedRotation {
        if self.is_held() {
            return BakedRotation::held(ends, matrix(self.rotation), self.rounding);
        }
        let (start, end) = ends;
        let lengths = (end - start) / self.duration;
        let angle = self.angle * lengths;
        let away = (start - self.time).abs().max((end - self.time).abs()) / self.duration;
        let error = self.error(angle, away);
        if error.is_nan() || error > largest {
            return BakedRotation::unknown(ends);
        }
        let (first, last) = (matrix(self.at(start)), matrix(self.at(end)));
        let third = self.axis * (angle / 3.0);
        let across = |matrix: DMat3| {
            DMat3::from_cols(
                third.cross(matrix.x_axis),
                third.cross(matrix.y_axis),
                third.cross(matrix.z_axis),
            )
        };
        let points = [first, first + across(first), last - across(last), last];
        BakedRotation::new(ends, points, error)
    }
}

/// Returns the largest error of cubic Hermite interpolation of a unit circle over an angle (rad).
fn interpolation_error(angle: f64) -> f64 {
    let square = angle * angle;
    // Its rounding is far below that of a rotation: above 1 nothing is known.
    square * square / 384.0
}

/// Returns the largest angle (rad) over which interpolation of a unit circle has this error.
pub(super) fn angle_within(error: f64) -> f64 {
    (384.0 * error).sqrt().sqrt()
}

/// Returns the parts of a revolution for a tolerance, also if they are longer by 1e-12 of themselves.
pub(super) fn parts_of_revolution(tolerance: f64) -> f64 {
    (TAU * (1.0 + 1e-12) / angle_within(tolerance)).ceil()
}
