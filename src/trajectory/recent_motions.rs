//! A body that is told a new straight motion again and again: its last few motions.
//!
//! In this file `from` is the instant (s) from which a new motion is followed. Pieces that end before `since` (s) are
//! dropped: the caller does not ask about the time before.

use super::cuts::DoublingCuts;
use super::outside::Outside;
use super::segment::Segment;
use super::segment_lists::SegmentLists;
use super::straight::StraightMotion;
use crate::count::short;
use crate::rounding::without_negative_zero;
use crate::simd::{prefetch, prefetch_first};
use std::iter::once;
use std::sync::OnceLock;

/// The last few straight motions of a body, one after another. They take no other memory, unless somebody asks
/// for a list of cubics.
///
/// Each motion listed here is one piece. The last motion goes on for ever: only its first piece after the last knot is
/// listed.
///
/// Eight cache lines. A body that is told a state a tick has its motions in the first three and all else in the seventh.
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
    /// Number of pieces of a body that is told a state each tick: the piece that ended when the clock was last advanced, the
    /// piece until the state is told, and the piece from then on.
    const USUAL: usize = 3;
    /// Largest number of pieces. There is one more for each further state between two ticks: of a physics engine that takes
    /// up to four steps a tick.
    const ROOM: usize = Self::USUAL + 3;

    /// Returns lists in this form, if they hold a few straight motions, one after another.
    pub(super) fn of(lists: &SegmentLists) -> Option<Self> {
        let pieces = lists.segments.len();
        let is_recent = lists.has_piece_after && lists.before != Outside::Extrapolate;
        if !is_recent || pieces > Self::ROOM {
            return None;
        }
        let mut recent = Self {
            piece_knots: [0.0; Self::ROOM + 1],
            segments: OnceLock::new(),
            count: short(pieces),
            before: lists.before,
            motions: [StraightMotion::NONE; Self::ROOM],
        };
        for (motion, segment) in recent.motions.iter_mut().zip(&*lists.segments) {
            *motion = StraightMotion::of(segment)?;
        }
        recent.piece_knots[..=pieces].copy_from_slice(&lists.knots);
        let [before, after] = lists.segments.extra() else {
            return None;
        };
        // Also where the body is absent before: another rule may be set later.
        let is_whole = *before == recent.motions[0].segment();
        (is_whole && *after == recent.last().segment()).then_some(recent)
    }

    /// Prefetches what a body has that is told a state each tick.
    pub(super) fn prefetch(&self) {
        prefetch(&self.motions[..Self::USUAL]);
        prefetch_first(&self.count);
    }

    const fn pieces(&self) -> usize {
        self.count as usize
    }

    /// Returns the knots and the end of the first piece after the last one, s.
    pub(super) fn piece_knots(&self) -> &[f64] {
        &self.piece_knots[..=self.pieces()]
    }

    /// Returns the knots, s.
    pub(super) fn knots(&self) -> &[f64] {
        &self.piece_knots[..self.pieces()]
    }

    /// Returns the motions between the [knots of its pieces](Self::piece_knots).
    pub(super) fn motions(&self) -> &[StraightMotion] {
        &self.motions[..self.pieces()]
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

    /// Returns the motion after the last knot.
    pub(super) fn last(&self) -> &StraightMotion {
        &self.motions[self.pieces() - 1]
    }

    /// Replaces the motion as [`Trajectory::replace`](super::Trajectory::replace) does. Returns false, and
    /// changes nothing, if there is no room.
    pub(super) fn replace(&mut self, from: f64, motion: &StraightMotion, since: f64) -> bool {
        let from = without_negative_zero(from);
        let Some((before, dropped, kept)) = self.pieces_kept(from, motion, since) else {
            return false;
        };
        let (last, last_knot) = (self.motions[before - 1], self.piece_knots[before - 1]);
        for place in 0..kept {
            let number = dropped + place;
            if let Some(beyond) = number.checked_sub(before) {
                self.motions[place] = last;
                self.piece_knots[place] = cut_after(last_knot, &last, beyond + 1);
            } else {
                self.motions[place] = self.motions[number];
                self.piece_knots[place] = self.piece_knots[number];
            }
        }
        self.append((dropped, kept), from, motion);
        if from < motion.start() {
            self.append((0, kept + 1), motion.start(), motion);
        }
        true
    }

    /// Returns how many pieces begin before an instant (s) from which a motion is to be followed; how many of these, and of
    /// those into which the last of them is cut up to there, are dropped and kept. `None` if the motion cannot be
    /// [replaced](Self::replace) here.
    pub(super) fn pieces_kept(
        &self,
        from: f64,
        motion: &StraightMotion,
        since: f64,
    ) -> Option<(usize, usize, usize)> {
        let before = self.knots().iter().take_while(|knot| **knot < from).count();
        let place = before.checked_sub(1)?;
        let (last, last_knot) = (&self.motions[place], self.piece_knots[place]);
        let cut = |number: usize| cut_after(last_knot, last, number);
        let beyond = if from <= self.piece_knots[before] {
            0
        } else {
            (1..).take_while(|&number| cut(number) < from).count()
        };
        // A state may lie ahead: up to there its motion is one more piece.
        let start = motion.start();
        let is_ahead = from < start;
        let knot = if is_ahead { start } else { from };
        let is_past = |knot: &f64| *knot < since;
        let mut past = self.piece_knots[..before]
            .iter()
            .take_while(|knot| is_past(knot))
            .count();
        if past == before {
            let later = (1..=beyond).map(cut).chain(once(from));
            past += later
                .chain(is_ahead.then_some(start))
                .take_while(is_past)
                .count();
        }
        // The last piece before the motion's own last one stays.
        let pieces = before + beyond;
        let dropped = past.saturating_sub(1).min(pieces - usize::from(!is_ahead));
        let kept = pieces - dropped;
        let end = cut_after(knot, motion, 1);
        let is_piece = end > knot
            && motion.check_followable((from, end), 0).is_ok()
            && (!is_ahead || is_one_piece_before(motion, from));
        (is_piece && kept + usize::from(is_ahead) < Self::ROOM).then_some((before, dropped, kept))
    }

    /// Replaces the motion, without checks: [`LastMotion::is_replaced_by`] must be true. Then there is room, and the
    /// motion so far goes on in one piece.
    #[inline]
    pub(super) fn replace_checked(
        &mut self,
        from: f64,
        motion: &StraightMotion,
        since: f64,
    ) -> LastMotion {
        let dropped = self.past(since);
        let kept = self.pieces() - dropped;
        debug_assert!(kept < Self::ROOM && from <= self.piece_knots[self.pieces()]);
        if dropped > 0 {
            for place in 0..kept {
                self.motions[place] = self.motions[dropped + place];
                self.piece_knots[place] = self.piece_knots[dropped + place];
            }
        }
        self.append((dropped, kept), without_negative_zero(from), motion);
        // `is_replaced_by` has checked that the motion can be followed for all of its first piece, and longer.
        self.facts()
    }

    /// Returns the number of pieces, not all of them, that end before an instant (s).
    #[inline]
    fn past(&self, since: f64) -> usize {
        let past = self.knots().iter().take_while(|knot| **knot < since);
        past.count().saturating_sub(1).min(self.pieces() - 1)
    }

    /// Lets the motion follow the pieces that were kept from an instant (s) on, after so many that were dropped.
    #[inline]
    fn append(&mut self, (dropped, kept): (usize, usize), from: f64, motion: &StraightMotion) {
        self.motions[kept] = *motion;
        self.piece_knots[kept] = from;
        self.piece_knots[kept + 1] = cut_after(from, motion, 1);
        self.count = short(kept + 1);
        if dropped > 0 {
            self.before = Outside::Absent;
        }
        self.segments.take();
    }

    /// Returns the facts that a further motion is checked against. There are some only where the last motion can
    /// certainly be followed for all of its first piece.
    #[inline]
    pub(super) fn last_motion(&self) -> LastMotion {
        let end = self.piece_knots[self.pieces()];
        if self.last().is_near(self.last_knot(), end) {
            self.facts()
        } else {
            LastMotion::NONE
        }
    }

    #[inline]
    fn facts(&self) -> LastMotion {
        if self.last().duration() < LastMotion::IN_ONE_PIECE {
            return LastMotion::NONE;
        }
        LastMotion {
            full_until: if self.pieces() < Self::ROOM {
                f64::NEG_INFINITY
            } else {
                self.piece_knots[1]
            },
            knot: self.last_knot(),
            start: self.last().start(),
        }
    }

    fn last_knot(&self) -> f64 {
        self.piece_knots[self.pieces() - 1]
    }

    /// Returns the motions in lists.
    pub(super) fn to_lists(&self) -> SegmentLists {
        let ends = [self.motions[0], *self.last()].map(|motion| motion.segment());
        let rules = [self.before, Outside::Coast];
        let mut lists = SegmentLists::new(self.knots(), self.segments(), &ends, rules);
        lists.add_piece_after();
        lists
    }
}

/// The facts about a body's recent motions that a further one is checked against. The monitor keeps a copy, and so
/// need not read the motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LastMotion {
    /// There is no room for a further piece until what ends by this instant (s) is forgotten.
    full_until: f64,
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
        full_until: 0.0,
        knot: f64::NAN,
        start: 0.0,
    };

    /// Returns true if a motion certainly [replaces](super::Trajectory::replace_checked) the last one at `from` (s),
    /// after what ended before `since` (s) is dropped. There is room, and the last motion goes on in one piece from
    /// its knot to `from`. The first knot of the trajectory is before another instant (both s). The new motion differs from
    /// the last one, and can be followed in all pieces up to `far` (s).
    #[inline]
    pub(crate) fn is_replaced_by(
        &self,
        motion: &StraightMotion,
        (from, since): (f64, f64),
        (first_knot, start): (f64, f64),
        far: f64,
    ) -> bool {
        // All pieces up to some cut last as long as the next one does, but for the duration of the first.
        let end = from + 2.0 * (far - from).max(0.0) + motion.duration();
        let is_resolved = motion.duration() > 2.0 * f64::EPSILON * from.abs();
        let is_other = (motion.start() - self.start).abs() > 0.0 && motion.moves();
        is_other
            && first_knot < start
            && self.full_until < since
            && self.knot < from
            && from - self.knot <= Self::IN_ONE_PIECE
            && motion.start() <= from
            && is_resolved
            && motion.is_near(from, end)
    }
}

/// Returns the cut with a number from 1 on of a motion that goes on from a knot (s).
fn cut_after(knot: f64, motion: &StraightMotion, number: usize) -> f64 {
    // There are far fewer: each is twice as far from the knot.
    DoublingCuts::cut(knot, motion.duration(), short(number))
}

/// Returns true if a motion goes back from its state to an instant (s) in one piece.
fn is_one_piece_before(motion: &StraightMotion, time: f64) -> bool {
    DoublingCuts::cut(motion.start(), -motion.duration(), 1) <= time
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn what_is_told_each_tick_takes_four_cache_lines() {
        let motions = offset_of!(RecentMotions, motions) + RecentMotions::USUAL * 64;
        let first = offset_of!(RecentMotions, count);
        let last = offset_of!(RecentMotions, piece_knots) + (RecentMotions::USUAL + 1) * 8;
        assert!(size_of::<StraightMotion>() == 64 && motions <= 192);
        assert!(first % 64 == 0 && last <= first + 64, "{first} {last}");
        assert_eq!(size_of::<RecentMotions>(), 512);
    }
}
