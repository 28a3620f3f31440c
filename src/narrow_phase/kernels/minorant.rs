//! A lower bound of the distance on a piece that is good to the last digits.
//!
//! Let `k0..k3` be the control points of a piece, `δ_j = k_j - k0`, `m = |k0|` and `A = max |δ_j|`.
//! The Bernstein coefficients of `d - m²` on the piece are formed from the differences, so that
//! their rounding is proportional to `A` and not to the square of the whole polygon. Then the
//! quadratic `c1 x + c2 x²` below them all bounds `d - m²` on the piece: the slope at `k0`, which
//! is rounding at a minimum, enters squared.

use super::cubic::{ControlPoints, Vector, dot, subtract};
use super::real::Real;

/// The control points of the two pieces on either side of `s`, both from the common point on.
///
/// De Casteljau's algorithm with weights `1 - s` and `s`: three levels of three roundings each,
/// so every point is within 9 units of rounding of the polygon's size.
#[inline(always)]
pub(super) fn split<R: Real>(points: ControlPoints<R>, s: R) -> [ControlPoints<R>; 2] {
    let t = R::from_f64(1.0) - s;
    let [p0, p1, p2, p3] = points;
    let p01 = lerp(t, p0, s, p1);
    let p12 = lerp(t, p1, s, p2);
    let p23 = lerp(t, p2, s, p3);
    let p012 = lerp(t, p01, s, p12);
    let p123 = lerp(t, p12, s, p23);
    let p0123 = lerp(t, p012, s, p123);
    [[p0123, p012, p01, p0], [p0123, p123, p23, p3]]
}

#[inline(always)]
fn lerp<R: Real>(t: R, a: Vector<R>, s: R, b: Vector<R>) -> Vector<R> {
    [
        t * a[0] + s * b[0],
        t * a[1] + s * b[1],
        t * a[2] + s * b[2],
    ]
}

/// What the squared distance on a piece less that at `k0` stays above, x from 0 to 1.
struct Below<R> {
    /// The quadratic `slope x + bend x²`.
    slope: R,
    bend: R,
    /// Not above any Bernstein coefficient.
    lowest: R,
}

/// A lower bound of the squared distance on a piece, for its points as they are.
///
/// For polygons between 1e-60 and 1e60 (f64): the slack is of fourth degree in lengths before
/// the division.
#[inline(always)]
pub(super) fn lower_bound<R: Real>(points: ControlPoints<R>) -> R {
    let (zero, u) = (R::from_f64(0.0), R::ROUNDING);
    let two = R::from_f64(2.0);
    let square = dot(points[0], points[0]);
    let Below {
        slope: c1,
        bend: c2,
        lowest,
    } = below(points, square);
    // The least value of c1 x + c2 x² on 0..=1, negated.
    let vertex = c1 * (c1 / (R::from_f64(4.0) * c2));
    let end = (-(c1 + c2)).or_more(zero);
    let inside = (c1 < zero) & (c2 > zero) & (-c1 <= two * c2);
    let slack = if inside { vertex } else { end };
    // And the plain convex hull. Two roundings of the quadratic or one of its end, two of the product, one of
    // the difference.
    let slack = slack.or_less((-lowest).or_more(zero));
    square - R::from_f64(4.0) * u * square - slack * (R::from_f64(1.0) + R::from_f64(8.0) * u)
}

/// `square` is the squared distance at `k0`.
#[inline(always)]
fn below<R: Real>([k0, k1, k2, k3]: ControlPoints<R>, square: R) -> Below<R> {
    let u = R::ROUNDING;
    let (two, three) = (R::from_f64(2.0), R::from_f64(3.0));
    let (d1, d2, d3) = (subtract(k1, k0), subtract(k2, k0), subtract(k3, k0));
    let (a1, a2, a3) = (dot(k0, d1), dot(k0, d2), dot(k0, d3));
    let (g11, g22, g33) = (dot(d1, d1), dot(d2, d2), dot(d3, d3));
    let (g12, g13, g23) = (dot(d1, d2), dot(d1, d3), dot(d2, d3));

    // Rounding: 4 m |δ1| for the first coefficient, A (19 m + 10 A) for the others, in units; two more
    // of the first, for the difference and the product below, one of the others: 2 m A + A² at most.
    // One more in 20 covers that of these bounds themselves.
    let reach = g11.or_more(g22).or_more(g33);
    let product = (square * reach).sqrt();
    let first_error = R::from_f64(6.3) * u * product + R::UNDERFLOW;
    let error = u * (R::from_f64(22.0) * product + R::from_f64(11.5) * reach) + R::UNDERFLOW;
    // The factor of x² below takes at most 15 times that of a coefficient, and 4 roundings of
    // terms of 54 m A + 9 A² in sum.
    let curvature_error = u * (R::from_f64(530.0) * product + R::from_f64(200.0) * reach)
        + R::from_f64(16.0) * R::UNDERFLOW;

    let e1 = a1 - first_error;
    let e2 = R::from_f64(0.2) * (two * a2 + R::from_f64(6.0) * a1 + three * g11);
    let e3 = R::from_f64(0.1) * (a3 + R::from_f64(9.0) * (a1 + a2 + g12));
    let e4 = R::from_f64(0.2) * (two * (a1 + a3 + g13) + three * (two * a2 + g22));
    let e5 = a2 + a3 + g23;
    let e6 = two * a3 + g33;

    // x has the coefficients k / 6, x² has k (k - 1) / 30: what each coefficient allows for the
    // factor of x².
    let c1 = R::from_f64(6.0) * e1;
    let c2 = (R::from_f64(15.0) * (e2 - two * e1))
        .or_less(R::from_f64(5.0) * (e3 - three * e1))
        .or_less(R::from_f64(2.5) * (e4 - R::from_f64(4.0) * e1))
        .or_less(R::from_f64(1.5) * (e5 - R::from_f64(5.0) * e1))
        .or_less(e6 - c1)
        - curvature_error;
    Below {
        slope: c1,
        bend: c2,
        lowest: (e2.or_less(e3).or_less(e4).or_less(e5).or_less(e6) - error).or_less(e1),
    }
}

/// A lower bound of the squared distance on the first half of a piece, from its quarters.
///
/// Halving rounds three times more.
#[inline(always)]
pub(super) fn lower_bound_near<R: Real>(points: ControlPoints<R>) -> R {
    let [near, _] = split(points, R::from_f64(0.5));
    let [first, second] = split(reversed(near), R::from_f64(0.5));
    lower_bound(reversed(first)).or_less(lower_bound(from_nearer(second)))
}

/// A lower bound of the squared distance on the second half of a piece, from its quarters.
#[inline(always)]
pub(super) fn lower_bound_far<R: Real>(points: ControlPoints<R>) -> R {
    let [_, far] = split(points, R::from_f64(0.5));
    let [third, fourth] = split(far, R::from_f64(0.5));
    lower_bound(from_nearer(third)).or_less(lower_bound(from_nearer(fourth)))
}

#[inline(always)]
fn reversed<R: Real>(points: ControlPoints<R>) -> ControlPoints<R> {
    let [p0, p1, p2, p3] = points;
    [p3, p2, p1, p0]
}

/// The piece in the direction in which it starts at its nearer end.
#[inline(always)]
pub(super) fn from_nearer<R: Real>(points: ControlPoints<R>) -> ControlPoints<R> {
    let [p0, p1, p2, p3] = points;
    let turn = dot(p3, p3) < dot(p0, p0);
    [
        select(turn, p3, p0),
        select(turn, p2, p1),
        select(turn, p1, p2),
        select(turn, p0, p3),
    ]
}

#[inline(always)]
fn select<R: Real>(first: bool, a: Vector<R>, b: Vector<R>) -> Vector<R> {
    [
        if first { a[0] } else { b[0] },
        if first { a[1] } else { b[1] },
        if first { a[2] } else { b[2] },
    ]
}

#[cfg(test)]
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "integers below 2^53, products below 2^127"
)]
mod tests {
    use super::*;
    use crate::enclosure::exact_differences;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Bases and differences of all sizes, as integers: also such that cancel in the products.
    #[test]
    fn the_minorant_is_below_the_exact_coefficients() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for round in 0..200_000 {
            let bits = [(); 4].map(|()| random.random_range(8..50));
            let mut points = bits.map(|bits: u32| {
                let range = 1_i64 << bits;
                [(); 3].map(|()| random.random_range(-range..=range))
            });
            if round % 2 == 0 {
                let base = points[0];
                for point in &mut points[1..] {
                    for (x, b) in point.iter_mut().zip(base) {
                        *x += b;
                    }
                }
            }
            let polygon = points.map(|point| point.map(|x| x as f64));
            let found = below(polygon, dot(polygon[0], polygon[0]));
            let [slope, bend, lowest] =
                [found.slope, found.bend, found.lowest].map(|x| x.floor() as i128);
            for (k, tenfold) in (1..).zip(exact_differences(&points)) {
                assert!(10 * lowest <= tenfold, "above e{k}: {points:?}");
                // c1 k/6 + c2 k(k-1)/30 <= ek, times 300.
                let quadratic = 10 * (5 * k * slope + k * (k - 1) * bend);
                assert!(quadratic <= 30 * tenfold, "above e{k}: {points:?}");
            }
        }
    }
}
