//! The error of covers.

use crate::error::Error;
use std::fmt;

/// The reason for which there is no cover, or no verdict on one.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CoverError {
    /// No finite set of spheres contains the shape (a half-space), or it is neither a solid nor a triangle mesh (a segment,
    /// a polyline, a single triangle). Height fields, voxels, rounded and custom shapes are not supported.
    #[error(
        "a {kind} cannot be covered with spheres: give a solid, a compound of solids, or a triangle mesh"
    )]
    UnsupportedShape {
        /// The kind of shape, as parry3d calls it.
        kind: &'static str,
    },
    /// The shape has no points, or a number of it is NaN or infinite, or a length is negative.
    #[error("the {kind} has no points, or a number that is not finite, or a negative length")]
    InvalidShape {
        /// The kind of shape, as parry3d calls it.
        kind: &'static str,
    },
    /// A number of spheres out of range.
    #[error(
        "{count} spheres: not a number from 1 to {}",
        crate::CoverOptions::MAX_SPHERES
    )]
    SphereCount {
        /// The number.
        count: usize,
    },
    /// An effort above the largest one.
    #[error(
        "an effort of {effort}: more than {} times the default number of starts",
        crate::CoverOptions::MAX_EFFORT
    )]
    Effort {
        /// The effort.
        effort: u32,
    },
    /// A target that is negative, NaN or infinite.
    #[error("a target overshoot of {target:?} m is not a finite number of at least 0")]
    Target {
        /// The target, m.
        target: f64,
    },
    /// No cover with the allowed number of spheres was found that reaches the target overshoot.
    #[error(
        "no cover found reaches out by at most {target:?} m: the best one, of {spheres} sphere{}, by {overshoot:?} m; \
         allow more spheres or a larger target",
        if *.spheres == 1 { "" } else { "s" }
    )]
    TargetMissed {
        /// Number of spheres of the best cover.
        spheres: usize,
        /// Its overshoot, m.
        overshoot: f64,
        /// The target, m.
        target: f64,
    },
    /// A factor of scale is not a positive finite number.
    #[error("{factor:?} is not a positive finite factor")]
    Scale {
        /// The factor.
        factor: f64,
    },
    /// A number of a saved cover is negative, NaN or infinite, or one of a scaled cover overflows.
    #[error("a cover whose {field} is {value:?}: not a finite number of at least 0")]
    Saved {
        /// The overshoot (m), the diameter (m) or the volume ratio.
        field: &'static str,
        /// The number.
        value: f64,
    },
    /// A sphere that no hitbox can have.
    #[error(transparent)]
    Sphere(#[from] Error),
}

/// A program that unwraps an error, or returns one from `main`, prints this: the sentence of `Display`.
impl fmt::Debug for CoverError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
