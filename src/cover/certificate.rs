//! The last word on a cover: radii that are proven, and their overshoot.

use super::cells::CellScratch;
use super::form::SolidForm;
use super::solid::{Solid, SolidPart};
use super::surface::Surface;
use crate::count::{as_f64, whole};
use crate::parallel;
use glam::DVec3;

/// Balls that contain a solid.
#[derive(Clone, Debug)]
pub(super) struct Certified {
    pub(super) balls: Vec<(DVec3, f64)>,
    /// No ball reaches farther out of the solid than this.
    pub(super) overshoot: f64,
    /// The overshoot that was expected when the balls' shares were found.
    pub(super) expected: f64,
}

/// Returns the balls by which shares are found, from their centres and bounds of the signed distances.
pub(super) fn weighted(centres: &[DVec3], heights: &[f64], expected: f64) -> Vec<(DVec3, f64)> {
    let each = centres.iter().zip(heights);
    each.map(|(&centre, &height)| (centre, (expected - height).max(0.0)))
        .collect()
}

/// Points of round surfaces in all, about.
const MAX_POINTS: f64 = 40_000.0;

/// Returns surfaces around the parts, as fine as a proof deserves.
pub(super) fn fine_surfaces(solid: &Solid) -> Vec<Surface> {
    let is_capped = |part: &SolidPart| {
        let SolidPart::Convex(convex) = part else {
            return false;
        };
        matches!(convex.form(), SolidForm::Capsule { .. })
    };
    let capped = solid.parts.iter().filter(|part| is_capped(part));
    let parts = as_f64(capped.count().max(1));
    // A capped part has a quarter of the square of its sides as points.
    let sides = (4.0 * MAX_POINTS / parts).sqrt().clamp(32.0, 1024.0);
    let sides = whole(sides).div_ceil(4) * 4;
    let each = solid.parts.iter();
    each.map(|part| part.surface(if is_capped(part) { sides } else { 1024 }))
        .collect()
}

/// Returns what radii are enlarged by, in all.
pub(super) fn spare(solid: &Solid) -> f64 {
    // A second proof, from other surfaces and other shares, needs some room. Half-spaces are moved
    // outward by 1e-11, which lengthens a small ball's share by more where a large ball is its neighbour.
    let is_round = solid.parts.iter().any(SolidPart::is_round);
    let other_surfaces = if is_round { 5e-7 * solid.diameter } else { 0.0 };
    32.0 * (solid.rounding + 1e-10) + solid.unevenness + other_surfaces
}

/// Returns the balls around some centres that contain the surfaces, and the volumes that they bound,
/// with about the least overshoot. `expected` is about that overshoot.
pub(super) fn certify(
    solid: &Solid,
    surfaces: &[Surface],
    centres: &[DVec3],
    mut expected: f64,
) -> Certified {
    const ROUNDS: u32 = 8;
    let spare = spare(solid);
    let heights = solid.certain_distances(centres);
    let mut best = Certified {
        balls: Vec::new(),
        overshoot: f64::INFINITY,
        expected,
    };
    for _ in 0..ROUNDS {
        let mut balls = weighted(centres, &heights, expected);
        let needed = parallel::map(balls.len(), CellScratch::default, |scratch, ball| {
            scratch.share(surfaces, ball, &balls, |_| false).needed()
        });
        let mut overshoot = f64::NEG_INFINITY;
        for ((ball, needed), height) in balls.iter_mut().zip(&needed).zip(&heights) {
            if let Some(needed) = needed {
                ball.1 = needed + spare;
                overshoot = overshoot.max(ball.1 + height);
            }
        }
        let mut needed = needed.iter();
        balls.retain(|_| needed.next().is_some_and(Option::is_some));
        // The shares of other weights would be no better.
        let gain = best.overshoot - overshoot;
        if gain > 0.0 {
            best = Certified {
                balls,
                overshoot,
                expected,
            };
        }
        if gain < 1e-4 * overshoot {
            break;
        }
        expected = overshoot;
    }
    best
}
