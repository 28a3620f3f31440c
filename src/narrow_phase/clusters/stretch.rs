//! The stretch of a part in which two bodies may be near each other, and the number of times that it is halved.
//!
//! Bodies that coast may be far apart for most of a part. Quarters of its time would be long as well, and tell few pairs of
//! spheres apart. So the search is restricted to the stretch in which the bounding spheres are within its bound. With a
//! wide margin that is long as well, and is halved more often.

use super::near::NearSpheres;
use super::part::{Interval, SpheresOverPart};
use super::shares::{FEWEST_HALVINGS, MOST_HALVINGS, Shares, WHOLE};
use crate::blossom::restrict_to;
use crate::enclosure::{Stretch, Threshold, Verdict};
use crate::narrow_phase::contact_radius;
use crate::narrow_phase::relative::rejection_threshold;
use crate::orientation::BakedRotation;
use crate::rounding::norm;

/// Share of the part by which a stretch is longer at either end: far more than the rounding of shares.
const SPARE: f64 = 1e-12;

impl SpheresOverPart<'_> {
    /// Length of a part's path from which on its stretch is looked for, in distances at which the bodies may be within the
    /// bound. Less in tests.
    const FAR: f64 = if cfg!(test) { 1.0 } else { 8.0 };
    /// Length of an interval's path up to which halving the interval again tells few more pairs apart, in sums of the
    /// bounding spheres' radii.
    const SHORT: f64 = 0.25;

    /// Returns the stretch in which the bounding spheres may come within `bound` (m), the whole part if its path is not
    /// long. `None` if they certainly never do. `square_reach` is [that](Interval::square_reach) of the part, m².
    #[inline]
    pub(super) fn stretch_within(&self, bound: f64, square_reach: f64) -> Option<Shares> {
        let [a, b] = self.views;
        let radius = contact_radius(a.bounding.radius, b.bounding.radius, bound);
        if radius < 0.0 {
            return None;
        }
        let distance = rejection_threshold(radius, self.scale + bound.abs());
        let far = Self::FAR * distance;
        let is_far = square_reach > far * far && square_reach < f64::INFINITY;
        if !is_far {
            return Some(WHOLE);
        }
        let offset = a.bounding.offset - b.bounding.offset;
        let enclosed = self.motion.of_spheres(offset).uncertain();
        let stretches = enclosed.stretches(Threshold {
            low: distance,
            high: distance,
        });
        let is_near = |stretch: &&Stretch| stretch.side != Verdict::Outside;
        let near = || stretches.as_slice().iter().filter(is_near);
        let (first, last) = (near().next()?, near().next_back()?);
        Some(((first.first - SPARE).max(0.0), (last.last + SPARE).min(1.0)))
    }

    /// Returns the difference of [supports](Self::find_supports) from which on two spheres are farther apart than the
    /// foremost two all the time, m. Neither body turns.
    ///
    /// Then separations along the direction change alike for all pairs. The separation of the foremost two exceeds theirs
    /// along it by an excess. This is a convex function of the relative position: in an interval, it is nowhere larger than
    /// at some control point.
    pub(super) fn support_behind(&self, interval: &Interval, near: &NearSpheres) -> f64 {
        let (a, b) = near.facing();
        let offset = self.sphere(0, a).offset - self.sphere(1, b).offset;
        let excess = interval.base.map(|point| {
            let apart = point + offset;
            norm(apart) - apart.dot(near.direction)
        });
        let [nearest, farthest] = near.foremost.map(|one| one.support);
        (nearest - farthest) + excess.into_iter().fold(0.0, f64::max)
    }

    /// Returns the number of times that a stretch is halved: more where the bodies are small,
    /// compared with its path. `square_reach` is [that](Interval::square_reach) of the stretch, m².
    pub(super) fn halvings(&self, square_reach: f64) -> i32 {
        let [a, b] = self.views;
        let short = Self::SHORT * (a.bounding.radius + b.bounding.radius);
        let mut square = square_reach * 0.25_f64.powi(FEWEST_HALVINGS);
        let mut halvings = FEWEST_HALVINGS;
        while halvings < MOST_HALVINGS && square > short * short {
            halvings += 1;
            square *= 0.25;
        }
        halvings
    }
}

impl Interval {
    /// Returns a stretch of the part, given the whole of it: the same motions, but for nine roundings.
    pub(super) fn stretch(&self, stretch: Shares) -> Self {
        let restrict = |rotation: &BakedRotation| rotation.stretch(stretch);
        let [a, b] = &self.rotations;
        Self {
            ends: self.ends,
            base: restrict_to(&self.base, WHOLE, stretch),
            rotations: [a.as_ref().map(restrict), b.as_ref().map(restrict)],
        }
    }
}
