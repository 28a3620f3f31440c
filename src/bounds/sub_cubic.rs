//! Parts of a compact trajectory's cubics.

use super::compact_cubic::CompactCubic;
use super::slice_interval::SliceInterval;
use super::{ROUNDING, nearest};
use glam::Vec4;

/// A cubic or a part of one: control points relative to a body's anchor, in the frame's unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SubCubic {
    pub(super) points: [Vec4; 4],
    /// At least half the largest distance between two points. Rounding is relative to this magnitude and to
    /// the coordinates.
    pub(super) spread: f32,
    /// Number of splits by which the part was cut from its cubic: each adds rounding.
    pub(super) splits: f32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl SubCubic {
    /// Roundings of the points at first, and per split: of coordinates and of `spread`.
    ///
    /// Coordinates: one per point of a compact trajectory. A split has three steps of de Casteljau, each
    /// with one rounding of its sum. Two more for the sums of a box, or three for the line of a fat
    /// line and one for its origin, and one spare.
    ///
    /// Spread: differences of points are at most 2. At each step a difference and its product with
    /// the share are rounded, 3 (2 + 2). The share's own rounding moves a point by up to 6.
    /// Coordinates of a part may be smaller than the rounded ones, by 2 for each rounding of these: 2 at
    /// first, with 2 spare. Of a split's, the count for the share has 3 to spare: a share below 1 is rounded
    /// half as much as counted.
    pub(super) const OF_COORDINATES: [f32; 2] = [6.0, 3.0];
    pub(super) const OF_SPREAD: [f32; 2] = [4.0, 24.0];

    /// Returns a cubic that f32 does not serve: its bounds are infinite.
    pub(super) const fn anywhere((from, to): (f64, f64)) -> Self {
        Self {
            points: [Vec4::ZERO; 4],
            spread: f32::INFINITY,
            splits: 0.0,
            from,
            to,
        }
    }

    #[inline(always)]
    pub(super) fn whole(compact_cubic: &CompactCubic, (from, to): (f64, f64), factor: f32) -> Self {
        let (points, spread) = compact_cubic.points(factor);
        Self {
            points,
            spread,
            splits: 0.0,
            from,
            to,
        }
    }

    /// Returns the last instant, s.
    #[inline(always)]
    pub(crate) const fn end(&self) -> f64 {
        self.to
    }

    /// Returns true if the cubic covers the whole slice, and the slice has a duration.
    #[inline(always)]
    pub(crate) fn fills<const MOVES: bool>(&self, slice_interval: &SliceInterval<MOVES>) -> bool {
        slice_interval.rate > 0.0
            && self.from <= slice_interval.from
            && self.to >= slice_interval.to
    }

    /// Returns the part between two instants (s).
    #[inline]
    pub(super) fn part(self, from: f64, to: f64) -> Self {
        let rest = if from > self.from {
            self.split(from).1
        } else {
            self
        };
        if to < rest.to { rest.split(to).0 } else { rest }
    }

    /// Returns a bound on the rounding error of each coordinate of the points.
    #[inline]
    pub(super) fn rounding(&self) -> Vec4 {
        let [p0, p1, p2, p3] = self.points.map(Vec4::abs);
        Self::roundings(p0.max(p1).max(p2.max(p3)), self.spread, self.splits)
    }

    /// Returns that bound for points with these largest coordinates.
    #[inline(always)]
    pub(super) fn roundings(largest: Vec4, spread: f32, splits: f32) -> Vec4 {
        let count = |[once, each]: [f32; 2]| ROUNDING * (once + each * splits);
        largest * count(Self::OF_COORDINATES) + spread * count(Self::OF_SPREAD)
    }

    /// Returns the parts before and after an instant (s).
    #[inline(always)]
    pub(crate) fn split(&self, time: f64) -> (Self, Self) {
        let share = if time > self.from {
            nearest((time - self.from) / (self.to - self.from))
        } else {
            0.0
        };
        let between = |x: Vec4, y: Vec4| x + (y - x) * share;
        let [p0, p1, p2, p3] = self.points;
        let (q0, q1, q2) = (between(p0, p1), between(p1, p2), between(p2, p3));
        let (r0, r1) = (between(q0, q1), between(q1, q2));
        let middle = between(r0, r1);
        let part = |points, from, to| Self {
            points,
            spread: self.spread,
            splits: self.splits + 1.0,
            from,
            to,
        };
        (
            part([p0, q0, r0, middle], self.from, time),
            part([middle, r1, q2, p3], time, self.to),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::{Exact, number};
    use glam::{DVec3, Vec3};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn wide(point: Vec4) -> DVec3 {
        point.truncate().as_dvec3()
    }

    /// Repeated splits of a small and distant cubic, or through zero: the rounding bound holds.
    #[test]
    fn splits_are_within_their_rounding() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for round in 0..600 {
            let far = [0.0, 1e4][round % 2];
            let mut vector =
                |half: f32| Vec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)));
            let position = vector(far);
            let points = [0; 4].map(|_| (position + vector(1.0)).extend(0.0));
            let exact = points.map(|point| Exact::of(wide(point)));
            let spread = points.map(|point| wide(point).distance(wide(points[0])));
            let whole = SubCubic {
                points,
                spread: nearest(spread.into_iter().fold(0.0, f64::max)),
                splits: 0.0,
                from: 0.0,
                to: 1.0,
            };
            let mut rest = whole;
            for _ in 0..[1, 8, 60][round % 3] {
                let share = rng.random_range(0.0..1.0) * [1.0, 0.5, 0.02][round % 3];
                let time = rest.from + (rest.to - rest.from) * share;
                let ahead = rest.split(time);
                for piece in [ahead.0, ahead.1] {
                    let ends = [number(piece.from), number(piece.to)];
                    let largest = piece.points.map(Vec4::abs).into_iter();
                    let largest = largest.reduce(Vec4::max).unwrap_or_default();
                    let all = SubCubic::roundings(largest, piece.spread, piece.splits);
                    let once = SubCubic::roundings(largest, piece.spread, 0.0);
                    for (j, point) in piece.points.into_iter().enumerate() {
                        let off = Exact::of(wide(point)).minus(&Exact::blossom(&exact, j, &ends));
                        let holds = off.is_within_box(wide(all - once));
                        assert!(holds, "{round} {piece:?} {off:?}");
                    }
                }
                rest = ahead.1;
            }
        }
    }
}
