//! Boxes: the Bézier hull of a motion in a time slice, rounded outward to a parry3d `Aabb` (f32).
//!
//! A box contains every position from which the exact solver would report a contact, including the
//! solver's own rounding. Its padding is the hitbox and half the margin. Rounding is added, more than the clearance of
//! all rejections (see `rounding`). A [`FatLine`] is a closer bound: a straight line and a radius. The padding of a body that
//! turns is a ball. If that is mostly empty, box and fat line are then [brought closer](tighten).
//!
//! From a trajectory to a box, all in f32: the cubics of a [`CompactTrajectory`] (or its segments,
//! if few boxes are needed) are split at the ends of slices into [`SubCubic`]s. A [`BoundsBuilder`]
//! follows these through a slice; it passes many whole cubics at once in [`CubicRun`]s.
//!
//! Rounding, in units of 2^-24: each split of a cubic costs some 24 relative to its size and three
//! relative to its distance from the trajectory's middle. Six more are relative to that distance,
//! and six to the distance from the scene's middle. Each count is given where it arises. The
//! clearance of rejections, 2^-44, is negligible against it.
//!
//! Words: [`internals`](crate::internals).

mod apart;
mod builder;
mod compact_cubic;
mod compact_trajectory;
mod cubic_run;
mod fat_line;
mod form_runs;
mod frame;
mod placement;
mod points;
mod slice_interval;
mod source;
mod straight_part;
mod straight_pieces;
mod sub_cubic;
mod swept;

pub(crate) use apart::{BodyCubic, HullTest, hull_test};
pub(crate) use builder::BoundsBuilder;
pub(crate) use compact_cubic::CompactCubic;
pub(crate) use compact_trajectory::{CacheLine, CompactTrajectory, CompactView};
pub(crate) use cubic_run::CubicRun;
pub(crate) use fat_line::FatLine;
pub(crate) use frame::{DAabb, Frame, MovingFrame, Padding};
pub(crate) use slice_interval::SliceInterval;
pub(crate) use source::{BoundingCubic, CubicSource};
pub(crate) use straight_pieces::{MAX_PLACES, StraightPieces};
pub(crate) use sub_cubic::SubCubic;
pub(crate) use swept::tighten;

use glam::{DVec3, Vec4};

/// Coordinates beyond this, in the frame's unit, are not served; below the largest f32.
const FAR: f64 = 1e37;

/// Half a unit in the last place of f32, relative.
const ROUNDING: f32 = 0.5 * f32::EPSILON;

#[allow(
    clippy::cast_possible_truncation,
    reason = "rounding to f32 is the purpose; callers round outward"
)]
#[inline(always)]
fn nearest(value: f64) -> f32 {
    value as f32
}

/// Returns the nearest f32 vector, with a fourth coordinate.
#[inline(always)]
fn nearest_vector(vector: DVec3, last: f64) -> Vec4 {
    let DVec3 { x, y, z } = vector;
    Vec4::new(nearest(x), nearest(y), nearest(z), nearest(last))
}
