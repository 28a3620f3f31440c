//! Trajectories from the forms in which curves are kept elsewhere, one file each.
//!
//! A conversion rounds. Each segment bounds the distance between the cubic that it keeps and the one meant, in real
//! arithmetic, by the numbers given.

mod b_spline;
mod bezier;
mod keyframes;
mod positions;
mod waypoints;

pub use keyframes::Keyframe;
pub use positions::PositionOptions;

#[cfg(test)]
mod tests;
