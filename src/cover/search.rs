//! Centres from which a search begins, and moves of single balls between descents.

use super::descent::{CoverCandidate, DescentScratch, Schedule, Target, descend};
use super::random::Random;
use super::solid::Solid;
use crate::count::as_f64;
use crate::parallel;
use glam::DVec3;

/// Points of a solid, about evenly spread in its volume, or on its surface if it has none.
pub(super) fn pool(solid: &Solid, count: usize, random: &mut Random) -> Vec<DVec3> {
    let mut pool = Vec::with_capacity(count);
    for _ in 0..32 * count {
        let point = random.point(solid.low, solid.high);
        if solid.contains(point) {
            pool.push(point);
            if pool.len() == count {
                return pool;
            }
        }
    }
    for surface in solid.surfaces(16) {
        for polygon in surface.polygons() {
            let corners = polygon.iter().map(|&corner| surface.points[corner]);
            pool.push(corners.sum::<DVec3>() / as_f64(polygon.len()));
        }
    }
    pool
}

/// Chooses centres from a pool: the first at random, each further one as the farthest of a few from those
/// before it.
pub(super) fn spread(pool: &[DVec3], count: usize, random: &mut Random) -> Vec<DVec3> {
    let mut centres = vec![pool[random.below(pool.len())]];
    let mut squares = vec![f64::INFINITY; pool.len()];
    while centres.len() < count {
        let last = centres[centres.len() - 1];
        for (square, point) in squares.iter_mut().zip(pool) {
            *square = square.min(point.distance_squared(last));
        }
        // Neither an outlier each time nor a point by chance.
        let few = (0..4).map(|_| random.below(pool.len()));
        let next = few.max_by(|&a, &b| squares[a].total_cmp(&squares[b]));
        centres.push(pool[next.unwrap_or(0)]);
    }
    centres
}

/// Moves points to where the depth is locally greatest, or to a ridge of it, and returns them with their
/// signed distances. Balls around such points contain much and reach out little.
pub(super) fn deepest(
    pool: &[DVec3],
    signed_distance: &(impl Fn(DVec3, &mut Vec<f64>) -> (f64, DVec3) + Sync),
) -> Vec<(DVec3, f64)> {
    const STEPS: u32 = 24;
    parallel::map(pool.len(), Vec::new, |scratch, number| {
        let mut at = pool[number];
        let (mut height, mut slope) = signed_distance(at, scratch);
        let mut length = height.abs();
        for _ in 0..STEPS {
            let next = at - slope * length;
            let (next_height, next_slope) = signed_distance(next, scratch);
            if next_height < height {
                (at, height, slope) = (next, next_height, next_slope);
            } else {
                length /= 2.0;
            }
        }
        (at, height)
    })
}

/// Returns the centres of lattices in the box around a solid, with at most `count` points, as far
/// as they lie in it: the few whose cells have the shortest diagonals.
pub(super) fn lattices(solid: &Solid, count: usize) -> impl Iterator<Item = Vec<DVec3>> {
    /// A descent measures some hundred times.
    const FEW: usize = 32;
    let size = solid.high - solid.low;
    let step = move |[x, y, z]: [usize; 3]| size / DVec3::new(as_f64(x), as_f64(y), as_f64(z));
    let sides = (1..=count).flat_map(|x| (1..=count / x).map(move |y| [x, y, count / x / y]));
    let mut sides: Vec<[usize; 3]> = sides.collect();
    let diagonal = |sides: &[usize; 3]| step(*sides).length_squared();
    sides.sort_by(|a, b| diagonal(a).total_cmp(&diagonal(b)));
    sides.truncate(FEW);
    let lattice = move |[x, y, z]: [usize; 3]| {
        let step = step([x, y, z]);
        let mut centres = Vec::with_capacity(x * y * z);
        for number in 0..x * y * z {
            let place = [number % x, number / x % y, number / x / y];
            let place = DVec3::from_array(place.map(|place| as_f64(place) + 0.5));
            centres.push(solid.low + step * place);
        }
        centres.retain(|&centre| solid.signed_distance(centre).0 < 0.0);
        centres
    };
    let lattices = sides.into_iter().map(lattice);
    lattices.filter(|centres| !centres.is_empty())
}

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

#[cfg(test)]
mod tests {
    use super::super::form::SolidForm;
    use super::*;

    /// A search of many centres begins as soon as one of few.
    #[test]
    fn few_lattices_are_tried() {
        let size = DVec3::new(0.5, 1.0, 2.0);
        let brick =
            Solid::new(vec![(SolidForm::cuboid(size), 0.0)]).unwrap_or_else(|| unreachable!());
        for count in [64, 300, 2_000] {
            let tried = lattices(&brick, count).count();
            assert!(tried <= 32, "{count}: {tried}");
        }
        // The cubes are first.
        let best = lattices(&brick, 64).next().unwrap_or_default();
        let at = |x: f64, y: f64, z: f64| best.contains(&DVec3::new(x, y, z));
        assert!(best.len() == 64 && at(0.0625, 0.0625, 0.0625), "{best:?}");
    }
}
