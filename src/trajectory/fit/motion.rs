//! Functions of time, approximated by cubics.

use super::Fit;
use super::options::FitOptions;
use super::place::{Approximated, PieceError, checked_tolerance, place_knots};
use super::velocity::check_velocity;
use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::rounding::{UNDERFLOW, UNIT_ROUNDOFF, norm};
use crate::trajectory::{Segment, State, Trajectory};
use crate::window::Window;
use glam::DVec3;

/// Factor between the largest deviation seen and the error that is reported.
const SAFETY: f64 = 1.25;

/// Least error that is reported, in units of the rounding. Within a smaller tolerance chance would place the knots:
/// deviations would have to be smaller than the rounding that is seen with them.
const LEAST: f64 = 2.5;

/// Shares of a piece at which a motion is examined first. They are uneven, so that no oscillation looks the same at
/// all of them. A smooth motion deviates most in the middle.
const SHARES: [f64; 11] = [0.5, 0.03, 0.11, 0.2, 0.29, 0.4, 0.61, 0.7, 0.81, 0.88, 0.97];

/// Distance from the place of the largest deviation at which it is looked for once more, on both sides.
const EXTRA: f64 = 0.035;

/// Least number of instants at which a motion is examined over the whole window.
const INSTANTS: f64 = 1024.0;

/// Least time between two instants, s.
const LEAST_STEP: f64 = f64::from_bits(1);

/// Fractional part of the golden ratio: its multiples fill an interval evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Number of equal parts of the window at whose ends rounding is compared with the tolerance before anything else.
const PARTS: u8 = 64;

impl Trajectory {
    /// Approximates a motion over a window by cubics, with knots where it needs them. `motion` returns position and
    /// velocity (m, m/s) at a time of the window (s). The error of the result is at most `tolerance` (m).
    ///
    /// That error is an estimate: 1.25 times the largest deviation seen, and rounding. Each piece is
    /// examined at thirteen instants or more, and the window at 1024 or more, evenly spread. An event shorter than a
    /// 300th of the window can pass unseen, if it ends where the motion would have been without it.
    /// [`fit_with`](Self::fit_with) proves the error, if the fourth derivative is bounded.
    ///
    /// Positions may have jumps in acceleration, and in velocity. The velocity must be the derivative of the
    /// position: otherwise the fit needs very many knots. From 256 knots on it compares the two wherever their number
    /// has doubled, and fails if their difference makes the last eight pieces short. With fewer knots such a motion is
    /// fitted, and the error covers it.
    ///
    /// A tolerance ten thousand times smaller needs ten times as many knots; see [`Fit::knot_count`]. No smaller one
    /// than 2.5e-15 of the distance from the origin can be reached, such as 18 nm at 7000 km: values of the motion are
    /// taken to be rounded by [4 units of the last place](FitOptions::with_ulps).
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Body, Trajectory, Window};
    ///
    /// // A circle of 100 m at 20 m/s, for a minute, to a centimetre.
    /// let circle = |time: f64| {
    ///     let (sin, cos) = (0.2 * time).sin_cos();
    ///     (DVec3::new(100.0 * cos, 100.0 * sin, 0.0), DVec3::new(-20.0 * sin, 20.0 * cos, 0.0))
    /// };
    /// let fit = Trajectory::fit(circle, Window::new(0.0, 60.0)?, 0.01)?;
    /// assert!(fit.error() <= 0.01 && fit.knot_count() < 40);
    ///
    /// // Answers about this body cover the circle, as far as the estimated error holds.
    /// let body = Body::new(fit.trajectory.clone()).with_model_error(fit.error())?;
    /// # assert_eq!(body.model_error(), fit.error());
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::FitTolerance`]; [`Error::FitWindow`]; [`Error::Motion`] where the motion has no usable value;
    /// [`Error::FitUnreachable`] where the tolerance is too near the rounding, or the position jumps;
    /// [`Error::FitVelocity`] where the velocity is not the derivative of the position; [`Error::FitKnots`] where the
    /// motion needs more than a million knots.
    #[doc(alias = "approximate")]
    #[doc(alias = "sample")]
    pub fn fit<P: Into<DVec3>, V: Into<DVec3>>(
        motion: impl FnMut(f64) -> (P, V),
        window: Window,
        tolerance: f64,
    ) -> Result<Fit, Error> {
        Self::fit_with(motion, window, tolerance, &FitOptions::default())
    }

    /// Approximates a motion like [`fit`](Self::fit), with options. With a
    /// [bound of the fourth derivative](FitOptions::with_fourth_derivative) M the error is proven.
    ///
    /// The proven error is M h⁴/384 for the longest time h between knots, the rounding of the motion's values, and
    /// that of the cubics. One bound for the whole window makes the knots evenly spaced.
    /// [A bound for each window](FitOptions::with_fourth_derivative_over) puts them where the motion bends. The middle
    /// of each piece is examined: a motion that contradicts its bound there is refused.
    ///
    /// ```
    /// use nearmiss::{FitOptions, Trajectory, Window};
    ///
    /// // An oscillation of 1 m at 1 rad/s: no derivative exceeds 1.
    /// let motion = |time: f64| ([time.sin(), 0.0, 0.0], [time.cos(), 0.0, 0.0]);
    /// let bounded = FitOptions::default().with_fourth_derivative(1.0);
    /// let fit = Trajectory::fit_with(motion, Window::new(0.0, 10.0)?, 1e-3, &bounded)?;
    /// assert!(fit.is_proven() && fit.error() <= 1e-3);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`fit`](Self::fit); [`Error::FitOption`]; [`Error::FitBound`] if the motion contradicts the bound.
    pub fn fit_with<P: Into<DVec3>, V: Into<DVec3>>(
        motion: impl FnMut(f64) -> (P, V),
        window: Window,
        tolerance: f64,
        options: &FitOptions<'_>,
    ) -> Result<Fit, Error> {
        let tolerance = checked_tolerance(tolerance)?;
        let options = options.checked()?;
        let ends = [window.start(), window.end()];
        if ends[0] >= ends[1] || ends.iter().any(|end| end.abs() > MAX_MAGNITUDE) {
            let [start, end] = ends;
            return Err(Error::FitWindow { start, end });
        }
        let mut examined = Examined {
            motion,
            tolerance,
            ulps: options.ulps,
            interval: ((ends[1] - ends[0]) / INSTANTS).max(LEAST_STEP),
            known: [None; 2],
        };
        let (max_knots, is_proven) = (options.max_knots, options.fourth_derivative.is_some());
        examined.check_rounding(ends, if is_proven { 1.0 } else { LEAST })?;
        let placed = match options.fourth_derivative {
            Some(bound) => place_knots(ends, tolerance, max_knots, |from, to| {
                let remainder = bound.remainder(from, to)?;
                let piece = examined.piece(from, to)?;
                let error =
                    |piece: FittedPiece| PieceError::of(remainder, piece.rounding, tolerance);
                Ok(piece.map_or(PieceError::UNKNOWN, error))
            }),
            None => place_knots(ends, tolerance, max_knots, &mut examined),
        }?;
        if let Some(bound) = options.fourth_derivative {
            for pair in placed.knots.windows(2) {
                examined.check(pair[0], pair[1], bound.remainder(pair[0], pair[1])?)?;
            }
        }
        let states = placed.knots.iter().map(|&time| examined.state(time));
        let trajectory = Self::from_states(&states.collect::<Result<Vec<_>, _>>()?)?;
        Ok(Fit {
            trajectory,
            error: placed.error,
            is_proven,
        })
    }
}

/// A cubic between two states of a motion.
struct FittedPiece {
    segment: Segment,
    /// Largest distance (m) between positions of the trajectory and of the motion that follows from rounding alone.
    rounding: f64,
}

impl FittedPiece {
    /// Returns the cubic between two states, or `None` if it leaves the range of f64. Values of the motion are good
    /// to `ulps`.
    fn between(first: &State, second: &State, ulps: f64) -> Option<Self> {
        let segment = Segment::hermite(first, second, 0).ok()?;
        let duration = second.time - first.time;
        let distance = norm(first.position) + segment.extent();
        let speed = norm(first.velocity).max(norm(second.velocity));
        // The weights of the positions add up to 1, those of the velocities to a quarter of the duration.
        let of_velocities = ulps * f64::EPSILON * duration * speed / 4.0;
        let of_cubic = segment.error() + Segment::EVALUATION * segment.extent() + UNDERFLOW;
        let rounding = rounding_at(distance, ulps) + of_velocities + of_cubic;
        Some(Self { segment, rounding })
    }
}

/// Returns the rounding (m) of a motion's position, good to `ulps`, and of the trajectory's at a distance (m) from the
/// origin.
fn rounding_at(distance: f64, ulps: f64) -> f64 {
    (ulps * f64::EPSILON + UNIT_ROUNDOFF) * distance
}

/// A motion under examination.
struct Examined<F> {
    motion: F,
    /// Tolerance, m.
    tolerance: f64,
    /// Rounding of the motion's values, in units of the last place.
    ulps: f64,
    /// Longest time between instants of the examination, s.
    interval: f64,
    /// The last two states that began and ended a piece.
    known: [Option<State>; 2],
}

impl<P: Into<DVec3>, V: Into<DVec3>, F: FnMut(f64) -> (P, V)> Examined<F> {
    /// Returns the state at a time.
    fn state(&mut self, time: f64) -> Result<State, Error> {
        let (position, velocity) = (self.motion)(time);
        let state = State::new(time, position, velocity);
        for axis in 0..3 {
            for (quantity, value) in [
                (Quantity::Position(axis), state.position[axis]),
                (Quantity::Velocity(axis), state.velocity[axis]),
            ] {
                if value.is_nan() || value.abs() > MAX_MAGNITUDE {
                    return Err(Error::Motion {
                        time,
                        quantity,
                        value,
                    });
                }
            }
        }
        Ok(state)
    }

    /// Returns an error where rounding alone, times `least`, exceeds the tolerance: no piece there can be within it.
    /// It is looked at before any knot is placed.
    fn check_rounding(&mut self, [start, end]: [f64; 2], least: f64) -> Result<(), Error> {
        for part in 0..=PARTS {
            let time = start + (end - start) * (f64::from(part) / f64::from(PARTS));
            let time = time.clamp(start, end);
            let distance = norm(self.state(time)?.position);
            let reached = least * rounding_at(distance, self.ulps);
            if reached > self.tolerance {
                return Err(Error::FitUnreachable {
                    time,
                    tolerance: self.tolerance,
                    reached,
                });
            }
        }
        Ok(())
    }

    /// Returns the cubic between two instants, or `None` if it leaves the range of f64.
    fn piece(&mut self, from: f64, to: f64) -> Result<Option<FittedPiece>, Error> {
        let mut ends = [State::default(); 2];
        for (time, end) in [from, to].into_iter().zip(&mut ends) {
            let mut known = self.known.into_iter().flatten();
            let found = known.find(|state| state.time.to_bits() == time.to_bits());
            *end = match found {
                Some(state) => state,
                None => self.state(time)?,
            };
        }
        self.known = ends.map(Some);
        Ok(FittedPiece::between(&ends[0], &ends[1], self.ulps))
    }

    /// Returns the distance between a cubic and the motion at a share of its duration (m).
    fn deviation(&mut self, piece: &FittedPiece, share: f64) -> Result<(f64, f64), Error> {
        let (start, end) = (piece.segment.start(), piece.segment.end());
        let time = (start + share * (end - start)).clamp(start, end);
        let position = self.state(time)?.position;
        Ok((norm(piece.segment.motion_at(time).0 - position), share))
    }

    /// Returns an estimate of the error between two instants.
    fn estimate(&mut self, from: f64, to: f64) -> Result<PieceError, Error> {
        let Some(piece) = self.piece(from, to)? else {
            return Ok(PieceError::UNKNOWN);
        };
        let mut largest = (0.0, 0.5);
        let larger = |a: (f64, f64), b: (f64, f64)| if b.0 > a.0 { b } else { a };
        for share in SHARES {
            largest = larger(largest, self.deviation(&piece, share)?);
        }
        let tolerance = self.tolerance;
        // Values seen and not seen may be off in opposite directions. What is seen contains rounding already.
        let rest = (2.0 - SAFETY) * piece.rounding;
        let error = |seen: f64| {
            let PieceError { metres, share } = PieceError::of(SAFETY * seen, rest, tolerance);
            let metres = metres.max(LEAST * piece.rounding);
            PieceError { metres, share }
        };
        let is_within = |seen: f64| error(seen).metres <= tolerance;
        if !is_within(largest.0) {
            return Ok(error(largest.0));
        }
        let mut place = GOLDEN;
        let mut covered = self.interval;
        while covered < to - from && is_within(largest.0) {
            largest = larger(largest, self.deviation(&piece, place)?);
            place = (place + GOLDEN).fract();
            covered += self.interval;
        }
        for share in [largest.1 - EXTRA, largest.1 + EXTRA] {
            largest = larger(largest, self.deviation(&piece, share)?);
        }
        Ok(error(largest.0))
    }

    /// Returns an error if the motion is farther from its cubic, in the middle of a piece, than the bound of its
    /// fourth derivative allows (m).
    fn check(&mut self, from: f64, to: f64, remainder: f64) -> Result<(), Error> {
        let Some(piece) = self.piece(from, to)? else {
            return Ok(());
        };
        let deviation = self.deviation(&piece, 0.5)?.0;
        // The value in the middle is rounded, too.
        let bound = PieceError::of(remainder, 2.0 * piece.rounding, self.tolerance).metres;
        if deviation > bound {
            return Err(Error::FitBound {
                time: from + 0.5 * (to - from),
                deviation,
                bound,
            });
        }
        Ok(())
    }
}

/// The error of a piece is the estimate.
impl<P: Into<DVec3>, V: Into<DVec3>, F: FnMut(f64) -> (P, V)> Approximated for &mut Examined<F> {
    fn error(&mut self, from: f64, to: f64) -> Result<PieceError, Error> {
        self.estimate(from, to)
    }

    fn examine(&mut self, knots: &[f64]) -> Result<(), Error> {
        check_velocity(knots, (self.tolerance, self.ulps), |time| self.state(time))
    }
}
