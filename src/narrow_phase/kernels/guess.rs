//! The guess: the lowest of a few samples, refined, and certified by deflation.
//!
//! With `d(u)` the squared distance, `u*` the guess and `d* = d(u*)`,
//!
//! `d(u) - d* = (u - u*) r + (u - u*)² q(u)`
//!
//! with a number `r` (the residual slope) and a quartic `q`, from dividing twice by `u - u*`. If
//! the Bernstein coefficients of `q` on pieces of -1..=1 are all positive, no other point is
//! lower, but for the residual slope, which is of the order of the rounding.
//!
//! The three stages are functions of their own, so that a block of pairs can pass them one after
//! the other: many short dependency chains at once instead of a long one.

use super::cubic::{CentredCubic, ControlPoints, dot};
use super::real::Real;

/// Units of rounding of the deflated coefficients, and that of the slope as a part of it (the
/// derivation is in the documentation of `kernels`).
const MARGIN: f64 = 36.0;
const SLOPE_MARGIN: f64 = 0.75;

/// A guessed closest approach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guess<R> {
    /// The centred local time, -1..=1.
    pub(super) time: R,
    /// 64 times the squared distance there.
    pub(super) square: R,
    /// Positive if the guess is certainly the global minimum up to rounding; may be NaN.
    pub(super) certificate: R,
}

/// A refined guess without its certificate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled<R> {
    pub(super) time: R,
    pub(super) square: R,
    /// What the least deflated coefficient has to exceed; infinite if the refinement has not settled.
    pub(super) margin: R,
}

/// Guesses from `2 HALF + 1` samples and certifies on `PIECES` pieces (2 or 8).
#[inline(always)]
pub(super) fn guess<R: Real, const HALF: usize, const PIECES: usize>(
    points: ControlPoints<R>,
) -> Guess<R> {
    let cubic = CentredCubic::new(points);
    let square = cubic.squared_distance();
    let start = lowest_sample::<R, HALF>(&square);
    let rough = descend::<R, HALF>(&square, start);
    let settled = settle(&cubic, &square, rough);
    Guess {
        time: settled.time,
        square: settled.square,
        certificate: certify::<R, PIECES>(&square, settled.time, settled.margin),
    }
}

/// First stage: the lowest of the samples at `0, ±1/HALF, …, ±1` of a squared distance.
#[inline(always)]
pub(super) fn lowest_sample<R: Real, const HALF: usize>(square: &[R; 7]) -> R {
    let [a0, a1, a2, a3, a4, a5, a6] = *square;
    let mut best = a0;
    let mut time = R::from_f64(0.0);
    let mut tilt = R::from_f64(0.0);
    let mut i = 1;
    while i <= HALF {
        // Even and odd powers apart serve u and -u at once: the sign of the odd part says which
        // of the two is lower.
        let u = R::from_f64(i as f64 / HALF as f64);
        let v = R::from_f64((i * i) as f64 / (HALF * HALF) as f64);
        let even = a0 + v * (a2 + v * (a4 + v * a6));
        let odd = a1 + v * (a3 + v * a5);
        let lower = even - u * odd.abs();
        time = if lower < best { u } else { time };
        tilt = if lower < best { odd } else { tilt };
        best = if lower < best { lower } else { best };
        i += 1;
    }
    if tilt > R::from_f64(0.0) { -time } else { time }
}

/// Second stage: two Halley steps on the slope of the squared distance, kept between the
/// neighbours of the sample and on the falling side.
#[inline(always)]
pub(super) fn descend<R: Real, const HALF: usize>(square: &[R; 7], start: R) -> R {
    let [_, a1, a2, a3, a4, a5, a6] = *square;
    let one = R::from_f64(1.0);
    let spacing = R::from_f64(1.0 / HALF as f64);
    let mut low = (start - spacing).or_more(-one);
    let mut high = (start + spacing).or_less(one);
    // The slope, its derivative, and half its second derivative.
    let s1 = R::from_f64(2.0) * a2;
    let s2 = R::from_f64(3.0) * a3;
    let s3 = R::from_f64(4.0) * a4;
    let s4 = R::from_f64(5.0) * a5;
    let s5 = R::from_f64(6.0) * a6;
    let f1 = R::from_f64(6.0) * a3;
    let f2 = R::from_f64(12.0) * a4;
    let f3 = R::from_f64(20.0) * a5;
    let f4 = R::from_f64(30.0) * a6;
    let c2 = R::from_f64(30.0) * a5;
    let c3 = R::from_f64(60.0) * a6;
    let mut u = start;
    let mut step = 0;
    while step < 2 {
        let v = u * u;
        let value = (a1 + u * s1) + v * ((s2 + u * s3) + v * (s4 + u * s5));
        let first = (s1 + u * f1) + v * ((f2 + u * f3) + v * f4);
        let second = (s2 + u * f2) + v * (c2 + u * c3);
        let next = u - value * first / (first * first - value * second);
        let rising = value > R::from_f64(0.0);
        high = if rising { u } else { high };
        low = if rising { low } else { u };
        // Also where the step is not a number.
        u = next.or_less(high).or_more(low);
        step += 1;
    }
    u
}

/// Third stage: one Halley step on the scalar product of position and velocity, free of the
/// cancellation in the expanded coefficients; then the certificate.
#[inline(always)]
pub(super) fn settle<R: Real>(cubic: &CentredCubic<R>, square: &[R; 7], u: R) -> Settled<R> {
    let (zero, one) = (R::from_f64(0.0), R::from_f64(1.0));
    let HalleyStep { slope, step, error } = halley_step(cubic, u);
    // At an end with the slope inward there is nothing to polish.
    let at_end = ((u <= -one) & (slope >= zero)) | ((u >= one) & (slope <= zero));
    // A step that is cut off at an end counts in full.
    let settled = at_end | ((step.abs() <= R::SETTLED) & (error <= R::from_f64(4.0) * R::ROUNDING));
    let step = if at_end { zero } else { step };
    let time = (u - step).or_less(one).or_more(-one);
    let position = cubic.position(time);

    // The rounding of the deflated coefficients in terms of the coefficient vectors (see
    // `kernels`).
    let [_, c1, c2, _] = cubic.coefficients;
    let (s0, s1, s2, s3) = (square[0], dot(c1, c1), dot(c2, c2), square[6]);
    let size = R::from_f64(4.0) * s0
        + R::from_f64(10.0) * s1
        + (R::from_f64(20.0) * s2 + R::from_f64(34.0) * s3);
    let margin = R::from_f64(MARGIN) * R::ROUNDING * size + R::UNDERFLOW;
    // A pair at rest but for rounding is as near at any time.
    let still = s1 + s2 + s3 + R::UNDERFLOW <= R::ROUNDING * R::ROUNDING * s0;
    let huge = R::from_f64(f64::INFINITY);
    let margin = if settled { margin } else { huge };
    let margin = if still { -huge } else { margin };
    Settled {
        time,
        square: dot(position, position),
        margin: if size < R::LARGE { margin } else { huge },
    }
}

/// A step of Halley's method towards a stationary point of the distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalleyStep<R> {
    /// Half the slope of the squared distance.
    slope: R,
    /// How far to go back in centred time.
    pub(super) step: R,
    /// An estimate of the error after the step, from the curvature of the slope: of third order
    /// at a simple root, of the order of the step itself at a multiple one.
    error: R,
}

/// The step from the vectors at a centred time.
#[inline(always)]
pub(super) fn halley_step<R: Real>(cubic: &CentredCubic<R>, u: R) -> HalleyStep<R> {
    let (one, two, three) = (R::from_f64(1.0), R::from_f64(2.0), R::from_f64(3.0));
    // Position, velocity, half the acceleration; a sixth of the third derivative is constant.
    let [position, velocity, bend, twist] = cubic.derivatives(u);
    let slope = dot(position, velocity);
    let first = dot(velocity, velocity) + two * dot(position, bend);
    let second = three * (dot(velocity, bend) + dot(position, twist));
    let inverse = one / (first * first - slope * second);
    let step = slope * first * inverse;
    let ratio = slope * second * inverse;
    HalleyStep {
        slope,
        step,
        error: step.abs() * (ratio * ratio),
    }
}

/// The least Bernstein coefficient of the deflated quartic, an inward slope at an end included,
/// less a margin for its rounding.
#[inline(always)]
pub(super) fn certify<R: Real, const PIECES: usize>(square: &[R; 7], u: R, margin: R) -> R {
    least_of_deflated::<R, PIECES>(square, u, margin) - margin
}

#[inline(always)]
fn least_of_deflated<R: Real, const PIECES: usize>(square: &[R; 7], u: R, margin: R) -> R {
    let zero = R::from_f64(0.0);
    let one = R::from_f64(1.0);
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

    // At an end of the span the slope points inward and helps. The end is made the low one: time
    // reversed, u becomes -u.
    let at_low = (u <= -one) & (r > zero);
    let at_high = (u >= one) & (r < zero);
    let q1 = if at_high { -q1 } else { q1 };
    let q3 = if at_high { -q3 } else { q3 };
    // The slope has a rounding of its own, and enters with factors of up to 20.
    let certain = (r.abs() - R::from_f64(SLOPE_MARGIN) * margin).or_more(zero);
    let inward = if at_low | at_high { certain } else { zero };

    // Bernstein coefficients from the middle outward, to both sides at once.
    let even = [
        q0,
        q0,
        q0 + R::from_f64(1.0 / 6.0) * q2,
        q0 + R::from_f64(0.5) * q2,
        q0 + (q2 + q4),
    ];
    let odd = [
        zero,
        R::from_f64(0.25) * q1,
        R::from_f64(0.5) * q1,
        R::from_f64(0.75) * q1 + R::from_f64(0.25) * q3,
        q1 + q3,
    ];
    let mut low_side = even;
    let mut high_side = even;
    let mut j = 0;
    while j < 5 {
        low_side[j] = even[j] - odd[j];
        high_side[j] = even[j] + odd[j];
        j += 1;
    }
    if PIECES == 2 {
        return low_piece(low_side, inward, 1.0).or_less(high_piece(high_side, inward, 1.0, 2.0));
    }
    let (second, first) = halves(low_side);
    let (third, fourth) = halves(high_side);
    let (first_b, first_a) = halves(first);
    let (second_b, second_a) = halves(second);
    let (third_a, third_b) = halves(third);
    let (fourth_a, fourth_b) = halves(fourth);
    let low = low_piece(first_a, inward, 0.25)
        .or_less(high_piece(first_b, inward, 0.5, 0.25))
        .or_less(high_piece(second_a, inward, 0.75, 0.5))
        .or_less(high_piece(second_b, inward, 1.0, 0.75));
    let high = high_piece(third_a, inward, 1.0, 1.25)
        .or_less(high_piece(third_b, inward, 1.25, 1.5))
        .or_less(high_piece(fourth_a, inward, 1.5, 1.75))
        .or_less(high_piece(fourth_b, inward, 1.75, 2.0));
    low.or_less(high)
}

/// The least lifted coefficient on the piece from the end at u = -1 on, of some width;
/// coefficient 4 is the one at the end.
///
/// There `(u + 1) q + inward` has to be positive. Its coefficient i + 1, counted from the end, is
/// width · (i + 1) / 5 times that of `q`, plus `inward`.
#[inline(always)]
fn low_piece<R: Real>(k: [R; 5], inward: R, width: f64) -> R {
    let mut least = k[0] + R::from_f64(1.0 / width) * inward;
    let mut i = 0;
    while i < 4 {
        let lifted = k[4 - i] + R::from_f64(5.0 / (width * (i + 1) as f64)) * inward;
        least = lifted.or_less(least);
        i += 1;
    }
    least
}

/// The least lifted coefficient on a piece whose ends are these distances from u = -1.
///
/// There `q + inward / (u + 1)` has to be positive; the quotient is convex, and above its tangent
/// at the middle of the piece.
#[inline(always)]
fn high_piece<R: Real>(k: [R; 5], inward: R, first: f64, last: f64) -> R {
    let middle = 0.5 * (first + last);
    let mut least = k[0] + R::from_f64((2.0 * middle - first) / (middle * middle)) * inward;
    let mut j = 1;
    while j < 5 {
        let distance = first + (last - first) * 0.25 * j as f64;
        let lifted = k[j] + R::from_f64((2.0 * middle - distance) / (middle * middle)) * inward;
        least = lifted.or_less(least);
        j += 1;
    }
    least
}

/// The Bernstein coefficients on the two halves of the interval.
#[inline(always)]
fn halves<R: Real>(k: [R; 5]) -> ([R; 5], [R; 5]) {
    let half = R::from_f64(0.5);
    let mut left = k;
    let mut right = k;
    let mut level = 1;
    while level < 5 {
        let mut i = 0;
        while i < 5 - level {
            right[i] = half * (right[i] + right[i + 1]);
            i += 1;
        }
        left[level] = right[0];
        level += 1;
    }
    (left, right)
}
