//! Runs of consecutive cubics summed up: a box that holds many of them need not look at each.

use super::piece::Piece;
use super::sketch::Stroke;
use super::trace::{Period, Trace};
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

/// Four consecutive cubics, or four bundles of them, as one: 64 bytes.
///
/// Coordinates are as in a [`Stroke`]. A path that strays some way from a line strays from any other
/// one (each gone along in proportion to time), to either side, at most by that and what the end of
/// the line that is farther on that side does. The line lies midway between how far the path strays to
/// either side of the line between its ends.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Bundle {
    /// Where its line begins; the last lane is what rounding is relative to besides coordinates.
    start: Vec4,
    /// Where that ends, and its extremes; their last lanes are how far it strays on each axis.
    end: Vec4,
    low: Vec4,
    high: Vec4,
}

/// A bundle in another unit.
pub(super) struct Unpacked {
    pub(super) start: Vec4,
    pub(super) end: Vec4,
    pub(super) low: Vec4,
    pub(super) high: Vec4,
    pub(super) near: f32,
    pub(super) stray: Vec4,
}

impl Bundle {
    /// Cubics in a bundle of cubics, and bundles in a larger one.
    pub(crate) const SIZE: usize = 1 << Self::SHIFT;
    const SHIFT: u32 = 2;

    pub(super) fn new(unpacked: &Unpacked) -> Self {
        let with = |lanes: Vec4, last: f32| lanes.truncate().extend(last);
        Self {
            start: with(unpacked.start, unpacked.near),
            end: with(unpacked.end, unpacked.stray.x),
            low: with(unpacked.low, unpacked.stray.y),
            high: with(unpacked.high, unpacked.stray.z),
        }
    }

    #[inline(always)]
    pub(super) fn unpack(&self, factor: f32) -> Unpacked {
        let [start, end, low, high] =
            [self.start, self.end, self.low, self.high].map(|lanes| lanes * factor);
        Unpacked {
            start,
            end,
            low,
            high,
            near: start.w,
            stray: Vec4::new(end.w, low.w, high.w, 0.0),
        }
    }

    /// Of four cubics, between five knots.
    fn of_cubics(strokes: &[Stroke], knots: &[f64]) -> Self {
        let piece = |number: usize| {
            let ends = (knots[number], knots[number + 1]);
            Piece::whole(&strokes[number], ends, 1.0)
        };
        let (head, tail) = (piece(0), piece(Self::SIZE - 1));
        let period = Period::new(knots[0], knots[Self::SIZE]);
        let mut trace = Trace::between(&head, &tail, &period);
        for number in 1..Self::SIZE {
            trace.follow_from_start(&piece(number));
        }
        trace.sum_up(tail.points[3])
    }

    /// Of four bundles, with as many cubics each between these knots.
    fn of_bundles(bundles: &[Self], knots: &[f64]) -> Self {
        let [first, last] = [0, Self::SIZE - 1].map(|number| bundles[number].unpack(1.0));
        let step = (knots.len() - 1) / Self::SIZE;
        let period = Period::new(knots[0], knots[knots.len() - 1]);
        let mut trace = Trace::between_bundles(&first, &last, &period);
        for (bundle, number) in bundles.iter().zip(1..) {
            trace.pass(&bundle.unpack(1.0), knots[number * step]);
        }
        trace.sum_up(last.end)
    }
}

/// How many complete bundles there are of some cubics: of 4, of 16, and so on.
pub(super) const fn count_of_bundles(mut cubics: usize) -> usize {
    let mut count = 0;
    while cubics >= Bundle::SIZE {
        cubics /= Bundle::SIZE;
        count += cubics;
    }
    count
}

/// Draws all complete bundles of some cubics: those of 4 cubics, then those of 16, and so on.
pub(super) fn bundle_up(knots: &[f64], strokes: &[Stroke], bundles: &mut [Bundle]) {
    let (mut span, mut below, mut level) = (Bundle::SIZE, 0, 0);
    while strokes.len() >= span {
        let count = strokes.len() / span;
        let (smaller, these) = bundles.split_at_mut(level);
        for (number, bundle) in these[..count].iter_mut().enumerate() {
            let knots = &knots[number * span..=(number + 1) * span];
            let four = number * Bundle::SIZE..(number + 1) * Bundle::SIZE;
            *bundle = if span == Bundle::SIZE {
                Bundle::of_cubics(&strokes[four], knots)
            } else {
                Bundle::of_bundles(&smaller[below..][four], knots)
            };
        }
        (below, level, span) = (level, level + count, span * Bundle::SIZE);
    }
}

/// The largest bundle that begins with cubic `first` and ends before cubic `end`, out of all of
/// `cubics`; and how many it holds.
#[inline(always)]
pub(super) fn largest(
    bundles: &[Bundle],
    cubics: usize,
    first: usize,
    end: usize,
) -> Option<(&Bundle, usize)> {
    let (mut level, mut shift, mut found) = (0, Bundle::SHIFT, None);
    while first & ((1 << shift) - 1) == 0 && first + (1 << shift) <= end {
        found = Some((level + (first >> shift), 1 << shift));
        level += cubics >> shift;
        shift += Bundle::SHIFT;
    }
    let (number, count) = found?;
    Some((bundles.get(number)?, count))
}
