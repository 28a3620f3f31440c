//! Pairs of spheres that may come within a margin, and which of them may be the nearest ones.

use super::proven::BoundStep;
use crate::blossom::divide;
use crate::enclosure::squared_distance;
use crate::narrow_phase::approach::retain_from;
use crate::narrow_phase::sphere_pair::difference_of_squares;
use crate::real::least_of;
use crate::rounding::UNIT_ROUNDOFF;
use arrayvec::ArrayVec;
use glam::DVec3;
use std::array;

/// Largest number of times that an interval is halved to find the nearest candidates: rounding allows no more.
pub(super) const HALVINGS: u32 = 3;

/// Two spheres that may come within the margin.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphereCandidate {
    /// Numbers of a's sphere and b's.
    pub(super) spheres: (u32, u32),
    /// Bernstein coefficients of the squared distance, in the square of the unit of lengths.
    pub(super) bernstein: [f64; 7],
    /// Lower bound of the distance, at least 0, in the unit of lengths.
    pub(super) distance: f64,
    /// Bound of the coefficients' rounding.
    pub(super) rounding: f64,
    /// Sum of the radii, in the unit of lengths.
    pub(super) radii: f64,
}

impl SphereCandidate {
    /// Returns two spheres with this sum of radii; `points` are the control points of their relative position, and
    /// `distance` is a lower bound of its length, in the unit of lengths.
    #[inline]
    pub(super) fn new(spheres: (u32, u32), points: &[DVec3; 4], radii: f64, distance: f64) -> Self {
        let bernstein = squared_distance(points);
        Self {
            spheres,
            bernstein,
            distance: least_of(bernstein).max(0.0).sqrt().max(distance),
            rounding: rounding_of_coefficients(points),
            radii,
        }
    }

    /// Returns a lower bound of the separation, in the unit of lengths.
    pub(super) fn least(&self) -> f64 {
        self.distance - self.radii
    }

    /// Returns true if the spheres may come as near as they must in a step of the interval, to matter there. `within` turns
    /// a bound (m) into a separation in the unit of lengths.
    pub(super) fn comes_within(&self, steps: &[BoundStep], within: impl Fn(f64) -> f64) -> bool {
        let (mut bernstein, mut start) = (self.bernstein, 0.0);
        for &BoundStep { end, bound } in steps {
            let mut step = bernstein;
            if end < 1.0 {
                let share = (end - start) / (1.0 - start);
                [step, bernstein] = divide(bernstein, share);
            }
            start = end;
            let distance = within(bound) + self.radii;
            // Of the coefficients, of a split for each step before, and of the halvings of `is_above`: at most 202 units.
            let square = distance * distance + 8.0 * self.rounding;
            if distance >= 0.0 && !is_above(&step, square, 2) {
                return true;
            }
        }
        false
    }

    /// Returns what tells how near the spheres are at the start, in the middle and at the end of the part: the
    /// squared distance less the squared sum of the radii.
    fn powers(&self) -> [f64; 3] {
        let [h0, h1, h2, h3, h4, h5, h6] = self.bernstein;
        let middle = (((h0 + h6) + 6.0 * (h1 + h5)) + (15.0 * (h2 + h4) + 20.0 * h3)) / 64.0;
        [h0, middle, h6].map(|square| square - self.radii * self.radii)
    }

    /// Returns a bound of the distance, to rounding, in the unit of lengths.
    fn farthest(&self) -> f64 {
        self.bernstein.into_iter().fold(0.0, f64::max).sqrt()
    }

    /// Returns true if another pair, which stays within a distance, is nearer by more than `slack` over the
    /// whole part.
    fn is_behind(&self, (near, distance): &(Self, f64), slack: f64) -> bool {
        let excess = (self.radii - near.radii).max(0.0) + slack;
        let rounding = self.rounding + near.rounding;
        let least = difference_of_squares(*distance, excess) + rounding;
        // Without a branch: the processor cannot predict which one is behind.
        let above: [f64; 7] = array::from_fn(|k| self.bernstein[k] - near.bernstein[k]);
        least_of(above) > least
    }
}

/// Returns true if a polynomial is above a bound, as can be told by halving the interval so many times.
fn is_above(bernstein: &[f64; 7], bound: f64, halvings: u32) -> bool {
    if bernstein.iter().all(|&coefficient| coefficient > bound) {
        return true;
    }
    // Its ends are its values there.
    halvings > 0
        && bernstein[0] > bound
        && bernstein[6] > bound
        && divide(*bernstein, 0.5)
            .iter()
            .all(|half| is_above(half, bound, halvings - 1))
}

/// Removes the candidates from `first` on in a list of which another one is nearer by more than `slack` all the time.
pub(super) fn remove_behind(candidates: &mut Vec<SphereCandidate>, first: usize, slack: f64) {
    // Those that are nearest, or nearly so, at three instants.
    let mut nearest = [(f64::INFINITY, first); 3];
    for (place, candidate) in candidates.iter().enumerate().skip(first) {
        for (nearest, power) in nearest.iter_mut().zip(candidate.powers()) {
            if power < nearest.0 {
                *nearest = (power, place);
            }
        }
    }
    let mut compared = ArrayVec::<_, 3>::new();
    for (number, (_, place)) in nearest.iter().enumerate() {
        if nearest[..number].iter().all(|(_, other)| other != place) {
            compared.push((candidates[*place], candidates[*place].farthest()));
        }
    }
    retain_from(first, candidates, |_, one| {
        !compared.iter().any(|near| one.is_behind(near, slack))
    });
}

/// Moves the pairs of spheres from `first` on in a list that may be the nearest ones at some time to `nearest`: no
/// other one is nearer by more than `slack` all the time. If they are not few, halves of the interval are
/// looked at one by one, and halves of these, so many times. Some pairs come several times.
pub(super) fn find_nearest(
    candidates: &mut Vec<SphereCandidate>,
    first: usize,
    slack: f64,
    halvings: u32,
    nearest: &mut Vec<(u32, u32)>,
) {
    /// Largest number of candidates of which all may be the nearest ones.
    const FEW: usize = 2;
    if candidates.len() - first > FEW {
        remove_behind(candidates, first, slack);
    }
    let end = candidates.len();
    if halvings == 0 || end - first <= FEW {
        nearest.extend(candidates.drain(first..).map(|one| one.spheres));
        return;
    }
    for place in first..end {
        let one = candidates[place];
        let [before, after] = divide(one.bernstein, 0.5);
        candidates[place].bernstein = before;
        candidates.push(SphereCandidate {
            bernstein: after,
            ..one
        });
    }
    for first in [end, first] {
        find_nearest(candidates, first, slack, halvings - 1, nearest);
    }
}

/// Returns a bound of the rounding of coefficients, of a part or of what is left of it after so many [halvings](HALVINGS): 32 units
/// of the largest square.
pub(super) fn rounding_of_coefficients(points: &[DVec3; 4]) -> f64 {
    // Of the largest square: 10 of the coefficients of the part, 6 of their means each time.
    let squares = points.map(DVec3::length_squared);
    32.0 * UNIT_ROUNDOFF * squares.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow_phase::relative::rejection_threshold;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Centres that meet at half time, and two spheres that stay at a tiny distance: at that instant they are
    /// farther, whatever the rounding of coefficients.
    #[test]
    fn spheres_that_meet_between_two_halves_are_not_behind() {
        let candidate = |points: [DVec3; 4]| SphereCandidate::new((0, 0), &points, 0.5, 0.0);
        let near = candidate([DVec3::new(0.0, 1e-10, 0.0); 4]);
        let slack = rejection_threshold(0.0, 1.0);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for round in 0..1_000 {
            let way = DVec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0)));
            let meeting = candidate([-way, way / -3.0, way / 3.0, way]);
            for bernstein in divide(meeting.bernstein, 0.5) {
                let half = SphereCandidate {
                    bernstein,
                    ..meeting
                };
                let is_behind = half.is_behind(&(near, near.farthest()), slack);
                assert!(!is_behind, "{round} {way}");
            }
        }
    }
}
