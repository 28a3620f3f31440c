//! Hitboxes: the space that a body occupies around its position.
//!
//! A hitbox is a sphere, a cluster of spheres fixed in the body's frame, or a half-space. To the
//! narrow phase the former are lists of spheres on the body's cubic segments, with one bounding
//! sphere tried first. A half-space has no spheres.

use crate::error::{Error, MAX_MAGNITUDE};
use crate::rounding::{UNIT_ROUNDOFF, norm};
use glam::DVec3;

#[cfg(feature = "serde")]
mod serial;

/// A sphere in the body's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sphere {
    /// Centre relative to the body's position, m.
    pub offset: DVec3,
    /// Radius, m.
    pub radius: f64,
}

impl Sphere {
    /// Returns a sphere around a point relative to the body's position (m), of a radius (m); making a hitbox of it checks
    /// it.
    #[must_use]
    pub fn new(offset: impl Into<DVec3>, radius: f64) -> Self {
        let offset = offset.into();
        Self { offset, radius }
    }
}

/// A sphere, a cluster of spheres that stand in for another shape, or a [half-space](Self::half_space).
///
/// Cost of two clusters that may be near each other, for each cubic that they follow:
///
/// - Clusters of a few spheres take some microseconds.
/// - Clusters of hundreds of spheres that pass by closely take about ten.
/// - Clusters that pass through each other take more. If the middle of one goes through that of the other, with 128 spheres
///   each, a screening takes 160 microseconds, and a tick of a [`Monitor`](crate::Monitor) that is told of them 700. With 512
///   spheres each, these take 900 and 6,600.
///
/// Clusters that turn follow several cubics in each revolution. Most pairs of spheres are ruled
/// out together. Few are solved: those that begin and end a conflict, and those that may be the nearest ones.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Hitbox, Sphere};
///
/// let ball = Hitbox::sphere(0.5)?;
/// let dumbbell = Hitbox::cluster(vec![
///     Sphere { offset: DVec3::X, radius: 0.4 },
///     Sphere { offset: -DVec3::X, radius: 0.4 },
/// ])?;
/// assert_eq!(ball.spheres().len(), 1);
/// assert!(dumbbell.bounding().radius >= 1.4);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "serial::HitboxNumbers", into = "serial::HitboxNumbers")
)]
pub struct Hitbox {
    /// Bounding sphere; for a half-space its normal, and an infinite radius.
    bounding: Sphere,
    /// Largest distance from the body's position to the bounding sphere's surface, m.
    reach: f64,
    /// `None` for a single sphere, which is then `bounding` itself.
    cluster: Option<Box<Cluster>>,
}

/// The spheres of a cluster: two or more. A half-space has none.
#[derive(Clone, Debug, PartialEq)]
struct Cluster {
    spheres: Vec<Sphere>,
    /// Corners of the box around all spheres, m.
    low: DVec3,
    high: DVec3,
    /// Largest distance from the body's position to a sphere's centre, m.
    arm: f64,
    /// Largest distance from the body's position to a sphere's surface, m.
    radius: f64,
    /// Smallest radius, m.
    smallest: f64,
    /// See [`Hitbox::has_long_arms`].
    has_long_arms: bool,
}

impl Hitbox {
    /// A point: radius 0.
    pub const POINT: Self = Self {
        bounding: Sphere {
            offset: DVec3::ZERO,
            radius: 0.0,
        },
        reach: 0.0,
        cluster: None,
    };

    /// Returns a sphere of this radius (m) around the body's position.
    ///
    /// # Errors
    ///
    /// [`Error::Radius`] if it is negative, NaN, infinite or above 1e300.
    pub fn sphere(radius: f64) -> Result<Self, Error> {
        let sphere = Sphere {
            offset: DVec3::ZERO,
            radius,
        };
        check(0, &sphere)?;
        Ok(Self::single(sphere))
    }

    /// Returns a cluster of spheres in the body's frame. It moves with the body, and turns with its
    /// [orientation](crate::Orientation).
    ///
    /// # Errors
    ///
    /// [`Error::EmptyCluster`], [`Error::Radius`], [`Error::Offset`].
    pub fn cluster(spheres: Vec<Sphere>) -> Result<Self, Error> {
        if spheres.is_empty() {
            return Err(Error::EmptyCluster);
        }
        for (index, sphere) in spheres.iter().enumerate() {
            check(index, sphere)?;
        }
        if let [single] = spheres[..] {
            return Ok(Self::single(single));
        }
        let (low, high) = corners(&spheres);
        let bounding = bounding_sphere(&spheres, (low, high));
        let distances = || spheres.iter().map(|sphere| norm(sphere.offset));
        let reaches = distances()
            .zip(&spheres)
            .map(|(far, sphere)| far + sphere.radius);
        let radius = reaches.fold(0.0, f64::max);
        let thinnest = 0.5 * (high - low).min_element();
        let cluster = Cluster {
            arm: distances().fold(0.0, f64::max),
            radius,
            has_long_arms: bounding.radius < 0.75 * radius || thinnest < 0.4 * radius,
            smallest: spheres
                .iter()
                .map(|sphere| sphere.radius)
                .fold(f64::INFINITY, f64::min),
            spheres,
            low,
            high,
        };
        Ok(Self {
            cluster: Some(Box::new(cluster)),
            ..Self::single(bounding)
        })
    }

    /// Returns the half-space behind a plane through the body's position: a floor, a ceiling, a
    /// wall. `normal` is a unit vector that points out of it, in the world's axes.
    ///
    /// The separation of a sphere from a half-space is the distance of its centre from the plane,
    /// minus its radius. Below the plane it goes on falling: a sphere at depth d has the separation
    /// -d minus its radius, however thick other walls are. The plane moves with its body, and
    /// cannot turn: an orientation that is not fixed is refused with the body.
    ///
    /// - Half-spaces do not meet each other.
    /// - Of [`sphere_a`](crate::ClosestApproach::sphere_a) and `sphere_b`, the half-space's is 0.
    /// - The direction of `normal` is meant, normalised in real arithmetic. The error of its rounding is
    ///   part of every bound.
    ///
    /// Cost: no box contains a half-space. Each other body is compared with each half-space: in
    /// about ten nanoseconds where the box of its plan stays clear of the plane, in some microseconds where it does not. A [`Monitor`](crate::Monitor)
    /// compares bodies again when they change, and all of them when a half-space does.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Body, Hitbox, Query, Scene, State, Trajectory};
    ///
    /// let mut scene = Scene::new();
    /// let floor = Body::new(Trajectory::at_rest(DVec3::ZERO)?);
    /// scene.insert(floor.with_hitbox(Hitbox::half_space(DVec3::Z)?))?;
    /// // A ball sinks from 10 m to the floor's height, in 10 s.
    /// let fall = [0.0, 10.0].map(|t| State::new(t, (10.0 - t) * DVec3::Z, -DVec3::Z));
    /// let ball = Body::new(Trajectory::from_states(&fall)?);
    /// scene.insert(ball.with_hitbox(Hitbox::sphere(0.5)?))?;
    /// let conflict = scene.screen(&Query::default())?.conflicts[0];
    /// assert_eq!((conflict.enter, conflict.closest.separation), (9.5, -0.5));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::NormalLength`] if the length of the normal differs from 1 by more than 1e-9, or is
    /// no number.
    pub fn half_space(normal: impl Into<DVec3>) -> Result<Self, Error> {
        /// Largest difference of the length from 1.
        const MAX_DEVIATION: f64 = 1e-9;
        let normal = normal.into();
        let length = norm(normal);
        if (length - 1.0).abs() <= MAX_DEVIATION {
            Ok(Self {
                bounding: Sphere {
                    offset: normal,
                    radius: f64::INFINITY,
                },
                reach: f64::INFINITY,
                cluster: Some(Box::new(Cluster {
                    spheres: Vec::new(),
                    low: DVec3::NEG_INFINITY,
                    high: DVec3::INFINITY,
                    arm: 0.0,
                    radius: f64::INFINITY,
                    smallest: f64::INFINITY,
                    has_long_arms: false,
                })),
            })
        } else {
            Err(Error::NormalLength { length })
        }
    }

    /// Returns the normal of a half-space as given, or `None` of spheres.
    #[must_use]
    pub fn normal(&self) -> Option<DVec3> {
        self.is_half_space().then_some(self.bounding.offset)
    }

    pub(crate) const fn is_half_space(&self) -> bool {
        self.bounding.radius.is_infinite()
    }

    fn single(sphere: Sphere) -> Self {
        Self {
            bounding: sphere,
            reach: norm(sphere.offset) + sphere.radius,
            cluster: None,
        }
    }

    /// Returns the spheres, in the order in which they were given; none of a half-space.
    #[must_use]
    pub fn spheres(&self) -> &[Sphere] {
        match &self.cluster {
            None => std::slice::from_ref(&self.bounding),
            Some(cluster) => &cluster.spheres,
        }
    }

    /// Returns a sphere that contains all others, rounded outward. It is not the smallest possible. A
    /// half-space has an infinite one around the body's position.
    #[must_use]
    pub const fn bounding(&self) -> Sphere {
        if self.is_half_space() {
            return Sphere {
                offset: DVec3::ZERO,
                radius: f64::INFINITY,
            };
        }
        self.bounding
    }

    /// Returns the bounding sphere; of a half-space its normal, with an infinite radius.
    #[inline]
    pub(crate) const fn bounding_or_normal(&self) -> Sphere {
        self.bounding
    }

    /// Returns the corners of the box around all spheres, in the body's frame (m).
    #[inline]
    pub(crate) fn corners(&self) -> (DVec3, DVec3) {
        let Sphere { offset, radius } = self.bounding;
        match &self.cluster {
            None => (offset - radius, offset + radius),
            Some(cluster) => (cluster.low, cluster.high),
        }
    }

    /// Returns the largest distance of the bounding sphere's points from the body's position, m.
    pub(crate) const fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the largest distance from the body's position to a sphere's centre, m.
    pub(crate) fn arm(&self) -> f64 {
        let own = || norm(self.bounding.offset);
        self.cluster
            .as_ref()
            .map_or_else(own, |cluster| cluster.arm)
    }

    /// Returns the radius of the smallest sphere around the body's position that contains all
    /// others, m.
    pub(crate) fn radius_around_position(&self) -> f64 {
        let cluster = self.cluster.as_ref();
        cluster.map_or(self.reach, |cluster| cluster.radius)
    }

    /// Returns true if the spheres lie aside of the body's position, or if the box around them is thin: the ball around the position
    /// that contains them is mostly empty.
    #[inline]
    pub(crate) fn has_long_arms(&self) -> bool {
        match &self.cluster {
            None => self.bounding.radius < 0.6 * self.reach,
            Some(cluster) => cluster.has_long_arms,
        }
    }

    /// Returns the smallest radius, m.
    pub(crate) fn smallest_radius(&self) -> f64 {
        let cluster = self.cluster.as_ref();
        cluster.map_or(self.bounding.radius, |cluster| cluster.smallest)
    }
}

impl Default for Hitbox {
    fn default() -> Self {
        Self::POINT
    }
}

fn check(index: usize, sphere: &Sphere) -> Result<(), Error> {
    let radius = sphere.radius;
    if !(0.0..=MAX_MAGNITUDE).contains(&radius) {
        return Err(Error::Radius {
            sphere: index,
            radius,
        });
    }
    for value in sphere.offset.to_array() {
        if value.is_nan() || value.abs() > MAX_MAGNITUDE {
            return Err(Error::Offset {
                sphere: index,
                value,
            });
        }
    }
    Ok(())
}

/// Returns the low and the high corner of the box around some spheres.
fn corners(spheres: &[Sphere]) -> (DVec3, DVec3) {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for sphere in spheres {
        low = low.min(sphere.offset - sphere.radius);
        high = high.max(sphere.offset + sphere.radius);
    }
    (low, high)
}

/// Returns a sphere around the middle of the box of all spheres.
fn bounding_sphere(spheres: &[Sphere], (low, high): (DVec3, DVec3)) -> Sphere {
    let offset = low / 2.0 + high / 2.0;
    let radius = spheres
        .iter()
        .map(|sphere| norm(sphere.offset - offset) + sphere.radius)
        .fold(0.0, f64::max);
    Sphere {
        offset,
        // The difference, the norm and the sum: 6 roundings of the parts at most.
        radius: radius * (1.0 + 16.0 * UNIT_ROUNDOFF)
            + 4.0 * UNIT_ROUNDOFF * norm(offset)
            + f64::MIN_POSITIVE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounding_sphere_contains_all_spheres() {
        let spheres = vec![
            Sphere {
                offset: DVec3::new(3.0, 0.0, 0.1),
                radius: 0.2,
            },
            Sphere {
                offset: DVec3::new(-1.0, 2.0, 0.0),
                radius: 1.5,
            },
        ];
        let bounding = bounding_sphere(&spheres, corners(&spheres));
        for sphere in &spheres {
            let reach = norm(sphere.offset - bounding.offset) + sphere.radius;
            assert!(reach <= bounding.radius);
        }
        assert!(bounding.radius < 4.2);
    }

    #[test]
    fn a_cluster_of_one_is_a_sphere() {
        let sphere = Sphere {
            offset: DVec3::Y,
            radius: 1.0,
        };
        let hitbox = Hitbox::cluster(vec![sphere]);
        assert!(hitbox.is_ok_and(|hitbox| hitbox.spheres() == [sphere]));
    }

    #[test]
    fn normals_are_unit_vectors() {
        for bad in [0.0, 0.5, 1.0 + 2e-9, f64::NAN, f64::INFINITY, 1e300] {
            let found = Hitbox::half_space(bad * DVec3::Y);
            assert!(matches!(found, Err(Error::NormalLength { .. })), "{bad}");
        }
        let normal = DVec3::new(0.6, 0.0, 0.8) * (1.0 + 0.9e-9);
        let Ok(floor) = Hitbox::half_space(normal) else {
            unreachable!("its length is 1, nearly")
        };
        assert_eq!(floor.normal(), Some(normal));
        assert!(floor.spheres().is_empty() && floor.bounding().radius.is_infinite());
        assert_eq!(Hitbox::POINT.normal(), None);
    }
}
