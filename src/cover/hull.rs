//! The triangles of a convex hull.

use glam::DVec3;

/// Six times the volume that counts as rounding, in the unit of solids.
const NO_VOLUME: f64 = 1e-14;

/// Returns the triangles of the convex hull of some points, seen from outside anticlockwise, or
/// `None` if the points are in one plane. The points are added one by one, each with triangles
/// to the rim of those that it sees.
pub(super) fn convex_hull(points: &[DVec3]) -> Option<Vec<Vec<usize>>> {
    let volume = |[a, b, c]: [usize; 3], at: usize| {
        let from_a = |corner: usize| points[corner] - points[a];
        from_a(at).dot(from_a(b).cross(from_a(c)))
    };
    let farthest = |distance: &dyn Fn(usize) -> f64| {
        (0..points.len()).max_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    };
    let from = |corner: usize| move |at: usize| points[at] - points[corner];
    let a = farthest(&|at| points[at].x)?;
    let b = farthest(&|at| from(a)(at).length())?;
    let c = farthest(&|at| from(a)(at).cross(from(a)(b)).length())?;
    let d = farthest(&|at| volume([a, b, c], at).abs())?;
    let [a, b] = if volume([a, b, c], d) > 0.0 {
        [b, a]
    } else {
        [a, b]
    };
    if volume([a, b, c], d) >= -NO_VOLUME {
        return None;
    }
    let mut triangles = vec![[a, b, c], [b, a, d], [c, b, d], [a, c, d]];
    let mut edges: Vec<(usize, usize)> = Vec::new();
    for at in 0..points.len() {
        edges.clear();
        triangles.retain(|&[a, b, c]| {
            let is_seen = volume([a, b, c], at) > NO_VOLUME;
            if is_seen {
                edges.extend([(a, b), (b, c), (c, a)]);
            }
            !is_seen
        });
        edges.sort_unstable();
        for &(from, to) in &edges {
            if edges.binary_search(&(to, from)).is_err() {
                triangles.push([from, to, at]);
            }
        }
    }
    Some(triangles.into_iter().map(Vec::from).collect())
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    fn in_balls(count: usize, size: DVec3) -> Vec<DVec3> {
        let mut random = Random::new(3, count as u64);
        let point = || random.point(DVec3::NEG_ONE, DVec3::ONE).normalize() * size;
        std::iter::repeat_with(point).take(count).collect()
    }

    #[test]
    fn hulls_contain_their_points() {
        for flatness in [1.0, 0.1, 1e-3, 1e-6] {
            let points = in_balls(200, DVec3::new(1.0, 1.0, flatness));
            let triangles = convex_hull(&points).unwrap_or_default();
            assert_eq!(triangles.len(), 2 * points.len() - 4, "{flatness}");
            for triangle in &triangles {
                let [a, b, c] = triangle[..] else { panic!() };
                let from_a = |corner: usize| points[corner] - points[a];
                let normal = from_a(b).cross(from_a(c));
                for at in 0..points.len() {
                    assert!(from_a(at).dot(normal) <= 4.0 * NO_VOLUME);
                }
            }
        }
        // A point in the middle of others is in no triangle.
        let mut points = in_balls(50, DVec3::ONE);
        points.insert(7, DVec3::ZERO);
        let triangles = convex_hull(&points).unwrap_or_default();
        assert_eq!(triangles.len(), 96);
        assert!(triangles.iter().flatten().all(|&corner| corner != 7));
    }

    #[test]
    fn points_in_a_plane_have_no_hull() {
        assert_eq!(convex_hull(&[]), None);
        assert_eq!(convex_hull(&[DVec3::ONE; 5]), None);
        assert_eq!(convex_hull(&in_balls(9, DVec3::new(1.0, 0.0, 1.0))), None);
    }
}
