//! Quadratics below the squared distance on a part (module documentation, sections 3 and 4).

use super::scaled::TINY;
use crate::blossom::ControlPolygon;
use crate::real::Real;
use crate::rounding::UNIT_ROUNDOFF;

/// A quadratic `base + slope x + leading x²` below the squared distance, x in 0..=1 from the base.
///
/// Valid for the computed control points, if those of the whole cubic lie within 1e-50..1e50.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Minorant {
    /// Computed squared norm at the base (relative error 3u).
    pub(crate) base: f64,
    slope: f64,
    leading: f64,
    /// Lower bound of the squared distance's Bernstein coefficients minus its value at the base.
    floor: f64,
}

impl Minorant {
    #[inline(always)]
    pub(crate) fn of(points: &ControlPolygon) -> Self {
        let [k0, k1, k2, k3] = *points;
        let (d1, d2, d3) = (k1 - k0, k2 - k0, k3 - k0);
        let (a1, a2, a3) = (k0.dot(d1), k0.dot(d2), k0.dot(d3));
        let (g11, g22, g33) = (d1.dot(d1), d2.dot(d2), d3.dot(d3));
        let (g12, g13, g23) = (d1.dot(d2), d1.dot(d3), d2.dot(d3));
        let base = k0.dot(k0);

        // m A and A². Where their product underflows, m A is below 1e-161, and what it would add
        // below TINY.
        let largest = g11.max_or_other(g22).max_or_other(g33);
        let product = (base * largest).sqrt();
        // In units: 4 m A for e1, 19 m A + 10 A² for the others; two more of e1, for the difference
        // and the product below, one of the others: 2 m A + A² at most. One more in 20 covers the
        // rounding of these bounds themselves.
        let first_error = 6.3 * UNIT_ROUNDOFF * product + TINY;
        let error = UNIT_ROUNDOFF * (22.0 * product + 11.5 * largest) + TINY;
        // The leading coefficient's error is at most 15 times that of a Bernstein coefficient, and 4 roundings of
        // terms of 54 m A + 9 A² in sum.
        let leading_error = UNIT_ROUNDOFF * (530.0 * product + 200.0 * largest) + 16.0 * TINY;

        let e1 = a1 - first_error;
        let e2 = (2.0 * a2 + 6.0 * a1 + 3.0 * g11) * 0.2;
        let e3 = (a3 + 9.0 * (a1 + a2 + g12)) * 0.1;
        let e4 = (2.0 * (a1 + a3 + g13) + 3.0 * (2.0 * a2 + g22)) * 0.2;
        let e5 = a2 + a3 + g23;
        let e6 = 2.0 * a3 + g33;

        let slope = 6.0 * e1;
        let leading = (15.0 * (e2 - 2.0 * e1))
            .min_or_other(5.0 * (e3 - 3.0 * e1))
            .min_or_other(2.5 * (e4 - 4.0 * e1))
            .min_or_other(1.5 * (e5 - 5.0 * e1))
            .min_or_other(e6 - slope);
        let least = e2
            .min_or_other(e3)
            .min_or_other(e4)
            .min_or_other(e5)
            .min_or_other(e6);
        Self {
            base,
            slope,
            leading: leading - leading_error,
            floor: (least - error).min_or_other(e1),
        }
    }

    /// Returns a lower bound of the squared distance over the part; may be negative.
    #[inline(always)]
    pub(crate) fn lower(&self) -> f64 {
        let (slope, leading) = (self.slope, self.leading);
        // Both are formed: a choice of results makes no branch.
        let at_vertex = slope * (slope / (4.0 * leading)) + TINY;
        let at_end = (-(slope + leading)).max_or_other(0.0);
        let is_inside = (slope < 0.0) & (leading > 0.0) & (-slope <= 2.0 * leading);
        let by_quadratic = if is_inside { at_vertex } else { at_end };
        let depth = by_quadratic.min_or_other((-self.floor).max_or_other(0.0));
        // Two roundings of the quadratic or one of the chord, two of the product, one of the difference.
        self.base - depth * (1.0 + 8.0 * UNIT_ROUNDOFF) - 6.0 * UNIT_ROUNDOFF * self.base - TINY
    }

    /// Returns an x beyond which the squared distance is certainly above `threshold`, or 1 if unknown.
    #[inline]
    pub(super) fn parameter_bound(&self, threshold: f64) -> f64 {
        let (slope, leading) = (self.slope, self.leading);
        let base = self.base * (1.0 - 8.0 * UNIT_ROUNDOFF) - TINY;
        // Room above the base; the quadratic exceeds it beyond its larger root.
        let gap = (threshold - base).max_or_other(TINY);
        let x = if leading > 0.0 {
            // sqrt(slope² + 4 leading gap) <= |slope| + 2 sqrt(leading gap), and each term alone holds.
            let by_leading = (gap / leading).sqrt();
            if slope >= 0.0 {
                by_leading.min_or_other(gap / slope)
            } else {
                by_leading - slope / leading
            }
        } else {
            // Concave: above the chord to its value at 1.
            let chord = slope + leading;
            if chord > 0.0 { gap / chord } else { 1.0 }
        };
        // Five roundings at most, and two of what this is multiplied by. NaN (0/0) and infinity answer 1.
        let x = x * (1.0 + 16.0 * UNIT_ROUNDOFF) + TINY;
        if x < 1.0 { x } else { 1.0 }
    }
}

#[cfg(test)]
mod exactly;

#[cfg(test)]
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "integers below 2^53, products below 2^127"
)]
mod tests {
    use super::*;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Returns ten times the exact coefficients e1..e6, for integer control points below 2^51: all
    /// products are below 2^110.
    fn exact_differences(points: &[[i64; 3]; 4]) -> [i128; 6] {
        let wide = points.map(|point| point.map(i128::from));
        let dot = |p: [i128; 3], q: [i128; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        let k0 = wide[0];
        let [d1, d2, d3] = [1, 2, 3].map(|j| [0, 1, 2].map(|axis| wide[j][axis] - k0[axis]));
        let (a1, a2, a3) = (dot(k0, d1), dot(k0, d2), dot(k0, d3));
        [
            10 * a1,
            2 * (2 * a2 + 6 * a1 + 3 * dot(d1, d1)),
            a3 + 9 * (a1 + a2 + dot(d1, d2)),
            2 * (2 * (a1 + a3 + dot(d1, d3)) + 3 * (2 * a2 + dot(d2, d2))),
            10 * (a2 + a3 + dot(d2, d3)),
            10 * (2 * a3 + dot(d3, d3)),
        ]
    }

    /// Bases and differences of all sizes, as integers, also with products that cancel.
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
            let polygon = points.map(|[x, y, z]| DVec3::new(x as f64, y as f64, z as f64));
            let found = Minorant::of(&polygon);
            let [slope, leading, floor] =
                [found.slope, found.leading, found.floor].map(|x| x.floor() as i128);
            for (k, tenfold) in (1..).zip(exact_differences(&points)) {
                assert!(10 * floor <= tenfold, "floor above e{k}: {points:?}");
                // c1 k/6 + c2 k(k-1)/30 <= ek, times 300.
                let quadratic = 10 * (5 * k * slope + k * (k - 1) * leading);
                assert!(
                    quadratic <= 30 * tenfold,
                    "quadratic above e{k}: {points:?}"
                );
            }
        }
    }
}
