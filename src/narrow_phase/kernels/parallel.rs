//! The kernels on all threads of the current rayon pool, with the same bits.
//!
//! Small batches stay on the caller's thread.

use super::{Enclosure, InstructionSet, Lanes, Real, Verdict};
use crate::parallel::run_both;

/// Pairs below which another thread does not pay: 47 microseconds of work on the processor in
/// `benches/results` with AVX-512, in `f64`.
const CHUNK: usize = 4096;

/// Runs [`closest_approach`](super::closest_approach) on all threads.
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
    let Some((left, right)) = halves(lanes) else {
        super::closest_approach(instructions, lanes, times, distances);
        return;
    };
    let (times_a, times_b) = times.split_at_mut(left.len());
    let (distances_a, distances_b) = distances.split_at_mut(left.len());
    run_both(
        &mut |_| closest_approach(instructions, &left, times_a, distances_a),
        &mut |_| closest_approach(instructions, &right, times_b, distances_b),
    );
}

/// Runs [`enclose`](super::enclose) on all threads.
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
    let Some((left, right)) = halves(lanes) else {
        super::enclose(instructions, lanes, errors, enclosures);
        return;
    };
    let (errors_a, errors_b) = errors.split_at(left.len());
    let (enclosures_a, enclosures_b) = enclosures.split_at_mut(left.len());
    run_both(
        &mut |_| enclose(instructions, &left, errors_a, enclosures_a),
        &mut |_| enclose(instructions, &right, errors_b, enclosures_b),
    );
}

/// Runs [`within`](super::within()) on all threads.
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
    let Some((left, right)) = halves(lanes) else {
        super::within(instructions, lanes, inner, outer, verdicts);
        return;
    };
    let (inner_a, inner_b) = inner.split_at(left.len());
    let (outer_a, outer_b) = outer.split_at(left.len());
    let (verdicts_a, verdicts_b) = verdicts.split_at_mut(left.len());
    run_both(
        &mut |_| within(instructions, &left, inner_a, outer_a, verdicts_a),
        &mut |_| within(instructions, &right, inner_b, outer_b, verdicts_b),
    );
}

/// Returns the two halves of a batch that is worth splitting.
fn halves<'a, R: Real>(lanes: &Lanes<'a, R>) -> Option<(Lanes<'a, R>, Lanes<'a, R>)> {
    let count = lanes.len();
    let middle = count / 2;
    (count > CHUNK).then(|| (lanes.range(0, middle), lanes.range(middle, count)))
}
