//! Cheap tests that reject only pairs that are certainly apart.
//!
//! Each examines the Bézier hull of the relative motion over a span or a part of one. The exact
//! solver decides the rest; [`CLEARANCE`](crate::rounding::CLEARANCE) explains why the tests never
//! reject a contact that the solver would report.

use crate::rounding::norm;
use crate::trajectory::Segment;
use glam::DVec3;

/// Returns true if two bodies stay farther apart than `threshold` (m) along this cubic.
///
/// `threshold` comes from [`rejection_threshold`](super::relative::rejection_threshold).
pub(crate) fn certainly_beyond(points: &[DVec3; 4], threshold: f64) -> bool {
    let [p0, p1, p2, p3] = *points;
    let low = p0.min(p1).min(p2.min(p3));
    let high = p0.max(p1).max(p2.max(p3));
    beyond_on_an_axis(low, high, threshold) || beyond_in_a_direction(points, threshold)
}

/// Returns true if the boxes of two whole segments are farther apart than `threshold` (m) on some
/// axis, without restriction to a common interval. Both must be used within their own knots.
pub(crate) fn segments_apart(a: &Segment, b: &Segment, offset: DVec3, threshold: f64) -> bool {
    let hull = |segment: &Segment| {
        let [_, p1, p2, p3] = segment.control_points();
        let low = p1.min(p2).min(p3).min(DVec3::ZERO);
        let high = p1.max(p2).max(p3).max(DVec3::ZERO);
        (low, high)
    };
    let apart = (a.origin() - b.origin()) + offset;
    let ((low_a, high_a), (low_b, high_b)) = (hull(a), hull(b));
    beyond_on_an_axis(
        apart + (low_a - high_b),
        apart + (high_a - low_b),
        threshold,
    )
}

/// Returns true if the box `low..=high` lies beyond the threshold on one axis.
fn beyond_on_an_axis(low: DVec3, high: DVec3, threshold: f64) -> bool {
    low.max_element() > threshold || high.min_element() < -threshold
}

/// Returns true if all control points lie beyond the threshold in the direction of their sum.
fn beyond_in_a_direction(points: &[DVec3; 4], threshold: f64) -> bool {
    let sum = (points[0] + points[3]) + (points[1] + points[2]);
    let length = norm(sum);
    if length <= 0.0 || !length.is_finite() {
        return false;
    }
    // The unit vector is good to a few roundings, which the threshold's clearance covers.
    let direction = sum / length;
    points.iter().all(|point| point.dot(direction) > threshold)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow_phase::profile::DistanceProfile;
    use crate::narrow_phase::relative::{RelativeCubic, local_scale, rejection_threshold};
    use crate::trajectory::{State, Trajectory};
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Returns a segment of random size and place, over -1..2 s.
    fn segment(rng: &mut ChaCha8Rng) -> Trajectory {
        let far = 10f64.powf(rng.random_range(-3.0..6.0));
        let size = 10f64.powf(rng.random_range(-3.0..3.0));
        let mut vector =
            |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
        let base = vector(far);
        let states = [-1.0, 2.0].map(|time| State::new(time, base + vector(size), vector(size)));
        Trajectory::from_states(&states).unwrap_or_else(|error| unreachable!("{error}"))
    }

    /// No test rejects a contact that the solver reports at a threshold within a few roundings of
    /// the minimum, on the whole span or on any part with the contact.
    #[test]
    fn filters_never_reject_what_the_solver_reports() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (mut reported, mut rejected) = (0, 0);
        for _ in 0..20_000 {
            let (a, b) = (segment(&mut rng), segment(&mut rng));
            let (a, b) = (&a.segments()[0], &b.segments()[0]);
            let whole = (0.25, 1.75);
            let cubic = RelativeCubic::between(a, b, whole, DVec3::ZERO);
            let scale = local_scale(a, b, whole, DVec3::ZERO);
            let profile = DistanceProfile::of(&cubic);
            let least = profile.closest(&cubic, whole.0, whole.1);
            let off = rng.random_range(-2.0..2.0) * cubic.tolerance();
            let radius = (least.distance + off).max(0.0);
            let threshold = rejection_threshold(radius, scale);
            let mut contacts = Vec::new();
            profile.intervals_within(&cubic, radius, whole, |ends, _| contacts.push(ends));
            if contacts.is_empty() {
                continue;
            }
            reported += 1;
            assert!(!certainly_beyond(&cubic.points, threshold));
            assert!(!segments_apart(a, b, DVec3::ZERO, threshold));
            for (enter, exit) in contacts {
                let from = enter - rng.random_range(0.0..0.2) * (enter - whole.0);
                let to = exit + rng.random_range(0.0..0.2) * (whole.1 - exit);
                let part = RelativeCubic::between(a, b, (from, to), DVec3::ZERO);
                assert!(!certainly_beyond(&part.points, threshold), "{enter} {exit}");
            }
            // The tests do reject: a radius of half the least distance, mostly.
            let half = rejection_threshold(0.5 * radius, scale);
            rejected += u32::from(certainly_beyond(&cubic.points, half));
        }
        assert!(reported > 10_000, "{reported}");
        assert!(rejected > 5_000, "{rejected}");
    }
}
