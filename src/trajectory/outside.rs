//! The rule beyond the knots.

/// The rule for the motion of a body before its first and after its last knot.
///
/// A body that continues beyond its knots exists at all times. A window in which it is screened must be closed on that
/// side, else there is an [`Error::WindowNotClosed`](crate::Error::WindowNotClosed).
///
/// Rounding: a position beyond the knots is good to 4e-15 of the distance travelled from the knot.
/// For a cubic, take the sum of the sizes of its three terms; straight motion has only the linear
/// one. Whether two bodies are within a margin is then known to 1e-14 of the sum of both distances and their separation.
/// [`Accuracy::Exact`](crate::Accuracy::Exact) reports conflicts that this leaves open,
/// [`Accuracy::Certified`](crate::Accuracy::Certified) marks them as unresolved.
///
/// Cost: in a window so long that bodies fly through the whole scene many times, every pair counts as near. With windows
/// of up to 1e12 s, a screening of 1,000 bodies at 10 m/s takes 0.1 s, and one of 5,000 takes 0.4 s.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Outside, State, Trajectory};
///
/// // It speeds up: t² metres after t seconds.
/// let square = |t: f64| State::new(t, t * t * DVec3::X, 2.0 * t * DVec3::X);
/// let plan = Trajectory::from_states(&[square(0.0), square(1.0)])?;
/// assert_eq!(plan.position(2.0), None);
/// for (outside, metres) in [(Outside::Extrapolate, 4.0), (Outside::Coast, 3.0)] {
///     assert_eq!(plan.clone().with_outside(outside).position(2.0), Some(metres * DVec3::X));
/// }
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Outside {
    /// The body does not exist there.
    #[default]
    Absent,
    /// The first and last cubic continue in their own parameter. A position
    /// is good to 4e-15 of the cubic's terms, which grow with time, its square and its cube. States
    /// one minute apart on a low orbit give 1 mm after 10 hours, and 1 m after five days.
    Extrapolate,
    /// The body keeps the velocity of its first or last knot (dead reckoning). From a single state:
    /// [`Trajectory::coasting`](super::Trajectory::coasting).
    #[doc(alias = "dead reckoning")]
    Coast,
}
