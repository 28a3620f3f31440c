//! The kernels for one pair, and the exhaustive method for comparison.

use super::closest::closest_approach_of;
use super::enclosures;
use super::within::within_of;
use super::{Enclosure, Real, Verdict};
use crate::guess::{CentredCubic, ControlPoints, distance, local_time, normalised};
use crate::polynomial::roots;

/// Returns the closest approach of a pair: local time in 0..=1, distance in metres. The bits are
/// those of the [batch](super::closest_approach).
#[must_use]
pub fn closest_approach<R: Real>(points: &ControlPoints<R>) -> (R, R) {
    closest_approach_of(points)
}

/// Returns the closest approach of a pair from all stationary points of the distance: local time in
/// 0..=1, distance in metres.
///
/// This is the textbook method: the roots of the degree-5 derivative of the squared distance. The
/// stationary points are found to `tolerance` in local time; 0 is full precision. Of equal minima,
/// the first instant is returned. The points are scaled by a power of two first, to avoid overflow.
#[must_use]
pub fn closest_approach_by_roots(points: &ControlPoints<f64>, tolerance: f64) -> (f64, f64) {
    let (points, unit) = normalised(points);
    let cubic = CentredCubic::new(points);
    let [_, a1, a2, a3, a4, a5, a6] = cubic.squared_distance();
    let slope = [a1, 2.0 * a2, 3.0 * a3, 4.0 * a4, 5.0 * a5, 6.0 * a6];

    let mut best = (-1.0, cubic.square(-1.0));
    let mut consider = |u: f64| {
        let square = cubic.square(u);
        if square < best.1 {
            best = (u, square);
        }
    };
    // A slope that is zero everywhere leaves the first instant.
    roots(slope, 2.0 * tolerance)
        .into_iter()
        .for_each(&mut consider);
    consider(1.0);
    let (u, square) = best;
    (local_time(u), distance(square) * unit)
}

/// Returns proven bounds of the least distance of a pair, for control points with an error of up to
/// `error` metres; see the [batch](super::enclose). The bounds may differ from those of the batch,
/// within the width stated there.
#[must_use]
pub fn enclose(points: &ControlPoints<f64>, error: f64) -> Enclosure {
    enclosures::enclose_pair(points, error, None)
}

/// Decides whether a pair certainly comes nearer than `inner`, or certainly stays farther apart
/// than `outer`, metres; see the [batch](super::within()).
///
/// Certain verdicts agree with those of the batch; either may be undecided by rounding.
#[must_use]
pub fn within<R: Real>(points: &ControlPoints<R>, inner: R, outer: R) -> Verdict {
    within_of(points, inner, outer)
}
