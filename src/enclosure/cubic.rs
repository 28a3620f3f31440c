//! Cubics with an error bound, and certified facts about their distance from the origin.

use crate::real::Real;
use glam::DVec3;

/// A cubic with a bound on its distance from the exact relative motion.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::internals::enclosure::{Threshold, UncertainCubic, Verdict};
///
/// // Straight past the origin, 3 m off; the exact motion is within a nanometre of that.
/// let cubic = UncertainCubic::new([-6.0, -2.0, 2.0, 6.0].map(|x| DVec3::new(x, 3.0, 0.0)), 1e-9)?;
/// let least = cubic.least_distance().distance;
/// assert!(least.low <= 3.0 && 3.0 <= least.high && least.high - least.low < 3e-9);
///
/// let stretches = cubic.stretches(Threshold { low: 5.0, high: 5.0 });
/// let sides = stretches.as_slice().iter().map(|stretch| stretch.side);
/// use Verdict::{Inside, Outside, Undecided};
/// assert!(sides.eq([Outside, Undecided, Inside, Undecided, Outside]));
/// # Ok::<(), nearmiss::internals::enclosure::OutOfRange>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainCubic {
    pub(super) points: [DVec3; 4],
    pub(super) error: f64,
}

impl UncertainCubic {
    /// Returns the cubic with these Bézier control points (m) on 0..=1; the exact cubic is nowhere
    /// farther than `error` (m) from it.
    ///
    /// # Errors
    ///
    /// [`OutOfRange`] for numbers that are not finite or beyond 1e300, or a negative error.
    pub fn new(points: [DVec3; 4], error: f64) -> Result<Self, OutOfRange> {
        if is_in_range(&points, error, 1e300) {
            Ok(Self { points, error })
        } else {
            Err(OutOfRange)
        }
    }

    /// Returns a cubic with finite control points, possibly beyond 1e300.
    pub(crate) fn finite(points: [DVec3; 4], error: f64) -> Self {
        debug_assert!(is_in_range(&points, error, f64::MAX), "finite numbers");
        Self { points, error }
    }
}

fn is_in_range(points: &[DVec3; 4], error: f64, largest: f64) -> bool {
    let is_served = |p: &DVec3| p.abs().max_element() <= largest && !p.is_nan();
    points.iter().all(is_served) && (0.0..=largest).contains(&error)
}

/// Error: a number of the input is not finite or beyond 1e300, or the error is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a control point or its error is not finite, negative or beyond 1e300")]
pub struct OutOfRange;

/// An interval `low..=high` that contains the exact distance (m, both finite and not negative).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceEnclosure {
    /// Lower end, m.
    pub low: f64,
    /// Upper end, m.
    pub high: f64,
}

/// An interval `first..=last` within 0..=1 (local parameter) that contains every exact answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterEnclosure {
    /// Lower end.
    pub first: f64,
    /// Upper end.
    pub last: f64,
}

/// An interval `low..=high` (m) that contains the exact threshold. If it is negative, nothing is
/// inside. If its ends are in the wrong order or not numbers, nothing is certain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Lower end, m.
    pub low: f64,
    /// Upper end, m.
    pub high: f64,
}

/// The certain relation of a distance to a threshold, or to an inner and an outer one.
///
/// The distance is the least one of a pair of bodies during a span, or the distance at every
/// instant of a [`Stretch`], its ends included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Certainly farther than the (outer) threshold.
    Outside,
    /// Certainly nearer than the (inner) threshold.
    Inside,
    /// Hidden by rounding, between the thresholds, or left open by a work limit.
    #[default]
    Undecided,
}

/// A part of 0..=1 with one relation to the threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Lower end (local parameter).
    pub first: f64,
    /// Upper end (local parameter).
    pub last: f64,
    /// Relation of the distance to the threshold, at every instant.
    pub side: Verdict,
}

/// The way a search ended; the answer is certified in both cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// The enclosure is as tight as the error of its input allows.
    Tight,
    /// The work limit was reached; the enclosure holds, but could be narrower.
    Limited,
}

/// The certified least distance of a cubic from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastDistance {
    /// The least distance.
    pub distance: DistanceEnclosure,
    /// All parameters at which it can be attained.
    pub parameter: ParameterEnclosure,
    /// The parameter with the least distance found; within 0..=1.
    pub guess: f64,
    /// The way the search ended.
    pub effort: Effort,
}

impl ParameterEnclosure {
    pub(super) const WHOLE: Self = Self {
        first: 0.0,
        last: 1.0,
    };

    pub(super) fn hull(self, other: Self) -> Self {
        Self {
            first: self.first.min_or_other(other.first),
            last: self.last.max_or_other(other.last),
        }
    }
}
