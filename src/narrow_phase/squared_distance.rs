//! A proof about a span by the Bernstein coefficients of the squared distance, before any root is sought.

use super::relative::RelativeCubic;
use crate::enclosure::squared_distance;
use crate::rounding::{UNIT_ROUNDOFF, scale_to_one};

/// Returns true if the distance certainly rises or certainly falls over the whole span. The
/// solver's rounding is covered: it would find no stationary point between the ends.
///
/// A polynomial in Bernstein form rises if its Bernstein coefficients do. Most spans of a long contact
/// pass this test, at a tenth of the cost of a root search.
pub(super) fn is_monotonic(cubic: &RelativeCubic) -> bool {
    /// Least difference of neighbouring coefficients, in a unit (a power of two) for which the largest norm of a control
    /// point lies in [1, 2). Each coefficient has an error of at most 7 roundings of 4: three of a scalar product, four of
    /// the weighted mean of two.
    ///
    /// The derivative over u in -1..=1, whose roots the solver seeks, is 3 times a mean of the
    /// differences. Its power coefficients sum up to 300 at most; each is wrong by 18 roundings
    /// of its bound, evaluation adds 11, and 28 are taken for zero: 17,000 roundings, against
    /// 390,000.
    const STEP: f64 = 131_072.0 * UNIT_ROUNDOFF;
    let power = scale_to_one(cubic.size);
    let bernstein = squared_distance(&cubic.points.map(|point| point * power));
    let (mut least, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    for ends in bernstein.windows(2) {
        let step = ends[1] - ends[0];
        least = if step < least { step } else { least };
        largest = if step > largest { step } else { largest };
    }
    least > STEP || largest < -STEP
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow_phase::stationary::stationary_points;
    use glam::DVec3;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn cubic(points: [DVec3; 4]) -> RelativeCubic {
        RelativeCubic {
            start: 0.0,
            end: 1.0,
            points,
            error: 0.0,
            size: crate::rounding::largest_norm(&points),
        }
    }

    /// Returns the part from `from` on of a cubic given by its control points.
    fn rest([p0, p1, p2, p3]: [DVec3; 4], from: f64) -> [DVec3; 4] {
        let (q0, q1, q2) = (p0.lerp(p1, from), p1.lerp(p2, from), p2.lerp(p3, from));
        let (r0, r1) = (q0.lerp(q1, from), q1.lerp(q2, from));
        [r0.lerp(r1, from), r1, q2, p3]
    }

    /// If the test holds, the solver finds no stationary point, also next to one.
    #[test]
    fn what_is_monotonic_has_no_stationary_point() {
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let (mut monotonic, mut others, mut beside) = (0, 0, 0);
        for round in 0..100_000 {
            let size = 10f64.powf(rng.random_range(-3.0..6.0));
            let mut vector =
                |half: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)));
            let (place, speed) = (vector(size), vector(size));
            let mut points = match round % 4 {
                // Any four points; docking: still at the end, or even without acceleration.
                0 => [0; 4].map(|_| vector(size)),
                1 => [place, place, place + speed, place + vector(size)],
                2 => [place, place, place, place + speed],
                // Across its own distance at the start: the squared distance grows like s² there.
                _ => [0.0, 1.0, 2.0, 3.0].map(|step| place + step * speed.cross(place) / size),
            };
            let stationary = stationary_points(&cubic(points));
            if let Some(&last) = stationary.as_slice().last()
                && round % 8 < 4
            {
                points = rest(points, last);
            }
            let share = 10f64.powf(rng.random_range(-17.0..-1.0));
            points = rest(points, share);
            let cubic = cubic(points);
            let found = stationary_points(&cubic);
            if is_monotonic(&cubic) {
                assert!(found.as_slice().is_empty(), "{round} {points:?}");
                monotonic += 1;
                beside += u32::from(share < 1e-3);
            } else {
                others += u32::from(found.as_slice().is_empty());
            }
        }
        // Enough of each kind; what is not proven is little more than what cannot be.
        assert!(
            monotonic > 20_000 && beside > 1_000,
            "{monotonic} {others} {beside}"
        );
    }
}
