//! More points on coarse surfaces, for a search that looks at points.

use super::surface::{Surface, fan};
use glam::DVec3;
use std::collections::HashMap;

/// Returns surfaces in triangles: at most so many points in all, or those that there are. Their points come first,
/// and the triangles are about equally large.
///
/// A surface's segments and lone points get no points between them.
pub(super) fn refined(surfaces: &[Surface], most: usize) -> Vec<Surface> {
    /// A step divides each triangle in two, about, and 2,000 points are reached from a few by 15 steps.
    const STEPS: u32 = 64;
    const STEP: f64 = 0.8;
    let lengths = surfaces.iter().map(longest_edge);
    let mut longest = lengths.fold(0.0, f64::max);
    let mut best = surfaces.to_vec();
    for _ in 0..STEPS {
        let next = surfaces.iter().map(|one| divided(one, longest, most));
        let Some(next) = next.collect::<Option<Vec<Surface>>>() else {
            break;
        };
        if next.iter().map(|one| one.points.len()).sum::<usize>() > most {
            break;
        }
        best = next;
        longest *= STEP;
    }
    best
}

/// Returns the length of the longest edge of a surface's triangles, 0 without triangles.
fn longest_edge(surface: &Surface) -> f64 {
    let triangles = surface.polygons().flat_map(fan);
    let lengths =
        triangles.map(|triangle| length(&surface.points, longest_first(&surface.points, triangle)));
    lengths.fold(0.0, f64::max)
}

/// Returns a surface in triangles with no edge longer than asked, or `None` if it has more points than `most` then. (Edges
/// shorter than the rounding of their ends cannot be halved without end.)
///
/// M. C. Rivara: Algorithms for refining triangular grids suitable for adaptive and multigrid techniques,
/// International Journal for Numerical Methods in Engineering 20 (1984).
fn divided(surface: &Surface, longest: f64, most: usize) -> Option<Surface> {
    let mut points = surface.points.clone();
    let mut triangles = Vec::new();
    // Whichever triangle an edge is of, it is halved if it is long: no gap opens between neighbours.
    let mut middles = HashMap::new();
    let mut waiting: Vec<[usize; 3]> = surface.polygons().flat_map(fan).collect();
    while let Some(triangle) = waiting.pop() {
        let [from, to, top] = longest_first(&points, triangle);
        if length(&points, [from, to, top]) <= longest {
            triangles.push([from, to, top]);
            continue;
        }
        if points.len() > most {
            return None;
        }
        let middle = *middles
            .entry((from.min(to), from.max(to)))
            .or_insert_with(|| {
                points.push(points[from].midpoint(points[to]));
                points.len() - 1
            });
        waiting.extend([[from, middle, top], [middle, to, top]]);
    }
    let mut divided = Surface::new(points, surface.is_closed());
    triangles
        .into_iter()
        .for_each(|corners| divided.push_polygon(corners));
    Some(divided)
}

/// Turns a triangle's list of corners until its longest edge is the first.
fn longest_first(points: &[DVec3], [a, b, c]: [usize; 3]) -> [usize; 3] {
    let longer = |one, other| {
        if length(points, other) > length(points, one) {
            other
        } else {
            one
        }
    };
    longer(longer([a, b, c], [b, c, a]), [c, a, b])
}

/// Returns the length of the first edge.
fn length(points: &[DVec3], [from, to, _]: [usize; 3]) -> f64 {
    points[from].distance(points[to])
}

#[cfg(test)]
mod tests {
    use super::super::convex::Convex;
    use super::super::form::SolidForm;
    use super::super::surface::is_closed;
    use super::*;

    #[test]
    fn refined_surfaces_are_the_same_surfaces() {
        let cuboid = |size| Convex::new(SolidForm::cuboid(size)).polyhedron(4);
        let brick = cuboid(DVec3::new(0.1, 0.5, 1.0));
        let surfaces = [brick.clone(), cuboid(DVec3::ONE)];
        for most in [16, 100, 500, 2_000] {
            let found = refined(&surfaces, most);
            for (before, after) in surfaces.iter().zip(&found) {
                assert_eq!(after.points[..8], before.points);
                assert!(after.is_closed() && is_closed(after.polygons()));
                assert!((after.volume() - before.volume()).abs() < 1e-12);
            }
            let points: usize = found.iter().map(|one| one.points.len()).sum();
            // Edges of one length are halved together: there are four times as many points then.
            assert!(points <= most && 4 * points > most, "{most}: {points}");
            // Of 16 points all are corners. Otherwise the last edge that was halved was longer than allowed.
            let longest = found.iter().map(longest_edge);
            let (low, high) = longest.fold((f64::INFINITY, 0.0_f64), |(low, high), length| {
                (low.min(length), high.max(length))
            });
            assert!(most == 16 || high < 2.0 * low, "{most}: {low} {high}");
        }
        // There are more already.
        assert_eq!(refined(&[brick], 3)[0].points.len(), 8);
    }

    #[test]
    fn what_has_no_triangles_stays() {
        let mut segment = Surface::new(vec![DVec3::ZERO, DVec3::X], false);
        segment.push_polygon([0, 1]);
        let found = refined(&[segment, Surface::default()], 100);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].points.len(), 2);
        // A triangle without area, and one that is a point.
        let mut slivers = Surface::new(vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], false);
        slivers.push_polygon([0, 1, 2]);
        slivers.push_polygon([0, 0, 0]);
        let points = refined(&[slivers], 100)[0].points.len();
        assert!((25..=100).contains(&points), "{points}");
    }

    /// Two tiny cuboids far apart: halves of their edges are as long as the edges, by rounding.
    #[test]
    fn edges_that_cannot_be_halved_end_the_refinement() {
        let cuboid = Convex::new(SolidForm::cuboid(DVec3::splat(1e-16))).polyhedron(4);
        let moved = |by: f64| {
            let points = cuboid.points.iter().map(|&point| point + by * DVec3::X);
            let mut moved = Surface::new(points.collect(), true);
            let polygons = cuboid.polygons();
            polygons.for_each(|corners| moved.push_polygon(corners.iter().copied()));
            moved
        };
        let surfaces = [moved(-1.0), moved(1.0)];
        let points = |all: &[Surface]| all.iter().map(|one| one.points.len()).sum::<usize>();
        assert!(points(&refined(&surfaces, 500)) <= 500);
    }
}
