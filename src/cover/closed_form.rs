//! Covers that follow from a formula.

use super::certificate::Certified;
use super::form::SolidForm;
use super::solid::{Solid, SolidPart};
use crate::count::as_f64;
use glam::DVec3;

/// Spare of a capsule's radii, in diameters: a proof by polyhedra needs some.
const SPARE: f64 = 2e-7;

/// Returns the best cover of a point, a ball or a capsule.
///
/// The balls of a capsule have the radius R = r + E. The outer ones lie E inside the ends of its
/// segment, where they touch the round ends from outside. Neighbours meet at the distance r from
/// the axis, so half their distance h has h² + r² = R², and the segment's length is
/// 2 E + 2 (K - 1) h.
pub(super) fn closed_form(solid: &Solid, count: usize) -> Option<Certified> {
    // The same proof for given spheres needs some of it.
    let rounding = 4.0 * solid.rounding;
    if solid.diameter <= 0.0 {
        let radius = if solid.is_exact { 0.0 } else { rounding };
        return Some(Certified {
            balls: vec![(DVec3::ZERO, radius)],
            overshoot: 2.0 * radius,
            expected: 0.0,
        });
    }
    let [SolidPart::Convex(convex)] = &solid.parts[..] else {
        return None;
    };
    let SolidForm::Capsule { ends, radius } = convex.form() else {
        return None;
    };
    let length = ends[0].distance(ends[1]);
    if length <= 0.0 {
        // At the origin a ball is what was given.
        let is_given = solid.balls[0].is_some_and(|ball| ball.offset == solid.origin);
        let spare = if is_given { 0.0 } else { rounding };
        return Some(Certified {
            balls: vec![(ends[0], radius + spare)],
            overshoot: 2.0 * spare,
            expected: 0.0,
        });
    }
    let gaps = as_f64(count - 1);
    let half_gap = |overshoot: f64| (overshoot * (overshoot + 2.0 * radius)).sqrt();
    let (mut low, mut high) = (0.0, length / 2.0);
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if 2.0 * middle + 2.0 * gaps * half_gap(middle) < length {
            low = middle;
        } else {
            high = middle;
        }
    }
    let direction = (ends[1] - ends[0]) / length;
    let spacing = if count == 1 {
        0.0
    } else {
        (length - 2.0 * high) / gaps
    };
    let mut along = high;
    let mut balls = Vec::with_capacity(count);
    let spare = SPARE * solid.diameter + rounding;
    for _ in 0..count {
        balls.push((ends[0] + direction * along, radius + high + spare));
        along += spacing;
    }
    Some(Certified {
        balls,
        overshoot: high + 2.0 * spare,
        expected: high,
    })
}
