//! Stationary points of the distance of two bodies within a span.
//!
//! The squared distance of two cubics is a polynomial of degree 6; its stationary points are the
//! roots of a polynomial of degree 5, found by Yuksel's recursion. The roots are then polished on
//! h · h' of the relative position vector h itself: the expanded coefficients lose half the digits
//! where the distance is small.

use super::relative::RelativeCubic;
use crate::polynomial::roots;
use crate::rounding::scale_to_one;
use arrayvec::ArrayVec;
use glam::DVec3;

/// Largest number of stationary points inside a span.
pub(crate) const MAX_STATIONARY: usize = 5;

/// Returns the stationary points of the distance inside the span, each minimum polished: increasing
/// local parameters.
pub(crate) fn stationary_points(cubic: &RelativeCubic) -> ArrayVec<f64, MAX_STATIONARY> {
    let mut found = ArrayVec::new();
    let roots = roots(slope(cubic), 0.0);
    for (k, &u) in roots.iter().enumerate() {
        // Polishing never passes a neighbour: the order of minima and maxima stays.
        let last = found.last().copied().unwrap_or(0.0);
        let high = roots.get(k + 1).map_or(1.0, |next| 0.5 + 0.5 * next);
        let s = polish(cubic, 0.5 + 0.5 * u, (last, high));
        if s > last && s < 1.0 && !found.is_full() {
            found.push(s);
        }
    }
    found
}

/// Returns the slope of the squared distance over u = 2 s - 1 in -1..=1, up to a power of two.
///
/// Around the middle of the span the power coefficients stay within a small multiple of the
/// squared size; around an end they would grow 30 times larger, and their rounding with them.
///
/// The degree is 5, and the last coefficient zero. Without it the roots would be found from other
/// guesses, and answers differ in the last digit.
fn slope(cubic: &RelativeCubic) -> [f64; 7] {
    let power = scale_to_one(cubic.size);
    let [p0, p1, p2, p3] = cubic.points.map(|point| point * power);
    let (outer, inner) = (p0 + p3, 3.0 * (p1 + p2));
    let (outer_step, inner_step) = (p3 - p0, 3.0 * (p2 - p1));
    let c: [DVec3; 4] = [
        (outer + inner) * 0.125,
        (3.0 * outer_step + inner_step) * 0.125,
        (3.0 * outer - inner) * 0.125,
        (outer_step - inner_step) * 0.125,
    ];
    [
        2.0 * c[0].dot(c[1]),
        2.0 * (2.0 * c[0].dot(c[2]) + c[1].dot(c[1])),
        3.0 * (2.0 * (c[0].dot(c[3]) + c[1].dot(c[2]))),
        4.0 * (2.0 * c[1].dot(c[3]) + c[2].dot(c[2])),
        5.0 * (2.0 * c[2].dot(c[3])),
        6.0 * c[3].dot(c[3]),
        0.0,
    ]
}

/// Bound, relative to the size of a cubic, of the root of what the squared distance may exceed that at a computed maximum. The
/// slope is off by at most a few hundred roundings of the squared size, and so is what it adds up to up to the maximum.
pub(super) const MAXIMUM_ERROR: f64 = 4e-7;

/// Moves a stationary point of the rounded polynomial onto the minimum of the distance itself.
///
/// Newton on h · h', accepted only while the distance shrinks. At a multiple root (docking) each
/// step only halves the error, hence the number of steps. Maxima are not moved: no answer depends
/// on their exact place. (Bounds that are taken from them have [room](MAXIMUM_ERROR) for it.)
fn polish(cubic: &RelativeCubic, start: f64, (low, high): (f64, f64)) -> f64 {
    const MAX_STEPS: usize = 60;
    let power = scale_to_one(cubic.size);
    let mut s = start.max(low).min(high);
    let motion = cubic.power_forms();
    let (mut position, mut rate) = motion.at(s);
    let mut distance = (position * power).length_squared();
    for _ in 0..MAX_STEPS {
        let (h, h1, h2) = (position * power, rate * power, cubic.curvature(s) * power);
        let slope = h.dot(h1);
        let slope_change = h1.length_squared() + h.dot(h2);
        if slope_change <= 0.0 || slope_change.is_nan() {
            break;
        }
        let next = (s - slope / slope_change).max(low).min(high);
        let (next_position, next_rate) = motion.at(next);
        let next_distance = (next_position * power).length_squared();
        if next_distance.is_nan() || next_distance >= distance {
            break;
        }
        (s, position, rate, distance) = (next, next_position, next_rate, next_distance);
    }
    s
}
