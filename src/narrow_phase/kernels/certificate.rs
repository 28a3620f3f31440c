//! The first try of a closest approach: a guess, certified by deflation.
//!
//! With `d(u)` the squared distance, `u*` the guess and `d* = d(u*)`,
//!
//! `d(u) - d* = (u - u*) r + (u - u*)² q(u)`
//!
//! with a number `r` (the residual slope) and a quartic `q`, from dividing twice by `u - u*`. If
//! the Bernstein coefficients of `q` on both halves of -1..=1 show that it is positive, no other
//! point is lower, but for the residual slope, which is of the order of the rounding.

use crate::guess::{
    CentredCubic, ControlPoints, LaneSquaredDistance, RefinedGuess, descend, lowest_sample, settle,
    squared_distance,
};
use crate::real::Real;

/// Rounding of the slope, as a part of the [tolerance](LaneSquaredDistance) (the derivation is in the
/// documentation of `kernels`).
const SLOPE_TOLERANCE: f32 = 0.75;

/// A guessed closest approach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guess<R> {
    pub(super) settled: RefinedGuess<R>,
    /// Positive if the guess is certainly the global minimum up to rounding; may be NaN.
    pub(super) certificate: f32,
}

/// Guesses from nine samples and certifies on the halves of the span.
#[inline(always)]
pub(super) fn guess<R: Real>(points: ControlPoints<R>) -> Guess<R> {
    let cubic = CentredCubic::new(points);
    let squared_distance = squared_distance::<R>(&cubic.rough());
    let start = lowest_sample(&squared_distance.square);
    let rough = descend(&squared_distance.square, start, R::STEPS);
    let settled = settle(&cubic, R::from_f64(f64::from(rough)));
    Guess {
        settled,
        certificate: certify(
            &squared_distance,
            settled.time.to_f32(),
            settled.tolerance_factor,
        ),
    }
}

/// The quartic left of the squared distance after dividing twice by the time from a guess.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deflated {
    /// Coefficients; of reversed time if `sign` is negative.
    pub(super) quartic: [f32; 5],
    /// At an end of the span, a lower bound of the inward slope; 0 elsewhere. Then
    /// `(u + 1) q + inward` has to be positive.
    pub(super) inward: f32,
    /// -1 if the guess is above 0, else 1: so that an end is always the low one.
    pub(super) sign: f32,
}

impl Deflated {
    /// Returns the quartic at a guess. `tolerance` is that of [`LaneSquaredDistance`].
    #[inline(always)]
    pub(super) fn new(square: &[f32; 7], u: f32, tolerance: f32) -> Self {
        let [_, a1, a2, a3, a4, a5, a6] = *square;
        // The first division by (u - u*), then the second.
        let b4 = a5 + u * a6;
        let b3 = a4 + u * b4;
        let b2 = a3 + u * b3;
        let b1 = a2 + u * b2;
        let b0 = a1 + u * b1;
        let q4 = a6;
        let q3 = b4 + u * q4;
        let q2 = b3 + u * q3;
        let q1 = b2 + u * q2;
        let q0 = b1 + u * q1;
        let r = b0 + u * q0;

        // At an end with the slope inward the product is negative. The slope has a rounding of
        // its own, and enters with factors of up to 20.
        let inward = if u.abs() >= 1.0 { -(r * u) } else { 0.0 };
        let sign = 1.0_f32.copysign(-u);
        Self {
            quartic: [q0, sign * q1, q2, sign * q3, q4],
            inward: (inward - SLOPE_TOLERANCE * tolerance).max_or_other(0.0),
            sign,
        }
    }
}

/// Returns a positive number if the quartic is certainly positive on both halves of the span.
#[inline(always)]
pub(super) fn certify(
    squared_distance: &LaneSquaredDistance,
    u: f32,
    tolerance_factor: f32,
) -> f32 {
    let Deflated {
        quartic: [q0, q1, q2, q3, q4],
        inward,
        ..
    } = Deflated::new(&squared_distance.square, u, squared_distance.tolerance);
    // Bernstein coefficients from the middle outward, to both sides at once.
    let even = [q0 + (1.0 / 6.0) * q2, q0 + 0.5 * q2, q0 + (q2 + q4)];
    let odd = [0.25 * q1, 0.5 * q1, 0.75 * q1 + 0.25 * q3, q1 + q3];
    // Where the slope is inward, `inward / (u + 1)` is added. Above the middle it is not below the
    // quartic with the coefficients 1, 0.75, 0.65, 0.55, 0.5 times `inward`: `u + 1` times that has
    // the coefficients 1, 1, 0.99, 1, 0.98, 1.
    let high = [
        q0 + inward,
        (q0 + odd[0]) + 0.75 * inward,
        (even[0] + odd[1]) + 0.65 * inward,
        (even[1] + odd[2]) + 0.55 * inward,
        (even[2] + odd[3]) + 0.5 * inward,
    ];
    // On the side of the end `(u + 1) q + inward` is a quintic: coefficient i, from the end on, is
    // i / 5 times that of the quartic, plus `inward`. The middle counts once.
    let low = [
        (q0 - odd[0]) + (5.0 / 4.0) * inward,
        (even[0] - odd[1]) + (5.0 / 3.0) * inward,
        (even[1] - odd[2]) + (5.0 / 2.0) * inward,
        (even[2] - odd[3]) + 5.0 * inward,
    ];
    // The second coefficient of a half, from its end on, may be as far below 0 as the lesser of the
    // two next to it is above: these make up for it, since the product of the first and the third
    // Bernstein polynomial is 3 / 8 of the square of the second, and their sum not less than twice
    // the root of the product. The factor `u + 1` changes nothing in that.
    let [h0, h1, h2, h3, h4] = high;
    let [l3, l2, l1, l0] = low;
    let (beside_high, beside_low) = (h0.min_or_other(h2), l0.min_or_other(l2));
    let second = (0.5 * (h1 + beside_high)).min_or_other(0.5 * (l1 + beside_low));
    let least = (beside_high.min_or_other(beside_low))
        .min_or_other(h3.min_or_other(h4))
        .min_or_other(second.min_or_other(l3));
    least - squared_distance.tolerance * tolerance_factor
}
