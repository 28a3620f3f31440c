//! Parts of cubics and of polynomials in Bézier form.

use crate::real::Real;
use glam::DVec3;
use std::ops::{Add, Mul};

/// Control points of a cubic or of a part of one, from the end that bounds are formed around.
pub(crate) type ControlPolygon = [DVec3; 4];

/// Returns the control points of a part of a cubic, each a value of its blossom (L. Ramshaw, 1989).
///
/// `start` and `end` mix two neighbouring points in the ratio in which the part's ends divide the cubic.
#[inline(always)]
pub(crate) fn restrict<T: Copy>(
    &[p0, p1, p2, p3]: &[T; 4],
    start: impl Fn(T, T) -> T,
    end: impl Fn(T, T) -> T,
) -> [T; 4] {
    let (a0, a1, a2) = (start(p0, p1), start(p1, p2), start(p2, p3));
    let (aa0, aa1) = (start(a0, a1), start(a1, a2));
    let (b0, b1, b2) = (end(p0, p1), end(p1, p2), end(p2, p3));
    let (bb0, bb1) = (end(b0, b1), end(b1, b2));
    [
        start(aa0, aa1),
        end(aa0, aa1),
        start(bb0, bb1),
        end(bb0, bb1),
    ]
}

/// Returns the Bernstein coefficients of a polynomial before and after a share of its interval (de Casteljau).
#[inline(always)]
pub(crate) fn divide<R: Real, const N: usize>(coefficients: [R; N], share: R) -> [[R; N]; 2] {
    let other = R::from_f64(1.0) - share;
    let (mut first, mut second) = (coefficients, coefficients);
    let mut step = 1;
    while step < N {
        let mut i = 0;
        while i < N - step {
            second[i] = other * second[i] + share * second[i + 1];
            i += 1;
        }
        first[step] = second[0];
        step += 1;
    }
    [first, second]
}

/// Returns the control points of the part between two times of a cubic, whose interval has these ends.
#[inline(always)]
pub(crate) fn restrict_to<T: Copy + Add<Output = T> + Mul<f64, Output = T>>(
    points: &[T; 4],
    (start, end): (f64, f64),
    (from, to): (f64, f64),
) -> [T; 4] {
    let duration = end - start;
    let mix = |time: f64| {
        // Each weight has a small relative error, also near an end.
        let (first, second) = ((end - time) / duration, (time - start) / duration);
        move |p: T, q: T| p * first + q * second
    };
    restrict(points, mix(from), mix(to))
}
