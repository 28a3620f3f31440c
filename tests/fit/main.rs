//! Fits against the motions they stand for: errors are never exceeded, and knots are few.

#![allow(
    clippy::unwrap_used,
    reason = "a fit that fails unexpectedly fails its test"
)]

mod bad_input;
mod estimated;
mod motions;
mod polynomials;
mod proven;
mod velocity;
