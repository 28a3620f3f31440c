//! When two bodies may be near each other in a slice of time: the cheapest test of a candidate.

use crate::bounds::Course;

/// The part of a slice (first and last instant, s) in which two bodies may be within the margin of
/// each other, from their courses alone; none where they certainly are not.
///
/// The difference of two straight motions is one, and within the sum of the slacks of zero only
/// between the roots of a quadratic. The slacks hold all rounding of the courses, and more than a
/// millionth of what is computed here: 2^-22 of the coordinates, where f64 rounds 2^-53.
pub(crate) fn approaching(a: &Course, b: &Course, (from, to): (f64, f64)) -> Option<(f64, f64)> {
    /// Share by which the distance is taken larger, for the rounding of the roots.
    const WIDER: f64 = 1.0 + 1e-6;
    /// Rounding of the shares of the slice, and of instants.
    const ROUNDING: f64 = 1e-9;
    let apart = [0, 1, 2].map(|axis| f64::from(a.start[axis]) - f64::from(b.start[axis]));
    let change = [0, 1, 2].map(|axis| f64::from(a.change[axis]) - f64::from(b.change[axis]));
    let radius = (f64::from(a.slack) + f64::from(b.slack)) * WIDER;
    let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    let square = dot(change, change);
    // Without motion, or beyond the range of numbers, there is no telling when.
    let nearest = -dot(apart, change) / square;
    if !nearest.is_finite() {
        let beyond = dot(apart, apart) > radius * radius && square <= 0.0;
        return (!beyond).then_some((from, to));
    }
    let foot = [0, 1, 2].map(|axis| apart[axis] + nearest * change[axis]);
    let room = radius * radius - dot(foot, foot);
    if room < 0.0 {
        return None;
    }
    let half = (room / square).sqrt() + ROUNDING;
    let (enter, exit) = (nearest - half, nearest + half);
    if enter > 1.0 || exit < 0.0 {
        return None;
    }
    let instant = |share: f64| from + share * (to - from);
    let resolution = 4.0 * f64::EPSILON * from.abs().max(to.abs());
    let first = if enter > 0.0 {
        instant(enter) - resolution
    } else {
        from
    };
    let last = if exit < 1.0 {
        instant(exit) + resolution
    } else {
        to
    };
    // Numbers that are not comparable leave the whole slice.
    Some((from.max(first), to.min(last)))
}
