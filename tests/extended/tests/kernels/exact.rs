//! The least distance of a relative cubic in exact integer arithmetic.
//!
//! Control points are integers times a power of two. The squared distance has Bernstein
//! coefficients that are integers after a factor of 10, and halving an interval keeps them
//! integers if the sums are not divided. So every bound is exact; only the final square root and
//! the comparison with a computed distance round, in the last digits of a small difference.

use dashu::base::{BitTest, Sign};
use dashu::integer::IBig;
use nearmiss::kernels::ControlPoints;

/// More bits than the coordinates have: bounds are rounded to integers when they are compared.
const GUARD: i32 = 64;

/// The squared least distance between two numbers, times `10 · 2^(-2 exponent)`.
pub(crate) struct Exact {
    low: IBig,
    high: IBig,
    exponent: i32,
}

/// A part of the span with the coefficients over it, times `2^(6 depth)`.
struct Part {
    coefficients: [IBig; 7],
    depth: usize,
}

/// A finite number as an integer times a power of two.
fn dyadic(x: f64) -> (IBig, i32) {
    let bits = x.to_bits();
    let biased = i32::try_from((bits >> 52) & 0x7ff).expect("eleven bits");
    let fraction = bits & ((1 << 52) - 1);
    let mantissa = if biased == 0 {
        fraction
    } else {
        fraction | (1 << 52)
    };
    let signed = if x < 0.0 {
        -IBig::from(mantissa)
    } else {
        IBig::from(mantissa)
    };
    (signed, biased.max(1) - 1075)
}

/// `x` as an integer times `2^exponent`; the exponent is not above that of `x`.
fn scaled(x: f64, exponent: i32) -> IBig {
    let (mantissa, own) = dyadic(x);
    if mantissa == IBig::ZERO {
        return mantissa;
    }
    mantissa << usize::try_from(own - exponent).expect("the common exponent is the least")
}

/// An integer times `2^exponent` as `f64`, with a relative error of some 1e-15.
fn to_f64(value: &IBig, exponent: i32) -> f64 {
    let (sign, magnitude) = value.clone().into_parts();
    let length = magnitude.bit_len();
    let drop = length.saturating_sub(60);
    let top = u64::try_from(magnitude >> drop).expect("sixty bits");
    let shift = exponent + i32::try_from(drop).expect("few bits");
    // In two steps, since the power alone may be out of range.
    let half = shift / 2;
    let result = top as f64 * 2.0_f64.powi(half) * 2.0_f64.powi(shift - half);
    if sign == Sign::Negative {
        -result
    } else {
        result
    }
}

impl Exact {
    /// The least distance of a pair: to `2^-70` of its square, or to `2^-120` of the square of the
    /// polygon's size.
    pub(crate) fn new(points: &ControlPoints<f64>) -> Self {
        let exponent = points
            .iter()
            .flatten()
            .filter(|x| **x != 0.0)
            .map(|x| dyadic(*x).1)
            .min()
            .unwrap_or(0)
            - GUARD;
        let p = points.map(|point| point.map(|x| scaled(x, exponent)));
        let dot =
            |i: usize, j: usize| -> IBig { (0..3).map(|axis| &p[i][axis] * &p[j][axis]).sum() };
        let coefficients: [IBig; 7] = [
            10 * dot(0, 0),
            10 * dot(0, 1),
            4 * dot(0, 2) + 6 * dot(1, 1),
            dot(0, 3) + 9 * dot(1, 2),
            4 * dot(1, 3) + 6 * dot(2, 2),
            10 * dot(2, 3),
            10 * dot(3, 3),
        ];
        let size: IBig = (0..4).map(|i| 10 * dot(i, i)).max().expect("four points");
        let high = (&coefficients[0]).min(&coefficients[6]).clone();
        let mut search = Self {
            low: IBig::ZERO,
            high,
            exponent,
        };
        search.run(
            vec![Part {
                coefficients,
                depth: 0,
            }],
            &(size >> 120),
        );
        search
    }

    /// Halves the parts that may hold the minimum, all of one depth at a time, until the bounds
    /// meet. Parts are kept at a common depth, so that they compare without scaling.
    fn run(&mut self, mut parts: Vec<Part>, enough: &IBig) {
        loop {
            let depth = parts.first().map_or(0, |part| part.depth);
            let high = self.high.clone() << (6 * depth);
            let lowest = |part: &Part| part.coefficients.iter().min().cloned();
            let low = parts
                .iter()
                .filter_map(lowest)
                .min()
                .unwrap_or_else(|| high.clone());
            self.low = (low.min(high.clone()) >> (6 * depth)).max(IBig::ZERO);
            let gap = &self.high - &self.low;
            if &gap <= enough || gap <= (&self.high >> 70) || depth == 200 {
                return;
            }
            // Whatever could hold a lower point goes on.
            parts.retain(|part| lowest(part).is_some_and(|least| least < high));
            assert!(
                parts.len() < 4_096,
                "{} parts at depth {depth}",
                parts.len()
            );
            parts = parts
                .iter()
                .flat_map(|part| halves(&part.coefficients, part.depth))
                .collect();
            for part in &parts {
                for end in [&part.coefficients[0], &part.coefficients[6]] {
                    // Rounded up, so that it stays an upper bound.
                    let value = -((-end) >> (6 * part.depth));
                    if value < self.high {
                        self.high = value;
                    }
                }
            }
        }
    }

    /// The least distance, rounded.
    pub(crate) fn distance(&self) -> f64 {
        to_f64(&self.high, 0).sqrt() / 10.0_f64.sqrt() * 2.0_f64.powi(self.exponent)
    }

    /// By how much a distance exceeds the least one.
    pub(crate) fn excess(&self, distance: f64) -> f64 {
        let (square, exponent, bound) = self.aligned(distance, &self.high);
        let difference = to_f64(&(square - bound), exponent) / 10.0;
        let sum = distance + self.distance();
        if sum == 0.0 { 0.0 } else { difference / sum }
    }

    /// Whether a number is certainly above the least distance.
    pub(crate) fn is_certainly_below(&self, distance: f64) -> bool {
        let (square, _, bound) = self.aligned(distance, &self.high);
        square > bound
    }

    /// Whether a number is certainly below the least distance.
    pub(crate) fn is_certainly_above(&self, distance: f64) -> bool {
        let (square, _, bound) = self.aligned(distance, &self.low);
        square < bound
    }

    /// Ten times the square of a distance, and a bound, as integers with a common exponent.
    fn aligned(&self, distance: f64, bound: &IBig) -> (IBig, i32, IBig) {
        let (mantissa, own) = dyadic(distance);
        let square = 10 * (&mantissa * &mantissa);
        let exponent = (2 * own).min(2 * self.exponent);
        let up = |value: IBig, from: i32| value << usize::try_from(from - exponent).expect("least");
        (
            up(square, 2 * own),
            exponent,
            up(bound.clone(), 2 * self.exponent),
        )
    }
}

/// The two halves of a part; coefficients get six more factors of two.
fn halves(coefficients: &[IBig; 7], depth: usize) -> [Part; 2] {
    let mut right = coefficients.clone();
    let mut left = coefficients.clone();
    left[0] = left[0].clone() << 6;
    for (level, end) in left.iter_mut().enumerate().skip(1) {
        for i in 0..7 - level {
            right[i] = &right[i] + &right[i + 1];
        }
        *end = right[0].clone() << (6 - level);
    }
    // right[i] has been summed 6 - i times.
    for (i, coefficient) in right.iter_mut().enumerate() {
        *coefficient = coefficient.clone() << i;
    }
    let depth = depth + 1;
    [
        Part {
            coefficients: left,
            depth,
        },
        Part {
            coefficients: right,
            depth,
        },
    ]
}
