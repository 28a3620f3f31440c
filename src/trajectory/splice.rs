//! Changes of a plan from an instant on: the part before that instant stays, bit for bit.

use super::cuts::DoublingCuts;
use super::segment_lists::{SegmentLists, count_at_front};
use super::{Outside, Storage, Trajectory};
use crate::error::{Error, check_change_time};
use crate::rounding::without_negative_zero;
use crate::simd::{prefetch, prefetch_first};
use std::iter::{once, repeat_n};
use std::slice::from_ref;

impl Trajectory {
    /// Returns this plan up to `from` (s), then `plan`.
    ///
    /// Cubics before `from` are unchanged; the one that contains `from` is followed up to there.
    /// There is no gap at `from`: the body is never absent. Positions may jump there. The rule
    /// before the first knot is this plan's, the rule after the last one is the new plan's.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{State, Trajectory};
    ///
    /// let line = |start: f64, from: DVec3, velocity: DVec3| {
    ///     let states = [0.0, 10.0].map(|t| State::new(start + t, from + t * velocity, velocity));
    ///     Trajectory::from_states(&states)
    /// };
    /// let ahead = line(0.0, DVec3::ZERO, DVec3::X)?;
    /// let aside = line(5.0, 5.0 * DVec3::X, DVec3::Y)?;
    /// let detour = ahead.spliced(5.0, &aside)?;
    /// assert_eq!(detour.knots(), [0.0, 5.0, 15.0]);
    /// assert_eq!(detour.position(3.0), ahead.position(3.0));
    /// assert_eq!(detour.position(8.0), aside.position(8.0));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// - [`Error::ChangeTime`] if `from` is not within ±1e300.
    /// - [`Error::NoOldPlan`] unless this plan exists at `from`; [`Error::NoNewPlan`] unless the new one does, and goes
    ///   on from there.
    /// - [`Error::OutOfRange`] if a plan leaves the range of numbers between its knots and `from`.
    /// - [`Error::TooFar`] if `from` is too far from a plan's knots.
    pub fn spliced(&self, from: f64, plan: &Self) -> Result<Self, Error> {
        check_change_time(from)?;
        let mut spliced = plan.clone();
        spliced.precede_by(self, from, f64::NEG_INFINITY)?;
        Ok(spliced)
    }

    /// Returns true if the body exists at a time (s) and continues from there.
    pub(crate) fn goes_on_from(&self, time: f64) -> bool {
        let is_over = self.outside_after() == Outside::Absent
            && self.knots().last().is_none_or(|last| *last <= time);
        time.is_finite() && self.domain().contains(time) && !is_over
    }

    /// Checks that this plan can be followed from a time (s) on.
    ///
    /// # Errors
    ///
    /// [`Error::NoNewPlan`].
    pub(crate) fn check_goes_on_from(&self, time: f64) -> Result<(), Error> {
        if self.goes_on_from(time) {
            return Ok(());
        }
        let (start, end) = self.domain().ends();
        Err(Error::NoNewPlan { time, start, end })
    }

    /// Returns this motion without the cubics that end before `time` (s). At least one is kept. If
    /// any are dropped, the body does not exist before the first one kept, whatever the rule before
    /// was. With another [rule](Self::with_outside) it goes on from there.
    ///
    /// ```
    /// use nearmiss::{State, Trajectory};
    ///
    /// let states = [0.0, 1.0, 2.0, 3.0].map(|t| State::new(t, [t, 0.0, 0.0], [1.0, 0.0, 0.0]));
    /// let rest = Trajectory::from_states(&states)?.trimmed_before(1.5);
    /// assert_eq!(rest.knots(), [1.0, 2.0, 3.0]);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    #[must_use]
    pub fn trimmed_before(mut self, time: f64) -> Self {
        if self.knots().len() > 1 {
            self.as_lists().forget_before(time);
        }
        self
    }

    /// Prepends `old`, the plan so far, up to `from` (s) to this plan, in place. Pieces that end before `since` (s)
    /// are not copied, as [`trimmed_before`](Self::trimmed_before) drops them.
    ///
    /// # Errors
    ///
    /// As [`spliced`](Self::spliced). On error nothing is changed.
    pub(crate) fn precede_by(&mut self, old: &Self, from: f64, since: f64) -> Result<(), Error> {
        let from = without_negative_zero(from);
        if !old.domain().contains(from) {
            let (time, (start, end)) = (from, old.domain().ends());
            return Err(Error::NoOldPlan { time, start, end });
        }
        if self.follow_straight(old, from, since) {
            return Ok(());
        }
        self.check_goes_on_from(from)?;
        let knots_before = count_at_front(self.knots(), |knot| knot <= from);
        // Of the old plan: whole pieces, then the piece that is cut at `from`. Beyond its knots a plan goes on along
        // its end motion, which becomes a piece like any other.
        let old_knots = old.knots();
        let own = old_knots.len().saturating_sub(1);
        let old_count = count_at_front(old_knots, |knot| knot < from);
        // The end motion keeps its doubling cuts, so that what is solved there keeps its bits. Without cuts, a cubic
        // that is followed far from its knots would be examined as a whole.
        let beyond = (old_count > own).then(|| old.segment_after());
        let mut cuts_after = DoublingCuts::NONE;
        if let (Some(end_motion), Some(&last)) = (&beyond, old_knots.last()) {
            end_motion.check_followable((last, from), old_knots.len() - 1)?;
            cuts_after = DoublingCuts::of(last, end_motion.end() - end_motion.start(), from);
        }
        let mut cuts_before = DoublingCuts::NONE;
        if let (0, Some(&first)) = (knots_before, self.knots().first()) {
            let end_motion = self.segment_before();
            end_motion.check_followable((from, first), 0)?;
            cuts_before = DoublingCuts::of(first, self.doubling_before().1, from);
        }
        let (cuts_after, cuts_before) = (cuts_after.but_last(), cuts_before.but_last());
        // The instants at which its pieces begin; not copied only to be dropped.
        let begins = old_knots[..old_count].iter().copied().chain(cuts_after);
        let is_past = |time: f64| time < since.min(from);
        let mut past = count_at_front(&old_knots[..old_count], is_past);
        if past == old_count {
            past = begins.clone().take_while(|&time| is_past(time)).count();
        }
        let dropped = past.saturating_sub(1);
        let begins = begins.skip(dropped);
        let kept = begins.clone().count();
        let old_segments = dropped.min(own)..old_count.min(own);
        // Of this plan: the piece that contains `from`, and all later ones.
        let goes_on = knots_before < self.knots().len();
        let present = match knots_before {
            0 => self.segment_before(),
            _ if goes_on => self.segments()[knots_before - 1],
            _ => self.segment_after(),
        };
        let beyond_count = kept - old_segments.len();
        let beyond = beyond
            .into_iter()
            .flat_map(|beyond| repeat_n(beyond, beyond_count));
        let count_of_cuts_before = cuts_before.clone().count();
        let to_come = if goes_on { 1 + count_of_cuts_before } else { 0 };
        // The motion before a splice ahead of the old knots is not that from the new first knot.
        let before = if old_knots.first().is_some_and(|&first| from < first) {
            old.segment_before()
        } else {
            old.end_motion(0)
        };
        let is_line = self.straight().is_some();
        let lists = self.as_lists();
        lists.drop_piece_after();
        lists.segments.put_extra(0, before);
        lists.before = old.outside_before();
        lists.segments.replace_front(
            knots_before.min(lists.segments.len()),
            kept + to_come,
            old_segments
                .map(|number| old.own_segment(number))
                .chain(beyond)
                .chain(repeat_n(present, to_come)),
        );
        if dropped > 0 {
            lists.begin_anew();
        }
        let count = kept + 1 + count_of_cuts_before;
        let knots = begins.chain(once(from)).chain(cuts_before);
        lists.knots.replace_front(knots_before, count, knots);
        // They come from the knot outwards.
        lists.knots.front_mut(count)[kept + 1..].reverse();
        lists.forget_before(since);
        if is_line {
            lists.add_piece_after();
            self.leave_lists();
        }
        Ok(())
    }

    /// Returns the lists that the trajectory is stored in, and stores it in lists if it is not yet.
    pub(super) fn as_lists(&mut self) -> &mut SegmentLists {
        let other = match &self.storage {
            Storage::Straight(motion, _) => {
                let (knot, ends) = (from_ref(motion.start_ref()), [motion.segment(); 2]);
                Some(SegmentLists::new(knot, &[], &ends, [Outside::Coast; 2]))
            }
            Storage::Recent(_) | Storage::Many(_) => {
                let ends = self.end_motions();
                let rules = [self.outside_before(), Outside::Coast];
                let mut lists = SegmentLists::new(self.knots(), self.segments(), &ends, rules);
                lists.add_piece_after();
                Some(lists)
            }
            Storage::Lists(_) => None,
        };
        if let Some(other) = other {
            self.storage = Storage::Lists(other);
        }
        match &mut self.storage {
            Storage::Lists(lists) => lists,
            Storage::Straight(..) | Storage::Recent(_) | Storage::Many(_) => {
                unreachable!("it was made lists")
            }
        }
    }

    /// Prefetches the data that a splice near the front reads, but for the first cache line of the trajectory.
    #[inline]
    pub(crate) fn prefetch(&self) {
        match &self.storage {
            Storage::Straight(_, ends) => prefetch_first(ends),
            Storage::Recent(recent) => recent.prefetch(),
            Storage::Many(_) | Storage::Lists(_) => self.prefetch_lists(),
        }
    }

    #[inline(never)]
    fn prefetch_lists(&self) {
        /// One or two cache lines.
        const KNOTS: usize = 8;
        match &self.storage {
            Storage::Many(many) => many.prefetch(),
            Storage::Lists(lists) => {
                prefetch(&lists.knots[..lists.knots.len().min(KNOTS)]);
                prefetch(lists.segments.extra());
                prefetch(&lists.segments[..lists.segments.len().min(2)]);
            }
            Storage::Straight(..) | Storage::Recent(_) => {}
        }
    }

    /// Prefetches the data that dropping the trajectory reads.
    pub(crate) fn prefetch_ends(&self) {
        if let Storage::Lists(lists) = &self.storage {
            lists.knots.prefetch_ends();
            lists.segments.prefetch_ends();
        }
    }
}

#[cfg(test)]
mod tests;
