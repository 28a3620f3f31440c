//! Runs of consecutive cubics summed up: a box that holds many of them need not look at each.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

/// Four consecutive cubics, or four runs of them, as one: 64 bytes.
///
/// Coordinates are as in a [`CompactCubic`](super::CompactCubic). A path that strays some way from a line strays from any other
/// one (each gone along in proportion to time), to either side, at most by that and what the end of
/// the line that is farther on that side does. The line lies midway between how far the path strays to
/// either side of the line between its ends.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct CubicRun {
    /// Where its line begins; the last lane is what rounding is relative to besides coordinates.
    start: Vec4,
    /// Where that ends, and its extremes; their last lanes are how far it strays on each axis.
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
    pub(super) near: f32,
    pub(super) stray: Vec4,
}

impl CubicRun {
    /// Cubics in a run, and runs in a larger one.
    pub(crate) const SIZE: usize = 1 << Self::SHIFT;
    const SHIFT: u32 = 2;

    pub(super) fn new(unpacked: &ScaledRun) -> Self {
        let with = |lanes: Vec4, last: f32| lanes.truncate().extend(last);
        Self {
            start: with(unpacked.start, unpacked.near),
            end: with(unpacked.end, unpacked.stray.x),
            low: with(unpacked.low, unpacked.stray.y),
            high: with(unpacked.high, unpacked.stray.z),
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
            near: start.w,
            stray: Vec4::new(end.w, low.w, high.w, 0.0),
        }
    }
}

/// How many complete runs of cubics there are of some cubics: of 4, of 16, and so on.
pub(super) const fn count_of_bundles(mut cubics: usize) -> usize {
    let mut count = 0;
    while cubics >= CubicRun::SIZE {
        cubics /= CubicRun::SIZE;
        count += cubics;
    }
    count
}

/// The largest run of cubics that begins with cubic `first` and ends before cubic `end`, out of all of
/// `cubics`; and how many it holds.
#[inline(always)]
pub(super) fn largest(
    bundles: &[CubicRun],
    cubics: usize,
    first: usize,
    end: usize,
) -> Option<(&CubicRun, usize)> {
    let (mut level, mut shift, mut found) = (0, CubicRun::SHIFT, None);
    while first & ((1 << shift) - 1) == 0 && first + (1 << shift) <= end {
        found = Some((level + (first >> shift), 1 << shift));
        level += cubics >> shift;
        shift += CubicRun::SHIFT;
    }
    let (number, count) = found?;
    Some((bundles.get(number)?, count))
}
