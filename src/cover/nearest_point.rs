//! Nearest points of segments and triangles.

use glam::DVec3;

/// Returns the point of a segment that is nearest to a place.
pub(super) fn nearest_on_segment([from, to]: [DVec3; 2], at: DVec3) -> DVec3 {
    let way = to - from;
    let share = (at - from).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
    from + way * share.clamp(0.0, 1.0)
}

/// Returns the point of a triangle that is nearest to a place.
///
/// C. Ericson: Real-Time Collision Detection (2005), section 5.1.5.
pub(super) fn nearest_on_triangle([a, b, c]: [DVec3; 3], at: DVec3) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, at - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = at - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = at - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let below = 1.0 / (va + vb + vc);
    // The weights of a sliver may be rounded by more than they are large. The point stays in the triangle, whatever
    // they are: no case is known, nor ruled out.
    let weight = |weight: f64, most: f64| if weight > 0.0 { weight.min(most) } else { 0.0 };
    let along = weight(vb * below, 1.0);
    let on_face = a + ab * along + ac * weight(vc * below, 1.0 - along);
    // It is far along the sliver, where a point of an edge is nearer.
    let on_edges = [[a, b], [b, c], [c, a]].map(|edge| nearest_on_segment(edge, at));
    let nearer = |one: DVec3, other: DVec3| {
        let is_nearer = other.distance_squared(at) < one.distance_squared(at);
        if is_nearer { other } else { one }
    };
    on_edges.into_iter().fold(on_face, nearer)
}
