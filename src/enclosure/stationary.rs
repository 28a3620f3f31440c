//! Bounds on the place of a minimiser by slope and curvature (module documentation, section 5).

use super::scaled::{SECOND_ORDER, TINY, norm_above};
use crate::blossom::ControlPolygon;
use crate::real::Real;
use crate::rounding::UNIT_ROUNDOFF;

/// Returns a bound on the distance of minimisers from the base, by the derivative.
///
/// `points` is a part counted from its base, and `error` a bound on its distance from the exact
/// cubic. All minimisers of the exact distance must lie within `range` of the base, in the part's
/// parameter, on either side. If the squared distance is certainly convex over that range, its
/// slope at the base gives the bound; otherwise `range` is returned.
pub(super) fn stationary_reach(points: &ControlPolygon, error: f64, range: f64) -> f64 {
    let k0 = points[0];
    let d1 = points[1] - k0;
    let second = (points[2] - k0) - 2.0 * d1;
    let third = (points[3] - k0) - 3.0 * (points[2] - k0) + 3.0 * d1;
    let (norm, n1, n2, n3) = (
        norm_above(k0),
        norm_above(d1) * 3.0,
        norm_above(second) * 6.0,
        norm_above(third) * 6.0,
    );
    // Upper bounds of the exact cubic's derivatives at the base, by Markov's inequality for the
    // error, a cubic that stays below `error` on the part: 18, 96, 192 times it. The computed
    // differences are wrong by less than 128u of the norms that enter.
    let rounding = 128.0
        * UNIT_ROUNDOFF
        * (norm_above(points[1]) + norm_above(points[2]) + norm + norm_above(points[3]));
    let (e1, e2, e3) = (
        18.0 * error + rounding,
        96.0 * error + rounding,
        192.0 * error + rounding,
    );
    let (u0, u1, u2, u3) = (norm + error, n1 + e1, n2 + e2, n3 + e3);
    // Half the slope of the squared distance at the base: value and error.
    let slope = 3.0 * k0.dot(d1).abs() + error * u1 + u0 * e1;
    // Half its second derivative: |h'|² + h·h'', less what the error and the range can take away.
    let slope_change = 9.0 * d1.dot(d1) + 6.0 * k0.dot(second);
    let uncertain = 2.0 * u1 * e1 + error * u2 + u0 * e2;
    let (v0, v1, v2) = (
        u0 + range * (u1 + range * (u2 + range * u3)),
        u1 + range * (u2 + range * u3),
        u2 + range * u3,
    );
    let lost = range * (3.0 * v1 * v2 + v0 * u3);
    let certain = slope_change - (uncertain + lost) * SECOND_ORDER - TINY;
    if certain > 0.0 {
        (slope / certain * SECOND_ORDER + TINY).min_or_other(range)
    } else {
        range
    }
}
