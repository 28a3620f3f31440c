//! What a body does beyond its knots, and the pieces that its motion has over a window.
//!
//! Beyond the knots a motion is cut into pieces of doubling length, from the knot outwards:
//! T, 2 T, 4 T, ... with T the duration of the neighbouring segment. The cuts depend on the
//! trajectory alone, never on a window, so an encounter out there has the same bits whatever
//! window it was found with; and a window however long needs only a few dozen pieces.

use super::{Segment, Trajectory};
use crate::error::{Error, LARGEST_MAGNITUDE, Quantity};
use crate::window::Window;
use std::borrow::Cow;

/// What a body does before its first and after its last knot.
///
/// A body that goes on beyond its knots exists at all times: it can only be screened within a
/// closed window, else there is an [`Error::WindowNotClosed`]. Where the window reaches its first or its
/// last knot, what it does beyond is laid out for that window: some microseconds a body, and room for
/// its plan once more. (A monitor does that once a plan.)
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
pub enum Outside {
    /// It does not exist there.
    #[default]
    Absent,
    /// The first and the last cubic go on, in their own parameter, as in the literature.
    Extrapolate,
    /// It keeps the velocity it has at its first or last knot: dead reckoning.
    Coast,
}

/// A motion over a window: cubics, and the instants between which each of them holds.
///
/// `knots[k]..knots[k + 1]` is the interval of `segments[k]`; inside a trajectory's own knots
/// that is the segment's own interval, outside it the carrying segment goes on beyond its own.
#[derive(Clone, Debug)]
pub(crate) struct Pieces<'a> {
    pub(crate) knots: Cow<'a, [f64]>,
    pub(crate) segments: Cow<'a, [Segment]>,
}

impl Pieces<'_> {
    /// The same, borrowing nothing.
    pub(crate) fn into_owned(self) -> Pieces<'static> {
        Pieces {
            knots: Cow::Owned(self.knots.into_owned()),
            segments: Cow::Owned(self.segments.into_owned()),
        }
    }
}

impl Trajectory {
    /// From the first to the last knot.
    pub(super) fn planned(&self) -> Window {
        match (self.knots.first(), self.knots.last()) {
            (Some(&first), Some(&last)) => Window::new(first, last).unwrap_or(Window::ALL),
            _ => Window::ALL,
        }
    }

    /// The cubic that carries the body before its first knot.
    pub(super) fn before(&self) -> &Segment {
        match (self.outside, self.segments.first()) {
            (Outside::Extrapolate, Some(first)) => first,
            _ => &self.segments.beside()[0],
        }
    }

    /// The cubic that carries the body after its last knot.
    pub(super) fn after(&self) -> &Segment {
        match (self.outside, self.segments.last()) {
            (Outside::Extrapolate, Some(last)) => last,
            _ => &self.segments.beside()[1],
        }
    }

    /// The pieces that cover the part of the domain within `window`, which is closed wherever the
    /// body exists beyond its knots. The body's own segments are borrowed, not copied, where the
    /// window stays within them.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`] where an extrapolated cubic leaves the range of numbers served;
    /// [`Error::TooFar`].
    pub(crate) fn pieces(&self, window: Window) -> Result<Pieces<'_>, Error> {
        let beyond = self.pieces_beyond(window)?;
        Ok(beyond.unwrap_or(Pieces {
            knots: Cow::Borrowed(&self.knots),
            segments: Cow::Borrowed(&self.segments),
        }))
    }

    /// The same; none if the window stays within the body's own knots.
    ///
    /// # Errors
    ///
    /// As [`pieces`](Self::pieces).
    pub(crate) fn pieces_beyond(&self, window: Window) -> Result<Option<Pieces<'static>>, Error> {
        if self.outside == Outside::Absent {
            return Ok(None);
        }
        let (first, last) = (self.planned().start(), self.planned().end());
        // Windows are closed: where one begins or ends at a knot, or a cut, what comes before or after
        // it counts as well. (It may be in another place, after a splice; and an instant may round to the knot.)
        let goes_before = window.start() <= first;
        // A body at rest has no cubic of its own: it goes on beyond its knot, whatever the window.
        let goes_after = self.segments.is_empty() || window.end() >= last;
        if !(goes_before || goes_after) {
            return Ok(None);
        }
        let mut knots = Vec::new();
        if goes_before {
            let carrier = self.before();
            let cuts = doubling_cuts(
                first,
                carrier.start() - carrier.end(),
                window.start().next_down().max(f64::MIN),
            );
            knots.extend(cuts.into_iter().rev());
        }
        let before = knots.len();
        knots.extend_from_slice(&self.knots);
        if goes_after {
            let carrier = self.after();
            knots.extend(doubling_cuts(
                last,
                carrier.end() - carrier.start(),
                window.end().max(last).next_up().min(f64::MAX),
            ));
        }
        let after = knots.len() - before - self.knots.len();
        let mut segments = vec![*self.before(); before];
        segments.extend_from_slice(&self.segments);
        segments.extend(std::iter::repeat_n(*self.after(), after));
        for (segment, ends) in segments.iter().zip(knots.windows(2)) {
            check_reach(segment, (ends[0], ends[1]), self.knots.len() - 1)?;
        }
        Ok(Some(Pieces {
            knots: Cow::Owned(knots),
            segments: Cow::Owned(segments),
        }))
    }
}

/// Checks that a cubic can be followed from an instant to another one (s) beyond its own knots, the last
/// of which has number `knot`.
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
    const MOST_LENGTHS: f64 = 1e100;
    if segment.lengths_to(from, to) > MOST_LENGTHS {
        let far = (from - segment.start()).abs() > (to - segment.start()).abs();
        let time = if far { from } else { to };
        return Err(Error::TooFar { knot, time });
    }
    // What its rounding amounts to grows as well.
    let reach = segment.rounding_scale(from, to);
    if reach > LARGEST_MAGNITUDE {
        return Err(Error::OutOfRange {
            knot,
            quantity: Quantity::Position(0),
            value: reach,
        });
    }
    Ok(())
}

/// Instants `knot + step (2^k - 1)`, k = 1, 2, ..., up to the first that reaches `until`.
fn doubling_cuts(knot: f64, step: f64, until: f64) -> Vec<f64> {
    let mut cuts = Vec::new();
    let mut factor = 1.0;
    let mut last = knot;
    while (step > 0.0 && last < until) || (step < 0.0 && last > until) {
        factor *= 2.0;
        let cut = knot + step * (factor - 1.0);
        // A step below the resolution of f64 at the knot is passed over until it shows.
        if (step > 0.0 && cut > last) || (step < 0.0 && cut < last) {
            last = cut.clamp(-f64::MAX, f64::MAX);
            cuts.push(last);
        }
    }
    cuts
}

#[cfg(test)]
mod tests {
    use super::doubling_cuts;

    #[test]
    fn cuts_do_not_depend_on_the_window() {
        let long = doubling_cuts(10.0, 2.0, 1e6);
        let short = doubling_cuts(10.0, 2.0, 30.0);
        assert_eq!(short, [12.0, 16.0, 24.0, 40.0]);
        assert_eq!(long[..4], short[..]);
        assert_eq!(doubling_cuts(-1.0, -1.0, -4.5), [-2.0, -4.0, -8.0]);
    }

    #[test]
    fn a_step_too_small_to_see_still_gets_there() {
        let cuts = doubling_cuts(1.7e9, 1e-9, 1.7e9 + 1.0);
        assert!(cuts.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(cuts.last().is_some_and(|&last| last >= 1.7e9 + 1.0));
    }
}
