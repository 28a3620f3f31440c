//! Root isolation by the signs of Bernstein coefficients.
//!
//! By Descartes' rule for the Bernstein form, the number of roots in an interval is at most the
//! number of sign changes of its coefficients, and of the same parity. So no change means no root
//! and one change means one; otherwise the interval is halved. A few halvings separate most roots;
//! the recursion finds the others.

/// Largest number of halvings; the recursion separates closer roots.
const DEPTH: u8 = 4;

/// Beyond this the powers of the interval's width could overflow.
const FAR: f64 = 1e30;

/// Upper bound of the loss of a coefficient by underflow.
const UNDERFLOW: f64 = 1e-300;

/// An interval with one simple root inside.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct IsolatingInterval {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) negative_at_low: bool,
    /// Zero of the control polygon.
    pub(super) start: f64,
}

/// Up to six isolating intervals in increasing order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Isolation {
    intervals: [IsolatingInterval; 6],
    count: usize,
}

impl Isolation {
    pub(super) fn intervals(&self) -> &[IsolatingInterval] {
        &self.intervals[..self.count]
    }
}

/// A part of the interval, in fractions of it, with its Bernstein coefficients.
#[derive(Clone, Copy)]
struct SubInterval {
    heights: [f64; 7],
    low: f64,
    high: f64,
    depth: u8,
}

/// Separates all roots of a polynomial of degree at most `D` in `low..=high`.
///
/// Returns `None` if that takes too many halvings, or if a coefficient is too close to zero to know
/// its sign. So all roots found are simple, inside, and neither at the ends nor at a cut.
#[inline]
pub(super) fn isolate<const D: usize>(
    coefficients: &[f64; 7],
    low: f64,
    high: f64,
) -> Option<Isolation> {
    let width = high - low;
    let heights = heights::<D>(coefficients, low, width);
    // Shift, scale and sums have at most 12, 14 and 8 roundings a term, the halvings 6 each; the
    // terms sum up to the polynomial of absolute coefficients at |low| + width at most.
    let reach = low.abs() + width;
    if reach > FAR {
        return None;
    }
    let magnitude = (0..=D)
        .rev()
        .fold(0.0, |sum, i| sum * reach + coefficients[i].abs());
    let error = 32.0 * f64::EPSILON * magnitude + UNDERFLOW;

    let mut found = Isolation::default();
    let mut stack = [SubInterval {
        heights,
        low: 0.0,
        high: 1.0,
        depth: 0,
    }; DEPTH as usize + 1];
    let mut waiting = 1;
    while waiting > 0 {
        waiting -= 1;
        let part = stack[waiting];
        let (changes, place, least) = sign_changes::<D>(&part.heights);
        // Written so that an error that is infinite or not a number is not below.
        let certain = least > error;
        if !certain {
            return None;
        }
        if changes == 1 {
            let (before, after) = (part.heights[place], part.heights[place + 1]);
            let fraction = (place as f64 + before / (before - after)) / D as f64;
            *found.intervals.get_mut(found.count)? = IsolatingInterval {
                low: low + width * part.low,
                high: low + width * part.high,
                negative_at_low: part.heights[0] < 0.0,
                start: low + width * (part.low + (part.high - part.low) * fraction),
            };
            found.count += 1;
        } else if changes > 1 {
            if part.depth == DEPTH {
                return None;
            }
            let middle = 0.5 * (part.low + part.high);
            let depth = part.depth + 1;
            let (left, right) = halves::<D>(&part.heights);
            stack[waiting] = SubInterval {
                heights: right,
                low: middle,
                high: part.high,
                depth,
            };
            stack[waiting + 1] = SubInterval {
                heights: left,
                low: part.low,
                high: middle,
                depth,
            };
            waiting += 2;
        }
    }
    Some(found)
}

/// Returns the Bernstein coefficients over an interval.
#[inline]
fn heights<const D: usize>(coefficients: &[f64; 7], low: f64, width: f64) -> [f64; 7] {
    let mut values = *coefficients;
    // The interval becomes 0..=1: shift by `low`, then scale.
    for i in 0..D {
        for j in (i..D).rev() {
            values[j] += low * values[j + 1];
        }
    }
    let mut scale = 1.0;
    for j in 1..=D {
        scale *= width;
        values[j] *= scale * INVERSE_BINOMIALS[D][j];
    }
    for level in (1..=D).rev() {
        for i in level..=D {
            values[i] += values[i - 1];
        }
    }
    values
}

/// Returns the number of sign changes, the index before the last one, and the least absolute value.
#[inline]
fn sign_changes<const D: usize>(heights: &[f64; 7]) -> (u32, usize, f64) {
    let mut changes = 0;
    let mut place = 0;
    let mut least = heights[0].abs();
    for i in 0..D {
        let change = (heights[i] < 0.0) != (heights[i + 1] < 0.0);
        changes += u32::from(change);
        place = if change { i } else { place };
        let height = heights[i + 1].abs();
        least = if height < least { height } else { least };
    }
    (changes, place, least)
}

/// Returns the Bernstein coefficients over the two halves.
#[inline]
fn halves<const D: usize>(heights: &[f64; 7]) -> ([f64; 7], [f64; 7]) {
    let mut left = *heights;
    let mut right = *heights;
    for (level, end) in left.iter_mut().enumerate().take(D + 1).skip(1) {
        for i in 0..=D - level {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
        *end = right[0];
    }
    (left, right)
}

/// 1 / binomial(D, j).
const INVERSE_BINOMIALS: [[f64; 7]; 7] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0 / 3.0, 1.0 / 3.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 0.25, 1.0 / 6.0, 0.25, 1.0, 0.0, 0.0],
    [1.0, 0.2, 0.1, 0.1, 0.2, 1.0, 0.0],
    [1.0, 1.0 / 6.0, 1.0 / 15.0, 0.05, 1.0 / 15.0, 1.0 / 6.0, 1.0],
];
