//! Boxes: the Bézier hull of a body's motion in a slice of time, rounded outward to a parry3d
//! `Aabb` (f32).
//!
//! A box contains every position from which the exact solver would report a contact, the solver's
//! own rounding included: it is inflated by the hitbox, half the margin and the clearance that
//! every filter keeps (see `rounding`). A [`FatLine`] says the same more closely: a straight line,
//! and how far from it.
//!
//! From a trajectory to a box, all in f32: its [`CompactTrajectory`] (or, where few boxes are wanted, its
//! segments), split at the ends of slices into [`SubCubic`]s, which a [`BoundsBuilder`] follows through a
//! slice; many whole cubics in one are passed in [`CubicRun`]s. A compact trajectory is drawn around the
//! trajectory itself. With each split of a cubic, some 24 roundings (2^-24) are relative to its
//! size and three to the distance from the trajectory's middle; six more are relative to that, and
//! six to the distance from the scene's middle. Each count is given where it arises. Next to it
//! the clearance of filters, 2^-44, is nothing.

mod apart;
mod builder;
mod bundling;
mod compact_cubic;
mod compact_trajectory;
mod cubic_run;
mod fat_line;
mod frame;
mod placement;
mod points;
mod slice_interval;
mod source;
mod sub_cubic;

pub(crate) use apart::{BodyCubic, HullTest, hull_test};
pub(crate) use builder::BoundsBuilder;
pub(crate) use compact_cubic::CompactCubic;
pub(crate) use compact_trajectory::{CompactTrajectory, CompactView, Line};
pub(crate) use cubic_run::CubicRun;
pub(crate) use fat_line::FatLine;
pub(crate) use frame::{DAabb, Frame, MovingFrame, Padding};
pub(crate) use slice_interval::SliceInterval;
pub(crate) use source::{BoundingCubic, CubicSource};
pub(crate) use sub_cubic::SubCubic;

/// Coordinates beyond this are not served: in the frame's unit, below the largest f32.
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
