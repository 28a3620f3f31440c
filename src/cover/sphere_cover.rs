//! A cover: spheres, with what is known of them.

use super::certificate::Certified;
use super::error::CoverError;
use super::fit::Fitter;
use super::options::CoverOptions;
use super::read::read;
use super::solid::Solid;
use super::verify::{Coverage, verify_cover};
use super::volume;
use crate::hitbox::{Hitbox, Sphere};
use parry3d::shape::Shape;

/// The part of a shape that a cover contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Extent {
    /// The whole volume.
    Volume,
    /// The surfaces only. The shape has a mesh that is not closed, or not oriented as one: each edge
    /// must be passed as often one way as the other. Or the shape is a polyhedron that is only a segment or a point.
    Surface,
}

/// Spheres that provably contain a shape, with a bound of how far they reach out of it.
///
/// ```
/// use nearmiss::parry3d::shape::Cuboid;
/// use nearmiss::{CoverOptions, Coverage, Hitbox, SphereCover};
///
/// let brick = Cuboid::new([0.5, 1.0, 2.0].into());
/// let cover = SphereCover::fit(&brick, &CoverOptions::new(8))?;
/// assert!(cover.spheres().len() <= 8);
/// assert!(cover.overshoot_percent() < 8.0);
/// assert_eq!(cover.verify(&brick)?, Coverage::Covered);
///
/// let hitbox = Hitbox::from(cover.scaled(2.0)?);
/// assert_eq!(hitbox.spheres().len(), cover.spheres().len());
/// # Ok::<(), nearmiss::CoverError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "CoverNumbers"))]
pub struct SphereCover {
    /// The spheres.
    spheres: Hitbox,
    overshoot: f64,
    diameter: f64,
    volume_ratio: Option<f64>,
    extent: Extent,
}

impl SphereCover {
    /// Returns spheres that contain a shape, with as small an overshoot as the search finds; or as
    /// few as the search finds to reach [a target](CoverOptions::with_target_overshoot).
    ///
    /// Each point of the shape is in a sphere: that is proven, with all rounding. The overshoot is a
    /// bound too. Neither is a matter of samples. Whether fewer or smaller spheres would do is not
    /// proven, except for a ball and a capsule, which have closed forms.
    ///
    /// Spheres that the others make needless are dropped. The overshoot is never larger than that with one sphere, nor
    /// with more than 256 spheres than that with 256.
    ///
    /// The shape's f32 numbers count as exact. A compound is covered part by part, and a depth in
    /// it is that in one of its parts: parts that overlap well lead to better bounds. The interior of
    /// a mesh is where its surface winds around. A convex polyhedron is the hull of all its points, also of those that
    /// parry3d leaves out of its faces.
    ///
    /// A shape and options lead to the same bits on any number of threads. By default the search takes up to two seconds
    /// for 16 spheres, up to about five for 64, on two cores (`cargo run --release --example cover`): fit a shape once,
    /// and store the cover.
    ///
    /// # Errors
    ///
    /// - [`CoverError::UnsupportedShape`]: half-spaces, height fields, segments and others.
    /// - [`CoverError::InvalidShape`]: NaN, infinite or negative numbers.
    /// - [`CoverError::SphereCount`], [`CoverError::Effort`], [`CoverError::Target`]: options out of range.
    /// - [`CoverError::TargetMissed`]: the largest number of spheres does not reach the target.
    pub fn fit(shape: &dyn Shape, options: &CoverOptions) -> Result<Self, CoverError> {
        Self::fit_with_progress(shape, options, |_| {})
    }

    /// Returns the cover of [`fit`](Self::fit) and reports the progress. `progress` gets the share
    /// done, or of the present number of spheres if a target is to be reached. Any thread may call
    /// it, so values may come out of order. The last call, with 1, is on this thread.
    ///
    /// # Errors
    ///
    /// As [`fit`](Self::fit).
    pub fn fit_with_progress(
        shape: &dyn Shape,
        options: &CoverOptions,
        progress: impl Fn(f64) + Sync,
    ) -> Result<Self, CoverError> {
        Self::fit_with_progress_dyn(shape, options, &progress)
    }

    /// Does the work of [`fit_with_progress`](Self::fit_with_progress), compiled once: as a generic function it would
    /// be compiled again for each caller.
    fn fit_with_progress_dyn(
        shape: &dyn Shape,
        options: &CoverOptions,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, CoverError> {
        let most = options.max_spheres();
        if !(1..=CoverOptions::MAX_SPHERES).contains(&most) {
            return Err(CoverError::SphereCount { count: most });
        }
        let effort = options.effort();
        if effort > CoverOptions::MAX_EFFORT {
            return Err(CoverError::Effort { effort });
        }
        let solid = read(shape)?;
        let fitter = Fitter::new(&solid, most, options.seed(), effort);
        let fit = |count: usize| fitter.fit(count, progress);
        let certified = match options.target_overshoot() {
            None => fit(most),
            Some(target) if target >= 0.0 && target.is_finite() => {
                fewest(&solid, most, target, fit)?
            }
            Some(target) => return Err(CoverError::Target { target }),
        };
        let cover = Self::new(&solid, &certified)?;
        progress(1.0);
        Ok(cover)
    }

    fn new(solid: &Solid, certified: &Certified) -> Result<Self, CoverError> {
        let spheres = certified.balls.iter().map(|&(centre, radius)| Sphere {
            offset: centre * solid.unit + solid.origin,
            radius: radius * solid.unit,
        });
        Ok(Self {
            spheres: Hitbox::cluster(spheres.collect())?,
            overshoot: certified.overshoot * solid.unit,
            diameter: solid.diameter * solid.unit,
            volume_ratio: volume::ratio(solid, &certified.balls),
            extent: if solid.is_volume() {
                Extent::Volume
            } else {
                Extent::Surface
            },
        })
    }

    /// Returns the spheres, in the shape's frame.
    #[must_use]
    pub fn spheres(&self) -> &[Sphere] {
        self.spheres.spheres()
    }

    /// Returns a bound of the overshoot, m: no point of a sphere is farther from the shape.
    #[must_use]
    pub const fn overshoot(&self) -> f64 {
        self.overshoot
    }

    /// Returns the overshoot in percent of the shape's diameter; 0 for a shape that is a point.
    #[must_use]
    pub fn overshoot_percent(&self) -> f64 {
        if self.diameter > 0.0 {
            100.0 * self.overshoot / self.diameter
        } else {
            0.0
        }
    }

    /// Returns the largest distance of two points of the shape, m. It is rounded down if no formula
    /// exists.
    #[must_use]
    pub const fn diameter(&self) -> f64 {
        self.diameter
    }

    /// Returns the volume of the union of the spheres over that of the shape, to about three digits;
    /// `None` if the shape has no volume. The interior of a mesh is where its surface winds around, however often.
    ///
    /// Volumes of compounds, and of meshes that wind more than once or both ways, are sums along 256 x 256 lines
    /// through the shape's box: parts as thin as a step between lines cost digits.
    #[must_use]
    pub const fn volume_ratio(&self) -> Option<f64> {
        self.volume_ratio
    }

    /// Returns the part of the shape that the spheres contain.
    #[must_use]
    pub const fn extent(&self) -> Extent {
        self.extent
    }

    /// Returns the verdict of [`verify_cover`] on the spheres and a shape.
    ///
    /// # Errors
    ///
    /// As [`verify_cover`].
    pub fn verify(&self, shape: &dyn Shape) -> Result<Coverage, CoverError> {
        verify_cover(self.spheres(), shape)
    }

    /// Returns the cover of the shape scaled by a factor around the origin of its frame.
    ///
    /// # Errors
    ///
    /// - [`CoverError::Scale`] if the factor is not a positive finite number.
    /// - [`CoverError::Sphere`] if a number of a sphere leaves the range of hitboxes.
    /// - [`CoverError::Saved`] if the overshoot or the diameter overflows.
    pub fn scaled(&self, factor: f64) -> Result<Self, CoverError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(CoverError::Scale { factor });
        }
        // The products and the sum are rounded by half of this, and underflow by less than the last term.
        let rounding = |sphere: &Sphere| {
            let reach = crate::rounding::norm(sphere.offset) + sphere.radius;
            4.0 * f64::EPSILON * factor * reach + f64::MIN_POSITIVE
        };
        let spheres = self.spheres().iter().map(|sphere| Sphere {
            offset: sphere.offset * factor,
            radius: factor * sphere.radius + rounding(sphere),
        });
        // By one the radius grows. Another one is for how it is rounded, and the centre.
        let most = self.spheres().iter().map(rounding).fold(0.0, f64::max);
        let overshoot = (self.overshoot * factor + 2.0 * most) * (1.0 + f64::EPSILON);
        Ok(Self {
            overshoot: checked("overshoot", overshoot)?,
            diameter: checked("diameter", self.diameter * factor)?,
            spheres: Hitbox::cluster(spheres.collect())?,
            ..*self
        })
    }
}

/// The numbers of a saved cover.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct CoverNumbers {
    spheres: Hitbox,
    overshoot: f64,
    diameter: f64,
    volume_ratio: Option<f64>,
    extent: Extent,
}

#[cfg(feature = "serde")]
impl TryFrom<CoverNumbers> for SphereCover {
    type Error = CoverError;

    fn try_from(numbers: CoverNumbers) -> Result<Self, CoverError> {
        let CoverNumbers {
            spheres,
            overshoot,
            diameter,
            volume_ratio,
            extent,
        } = numbers;
        for (field, value) in [
            ("overshoot", overshoot),
            ("diameter", diameter),
            ("volume ratio", volume_ratio.unwrap_or(0.0)),
        ] {
            checked(field, value)?;
        }
        Ok(Self {
            // A half-space has no spheres.
            spheres: Hitbox::cluster(spheres.spheres().to_vec())?,
            overshoot,
            diameter,
            volume_ratio,
            extent,
        })
    }
}

/// Returns a number of a cover, if it is one.
///
/// # Errors
///
/// [`CoverError::Saved`].
fn checked(field: &'static str, value: f64) -> Result<f64, CoverError> {
    let is_one = value >= 0.0 && value.is_finite();
    is_one
        .then_some(value)
        .ok_or(CoverError::Saved { field, value })
}

/// Returns the smallest cover found that reaches a target (m): numbers of balls are doubled until one
/// does, and halved between.
fn fewest(
    solid: &Solid,
    most: usize,
    target: f64,
    fit: impl Fn(usize) -> Certified,
) -> Result<Certified, CoverError> {
    let reaches = |certified: &Certified| certified.overshoot * solid.unit <= target;
    let (mut short, mut count) = (0, 1);
    let mut best: Option<Certified> = None;
    let mut best = loop {
        let certified = fit(count);
        if reaches(&certified) {
            break certified;
        }
        // More balls need not be better.
        let is_better = |best: &Certified| certified.overshoot < best.overshoot;
        if best.as_ref().is_none_or(is_better) {
            best = Some(certified);
        }
        if let Some(best) = best.as_ref().filter(|_| count == most) {
            return Err(CoverError::TargetMissed {
                spheres: best.balls.len(),
                overshoot: best.overshoot * solid.unit,
                target,
            });
        }
        short = count;
        count = (2 * count).min(most);
    };
    while count - short > 1 {
        let middle = usize::midpoint(short, count);
        let certified = fit(middle);
        if reaches(&certified) {
            (best, count) = (certified, middle);
        } else {
            short = middle;
        }
    }
    Ok(best)
}

impl From<SphereCover> for Hitbox {
    fn from(cover: SphereCover) -> Self {
        cover.spheres
    }
}

impl From<&SphereCover> for Hitbox {
    fn from(cover: &SphereCover) -> Self {
        cover.spheres.clone()
    }
}
