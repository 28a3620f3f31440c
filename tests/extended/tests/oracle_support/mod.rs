//! The exact oracle: distances of moving bodies in integer arithmetic, nothing rounded.
//!
//! It shares no code and no method with the crate. The truth is the real cubic Hermite spline
//! through the f64 states as given (or the real polynomial with the f64 coefficients as given);
//! every number below is an integer times a power of two, every comparison is exact.
//!
//! ```text
//! dyadic       numbers m 2^e
//! polynomial   integer polynomials: gcd, square-free part, signs
//! roots        isolation of all roots in [0, 1] (Descartes' rule on Bernstein coefficients)
//! motion       states or coefficients -> cubics, domains, spans
//! distance     squared distance over a span, as an integer polynomial
//! minimum      global minimum with all instants at which it is reached, ties decided exactly
//! algebraic    order of two critical values, when enclosures cannot tell them apart
//! contacts     maximal closed intervals with distance <= D, touching instants included
//! polygons     seeded families of cubics to try claims on
//! verify       fast proofs of claims: never below lo, somewhere at most hi
//! ```

#![allow(
    dead_code,
    reason = "each test binary that includes the oracle uses a part of it"
)]
#![allow(
    unused_imports,
    reason = "each test binary that includes the oracle uses a part of it"
)]
#![allow(clippy::unwrap_used, reason = "a panic in the oracle is a failed test")]

mod algebraic;
mod contacts;
mod distance;
mod dyadic;
mod minimum;
mod motion;
mod polygons;
mod polynomial;
mod roots;
mod verify;

pub(crate) use contacts::{Contact, contacts};
pub(crate) use distance::{SquaredDistance, squared_distances};
pub(crate) use dyadic::Dyadic;
pub(crate) use minimum::{Enclosure, Minimum, Stretch, minimum};
pub(crate) use motion::{Body, Outside, PolynomialSegment, Span, State, spans};
pub(crate) use polygons::{FAMILIES, Family, Polygon, polygon};
pub(crate) use polynomial::Polynomial;
pub(crate) use roots::{Root, isolate};
pub(crate) use verify::{is_at_most, least_sign, never_above, never_below, reaches, stays_above};
