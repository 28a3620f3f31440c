//! The last word on a cover: radii that are proven, their overshoot, and balls that are not needed.

use super::cells::{CellScratch, Share};
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
fn weighted(centres: &[DVec3], heights: &[f64], expected: f64) -> Vec<(DVec3, f64)> {
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
fn spare(solid: &Solid) -> f64 {
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

/// Balls by which surfaces are divided, and what is known of them.
struct Division<'a> {
    surfaces: &'a [Surface],
    balls: Vec<(DVec3, f64)>,
    /// Upper bounds of the signed distances of the centres.
    heights: Vec<f64>,
    spare: f64,
}

/// Returns a cover without balls that can go: the others reach out no farther than all balls did before. Small balls go
/// first.
pub(super) fn without_needless(
    solid: &Solid,
    surfaces: &[Surface],
    certified: Certified,
) -> Certified {
    let centres: Vec<DVec3> = certified.balls.iter().map(|&(centre, _)| centre).collect();
    let heights = solid.certain_distances(&centres);
    let division = Division {
        surfaces,
        balls: weighted(&centres, &heights, certified.expected),
        heights,
        spare: spare(solid),
    };
    let count = certified.balls.len();
    let mut shares = parallel::map(count, CellScratch::default, |scratch, ball| {
        scratch.share(surfaces, ball, &division.balls, |_| false)
    });
    let limit = certified.overshoot;
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| certified.balls[a].1.total_cmp(&certified.balls[b].1));
    let (mut gone, mut left) = (vec![false; count], count);
    let mut scratch = CellScratch::default();
    for ball in order {
        // Nothing remains that the share of the last ball could go to.
        if left == 1 {
            break;
        }
        let without = |other: usize| other == ball || gone[other];
        let found = division.shares_without(&mut scratch, &shares, ball, without, limit);
        for (other, share) in found.iter().flatten() {
            shares[*other] = share.clone();
        }
        if found.is_some() {
            (gone[ball], left) = (true, left - 1);
        }
    }
    let mut kept = Certified {
        balls: Vec::new(),
        overshoot: f64::NEG_INFINITY,
        ..certified
    };
    for ball in (0..count).filter(|&ball| !gone[ball]) {
        if let Some(needed) = shares[ball].needed() {
            let radius = needed + division.spare;
            kept.balls.push((division.balls[ball].0, radius));
            kept.overshoot = kept.overshoot.max(radius + division.heights[ball]);
        }
    }
    if kept.balls.len() < count && kept.overshoot <= limit {
        kept
    } else {
        certified
    }
}

impl Division<'_> {
    /// Returns the shares that are larger without a ball, and without others that have gone; `None` if a ball would
    /// reach out farther than the limit.
    fn shares_without(
        &self,
        scratch: &mut CellScratch,
        shares: &[Share],
        ball: usize,
        is_absent: impl Fn(usize) -> bool + Copy,
        limit: f64,
    ) -> Option<Vec<(usize, Share)>> {
        let is_larger = |&other: &usize| !is_absent(other) && shares[other].cut_by.contains(&ball);
        let larger = (0..shares.len()).filter(is_larger);
        let larger = larger.map(|other| {
            let share = scratch.share(self.surfaces, other, &self.balls, is_absent);
            let reach = |needed: f64| needed + self.spare + self.heights[other];
            let is_within = share.needed().is_none_or(|needed| reach(needed) <= limit);
            is_within.then_some((other, share))
        });
        larger.collect()
    }
}
