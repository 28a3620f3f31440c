//! Parts of a cubic: restriction from the root polygon, and a quadratic that stays below.

use super::normal::{SLACK, TINY, UNIT, norm_above};
use glam::DVec3;

/// Control points of a part, counted from its base: the end that bounds are formed around.
pub(super) type Polygon = [DVec3; 4];

/// Which end of a part its base is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Base {
    Start,
    End,
}

/// The parts before and after `s`, both counted from `s` (de Casteljau).
///
/// Each control point is wrong by at most 9u times the largest norm of the control points given:
/// three levels with at most three roundings per term (weight, product, sum), and non-negative
/// weights that sum to one.
#[inline]
pub(super) fn split(points: &Polygon, s: f64) -> (Polygon, Polygon) {
    let [h0, h1, h2, h3] = *points;
    let mix = Mix::at(s);
    let (a0, a1, a2) = (mix.of(h0, h1), mix.of(h1, h2), mix.of(h2, h3));
    let (b0, b1) = (mix.of(a0, a1), mix.of(a1, a2));
    let c = mix.of(b0, b1);
    ([c, b0, a0, h0], [c, b1, a2, h3])
}

/// The part from `start` to `end`, counted from `start` (blossoms); wrong by at most 9u times the
/// largest norm, as in [`split`], however short the part.
#[inline]
pub(super) fn part(points: &Polygon, start: f64, end: f64) -> Polygon {
    let [h0, h1, h2, h3] = *points;
    let (low, high) = (Mix::at(start), Mix::at(end));
    let (a0, a1, a2) = (low.of(h0, h1), low.of(h1, h2), low.of(h2, h3));
    let (aa0, aa1) = (low.of(a0, a1), low.of(a1, a2));
    let (b0, b1, b2) = (high.of(h0, h1), high.of(h1, h2), high.of(h2, h3));
    let (bb0, bb1) = (high.of(b0, b1), high.of(b1, b2));
    [
        low.of(aa0, aa1),
        high.of(aa0, aa1),
        low.of(bb0, bb1),
        high.of(bb0, bb1),
    ]
}

/// The same part counted from its other end.
#[inline]
pub(super) fn reversed(points: Polygon) -> Polygon {
    let [a, b, c, d] = points;
    [d, c, b, a]
}

/// The point at `s`, wrong by at most 9u times the largest norm.
#[inline]
pub(super) fn point(points: &Polygon, s: f64) -> DVec3 {
    let [h0, h1, h2, h3] = *points;
    let mix = Mix::at(s);
    let (a0, a1, a2) = (mix.of(h0, h1), mix.of(h1, h2), mix.of(h2, h3));
    mix.of(mix.of(a0, a1), mix.of(a1, a2))
}

#[derive(Clone, Copy)]
struct Mix {
    first: f64,
    second: f64,
}

impl Mix {
    #[inline]
    fn at(s: f64) -> Self {
        Self {
            first: 1.0 - s,
            second: s,
        }
    }

    #[inline]
    fn of(self, x: DVec3, y: DVec3) -> DVec3 {
        x * self.first + y * self.second
    }
}

/// A quadratic below the squared distance on a part: `base + slope x + bend x²`, x in 0..=1 from
/// the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Minorant {
    /// Computed squared norm at the base (relative error 3u).
    pub(super) base: f64,
    slope: f64,
    bend: f64,
    /// No Bernstein coefficient of the squared distance minus that at the base is below this.
    floor: f64,
}

impl Minorant {
    /// Module documentation, sections 3 and 4.
    #[inline]
    pub(super) fn of(points: &Polygon) -> Self {
        let k0 = points[0];
        let (d1, d2, d3) = (points[1] - k0, points[2] - k0, points[3] - k0);
        let (a1, a2, a3) = (k0.dot(d1), k0.dot(d2), k0.dot(d3));
        let (g11, g22, g33) = (d1.dot(d1), d2.dot(d2), d3.dot(d3));
        let (g12, g13, g23) = (d1.dot(d2), d1.dot(d3), d2.dot(d3));
        let base = k0.dot(k0);

        // Upper bounds of the norms; the added square is far above what underflow can hide.
        let hidden = TINY;
        let norm = (base + hidden).sqrt();
        let reach = (greater(g11, greater(g22, g33)) + hidden).sqrt();
        let first = (g11 + hidden).sqrt();
        let error_first = (4.0 * UNIT * SLACK) * (norm * first) + TINY;
        let error = (UNIT * SLACK) * (reach * (19.0 * norm + 10.0 * reach)) + TINY;

        let e1 = a1 - error_first;
        let rest = [
            (2.0 * a2 + 6.0 * a1 + 3.0 * g11) * 0.2 - error,
            (a3 + 9.0 * (a1 + a2 + g12)) * 0.1 - error,
            (2.0 * (a1 + a3 + g13) + 3.0 * (2.0 * a2 + g22)) * 0.2 - error,
            (a2 + a3 + g23) - error,
            (2.0 * a3 + g33) - error,
        ];
        let mut floor = e1;
        let mut bend = f64::INFINITY;
        for ((e, k), weight) in rest.into_iter().zip(ORDERS).zip(BENDS) {
            floor = smaller(floor, e);
            let excess = (e - k * e1) - 4.0 * UNIT * (e.abs() + k * e1.abs());
            bend = smaller(bend, weight * excess);
        }
        Self {
            base,
            slope: below(6.0 * e1),
            bend: below(bend),
            floor: below(floor),
        }
    }

    /// A lower bound of the squared distance over the part; may be negative.
    #[inline]
    pub(super) fn lower(&self) -> f64 {
        let (slope, bend) = (self.slope, self.bend);
        let by_quadratic = if slope < 0.0 && -slope <= 2.0 * bend {
            slope * (slope / (4.0 * bend)) + TINY
        } else {
            greater(0.0, -(slope + bend))
        };
        let by_floor = greater(0.0, -self.floor);
        let sink = smaller(by_quadratic, by_floor);
        // Two roundings of the quadratic or one of the chord, two of the product, one of the difference.
        self.base - sink * (1.0 + 8.0 * UNIT) - 6.0 * UNIT * self.base - TINY
    }

    /// A lower bound of the squared distance at the base.
    #[inline]
    fn base_below(&self) -> f64 {
        self.base * (1.0 - 8.0 * UNIT) - TINY
    }

    /// An x beyond which the squared distance is certainly above `level`; 1 where that cannot be
    /// told.
    #[inline]
    pub(super) fn reach(&self, level: f64) -> f64 {
        let (slope, bend) = (self.slope, self.bend);
        // Room above the base; the quadratic exceeds it beyond its larger root.
        let gap = greater(level - self.base_below(), TINY);
        let x = if bend > 0.0 {
            // sqrt(slope² + 4 bend gap) <= |slope| + 2 sqrt(bend gap), and each term alone holds.
            let by_bend = (gap / bend).sqrt();
            if slope >= 0.0 {
                smaller(by_bend, gap / slope)
            } else {
                by_bend - slope / bend
            }
        } else {
            // Concave: above the chord to its value at 1.
            let chord = slope + bend;
            if chord > 0.0 { gap / chord } else { 1.0 }
        };
        // Five roundings at most, and two of what this is multiplied by. NaN (0/0) and infinity answer 1.
        let x = x * (1.0 + 16.0 * UNIT) + TINY;
        if x < 1.0 { x } else { 1.0 }
    }
}

const ORDERS: [f64; 5] = [2.0, 3.0, 4.0, 5.0, 6.0];
/// 30 / (k (k - 1)).
const BENDS: [f64; 5] = [15.0, 5.0, 2.5, 1.5, 1.0];

/// How far a minimiser can be from the base, by the derivative: see [`stationary_reach`].
///
/// `points` is a part counted from its base, `error` a bound on its distance from the exact cubic,
/// and all minimisers of the exact distance are known to lie within `range` of the base (in the
/// part's parameter, on either side). Where the squared distance is certainly convex over that
/// range, its slope at the base bounds how far the minimiser can be; `range` otherwise.
pub(super) fn stationary_reach(points: &Polygon, error: f64, range: f64) -> f64 {
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
        * UNIT
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
    let bend = 9.0 * d1.dot(d1) + 6.0 * k0.dot(second);
    let uncertain = 2.0 * u1 * e1 + error * u2 + u0 * e2;
    let (v0, v1, v2) = (
        u0 + range * (u1 + range * (u2 + range * u3)),
        u1 + range * (u2 + range * u3),
        u2 + range * u3,
    );
    let lost = range * (3.0 * v1 * v2 + v0 * u3);
    let certain = bend - (uncertain + lost) * SLACK - TINY;
    if certain > 0.0 {
        smaller(slope / certain * SLACK + TINY, range)
    } else {
        range
    }
}

/// A little below: covers two roundings of the number itself.
#[inline]
fn below(x: f64) -> f64 {
    x - 4.0 * UNIT * x.abs()
}

/// Compare and select, the same on every machine (`f64::max` leaves the sign of zero open).
#[inline]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Ten times the exact coefficients e1..e6, for integer control points below 2^51: all
/// products are below 2^110.
#[cfg(test)]
pub(crate) fn exact_differences(points: &[[i64; 3]; 4]) -> [i128; 6] {
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

#[cfg(test)]
mod exactly;

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{Rng, RngExt, SeedableRng};

    fn draw(random: &mut impl Rng) -> [[i64; 3]; 4] {
        // A base and differences of all sizes, also such that cancel in the scalar products.
        let bits = [(); 4].map(|()| random.random_range(8..50));
        let mut points = bits.map(|bits: u32| {
            let range = 1_i64 << bits;
            [(); 3].map(|()| random.random_range(-range..=range))
        });
        if random.random_range(0..2) == 0 {
            let base = points[0];
            for point in &mut points[1..] {
                for (x, b) in point.iter_mut().zip(base) {
                    *x += b;
                }
            }
        }
        points
    }

    /// Rounded down; what is lost is below one, and the products here are far above.
    #[allow(clippy::cast_possible_truncation, reason = "far below 2^127")]
    fn integer(x: f64) -> i128 {
        x.floor() as i128
    }

    #[test]
    #[allow(clippy::cast_precision_loss, reason = "below 2^53")]
    fn the_minorant_is_below_the_exact_coefficients() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..200_000 {
            let points = draw(&mut random);
            let polygon = points.map(|[x, y, z]| DVec3::new(x as f64, y as f64, z as f64));
            let minorant = Minorant::of(&polygon);
            let (slope, bend) = (integer(minorant.slope), integer(minorant.bend));
            let floor = integer(minorant.floor);
            for (k, tenfold) in (1..).zip(exact_differences(&points)) {
                assert!(10 * floor <= tenfold, "floor above e{k}: {points:?}");
                // c1 k/6 + c2 k(k-1)/30 <= ek, times 300.
                let quadratic = 10 * (5 * k * slope + k * (k - 1) * bend);
                assert!(
                    quadratic <= 30 * tenfold,
                    "quadratic above e{k}: {points:?}"
                );
            }
        }
    }
}
