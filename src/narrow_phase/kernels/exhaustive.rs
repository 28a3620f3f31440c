//! The textbook method: all roots of the slope of the squared distance.

use super::cubic::{CentredCubic, ControlPoints, distance, local_time};
use super::refine::{normalised, square_at};
use crate::polynomial::{Polynomial, Roots};

/// Returns the global minimum over the ends and all stationary points: time and distance.
///
/// `tolerance` is that of the stationary points in local time; 0 is full precision. The polygon is
/// scaled by a power of two first, to avoid overflow.
#[inline]
pub(super) fn all_roots(points: &ControlPoints<f64>, tolerance: f64) -> (f64, f64) {
    let (points, unit) = normalised(points);
    let cubic = CentredCubic::new(points);
    let [_, a1, a2, a3, a4, a5, a6] = cubic.squared_distance();
    let slope = Polynomial::new([a1, 2.0 * a2, 3.0 * a3, 4.0 * a4, 5.0 * a5, 6.0 * a6]);

    let mut best = (-1.0, square_at(&cubic, -1.0));
    let mut consider = |u: f64| {
        let square = square_at(&cubic, u);
        if square < best.1 {
            best = (u, square);
        }
    };
    // A slope that is zero everywhere leaves the first instant.
    if let Roots::At(roots) = slope.roots_in(-1.0, 1.0, 2.0 * tolerance) {
        for &u in &roots {
            consider(u);
        }
    }
    consider(1.0);
    let (u, square) = best;
    (local_time(u), distance(square) * unit)
}
