//! Hull test of two bodies that each follow one cubic: in f32, from their compact trajectories.

use super::ROUNDING;
use super::compact_cubic::CompactCubic;
use super::source::CubicSource;
use glam::Vec3A;

/// One body on one of its cubics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyCubic<'a> {
    pub(crate) source: &'a CubicSource<'a, CompactCubic>,
    pub(crate) cubic: usize,
}

/// The outcome of a [hull test](hull_test).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HullTest {
    /// The bodies certainly stay apart by more than the margin.
    Apart,
    /// The bodies may come near. Rounding is small: the same test in f64 would rule out little more.
    Near,
    /// Undecided: f32 rounding is too large next to the distance in question, or one of the bodies turns and has long arms. A test in
    /// f64 may still show that the bodies stay apart.
    Undecided,
}

/// Tests two bodies from `from` to `to` (s), within one cubic of each. They are apart if all
/// control points of the relative motion lie beyond the margin on an axis or along their sum.
pub(crate) fn hull_test(a: &BodyCubic<'_>, b: &BodyCubic<'_>, interval: (f64, f64)) -> HullTest {
    if a.source.knots.has_unlisted_cubics() || b.source.knots.has_unlisted_cubics() {
        hull_test_of::<true>(a, b, interval)
    } else {
        hull_test_of::<false>(a, b, interval)
    }
}

#[inline(always)]
fn hull_test_of<const UNLISTED: bool>(
    a: &BodyCubic<'_>,
    b: &BodyCubic<'_>,
    (from, to): (f64, f64),
) -> HullTest {
    /// Largest rounding, as a share of the radius, with which the outcome is `Near`, not `Undecided`.
    const SMALL: f32 = 0.25;
    let part = |body: &BodyCubic<'_>| {
        let piece = body.source.sub_cubic::<UNLISTED>(body.cubic);
        let placement = &body.source.placement;
        let piece = piece.part(from, to);
        let rounding = piece.rounding() + placement.constant_rounding;
        (
            piece.points,
            rounding + placement.origin.abs() * (6.0 * ROUNDING),
        )
    };
    let ((points_a, rounding_a), (points_b, rounding_b)) = (part(a), part(b));
    let (placement_a, placement_b) = (&a.source.placement, &b.source.placement);
    let apart = placement_a.origin - placement_b.origin;
    let points = [0, 1, 2, 3].map(|j| Vec3A::from_vec4(apart + (points_a[j] - points_b[j])));
    let rounding = Vec3A::from_vec4(rounding_a + rounding_b);
    // Its rounding is in both placements'.
    let radius = placement_a.reach + placement_b.reach;
    let [p0, p1, p2, p3] = points;
    let (low, high) = (p0.min(p1).min(p2.min(p3)), p0.max(p1).max(p2.max(p3)));
    let bound = rounding + radius;
    if (low.cmpgt(bound) | high.cmplt(-bound)).any() {
        return HullTest::Apart;
    }
    let sum = (p0 + p3) + (p1 + p2);
    let square = sum.length_squared();
    // Products of coordinates have three roundings of their own. `rounding` counts six of each origin and point, and
    // the difference uses three of them: three are left. The bound has seven roundings of the radius; `constant_rounding`
    // counts eight on each axis.
    let total_rounding = rounding.element_sum();
    let beyond = (radius + total_rounding) * square.sqrt();
    // With smaller squares digits are lost, with larger ones everything.
    if (1e-30..1e30).contains(&square) && points.iter().all(|point| point.dot(sum) > beyond) {
        return HullTest::Apart;
    }
    let has_long_arms = placement_a.has_long_arms | placement_b.has_long_arms;
    if total_rounding <= SMALL * radius && !has_long_arms {
        HullTest::Near
    } else {
        HullTest::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::{CompactTrajectory, DAabb, Frame, Padding};
    use crate::hitbox::Hitbox;
    use crate::trajectory::{State, Trajectory};
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// Two bodies are never apart by less than their least distance, however far from each other
    /// and the scene's middle; mostly they are by a third of it.
    #[test]
    fn what_comes_near_is_not_apart() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut rejected = 0;
        for round in 0..3_000 {
            let size = 10f64.powf(rng.random_range(-3.0..3.0));
            let far = size * [1.0, 1e4, 1e6][round % 3];
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
            let (middle, base) = (vector(far), vector(far));
            let mut flight = || {
                let states = [0.0, 1.0, 3.0].map(|time| {
                    let position = base + vector(size);
                    State::new(time, position, vector(size))
                });
                let Ok(flight) = Trajectory::from_states(&states) else {
                    unreachable!("the states are in order")
                };
                flight
            };
            let flights = [flight(), flight()];
            let (from, to) = (rng.random_range(1.0..=1.5), rng.random_range(2.0..=3.0));
            let distance = |time: f64| {
                let [a, b] = [0, 1].map(|k: usize| flights[k].position(time).unwrap_or_default());
                a.distance(b)
            };
            let nearest = (0..=64)
                .map(|step| distance((from + (to - from) * f64::from(step) / 64.0).min(to)))
                .fold(f64::INFINITY, f64::min);
            let extremes = DAabb {
                low: middle,
                high: middle,
            };
            let frame = Frame::around(extremes, far);
            let compacts = [0, 1]
                .map(|k: usize| CompactTrajectory::of(flights[k].knots(), flights[k].segments()));
            let is_apart = |margin: f64| {
                let point = Hitbox::POINT;
                let padding = Padding::of(&point, margin, &frame);
                let sources = compacts.each_ref().map(|(compact, cache_lines)| {
                    let view = compact.on(cache_lines);
                    CubicSource::compact(view.knots, &view, &padding, &frame)
                });
                let [a, b] = [0, 1].map(|k: usize| BodyCubic {
                    source: &sources[k],
                    cubic: 1,
                });
                hull_test(&a, &b, (from, to)) == HullTest::Apart
            };
            assert!(!is_apart(nearest), "{round}");
            rejected += u32::from(is_apart(nearest / 3.0));
        }
        assert!(rejected > 1_000, "{rejected}");
    }
}
