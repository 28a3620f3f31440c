//! Velocities that are not the derivative of the position.
//!
//! A cubic takes its slopes from the velocities that it is told. If these are off by e, a piece of duration h is off by
//! up to 0.096 e h, however short it is: pieces within a tolerance last about 8 tolerances over e, and there are very
//! many of them. The secant of the position shows e: by the mean value theorem it is the mean velocity.
//!
//! A motion is refused only where that e is what makes the pieces short, and where short intervals inside of them show
//! the same e. A velocity that jumps or oscillates differs from its mean as well, but not in short intervals alike.

use crate::error::{Error, Quantity};
use crate::rounding::norm;
use crate::trajectory::State;
use glam::DVec3;

/// Least number of knots whose pieces are examined. Fits of fewer are quick whatever the velocity is.
const MANY_KNOTS: usize = 256;

/// Number of consecutive pieces that are examined: the last ones.
const PIECES: usize = 8;

/// Least product of the velocity's error and a piece's duration, in tolerances: half of what the tolerance allows.
const LEAST_SHIFT: f64 = 4.0;

/// Shares of a piece at which short intervals begin. They are uneven, so that no oscillation looks the same at all.
const SHARES: [f64; 3] = [0.19, 0.47, 0.83];

/// Duration of a short interval, in durations of its piece.
const SHORT: f64 = 1.0 / 64.0;

/// Largest difference between the error of the velocity in a short interval and that in its piece, in units of the
/// latter.
const ALIKE: f64 = 0.25;

/// Returns an error if the last of these knots are close to each other because the velocity is not the derivative of
/// the position. They are examined whenever their number has doubled. `state` returns the motion's state at a time,
/// whose position is good to `ulps`; the pieces are within `tolerance` (m).
///
/// # Errors
///
/// Those of `state`; [`Error::FitVelocity`].
pub(super) fn check_velocity(
    knots: &[f64],
    (tolerance, ulps): (f64, f64),
    mut state: impl FnMut(f64) -> Result<State, Error>,
) -> Result<(), Error> {
    let count = knots.len();
    if count < MANY_KNOTS || !count.is_power_of_two() {
        return Ok(());
    }
    let mut mean = |from: f64, to: f64| {
        let ends = [state(from)?, state(to)?];
        Ok::<_, Error>(MeanVelocity::of(
            ends,
            state(from + 0.5 * (to - from))?,
            ulps,
        ))
    };
    let mut last = None;
    for piece in knots[count - PIECES - 1..].windows(2) {
        let duration = piece[1] - piece[0];
        let whole = mean(piece[0], piece[1])?;
        let error = norm(whole.error());
        // NaN refuses nothing.
        let is_harmful = error * duration >= LEAST_SHIFT * tolerance;
        if !is_harmful {
            return Ok(());
        }
        for share in SHARES {
            let from = piece[0] + share * duration;
            let short = mean(from, from + SHORT * duration)?;
            let difference = norm(short.error() - whole.error());
            let is_alike = difference + whole.rounding + short.rounding <= ALIKE * error;
            if !is_alike {
                return Ok(());
            }
            last = Some(short);
        }
    }
    last.map_or(Ok(()), |short| Err(short.refusal()))
}

/// The mean velocity over an interval, from positions and as told.
struct MeanVelocity {
    /// Middle, s.
    time: f64,
    /// Mean velocity by the positions at both ends, m/s.
    secant: DVec3,
    /// Mean velocity by Simpson's rule from those told, m/s.
    told: DVec3,
    /// Rounding of the secant, m/s.
    rounding: f64,
}

impl MeanVelocity {
    fn of([first, last]: [State; 2], middle: State, ulps: f64) -> Self {
        let duration = last.time - first.time;
        let distance = norm(first.position).max(norm(last.position));
        Self {
            time: middle.time,
            secant: (last.position - first.position) / duration,
            told: (first.velocity + 4.0 * middle.velocity + last.velocity) / 6.0,
            rounding: 2.0 * (ulps + 1.0) * f64::EPSILON * distance / duration,
        }
    }

    fn error(&self) -> DVec3 {
        self.told - self.secant
    }

    /// Returns the error of the axis that is off most.
    fn refusal(&self) -> Error {
        let error = self.error().abs();
        let axis = error.max_position();
        Error::FitVelocity {
            time: self.time,
            quantity: Quantity::Velocity(axis),
            told: self.told[axis],
            found: self.secant[axis],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{SHARES, SHORT, check_velocity};
    use crate::error::{Error, Quantity};
    use crate::trajectory::State;
    use glam::DVec3;
    use std::f64::consts::TAU;

    /// An oscillation with a period of a second, in pieces of a second: mean velocities by Simpson's rule are wrong by
    /// the same amount in each, but not in shorter intervals.
    #[test]
    fn oscillations_in_step_with_the_knots_are_no_error() {
        let knots: Vec<f64> = (0..256).map(f64::from).collect();
        let oscillation = |time: f64| {
            let (sin, cos) = (TAU * time).sin_cos();
            Ok(State::new(time, sin * DVec3::X, TAU * cos * DVec3::X))
        };
        assert_eq!(check_velocity(&knots, (0.1, 4.0), oscillation), Ok(()));
        let rest = |time: f64| Ok(State::new(time, DVec3::ONE, 2.0 * DVec3::Z));
        let refused = check_velocity(&knots, (0.1, 4.0), rest);
        let expected = Error::FitVelocity {
            time: 254.0 + SHARES[2] + 0.5 * SHORT,
            quantity: Quantity::Velocity(2),
            told: 2.0,
            found: 0.0,
        };
        assert_eq!(refused, Err(expected));
    }
}
