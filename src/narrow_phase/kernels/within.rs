//! Verdicts for many pairs: two Bernstein screens, then an enclosure for the few undecided ones.

use super::Verdict;
use super::batch::Lanes;
use super::enclosures::enclose_pair;
use super::loops::{BLOCK, EnclosureBlock, LaneBlock, enclose_block};
use super::pending::{Places, RetryQueue};
use super::screen::{screen_block, screen_block_finely, screen_eighths, screen_halves};
use crate::guess::{ControlPoints, in_f64, largest_coordinate};
use crate::real::Real;
use crate::simd::InstructionSet;

pub(super) fn within_of<R: Real>(points: &ControlPoints<R>, inner: R, outer: R) -> Verdict {
    let first = screen_halves(*points, inner, outer);
    if first != Verdict::Undecided {
        return first;
    }
    let second = screen_eighths(*points, inner, outer);
    if second != Verdict::Undecided {
        return second;
    }
    let wide = in_f64(points);
    last_verdict(
        &wide,
        conversion_error::<R>(&wide),
        inner.to_f64(),
        outer.to_f64(),
    )
}

/// Returns the verdict from a tight enclosure.
fn last_verdict(points: &ControlPoints<f64>, error: f64, inner: f64, outer: f64) -> Verdict {
    let enclosure = enclose_pair(points, error, None);
    verdict_between(enclosure.low, enclosure.high, inner, outer)
}

/// Returns the verdict if the least distance is between two numbers.
#[inline]
fn verdict_between(low: f64, high: f64, inner: f64, outer: f64) -> Verdict {
    if low > outer {
        Verdict::Outside
    } else if high < inner {
        Verdict::Inside
    } else {
        Verdict::Undecided
    }
}

/// Returns a bound on the rounding of the points to the type of the lanes.
#[inline]
fn conversion_error<R: Real>(points: &ControlPoints<f64>) -> f64 {
    let rounding = R::ROUNDING.to_f64();
    if rounding < f64::EPSILON {
        return 0.0;
    }
    // sqrt(3) times the largest coordinate bounds the size of the polygon.
    1.8 * (rounding * largest_coordinate(points) + R::UNDERFLOW.to_f64())
}

/// The work of one call of [`within`].
struct WithinBatch<'a, R> {
    instructions: InstructionSet,
    verdicts: &'a mut [Verdict],
    /// Undecided after the first screen; with the thresholds.
    second: RetryQueue<R, 2>,
    /// Undecided after the second screen; with the thresholds and the error, in f64.
    third: RetryQueue<f64, 3>,
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
    let mut screening = WithinBatch {
        instructions,
        verdicts,
        second: RetryQueue::new(),
        third: RetryQueue::new(),
    };
    for start in (0..lanes.len()).step_by(BLOCK) {
        let end = (start + BLOCK).min(lanes.len());
        let block = lanes.range(start, end);
        let found = &mut screening.verdicts[start..end];
        screen_block(
            instructions,
            &block,
            &inner[start..end],
            &outer[start..end],
            found,
        );
        for place in Places::of(found, |&verdict| verdict == Verdict::Undecided) {
            let pair = start + place;
            let points = lanes.control_points(pair);
            screening
                .second
                .push(pair, points, [inner[pair], outer[pair]]);
            if screening.second.is_full() {
                screening.screen_again();
            }
        }
    }
    screening.screen_again();
    screening.enclose();
}

impl<R: Real> WithinBatch<'_, R> {
    /// Applies the second screen to the waiting pairs.
    fn screen_again(&mut self) {
        let mut verdicts = [Verdict::Undecided; BLOCK];
        let verdicts = &mut verdicts[..self.second.width()];
        let [inner, outer] = self.second.extras();
        screen_block_finely(
            self.instructions,
            &self.second.lanes(),
            inner,
            outer,
            verdicts,
        );
        for i in 0..self.second.len() {
            let pair = self.second.pair(i);
            self.verdicts[pair] = verdicts[i];
            if verdicts[i] == Verdict::Undecided {
                let wide = in_f64(&self.second.control_points(i));
                let [inner, outer] = self.second.extras().map(|extra| extra[i].to_f64());
                let error = conversion_error::<R>(&wide);
                self.third.push(pair, wide, [inner, outer, error]);
                if self.third.is_full() {
                    self.enclose();
                }
            }
        }
        self.second.clear();
    }

    /// Encloses the waiting pairs.
    fn enclose(&mut self) {
        let Self {
            instructions,
            third,
            verdicts,
            ..
        } = self;
        if third.is_empty() {
            return;
        }
        let mut bounds = EnclosureBlock::new();
        let lanes = third.lanes();
        let [inner, outer, errors] = third.extras();
        enclose_block(
            *instructions,
            &mut LaneBlock::new(),
            &lanes,
            errors,
            &mut bounds,
        );
        for i in 0..third.len() {
            let tight = bounds.tight[i];
            let mut found = Verdict::Undecided;
            if tight >= 0.0 {
                found = verdict_between(bounds.lows[i], bounds.highs[i], inner[i], outer[i]);
            }
            // A tight enclosure that is undecided stays so.
            if found == Verdict::Undecided && (tight <= 0.0 || tight.is_nan()) {
                found = last_verdict(&third.control_points(i), errors[i], inner[i], outer[i]);
            }
            verdicts[third.pair(i)] = found;
        }
        third.clear();
    }
}
