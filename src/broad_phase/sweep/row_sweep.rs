//! The sweep itself: every record against its successors: those in its row that begin before it ends, by their bins, and
//! may form pairs with it, by their groups.

use super::region::Region;
use super::rows::{STEP, SortedRows, Successors};
use crate::broad_phase::{BodyBox, Candidate, PairFilter, emit};
use crate::count::short;
use crate::simd::Task;
use std::ops::Range;

/// Number of hits that are buffered.
const HITS: usize = 256;

/// A step with a hit: a record, its successors from the first of the 16 compared on, and a byte for each of
/// these: 1 for an overlap on the grid.
#[derive(Clone, Copy)]
struct Hit {
    record: u32,
    next: u32,
    end: u32,
    lanes: [u8; STEP],
}

/// Finds the pairs of boxes in sorted rows.
pub(super) struct SweepRows<'a> {
    pub(super) boxes: &'a [BodyBox],
    pub(super) rows: &'a SortedRows,
    /// The lists of successors that are compared.
    pub(super) lists: Range<usize>,
    pub(super) region: Option<&'a Region>,
    pub(super) filter: &'a dyn PairFilter,
    pub(super) candidates: &'a mut Vec<Candidate>,
}

impl Task for SweepRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        if self.rows.are_grouped {
            self.sweep::<true>();
        } else {
            self.sweep::<false>();
        }
    }
}

impl SweepRows<'_> {
    #[inline(always)]
    fn sweep<const GROUPED: bool>(mut self) {
        let SortedRows {
            low: [low_x, low_y, low_z],
            high: [high_x, high_y, high_z],
            ..
        } = self.rows;
        // All of one length, so that one check of an index holds for all.
        let length = low_x.len();
        let lows = [&low_x[..length], &low_y[..length], &low_z[..length]];
        let highs = [&high_x[..length], &high_y[..length], &high_z[..length]];
        let mut hits = [Hit {
            record: 0,
            next: 0,
            end: 0,
            lanes: [0; STEP],
        }; HITS];
        let mut count = 0;
        for list in self.lists.clone() {
            let Successors { record, first, end } = self.rows.list::<GROUPED>(list);
            let (number, mut next) = (record as usize, first);
            let low = [lows[0][number], lows[1][number], lows[2][number]];
            let high = [highs[0][number], highs[1][number], highs[2][number]];
            while next < end {
                let lanes = meeting(lows, highs, next as usize, low, high);
                // Written in any case, kept where there is a hit: no branch to mispredict.
                hits[count] = Hit {
                    record,
                    next,
                    end,
                    lanes,
                };
                count += usize::from(u128::from_ne_bytes(lanes) != 0);
                if count == HITS {
                    self.report(&hits);
                    if self.filter.gives_up() {
                        return;
                    }
                    count = 0;
                }
                next += short(STEP);
            }
        }
        self.report(&hits[..count]);
    }
}

/// Returns the overlaps of the 16 records from `next` on with a grid box.
///
/// One saturating difference per face; none may exceed zero.
#[inline(always)]
fn meeting(
    lows: [&[u16]; 3],
    highs: [&[u16]; 3],
    next: usize,
    low: [u16; 3],
    high: [u16; 3],
) -> [u8; STEP] {
    let to = next + STEP;
    let (low_x, high_x) = (&lows[0][next..to], &highs[0][next..to]);
    let (low_y, high_y) = (&lows[1][next..to], &highs[1][next..to]);
    let (low_z, high_z) = (&lows[2][next..to], &highs[2][next..to]);
    let mut lanes = [0; STEP];
    for lane in 0..STEP {
        let apart = low_x[lane].saturating_sub(high[0])
            | low_y[lane].saturating_sub(high[1])
            | low_z[lane].saturating_sub(high[2])
            | low[0].saturating_sub(high_x[lane])
            | low[1].saturating_sub(high_y[lane])
            | low[2].saturating_sub(high_z[lane]);
        lanes[lane] = u8::from(apart == 0);
    }
    lanes
}

impl SweepRows<'_> {
    /// Emits the pairs of hits that belong to their row and whose boxes overlap.
    #[inline(never)]
    fn report(&mut self, hits: &[Hit]) {
        let source = &self.rows.source;
        for hit in hits {
            let record = hit.record as usize;
            let copy = source[record];
            let one = &self.boxes[copy.number()];
            // What follows the successors may be the same boxes in the next row.
            let left = hit.end - hit.next;
            let mut lanes = mask(hit.lanes);
            if left < 16 {
                lanes &= (1 << left) - 1;
            }
            while lanes != 0 {
                let other = source[(hit.next + lanes.trailing_zeros()) as usize];
                lanes &= lanes - 1;
                let belongs = copy.reports_with(other);
                let other = &self.boxes[other.number()];
                if belongs
                    & one.meets(other)
                    & self.region.is_none_or(|region| region.owns(one, other))
                {
                    emit(one.body, other.body, self.filter, self.candidates);
                }
            }
        }
    }
}

/// Returns a bit for each byte; all bytes must be 0 or 1.
#[inline(always)]
pub(super) fn mask(lanes: [u8; STEP]) -> u32 {
    // Moves the lowest bit of byte i to bit 56 + i, and all else below or out.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let half = |lanes: [u8; STEP / 2]| {
        let gathered = u64::from_le_bytes(lanes).wrapping_mul(GATHER);
        gathered.to_be_bytes()[0]
    };
    let [a, b, c, d, e, f, g, h, rest @ ..] = lanes;
    u32::from(half([a, b, c, d, e, f, g, h])) | u32::from(half(rest)) << 8
}
