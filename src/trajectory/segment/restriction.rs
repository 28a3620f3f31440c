//! Parts of a segment: control points between two instants, inside its knots and beyond, their rounding and their limits.

use super::Segment;
use crate::blossom::restrict_to;
use crate::error::{Error, MAX_MAGNITUDE, Quantity};
use crate::rounding::{UNDERFLOW, UNIT_ROUNDOFF, norm};
use glam::DVec3;

/// Control points of a part of a segment relative to the segment's origin (m), and their error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Restriction {
    pub(crate) points: [DVec3; 4],
    /// Bound on the error of each point, m, without that of the origin.
    pub(crate) error: f64,
}

impl Segment {
    /// Returns the control points of the part over `from..to`, relative to the segment's origin.
    ///
    /// Inside the knots: blossoming with weights of sum one. Beyond them (`Extrapolate`, `Coast`):
    /// power form around the first knot. `from == to` gives one point four times.
    #[inline]
    pub(crate) fn restrict(&self, from: f64, to: f64) -> Restriction {
        if from <= self.start && to >= self.end && from >= self.start && to <= self.end {
            return Restriction {
                points: self.control_points(),
                error: self.error() + UNIT_ROUNDOFF * self.extent + UNDERFLOW,
            };
        }
        self.restrict_part(from, to)
    }

    /// Restricts to an interval other than the whole segment.
    fn restrict_part(&self, from: f64, to: f64) -> Restriction {
        if self.is_straight() {
            self.restrict_straight(from, to)
        } else if self.covers(from, to) {
            self.restrict_inside(from, to)
        } else {
            self.restrict_beyond(from, to)
        }
    }

    #[inline(always)]
    fn restrict_straight(&self, from: f64, to: f64) -> Restriction {
        let duration = self.end - self.start;
        let (a, b) = ((from - self.start) / duration, (to - self.start) / duration);
        let linear = 3.0 * self.control_points[0];
        let durations = a.abs().max(b.abs());
        let size = self.extent * durations;
        Restriction {
            points: [a + a + a, a + a + b, a + b + b, b + b + b].map(|sum| linear * (sum / 3.0)),
            // The error of any cubic: the extent is the length of the linear coefficient.
            error: self.grown_error(durations, size) + 12.0 * UNIT_ROUNDOFF * size + UNDERFLOW,
        }
    }

    fn restrict_inside(&self, from: f64, to: f64) -> Restriction {
        let ends = (self.start, self.end);
        Restriction {
            points: restrict_to(&self.control_points(), ends, (from, to)),
            // Three steps of lerps with relative weight errors: γ5 each (γn: n roundings).
            error: self.error() + 16.0 * UNIT_ROUNDOFF * self.extent + UNDERFLOW,
        }
    }

    fn restrict_beyond(&self, from: f64, to: f64) -> Restriction {
        let duration = self.end - self.start;
        let (a, b) = ((from - self.start) / duration, (to - self.start) / duration);
        let [linear, quadratic, cubic] = self.powers();
        // The blossom of c1 s + c2 s² + c3 s³ at (x, y, z).
        let at = |x: f64, y: f64, z: f64| {
            linear * ((x + y + z) / 3.0)
                + quadratic * ((x * y + y * z + z * x) / 3.0)
                + cubic * (x * y * z)
        };
        let durations = a.abs().max(b.abs());
        let size = norm(linear) * durations
            + norm(quadratic) * durations * durations
            + norm(cubic) * durations * durations * durations;
        Restriction {
            points: [at(a, a, a), at(a, a, b), at(a, b, b), at(b, b, b)],
            // The blossom: at most 12 roundings of each term.
            error: self.grown_error(durations, size) + 12.0 * UNIT_ROUNDOFF * size + UNDERFLOW,
        }
    }

    /// Returns the size to which all rounding of the part between `from` and `to` is relative, m.
    /// It bounds the terms of the power form. It is larger where the segment's own error exceeds a
    /// few roundings of its extent, as for polynomials in absolute time far from the origin.
    pub(crate) fn rounding_scale(&self, from: f64, to: f64) -> f64 {
        let (size, error) = if self.covers(from, to) {
            (self.extent, self.error())
        } else {
            let durations = self.durations_to(from, to);
            let size = if self.is_curved() {
                let [linear, quadratic, cubic] = self.powers().map(|c| c.abs().element_sum());
                durations * (linear + durations * (quadratic + durations * cubic))
            } else if self.is_power_form() {
                self.extent * durations.max(1.0)
            } else {
                self.extent * (1.0 + 2.0 * durations).powi(3)
            };
            (size, self.grown_error(durations, size))
        };
        size + error / (16.0 * UNIT_ROUNDOFF)
    }

    /// Returns the distance that an interval reaches from the start, in durations of the segment.
    pub(crate) fn durations_to(&self, from: f64, to: f64) -> f64 {
        let duration = self.end - self.start;
        ((from - self.start).abs().max((to - self.start).abs())) / duration
    }

    /// Returns a bound on the segment's own error within `durations` durations of its start, m;
    /// `size` (m) bounds the terms of its power form there.
    ///
    /// In [power form](Self::is_power_form) each coefficient's error is proportional to itself: see
    /// [`end_cubic`](mod@crate::trajectory::end_cubic). Otherwise a control point's error (its own, and at most 4
    /// roundings of the extent from forming the power coefficients) grows like the sum of the
    /// Bernstein weights: (1 + 2 durations)³.
    fn grown_error(&self, durations: f64, size: f64) -> f64 {
        let growth = 1.0 + 2.0 * durations;
        if !self.is_power_form() {
            let points = self.error + 4.0 * UNIT_ROUNDOFF * self.extent + UNDERFLOW;
            points * growth.powi(3)
        } else if self.error() > 0.0 {
            let (rounding_growth, growth) = if self.is_curved() {
                (1.0 + 64.0 * UNIT_ROUNDOFF * durations, growth.powi(3))
            } else {
                (1.0, growth)
            };
            self.error()
                + 20.0 * UNIT_ROUNDOFF * size * rounding_growth * rounding_growth
                + UNDERFLOW * growth
        } else {
            0.0
        }
    }

    /// Checks that the cubic can be followed between two instants (s) beyond knot number `knot`.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`], [`Error::TooFar`].
    pub(in crate::trajectory) fn check_followable(
        &self,
        (from, to): (f64, f64),
        knot: usize,
    ) -> Result<(), Error> {
        /// Largest distance in time, in segment durations: its third power must stay in range.
        const MAX_DURATIONS: f64 = 1e100;
        /// Upper bound of cut times, s: the last cut may lie some times farther than the window's end.
        const FARTHEST: f64 = 10.0 * MAX_MAGNITUDE;
        let farthest = from.abs().max(to.abs());
        if self.durations_to(from, to) > MAX_DURATIONS || farthest > FARTHEST {
            let far = (from - self.start).abs() > (to - self.start).abs();
            let time = if far { from } else { to };
            return Err(Error::TooFar { knot, time });
        }
        // Its rounding grows as well.
        let scale = self.rounding_scale(from, to);
        if scale.is_nan() || scale > MAX_MAGNITUDE {
            return Err(Error::OutOfRange {
                knot,
                quantity: Quantity::Distance,
                value: scale,
            });
        }
        Ok(())
    }
}
