//! Batch kernels: the closest approach of thousands of pairs, on vectors of 2 to 16 lanes.
//!
//! A pair is a relative cubic over a span: four Bezier control points over the local time 0..=1.
//! A batch is twelve slices, one for each coordinate of each point: [`Lanes`], or [`CubicBatch`]
//! to fill them, or [`SpanBatch`] to fill them from segments. It answers three questions,
//! in `f64` and, but for the second, in `f32`:
//!
//! - [`closest_approach`]: how near, and when;
//! - [`enclose`]: proven bounds of the least distance, for a given error of the cubic;
//! - [`within`](within()): nearer than a threshold, certainly not, or undecided.
//!
//! [`scalar`] asks the same of a single pair. The functions here work on the caller's thread;
//! those in `parallel` (a feature) on all threads of the current rayon pool.
//!
//! ```
//! use nearmiss::kernels::{CubicBatch, InstructionSet, closest_approach};
//!
//! // One body passes the other on a straight line, 3 m off, nearest in the middle of the span.
//! let mut batch = CubicBatch::new();
//! batch.push([[-6.0, 3.0, 0.0], [-2.0, 3.0, 0.0], [2.0, 3.0, 0.0], [6.0, 3.0, 0.0]]);
//! let (mut times, mut distances) = ([0.0_f64], [0.0]);
//! closest_approach(InstructionSet::best(), &batch.lanes(), &mut times, &mut distances);
//! assert_eq!((times[0], distances[0]), (0.5, 3.0));
//! ```
//!
//! # How
//!
//! *Guess, then prove the guess* (`src/guess`, `certificate.rs`): the lowest of nine samples, one or two steps of
//! high order on the slope of the squared distance, one more on the vectors. Then the squared
//! distance, less its value at the guess, is divided twice by the distance in time from the guess;
//! if the Bernstein coefficients of the quotient, a quartic, show on both halves of the span that
//! it is positive, no other point is lower. Only the step on the vectors needs the precision of the
//! result: guesses and proofs are made in `f32`, twice as many lanes to a vector. Pairs without a
//! proof are gathered and tried again with their other minimum (`rival.rs`), which is either lower
//! or shows where to cut the span for the proof, unless it is as low. The last ones are enclosed,
//! and searched by branch and bound.
//!
//! *Enclosures* (`src/enclosure`): the span is split at the guess; on each side a quadratic below
//! the Bernstein coefficients of the squared distance, formed from differences, bounds it to the
//! last digits. Then quarters, then branch and bound.
//!
//! *Verdicts* (`screen.rs`): Bernstein coefficients on halves, then eighths, then enclosures.
//!
//! Each stage is a plain function of one lane, without branches. A loop over it is compiled for
//! each instruction set (`simd.rs`, the only file with `unsafe`), and the compiler makes the
//! vectors. No operation is fused or reordered, so all [`InstructionSet`]s give the same bits, and
//! a pair has the same result in any batch, at any place of it, and on any thread.
//!
//! # Rounding
//!
//! `u` is the unit of rounding of the type, `M` the size of the polygon (its farthest control
//! point), `C0..C3` the coefficient vectors of the centred cubic.
//!
//! - *Certificate of a guess*, where `u` is that of `f32`. The coefficients `a_k` of the squared
//!   distance have an error of at most `7 u A_k`, where `A_k` sums the products `|C_i| |C_j|`,
//!   `i + j = k`: 2 for the rounding of both vectors to `f32`, 5 for the products and sums. Two
//!   divisions with `|u*| <= 1` round each term 9 times more, the change to Bernstein form and the
//!   mean of two coefficients 6 times; `u*` itself was rounded, which moves the quotient by `8/3`
//!   units of its terms. `A_k` enters the quotient with the factor `k (k - 1) / 2`. With
//!   `2 |C_i| |C_j| <= |C_i|² + |C_j|²` the error is at most `25 u W`,
//!   `W = 4 |C0|² + 10 |C1|² + 20 |C2|² + 34 |C3|²`; the tolerance is `40 u W`. The slope at an end
//!   has an error of at most `18 u` times the sum of `k A_k`, which is below `27 u W`; it is
//!   lowered by `30 u W` before it is used. What it adds to the coefficients, 5 times itself at
//!   most, is rounded up to 3 times, which is `6 u W` more than the lowering allows for. Against a
//!   rival the quotient becomes a quintic (3 roundings, and twice the size at an end), is cut (15)
//!   and halved twice (10): less than `146 u W` with the roundings of the slope, which is below
//!   `1.5 W`; the tolerance is `160 u W`. The proof is that no point is lower by more than the
//!   residual slope allows; that slope is rounding of the lanes' type after the last step. For a
//!   complete bound use [`enclose`].
//! - *Enclosure.* Splitting the polygon moves it by `9 u M` at most, halvings add `3 u M` each. The
//!   error of the distance is that plus the given error of the cubic, once; the rounding of the
//!   lower bound itself is counted term by term where it is formed.
//! - *Verdict.* The Bernstein coefficients of the squared distance have an error of `7 u M²`;
//!   of `8 u M²` with respect to points that were rounded to the type of the lanes. Halvings add
//!   `6 u M²` each. The tolerances are 16 (one halving) and 32 (three) `u M²`. So `f32` lanes filled
//!   with rounded `f64` points never lose a conflict of these points.
//!
//! Squares that overflow or underflow fail every test; such pairs end in the scalar `f64` code,
//! which scales by powers of two first. As guesses are proven in `f32`, these are polygons beyond
//! some 1e15 m (f32 lanes: 1e8 m) or below 1e-10 m. A pair with a coordinate that is not finite is
//! undecided (except that nothing is within a negative distance). Its enclosure is infinite, and
//! its closest approach meaningless.

mod batch;
mod certificate;
mod closest;
mod enclosures;
#[cfg(test)]
mod exactly;
mod loops;
#[cfg(feature = "parallel")]
pub mod parallel;
mod pending;
mod rival;
pub mod scalar;
mod screen;
mod spans;
mod within;

pub use crate::enclosure::Verdict;
pub use crate::guess::ControlPoints;
pub use crate::real::Real;
pub use crate::simd::InstructionSet;
pub use batch::{CubicBatch, Lanes};
pub use closest::closest_approach;
pub use enclosures::{Enclosure, enclose};
pub use spans::SpanBatch;
pub use within::within;
