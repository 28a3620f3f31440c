//! Straight motions that a body is told: each replaces its motion from an instant on, in the memory of its trajectory.

use super::cuts::DoublingCuts;
use super::many_motions::ManyMotions;
use super::motion_list::{MotionList, ReplacedPieces};
use super::recent_motions::{LastMotion, RecentMotions};
use super::{Outside, Segment, Storage, StraightMotion, Trajectory};
use crate::window::Window;
use std::iter::once;

impl Storage {
    /// Returns straight motions between the knots of their pieces (s), with room for so many.
    fn of_motions(
        (motions, knots): (impl Iterator<Item = StraightMotion>, &[f64]),
        before: Outside,
        count: usize,
    ) -> Self {
        if count <= RecentMotions::ROOM {
            Self::Recent(Box::new(RecentMotions::of(motions, knots, before)))
        } else {
            Self::Many(ManyMotions::of(motions, knots, before))
        }
    }
}

impl Trajectory {
    /// Prepends `old` as [`precede_by`](Self::precede_by) does, if both are straight motions. Returns false, and changes
    /// nothing, if that cannot be done so.
    pub(super) fn follow_straight(&mut self, old: &Self, from: f64, since: f64) -> bool {
        let Storage::Straight(motion, _) = self.storage else {
            return false;
        };
        let mut both = match &old.storage {
            Storage::Straight(old, _) if old.start() < from => {
                let knots = [
                    old.start(),
                    DoublingCuts::cut(old.start(), old.duration(), 1),
                ];
                Self {
                    storage: Storage::of_motions((once(*old), &knots), Outside::Coast, 1),
                }
            }
            Storage::Recent(_) | Storage::Many(_) => old.clone(),
            Storage::Straight(..) | Storage::Lists(_) => return false,
        };
        let is_done = both.replace_listed(from, &motion, since);
        if is_done {
            *self = both;
        }
        is_done
    }

    /// Returns a cubic between the knots.
    pub(super) fn own_segment(&self, number: usize) -> Segment {
        match self.straight_motions() {
            [] => self.segments()[number],
            // A list of all would be made first.
            motions => motions[number].segment(),
        }
    }

    /// Returns true if [`replace`](Self::replace) can be done, and the motion followed over `window` then.
    pub(crate) fn can_replace(
        &self,
        (from, since): (f64, f64),
        motion: &StraightMotion,
        window: Window,
    ) -> bool {
        let knots = self.knots();
        let (Some(&first), Some(&last), None) = (knots.first(), knots.last(), self.straight())
        else {
            return false;
        };
        let begins = self.outside_before() == Outside::Absent || first < window.start();
        let is_there = last >= from || self.outside_after() == Outside::Coast;
        if !begins || !is_there || first >= from {
            return false;
        }
        let (number, start) = (knots.len(), motion.start());
        let is_known = match &self.storage {
            Storage::Recent(_) | Storage::Many(_) => {
                self.replaced_pieces(from, motion, since).is_some()
            }
            Storage::Straight(..) | Storage::Lists(_) => {
                let goes_on = last >= from
                    || self
                        .segment_after()
                        .check_followable((last, from), number - 1)
                        .is_ok();
                goes_on && (start <= from || motion.check_followable((from, start), number).is_ok())
            }
        };
        let mut reached = from.max(start);
        is_known
            && DoublingCuts::of(reached, motion.duration(), window.end().next_up()).all(|cut| {
                let piece = (std::mem::replace(&mut reached, cut), cut);
                motion.check_followable(piece, number).is_ok()
            })
    }

    /// Lets the body follow its motion so far up to `from` (s), then a straight one. Pieces that end before `since`
    /// (s) are dropped. The result is that of [`precede_by`](Self::precede_by), in this trajectory's memory.
    /// [`can_replace`](Self::can_replace) must be true.
    pub(crate) fn replace(&mut self, from: f64, motion: &StraightMotion, since: f64) {
        if !self.replace_listed(from, motion, since) {
            self.as_lists().replace(from, motion, since);
            self.leave_lists();
        }
    }

    /// Replaces one of several straight motions as [`replace`](Self::replace) does. Returns false, and changes nothing, if
    /// there are none, or it cannot be replaced so.
    fn replace_listed(&mut self, from: f64, motion: &StraightMotion, since: f64) -> bool {
        let Some(pieces) = self.replaced_pieces(from, motion, since) else {
            return false;
        };
        self.make_room(pieces.count());
        match &mut self.storage {
            Storage::Recent(recent) => recent.replace(from, motion, pieces),
            Storage::Many(many) => many.replace(from, motion, pieces),
            Storage::Straight(..) | Storage::Lists(_) => return false,
        }
        true
    }

    /// Returns the pieces of several straight motions when another motion replaces the last one; `None` if it cannot.
    fn replaced_pieces(
        &self,
        from: f64,
        motion: &StraightMotion,
        since: f64,
    ) -> Option<ReplacedPieces> {
        match &self.storage {
            Storage::Recent(recent) => ReplacedPieces::of(&**recent, from, motion, since),
            Storage::Many(many) => ReplacedPieces::of(many, from, motion, since),
            Storage::Straight(..) | Storage::Lists(_) => None,
        }
    }

    /// Stores several straight motions where so many have room. Those that were many stay where they are until there are
    /// few both before and after: an engine that takes many steps has few once a tick.
    fn make_room(&mut self, count: usize) {
        let motions = self.straight_motions();
        let is_moved = match &self.storage {
            Storage::Recent(_) => count > RecentMotions::ROOM,
            Storage::Many(_) => count.max(motions.len()) <= RecentMotions::USUAL,
            Storage::Straight(..) | Storage::Lists(_) => false,
        };
        if is_moved {
            let (knots, before) = (self.piece_knots(), self.outside_before());
            self.storage = Storage::of_motions((motions.iter().copied(), knots), before, count);
        }
    }

    /// Stores lists as straight motions if they hold nothing else.
    pub(super) fn leave_lists(&mut self) {
        if let Storage::Lists(lists) = &self.storage
            && lists.are_straight()
        {
            let motions = lists.segments.iter().filter_map(StraightMotion::of);
            let (count, knots) = (lists.segments.len(), &*lists.knots);
            if count == 1
                && lists.before == Outside::Coast
                && let Some(motion) = motions.clone().next()
                && motion.start().total_cmp(&knots[0]).is_eq()
            {
                // Before its knot it is cut as a single motion is: one that was saved is read as such.
                *self = Self::of_straight(motion);
                return;
            }
            self.storage = Storage::of_motions((motions, knots), lists.before, count);
        }
    }

    /// Returns the facts that a further motion is checked against; none of a plan, or of a single motion.
    #[inline]
    pub(crate) fn last_motion(&self) -> LastMotion {
        match &self.storage {
            Storage::Recent(recent) => LastMotion::of(&**recent),
            Storage::Many(many) => LastMotion::of(many),
            Storage::Straight(..) | Storage::Lists(_) => LastMotion::NONE,
        }
    }

    /// Replaces the motion as [`replace`](Self::replace) does, without checks: [`LastMotion::is_replaced_by`] must be
    /// true. It mostly is where a state is told each frame. Returns the facts that a further motion is checked against.
    #[inline]
    pub(crate) fn replace_checked(
        &mut self,
        from: f64,
        motion: &StraightMotion,
        since: f64,
    ) -> LastMotion {
        if let Storage::Recent(recent) = &mut self.storage
            && let Some(last) = recent.replace_checked(from, motion, since)
        {
            return last;
        }
        self.replace_among_many(from, motion, since)
    }

    #[inline(never)]
    fn replace_among_many(&mut self, from: f64, motion: &StraightMotion, since: f64) -> LastMotion {
        self.replace(from, motion, since);
        self.last_motion()
    }

    /// Returns true if it goes on from `from` (s) just as a straight motion does.
    pub(crate) fn follows(&self, motion: &StraightMotion, from: f64) -> bool {
        let is_past = self.knots().last().is_some_and(|&last| last <= from);
        is_past
            && match self.straight_motions().last() {
                Some(own) => own.is_same_as(motion),
                None => {
                    self.outside_after() == Outside::Coast
                        && StraightMotion::of(&self.segment_after())
                            .is_some_and(|own| own.is_same_as(motion))
                }
            }
    }
}
