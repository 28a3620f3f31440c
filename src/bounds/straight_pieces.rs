//! Straight motions, one after another, and their bounds in a slice.

use super::builder::BoundsBuilder;
use super::frame::Frame;
use super::slice_interval::SliceInterval;
use super::straight_part::StraightPart;
use crate::trajectory::StraightMotion;

/// Straight motions, one after another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StraightPieces<'a> {
    pub(super) motions: &'a [StraightMotion],
    /// One more than motions.
    pub(super) knots: &'a [f64],
    /// Number of the first motion among the body's cubics.
    pub(super) before: usize,
    /// The frame of the body's place.
    pub(super) anchor: Frame,
}

impl StraightPieces<'_> {
    /// Returns the bounds of the motion in a slice, and the number of its first cubic there. All of the slice lies
    /// between the first and the last knot.
    #[inline(always)]
    pub(crate) fn bounds<const MOVES: bool>(
        &self,
        period: &SliceInterval<MOVES>,
    ) -> (BoundsBuilder<MOVES>, usize) {
        let count = self.motions.len();
        let ends = &self.knots[1..count];
        // A piece that ends as the slice begins counts with its last point, as one does that begins at its end.
        let first = ends.iter().take_while(|&&end| end < period.from).count();
        let later = ends[first..].iter().take_while(|&&end| end <= period.to);
        let last = first + later.count();
        let head = self.part(first, period);
        if first == last {
            return (
                BoundsBuilder::along(&head, &head, period),
                self.before + first,
            );
        }
        let tail = self.part(last, period);
        let mut builder = BoundsBuilder::along(&head, &tail, period);
        for number in first + 1..last {
            builder.go_straight(&self.part(number, period));
        }
        builder.go_straight(&tail);
        (builder, self.before + first)
    }

    /// Returns the part of a motion within a slice.
    #[inline(always)]
    fn part<const MOVES: bool>(
        &self,
        number: usize,
        period: &SliceInterval<MOVES>,
    ) -> StraightPart {
        let from = self.knots[number].max(period.from);
        let to = self.knots[number + 1].min(period.to);
        StraightPart::new(&self.motions[number], (from, to), &self.anchor)
    }
}
