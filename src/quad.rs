//! Four f64 side by side: x, y, z and one lane to spare.
//!
//! Loops over lanes without calls, which the compiler turns into vector instructions in a
//! [`Task`](crate::simd::Task); hence `inline(always)` and plain comparisons (numbers, not NaN).

use glam::DVec3;

pub(crate) type Quad = [f64; 4];

#[inline(always)]
pub(crate) fn quad(vector: DVec3) -> Quad {
    [vector.x, vector.y, vector.z, 0.0]
}

#[inline(always)]
fn each(a: Quad, b: Quad, of: impl Fn(f64, f64) -> f64) -> Quad {
    [
        of(a[0], b[0]),
        of(a[1], b[1]),
        of(a[2], b[2]),
        of(a[3], b[3]),
    ]
}

#[inline(always)]
pub(crate) fn sum(a: Quad, b: Quad) -> Quad {
    each(a, b, |a, b| a + b)
}

#[inline(always)]
pub(crate) fn difference(a: Quad, b: Quad) -> Quad {
    each(a, b, |a, b| a - b)
}

#[inline(always)]
pub(crate) fn times(a: Quad, factor: f64) -> Quad {
    each(a, [factor; 4], |a, b| a * b)
}

#[inline(always)]
pub(crate) fn least(a: Quad, b: Quad) -> Quad {
    each(a, b, |a, b| if a < b { a } else { b })
}

#[inline(always)]
pub(crate) fn most(a: Quad, b: Quad) -> Quad {
    each(a, b, |a, b| if a > b { a } else { b })
}

#[inline(always)]
pub(crate) fn size(a: Quad) -> Quad {
    [a[0].abs(), a[1].abs(), a[2].abs(), a[3].abs()]
}
