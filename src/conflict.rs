//! Conflicts, as a screening reports them, and their total order.

use crate::accuracy::{Certificate, TimeEnclosure};
use crate::id::{BodyId, TaggedBody};
use crate::readable::Readable;
use glam::DVec3;
use std::cmp::Ordering;
use std::fmt;

/// The instant of least separation of two bodies, within a window or a conflict.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
#[doc(alias = "tca")]
#[doc(alias = "cpa")]
#[doc(alias = "miss distance")]
pub struct ClosestApproach {
    /// The instant, s; the first one of several, or of a stretch.
    pub time: f64,
    /// Distance between the hitboxes' surfaces on the splines, m; negative where they overlap. It
    /// belongs to the exact instant, of which `time` is the rounded value. The positions at `time` may differ from
    /// it where a body goes far between two neighbouring f64 instants, as between knots an ulp
    /// apart.
    pub separation: f64,
    /// Position of body a at `time`, m.
    pub position_a: DVec3,
    /// Position of body b at `time`, m.
    pub position_b: DVec3,
    /// Velocity of a minus that of b, m/s. At a jump: the velocity from then on.
    pub relative_velocity: DVec3,
    /// Number of the closest sphere of a's hitbox (0 for a single sphere); of several, any one. Where the orientation
    /// jumps at `time`, either rotation may be the one of this sphere (at the last instant of a plan, the earlier one);
    /// [`Body::spheres_at`](crate::Body::spheres_at) takes the later one.
    pub sphere_a: u32,
    /// Number of the closest sphere of b's hitbox (0 for a single sphere).
    pub sphere_b: u32,
    /// Sum of both bodies' [model errors](crate::Body::with_model_error), rounded up, m. The least
    /// separation in the world is within so much of `separation`, which is that of the splines.
    #[cfg_attr(feature = "serde", serde(default))]
    pub model_error: f64,
}

/// A closest approach with proven bounds, as in [`Certificate`]: of the
/// splines, or with [model errors](crate::Body::with_model_error) of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CertifiedApproach {
    /// The closest approach of the splines.
    pub approach: ClosestApproach,
    /// The least separation lies in `approach.separation ± error` (m), model errors included.
    pub error: f64,
    /// All instants of least separation.
    pub time: TimeEnclosure,
}

impl ClosestApproach {
    /// Returns the position of a relative to b at `time`, m.
    #[must_use]
    pub fn relative_position(&self) -> DVec3 {
        self.position_a - self.position_b
    }

    /// Returns true if all its numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let vectors = [self.position_a, self.position_b, self.relative_velocity];
        let numbers = [self.time, self.separation, self.model_error];
        vectors.into_iter().all(DVec3::is_finite) && numbers.into_iter().all(f64::is_finite)
    }
}

/// A maximal interval in which two bodies' separation is at most the margin.
///
/// Of bodies with [model errors](crate::Body::with_model_error), the separation of the splines is at
/// most margin + [`model_error`](ClosestApproach::model_error): the bodies may be within the margin in
/// the world.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{Body, Query, Scene, State, Trajectory, Window};
///
/// // One body passes the other 3 m off, at 1 m/s: within 5 m from 4 s before to 4 s after.
/// let fly = [-10.0, 10.0].map(|t| State::new(t, DVec3::new(t, 3.0, 0.0), DVec3::X));
/// let mut scene = Scene::new();
/// scene.insert(Body::new(Trajectory::from_states(&fly)?))?;
/// scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
/// let query = Query::new(Window::new(-10.0, 10.0)?).with_margin(5.0);
/// let conflict = scene.screen(&query)?.conflicts[0];
/// assert!((conflict.enter + 4.0).abs() < 1e-9 && (conflict.exit - 4.0).abs() < 1e-9);
/// assert!((conflict.closest.separation - 3.0).abs() < 1e-9);
/// assert!(!conflict.clip.at_enter && !conflict.clip.at_exit);
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
#[doc(alias = "conjunction")]
#[doc(alias = "time of impact")]
pub struct Conflict {
    /// The body with the smaller id.
    pub a: BodyId,
    /// The body with the larger id.
    pub b: BodyId,
    /// The tag of body a.
    pub tag_a: u64,
    /// The tag of body b.
    pub tag_b: u64,
    /// First instant within the margin, s.
    pub enter: f64,
    /// Last instant within the margin, s; equal to `enter` for a mere touch.
    pub exit: f64,
    /// The least separation inside the interval. It may exceed the margin by model errors, and by
    /// rounding: far [beyond the knots](crate::Outside) by 1e-14 of the distance travelled.
    pub closest: ClosestApproach,
    /// Ends of the interval that the window or the bodies' common domain cuts.
    pub clip: Clip,
    /// Proven facts; with [`Accuracy::Certified`](crate::Accuracy::Certified) only.
    pub certificate: Option<Certificate>,
}

/// The ends of a conflict that are ends of the window or the common domain instead of crossings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Clip {
    /// True if the window or the common domain begins inside, or exactly at the margin.
    pub at_enter: bool,
    /// True if the window or the common domain ends inside, or exactly at the margin.
    pub at_exit: bool,
}

impl Clip {
    /// Returns the ends as bits: bit 0 for enter, bit 1 for exit.
    #[must_use]
    pub fn bits(self) -> u8 {
        u8::from(self.at_enter) | u8::from(self.at_exit) << 1
    }
}

impl Conflict {
    /// Returns the body that this one meets; `None` if the conflict is of two other bodies.
    #[must_use]
    pub fn other(&self, id: BodyId) -> Option<BodyId> {
        let bodies = (self.a, self.b);
        other_of(bodies, id, bodies)
    }

    /// Returns the [tag](crate::Body::tag) of the body that this one meets; `None` if the conflict is of two other bodies.
    #[must_use]
    pub fn other_tag(&self, id: BodyId) -> Option<u64> {
        other_of((self.a, self.b), id, (self.tag_a, self.tag_b))
    }

    /// Returns the time between enter and exit, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.exit - self.enter
    }

    /// Compares in the order of reports: by enter, then a, then b.
    #[must_use]
    pub fn order(&self, other: &Self) -> Ordering {
        self.enter
            .total_cmp(&other.enter)
            .then_with(|| self.a.cmp(&other.a))
            .then_with(|| self.b.cmp(&other.b))
    }
}

impl fmt::Display for Conflict {
    /// Writes one line: the bodies, with tags that are not 0, the interval, the closest approach, the proven error of its
    /// separation (of the splines; with model errors, of the world), and the clipped ends. A precision (`{:.6}`)
    /// sets the number of decimals. Numbers below 0.001, and from 1e15 on, have an exponent.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (a, b) = (
            TaggedBody(self.a, self.tag_a),
            TaggedBody(self.b, self.tag_b),
        );
        write!(f, "{a} and {b} ")?;
        write_interval(f, (self.enter, self.exit), &self.closest)?;
        if let Some(certificate) = &self.certificate {
            let decimals = f.precision().unwrap_or(3);
            let error = Readable(certificate.error);
            let of = if self.closest.model_error > 0.0 {
                "world"
            } else {
                "splines"
            };
            write!(f, ", ±{error:.decimals$} m of the {of}")?;
            if !certificate.resolved {
                f.write_str(", unresolved")?;
            }
        }
        f.write_str(match (self.clip.at_enter, self.clip.at_exit) {
            (false, false) => "",
            (true, false) => ", cut off at enter",
            (false, true) => ", cut off at exit",
            (true, true) => ", cut off at both ends",
        })
    }
}

/// Returns the value of the body of a pair that is not this one; `None` if this one is not of the pair.
pub(crate) fn other_of<T>(bodies: (BodyId, BodyId), id: BodyId, values: (T, T)) -> Option<T> {
    if id == bodies.0 {
        Some(values.1)
    } else {
        (id == bodies.1).then_some(values.0)
    }
}

/// Writes the interval (s) in which two bodies are too close, and the closest approach.
pub(crate) fn write_interval(
    f: &mut fmt::Formatter<'_>,
    (enter, exit): (f64, f64),
    closest: &ClosestApproach,
) -> fmt::Result {
    let decimals = f.precision().unwrap_or(3);
    let [enter, exit, least, time] = [enter, exit, closest.separation, closest.time].map(Readable);
    write!(
        f,
        "from {enter:.decimals$} s to {exit:.decimals$} s, \
         closest {least:.decimals$} m at {time:.decimals$} s"
    )
}
