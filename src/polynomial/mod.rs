//! Polynomials of fixed low degree: evaluation, Bernstein form, real roots.
//!
//! Everything here is plain mathematics on `f64` coefficients, without allocation and without
//! any notion of bodies, times or distances.
//!
//! - [`Polynomial`]: coefficients of 1, x, x², …; evaluation, derivative, roots.
//! - [`Bernstein`]: coefficients over the unit interval; bounds by the convex hull, subdivision.
//! - [`quadratic`]: the numerically stable quadratic formula.
//! - [`Roots`], [`RootList`]: the result of a root search.
//!
//! # The roots
//!
//! [`Polynomial::roots_in`] follows C. Yuksel, "High-Performance Polynomial Root Finding for
//! Graphics", Proceedings of the ACM on Computer Graphics and Interactive Techniques 5(3), 2022:
//! between two neighbouring roots of the derivative a polynomial is monotone and has at most one
//! root, which a bracketed Newton iteration finds. The roots of the derivative are found the same
//! way, down to a quadratic, which has a formula.
//!
//! Most polynomials do not need the recursion. If the signs of the Bernstein coefficients prove,
//! after a few halvings, that every part holds at most one root (Descartes' rule), Newton's
//! iteration starts there. Polynomials that rounding leaves uncertain go through the recursion.
//!
//! Guarantees, for finite coefficients and a finite interval:
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
//! - *Degenerate input has an answer.* Leading coefficients may be zero or tiny, a nonzero
//!   constant has no root, and the zero polynomial answers [`Roots::Everywhere`].
//!
//! With a positive `tolerance`, pairs of roots closer than about twice the tolerance may be
//! reported as one root or as none.

mod bernstein;
mod isolation;
mod power;
mod quadratic;
mod recursion;
mod roots;

pub use bernstein::Bernstein;
pub use power::Polynomial;
pub use quadratic::quadratic;
pub use roots::{RootList, Roots};
