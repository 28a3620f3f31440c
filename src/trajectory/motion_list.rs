//! Straight motions, one after another, of a body that is told a new one again and again.
//!
//! In this file `from` is the instant (s) from which a new motion is followed. Pieces that end before `since` (s) are
//! dropped: the caller does not ask about the time before.

use super::cuts::DoublingCuts;
use super::straight::StraightMotion;
use crate::count::short;
use crate::rounding::without_negative_zero;
use std::iter::once;

/// Straight motions, one after another. Each listed motion is one piece. The last motion goes on for ever: only its first
/// piece after the last knot is listed.
pub(super) trait MotionList {
    /// Returns the motions between the [knots](Self::piece_knots).
    fn motions(&self) -> &[StraightMotion];

    /// Returns the knots and the end of the first piece after the last one, s.
    fn piece_knots(&self) -> &[f64];

    /// Keeps so many pieces after those that are dropped.
    fn keep(&mut self, dropped: usize, kept: usize);

    /// Adds a piece that begins at an instant (s). There must be room for it.
    fn push(&mut self, knot: f64, motion: &StraightMotion);

    /// Ends the last piece, once all are there.
    fn finish(&mut self);

    /// Replaces the motion as [`Trajectory::replace`](super::Trajectory::replace) does, given the pieces that are there then.
    fn replace(&mut self, from: f64, motion: &StraightMotion, pieces: ReplacedPieces) {
        let ReplacedPieces {
            before,
            beyond,
            ahead,
            dropped,
        } = pieces;
        let from = without_negative_zero(from);
        let (last, last_knot) = (self.motions()[before - 1], self.piece_knots()[before - 1]);
        let first = dropped.min(before);
        self.keep(first, before - first);
        let rest = dropped - first;
        for number in rest..beyond {
            self.push(cut_after(last_knot, &last, number + 1), &last);
        }
        let from_state = once(motion.start()).filter(|_| ahead > 0);
        let cuts = (1..ahead).rev().map(|number| cut_before(motion, number));
        let knots = once(from).chain(cuts).chain(from_state);
        for knot in knots.skip(rest.saturating_sub(beyond)) {
            self.push(knot, motion);
        }
        self.finish();
    }
}

/// The pieces of straight motions when another motion replaces the last one.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReplacedPieces {
    /// Pieces that begin before the instant from which the motion is followed: the last of them is cut there.
    before: usize,
    /// Pieces into which the last of these is cut up to there, beyond the first.
    beyond: usize,
    /// Pieces of the new motion before the time of its state, if that is ahead.
    ahead: usize,
    /// Pieces of all these, in this order, that end before the time that is asked about.
    dropped: usize,
}

impl ReplacedPieces {
    /// Returns the pieces of a list in which another motion replaces the last one; `None` if it cannot.
    pub(super) fn of(
        list: &impl MotionList,
        from: f64,
        motion: &StraightMotion,
        since: f64,
    ) -> Option<Self> {
        let (motions, piece_knots) = (list.motions(), list.piece_knots());
        let knots = &piece_knots[..motions.len()];
        let before = count_at_end(knots, |knot| knot < from);
        let place = before.checked_sub(1)?;
        let (last, last_knot) = (&motions[place], knots[place]);
        let is_known =
            before < knots.len() || last.check_followable((last_knot, from), place).is_ok();
        let cut = |number: usize| cut_after(last_knot, last, number);
        let beyond = if from <= piece_knots[before] || !is_known {
            0
        } else {
            (1..).take_while(|&number| cut(number) < from).count()
        };
        // A state may lie ahead: up to there its motion has pieces of its own.
        let start = motion.start();
        let (knot, is_ahead) = (if from < start { start } else { from }, from < start);
        let end = cut_after(knot, motion, 1);
        if !is_known || end <= knot || motion.check_followable((from, end), 0).is_err() {
            return None;
        }
        let ahead = if is_ahead {
            let cuts = (1..).take_while(|&number| from < cut_before(motion, number));
            1 + cuts.count()
        } else {
            0
        };
        let is_past = |knot: &f64| *knot < since;
        let mut past = knots[..before]
            .iter()
            .take_while(|knot| is_past(knot))
            .count();
        if past == before {
            let cuts_ahead = (1..ahead).rev().map(|number| cut_before(motion, number));
            let later = (1..=beyond).map(cut).chain(once(from));
            let later = later.chain(cuts_ahead).chain(is_ahead.then_some(start));
            past += later.take_while(is_past).count();
        }
        // The last piece before the motion's own last one stays.
        let dropped = past.saturating_sub(1).min(before + beyond + ahead - 1);
        Some(Self {
            before,
            beyond,
            ahead,
            dropped,
        })
    }

    /// Returns the number of pieces with those of the new motion.
    pub(super) const fn count(&self) -> usize {
        self.before + self.beyond + self.ahead + 1 - self.dropped
    }
}

/// Returns the number of leading knots for which `is_before` holds. Searches from the end: mostly few come after.
pub(crate) fn count_at_end(knots: &[f64], is_before: impl Fn(f64) -> bool) -> usize {
    let mut after = 1;
    while after < knots.len() && !is_before(knots[knots.len() - after]) {
        after *= 2;
    }
    let first = knots.len().saturating_sub(after);
    first + knots[first..].partition_point(|&knot| is_before(knot))
}

/// Returns the cut with a number from 1 on of a motion that goes on from a knot (s).
#[inline]
pub(super) fn cut_after(knot: f64, motion: &StraightMotion, number: usize) -> f64 {
    // There are far fewer: each is twice as far from the knot.
    DoublingCuts::cut(knot, motion.duration(), short(number))
}

/// Returns the cut with a number from 1 on of a motion that goes back from its state, s.
fn cut_before(motion: &StraightMotion, number: usize) -> f64 {
    DoublingCuts::cut(motion.start(), -motion.duration(), short(number))
}

#[cfg(test)]
mod tests {
    use super::count_at_end;

    #[test]
    fn knots_are_counted_from_the_end() {
        for count in 0..40_u32 {
            let knots: Vec<f64> = (0..count).map(f64::from).collect();
            for limit in 0..=count {
                let found = count_at_end(&knots, |knot| knot < f64::from(limit));
                assert_eq!(found, limit as usize, "{count}");
            }
        }
    }
}
