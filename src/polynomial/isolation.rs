//! Root isolation by the signs of Bernstein coefficients.
//!
//! By Descartes' rule for the Bernstein form, the number of roots in an interval is at most the
//! number of sign changes of its coefficients, and of the same parity. So no change means no root
//! and one change means one; otherwise the interval is halved. A few halvings separate most roots;
//! the recursion finds the others.

use arrayvec::ArrayVec;

/// Largest number of halvings; the recursion separates closer roots.
const DEPTH: u8 = 4;

/// Upper bound of the loss of a coefficient by underflow.
const UNDERFLOW: f64 = 1e-300;

/// An interval with one simple root inside.
pub(super) struct IsolatingInterval {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) negative_at_low: bool,
    /// Zero of the control polygon.
    pub(super) start: f64,
}

/// A part of -1..=1, in fractions of it, with its Bernstein coefficients.
struct SubInterval {
    bernstein: [f64; 7],
    low: f64,
    high: f64,
    depth: u8,
}

/// Separates all roots of a polynomial of degree at most `D` in -1..=1: increasing intervals.
///
/// Returns `None` if that takes too many halvings, or if a coefficient is too close to zero to know
/// its sign. So all roots found are simple, inside, and neither at the ends nor at a cut.
#[inline]
pub(super) fn isolate<const D: usize>(
    coefficients: &[f64; 7],
) -> Option<ArrayVec<IsolatingInterval, 6>> {
    // Shift, scale and sums have at most 12, 14 and 8 roundings a term, the halvings 6 each; the
    // terms sum up to the polynomial of absolute coefficients at 1 + 2 at most.
    let magnitude = (0..=D)
        .rev()
        .fold(0.0, |sum, i| sum * 3.0 + coefficients[i].abs());
    let error = 32.0 * f64::EPSILON * magnitude + UNDERFLOW;

    let mut found = ArrayVec::new();
    let mut stack = ArrayVec::<_, { DEPTH as usize + 1 }>::new();
    stack.push(SubInterval {
        bernstein: bernstein::<D>(coefficients),
        low: 0.0,
        high: 1.0,
        depth: 0,
    });
    while let Some(part) = stack.pop() {
        let (changes, place, least) = sign_changes::<D>(&part.bernstein);
        // Written so that an error that is infinite or not a number is not below.
        let certain = least > error;
        if !certain {
            return None;
        }
        if changes == 1 {
            let (before, after) = (part.bernstein[place], part.bernstein[place + 1]);
            let fraction = (place as f64 + before / (before - after)) / D as f64;
            let interval = IsolatingInterval {
                low: -1.0 + 2.0 * part.low,
                high: -1.0 + 2.0 * part.high,
                negative_at_low: part.bernstein[0] < 0.0,
                start: -1.0 + 2.0 * (part.low + (part.high - part.low) * fraction),
            };
            found.try_push(interval).ok()?;
        } else if changes > 1 {
            if part.depth == DEPTH {
                return None;
            }
            let middle = 0.5 * (part.low + part.high);
            let depth = part.depth + 1;
            let (left, right) = halves::<D>(&part.bernstein);
            stack.push(SubInterval {
                bernstein: right,
                low: middle,
                depth,
                ..part
            });
            stack.push(SubInterval {
                bernstein: left,
                high: middle,
                depth,
                ..part
            });
        }
    }
    Some(found)
}

/// Returns the Bernstein coefficients over -1..=1.
#[inline]
fn bernstein<const D: usize>(coefficients: &[f64; 7]) -> [f64; 7] {
    let mut values = *coefficients;
    // The interval becomes 0..=1: shift, then scale.
    for i in 0..D {
        for j in (i..D).rev() {
            values[j] -= values[j + 1];
        }
    }
    let mut scale = 1.0;
    for j in 1..=D {
        scale *= 2.0;
        values[j] *= scale * INVERSE_BINOMIALS[D - 5][j];
    }
    for step in (1..=D).rev() {
        for i in step..=D {
            values[i] += values[i - 1];
        }
    }
    values
}

/// Returns the number of sign changes, the index before the last one, and the least absolute value.
#[inline]
fn sign_changes<const D: usize>(bernstein: &[f64; 7]) -> (u32, usize, f64) {
    let mut changes = 0;
    let mut place = 0;
    let mut least = bernstein[0].abs();
    for i in 0..D {
        let change = (bernstein[i] < 0.0) != (bernstein[i + 1] < 0.0);
        changes += u32::from(change);
        place = if change { i } else { place };
        let coefficient = bernstein[i + 1].abs();
        least = if coefficient < least {
            coefficient
        } else {
            least
        };
    }
    (changes, place, least)
}

/// Returns the Bernstein coefficients over the two halves.
#[inline]
fn halves<const D: usize>(bernstein: &[f64; 7]) -> ([f64; 7], [f64; 7]) {
    let mut left = *bernstein;
    let mut right = *bernstein;
    for (step, end) in left.iter_mut().enumerate().take(D + 1).skip(1) {
        for i in 0..=D - step {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
        *end = right[0];
    }
    (left, right)
}

/// 1 / binomial(D, j), for `D` of 5 and 6.
const INVERSE_BINOMIALS: [[f64; 7]; 2] = [
    [1.0, 0.2, 0.1, 0.1, 0.2, 1.0, 0.0],
    [1.0, 1.0 / 6.0, 1.0 / 15.0, 0.05, 1.0 / 15.0, 1.0 / 6.0, 1.0],
];
