//! The lower envelope of all pairs' separations: the pairs that are nearest at some time.

use super::chords::{PiecewiseLinearBound, pieces_of};
use super::{ClusterPair, SpherePairBound};
use crate::narrow_phase::sphere_pair::difference_of_squares;
use glam::DVec3;

/// Pieces of a span, each with the nearest pairs of spheres at its ends.
pub(super) struct Envelope<'a> {
    clusters: &'a ClusterPair<'a>,
    pieces: Vec<EnvelopePart>,
    /// Factor from metres to the unit of all lengths here, in which they are near one.
    power: f64,
    /// Least difference of two distances that is more than rounding.
    slack: f64,
}

#[derive(Clone, Copy, Debug)]
struct EnvelopePart {
    /// Control points of the bodies' relative motion.
    points: [DVec3; 4],
    /// The nearest pairs of spheres, each with the largest distance of its centres in the piece, to rounding.
    nearest: [(SphereOffset, f64); 2],
}

/// Offset of the centres and sum of the radii of two spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SphereOffset {
    offset: DVec3,
    radii: f64,
}

impl<'a> Envelope<'a> {
    const MAX: f64 = 16.0;

    /// Returns the envelope of the candidates over the whole span.
    pub(super) fn of(
        clusters: &'a ClusterPair<'a>,
        chords: &PiecewiseLinearBound,
        candidates: &[SpherePairBound],
    ) -> Self {
        let power = chords.power;
        let near = |candidate: &SpherePairBound| near(clusters, candidate, power);
        let all: Vec<SphereOffset> = candidates.iter().map(near).collect();
        let points = clusters.motion.points(DVec3::ZERO);
        let points = points.map(|point| point * power);
        let widest = all.iter().map(|near| near.radii).fold(0.0, f64::max);
        let way = points.windows(2).map(|two| two[0].distance(two[1]));
        // No number where nothing moves, or the spheres are points.
        let count = (way.sum::<f64>() / widest).ceil();
        let count = if count >= 1.0 {
            count.min(Self::MAX)
        } else {
            1.0
        };
        let nearest_at = |point: DVec3| {
            let separation = |near: &SphereOffset| (point + near.offset).length() - near.radii;
            let all = all.iter().map(|near| (separation(near), *near));
            let nearer =
                |x: (f64, SphereOffset), y: (f64, SphereOffset)| if y.0 < x.0 { y } else { x };
            all.reduce(nearer).map(|(_, near)| near)
        };
        let mut pieces = Vec::new();
        let mut before = nearest_at(points[0]);
        for points in pieces_of(&points, count) {
            let after = nearest_at(points[3]);
            if let (Some(first), Some(last)) = (before, after) {
                let nearest = [first, last].map(|near| {
                    let squares = points.map(|point| (point + near.offset).length_squared());
                    (near, squares.into_iter().fold(0.0, f64::max).sqrt())
                });
                pieces.push(EnvelopePart { points, nearest });
            }
            before = after;
        }
        Self {
            clusters,
            pieces,
            power,
            // A window may begin between an instant and what that is rounded to.
            slack: (chords.slack + 2.0 * clusters.motion.blur()) * power,
        }
    }

    /// Returns true if another pair is certainly nearer than this one at all times.
    pub(super) fn is_above(&self, candidate: &SpherePairBound) -> bool {
        let far = near(self.clusters, candidate, self.power);
        self.pieces.iter().all(|piece| {
            let mut nearest = piece.nearest.iter();
            nearest.any(|near| piece.is_nearer(near, &far, self.slack))
        })
    }
}

fn near(clusters: &ClusterPair<'_>, candidate: &SpherePairBound, power: f64) -> SphereOffset {
    let (a, b) = clusters.spheres(candidate);
    SphereOffset {
        offset: (a.offset - b.offset) * power,
        radii: (a.radius + b.radius) * power,
    }
}

impl EnvelopePart {
    /// Returns true if the pair `near`, whose centres are within a distance, has a smaller separation
    /// than the pair `far`, by `slack`, along the whole piece. The difference of the squared distances is
    /// linear in the motion.
    fn is_nearer(
        &self,
        &(near, distance): &(SphereOffset, f64),
        far: &SphereOffset,
        slack: f64,
    ) -> bool {
        let across = far.offset - near.offset;
        let middle = 0.5 * (far.offset + near.offset);
        let excess = (far.radii - near.radii).max(0.0) + slack;
        let least = 0.5 * difference_of_squares(distance, excess);
        let points = self.points.iter();
        points
            .map(|&point| point + middle)
            .all(|point| point.dot(across) > least)
    }
}
