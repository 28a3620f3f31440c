//! Motion beyond the knots: the cubic followed there, and its division into pieces.
//!
//! Pieces have doubling length, from the knot outwards: T, 2 T, 4 T, ..., with T the duration of
//! the neighbouring segment, rounded to three times a power of two. For a body at rest T is longer
//! than any time; for one that only coasts it is fixed. The cuts depend on the trajectory alone,
//! never on a window. So an encounter there has the same bits whatever the window, and any window
//! needs only a few dozen pieces. Pieces and cuts are computed from their numbers, not stored.

#[cfg(test)]
use super::StraightMotion;
use super::cuts::DoublingCuts;
use super::{Outside, Segment, Trajectory};
use crate::error::Error;
use crate::window::Window;

/// The number of pieces beyond the knots that cover a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extension {
    /// Pieces before the first knot.
    pub(crate) before: u32,
    /// Pieces after the last knot.
    pub(crate) after: u32,
    /// First and last instant of all pieces, the trajectory's own included, s.
    pub(crate) domain: (f64, f64),
}

impl Trajectory {
    /// Returns the time from the first to the last of the [knots of its pieces](Self::piece_knots); all of time without one.
    pub(crate) fn listed_domain(&self) -> Window {
        let knots = self.piece_knots();
        match (knots.first(), knots.last()) {
            (Some(&first), Some(&last)) => Window::new(first, last).unwrap_or(Window::ALL),
            _ => Window::ALL,
        }
    }

    /// Returns the cubic that the body follows before its first knot.
    pub(crate) fn segment_before(&self) -> Segment {
        let (end, first) = (self.end_motion(0), self.knots()[0]);
        let begins_there = end.is_power_form() && end.start().total_cmp(&first).is_eq();
        match self.outside_before() {
            Outside::Extrapolate if begins_there => end.extended(),
            Outside::Extrapolate => end,
            _ if begins_there || end.is_straight() => end.straight(),
            // The plan has lost its beginning, or was spliced where it was extrapolated.
            _ => end.line_at(first),
        }
    }

    /// Returns the cubic that the body follows after its last knot.
    pub(crate) fn segment_after(&self) -> Segment {
        let end = self.end_motion(1);
        match self.outside_after() {
            Outside::Extrapolate => end.extended(),
            _ => end.straight(),
        }
    }

    /// Returns the cut with a number from 1 on, counted from the first knot, s.
    pub(crate) fn cut_before(&self, number: u32) -> f64 {
        let (knot, step, first) = self.doubling_before();
        DoublingCuts::cut(knot, step, first + number)
    }

    /// Returns the cut with a number from 1 on, counted from the last knot, s.
    pub(crate) fn cut_after(&self, number: u32) -> f64 {
        let (knot, step, first) = self.doubling_after();
        DoublingCuts::cut(knot, step, first + number)
    }

    /// Returns the pieces that cover the part of the domain within `window`, or `None` if no piece
    /// beyond the knots is needed. The window is closed if the body exists beyond its knots.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] where an extrapolated cubic leaves the range of numbers served;
    /// [`Error::TooFar`].
    pub(crate) fn extension(&self, window: Window) -> Result<Option<Extension>, Error> {
        let own = self.listed_domain();
        let is_own = own.start() < window.start() && window.end() < own.end();
        if is_own || !self.goes_beyond() {
            return Ok(None);
        }
        let mut extension = Extension {
            before: 0,
            after: 0,
            domain: (own.start(), own.end()),
        };
        let before = self.cuts_before(window.start());
        for (cut, number) in before.zip(1..) {
            (extension.before, extension.domain.0) = (number, cut);
        }
        if extension.before > 0 {
            // The farthest piece is the first to leave the range of numbers.
            let end = self.cut_before(extension.before - 1);
            let segment = self.segment_before();
            segment.check_followable((extension.domain.0, end), 0)?;
        }
        self.lengthen(&mut extension, window.end())?;
        let is_own = extension.before == 0 && extension.after == 0;
        Ok((!is_own).then_some(extension))
    }

    /// Extends an [extension](Self::extension) to one that covers a window with a later `end` (s).
    ///
    /// # Errors
    ///
    /// As [`extension`](Self::extension). On error nothing is changed.
    pub(crate) fn lengthen(&self, extension: &mut Extension, end: f64) -> Result<(), Error> {
        let known = extension.after;
        let (mut after, mut from) = (known, extension.domain.1);
        let (mut segment, knot) = (None, self.knots().len().saturating_sub(1));
        for cut in self.cuts_after(end).skip(known as usize) {
            if let Some(motion) = self.straight_motions().last() {
                motion.check_followable((from, cut), knot)?;
            } else {
                let segment = segment.get_or_insert_with(|| self.segment_after());
                segment.check_followable((from, cut), knot)?;
            }
            (after, from) = (after + 1, cut);
        }
        (extension.after, extension.domain.1) = (after, from);
        Ok(())
    }

    /// Returns the number of pieces after the listed ones up to an instant (s) at or beyond which the listed ones end, and the
    /// end of the last of them (s). They are not checked as those of an [extension](Self::extension) are.
    #[inline]
    pub(crate) fn pieces_after(&self, end: f64) -> (u32, f64) {
        let cuts = self.cuts_after(end).zip(1..);
        cuts.fold((0, self.listed_domain().end()), |_, (cut, number)| {
            (number, cut)
        })
    }

    /// Returns the cuts before the first knot up to the first one at or beyond a window's start
    /// (s); none if the window starts later.
    ///
    /// Windows are closed: where one begins or ends at a knot or cut, the piece on the other side
    /// counts as well. After a splice that piece may be at another position, and an instant may
    /// round to the knot.
    fn cuts_before(&self, start: f64) -> DoublingCuts {
        if self.outside_before() == Outside::Absent || start > self.listed_domain().start() {
            return DoublingCuts::NONE;
        }
        let until = start.next_down().max(f64::MIN);
        let (knot, step, first) = self.doubling_before();
        DoublingCuts::after(first, knot, step, until)
    }

    /// Returns the cuts after the last knot up to the first one at or beyond a window's end (s);
    /// none if the window ends earlier.
    fn cuts_after(&self, end: f64) -> DoublingCuts {
        let last = self.listed_domain().end();
        if self.outside_after() == Outside::Absent || end < last {
            return DoublingCuts::NONE;
        }
        let until = end.max(last).next_up().min(f64::MAX);
        let (knot, step, first) = self.doubling_after();
        DoublingCuts::after(first, knot, step, until)
    }

    /// Returns the knot that the cuts before the motion's own cubics are counted from (s), the duration of the first
    /// piece from there (negative, s), and the number of the cut at which its own cubics begin.
    pub(super) fn doubling_before(&self) -> (f64, f64, u32) {
        let end = self.end_motion(0);
        let step = end.start() - end.end();
        match self.straight() {
            Some((motion, _)) => (motion.start(), step, 1),
            None => (self.listed_domain().start(), step, 0),
        }
    }

    /// Returns the knot that the cuts after the motion's own cubics are counted from (s), the duration of the first
    /// piece from there (s), and the number of the cut at which its own cubics end.
    fn doubling_after(&self) -> (f64, f64, u32) {
        let step = match self.straight_motions().last() {
            Some(motion) => motion.duration(),
            None => {
                let end = self.end_motion(1);
                end.end() - end.start()
            }
        };
        match (self.piece_knots(), self.knots()) {
            (knots, [.., last]) if knots.len() > self.knots().len() => (*last, step, 1),
            _ => (self.listed_domain().end(), step, 0),
        }
    }
}

/// All pieces of a motion, as lists.
#[cfg(test)]
#[derive(Clone, Debug)]
pub(crate) struct Pieces {
    pub(crate) knots: Vec<f64>,
    pub(crate) segments: Vec<Segment>,
}

#[cfg(test)]
impl Pieces {
    pub(crate) fn over(plan: &Trajectory, window: Window) -> Self {
        let mut knots: Vec<f64> = plan.cuts_before(window.start()).collect();
        knots.reverse();
        let before = knots.len();
        knots.extend_from_slice(plan.piece_knots());
        let own = knots.len();
        knots.extend(plan.cuts_after(window.end()));
        let mut segments = vec![plan.segment_before(); before];
        segments.extend(Self::own(plan).segments);
        segments.resize(segments.len() + knots.len() - own, plan.segment_after());
        Self { knots, segments }
    }

    /// Returns the pieces between a trajectory's knots.
    pub(crate) fn own(plan: &Trajectory) -> Self {
        Self {
            knots: plan.piece_knots().to_vec(),
            segments: match plan.straight_motions() {
                [] => plan.cubics().to_vec(),
                motions => motions.iter().map(StraightMotion::segment).collect(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Extension, Outside, Pieces};
    use crate::knots::Knots;
    use crate::trajectory::{State, Trajectory};
    use crate::window::Window;
    use glam::DVec3;

    /// Returns plans that continue beyond their knots: at rest, coasting, of three states.
    fn plans() -> [Trajectory; 5] {
        let state = |time: f64| State::new(time, DVec3::X * time, DVec3::X);
        let late = |time: f64| State::new(1.7e9 + time, DVec3::X * time, DVec3::Y * time);
        let plans = [
            Trajectory::at_rest(DVec3::ONE),
            Trajectory::coasting(state(3.0)),
            Trajectory::from_states(&[-0.5, 1.0, 3.0].map(state)),
            Trajectory::from_states(&[-0.5, 1.0, 3.0].map(state)),
            Trajectory::from_states(&[0.0, 1e-6, 0.4].map(late)),
        ];
        let rules = [Outside::Coast, Outside::Extrapolate].into_iter().cycle();
        let mut plans = plans.map(|plan| plan.unwrap_or_else(|_| unreachable!()));
        for (plan, rule) in plans.iter_mut().zip(rules) {
            *plan = plan.clone().with_outside(rule);
        }
        plans
    }

    fn window(start: f64, end: f64) -> Window {
        Window::new(start, end).unwrap_or_else(|_| unreachable!())
    }

    fn extension(plan: &Trajectory, window: Window) -> Option<Extension> {
        plan.extension(window).unwrap_or_else(|_| unreachable!())
    }

    /// Windows begin and end at knots, at cuts, beside them and far away.
    #[test]
    fn pieces_follow_from_their_numbers() {
        let instants = [
            -1e12,
            -15.0,
            -11.0,
            -5.0,
            -3.0,
            -2.0,
            -0.5,
            0.0,
            1.0,
            3.0,
            5.0,
            7.0,
            9.0,
            20.0,
            21.0,
            1.7e9,
            1.7e9 + 0.4,
            1e12,
            1e300,
        ];
        let instants = instants.map(|time: f64| [time.next_down(), time, time.next_up()]);
        let instants: Vec<f64> = instants.into_iter().flatten().collect();
        let (mut beyond, mut own) = (0, 0);
        for plan in plans() {
            for &start in &instants {
                for &end in instants.iter().filter(|end| **end >= start) {
                    let window = window(start, end);
                    let list = Pieces::over(&plan, window);
                    let Ok(extension) = plan.extension(window) else {
                        continue;
                    };
                    let knots = Knots::over(&plan, extension.as_ref());
                    assert_eq!(knots.cubics(), list.segments.len());
                    let all: Vec<f64> = (0..=knots.cubics()).map(|k| knots.at(k)).collect();
                    assert_eq!(all, list.knots, "{window:?}");
                    assert_eq!(knots.ends(), Knots::of(&list.knots).ends());
                    for (number, segment) in list.segments.iter().enumerate() {
                        match knots.segment_beyond(number) {
                            Some(outer) => assert_eq!(outer, *segment),
                            None => own += 1,
                        }
                    }
                    beyond += list.segments.len() - plan.cubics().len();
                }
            }
        }
        assert!(beyond > 50_000 && own > 1_000, "{beyond} {own}");
    }

    /// Extends in many small steps.
    #[test]
    fn a_lengthened_extension_is_that_over_the_longer_window() {
        let mut lengthened = 0;
        for plan in plans() {
            for start in [-9.0, 0.0, 5.0] {
                let mut kept: Option<Extension> = None;
                for step in 0_u32..300 {
                    let end = start + 0.01 * 1.05_f64.powi(step.cast_signed());
                    let fresh = extension(&plan, window(start, end));
                    if let Some(kept) = &mut kept {
                        let before = kept.after;
                        assert!(plan.lengthen(kept, end).is_ok());
                        lengthened += kept.after - before;
                    } else {
                        kept = fresh;
                    }
                    assert_eq!(kept, fresh, "{start} {end}");
                }
            }
        }
        assert!(lengthened > 60, "{lengthened}");
    }

    #[test]
    fn what_cannot_be_lengthened_stays() {
        let fast = State::new(0.0, DVec3::ZERO, DVec3::X * 1e298);
        let plan = Trajectory::coasting(fast).unwrap_or_else(|_| unreachable!());
        let Some(mut kept) = extension(&plan, window(0.0, 7.0)) else {
            unreachable!("it goes on")
        };
        let before = kept;
        assert!(plan.lengthen(&mut kept, 1e9).is_err());
        assert_eq!(kept, before);
        assert!(plan.lengthen(&mut kept, 20.0).is_ok());
    }
}
