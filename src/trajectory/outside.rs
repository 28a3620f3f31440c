//! What a body does beyond its knots, and the pieces that its motion has over a window.
//!
//! Beyond the knots a motion is cut into pieces of doubling length, from the knot outwards:
//! T, 2 T, 4 T, ... with T the duration of the neighbouring segment (of a body at rest, longer than
//! any time; of one that only coasts, fixed). The cuts depend on the trajectory alone, never on a
//! window, so an encounter out there has the same bits whatever window it was found with; and a window
//! however long needs only a few dozen pieces. T is rounded to three times a power of two.

use super::cuts::DoublingCuts;
use super::{Segment, Trajectory};
use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::window::Window;
use std::iter::repeat_n;

/// What a body does before its first and after its last knot.
///
/// A body that goes on beyond its knots exists at all times: it can only be screened within a
/// closed window, else there is an [`Error::WindowNotClosed`]. Where the window reaches its first or its
/// last knot, what it does beyond is laid out once: some microseconds a body, and room for its plan
/// once more. It is laid out again for a new plan, and where a window reaches twice as far beyond the
/// knots, or half as far.
///
/// Far beyond the knots a position is good to some roundings of the way gone, 4e-15 of it: of a cubic, of
/// the sizes of its three terms. A straight flight has none but the first. So two bodies come within a margin
/// to 1e-14 of both ways and of their distance. [`Accuracy::Exact`](crate::Accuracy::Exact) reports what that
/// leaves open, [`Accuracy::Certified`](crate::Accuracy::Certified) marks it as unresolved.
///
/// A window in which bodies cross the scene many times over costs as if each pair were near: to 1e12 s,
/// 1,000 bodies at 10 m/s take 4 s, and 5,000 more than 90 s. Ask for shorter ones.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Outside, State, Trajectory};
///
/// // It speeds up: t² metres after t seconds.
/// let square = |t: f64| State::new(t, t * t * DVec3::X, 2.0 * t * DVec3::X);
/// let plan = Trajectory::from_states(&[square(0.0), square(1.0)])?;
/// assert_eq!(plan.position(2.0), None);
/// for (outside, metres) in [(Outside::Extrapolate, 4.0), (Outside::Coast, 3.0)] {
///     assert_eq!(plan.clone().with_outside(outside).position(2.0), Some(metres * DVec3::X));
/// }
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Outside {
    /// It does not exist there.
    #[default]
    Absent,
    /// The first and the last cubic go on, in their own parameter, as in the literature. A position is good
    /// to 4e-15 of the cubic's terms, which grow with time, its square and its cube; straight motion has the
    /// first alone. States a minute apart on a low orbit give a millimetre after 10 hours, and a metre after
    /// five days.
    Extrapolate,
    /// It keeps the velocity it has at its first or last knot: dead reckoning. (From a single state:
    /// [`Trajectory::coasting`].)
    Coast,
}

/// A motion over a window that reaches beyond its knots: cubics, and the instants between which each
/// of them holds.
///
/// `knots[k]..knots[k + 1]` is the interval of `segments[k]`; inside a trajectory's own knots
/// that is the segment's own interval, outside it the carrying segment goes on beyond its own.
#[derive(Clone, Debug)]
pub(crate) struct Pieces {
    pub(crate) knots: Vec<f64>,
    pub(crate) segments: Vec<Segment>,
    /// How many of them are before the first knot, and how many after the last one; none where the body
    /// does not exist there, whatever the window.
    before: Option<usize>,
    after: Option<usize>,
}

/// Windows over which a motion has the same pieces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scope {
    /// They begin after the first of these instants and by the second one, s; anywhere, if there are
    /// none.
    starts: Option<(f64, f64)>,
    /// And end from the first of these on and before the second one, s.
    ends: Option<(f64, f64)>,
}

impl Scope {
    pub(crate) fn holds(&self, window: Window) -> bool {
        let (start, end) = (window.start(), window.end());
        let begins = |(from, to)| from < start && start <= to;
        let stops = |(from, to)| from <= end && end < to;
        self.starts.is_none_or(begins) && self.ends.is_none_or(stops)
    }
}

impl Pieces {
    /// For so many more there is room at first: each reaches twice as far as the one before.
    const ROOM: usize = 4;

    /// None yet, and memory for so many.
    pub(crate) fn with_capacity(count: usize) -> Self {
        Self {
            knots: Vec::with_capacity(count + 1),
            segments: Vec::with_capacity(count),
            before: None,
            after: None,
        }
    }

    /// For how many there is memory.
    pub(crate) fn capacity(&self) -> usize {
        let knots = self.knots.capacity().saturating_sub(1);
        self.segments.capacity().min(knots)
    }

    /// Drops all, but not the memory.
    pub(crate) fn clear(&mut self) {
        self.knots.clear();
        self.segments.clear();
        (self.before, self.after) = (None, None);
    }

    /// A trajectory's own.
    #[cfg(test)]
    pub(crate) fn own(trajectory: &Trajectory) -> Self {
        Self {
            knots: trajectory.knots().to_vec(),
            segments: trajectory.segments().to_vec(),
            before: None,
            after: None,
        }
    }

    /// The windows over which the motion has just these.
    pub(crate) fn scope(&self) -> Scope {
        let last = self.knots.len() - 1;
        let has_no_cubic = self.beyond().count() == self.segments.len();
        Scope {
            starts: self.before.map(|count| match count {
                0 => (self.knots[0], f64::INFINITY),
                _ => (self.knots[0], self.knots[1]),
            }),
            ends: self.after.map(|count| match count {
                0 => (f64::NEG_INFINITY, self.knots[last]),
                1 if has_no_cubic => (f64::NEG_INFINITY, self.knots[last]),
                _ => (self.knots[last - 1], self.knots[last]),
            }),
        }
    }

    /// Those beyond the trajectory's own knots, with the interval of each (s).
    pub(crate) fn beyond(&self) -> impl Iterator<Item = (&Segment, (f64, f64))> {
        let [before, after] = [self.before, self.after].map(Option::unwrap_or_default);
        let own = before..self.segments.len() - after;
        let ends = self.knots.windows(2).map(|ends| (ends[0], ends[1]));
        let pieces = self.segments.iter().zip(ends).enumerate();
        pieces
            .filter(move |(number, _)| !own.contains(number))
            .map(|(_, piece)| piece)
    }
}

impl Trajectory {
    /// From the first to the last knot; all of time without one.
    pub(crate) fn planned(&self) -> Window {
        match (self.knots.first(), self.knots.last()) {
            (Some(&first), Some(&last)) => Window::new(first, last).unwrap_or(Window::ALL),
            _ => Window::ALL,
        }
    }

    /// The cubic that carries the body before its first knot.
    pub(super) fn carrier_before(&self) -> Segment {
        let end = self.segments.beside()[0];
        match (self.before, self.segments.first()) {
            // Of what was before the knots that are left nothing is known.
            (Outside::Extrapolate, Some(first)) if end.start() < self.knots[0] => *first,
            (Outside::Extrapolate, _) => end.extended(),
            _ => end.straight(),
        }
    }

    /// The cubic that carries the body after its last knot.
    pub(super) fn carrier_after(&self) -> Segment {
        let end = self.segments.beside()[1];
        match self.after {
            Outside::Extrapolate => end.extended(),
            _ => end.straight(),
        }
    }

    /// The pieces that cover the part of the domain within `window`, which is closed where the body
    /// exists beyond its knots; none if the window stays within them, or the body is absent beyond. They
    /// are put into `memory` for so many, which is empty yet.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] where an extrapolated cubic leaves the range of numbers served;
    /// [`Error::TooFar`].
    pub(crate) fn pieces(
        &self,
        window: Window,
        memory: impl FnOnce(usize) -> Pieces,
    ) -> Result<Option<Pieces>, Error> {
        if !self.goes_beyond() {
            return Ok(None);
        }
        let first = self.planned().start();
        let (before, after) = (
            self.cuts_before(window.start()),
            self.cuts_after(window.end()),
        );
        let counts = [&before, &after].map(|cuts| cuts.clone().count());
        if counts == [0, 0] {
            return Ok(None);
        }
        let own = self.segments.len();
        let mut pieces = memory(counts[0] + own + counts[1] + Pieces::ROOM);
        let Pieces {
            knots, segments, ..
        } = &mut pieces;
        // From the knot outwards.
        knots.extend(before);
        knots.reverse();
        knots.extend_from_slice(&self.knots);
        knots.extend(after);
        segments.extend(repeat_n(self.carrier_before(), counts[0]));
        segments.extend_from_slice(&self.segments);
        segments.extend(repeat_n(self.carrier_after(), counts[1]));
        pieces.before = (self.before != Outside::Absent).then_some(counts[0]);
        pieces.after = (self.after != Outside::Absent).then_some(counts[1]);
        for (segment, ends) in pieces.beyond() {
            let is_before = ends.1 <= first;
            let knot = if is_before { 0 } else { self.knots.len() - 1 };
            check_reach(segment, ends, knot)?;
        }
        Ok(Some(pieces))
    }

    /// Where it is cut before the first knot, as far as to a window's start (s), and beyond it; nowhere,
    /// if that is not reached.
    ///
    /// Windows are closed: where one begins or ends at a knot, or a cut, what comes before or after
    /// it counts as well. (It may be in another place, after a splice; and an instant may round to
    /// the knot.)
    fn cuts_before(&self, start: f64) -> DoublingCuts {
        let (carrier, first) = (self.carrier_before(), self.planned().start());
        if self.before == Outside::Absent || start > first {
            return DoublingCuts::NONE;
        }
        let until = start.next_down().max(f64::MIN);
        DoublingCuts::of(first, carrier.start() - carrier.end(), until)
    }

    /// The same after the last knot, as far as to a window's end (s).
    fn cuts_after(&self, end: f64) -> DoublingCuts {
        let (carrier, last) = (self.carrier_after(), self.planned().end());
        // Without a cubic of its own a body goes on beyond its knot, whatever the window.
        if self.after == Outside::Absent || !(self.segments.is_empty() || end >= last) {
            return DoublingCuts::NONE;
        }
        let until = end.max(last).next_up().min(f64::MAX);
        DoublingCuts::of(last, carrier.end() - carrier.start(), until)
    }

    /// Makes its [pieces](Self::pieces) over a window those over one that ends later, at `end` (s).
    ///
    /// # Errors
    ///
    /// As [`pieces`](Self::pieces); nothing was changed then.
    pub(crate) fn lengthen(&self, pieces: &mut Pieces, end: f64) -> Result<(), Error> {
        let Some(known) = pieces.after else {
            return Ok(());
        };
        let (carrier, new) = (self.carrier_after(), self.cuts_after(end).skip(known));
        let mut from = pieces.knots[pieces.knots.len() - 1];
        let mut count = 0;
        for cut in new.clone() {
            check_reach(&carrier, (from, cut), self.knots.len() - 1)?;
            (from, count) = (cut, count + 1);
        }
        pieces.knots.extend(new);
        pieces.segments.extend(repeat_n(carrier, count));
        pieces.after = Some(known + count);
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::{Outside, Pieces};
    use crate::trajectory::{State, Trajectory};
    use crate::window::Window;
    use glam::DVec3;

    /// Of three states, at rest, and from one state.
    fn plans() -> [Trajectory; 3] {
        let state = |time: f64| State::new(time, DVec3::X * time, DVec3::X);
        let plans = [
            Trajectory::from_states(&[-0.5, 1.0, 3.0].map(state)),
            Trajectory::at_rest(DVec3::ONE),
            Trajectory::coasting(state(3.0)),
        ];
        plans.map(|plan| plan.unwrap_or_else(|_| unreachable!()))
    }

    /// Each window against each other one, that begin and end at knots, at cuts, and beside them.
    #[test]
    fn the_scope_holds_what_has_the_same_pieces() {
        let [plan, rest, coasts] = plans();
        let instants = [
            -15.0, -11.0, -5.0, -3.0, -2.0, -0.5, 0.0, 1.0, 3.0, 5.0, 7.0, 9.0, 20.0, 21.0,
        ];
        let instants = instants.map(|time: f64| [time.next_down(), time, time.next_up()]);
        let instants: Vec<f64> = instants.into_iter().flatten().collect();
        for plan in [
            rest,
            coasts,
            plan.clone().with_outside(Outside::Coast),
            plan.with_outside(Outside::Extrapolate),
        ] {
            let windows = instants.iter().flat_map(|&start| {
                let windows = instants.iter().map(move |&end| Window::new(start, end));
                windows.filter_map(Result::ok)
            });
            let laid_out: Vec<_> = windows
                .map(|window| {
                    (
                        window,
                        plan.pieces(window, Pieces::with_capacity)
                            .unwrap_or_else(|_| unreachable!()),
                    )
                })
                .collect();
            let mut same = 0;
            for (_, pieces) in &laid_out {
                let Some(pieces) = pieces else { continue };
                for (window, others) in &laid_out {
                    let is_same = others
                        .as_ref()
                        .is_some_and(|others| others.knots == pieces.knots);
                    assert_eq!(
                        pieces.scope().holds(*window),
                        is_same,
                        "{window:?} {pieces:?}"
                    );
                    same += u32::from(is_same);
                }
            }
            assert!(same > 5_000, "{same}");
        }
    }

    /// However often they are lengthened, and however little.
    #[test]
    fn lengthened_pieces_are_those_of_the_longer_window() {
        let [plan, rest, _] = plans();
        let over = |plan: &Trajectory, start: f64, end: f64| {
            let window = Window::new(start, end).unwrap_or_else(|_| unreachable!());
            plan.pieces(window, Pieces::with_capacity)
                .unwrap_or_else(|_| unreachable!())
        };
        let mut lengthened = 0;
        for plan in [
            rest,
            plan.clone().with_outside(Outside::Coast),
            plan.with_outside(Outside::Extrapolate),
        ] {
            for start in [-9.0, 0.0, 5.0] {
                let mut kept: Option<Pieces> = None;
                for step in 0_u32..300 {
                    let end = start + 0.01 * 1.05_f64.powi(step.cast_signed());
                    let fresh = over(&plan, start, end);
                    if let Some(pieces) = &mut kept {
                        let before = pieces.knots.len();
                        assert!(plan.lengthen(pieces, end).is_ok());
                        lengthened += pieces.knots.len() - before;
                    } else {
                        kept = fresh.clone();
                    }
                    let shown = |pieces: Option<&Pieces>| format!("{pieces:?}");
                    assert_eq!(shown(kept.as_ref()), shown(fresh.as_ref()), "{start} {end}");
                }
            }
        }
        assert!(lengthened > 60, "{lengthened}");
    }

    #[test]
    fn what_cannot_be_lengthened_stays() {
        let fast = State::new(0.0, DVec3::ZERO, DVec3::X * 1e299);
        let plan = Trajectory::coasting(fast).unwrap_or_else(|_| unreachable!());
        let window = Window::new(0.0, 1.0).unwrap_or_else(|_| unreachable!());
        let Ok(Some(mut pieces)) = plan.pieces(window, Pieces::with_capacity) else {
            unreachable!("it goes on")
        };
        let before = format!("{pieces:?}");
        assert!(plan.lengthen(&mut pieces, 1e9).is_err());
        assert_eq!(format!("{pieces:?}"), before);
        assert!(plan.lengthen(&mut pieces, 2.0).is_ok());
    }
}
