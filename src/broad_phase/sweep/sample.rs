//! Statistics of boxes, from a sample of them.

use super::partition::SplitPlanes;
use super::region::Region;
use crate::broad_phase::BodyBox;

/// A sample of boxes: where they start, and how long they are. Decides about speed, never about
/// pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct BoxSample {
    /// Low corners in ascending order, for each axis (m).
    lows: [Vec<f32>; 3],
    /// The range of nearly all low corners (m).
    ranges: [(f32, f32); 3],
    /// Mean extents as shares of these ranges, none counted longer than the range.
    shares: [f64; 3],
}

impl BoxSample {
    /// One in this many boxes is looked at, but not fewer or more than these.
    const STRIDE: usize = 16;
    const FEWEST: usize = 64;
    const MAX: usize = 256;
    /// One in this many of the sample may lie anywhere on either side.
    const STRAYS: usize = 32;
    /// A gap is this many times wider than the mean one. Of 256 places drawn evenly, the widest
    /// gap is 6 times the mean, and one case in ten has a wider one than this.
    const WIDE: f64 = 8.0;

    /// Looks at a sample of boxes as far as they are in the region.
    pub(super) fn take(&mut self, boxes: &[BodyBox], region: &Region) {
        let size = (boxes.len() / Self::STRIDE)
            .clamp(Self::FEWEST, Self::MAX)
            .min(boxes.len());
        for axis in 0..3 {
            let lows = &mut self.lows[axis];
            lows.clear();
            let sample = scattered(size, boxes.len());
            lows.extend(sample.map(|place| low(&boxes[place], region, axis)));
            lows.sort_unstable_by(f32::total_cmp);
            self.ranges[axis] = range(lows);
            let width = width(self.ranges[axis]);
            let mut sum = 0.0;
            for place in scattered(size, boxes.len()) {
                let high = boxes[place].aabb.maxs[axis].min(region.high[axis]);
                let extent = f64::from(high) - f64::from(low(&boxes[place], region, axis));
                sum += if extent < width { extent / width } else { 1.0 };
            }
            self.shares[axis] = sum / size as f64;
        }
    }

    /// The range of low corners on each axis (m), but for a few that stray.
    pub(super) const fn ranges(&self) -> [(f32, f32); 3] {
        self.ranges
    }

    /// Mean extents on each axis as shares of the range.
    pub(super) const fn shares(&self) -> [f64; 3] {
        self.shares
    }

    /// Sets planes in the empty space between boxes, if that is more than half of an axis; gives
    /// whether it is.
    pub(super) fn cut_at_gaps(&self, cuts: &mut SplitPlanes) -> bool {
        for axis in 0..3 {
            cuts.axis = axis;
            cuts.planes.clear();
            let lows = &self.lows[axis];
            let strays = lows.len() / Self::STRAYS;
            let lows = &lows[strays..lows.len() - strays];
            let whole = width((lows[0], lows[lows.len() - 1]));
            let wide = (Self::WIDE / lows.len() as f64).max(4.0 * self.shares[axis]) * whole;
            let mut empty = 0.0;
            for gap in lows.windows(2) {
                let size = width((gap[0], gap[1]));
                if size > wide {
                    empty += size;
                    cuts.planes.push(before(gap[1], gap[0]));
                }
            }
            if empty > 0.5 * whole {
                return true;
            }
        }
        false
    }

    /// Sets planes that divide the boxes into four about equal parts, across the axis on which
    /// boxes are shortest.
    pub(super) fn cut_evenly(&self, cuts: &mut SplitPlanes) {
        let shares = &self.shares;
        let shorter = |&one: &usize, &other: &usize| shares[one].total_cmp(&shares[other]);
        cuts.axis = (0..3).min_by(shorter).unwrap_or(0);
        let lows = &self.lows[cuts.axis];
        let quarter = lows.len() / 4;
        cuts.planes.clear();
        cuts.planes
            .extend([quarter, 2 * quarter, 3 * quarter].map(|place| lows[place]));
        cuts.planes.dedup();
    }
}

/// Returns the place at which a box starts in the region.
fn low(one: &BodyBox, region: &Region, axis: usize) -> f32 {
    one.aabb.mins[axis].max(region.low[axis])
}

/// The range of nearly all of the ascending numbers: without the outermost ones, but widened again
/// by an eighth as far as there are any.
fn range(lows: &[f32]) -> (f32, f32) {
    let strays = lows.len() / BoxSample::STRAYS;
    let (first, last) = (lows[0], lows[lows.len() - 1]);
    let (low, high) = (lows[strays], lows[lows.len() - 1 - strays]);
    let margin = 0.125 * high - 0.125 * low;
    if margin > 0.0 {
        ((low - margin).max(first), (high + margin).min(last))
    } else {
        (first, last)
    }
}

/// A place between two, far nearer to the first: all of its cluster is likely on its side, and
/// what reaches over from the other side does not start far off.
fn before(near: f32, far: f32) -> f32 {
    near - (0.0625 * near - 0.0625 * far)
}

fn width((low, high): (f32, f32)) -> f64 {
    f64::from(high) - f64::from(low)
}

/// `size` of the numbers 0..count: all, or spread evenly but not in equal strides, so that no
/// order of the bodies can hide some of them (multiples of the golden ratio).
#[allow(
    clippy::cast_possible_truncation,
    reason = "the ratio's multiples wrap on purpose, and what results is below count"
)]
pub(super) fn scattered(size: usize, count: usize) -> impl Iterator<Item = usize> {
    (0..size).map(move |k| {
        if size == count {
            k
        } else {
            let turn = (k as u32).wrapping_mul(0x9E37_79B9);
            ((u64::from(turn) * count as u64) >> 32) as usize
        }
    })
}
