//! Yuksel's recursion: the roots of the derivative bracket the roots.
//!
//! All polynomials have seven coefficients, those above the degree `D` unused, since the type cannot
//! say that a derivative has one coefficient less. Loops over a constant range are unrolled.

use super::isolation::{IsolatingInterval, isolate};
use arrayvec::ArrayVec;

/// Up to six numbers in increasing order.
pub type RootList = ArrayVec<f64, 6>;

/// Newton steps before bisection joins in: more than an isolated simple root takes.
const PATIENCE: u32 = 8;

/// A polynomial of degree at most `D` (the rest of the seven coefficients is zero) and its slope.
struct PolynomialOfDegree<const D: usize> {
    coefficients: [f64; 7],
    slope: [f64; 7],
}

/// Returns the roots of a polynomial of degree at most `D` in -1..=1, touching ones included.
///
/// The coefficients must be at most 1e90 and not all zero.
pub(super) fn solve<const D: usize>(coefficients: &[f64; 7], tolerance: f64) -> RootList {
    let polynomial = PolynomialOfDegree::<D>::new(coefficients);
    let mut roots = RootList::new();
    if let Some(intervals) = isolate::<D>(coefficients) {
        for interval in intervals {
            push_apart(&mut roots, polynomial.refine(interval, tolerance));
        }
        return roots;
    }
    let turning = polynomial.turning_points(tolerance);
    let near_zero = polynomial.near_zero_test(tolerance);

    let mut left = -1.0;
    let mut left_value = polynomial.value(left);
    let mut left_near = near_zero(left, left_value);
    // Whether the root that makes `left` nearly zero is in the list already. A piece with both
    // ends nearly zero is nearly zero throughout, so a chain of such ends is one root.
    let mut reported = false;
    for right in turning.into_iter().chain([1.0]) {
        let right_value = polynomial.value(right);
        let right_near = near_zero(right, right_value);
        let crossing =
            (left_value < 0.0 && right_value > 0.0) || (left_value > 0.0 && right_value < 0.0);
        if !reported && (crossing || left_near) {
            push_apart(
                &mut roots,
                if crossing {
                    polynomial.refine(
                        monotone_piece(left, left_value, right, right_value),
                        tolerance,
                    )
                } else {
                    left
                },
            );
        }
        reported = right_near && (crossing || left_near);
        (left, left_value, left_near) = (right, right_value, right_near);
    }
    if left_near && !reported {
        push_apart(&mut roots, left);
    }
    roots
}

/// Returns the sign changes of a polynomial of degree at most `D` between -1 and 1.
///
/// For bracketing only: a touching zero may be missed or reported.
fn crossings<const D: usize>(coefficients: &[f64; 7], tolerance: f64) -> RootList {
    let polynomial = PolynomialOfDegree::<D>::new(coefficients);
    let mut roots = RootList::new();
    let mut left = -1.0;
    let mut left_value = polynomial.value(left);
    for right in polynomial
        .turning_points(tolerance)
        .into_iter()
        .chain([1.0])
    {
        let right_value = polynomial.value(right);
        if (left_value < 0.0) != (right_value < 0.0) {
            let piece = monotone_piece(left, left_value, right, right_value);
            push_apart(&mut roots, polynomial.refine(piece, tolerance));
        }
        (left, left_value) = (right, right_value);
    }
    roots
}

/// Returns an interval between two points of different sign.
#[inline]
fn monotone_piece(low: f64, low_value: f64, high: f64, high_value: f64) -> IsolatingInterval {
    // Between two turning points a polynomial looks like 3 x² - 2 x³, whose inverse is
    // 1/2 - sin(asin(1 - 2 y) / 3); this agrees with it at the ends and the middle.
    let y = low_value / (low_value - high_value);
    let z = 1.0 - 2.0 * y;
    let x = 0.5 - z * (1.0 / 3.0 + z * z / 6.0);
    let guess = low + (high - low) * x;
    // Values that overflow give no guess.
    let start = if guess > low && guess < high {
        guess
    } else {
        0.5 * low + 0.5 * high
    };
    IsolatingInterval {
        low,
        high,
        negative_at_low: low_value < 0.0,
        start,
    }
}

/// Appends a root unless it equals the last one.
#[inline]
fn push_apart(roots: &mut RootList, root: f64) {
    if roots.last().is_none_or(|&last| last < root) {
        roots.push(root);
    }
}

/// Returns the real roots of `c0 + c1 x + c2 x²` between -1 and 1, by the formula without
/// cancellation; a double root once. The squares of the coefficients must not overflow.
#[inline]
fn quadratic([c0, c1, c2]: [f64; 3]) -> RootList {
    let mut roots = RootList::new();
    let discriminant = c1 * c1 - 4.0 * c2 * c0;
    if discriminant < 0.0 {
        return roots;
    }
    let root = discriminant.sqrt();
    // -c1 and the root of the discriminant are added with the same sign.
    let q = -0.5 * if c1 < 0.0 { c1 - root } else { c1 + root };
    // q = 0 only if c1 and c0 c2 are 0: then x = 0 is the double root, or there is none.
    let first = if q == 0.0 { q / c2 } else { c0 / q };
    let second = q / c2;
    let sorted = if first < second {
        [first, second]
    } else {
        [second, first]
    };
    for x in sorted {
        if x > -1.0 && x < 1.0 {
            push_apart(&mut roots, x);
        }
    }
    roots
}

impl<const D: usize> PolynomialOfDegree<D> {
    #[inline]
    fn new(coefficients: &[f64; 7]) -> Self {
        let mut slope = [0.0; 7];
        let mut power = 0.0;
        for i in 0..D {
            power += 1.0;
            slope[i] = power * coefficients[i + 1];
        }
        Self {
            coefficients: *coefficients,
            slope,
        }
    }

    #[inline]
    fn value(&self, x: f64) -> f64 {
        evaluate::<D>(&self.coefficients, x)
    }

    #[inline]
    fn slope(&self, x: f64) -> f64 {
        match D {
            6 => evaluate::<5>(&self.slope, x),
            5 => evaluate::<4>(&self.slope, x),
            4 => evaluate::<3>(&self.slope, x),
            _ => evaluate::<2>(&self.slope, x),
        }
    }

    /// Returns the sign changes of the slope: between neighbouring ones the polynomial is monotone.
    #[inline]
    fn turning_points(&self, tolerance: f64) -> RootList {
        let [c0, c1, c2, ..] = self.slope;
        match D {
            6 => crossings::<5>(&self.slope, tolerance),
            5 => crossings::<4>(&self.slope, tolerance),
            4 => crossings::<3>(&self.slope, tolerance),
            _ => quadratic([c0, c1, c2]),
        }
    }

    /// Returns a test whether a value may be zero: within `tolerance` of a zero to first order, or
    /// within the rounding of the coefficients (one unit each) and of `evaluate` (at most 3 D / 2 +
    /// 2 units of each term).
    #[inline]
    fn near_zero_test(&self, tolerance: f64) -> impl Fn(f64, f64) -> bool {
        let units = (4 * D + 4) as f64 * (0.5 * f64::EPSILON);
        let noise = self.coefficients.map(|c| c.abs() * units);
        let steepness = self.slope.map(|c| c.abs() * tolerance);
        // No value above this passes the test anywhere in the interval.
        let limit = horner::<D>(&noise, 1.0) + horner::<D>(&steepness, 1.0);
        move |x: f64, value: f64| {
            value.abs() <= limit
                && value.abs() <= tolerance * self.slope(x).abs() + horner::<D>(&noise, x.abs())
        }
    }

    /// Returns the only root in an interval, by Newton's method safeguarded by bisection.
    ///
    /// The error after a step is estimated from the last two: `step³ / last²` where the convergence
    /// is quadratic, and with a factor of 16 to spare also where it is linear. The steps must have
    /// shrunk twice in a row, since a single small step can be chance. Bisection between the bit
    /// patterns ends the search after at most some 150 evaluations on any interval.
    fn refine(&self, interval: IsolatingInterval, tolerance: f64) -> f64 {
        let IsolatingInterval {
            mut low,
            mut high,
            negative_at_low,
            start: mut x,
        } = interval;
        // The last two Newton steps, 0 where the point was not reached by one.
        let (mut last, mut before_last) = (0.0, 0.0);
        let mut evaluations = 0;
        loop {
            let value = self.value(x);
            if value == 0.0 {
                return x;
            }
            if (value < 0.0) == negative_at_low {
                low = x;
            } else {
                high = x;
            }
            let newton = x - value / self.slope(x);
            let limit = tolerance + f64::EPSILON * newton.abs();
            evaluations += 1;
            let step = (newton - x).abs();
            // A NaN (zero or infinite slope) is not between.
            let between = newton >= low && newton <= high;
            let ratio = step / last;
            let shrinking = 2.0 * last <= before_last;
            if between && shrinking && 16.0 * step * (ratio * ratio) <= limit {
                return newton;
            }
            // Exactly at an end it would stand still.
            let usable = newton > low && newton < high;
            let next = if usable && (evaluations < PATIENCE || evaluations.is_multiple_of(2)) {
                (last, before_last) = (step, last);
                newton
            } else {
                (last, before_last) = (0.0, 0.0);
                if evaluations < PATIENCE {
                    0.5 * low + 0.5 * high
                } else {
                    middle_of_bits(low, high)
                }
            };
            if high - low <= tolerance || next <= low || next >= high {
                return next;
            }
            x = next;
        }
    }
}

/// Returns the value of a polynomial of degree `D`, with even and odd powers summed apart: half the
/// latency of Horner's rule, with the same order of rounding.
#[inline(always)]
fn evaluate<const D: usize>(coefficients: &[f64; 7], x: f64) -> f64 {
    let square = x * x;
    let (even_top, odd_top) = if D.is_multiple_of(2) {
        (D, D - 1)
    } else {
        (D - 1, D)
    };
    let mut even = coefficients[even_top];
    let mut odd = coefficients[odd_top];
    for k in 1..=D / 2 {
        if even_top >= 2 * k {
            even = even * square + coefficients[even_top - 2 * k];
        }
        if odd_top > 2 * k {
            odd = odd * square + coefficients[odd_top - 2 * k];
        }
    }
    even + x * odd
}

#[inline]
fn horner<const D: usize>(coefficients: &[f64; 7], x: f64) -> f64 {
    let mut value = 0.0;
    for &coefficient in coefficients[..=D].iter().rev() {
        value = value * x + coefficient;
    }
    value
}

/// Returns the number half-way between two others in the order of all floating-point numbers, so
/// that 64 halvings end in neighbours whatever the range.
fn middle_of_bits(low: f64, high: f64) -> f64 {
    /// Maps a bit pattern to an integer that grows with the number, and back.
    fn ordered(bits: i64) -> i64 {
        bits ^ (((bits >> 63).cast_unsigned() >> 1).cast_signed())
    }
    let low = ordered(low.to_bits().cast_signed());
    let high = ordered(high.to_bits().cast_signed());
    // Rounds down without overflow.
    let middle = (low & high) + ((low ^ high) >> 1);
    f64::from_bits(ordered(middle).cast_unsigned())
}
