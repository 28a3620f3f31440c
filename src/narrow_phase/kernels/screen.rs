//! Bernstein bounds that show a pair certainly farther apart than a threshold, or certainly nearer.
//!
//! The squared distance of a relative cubic is a sextic, and stays above the least of its seven
//! Bernstein coefficients. Their rounding is counted in the documentation of `kernels`.
#![allow(
    clippy::needless_range_loop,
    reason = "many slices with one index is what is vectorised, and what is easiest to read"
)]

use super::Verdict;
use super::batch::Lanes;
use crate::guess::{ControlPoints, dot, largest_of};
use crate::real::Real;
use crate::simd::{InstructionSet, for_each_instruction_set};

/// First screen: decides on the two halves of the span.
#[inline(always)]
pub(super) fn screen_halves<R: Real>(points: ControlPoints<R>, inner: R, outer: R) -> Verdict {
    let (coefficients, size) = squared_distance(points);
    let (left, right) = halves(coefficients);
    let nearest = left[0].min_or_other(left[6]).min_or_other(right[6]);
    let lowest = least_inside(left)
        .min_or_other(least_inside(right))
        .min_or_other(nearest);
    verdict(lowest, nearest, inner, outer, 16.0, size)
}

/// Second screen: decides on the eight eighths of the span.
#[inline(always)]
pub(super) fn screen_eighths<R: Real>(points: ControlPoints<R>, inner: R, outer: R) -> Verdict {
    let (coefficients, size) = squared_distance(points);
    let (left, right) = halves(coefficients);
    let (low_a, near_a) = quarters(left);
    let (low_b, near_b) = quarters(right);
    verdict(
        low_a.min_or_other(low_b),
        near_a.min_or_other(near_b),
        inner,
        outer,
        32.0,
        size,
    )
}

/// Returns the least coefficient and the least value at a cut, over the four quarters of a piece.
#[inline(always)]
fn quarters<R: Real>(coefficients: [R; 7]) -> (R, R) {
    let (left, right) = halves(coefficients);
    let (a, b) = halves(left);
    let (c, d) = halves(right);
    let inside_a = least_inside(a).min_or_other(least_inside(b));
    let inside_b = least_inside(c).min_or_other(least_inside(d));
    let nearest = (a[0].min_or_other(a[6]))
        .min_or_other(b[6].min_or_other(c[6]))
        .min_or_other(d[6]);
    (
        inside_a.min_or_other(inside_b).min_or_other(nearest),
        nearest,
    )
}

/// Decides by the least coefficient and the least value of the squared distance.
#[inline(always)]
fn verdict<R: Real>(lowest: R, nearest: R, inner: R, outer: R, units: f64, size: R) -> Verdict {
    let u = R::ROUNDING;
    let (zero, one) = (R::from_f64(0.0), R::from_f64(1.0));
    let tolerance = R::from_f64(units) * u * size + R::UNDERFLOW;
    let above = outer * outer * (one + R::from_f64(8.0) * u) + tolerance;
    let below = inner * inner * (one - R::from_f64(8.0) * u) - tolerance;
    // Not a number compares false, and stays undecided; so do infinities.
    let is_served = size < R::LARGE;
    let outside = (lowest > above) & is_served & (outer >= zero);
    let inside = (nearest < below) & is_served & (inner >= zero);
    if outside {
        Verdict::Outside
    } else if inside {
        Verdict::Inside
    } else {
        Verdict::Undecided
    }
}

/// Returns the squared distance's Bernstein coefficients, and the square of the polygon's size.
#[inline(always)]
fn squared_distance<R: Real>(points: ControlPoints<R>) -> ([R; 7], R) {
    let [p0, p1, p2, p3] = points;
    let (d00, d11, d22, d33) = (dot(p0, p0), dot(p1, p1), dot(p2, p2), dot(p3, p3));
    let coefficients = [
        d00,
        dot(p0, p1),
        R::from_f64(0.4) * dot(p0, p2) + R::from_f64(0.6) * d11,
        R::from_f64(0.1) * dot(p0, p3) + R::from_f64(0.9) * dot(p1, p2),
        R::from_f64(0.4) * dot(p1, p3) + R::from_f64(0.6) * d22,
        dot(p2, p3),
        d33,
    ];
    (coefficients, largest_of([d00, d11, d22, d33]))
}

/// Returns the least coefficient that is not a value at an end.
#[inline(always)]
fn least_inside<R: Real>(k: [R; 7]) -> R {
    ((k[1].min_or_other(k[2])).min_or_other(k[3])).min_or_other(k[4].min_or_other(k[5]))
}

/// Returns the Bernstein coefficients on the two halves of the interval.
///
/// Sums first and powers of two last: the results of averages, with fewer products.
#[inline(always)]
fn halves<R: Real>(k: [R; 7]) -> ([R; 7], [R; 7]) {
    let mut left = k;
    let mut right = k;
    let mut step = 1;
    let mut share = 1.0;
    while step < 7 {
        let mut i = 0;
        while i < 7 - step {
            right[i] = right[i] + right[i + 1];
            i += 1;
        }
        share *= 0.5;
        left[step] = R::from_f64(share) * right[0];
        step += 1;
    }
    let mut i = 0;
    while i < 6 {
        right[i] = R::from_f64(share) * right[i];
        share *= 2.0;
        i += 1;
    }
    (left, right)
}

// Two functions: a screen that is an argument is called for each pair, and not vectorised.
for_each_instruction_set! {
    /// Screens each pair of a block on the [halves](screen_halves) of its span.
    fn screen_block<R: Real>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], verdicts: &mut [Verdict]) {
        let count = verdicts.len();
        let lanes = lanes.first(count);
        let (inner, outer) = (&inner[..count], &outer[..count]);
        for i in 0..count {
            verdicts[i] = screen_halves(lanes.control_points(i), inner[i], outer[i]);
        }
    }
}

for_each_instruction_set! {
    /// Screens each pair of a block on the [eighths](screen_eighths) of its span.
    fn screen_block_finely<R: Real>(lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], verdicts: &mut [Verdict]) {
        let count = verdicts.len();
        let lanes = lanes.first(count);
        let (inner, outer) = (&inner[..count], &outer[..count]);
        for i in 0..count {
            verdicts[i] = screen_eighths(lanes.control_points(i), inner[i], outer[i]);
        }
    }
}
