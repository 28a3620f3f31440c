//! Batch kernels: the closest approach of thousands of pairs, on vectors of 2 to 16 lanes.
//!
//! A pair is a relative cubic over a span: four Bezier control points over the local time 0..=1.
//! A batch is twelve slices, one for each coordinate of each point: [`Lanes`], or [`CubicBatch`]
//! to fill them, or [`SpanBatch`] to fill them from segments. It answers three questions,
//! in `f64` and, but for the second, in `f32`:
//!
//! - [`closest_approach`]: how near, and when;
//! - [`enclose`]: proven bounds of the least distance, for a given error of the cubic;
//! - [`within`]: nearer than a threshold, certainly not, or undecided.
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
pub use enclosures::Enclosure;
pub use spans::SpanBatch;

/// Computes the closest approach of each pair: local times in 0..=1, distances in metres.
///
/// The distance is the global minimum over the span up to rounding: some 1e-15 (f64) or 1e-6 (f32)
/// of the size of the polygon. If there are several equal minima, or the distance is constant, any one
/// of the times may be reported. At a flat minimum the time has an error of the order of the
/// square root of the rounding. The bits are the same with every instruction set.
///
/// # Panics
///
/// If the slices do not have one entry for each pair.
pub fn closest_approach<R: Real>(
    instructions: InstructionSet,
    lanes: &Lanes<'_, R>,
    times: &mut [R],
    distances: &mut [R],
) {
    assert_eq!(lanes.len(), times.len(), "one time for each pair");
    assert_eq!(lanes.len(), distances.len(), "one distance for each pair");
    closest::closest_approach(instructions, lanes, times, distances);
}

/// Computes proven bounds of the least distance of each pair, metres.
///
/// `errors[i]` bounds, in metres and at every instant, the distance between the true relative
/// position of pair `i` and the one its control points give. Then the true least distance lies in
/// the enclosure, whatever rounds. Its width is a little more than twice the error plus 20 times
/// `EPSILON` of the polygon's size (of polygons below 1e-285 m it is no less than that size). With
/// an error that is negative or not finite, the enclosure is no bound either.
///
/// ```
/// use nearmiss::kernels::{CubicBatch, Enclosure, InstructionSet, enclose};
///
/// let mut batch = CubicBatch::new();
/// batch.push([[-6.0, 3.0, 0.0], [-2.0, 3.0, 0.0], [2.0, 3.0, 0.0], [6.0, 3.0, 0.0]]);
/// let mut found = [Enclosure { low: 0.0, high: 0.0, time: 0.0 }];
/// enclose(InstructionSet::best(), &batch.lanes(), &[1e-9], &mut found);
/// assert!(found[0].low <= 3.0 && 3.0 <= found[0].high);
/// assert!(found[0].high - found[0].low < 3e-9);
/// ```
///
/// # Panics
///
/// If the slices do not have one entry for each pair.
pub fn enclose(
    instructions: InstructionSet,
    lanes: &Lanes<'_, f64>,
    errors: &[f64],
    enclosures: &mut [Enclosure],
) {
    assert_eq!(lanes.len(), errors.len(), "one error for each pair");
    assert_eq!(lanes.len(), enclosures.len(), "one enclosure for each pair");
    enclosures::enclosures(instructions, lanes, errors, enclosures);
}

/// Decides for each pair whether it is certainly nearer than `inner` at some instant, or certainly
/// farther apart than `outer` at every instant, both in metres.
///
/// For a threshold `R` and control points with an error of up to `E` metres these are `R - E`
/// and `R + E`, rounded away from each other. A pair whose least distance is between them, or
/// within rounding of them, is undecided. `f32` control points may have been rounded from `f64`:
/// the verdict holds for the points before. A negative `inner` is never reached.
///
/// ```
/// use nearmiss::kernels::{CubicBatch, InstructionSet, Verdict, within};
///
/// // 3 m off; are these within 2.9 m, 3.1 m, and 3 m?
/// let pass = [[-6.0, 3.0, 0.0], [-2.0, 3.0, 0.0], [2.0, 3.0, 0.0], [6.0, 3.0, 0.0]];
/// let mut batch = CubicBatch::<f32>::new();
/// batch.extend([pass; 3]);
/// let (thresholds, mut verdicts) = ([2.9, 3.1, 3.0], [Verdict::Undecided; 3]);
/// within(InstructionSet::best(), &batch.lanes(), &thresholds, &thresholds, &mut verdicts);
/// assert_eq!(verdicts, [Verdict::Outside, Verdict::Inside, Verdict::Undecided]);
/// ```
///
/// # Panics
///
/// If the slices do not have one entry for each pair.
pub fn within<R: Real>(
    instructions: InstructionSet,
    lanes: &Lanes<'_, R>,
    inner: &[R],
    outer: &[R],
    verdicts: &mut [Verdict],
) {
    assert_eq!(
        lanes.len(),
        inner.len(),
        "one inner threshold for each pair"
    );
    assert_eq!(
        lanes.len(),
        outer.len(),
        "one outer threshold for each pair"
    );
    assert_eq!(lanes.len(), verdicts.len(), "one verdict for each pair");
    within::within(instructions, lanes, inner, outer, verdicts);
}
