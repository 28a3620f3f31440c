//! The general form of a trajectory: cubics between knots, in lists.

use super::cuts::DoublingCuts;
use super::front_gap::FrontGapVec;
use super::outside::Outside;
use super::segment::Segment;
use super::straight::StraightMotion;
use crate::rounding::without_negative_zero;
use std::iter::once;

/// Cubics between knots, as a list of each.
#[derive(Clone, Debug)]
pub(super) struct SegmentLists {
    /// Knots, s: one more than segments.
    pub(super) knots: FrontGapVec<f64>,
    /// Segments between the knots; as extra values, the end motions before and after. The one before is the first cubic
    /// of a plan that has lost its beginning.
    pub(super) segments: FrontGapVec<Segment, 2>,
    pub(super) before: Outside,
    pub(super) after: Outside,
    /// The first piece after the last knot is the last one of the lists: it is read as fast as the plan's own.
    pub(super) has_piece_after: bool,
}

impl SegmentLists {
    /// Returns the lists of these cubics between knots, with the end motions and the rules before and after.
    pub(super) fn new(
        knots: &[f64],
        segments: &[Segment],
        ends: &[Segment; 2],
        [before, after]: [Outside; 2],
    ) -> Self {
        Self {
            knots: FrontGapVec::new(knots, &[]),
            segments: FrontGapVec::new(segments, ends),
            before,
            after,
            has_piece_after: false,
        }
    }

    /// Returns the knots, without the end of the piece after the last one.
    pub(super) fn knots(&self) -> &[f64] {
        &self.knots[..self.knots.len() - usize::from(self.has_piece_after)]
    }

    /// Returns the cubics between the knots.
    pub(super) fn segments(&self) -> &[Segment] {
        &self.segments[..self.segments.len() - usize::from(self.has_piece_after)]
    }

    /// Takes the first piece after the last knot, from where the plan coasts, into the lists.
    pub(super) fn add_piece_after(&mut self) {
        debug_assert!(self.after == Outside::Coast && !self.has_piece_after);
        let end_motion = self.segments.extra()[1].straight();
        let last = self.knots[self.knots.len() - 1];
        let cut = DoublingCuts::cut(last, end_motion.end() - end_motion.start(), 1);
        if cut > last && end_motion.check_followable((last, cut), 0).is_ok() {
            self.knots.push(cut);
            self.segments.push(end_motion);
            self.has_piece_after = true;
        }
    }

    /// Takes the piece after the last knot out of the lists.
    pub(super) fn drop_piece_after(&mut self) {
        if std::mem::take(&mut self.has_piece_after) {
            self.knots.pop();
            self.segments.pop();
        }
    }

    /// Replaces the motion as [`Trajectory::replace`](super::Trajectory::replace) does, from an instant after the first knot
    /// on.
    pub(super) fn replace(&mut self, from: f64, motion: &StraightMotion, since: f64) {
        self.drop_piece_after();
        let from = without_negative_zero(from);
        let before = self.knots.partition_point(|&knot| knot < from);
        if before < self.knots.len() {
            self.knots.truncate(before);
            self.segments.truncate(before);
        } else {
            let end_motion = self.segments.extra()[1].straight();
            let step = end_motion.end() - end_motion.start();
            let last = self.knots[self.knots.len() - 1];
            self.segments.push(end_motion);
            for knot in DoublingCuts::of(last, step, from).but_last() {
                self.knots.push(knot);
                self.segments.push(end_motion);
            }
        }
        self.knots.push(from);
        let (start, line) = (motion.start(), motion.segment());
        if from < start {
            let ahead = DoublingCuts::of(start, -motion.duration(), from).but_last();
            let first = self.knots.len();
            for knot in once(start).chain(ahead) {
                self.knots.push(knot);
                self.segments.push(line);
            }
            // They come from the state's time backwards.
            self.knots.all_mut()[first..].reverse();
        }
        self.segments.put_extra(1, line);
        self.after = Outside::Coast;
        self.forget_before(since);
        self.add_piece_after();
    }

    /// Returns true if they hold straight motions, one after another, with the first piece of the last one.
    pub(super) fn are_straight(&self) -> bool {
        let motions = || self.segments.iter().map(StraightMotion::of);
        let is = |motion: Option<Option<StraightMotion>>, end: Option<&Segment>| {
            motion.flatten().map(|motion| motion.segment()).as_ref() == end
        };
        let [before, after] = [0, 1].map(|end| self.segments.extra().get(end));
        // The end motion before counts also where the body is absent before: another rule may be set later.
        self.has_piece_after
            && self.before != Outside::Extrapolate
            && motions().all(|motion| motion.is_some())
            && is(motions().next(), before)
            && is(motions().next_back(), after)
    }

    /// Drops the cubics that end before `time` (s), but for the last one.
    pub(super) fn forget_before(&mut self, time: f64) {
        let dropped = count_at_front(self.knots(), |knot| knot < time)
            .saturating_sub(1)
            .min(self.segments().len().saturating_sub(1));
        if dropped > 0 {
            self.knots.drop_front(dropped);
            self.segments.drop_front(dropped);
            self.begin_anew();
        }
    }

    /// Notes that nothing is known of the motion before the first cubic.
    pub(super) fn begin_anew(&mut self) {
        self.before = Outside::Absent;
        let first = self.segments[0];
        self.segments.put_extra(0, first);
    }
}

/// Returns the number of leading knots for which `is_before` holds. Searches from the front, since
/// they are usually few.
pub(super) fn count_at_front(knots: &[f64], is_before: impl Fn(f64) -> bool) -> usize {
    let mut bound = 1;
    while bound < knots.len() && is_before(knots[bound]) {
        bound *= 2;
    }
    let rest = &knots[bound / 2..knots.len().min(bound + 1)];
    bound / 2 + rest.partition_point(|&knot| is_before(knot))
}
