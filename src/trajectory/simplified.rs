//! Fewer cubics for the same motion, within a proven distance.
//!
//! A run of cubics becomes one: the Hermite cubic with the position and velocity at which the run begins and ends. On
//! each cubic of the run the difference of both is a cubic again, and nowhere larger than its largest Bézier point.
//! Both are restricted to that interval; the bounds of their errors, and the roundings of the difference, are added.

use super::fit::{Fit, checked_tolerance};
use super::{Segment, State, Trajectory};
use crate::error::Error;
use crate::rounding::{UNIT_ROUNDOFF, norm};

impl Trajectory {
    /// Returns this motion with fewer cubics, proven to stay within `tolerance` (m) of it at every time.
    ///
    /// Consecutive cubics are merged into one, which has position and velocity of this motion where it begins and
    /// ends. The knots that are left are some of the present ones, with the first and the last. Cubics that are not
    /// merged keep their bits. Jumps of the velocity stay where they matter: they are merged over only within the
    /// tolerance. The motion before the first and after the last knot stays the same, by the same rule.
    ///
    /// Knots are chosen one after another, each run as long as repeated doubling and halving find it. So there may be
    /// a plan of fewer cubics. A body at rest, or one that only coasts, is returned as it is.
    ///
    /// [`Fit::error`] is the largest distance that the proof leaves, at most `tolerance`; 0 if nothing was merged. It
    /// holds between the exact cubics: of this trajectory, with the rounding of its construction, and of the returned
    /// one.
    ///
    /// ```
    /// use nearmiss::{Body, State, Trajectory};
    ///
    /// // A circle of 100 m, told ten times a second for a minute.
    /// let state = |step: u16| {
    ///     let time = f64::from(step) / 10.0;
    ///     let (sin, cos) = (time / 10.0).sin_cos();
    ///     State::new(time, [100.0 * cos, 100.0 * sin, 0.0], [-10.0 * sin, 10.0 * cos, 0.0])
    /// };
    /// let told = Trajectory::from_states(&(0..=600).map(state).collect::<Vec<_>>())?;
    /// let simple = told.simplified(0.01)?;
    /// assert!(simple.trajectory.segments().len() < 20);
    /// assert!(simple.error() <= 0.01 && simple.is_proven());
    /// let error = simple.error();
    /// let body = Body::new(simple.trajectory).with_model_error(error)?;
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::FitTolerance`] if the tolerance is not a positive number up to 1e300.
    #[doc(alias("decimate", "reduce", "resample", "compress"))]
    pub fn simplified(&self, tolerance: f64) -> Result<Fit, Error> {
        let tolerance = checked_tolerance(tolerance)?;
        let (own_knots, own) = (self.knots(), self.segments());
        let mut knots = Vec::new();
        let mut segments = Vec::new();
        let mut error = 0.0_f64;
        let mut first = 0;
        while first < own.len() {
            let (count, merged) = longest_run(&own[first..], &own_knots[first..], tolerance);
            knots.push(own_knots[first]);
            let (segment, distance) = merged.unwrap_or((own[first], 0.0));
            segments.push(segment);
            error = error.max(distance);
            first += count;
        }
        if segments.len() == own.len() {
            return Ok(Fit::proven(self.clone(), 0.0));
        }
        knots.extend(own_knots.last());
        let ends = self.end_motions();
        let rules = [self.outside_before(), self.outside_after()];
        let simplified = Self::of_cubics(&knots, &segments, &ends, rules);
        Ok(Fit::proven(simplified, error))
    }
}

/// Returns the number of cubics at the front that are replaced by one; that one, and its distance from them
/// (m), if there are several. They are followed between the knots.
fn longest_run(
    segments: &[Segment],
    knots: &[f64],
    tolerance: f64,
) -> (usize, Option<(Segment, f64)>) {
    let merged = |count: usize| merged(&segments[..count], &knots[..=count], tolerance);
    let (mut count, mut best, mut step) = (1, None, 1);
    // The length of a run that is too long.
    let mut limit = segments.len() + 1;
    while count < segments.len() && limit > segments.len() {
        let tried = (count + step).min(segments.len());
        match merged(tried) {
            None => limit = tried,
            found => (count, best, step) = (tried, found, 2 * step),
        }
    }
    while limit - count > 1 {
        let tried = count + (limit - count) / 2;
        match merged(tried) {
            None => limit = tried,
            found => (count, best) = (tried, found),
        }
    }
    (count, best)
}

/// Returns one cubic for consecutive ones, and its distance from them (m), if that is within the tolerance.
fn merged(segments: &[Segment], knots: &[f64], tolerance: f64) -> Option<(Segment, f64)> {
    let ([first, .., last], [from, .., to]) = (segments, knots) else {
        return None;
    };
    let state = |segment: &Segment, time: f64| {
        let (position, velocity, _) = segment.motion_at(time);
        State::new(time, position, velocity)
    };
    let (begin, end) = (state(first, *from), state(last, *to));
    let is_finite = [begin, end]
        .iter()
        .all(|state| state.position.is_finite() && state.velocity.is_finite());
    if !is_finite {
        return None;
    }
    let segment = Segment::hermite(&begin, &end, 0).ok()?;
    let mut largest = 0.0_f64;
    for (other, ends) in segments.iter().zip(knots.windows(2)) {
        let distance = distance(&segment, other, (ends[0], ends[1]));
        // NaN is not within the tolerance.
        if distance.is_nan() || distance > tolerance {
            return None;
        }
        largest = largest.max(distance);
    }
    Some((segment, largest))
}

/// Returns a bound on the distance between two cubics over an interval (s), m.
fn distance(one: &Segment, other: &Segment, (from, to): (f64, f64)) -> f64 {
    let parts = [one, other].map(|segment| segment.restrict(from, to));
    let between = one.origin() - other.origin();
    let mut largest = 0.0_f64;
    for (a, b) in parts[0].points.into_iter().zip(parts[1].points) {
        // The difference of the origins is rounded, that of the points, and the sum.
        let rounding = 2.0 * UNIT_ROUNDOFF * (norm(between) + norm(a) + norm(b));
        largest = largest.max(norm(between + (a - b)) + rounding);
    }
    (largest + parts[0].error + parts[1].error) * (1.0 + 16.0 * UNIT_ROUNDOFF)
}

#[cfg(test)]
mod tests;
