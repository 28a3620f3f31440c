//! A body that is told straight motions again and again, and has more of them than a few: with a history, with several
//! calls between two ticks, or told for instants ahead of the clock.

use super::motion_list::{MotionList, cut_after};
use super::outside::Outside;
use super::segment::Segment;
use super::straight::StraightMotion;
use crate::simd::prefetch;
use std::sync::OnceLock;

/// Any number of straight motions, one after another.
#[derive(Clone, Debug)]
pub(super) struct ManyMotions {
    /// The motions, after those of the pieces that were dropped.
    motions: Vec<StraightMotion>,
    /// The knots, after those of the pieces that were dropped; the end of the first piece after the last knot.
    piece_knots: Vec<f64>,
    /// Number of pieces that were dropped. They are moved out when they are most, so that each piece is moved about once.
    dropped: usize,
    before: Outside,
    /// The cubics between the knots, for those who ask for a list of them.
    segments: OnceLock<Box<[Segment]>>,
}

impl ManyMotions {
    /// Returns some motions between the knots of their pieces (s).
    pub(super) fn of(
        motions: impl Iterator<Item = StraightMotion>,
        piece_knots: &[f64],
        before: Outside,
    ) -> Self {
        Self {
            motions: motions.collect(),
            piece_knots: piece_knots.to_vec(),
            dropped: 0,
            before,
            segments: OnceLock::new(),
        }
    }

    pub(super) const fn before(&self) -> Outside {
        self.before
    }

    /// Returns the cubics between the knots.
    pub(super) fn segments(&self) -> &[Segment] {
        self.segments.get_or_init(|| {
            let motions = self.motions();
            let motions = &motions[..motions.len() - 1];
            motions.iter().map(StraightMotion::segment).collect()
        })
    }

    /// Prefetches both ends of the lists: the clock is among the last motions.
    pub(super) fn prefetch(&self) {
        const KNOTS: usize = 8;
        const MOTIONS: usize = 3;
        let (motions, knots) = (self.motions(), self.piece_knots());
        prefetch(&knots[..knots.len().min(1)]);
        prefetch(&knots[knots.len().saturating_sub(KNOTS)..]);
        prefetch(&motions[motions.len().saturating_sub(MOTIONS)..]);
    }
}

impl MotionList for ManyMotions {
    #[inline]
    fn motions(&self) -> &[StraightMotion] {
        &self.motions[self.dropped..]
    }

    #[inline]
    fn piece_knots(&self) -> &[f64] {
        &self.piece_knots[self.dropped..]
    }

    fn keep(&mut self, dropped: usize, kept: usize) {
        self.dropped += dropped;
        let count = self.dropped + kept;
        self.motions.truncate(count);
        self.piece_knots.truncate(count);
        if self.dropped > kept {
            self.motions.drain(..self.dropped);
            self.piece_knots.drain(..self.dropped);
            self.dropped = 0;
        }
        if dropped > 0 {
            self.before = Outside::Absent;
        }
    }

    fn push(&mut self, knot: f64, motion: &StraightMotion) {
        self.motions.push(*motion);
        self.piece_knots.push(knot);
    }

    fn finish(&mut self) {
        if let (Some(motion), Some(knot)) = (self.motions.last(), self.piece_knots.last()) {
            self.piece_knots.push(cut_after(*knot, motion, 1));
        }
        self.segments.take();
    }
}
