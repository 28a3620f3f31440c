//! Parts of a cubic, each formed from the control points of the whole (module documentation, section 1).

use crate::blossom::{ControlPolygon, restrict};
use glam::DVec3;

/// Returns the parts before and after `s`, both counted from `s` (de Casteljau).
#[inline(always)]
pub(crate) fn split(points: &ControlPolygon, s: f64) -> [ControlPolygon; 2] {
    let [h0, h1, h2, h3] = *points;
    let (a0, a1, a2) = (lerp(h0, h1, s), lerp(h1, h2, s), lerp(h2, h3, s));
    let (b0, b1) = (lerp(a0, a1, s), lerp(a1, a2, s));
    let c = lerp(b0, b1, s);
    [[c, b0, a0, h0], [c, b1, a2, h3]]
}

/// Returns the part from `start` to `end`, counted from `start` (blossoms).
#[inline(always)]
pub(crate) fn part(points: &ControlPolygon, start: f64, end: f64) -> ControlPolygon {
    restrict(points, |p, q| lerp(p, q, start), |p, q| lerp(p, q, end))
}

/// Returns the part counted from its other end.
#[inline(always)]
pub(crate) fn reversed([a, b, c, d]: ControlPolygon) -> ControlPolygon {
    [d, c, b, a]
}

/// Returns the part counted from its nearer end, and true if that is the other end. Free of
/// branches, for vectors.
#[inline(always)]
pub(crate) fn from_nearer(points: &ControlPolygon) -> (ControlPolygon, bool) {
    let [p0, p1, p2, p3] = *points;
    let is_reversed = p3.length_squared() < p0.length_squared();
    let points = [
        select(is_reversed, p3, p0),
        select(is_reversed, p2, p1),
        select(is_reversed, p1, p2),
        select(is_reversed, p0, p3),
    ];
    (points, is_reversed)
}

#[inline(always)]
fn select(first: bool, a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        if first { a.x } else { b.x },
        if first { a.y } else { b.y },
        if first { a.z } else { b.z },
    )
}

#[inline]
pub(super) fn point(points: &ControlPolygon, s: f64) -> DVec3 {
    let [h0, h1, h2, h3] = *points;
    let (a0, a1, a2) = (lerp(h0, h1, s), lerp(h1, h2, s), lerp(h2, h3, s));
    lerp(lerp(a0, a1, s), lerp(a1, a2, s), s)
}

#[inline(always)]
fn lerp(a: DVec3, b: DVec3, s: f64) -> DVec3 {
    a * (1.0 - s) + b * s
}

/// Returns the Bernstein coefficients of the squared distance, of degree 6.
#[inline]
pub(crate) fn squared_distance(h: &ControlPolygon) -> [f64; 7] {
    [
        h[0].dot(h[0]),
        h[0].dot(h[1]),
        (2.0 * h[0].dot(h[2]) + 3.0 * h[1].dot(h[1])) * 0.2,
        (h[0].dot(h[3]) + 9.0 * h[1].dot(h[2])) * 0.1,
        (2.0 * h[1].dot(h[3]) + 3.0 * h[2].dot(h[2])) * 0.2,
        h[2].dot(h[3]),
        h[3].dot(h[3]),
    ]
}
