//! Motion beyond the knots: which cubic a body follows there, and where that is cut into pieces.
//!
//! Pieces have doubling length, from the knot outwards: T, 2 T, 4 T, ... with T the duration of the
//! neighbouring segment (of a body at rest, longer than any time; of one that only coasts, fixed). The
//! cuts depend on the trajectory alone, never on a window, so an encounter out there has the same bits
//! whatever window it was found with; and a window however long needs only a few dozen pieces. T is
//! rounded to three times a power of two. Pieces and cuts are kept in no list: they follow from their
//! numbers.

use super::cuts::DoublingCuts;
use super::{Outside, Segment, Trajectory};
use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::window::Window;

/// The number of pieces that a motion has beyond its knots, over a window that reaches there.
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
    /// Returns the time from the first to the last of its [cuts](Self::cuts); all of time without one.
    pub(crate) fn planned(&self) -> Window {
        let cuts = self.cuts();
        match (cuts.first(), cuts.last()) {
            (Some(&first), Some(&last)) => Window::new(first, last).unwrap_or(Window::ALL),
            _ => Window::ALL,
        }
    }

    /// Returns the cubic that the body follows before its first knot.
    pub(crate) fn segment_before(&self) -> Segment {
        let end = *self.carriers()[0];
        match (self.outside_before(), self.cubics().first()) {
            // Of what was before the knots that are left nothing is known.
            (Outside::Extrapolate, Some(first)) if end.start() < self.cuts()[0] => *first,
            (Outside::Extrapolate, _) => end.extended(),
            _ => end.straight(),
        }
    }

    /// Returns the cubic that the body follows after its last knot.
    pub(crate) fn segment_after(&self) -> Segment {
        let end = *self.carriers()[1];
        match self.outside_after() {
            Outside::Extrapolate => end.extended(),
            _ => end.straight(),
        }
    }

    /// Returns the cut with a number from 1 on, counted from the first knot, s.
    pub(crate) fn cut_before(&self, number: u32) -> f64 {
        let (knot, first) = self.knot_before();
        DoublingCuts::cut(knot, self.step_before(), first + number)
    }

    /// Returns the cut with a number from 1 on, counted from the last knot, s.
    pub(crate) fn cut_after(&self, number: u32) -> f64 {
        let (knot, first) = self.knot_after();
        DoublingCuts::cut(knot, self.step_after(), first + number)
    }

    /// Returns the pieces that cover the part of the domain within `window`, which is closed where the body
    /// exists beyond its knots; none if the window stays within them, or the body is absent beyond.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] where an extrapolated cubic leaves the range of numbers served;
    /// [`Error::TooFar`].
    pub(crate) fn extension(&self, window: Window) -> Result<Option<Extension>, Error> {
        if !self.goes_beyond() {
            return Ok(None);
        }
        let mut extension = Extension {
            before: 0,
            after: 0,
            domain: (self.planned().start(), self.planned().end()),
        };
        let before = self.cuts_before(window.start());
        for (cut, number) in before.zip(1..) {
            (extension.before, extension.domain.0) = (number, cut);
        }
        if extension.before > 0 {
            // The farthest piece is the first to leave the range of numbers.
            let end = self.cut_before(extension.before - 1);
            check_reach(&self.segment_before(), (extension.domain.0, end), 0)?;
        }
        self.lengthen(&mut extension, window.end())?;
        let is_own = extension.before == 0 && extension.after == 0;
        Ok((!is_own).then_some(extension))
    }

    /// Makes an [extension](Self::extension) over a window that over one that ends later, at `end` (s).
    ///
    /// # Errors
    ///
    /// As [`extension`](Self::extension); nothing was changed then.
    pub(crate) fn lengthen(&self, extension: &mut Extension, end: f64) -> Result<(), Error> {
        let known = extension.after;
        let (mut after, mut from) = (known, extension.domain.1);
        let mut segment = None;
        for cut in self.cuts_after(end).skip(known as usize) {
            let segment = segment.get_or_insert_with(|| self.segment_after());
            check_reach(segment, (from, cut), self.knots().len() - 1)?;
            (after, from) = (after + 1, cut);
        }
        (extension.after, extension.domain.1) = (after, from);
        Ok(())
    }

    /// Where it is cut before the first knot, as far as to a window's start (s), and beyond it; nowhere,
    /// if that is not reached.
    ///
    /// Windows are closed: where one begins or ends at a knot, or a cut, what comes before or after
    /// it counts as well. (It may be in another place, after a splice; and an instant may round to
    /// the knot.)
    fn cuts_before(&self, start: f64) -> DoublingCuts {
        if self.outside_before() == Outside::Absent || start > self.planned().start() {
            return DoublingCuts::NONE;
        }
        let until = start.next_down().max(f64::MIN);
        let (knot, number) = self.knot_before();
        DoublingCuts::after(number, knot, self.step_before(), until)
    }

    /// Where it is cut after the last knot, as far as to a window's end (s), and beyond it; nowhere, if
    /// that is not reached.
    fn cuts_after(&self, end: f64) -> DoublingCuts {
        let last = self.planned().end();
        // Without a cubic of its own a body goes on beyond its knot, whatever the window.
        if self.outside_after() == Outside::Absent || !(self.cubics().is_empty() || end >= last) {
            return DoublingCuts::NONE;
        }
        let until = end.max(last).next_up().min(f64::MAX);
        let (knot, number) = self.knot_after();
        DoublingCuts::after(number, knot, self.step_after(), until)
    }

    /// The duration of the first piece before the knots, negative, s.
    fn step_before(&self) -> f64 {
        let end = self.carriers()[0];
        let segment = match (self.outside_before(), self.cubics().first()) {
            (Outside::Extrapolate, Some(first)) if end.start() < self.cuts()[0] => first,
            _ => end,
        };
        segment.start() - segment.end()
    }

    /// The duration of the first piece after the knots, s.
    fn step_after(&self) -> f64 {
        let end = self.carriers()[1];
        end.end() - end.start()
    }

    /// Returns the knot that the cuts before the motion's own cubics are counted from (s), and the number of
    /// the one at which these begin.
    fn knot_before(&self) -> (f64, u32) {
        match self.line() {
            Some((segment, _)) => (segment.start(), 1),
            None => (self.planned().start(), 0),
        }
    }

    /// Returns the knot that the cuts after the motion's own cubics are counted from (s), and the number of
    /// the one at which these end.
    fn knot_after(&self) -> (f64, u32) {
        match self.line() {
            Some((segment, _)) => (segment.start(), 1),
            None => match (self.cuts(), self.knots()) {
                (cuts, [.., last]) if cuts.len() > self.knots().len() => (*last, 1),
                _ => (self.planned().end(), 0),
            },
        }
    }
}

/// Checks that a cubic can be followed from an instant to another one (s) beyond the knot with this
/// number.
///
/// # Errors
///
/// [`Error::OutOfRange`], [`Error::TooFar`].
pub(super) fn check_reach(
    segment: &Segment,
    (from, to): (f64, f64),
    knot: usize,
) -> Result<(), Error> {
    /// Lengths of it: their third power must stay within the range of numbers.
    const MAX_LENGTHS: f64 = 1e100;
    /// The last cut before the end of a window may be some times as far as that.
    const FARTHEST: f64 = 10.0 * MAX_MAGNITUDE;
    let farthest = from.abs().max(to.abs());
    if segment.lengths_to(from, to) > MAX_LENGTHS || farthest > FARTHEST {
        let far = (from - segment.start()).abs() > (to - segment.start()).abs();
        let time = if far { from } else { to };
        return Err(Error::TooFar { knot, time });
    }
    // What its rounding amounts to grows as well.
    let reach = segment.rounding_scale(from, to);
    if reach.is_nan() || reach > MAX_MAGNITUDE {
        return Err(Error::OutOfRange {
            knot,
            quantity: Quantity::Distance,
            value: reach,
        });
    }
    Ok(())
}

/// A motion's pieces in lists, one by one.
#[cfg(test)]
#[derive(Clone, Debug)]
pub(crate) struct Pieces {
    pub(crate) knots: Vec<f64>,
    pub(crate) segments: Vec<Segment>,
}

#[cfg(test)]
impl Pieces {
    /// Of a trajectory over a window.
    pub(crate) fn over(plan: &Trajectory, window: Window) -> Self {
        let mut knots: Vec<f64> = plan.cuts_before(window.start()).collect();
        knots.reverse();
        let before = knots.len();
        knots.extend_from_slice(plan.cuts());
        let own = knots.len();
        knots.extend(plan.cuts_after(window.end()));
        let mut segments = vec![plan.segment_before(); before];
        segments.extend_from_slice(plan.cubics());
        segments.resize(segments.len() + knots.len() - own, plan.segment_after());
        Self { knots, segments }
    }

    /// A trajectory's own.
    pub(crate) fn own(plan: &Trajectory) -> Self {
        Self {
            knots: plan.cuts().to_vec(),
            segments: plan.cubics().to_vec(),
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

    /// Of three states, at rest, and from one state, that go on before and after.
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

    /// Windows that begin and end at knots, at cuts, and beside them, and far away.
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

    /// However often it is lengthened, and however little.
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
