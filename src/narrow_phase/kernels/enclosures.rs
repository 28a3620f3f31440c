//! Enclosures of the least distance: one split for blocks, then quarters, then branch and bound.

use super::batch::Lanes;
use super::loops::{BLOCK, EnclosureBlock, LaneBlock, enclose_block, enclose_block_finely};
use super::pending::{Places, RetryQueue, is_positive};
use crate::enclosure::UncertainCubic;
use crate::guess::{ControlPoints, QUICK, polygon, refined};
use crate::simd::InstructionSet;

/// An enclosure of a pair's least distance, with a time that attains it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// Lower bound of the least distance, m; not negative.
    pub low: f64,
    /// Upper bound of the least distance, m.
    pub high: f64,
    /// A local time in 0..=1 at which the distance is at most `high`.
    pub time: f64,
}

/// Returns the enclosure of one pair, by branch and bound.
///
/// `error` bounds the distance between the true relative position and that of the polygon, at every
/// instant, m. If it is infinite the enclosure is 0 to infinity. `guess` is the probable time of
/// the minimum, if known.
pub(super) fn enclose_pair(
    points: &ControlPoints<f64>,
    error: f64,
    guess: Option<f64>,
) -> Enclosure {
    let is_finite = points.iter().flatten().all(|x| x.is_finite());
    if !is_finite || !(0.0..f64::INFINITY).contains(&error) {
        return Enclosure {
            low: 0.0,
            high: f64::INFINITY,
            time: 0.0,
        };
    }
    let cubic = UncertainCubic::finite(polygon(points), error);
    let (distance, time) = cubic.nearest(guess);
    Enclosure {
        low: distance.low,
        high: distance.high,
        time,
    }
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
    let mut block = LaneBlock::new();
    let mut pending = RetryQueue::new();
    let mut bounds = EnclosureBlock::new();
    for start in (0..lanes.len()).step_by(BLOCK) {
        let end = (start + BLOCK).min(lanes.len());
        let part = lanes.range(start, end);
        enclose_block(
            instructions,
            &mut block,
            &part,
            &errors[start..end],
            &mut bounds,
        );
        for (i, enclosure) in enclosures[start..end].iter_mut().enumerate() {
            *enclosure = bounds.enclosure(i);
        }
        for place in Places::of(&bounds.tight[..end - start], |&tight| !is_positive(tight)) {
            let pair = start + place;
            let extras = [errors[pair], bounds.times[place]];
            pending.push(pair, lanes.control_points(pair), extras);
            if pending.is_full() {
                enclose_again(instructions, &mut pending, enclosures);
            }
        }
    }
    enclose_again(instructions, &mut pending, enclosures);
}

/// Bounds the pending pairs by quarters, and those still not tight by branch and bound.
fn enclose_again(
    instructions: InstructionSet,
    pending: &mut RetryQueue<f64, 2>,
    enclosures: &mut [Enclosure],
) {
    let mut bounds = EnclosureBlock::new();
    let [errors, times] = pending.extras();
    enclose_block_finely(instructions, &pending.lanes(), errors, times, &mut bounds);
    for i in 0..pending.len() {
        enclosures[pending.pair(i)] = if is_positive(bounds.tight[i]) {
            bounds.enclosure(i)
        } else {
            let points = pending.control_points(i);
            let (time, _) = refined(&points, times[i], QUICK);
            enclose_pair(&points, errors[i], Some(time))
        };
    }
    pending.clear();
}

impl EnclosureBlock {
    #[inline]
    fn enclosure(&self, i: usize) -> Enclosure {
        Enclosure {
            low: self.lows[i],
            high: self.highs[i],
            time: self.times[i],
        }
    }
}
