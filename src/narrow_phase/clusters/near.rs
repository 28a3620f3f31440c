//! Lists of the spheres of two bodies that may be near the other body.

use crate::narrow_phase::approach::retain_from;
use glam::DVec3;

/// The spheres of two bodies that may be near the other body in an interval.
#[derive(Debug, Default)]
pub(super) struct NearSpheres {
    pub(super) listed: [Vec<ListedSphere>; 2],
    /// The sphere of each body that reaches farthest towards the other one; the two are probably among the nearest.
    pub(super) foremost: [ListedSphere; 2],
    /// Direction of the supports: a unit vector, up to rounding, or zero.
    pub(super) direction: DVec3,
}

/// A sphere that may be near the other body in an interval.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ListedSphere {
    pub(super) number: u32,
    /// Support along a direction, m: see [`SpheresOverPart::find_supports`](super::part::SpheresOverPart::find_supports).
    pub(super) support: f64,
}

/// The path of a sphere's centre in an interval, in the unit of lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpherePath {
    points: [DVec3; 4],
    /// From the first point to the last one.
    chord: DVec3,
    /// Bound of the path's deviation from the chord, gone along evenly.
    deviation: f64,
    /// Radius of the sphere.
    radius: f64,
}

impl SpherePath {
    #[inline(always)]
    pub(super) fn new(points: [DVec3; 4], radius: f64) -> Self {
        Self {
            points,
            chord: points[3] - points[0],
            deviation: deviation(&points),
            radius,
        }
    }

    /// Returns the control points relative to those of another path.
    #[inline]
    pub(super) fn relative_to(&self, other: &Self) -> [DVec3; 4] {
        let ([p0, p1, p2, p3], [q0, q1, q2, q3]) = (self.points, other.points);
        [p0 - q0, p1 - q1, p2 - q2, p3 - q3]
    }

    /// Returns a lower bound of the distance of two centres, or `None` if the separation exceeds a threshold.
    #[inline(always)]
    pub(super) fn distance_within(&self, other: &Self, threshold: f64) -> Option<f64> {
        let (square, deviation) = self.least_on_chords(other);
        let reach = (threshold + self.radius) + (other.radius + deviation);
        (reach >= 0.0 && square <= reach * reach).then(|| square.sqrt() - deviation)
    }

    /// Returns a separation that two spheres come within.
    pub(super) fn separation_reached(&self, other: &Self) -> f64 {
        let (square, deviation) = self.least_on_chords(other);
        square.sqrt() + deviation - (self.radius + other.radius)
    }

    /// Returns the squared least distance of two centres if they were on their chords, and how far both deviate from these.
    #[inline(always)]
    fn least_on_chords(&self, other: &Self) -> (f64, f64) {
        let (start, change) = (self.points[0] - other.points[0], self.chord - other.chord);
        // A change that vanishes makes a share without number, which `max` drops.
        let share = (-start.dot(change) / change.length_squared()).max(0.0);
        let nearest = start + change * share.min(1.0);
        (nearest.length_squared(), self.deviation + other.deviation)
    }
}

/// Returns a bound of a cubic's deviation from its chord, gone along evenly: that of the inner control points.
#[inline]
pub(super) fn deviation([p0, p1, p2, p3]: &[DVec3; 4]) -> f64 {
    let third = (*p3 - *p0) / 3.0;
    let (inner, outer) = (*p1 - (*p0 + third), *p2 - (*p3 - third));
    let largest = inner.length_squared().max(outer.length_squared());
    largest.sqrt()
}

impl NearSpheres {
    /// Returns the numbers of the two foremost spheres.
    pub(super) fn facing(&self) -> (u32, u32) {
        self.foremost.map(|one| one.number).into()
    }

    /// Returns the number of pairs.
    pub(super) fn pairs(&self) -> usize {
        self.listed[0].len() * self.listed[1].len()
    }

    /// Removes the spheres that are farther than `bound` (m) from all of the other body's.
    pub(super) fn remove_far(&mut self, bound: f64) {
        let [a, b] = &mut self.listed;
        // These two are not removed, unless all are.
        let [nearest, farthest] = self.foremost.map(|one| one.support);
        retain_from(0, a, |_, one| one.support - farthest <= bound);
        retain_from(0, b, |_, one| nearest - one.support <= bound);
    }
}
