//! Runs of consecutive cubics: a box that contains many cubics is formed from few runs.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

/// Bounds of four consecutive cubics, or of four smaller runs: 64 bytes.
///
/// Coordinates are as in a [`CompactCubic`](super::CompactCubic). The run is a line with the largest
/// deviation of the motion from it: the chord, moved to the middle between the extreme deviations. If a
/// motion deviates from one uniformly parametrised line by at most d, it deviates from another one by
/// at most d plus the larger distance between corresponding ends of both lines (per axis and side).
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct CubicRun {
    /// Start of the line; the last lane is the largest `spread` of a cubic: see [`SubCubic`](super::SubCubic).
    start: Vec4,
    /// End of the line, and the extreme coordinates of the motion; the last lanes are the largest deviation from the
    /// line on each axis.
    end: Vec4,
    low: Vec4,
    high: Vec4,
}

/// A run of cubics in another unit.
pub(super) struct ScaledRun {
    pub(super) start: Vec4,
    pub(super) end: Vec4,
    pub(super) low: Vec4,
    pub(super) high: Vec4,
    pub(super) spread: f32,
    pub(super) deviation: Vec4,
}

impl CubicRun {
    /// Cubics in a run, and runs in a larger one.
    pub(crate) const SIZE: usize = 1 << Self::SHIFT;
    const SHIFT: u32 = 2;

    pub(super) fn new(unpacked: &ScaledRun) -> Self {
        let with = |lanes: Vec4, last: f32| lanes.truncate().extend(last);
        Self {
            start: with(unpacked.start, unpacked.spread),
            end: with(unpacked.end, unpacked.deviation.x),
            low: with(unpacked.low, unpacked.deviation.y),
            high: with(unpacked.high, unpacked.deviation.z),
        }
    }

    #[inline(always)]
    pub(super) fn unpack(&self, factor: f32) -> ScaledRun {
        let [start, end, low, high] =
            [self.start, self.end, self.low, self.high].map(|lanes| lanes * factor);
        ScaledRun {
            start,
            end,
            low,
            high,
            spread: start.w,
            deviation: Vec4::new(end.w, low.w, high.w, 0.0),
        }
    }
}

/// Returns the number of complete runs of `cubics` cubics: of 4, of 16, and so on.
pub(super) const fn count_of_runs(mut cubics: usize) -> usize {
    let mut count = 0;
    while cubics >= CubicRun::SIZE {
        cubics /= CubicRun::SIZE;
        count += cubics;
    }
    count
}

/// Returns the largest run from cubic `first` to before cubic `end`, and its number of cubics.
#[inline(always)]
pub(super) fn largest(
    runs: &[CubicRun],
    cubics: usize,
    first: usize,
    end: usize,
) -> Option<(&CubicRun, usize)> {
    let (mut start, mut shift, mut found) = (0, CubicRun::SHIFT, None);
    while first & ((1 << shift) - 1) == 0 && first + (1 << shift) <= end {
        found = Some((start + (first >> shift), 1 << shift));
        start += cubics >> shift;
        shift += CubicRun::SHIFT;
    }
    let (number, count) = found?;
    Some((runs.get(number)?, count))
}
