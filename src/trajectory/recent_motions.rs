//! A body that is told a new straight motion again and again: its last few motions.

use super::motion_list::{MotionList, cut_after};
use super::outside::Outside;
use super::segment::Segment;
use super::straight::StraightMotion;
use crate::count::short;
use crate::rounding::without_negative_zero;
use crate::simd::{prefetch, prefetch_first};
use std::sync::OnceLock;

/// The last few straight motions of a body, one after another. They take no other memory, unless somebody asks
/// for a list of cubics.
///
/// Seven cache lines. A body that is told a state a tick has its motions in the first two and all else in the sixth.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct RecentMotions {
    motions: [StraightMotion; Self::ROOM],
    /// Number of pieces.
    count: u32,
    before: Outside,
    /// The cubics between the knots, for those who ask for a list of them.
    segments: OnceLock<Box<[Segment]>>,
    /// The knots, and the end of the first piece after the last one: one more than there are pieces.
    piece_knots: [f64; Self::ROOM + 1],
}

impl RecentMotions {
    /// Number of pieces of a body that is told a state each tick: the piece until the state is told, and the piece from then
    /// on.
    pub(super) const USUAL: usize = 2;
    /// Largest number of pieces. There is one more for each further state between two ticks: of a physics engine that takes
    /// up to four steps a tick.
    pub(super) const ROOM: usize = Self::USUAL + 3;

    /// Returns a few motions between the knots of their pieces (s).
    pub(super) fn of(
        motions: impl Iterator<Item = StraightMotion>,
        piece_knots: &[f64],
        before: Outside,
    ) -> Self {
        let mut recent = Self {
            motions: [StraightMotion::NONE; Self::ROOM],
            count: short(piece_knots.len() - 1),
            before,
            segments: OnceLock::new(),
            piece_knots: [0.0; Self::ROOM + 1],
        };
        recent.piece_knots[..piece_knots.len()].copy_from_slice(piece_knots);
        for (place, motion) in recent.motions.iter_mut().zip(motions) {
            *place = motion;
        }
        recent
    }

    /// Prefetches what a body has that is told a state each tick.
    #[inline]
    pub(super) fn prefetch(&self) {
        prefetch(&self.motions[..Self::USUAL]);
        prefetch_first(&self.count);
    }

    const fn pieces(&self) -> usize {
        self.count as usize
    }

    /// Returns the knots, s.
    pub(super) fn knots(&self) -> &[f64] {
        &self.piece_knots[..self.pieces()]
    }

    /// Returns the rule before the first knot.
    pub(super) const fn before(&self) -> Outside {
        self.before
    }

    /// Returns the cubics between the knots.
    pub(super) fn segments(&self) -> &[Segment] {
        self.segments.get_or_init(|| {
            let motions = &self.motions[..self.pieces() - 1];
            motions.iter().map(StraightMotion::segment).collect()
        })
    }

    /// Replaces the motion, without checks: [`LastMotion::is_replaced_by`] must be true. Then the motion so far goes on in
    /// one piece. Returns the facts that a further motion is checked against; `None`, and changes nothing, if there is no
    /// room.
    #[inline]
    pub(super) fn replace_checked(
        &mut self,
        from: f64,
        motion: &StraightMotion,
        since: f64,
    ) -> Option<LastMotion> {
        let dropped = self.past(since);
        let kept = self.pieces() - dropped;
        if kept == Self::ROOM {
            return None;
        }
        debug_assert!(from <= self.piece_knots[self.pieces()]);
        self.keep(dropped, kept);
        self.push(without_negative_zero(from), motion);
        self.finish();
        // `is_replaced_by` has checked that the motion can be followed for all of its first piece, and longer.
        Some(self.facts())
    }

    /// Returns the number of pieces, not all of them, that end before an instant (s).
    #[inline]
    fn past(&self, since: f64) -> usize {
        let past = self.knots().iter().take_while(|knot| **knot < since);
        past.count().saturating_sub(1).min(self.pieces() - 1)
    }

    #[inline]
    fn facts(&self) -> LastMotion {
        let place = self.pieces() - 1;
        LastMotion::of_piece(&self.motions[place], self.piece_knots[place])
    }
}

impl MotionList for RecentMotions {
    #[inline]
    fn motions(&self) -> &[StraightMotion] {
        &self.motions[..self.pieces()]
    }

    #[inline]
    fn piece_knots(&self) -> &[f64] {
        &self.piece_knots[..=self.pieces()]
    }

    #[inline]
    fn keep(&mut self, dropped: usize, kept: usize) {
        self.count = short(kept);
        if dropped > 0 {
            for place in 0..kept {
                self.motions[place] = self.motions[dropped + place];
                self.piece_knots[place] = self.piece_knots[dropped + place];
            }
            self.before = Outside::Absent;
        }
    }

    #[inline]
    fn push(&mut self, knot: f64, motion: &StraightMotion) {
        let place = self.pieces();
        self.motions[place] = *motion;
        self.piece_knots[place] = knot;
        self.count += 1;
    }

    #[inline]
    fn finish(&mut self) {
        let place = self.pieces() - 1;
        self.piece_knots[place + 1] = cut_after(self.piece_knots[place], &self.motions[place], 1);
        self.segments.take();
    }
}

/// The facts about a body's recent motions that a further one is checked against. The monitor keeps a copy, and so
/// need not read the motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LastMotion {
    /// The last knot, s; not a number if the body has no such motions.
    knot: f64,
    /// The time of the state that the last motion goes through, s.
    start: f64,
}

impl LastMotion {
    /// Time for which each of these motions goes on in one piece, s: less than all but the rounding of the duration of its
    /// cubic.
    const IN_ONE_PIECE: f64 = 0.9 * StraightMotion::DURATION;

    pub(crate) const NONE: Self = Self {
        knot: f64::NAN,
        start: 0.0,
    };

    /// Returns the facts about the last of some motions. There are some only where it can certainly be followed for all of
    /// its first piece.
    #[inline]
    pub(super) fn of(list: &impl MotionList) -> Self {
        let (Some(motion), [.., knot, end]) = (list.motions().last(), list.piece_knots()) else {
            return Self::NONE;
        };
        if motion.is_near(*knot, *end) {
            Self::of_piece(motion, *knot)
        } else {
            Self::NONE
        }
    }

    /// Returns the facts about a motion from its knot (s) on.
    #[inline]
    fn of_piece(motion: &StraightMotion, knot: f64) -> Self {
        if motion.duration() < Self::IN_ONE_PIECE {
            return Self::NONE;
        }
        Self {
            knot,
            start: motion.start(),
        }
    }

    /// Returns true if a motion certainly [replaces](super::Trajectory::replace_checked) the last one at `from` (s).
    /// The last motion goes on in one piece from its knot to `from`. The first knot of the trajectory is not after another
    /// instant (both s). The new motion differs from the last one, and can be followed in all pieces up to `far` (s).
    #[inline]
    pub(crate) fn is_replaced_by(
        &self,
        motion: &StraightMotion,
        from: f64,
        (first_knot, start): (f64, f64),
        far: f64,
    ) -> bool {
        // All pieces up to some cut last as long as the next one does, but for the duration of the first.
        let end = from + 2.0 * (far - from).max(0.0) + motion.duration();
        let is_resolved = motion.duration() > 2.0 * f64::EPSILON * from.abs();
        let is_other = (motion.start() - self.start).abs() > 0.0 && motion.moves();
        is_other
            && first_knot <= start
            && self.knot < from
            && from - self.knot <= Self::IN_ONE_PIECE
            && motion.start() <= from
            && is_resolved
            && motion.is_near(from, end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn what_is_told_each_tick_takes_three_cache_lines() {
        let motions = offset_of!(RecentMotions, motions) + RecentMotions::USUAL * 64;
        let first = offset_of!(RecentMotions, count);
        let last = offset_of!(RecentMotions, piece_knots) + (RecentMotions::USUAL + 1) * 8;
        assert!(size_of::<StraightMotion>() == 64 && motions <= 128);
        assert!(first % 64 == 0 && last <= first + 64, "{first} {last}");
        assert_eq!(size_of::<RecentMotions>(), 448);
    }
}
