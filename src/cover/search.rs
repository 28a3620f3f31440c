//! Moves of single balls, between descents.

use super::descent::{CoverCandidate, DescentScratch, Schedule, Target, descend};
use super::random::Random;
use super::solid::Solid;
use glam::DVec3;

/// Moves one of the balls to a worst point, and descends. Keeps the result if that is better.
pub(super) fn improve(
    solid: &Solid,
    target: &Target<'_>,
    ridges: &[(DVec3, f64)],
    best: &mut CoverCandidate,
    schedule: &Schedule,
    random: &mut Random,
    scratch: &mut DescentScratch,
) {
    let mut centres = best.centres.clone();
    let moved = random.below(centres.len());
    scratch.measure(solid, target, &centres, best.overshoot);
    if let Some((point, centre)) = scratch.one_of_the_worst(&best.centres, random) {
        let between = point.lerp(centre, 0.2 + 0.6 * random.unit());
        let share = random.unit();
        let large = largest(ridges, point, share * best.overshoot);
        centres[moved] = large.filter(|_| share > 0.5).unwrap_or(between);
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
