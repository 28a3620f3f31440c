//! Cubics with an error, and what is certain about their distance from the origin.

use glam::DVec3;

/// A cubic from which the exact relative motion is nowhere farther than an error bound.
///
/// ```
/// use glam::DVec3;
/// use nearmiss::internals::enclosure::{Side, Threshold, UncertainCubic};
///
/// // Straight past the origin, 3 m off; the exact motion is within a nanometre of that.
/// let cubic = UncertainCubic::new([-6.0, -2.0, 2.0, 6.0].map(|x| DVec3::new(x, 3.0, 0.0)), 1e-9)?;
/// let least = cubic.least_distance().distance;
/// assert!(least.low <= 3.0 && 3.0 <= least.high && least.high - least.low < 3e-9);
///
/// let stretches = cubic.stretches(Threshold { low: 5.0, high: 5.0 });
/// let sides: Vec<Side> = stretches.as_slice().iter().map(|stretch| stretch.side).collect();
/// use Side::{Inside, Outside, Undecided};
/// assert_eq!(sides, [Outside, Undecided, Inside, Undecided, Outside]);
/// # Ok::<(), nearmiss::internals::enclosure::OutOfRange>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainCubic {
    pub(super) points: [DVec3; 4],
    pub(super) error: f64,
}

/// A number of the input is not finite or beyond 1e300, or the error is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a control point or its error is not finite, negative or beyond 1e300")]
pub struct OutOfRange;

/// The exact distance lies in `low..=high` (m, both finite and not negative).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceEnclosure {
    /// Lower end, m.
    pub low: f64,
    /// Upper end, m.
    pub high: f64,
}

/// Every exact answer lies in `first..=last`, a part of 0..=1 (local parameter).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterEnclosure {
    /// Lower end.
    pub first: f64,
    /// Upper end.
    pub last: f64,
}

/// The exact threshold lies in `low..=high` (m); it may be negative, and then nothing is inside. Nothing is
/// certain about ends in the wrong order, or that are no numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Lower end, m.
    pub low: f64,
    /// Upper end, m.
    pub high: f64,
}

/// What is certain about the distance over a stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Nearer than the threshold all over the stretch, its ends included.
    Inside,
    /// Farther than the threshold all over the stretch, its ends included.
    Outside,
    /// Within the error of the threshold, or left open by the work limit.
    Undecided,
}

/// A part of 0..=1 on which the same is certain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Where it begins.
    pub first: f64,
    /// Where it ends.
    pub last: f64,
    /// What is certain about it.
    pub side: Side,
}

/// Whether a search ended by itself or by its limit; the answer is certified in both cases.
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
    /// All parameters at which it can be reached.
    pub parameter: ParameterEnclosure,
    /// The parameter with the least distance found; within 0..=1.
    pub guess: f64,
    /// Whether the search came to its end.
    pub effort: Effort,
}

impl ParameterEnclosure {
    pub(super) const WHOLE: Self = Self {
        first: 0.0,
        last: 1.0,
    };
}
