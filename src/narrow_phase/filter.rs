//! Cheap tests that may only reject what is certainly apart.
//!
//! Each looks at the Bézier hull of the relative motion over a span or a part of one. What they
//! let through goes to the exact solver; see [`CLEARANCE`](crate::rounding::CLEARANCE) for why
//! they never reject what the solver would report.

use super::relative::RelativeCubic;
use crate::rounding::{UNIT_ROUNDOFF, norm, normalising_power};
use glam::DVec3;

/// Whether the two bodies stay farther apart than `threshold` (m) all along the cubic.
///
/// `threshold` is that of [`filter_threshold`](super::relative::filter_threshold).
pub(crate) fn certainly_beyond(cubic: &RelativeCubic, threshold: f64) -> bool {
    beyond_on_an_axis(cubic, threshold)
        || beyond_in_a_direction(cubic, threshold)
        || beyond_by_coefficients(cubic, threshold)
}

/// The hull's axis-aligned box lies beyond the threshold on one axis.
fn beyond_on_an_axis(cubic: &RelativeCubic, threshold: f64) -> bool {
    let [p0, p1, p2, p3] = cubic.points;
    let low = p0.min(p1).min(p2.min(p3));
    let high = p0.max(p1).max(p2.max(p3));
    low.max_element() > threshold || high.min_element() < -threshold
}

/// All control points lie beyond the threshold in the direction of their sum.
fn beyond_in_a_direction(cubic: &RelativeCubic, threshold: f64) -> bool {
    let sum = (cubic.points[0] + cubic.points[3]) + (cubic.points[1] + cubic.points[2]);
    let length = norm(sum);
    if length <= 0.0 || !length.is_finite() {
        return false;
    }
    // The unit vector is good to a few roundings, which the threshold's clearance covers.
    let direction = sum / length;
    cubic
        .points
        .iter()
        .all(|point| point.dot(direction) > threshold)
}

/// The smallest Bernstein coefficient of the squared distance lies beyond the squared threshold.
fn beyond_by_coefficients(cubic: &RelativeCubic, threshold: f64) -> bool {
    let power = normalising_power(cubic.size);
    let coefficients = squared_distance(cubic.points.map(|point| point * power));
    let least = coefficients.iter().copied().fold(f64::INFINITY, f64::min);
    // The scaled size is below 2: its square below 4. 7 roundings of it for the coefficients
    // (numerics, section 5), 16 of the threshold's square.
    let radius = threshold * power;
    least > radius * radius * (1.0 + 16.0 * UNIT_ROUNDOFF) + 128.0 * UNIT_ROUNDOFF
}

/// Bernstein coefficients of the squared distance, degree 6, from the control points.
fn squared_distance(h: [DVec3; 4]) -> [f64; 7] {
    [
        h[0].dot(h[0]),
        h[0].dot(h[1]),
        (2.0 * h[0].dot(h[2]) + 3.0 * h[1].dot(h[1])) * 0.2,
        (h[0].dot(h[3]) + 9.0 * h[1].dot(h[2])) * 0.1,
        (2.0 * h[1].dot(h[3]) + 3.0 * h[2].dot(h[2])) * 0.2,
        h[2].dot(h[3]),
        h[3].dot(h[3]),
    ]
}
