//! The real roots of polynomials of degree 5 and 6 between -1 and 1.
//!
//! Everything here is plain mathematics on `f64` coefficients, without allocation and without
//! any notion of bodies, times or distances.
//!
//! # The roots
//!
//! [`roots`] follows C. Yuksel, "High-Performance Polynomial Root Finding for
//! Graphics", Proceedings of the ACM on Computer Graphics and Interactive Techniques 5(3), 2022:
//! between two neighbouring roots of the derivative a polynomial is monotone and has at most one
//! root, which a bracketed Newton iteration finds. The roots of the derivative are found the same
//! way, down to a quadratic, which has a formula.
//!
//! Most polynomials do not need the recursion. If the signs of the Bernstein coefficients prove,
//! after a few halvings, that every part holds at most one root (Descartes' rule), Newton's
//! iteration starts there. Polynomials that rounding leaves uncertain go through the recursion.
//!
//! Guarantees, for finite coefficients:
//!
//! - *Sorted, and each once.* A multiple root is reported once, whatever its multiplicity.
//! - *Closed interval.* A root at an end belongs to the interval.
//! - *Touching counts.* A turning point or an end of the interval where the polynomial is zero
//!   within the rounding of its coefficients and of its evaluation is reported as a root, unless
//!   a sign change next to it already is. With a positive `tolerance` a zero that lies outside the
//!   interval by up to that much may be reported at the end. The search errs on the side of
//!   reporting.
//! - *Backward stable.* The roots are those of a polynomial whose coefficients differ from the
//!   given ones by some units of rounding. Where roots are ill-conditioned (clusters, multiple
//!   roots) the roots of these two polynomials can be far apart: a root of multiplicity m is
//!   known to about the m-th root of 1e-16, and a cluster may come out as fewer roots.
//! - *Degenerate input has an answer.* Leading coefficients may be zero or tiny. A constant has no
//!   root, not even zero, of which every point is one.
//!
//! With a positive `tolerance`, pairs of roots closer than about twice the tolerance may be
//! reported as one root or as none.

mod isolation;
mod recursion;

use crate::rounding::scale_to_one;
use recursion::solve;

pub use recursion::RootList;

/// Returns the real roots from -1 to 1 of the sum of `coefficients[i]` times x to the i.
///
/// `tolerance` is the largest error of a well-conditioned root; 0 means full precision. The
/// guarantees are listed in `src/polynomial/mod.rs`. The degree is 5 or 6: other lengths do not
/// compile.
///
/// ```
/// use nearmiss::internals::polynomial::roots;
///
/// // (x + 1) (2 x - 1) (x - 1)
/// assert_eq!(roots([1.0, -2.0, -1.0, 2.0, 0.0, 0.0], 0.0).as_slice(), [-1.0, 0.5, 1.0]);
/// assert!(roots([0.0; 6], 0.0).is_empty());
/// ```
#[inline]
#[must_use]
pub fn roots<const N: usize>(coefficients: [f64; N], tolerance: f64) -> RootList {
    const { assert!(N == 6 || N == 7, "roots are found of degree 5 and 6") };
    let mut padded = [0.0; 7];
    padded[..N].copy_from_slice(&coefficients);
    let sizes = coefficients.iter().map(|coefficient| coefficient.abs());
    let largest = sizes.fold(0.0, f64::max);
    if largest == 0.0 {
        return RootList::new();
    }
    // Away from the ends of the range nothing overflows in the derivatives or squares.
    if !(1e-90..=1e90).contains(&largest) {
        let factor = scale_to_one(largest);
        padded = padded.map(|coefficient| coefficient * factor);
    }
    match N {
        6 => solve::<5>(&padded, tolerance),
        _ => solve::<6>(&padded, tolerance),
    }
}
