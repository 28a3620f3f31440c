//! Statistics of a sample of boxes.

use super::partition::Partition;
use super::region::Region;
use crate::broad_phase::BodyBox;

/// A sample of the boxes' positions and extents. It influences the speed, never the pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct BoxSample {
    /// Low corners in ascending order, for each axis.
    lows: [Vec<f32>; 3],
    /// Range of low corners on each axis, without outliers.
    pub(super) ranges: [(f32, f32); 3],
    /// Mean extents as shares of these ranges, none counted longer than the range.
    pub(super) shares: [f64; 3],
}

impl BoxSample {
    /// Sampling stride in boxes, and limits of the sample's size.
    const STRIDE: usize = 16;
    const FEWEST: usize = 64;
    const MAX: usize = 256;
    /// Share of the sample on either side that may be outliers: one in this number.
    const OUTLIERS: usize = 32;
    /// Ratio of a gap to the mean one. The widest gap of 256 places drawn evenly is 6 times the
    /// mean on average, and exceeds this ratio in one case of ten.
    const WIDE: f64 = 8.0;

    /// Samples boxes, clipped to the region.
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

    /// Sets planes in empty space and returns true, if that is more than half of an axis.
    pub(super) fn set_planes_at_gaps(&self, partition: &mut Partition) -> bool {
        for axis in 0..3 {
            partition.axis = axis;
            partition.planes.clear();
            let lows = &self.lows[axis];
            let outliers = lows.len() / Self::OUTLIERS;
            let lows = &lows[outliers..lows.len() - outliers];
            let whole = width((lows[0], lows[lows.len() - 1]));
            let wide = (Self::WIDE / lows.len() as f64).max(4.0 * self.shares[axis]) * whole;
            let mut empty = 0.0;
            for gap in lows.windows(2) {
                let size = width((gap[0], gap[1]));
                if size > wide {
                    empty += size;
                    partition.planes.push(before(gap[1], gap[0]));
                }
            }
            if empty > 0.5 * whole {
                return true;
            }
        }
        false
    }

    /// Sets planes that quarter the boxes about equally, across the axis with the shortest boxes.
    pub(super) fn set_planes_evenly(&self, partition: &mut Partition) {
        let shares = &self.shares;
        let shorter = |&one: &usize, &other: &usize| shares[one].total_cmp(&shares[other]);
        partition.axis = (0..3).min_by(shorter).unwrap_or(0);
        let lows = &self.lows[partition.axis];
        let quarter = lows.len() / 4;
        partition.planes.clear();
        partition
            .planes
            .extend([quarter, 2 * quarter, 3 * quarter].map(|place| lows[place]));
        partition.planes.dedup();
    }
}

/// Returns the start of a box in the region.
fn low(one: &BodyBox, region: &Region, axis: usize) -> f32 {
    one.aabb.mins[axis].max(region.low[axis])
}

/// Returns the range of ascending numbers without outliers, widened by up to an eighth.
fn range(lows: &[f32]) -> (f32, f32) {
    let outliers = lows.len() / BoxSample::OUTLIERS;
    let (first, last) = (lows[0], lows[lows.len() - 1]);
    let (low, high) = (lows[outliers], lows[lows.len() - 1 - outliers]);
    let margin = 0.125 * high - 0.125 * low;
    if margin > 0.0 {
        ((low - margin).max(first), (high + margin).min(last))
    } else {
        (first, last)
    }
}

/// Returns a place between two, close to the first. All of its cluster is probably on its side, and
/// boxes that reach over from the other side do not start far off.
fn before(near: f32, far: f32) -> f32 {
    near - (0.0625 * near - 0.0625 * far)
}

fn width((low, high): (f32, f32)) -> f64 {
    f64::from(high) - f64::from(low)
}

/// Returns `size` of the numbers 0..count: all, or spread evenly but not periodically, so that no
/// order of the bodies hides some of them (multiples of the golden ratio).
#[allow(
    clippy::cast_possible_truncation,
    reason = "the ratio's multiples wrap on purpose, and what results is below count"
)]
pub(super) fn scattered(size: usize, count: usize) -> impl Iterator<Item = usize> {
    (0..size).map(move |k| {
        if size == count {
            k
        } else {
            let fraction = (k as u32).wrapping_mul(0x9E37_79B9);
            ((u64::from(fraction) * count as u64) >> 32) as usize
        }
    })
}
