//! The choice between rounded and certified answers, and certificates.

/// The guarantee of an answer, and its cost.
///
/// # Guarantees
///
/// | | promise | cost |
/// |---|---|---|
/// | [`Exact`](Self::Exact) | f64, good to a few roundings of the local scale; not certified | 1 |
/// | [`Certified`](Self::Certified) | proven enclosures of separation, enter, exit and closest approach; what cannot be decided is marked | sparse scenes 1.0 to 1.4, dense ones to 1.9, clusters that turn 1.7 to 2.5; near clusters with model errors, whose pairs of spheres within twice the error are all solved, 7 to 50 |
///
/// Both are about the splines through the numbers given. Where bodies have [model
/// errors](crate::Body::with_model_error), `Certified` is about the world: see [`Certificate`].
///
/// Costs, as the time of a screening on one thread over that of `Exact`:
///
/// - Seven sets of real trajectories: 1.0 to 1.4 (`screen --accuracy A --threads 1 --stats json`, `screen_ms`).
/// - 1,500 balls of 0.5 m, margin 0.5 m: 1.0 with one in 40^3 m, 1.3 in 10^3 m, 1.7 in 5^3 m, 1.9 in 3^3 m.
/// - 1,500 clusters of 8 spheres that turn, with the default tolerance: 1.7 with one in 40^3 m, 2.2 in 16^3 m, 2.5 in 8^3 m.
///
/// Finding the pairs is common to both. In sparse scenes that takes most of the time; in dense ones, and where clusters
/// turn, solving them does.
///
/// The local scale L of two segments is the distance of their origins, the positions where they begin, plus their extents. Neither
/// the absolute position nor the absolute time enters, but for polynomials in absolute time: their terms may be larger
/// than what they add up to. The cubic of a straight motion ([`coasting`](crate::Trajectory::coasting), or a state that is told)
/// counts as at least 6 s long: at 1e6 m/s its extent is 6e6 m.
///
/// # Why no stage can lose a conflict
///
/// u is 2^-53. The exact motion is the motion in real arithmetic through the numbers given.
///
/// | stage | what it may do wrong | why nothing is lost |
/// |---|---|---|
/// | states → segment | the Bézier points, relative to the first state's own position, are off by at most 4 u of the segment's extent; that bound stays with the segment (polynomials in absolute time: one rounding of the position, 2^-100 of all that is added up) | every later bound contains it |
/// | beyond the knots | position, velocity and the two other coefficients around the knot are those of the numbers given, or rounded once from exact sums: 32 u of each term, so in proportion to the way | the same |
/// | window | it clips answers, never the spans that are solved | two exact comparisons with instants that were rounded: `Exact` may miss a touch at the very end of a [window](crate::Window) |
/// | boxes | f32, relative to the middle of the scene and in a power of two that suits its size, so that no range overflows | inflated by all f32 rounding errors; the spare roundings exceed the filters' clearance by far; they contain hitbox and half the margin |
/// | candidates | the sweep maps boxes to 16 bits by a monotone rounding, clamped at the ends; the tree compares them as they are | overlap is only ever added; every method is tested against brute force |
/// | fat lines | f32, a line and a radius for a body in a slice | the radius covers the cubic's largest distance from the line, all roundings, hitbox and half the margin |
/// | compact cubics | f32, both bodies' cubics over a part of a span | the same roundings, and those of the relative motion, are added to the radius |
/// | cheap tests | f64 hulls and a separating direction, wrong by at most 100 u L | they reject only what is beyond the threshold by 512 u L |
/// | clusters | the bounding sphere is tested first | its radius is rounded outward; then the pairs of spheres that bounds cannot rule out are solved, and the results united |
/// | turning spheres | between cuts, the way of a centre is a cubic, with an error of at most the [orientation's](crate::Orientation) tolerance; where the rotation is unknown (beyond the range of f64's angles; beyond knots at more than 1e6 rad/s, or so far that rounding hides it) the centre is anywhere within its distance | `Exact` adds the error to the radius, `Certified` to the error of the relative cubic; boxes contain every rotation |
/// | relative cubic | restriction to the span and difference: a bound on its error is computed with it | handed to the solver |
/// | model errors | known bounds of the distance of splines and world | boxes and bounding spheres contain them; `Exact` adds them to the margin, rounded up; `Certified` is certain inside margin - e and outside margin + e alone |
/// | threshold | radii and margin are summed to within one rounding | `Certified` takes the two neighbours of the rounded sum where it had to be rounded |
/// | solver | `Exact` counts as contact what comes within its worst-case rounding of the threshold | `Certified` proves each part of a span inside or outside (`src/enclosure`); undecided parts are reported, and join their neighbours, as unresolved |
/// | times | the local parameter is exact, its instant is rounded | outward in `Certified`; knots are met exactly; contacts of a pair are one where no more lies between them than the rounding of their local parameters |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Accuracy {
    /// f64, good to a few roundings of the local scale, not certified. Distances within the worst
    /// case of that rounding of the margin are reported, so a touch is never lost but at an end of the
    /// [window](crate::Window). A conflict may begin later or end sooner, by the time in which the separation is within that
    /// rounding of the margin. Where one sphere of a cluster takes over from another just at the margin, it may be reported as
    /// two that are so far apart.
    #[default]
    Exact,
    /// Every conflict carries a [`Certificate`]: proven enclosures of its separation and of its times. They hold for the
    /// splines, the exact motion through the given numbers; where bodies have
    /// [model errors](crate::Body::with_model_error), for the world. Pairs that are certainly outside
    /// are not reported; conflicts that cannot be decided are marked as unresolved.
    Certified,
}

/// An interval `earliest..=latest` (s) that contains the exact instant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TimeEnclosure {
    /// Lower end, s.
    pub earliest: f64,
    /// Upper end, s.
    pub latest: f64,
}

/// Proven facts about a conflict of the splines, as worst cases over all rounding; of the world, if
/// the bodies have model errors.
///
/// The facts hold for the motion in real arithmetic through the given `f64` states or polynomials,
/// with the exact sum of radii and margin. The proof is in `src/enclosure`.
///
/// # Of the world
///
/// Let e be the sum of both bodies' [model errors](crate::Body::with_model_error), rounded up. The
/// separation in the world is then within e of the splines' at all times, and nothing else is known
/// of it. The facts hold for every world like that:
///
/// - All times within the margin in the world lie in conflicts that are reported, from
///   `enter.earliest` to `exit.latest`. A conflict of the world lies in one of them, not in two.
/// - `resolved`: from `enter.latest` to `exit.earliest` the bodies are within the margin in the world.
///   So there is a conflict of the world with these instants; it begins within `enter` and ends
///   within `exit`. Within these enclosures, of which the length grows with e, the world may have
///   further ones.
/// - Not `resolved`: the world may have no conflict there, one, or several.
/// - `closest.separation ± error` contains the least separation in the world, and the instants at
///   which it is attained lie within `closest`. `error` is somewhat more than e.
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
    /// The least separation within the conflict lies in `closest.separation ± error` (m), model errors
    /// included.
    pub error: f64,
    /// True if this is certainly one conflict: the bodies are within the margin at some instant, and
    /// throughout from `enter.latest` to `exit.earliest`. Within the enclosures of enter and exit they may
    /// cross the margin more than once.
    ///
    /// False if f64, or what the model errors leave open, cannot decide: whether the pair reaches
    /// the margin at all, or whether a short or narrow gap divides the conflict.
    pub resolved: bool,
    /// Beginning of the conflict.
    pub enter: TimeEnclosure,
    /// End of the conflict.
    pub exit: TimeEnclosure,
    /// All instants of least separation; between `enter.earliest` and `exit.latest`.
    pub closest: TimeEnclosure,
}

impl TimeEnclosure {
    /// Returns the instant within the enclosure that is nearest to `time`.
    pub(crate) fn nearest(self, time: f64) -> f64 {
        time.max(self.earliest).min(self.latest)
    }

    /// Returns the part between two instants, between which the exact one lies as well.
    pub(crate) fn within(self, start: f64, end: f64) -> Self {
        Self {
            earliest: self.earliest.max(start).min(end),
            latest: self.latest.min(end).max(start),
        }
    }

    /// Returns the smallest enclosure of both.
    pub(crate) fn hull(self, other: Self) -> Self {
        Self {
            earliest: self.earliest.min(other.earliest),
            latest: self.latest.max(other.latest),
        }
    }
}
