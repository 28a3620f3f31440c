//! Enclosures for many pairs: one split, then quarters, then branch and bound.

use super::batch::Lanes;
use super::dispatch::{BLOCK, Block, Level, enclose_block, enclose_block_finely};
use super::enclosure::{Enclosure, enclose};
use super::pending::Pending;

/// The enclosure of the least distance of each pair, on one thread.
pub(super) fn enclosures(
    level: Level,
    lanes: &Lanes<'_, f64>,
    errors: &[f64],
    enclosures: &mut [Enclosure],
) {
    let mut block = Block::new();
    let mut pending = Pending::new();
    let mut found = [[0.0; BLOCK]; 4];
    let mut start = 0;
    while start < lanes.len() {
        let end = (start + BLOCK).min(lanes.len());
        let [times, lows, highs, tight] = found.each_mut().map(|slot| &mut slot[..end - start]);
        let part = lanes.range(start, end);
        enclose_block(level, &mut block, &part, &errors[start..end], times, lows, highs, tight);
        for i in 0..end - start {
            let pair = start + i;
            enclosures[pair] = Enclosure { low: lows[i], high: highs[i], time: times[i] };
            // Also where it is not a number.
            if !(tight[i] > 0.0) {
                pending.push(pair, lanes, [errors[pair], times[i]]);
                if pending.is_full() {
                    enclose_again(level, &mut pending, enclosures);
                }
            }
        }
        start = end;
    }
    enclose_again(level, &mut pending, enclosures);
}

/// Quarters for the pairs that are pending, and branch and bound for those still not tight.
fn enclose_again(level: Level, pending: &mut Pending<f64, 2>, enclosures: &mut [Enclosure]) {
    let mut found = [[0.0; BLOCK]; 3];
    let [lows, highs, tight] = found.each_mut().map(|slot| &mut slot[..pending.len()]);
    let lanes = pending.lanes();
    let [errors, times] = pending.extras();
    enclose_block_finely(level, &lanes, errors, times, lows, highs, tight);
    for i in 0..pending.len() {
        enclosures[pending.pair(i)] = if tight[i] > 0.0 {
            Enclosure { low: lows[i], high: highs[i], time: times[i] }
        } else {
            enclose(&lanes.control_points(i), errors[i])
        };
    }
    pending.clear();
}
