//! Limits to which a cubic is followed beyond its knots.

use super::segment::Segment;
use super::straight::StraightMotion;
use crate::error::{Error, MAX_MAGNITUDE, Quantity};

/// Checks that a cubic can be followed between two instants (s) beyond knot number `knot`.
///
/// # Errors
///
/// [`Error::OutOfRange`], [`Error::TooFar`].
pub(super) fn check_reach(
    segment: &Segment,
    (from, to): (f64, f64),
    knot: usize,
) -> Result<(), Error> {
    /// Largest distance in time, in segment durations: its third power must stay in range.
    const MAX_LENGTHS: f64 = 1e100;
    /// Upper bound of cut times, s: the last cut may lie some times farther than the window's end.
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

/// Checks the same of a straight motion.
///
/// # Errors
///
/// As [`check_reach`].
pub(super) fn check_straight(
    motion: &StraightMotion,
    (from, to): (f64, f64),
    knot: usize,
) -> Result<(), Error> {
    if motion.is_near(from, to) {
        return Ok(());
    }
    check_reach(&motion.segment(), (from, to), knot)
}
