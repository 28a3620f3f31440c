//! Orientations: how bodies turn, and the cubics that stand in for the way of a turning point.
//!
//! A point c of a turning body is at p(t) + R(t) c, which is no polynomial. Between the cuts of an
//! orientation, R is replaced by a cubic of matrices with a proven error: applied to c it gives the
//! point's cubic. The cuts depend on the orientation and its tolerance alone.
//!
//! Words: [`internals`](crate::internals).

mod arc;
mod baked;
mod given;
mod piece;
mod quaternion_cubic;
#[cfg(feature = "serde")]
mod serial;
#[cfg(test)]
mod tests;
mod told_spin;
mod turning;

pub(crate) use baked::BakedRotation;
pub(crate) use told_spin::ToldSpin;
pub(crate) use turning::{SteadyTurn, Turning, TurningSection};

use crate::error::{Error, check_change_time};
use crate::rounding::without_negative_zero;
use crate::trajectory::Outside;
use given::GivenRotation;
use glam::{DQuat, DVec3};
use turning::OrientationPart;

/// The orientation of a body over time: the rotation from its own axes to those of the world.
///
/// | kind | meaning |
/// |---|---|
/// | [`FIXED`](Self::FIXED) | the axes of the body are those of the world; the default |
/// | [`spin`](Self::spin) | a rotation at one instant, and a constant angular velocity |
/// | [`slerp`](Self::slerp) | rotations at knots, the shortest way between them at a constant rate |
/// | [`normalized_cubic`](Self::normalized_cubic) | rotations at knots, without jumps of the angular velocity |
///
/// Knots of an orientation are independent of those of the trajectory. Rotations are unit
/// quaternions; a length that differs from 1 by more than 1e-9 is refused. The direction given is
/// meant, normalised in real arithmetic: the error of its rounding is part of every bound. q and -q
/// are the same rotation.
///
/// # Accuracy and cost
///
/// The centre c of a sphere goes around the body's position on a path that is no polynomial.
/// Between cuts the path is replaced by a cubic with a proven error of at most `tolerance · |c|`.
/// [`Accuracy::Exact`](crate::Accuracy::Exact) adds that error to the sphere's radius, so no contact is lost.
/// A separation may be too small, by at most twice the sum of both bodies' errors.
/// [`Accuracy::Certified`](crate::Accuracy::Certified) adds it to the half-width of its enclosures.
///
/// | tolerance | default of | cubics per revolution |
/// |---|---|---|
/// | 1e-2 | | 5 |
/// | 1e-3 | `Accuracy::Exact` | 8 |
/// | 1e-4 | | 15 |
/// | 1e-6 | `Accuracy::Certified` | 45 |
///
/// The numbers hold for `spin`, and for whole revolutions of `slerp`. Cubics are formed while two
/// bodies' bounding spheres are within the margin, and not before. The time taken grows with their
/// number, so with the revolutions in that time. A screening's limit of spans does not bound it. A monitor keeps the parts of
/// each turn in its lookahead, for each two spheres that may be the nearest ones, and
/// [its limit](crate::Monitor::set_max_spans) bounds them. A body whose spheres are all centred at its
/// position pays nothing for turning.
///
/// Until two bodies are near, one that turns is bounded by the ball around its position that its spheres never leave. If they
/// lie aside of the position, along a rod or in a plate, it is bounded closer where it turns about one axis at a constant rate.
/// Between the knots of a `normalized_cubic` only the ball counts. Put the position amid the spheres: a tick in which 500 clusters
/// are told takes up to 2.6 times as long if their positions are three of their radii off, and 3 times if they are five.
///
/// ```
/// use nearmiss::glam::{DQuat, DVec3};
/// use nearmiss::{Body, Hitbox, Orientation, Sphere, Trajectory};
/// use std::f64::consts::{FRAC_PI_2, PI};
///
/// // Half a revolution per second about z.
/// let spin = Orientation::spin(0.0, DQuat::IDENTITY, PI * DVec3::Z)?;
/// let ahead = Sphere { offset: DVec3::X, radius: 0.1 };
/// let body = Body::new(Trajectory::at_rest(DVec3::ZERO)?)
///     .with_hitbox(Hitbox::cluster(vec![ahead])?)
///     .with_orientation(spin);
/// let spheres = body.spheres_at(0.5).unwrap_or_default();
/// assert!(spheres[0].offset.distance(DVec3::Y) < 1e-15);
///
/// let turn = [(0.0, DQuat::IDENTITY), (2.0, DQuat::from_rotation_z(FRAC_PI_2))];
/// let slow = Orientation::slerp(&turn)?;
/// assert!(slow.rotation(1.0).angle_between(DQuat::from_rotation_z(0.5 * FRAC_PI_2)) < 1e-7);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "serial::OrientationNumbers",
        into = "serial::OrientationNumbers"
    )
)]
pub struct Orientation {
    /// `None` if the body does not turn.
    turning: Option<Box<Turning>>,
}

impl Orientation {
    /// The axes of the body are those of the world at all times.
    pub const FIXED: Self = Self { turning: None };

    /// Returns a constant angular velocity (rad/s, in the world's axes) from a rotation at `time`
    /// (s), before and after it: what a physics engine tells each frame.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`], [`Error::OutOfRange`] for a time beyond 1e300 s,
    /// [`Error::RotationLength`], and [`Error::AngularSpeed`] above 1e6 rad/s.
    pub fn spin(
        time: f64,
        rotation: DQuat,
        angular_velocity: impl Into<DVec3>,
    ) -> Result<Self, Error> {
        Self::of(GivenRotation::Spin {
            time,
            rotation,
            angular_velocity: angular_velocity.into(),
        })
    }

    /// Returns the motion through rotations at knots (s), increasing: about a fixed axis at a
    /// constant rate from each to the next one, the shorter way.
    ///
    /// Before the first and after the last knot the rotation is held; see
    /// [`with_outside`](Self::with_outside). Between knots a few roundings of their times apart the tolerance cannot
    /// hold: a sphere's centre may be anywhere at its distance from the position there, and contacts are reported wherever that allows them.
    ///
    /// # Errors
    ///
    /// [`Error::TooFewRotations`], [`Error::NotFinite`], [`Error::OutOfRange`],
    /// [`Error::TimeNotIncreasing`], [`Error::RotationLength`]; [`Error::AntipodalRotations`] if
    /// neighbours are half a turn apart, where both ways are equally long.
    pub fn slerp(knots: &[(f64, DQuat)]) -> Result<Self, Error> {
        Self::of(GivenRotation::Slerp {
            knots: knots.to_vec(),
            outside: Outside::Absent,
        })
    }

    /// Returns the smooth motion through rotations at knots (s), increasing: cubics of quaternions,
    /// normalised. The angular velocity does not jump.
    ///
    /// At a knot the slope of the cubics is that from the knot before to the knot after
    /// (Catmull and Rom); at the first and last one, that to its neighbour. Before the first and
    /// after the last knot the rotation is held; see [`with_outside`](Self::with_outside).
    ///
    /// # Errors
    ///
    /// As [`slerp`](Self::slerp); [`Error::RotationVanishes`] if a cubic comes so close to zero
    /// that its direction is lost.
    pub fn normalized_cubic(knots: &[(f64, DQuat)]) -> Result<Self, Error> {
        Self::of(GivenRotation::NormalizedCubic {
            knots: knots.to_vec(),
            outside: Outside::Absent,
        })
    }

    /// Returns this orientation with another rule for the time before and after its knots.
    ///
    /// With [`Outside::Absent`] the rotation is held: whether the body exists is up to its
    /// trajectory. With [`Outside::Coast`] and [`Outside::Extrapolate`] the body keeps the angular
    /// velocity that it has at the first or last knot. If that is above 1e6 rad/s (knots almost at the same time), a sphere's
    /// centre may be anywhere at its distance from the position, and contacts are reported wherever that allows them. A spin has no knots, and ignores
    /// the rule.
    ///
    /// The rate is known to rounding, which adds up. With the default tolerances, a centre may be anywhere as well from
    /// 7e7 lengths of the interval at that knot on (`Certified`), or from 7e10 on (`Exact`). If both rotations of that
    /// interval are given as equal, that rotation is held for ever.
    #[must_use]
    pub fn with_outside(mut self, outside: Outside) -> Self {
        // What was accepted before is so again: the rule refuses nothing.
        if let Some(turning) = &mut self.turning
            && let Ok(other) = turning.with_outside(outside)
        {
            **turning = other;
        }
        self
    }

    /// Returns this orientation with another tolerance: the largest error of a sphere's centre,
    /// relative to its distance from the body's position, at any accuracy.
    ///
    /// Spins that are told later ([`BodyState::with_spin`](crate::BodyState::with_spin)) keep it. It has no effect on
    /// a [fixed](Self::FIXED) orientation, which does not remember it: give a body that is to turn later a spin of 0.
    ///
    /// ```
    /// use nearmiss::Orientation;
    /// use nearmiss::glam::{DQuat, DVec3};
    ///
    /// assert_eq!(Orientation::FIXED.with_tolerance(1e-8)?, Orientation::FIXED);
    /// let still = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::ZERO)?;
    /// assert_ne!(still.clone().with_tolerance(1e-8)?, still);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Tolerance`] if it is not within 1e-9..=0.1; [`Error::RotationVanishes`] if a
    /// [normalised cubic](Self::normalized_cubic) cannot be known so well.
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self, Error> {
        let turning = self.into_turning().with_tolerance(Some(tolerance))?;
        Ok(Self::of_turning(turning))
    }

    /// Returns the [tolerance](Self::with_tolerance) that was set, relative to a sphere's distance from the body's
    /// position; none if that of the [accuracy](Self#accuracy-and-cost) counts, or if the body does not turn.
    #[must_use]
    pub fn tolerance(&self) -> Option<f64> {
        self.turning().and_then(|turning| turning.tolerance)
    }

    /// Returns this orientation up to `from` (s), then `next`.
    ///
    /// There is no gap at `from`; the rotation may jump there. The [tolerance](Self::tolerance) is that of `next`, or
    /// this one's if `next` has none. An orientation that is fixed at all times has none.
    ///
    /// ```
    /// use nearmiss::Orientation;
    /// use nearmiss::glam::{DQuat, DVec3};
    ///
    /// let still = Orientation::FIXED;
    /// let spin = Orientation::spin(5.0, DQuat::IDENTITY, DVec3::Z)?.with_tolerance(1e-4)?;
    /// let both = still.spliced(5.0, &spin)?;
    /// assert_eq!(both.rotation(4.0), DQuat::IDENTITY);
    /// assert_eq!(both.rotation(6.0), spin.rotation(6.0));
    /// assert_eq!(both.tolerance(), Some(1e-4));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::ChangeTime`] if `from` is not within ±1e300; [`Error::RotationVanishes`] if a
    /// [normalised cubic](Self::normalized_cubic) cannot be known to the tolerance of the other orientation.
    pub fn spliced(&self, from: f64, next: &Self) -> Result<Self, Error> {
        self.followed_by(next, from, f64::NEG_INFINITY)
    }

    /// Returns the orientation that is this one until `from` (s) and `next` from then on. Parts that end
    /// before `since` (s) are dropped. The tolerance is that of `next`, if it has one.
    ///
    /// # Errors
    ///
    /// [`Error::ChangeTime`]; [`Error::RotationVanishes`] if a cubic
    /// cannot be known to the tolerance of the other orientation.
    pub(crate) fn followed_by(&self, next: &Self, from: f64, since: f64) -> Result<Self, Error> {
        let from = Self::checked_start(from)?;
        let tolerance = next.tolerance().or_else(|| self.tolerance());
        let (mut both, mut next) = (self.clone().into_turning(), next.clone().into_turning());
        let is_followed = matches!(&next.parts[..], [only] if both.goes_on_as(&only.given, from));
        both.keep(if is_followed { f64::INFINITY } else { from }, since)?;
        both = both.with_tolerance(tolerance)?;
        if !is_followed {
            next.keep(f64::INFINITY, from.next_up())?;
            both.append(next.with_tolerance(tolerance)?, from);
        }
        Ok(Self::of_turning(both))
    }

    /// Returns an instant (s) from which on an orientation may be followed.
    ///
    /// # Errors
    ///
    /// [`Error::ChangeTime`].
    pub(crate) fn checked_start(from: f64) -> Result<f64, Error> {
        check_change_time(from)?;
        Ok(without_negative_zero(from))
    }

    fn into_turning(self) -> Turning {
        self.turning.map_or_else(Turning::fixed, |turning| *turning)
    }

    fn of(given: GivenRotation) -> Result<Self, Error> {
        let turning = Turning::of(vec![OrientationPart { from: None, given }], None)?;
        Ok(Self::of_turning(turning))
    }

    fn of_turning(turning: Turning) -> Self {
        let mut parts = turning.parts.iter();
        let is_fixed = parts.all(|part| part.given == GivenRotation::Fixed);
        Self {
            turning: (!is_fixed).then(|| Box::new(turning)),
        }
    }

    /// Returns the rotation from the body's axes to those of the world at `time` (s): a unit
    /// quaternion, good to a few roundings, and to 16 roundings of the angle of a spin. Where an orientation between knots
    /// goes on beyond them, for each duration of its first or last piece 256 roundings of a radian are added. If the angle
    /// overflows f64, or the time is NaN, it is some rotation.
    #[must_use]
    pub fn rotation(&self, time: f64) -> DQuat {
        match &self.turning {
            None => DQuat::IDENTITY,
            Some(turning) => turning.at(time),
        }
    }

    /// Returns true if the axes of the body are those of the world at all times.
    #[must_use]
    pub const fn is_fixed(&self) -> bool {
        self.turning.is_none()
    }

    /// Returns the turning motion, or `None` if the body does not turn.
    #[inline]
    pub(crate) fn turning(&self) -> Option<&Turning> {
        self.turning.as_deref()
    }
}
