//! Moves of single balls, between descents.

use super::descent::{CoverCandidate, DescentScratch, Schedule, Target, descend};
use super::random::Random;
use super::solid::Solid;
use glam::DVec3;

/// Moves one of the balls whose loss costs least to a worst point, and descends. Keeps the result if
/// that is better.
pub(super) fn improve(
    solid: &Solid,
    target: &Target<'_>,
    ridges: &[(DVec3, f64)],
    best: &mut CoverCandidate,
    schedule: &Schedule,
    random: &mut Random,
    scratch: &mut DescentScratch,
) {
    /// Losses are alike, and the least one need not lead farthest.
    const FEW: usize = 3;
    let mut centres = best.centres.clone();
    let losses = scratch.losses(solid, target, &centres, best.overshoot);
    let mut order: Vec<usize> = (0..losses.len()).collect();
    order.sort_by(|&a, &b| losses[a].total_cmp(&losses[b]).then(a.cmp(&b)));
    // Balls without any use move together.
    let bound = best.overshoot * (1.0 + 1e-9);
    let useless = losses.iter().filter(|&&loss| loss <= bound).count();
    let moved = if useless < FEW {
        vec![order[random.below(FEW.min(order.len()))]]
    } else {
        order[..useless.div_ceil(3)].to_vec()
    };
    scratch.measure(solid, target, &centres, best.overshoot, 0.0);
    for ball in moved {
        if let Some((point, centre)) = scratch.one_of_the_worst(&best.centres, random) {
            let between = point.lerp(centre, 0.2 + 0.6 * random.unit());
            let share = random.unit();
            let large = largest(ridges, point, share * best.overshoot);
            centres[ball] = large.filter(|_| share > 0.5).unwrap_or(between);
        }
    }
    let found = descend(solid, target, centres, schedule, scratch);
    if found.overshoot < best.overshoot {
        *best = found;
    }
}

/// Returns the middle of the largest ball that contains a point and reaches out no farther than
/// asked.
fn largest(ridges: &[(DVec3, f64)], point: DVec3, overshoot: f64) -> Option<DVec3> {
    let serves = |&&(at, height): &&(DVec3, f64)| at.distance(point) + height <= overshoot;
    let serving = ridges.iter().filter(serves);
    serving
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|&(at, _)| at)
}
