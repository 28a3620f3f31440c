//! Certified enclosures.

mod crossings;
mod guess;
mod levels;
mod meeting;
mod minimum;
mod normal;
mod piece;
mod stretches;

pub use stretches::Stretches;

use glam::DVec3;

/// A relative cubic known up to an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainCubic {
    points: [DVec3; 4],
    error: f64,
}

/// A number of the input is not finite or beyond 1e300.
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

/// The exact threshold lies in `low..=high` (m); it may be negative, and then nothing is inside.
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
    const WHOLE: Self = Self {
        first: 0.0,
        last: 1.0,
    };
}

impl UncertainCubic {
    /// The cubic with these Bezier control points (m) on 0..=1, of which the exact cubic is
    /// nowhere farther than `error` (m).
    ///
    /// # Errors
    ///
    /// [`OutOfRange`] for what is not finite, beyond 1e300, or a negative error.
    pub fn new(points: [DVec3; 4], error: f64) -> Result<Self, OutOfRange> {
        const LARGEST: f64 = 1e300;
        let is_in_range = |p: &DVec3| p.abs().max_element() <= LARGEST && !p.is_nan();
        if points.iter().all(is_in_range) && (0.0..=LARGEST).contains(&error) {
            Ok(Self { points, error })
        } else {
            Err(OutOfRange)
        }
    }

    /// The least distance from the origin.
    #[must_use]
    pub fn least_distance(&self) -> LeastDistance {
        minimum::least_distance(self)
    }

    /// The distance from the origin at a parameter in 0..=1.
    ///
    /// # Panics
    ///
    /// In debug builds, for a parameter outside 0..=1.
    #[must_use]
    pub fn distance_at(&self, parameter: f64) -> DistanceEnclosure {
        debug_assert!((0.0..=1.0).contains(&parameter), "a parameter within 0..=1");
        minimum::distance_at(self, parameter)
    }

    /// Where the distance is certainly below the threshold, where certainly above, and where that
    /// cannot be told: a partition of 0..=1.
    #[must_use]
    pub fn stretches(&self, threshold: Threshold) -> Stretches {
        crossings::stretches(self, threshold)
    }
}
