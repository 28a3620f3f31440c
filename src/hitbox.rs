//! Hitboxes: the space that a body occupies around its position.
//!
//! A hitbox is a sphere, or a cluster of spheres fixed in the body's frame. To the narrow phase
//! it is a list of spheres on the body's cubic segments, with one bounding sphere tried first.

use crate::error::{Error, MAX_MAGNITUDE};
use crate::rounding::{UNIT_ROUNDOFF, norm};
use glam::DVec3;

/// A sphere in the body's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sphere {
    /// Centre relative to the body's position, m.
    pub offset: DVec3,
    /// Radius, m.
    pub radius: f64,
}

/// A sphere, or a cluster of spheres that stand in for another shape.
///
/// Cost, where two clusters may be near each other: some nanoseconds for each pair of their
/// spheres, and up to two microseconds where they overlap. Two overlapping bodies of 2,500 spheres
/// each take seconds. Only a few pairs are solved: those that begin and end a conflict, and those
/// that may be the nearest ones.
///
/// ```
/// use glam::DVec3;
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
    serde(try_from = "Vec<Sphere>", into = "Vec<Sphere>")
)]
pub struct Hitbox {
    bounding: Sphere,
    /// Largest distance from the body's position to the bounding sphere's surface, m.
    reach: f64,
    /// `None` for a single sphere, which is then `bounding` itself.
    cluster: Option<Box<Cluster>>,
}

/// Two spheres or more.
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
        let cluster = Cluster {
            arm: distances().fold(0.0, f64::max),
            radius: reaches.fold(0.0, f64::max),
            spheres,
            low,
            high,
        };
        Ok(Self {
            cluster: Some(Box::new(cluster)),
            ..Self::single(bounding)
        })
    }

    fn single(sphere: Sphere) -> Self {
        Self {
            bounding: sphere,
            reach: norm(sphere.offset) + sphere.radius,
            cluster: None,
        }
    }

    /// Returns the spheres, in the order in which they were given.
    #[must_use]
    pub fn spheres(&self) -> &[Sphere] {
        match &self.cluster {
            None => std::slice::from_ref(&self.bounding),
            Some(cluster) => &cluster.spheres,
        }
    }

    /// Returns a sphere that contains all others, rounded outward; not the smallest possible.
    #[must_use]
    pub const fn bounding(&self) -> Sphere {
        self.bounding
    }

    /// Returns the corners of the box around all spheres, in the body's frame (m).
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

    /// Returns the smallest radius, m.
    pub(crate) fn smallest_radius(&self) -> f64 {
        let radii = self.spheres().iter().map(|sphere| sphere.radius);
        radii.fold(f64::INFINITY, f64::min)
    }
}

#[cfg(feature = "serde")]
impl From<Hitbox> for Vec<Sphere> {
    fn from(hitbox: Hitbox) -> Self {
        hitbox.spheres().to_vec()
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Vec<Sphere>> for Hitbox {
    type Error = Error;

    fn try_from(spheres: Vec<Sphere>) -> Result<Self, Error> {
        Self::cluster(spheres)
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
    fn bad_spheres_are_named() {
        assert!(matches!(
            Hitbox::sphere(-1.0),
            Err(Error::Radius { sphere: 0, .. })
        ));
        assert!(matches!(Hitbox::cluster(vec![]), Err(Error::EmptyCluster)));
        let nowhere = Sphere {
            offset: DVec3::new(0.0, f64::NAN, 0.0),
            radius: 1.0,
        };
        assert!(matches!(
            Hitbox::cluster(vec![Sphere::default(), nowhere]),
            Err(Error::Offset { sphere: 1, value }) if value.is_nan()
        ));
    }
}
