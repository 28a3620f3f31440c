//! The choice between rounded and proven answers, and the record of a proof.

/// How much an answer promises, and what that costs.
///
/// # What each setting promises
///
/// | | promise | cost |
/// |---|---|---|
/// | [`Exact`](Self::Exact) | f64, good to a few roundings of the local scale; not certified | 1 |
/// | [`Certified`](Self::Certified) | proven enclosures of separation, enter, exit and closest approach; what f64 cannot decide is marked | 1.0 to 1.4 |
///
/// Costs: `screen --accuracy A --threads 1 --stats json`, `screen_ms` over that of `exact`, medians of
/// nine runs (of the largest, five) on seven sets of real trajectories. Finding candidates takes the most of
/// it, and is the same for both.
///
/// The local scale L of two segments is the distance of their origins plus their extents; neither
/// the absolute position nor the absolute time enters.
///
/// # Why no stage can lose a conflict
///
/// u is 2^-53. The truth is the motion in real arithmetic through the numbers given.
///
/// | stage | what it may do wrong | why nothing is lost |
/// |---|---|---|
/// | states → segment | the Bézier points, relative to the first state's own position, are off by at most 4 u of the segment's extent; that bound stays with the segment (polynomials in absolute time: one rounding of the position, 2^-100 of all that is added up) | every later bound contains it |
/// | beyond the knots | position, velocity and the two other coefficients around the knot are those of the numbers given, or rounded once from exact sums: 32 u of each term, so in proportion to the way | the same |
/// | window | it clips answers, it never cuts what is solved | two exact comparisons |
/// | boxes | f32, relative to the middle of the scene and in a power of two that suits its size, so that no range overflows | enlarged by all roundings of f32, next to whose spare ones what filters keep clear is nothing; they contain hitbox and half the margin |
/// | candidates | the sweep maps boxes to 16 bits by a monotone rounding, clamped at the ends; the tree compares them as they are | overlap is only ever added; every method is tested against brute force |
/// | courses | f32, the straight line that a body nearly follows through a slice | its slack holds the cubic's largest distance from the line, all roundings, hitbox and half the margin |
/// | sketches | f32, both bodies' cubics over a part of a span | the same roundings, and those of the relative motion, are added to the radius |
/// | cheap tests | f64 hulls, a separating direction, Bernstein coefficients of the squared distance, wrong by at most 100 u L | they reject only what is beyond the threshold by 512 u L (control heights that the solver looks at itself: by its own rounding once more) |
/// | clusters | the bounding sphere is tested first | its radius is rounded outward; then the pairs of spheres that bounds cannot rule out are solved, and the results united |
/// | relative cubic | restriction to the span and difference: a bound on its error is computed with it | handed to the solver |
/// | threshold | radii and margin are summed exactly | `Certified` takes the two neighbours of the rounded sum where it had to be rounded |
/// | solver | `Exact` counts as contact what comes within its worst-case rounding of the threshold | `Certified` proves each part of a span inside or outside (`src/enclosure`); what is neither is reported, and what it separates is joined, as unresolved |
/// | times | the local parameter is exact, its instant is rounded | outward in `Certified`; knots are met exactly |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Accuracy {
    /// f64, good to a few roundings of the local scale, not certified. What comes within the
    /// worst case of that rounding of the margin is reported, so a touch is never lost.
    #[default]
    Exact,
    /// Every conflict carries a [`Certificate`]: enclosures of its separation and of its times,
    /// proven against the exact real-arithmetic motion through the given numbers. What is
    /// certainly outside is not reported; what f64 cannot decide is, marked as unresolved.
    Certified,
}

/// The exact instant lies in `earliest..=latest` (s).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TimeEnclosure {
    /// Not before this, s.
    pub earliest: f64,
    /// Not after this, s.
    pub latest: f64,
}

/// What is proven of a conflict, as worst cases over all rounding on the way.
///
/// The truth is the motion in real arithmetic through the `f64` states (or of the `f64`
/// polynomials) given, with the exact sum of radii and margin. The proof is in
/// `src/enclosure`.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Accuracy, Body, Query, Scene, State, Trajectory};
///
/// let mut scene = Scene::new();
/// for velocity in [DVec3::X, DVec3::Y] {
///     // They cross at 0 s.
///     let states = [-9.0, 9.0].map(|t| State::new(t, t * velocity, velocity));
///     scene.insert(Body::new(Trajectory::from_states(&states)?))?;
/// }
/// let query = Query::default().with_margin(2.0).with_accuracy(Accuracy::Certified);
/// let conflict = scene.screen(&query)?.conflicts[0];
/// assert!(conflict.certificate.is_some_and(|proof| {
///     // A proof to the last digits: it is one conflict, and contains the instant 0 s.
///     proof.resolved
///         && proof.error < 1e-13
///         && proof.closest.earliest <= 0.0
///         && 0.0 <= proof.closest.latest
///         && proof.enter.latest - proof.enter.earliest < 1e-13
/// }));
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Certificate {
    /// The least separation within the conflict lies in `closest.separation ± error` (m).
    pub error: f64,
    /// Whether the pair is certainly within the margin at some instant, and all the time between
    /// `enter.latest` and `exit.earliest`: one conflict. (Within the enclosures of enter and exit it may cross
    /// the margin more than once.) If not, either the pair comes so near the margin that f64 cannot
    /// tell whether it is reached, or so near it in between, or for so short a time beyond it, that f64
    /// cannot tell whether these are several conflicts.
    pub resolved: bool,
    /// When it begins.
    pub enter: TimeEnclosure,
    /// When it ends.
    pub exit: TimeEnclosure,
    /// When the separation is least; all such instants where there are several.
    pub closest: TimeEnclosure,
}

impl TimeEnclosure {
    /// The instant within the enclosure that is nearest to `time`.
    pub(crate) fn nearest(self, time: f64) -> f64 {
        time.max(self.earliest).min(self.latest)
    }

    /// The smallest enclosure of both.
    pub(crate) fn hull(self, other: Self) -> Self {
        Self {
            earliest: self.earliest.min(other.earliest),
            latest: self.latest.max(other.latest),
        }
    }
}
