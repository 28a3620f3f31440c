//! The quadratic formula without cancellation.

use super::roots::RootList;
use crate::rounding::normalising_power;

/// Returns the real roots of `c0 + c1 x + c2 x²`, sorted; a double root once.
///
/// Each root is computed by the textbook formula without cancellation. Its relative error is a few
/// units of rounding unless the discriminant itself is within rounding of zero. If `c2` is zero,
/// the root of the line is returned; if `c2` is so small that the second root overflows, only the
/// first one. If `c1` and `c2` are zero the list is empty, whatever `c0`:
/// [`Polynomial::roots_in`](super::Polynomial::roots_in) tells these cases apart.
///
/// Any finite coefficients are allowed: those outside 1e±120 are scaled by a power of two first.
/// Coefficients that are not finite give a meaningless list.
///
/// ```
/// use nearmiss::internals::polynomial::quadratic;
///
/// // The small root keeps all its digits.
/// assert_eq!(&quadratic([1.0, -1e9, 1.0])[..], &[1e-9, 1e9]);
/// ```
#[must_use]
pub fn quadratic(coefficients: [f64; 3]) -> RootList {
    let [c0, c1, c2] = coefficients;
    let largest = c0.abs().max(c1.abs()).max(c2.abs());
    if (1e-120..=1e120).contains(&largest) {
        return scaled_quadratic(c0, c1, c2);
    }
    let factor = normalising_power(largest);
    scaled_quadratic(c0 * factor, c1 * factor, c2 * factor)
}

/// Returns the roots for coefficients whose squares do not overflow.
#[inline]
pub(super) fn scaled_quadratic(c0: f64, c1: f64, c2: f64) -> RootList {
    let mut roots = RootList::default();
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
    let (low, high) = if first < second {
        (first, second)
    } else {
        (second, first)
    };
    if low.is_finite() {
        roots.push(low);
    }
    if high.is_finite() && (high > low || !low.is_finite()) {
        roots.push(high);
    }
    roots
}
