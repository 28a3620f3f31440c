//! Knots as far apart as a tolerance allows.
//!
//! From each knot the longest step within the tolerance leads to the next one. No other choice needs fewer knots,
//! if longer pieces have larger errors. Then all knots move a little, so that the last piece is not a short one.

use crate::count::as_f64;
use crate::error::{Error, MAX_MAGNITUDE};

/// [Share](PieceError::share) that a step aims at.
const AIM: f64 = 0.95;

/// [Share](PieceError::share) from which on a step is long enough.
const LONG_ENOUGH: f64 = 0.9;

/// Precision to which a step's length is searched for where the error is no power of it.
const STEP_PRECISION: f64 = 0.01;

/// Shortest step, in units of the last place of the time. Instants between its ends are still told apart: a motion
/// that jumps is never within the tolerance across its jump.
const LEAST_STEP: f64 = 64.0;

/// Most trials for one step: enough to halve and double it across the whole range of f64.
const MAX_TRIALS: u32 = 8_192;

/// Knots of a fit.
#[derive(Debug)]
pub(super) struct Placed {
    /// Times of the knots, s.
    pub(super) knots: Vec<f64>,
    /// Largest error of a piece, m.
    pub(super) error: f64,
}

/// Returns a tolerance (m), if it is one.
///
/// # Errors
///
/// [`Error::FitTolerance`].
pub(in crate::trajectory) fn checked_tolerance(metres: f64) -> Result<f64, Error> {
    if metres > 0.0 && metres <= MAX_MAGNITUDE {
        Ok(metres)
    } else {
        Err(Error::FitTolerance { metres })
    }
}

/// The error of a piece of a fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceError {
    /// Largest distance between the motion and positions of the trajectory, m.
    pub(super) metres: f64,
    /// The motion's deviation from the cubic, without rounding, in units of what rounding leaves of the tolerance.
    pub(super) share: f64,
}

impl PieceError {
    /// The error of a piece whose cubic has left the range of f64.
    pub(super) const UNKNOWN: Self = Self {
        metres: f64::INFINITY,
        share: f64::INFINITY,
    };

    /// Returns the error by bounds or estimates of the deviation and of the rounding (m).
    pub(super) fn of(deviation: f64, rounding: f64, tolerance: f64) -> Self {
        /// Factor on bounds, for their own rounding.
        const SPARE: f64 = 1.0 + 1e-12;
        Self {
            metres: (deviation + rounding) * SPARE,
            share: deviation / (tolerance - rounding),
        }
    }
}

/// The motion for which knots are placed.
pub(super) trait Approximated {
    /// Returns the error of the piece between two instants.
    fn error(&mut self, from: f64, to: f64) -> Result<PieceError, Error>;

    /// Returns an error if the knots placed so far show that the motion cannot be meant.
    fn examine(&mut self, _knots: &[f64]) -> Result<(), Error> {
        Ok(())
    }
}

impl<F: FnMut(f64, f64) -> Result<PieceError, Error>> Approximated for F {
    fn error(&mut self, from: f64, to: f64) -> Result<PieceError, Error> {
        self(from, to)
    }
}

/// Places knots from `start` to `end` (s) such that no piece of the motion has an error above the tolerance (m).
///
/// # Errors
///
/// Those of the motion; [`Error::FitUnreachable`]; [`Error::FitKnots`].
pub(super) fn place_knots(
    [start, end]: [f64; 2],
    tolerance: f64,
    max_knots: usize,
    mut motion: impl Approximated,
) -> Result<Placed, Error> {
    let (mut knots, mut from) = (vec![start], start);
    let (mut step, mut error, mut last_share) = ((end - start) / 8.0, 0.0_f64, 0.0);
    while from < end {
        if knots.len() >= max_knots {
            return Err(Error::FitKnots {
                limit: max_knots,
                time: from,
            });
        }
        let (to, found) = longest_step([from, end], step, tolerance, &mut motion)?;
        (error, last_share) = (error.max(found.metres), found.share);
        knots.push(to);
        motion.examine(&knots)?;
        (step, from) = (to - from, to);
    }
    let balanced = evenly_shortened(&knots, last_share);
    let within = error_within(&balanced, tolerance, &mut motion)?;
    let (knots, error) = within.map_or((knots, error), |error| (balanced, error));
    Ok(Placed { knots, error })
}

/// Returns the farthest instant that a piece from `from` reaches within the tolerance, at most `end`, and its error.
fn longest_step(
    [from, end]: [f64; 2],
    first: f64,
    tolerance: f64,
    motion: &mut impl Approximated,
) -> Result<(f64, PieceError), Error> {
    let least = LEAST_STEP * f64::EPSILON * from.abs().max(f64::MIN_POSITIVE);
    let (mut good, mut bad, mut reached) = (None, None, f64::INFINITY);
    let mut to = (from + first.max(least)).min(end);
    for trial in 0..MAX_TRIALS {
        let (length, error) = (to - from, motion.error(from, to)?);
        reached = error.metres.min(reached);
        // The deviation from a cubic grows with the fourth power of its duration.
        let factor = (AIM / error.share).sqrt().sqrt();
        let hurry = trial > 8;
        let proposal = if error.metres <= tolerance {
            if to >= end || error.share >= LONG_ENOUGH {
                return Ok((to, error));
            }
            good = Some((to, error));
            from + length * factor.clamp(if hurry { 2.0 } else { 1.01 }, 4.0)
        } else {
            bad = Some(to);
            // After NaN the step shrinks as well.
            let factor = if factor >= 0.1 { factor } else { 0.1 };
            from + length * factor.min(if hurry { 0.5 } else { 0.95 })
        };
        to = match (good, bad) {
            (None, _) if proposal - from < least => break,
            (None, _) => proposal,
            (Some((good, _)), None) if proposal > good => proposal.min(end),
            (Some((good, _)), Some(bad)) if bad - good > STEP_PRECISION * (good - from) => {
                let inset = 0.1 * (bad - good);
                let inside = good + inset..bad - inset;
                let between = good + 0.5 * (bad - good);
                let power_law = trial < 6 && inside.contains(&proposal);
                if power_law { proposal } else { between }
            }
            (Some(_), _) => break,
        };
    }
    good.ok_or(Error::FitUnreachable {
        time: from,
        tolerance,
        reached,
    })
}

/// Returns the knots with all pieces shortened by one factor, and the last one lengthened in turn. `share` is that of
/// the last piece.
///
/// The last piece could have been longer: as long as the piece before it, or as its share says.
fn evenly_shortened(knots: &[f64], share: f64) -> Vec<f64> {
    let [.., before, from, end] = knots else {
        return Vec::new();
    };
    let pieces = knots.len() - 2;
    // Length of the last piece, in units of the longest one that would do.
    let last = share.sqrt().sqrt().min((end - from) / (from - before));
    let last = last.clamp(1e-3, 1.0);
    let ratio = (as_f64(pieces) + last) / as_f64(pieces + 1);
    let mut balanced = knots.to_vec();
    for (number, knot) in balanced.iter_mut().enumerate().take(pieces + 1).skip(1) {
        // A shorter piece before each: the knot lies in the piece before it, or in an earlier one.
        let place = as_f64(number) * ratio;
        let mut piece = number - 1;
        while as_f64(piece) > place {
            piece -= 1;
        }
        let inside = place - as_f64(piece);
        *knot = knots[piece] + (knots[piece + 1] - knots[piece]) * inside;
    }
    balanced
}

/// Returns the largest error of the pieces between knots, or `None` if one exceeds the tolerance, or there is none.
fn error_within(
    knots: &[f64],
    tolerance: f64,
    motion: &mut impl Approximated,
) -> Result<Option<f64>, Error> {
    let mut largest = None;
    for pair in knots.windows(2) {
        let is_short = pair[1] - pair[0] < LEAST_STEP * f64::EPSILON * pair[0].abs();
        if is_short {
            return Ok(None);
        }
        let error = motion.error(pair[0], pair[1])?.metres;
        if error.is_nan() || error > tolerance {
            return Ok(None);
        }
        largest = Some(error.max(largest.unwrap_or(0.0)));
    }
    Ok(largest)
}
