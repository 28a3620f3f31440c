//! Chords of a relative motion, for lower bounds of the separation of spheres.

use super::ClusterPair;
use crate::enclosure::part;
use crate::hitbox::Sphere;
use crate::narrow_phase::relative::rejection_threshold;
use crate::narrow_phase::sphere_pair::farthest;
use crate::narrow_phase::widened;
use crate::rounding::{norm, normalising_power};
use glam::DVec3;
use std::iter::successors;

/// A piecewise linear approximation of two bodies' relative motion with its deviation, for lower
/// bounds of the separation of spheres.
pub(super) struct PiecewiseLinearBound {
    /// Factor from metres to the chords' unit, in which lengths are near one; and that unit, m.
    pub(super) power: f64,
    unit: f64,
    lines: Vec<Chord>,
    /// Largest deviation of the motion from its chords, in their unit.
    deviation: f64,
    /// Bound on all rounding, m.
    pub(super) slack: f64,
}

#[derive(Clone, Copy, Debug)]
struct Chord {
    start: DVec3,
    change: DVec3,
    /// Inverse of its squared length; 0 if that vanishes.
    inverse: f64,
}

impl Chord {
    /// Returns the point of the chord, moved by an offset, that is nearest to zero.
    #[inline]
    fn nearest_point(&self, offset: DVec3) -> DVec3 {
        let start = self.start + offset;
        let share = -start.dot(self.change) * self.inverse;
        start + self.change * share.clamp(0.0, 1.0)
    }
}

impl PiecewiseLinearBound {
    const MAX: f64 = 8.0;

    /// Returns the chords of a part of the span (first and last instant, s).
    pub(super) fn of(clusters: &ClusterPair<'_>, part: (f64, f64), margin: f64) -> Self {
        let ClusterPair { a, b, .. } = *clusters;
        let reach = |sphere: &Sphere| norm(sphere.offset) + sphere.radius;
        let reach = reach(&a.bounding) + reach(&b.bounding);
        let scale = clusters.scale + reach + margin.abs();
        let power = normalising_power(scale);
        let points = clusters.points_between(part).map(|point| point * power);
        // A cubic deviates from its chord (gone along evenly) no farther than its inner points do: a
        // quarter as far on each of two halves.
        let deviation = |[p0, p1, p2, p3]: [DVec3; 4]| {
            let third = (p3 - p0) / 3.0;
            let (inner, outer) = (p1 - (p0 + third), p2 - (p3 - third));
            inner.length().max(outer.length())
        };
        let largest = |spheres: &[Sphere]| spheres.iter().map(|s| s.radius).fold(0.0, f64::max);
        let wanted = 0.25 * power * (largest(a.spheres) + largest(b.spheres));
        let count = (deviation(points) / wanted).sqrt().ceil();
        let count = if count > 1.0 {
            count.min(Self::MAX)
        } else {
            1.0
        };
        let (mut lines, mut most) = (Vec::new(), 0.0_f64);
        for piece in pieces_of(&points, count) {
            let change = piece[3] - piece[0];
            let square = change.length_squared();
            lines.push(Chord {
                start: piece[0],
                change,
                // Of a subnormal number it would have no end.
                inverse: if square >= f64::MIN_POSITIVE {
                    1.0 / square
                } else {
                    0.0
                },
            });
            most = most.max(deviation(piece));
        }
        Self {
            power,
            unit: 1.0 / power,
            lines,
            deviation: most,
            // A rejection's, twice: the pieces have as many roundings again. Distances that are constant tie
            // within their tolerance, of which a clearance has two: what may matter for a tie has to be seen.
            slack: 2.0 * rejection_threshold(0.0, scale),
        }
    }

    /// Returns a lower bound of the separation of two spheres with this sum of radii, or `None` if
    /// it exceeds `bound` (all m).
    #[inline]
    pub(super) fn low(&self, offset: DVec3, radii: f64, bound: f64) -> Option<f64> {
        let offset = offset * self.power;
        let square = |line: &Chord| line.nearest_point(offset).length_squared();
        let least = self.lines.iter().map(square).fold(f64::INFINITY, f64::min);
        // Most are beyond, which is known without a root.
        let reach = (bound + radii) * self.power + self.deviation;
        let is_beyond = reach < 0.0 || least > reach * reach;
        (!is_beyond).then(|| (least.sqrt() - self.deviation) * self.unit - radii)
    }

    /// Returns a separation beyond which spheres are not the nearest ones over the part, up to the slack, m: that
    /// of two spheres that face each other where the bodies are near.
    pub(super) fn least_of_some(&self, clusters: &ClusterPair<'_>) -> f64 {
        let ClusterPair { a, b, .. } = *clusters;
        let toward = self.nearest_point(a.bounding.offset - b.bounding.offset);
        let toward = toward.normalize_or_zero();
        let reaches = b
            .spheres
            .iter()
            .map(|one| one.radius + one.offset.dot(toward));
        let other = farthest(reaches);
        let other = &b.spheres[other as usize];
        let low = |one: &Sphere| {
            let radii = one.radius + other.radius;
            self.low(one.offset - other.offset, radii, f64::INFINITY)
        };
        let lows = a.spheres.iter().filter_map(low);
        let least = lows.fold(f64::INFINITY, f64::min);
        // A window may begin between an instant and what that is rounded to.
        let least = least + 2.0 * (self.deviation * self.unit + clusters.motion.blur());
        // The error counts twice: the nearest spheres may be farther apart by it, and others nearer by it.
        let error = a.model_error_with(b);
        widened(widened(least, error), error)
    }

    /// Returns an upper bound of the bodies' separation over the part, up to the slack, m.
    pub(super) fn most(&self, clusters: &ClusterPair<'_>) -> f64 {
        /// Spheres of a, of all those in the list, that are compared with all of b.
        const SAMPLES: usize = 8;
        let ClusterPair { a, b, .. } = *clusters;
        let step = a.spheres.len().div_ceil(SAMPLES).max(1);
        let apart = (a.bounding.offset - b.bounding.offset) * self.power;
        let separation = |line: &Chord| {
            // Any two spheres bound it: those near each other at the chord's middle. Unless the bodies
            // overlap, the sphere that reaches farthest towards the other body has one nearby.
            let middle = line.start + 0.5 * line.change;
            let toward = (middle + apart).normalize_or_zero();
            let behind = |sphere: &Sphere| sphere.radius - sphere.offset.dot(toward);
            let facing = &a.spheres[farthest(a.spheres.iter().map(behind)) as usize];
            let mut nearest = (f64::INFINITY, facing, &b.spheres[0]);
            for one in a.spheres.iter().step_by(step).chain([facing]) {
                for other in b.spheres {
                    let point = middle + (one.offset - other.offset) * self.power;
                    let found = point.length() - (one.radius + other.radius) * self.power;
                    if found < nearest.0 {
                        nearest = (found, one, other);
                    }
                }
            }
            let (_, one, other) = nearest;
            let start = line.start + (one.offset - other.offset) * self.power;
            let farther = start.length().max((start + line.change).length());
            (farther + self.deviation) * self.unit - (one.radius + other.radius)
        };
        let separations = self.lines.iter().map(separation);
        // A window may begin between an instant and what that is rounded to.
        separations.fold(f64::NEG_INFINITY, f64::max) + 2.0 * clusters.motion.blur()
    }

    /// Returns the approximate least relative position of two centres, m.
    pub(super) fn nearest_point(&self, offset: DVec3) -> DVec3 {
        let offset = offset * self.power;
        let points = self.lines.iter().map(|line| line.nearest_point(offset));
        let nearer = |x: DVec3, y: DVec3| {
            if y.length_squared() < x.length_squared() {
                y
            } else {
                x
            }
        };
        points.reduce(nearer).unwrap_or_default()
    }
}

/// Returns the control points of `count` equal pieces of a cubic (a whole number), in time order.
fn pieces_of(points: &[DVec3; 4], count: f64) -> impl Iterator<Item = [DVec3; 4]> {
    let begins = successors(Some(0.0), |begin| Some(begin + 1.0));
    let begins = begins.take_while(move |&begin| begin < count);
    begins.map(move |begin| part(points, begin / count, (begin + 1.0) / count))
}
