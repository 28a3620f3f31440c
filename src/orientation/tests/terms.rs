//! Error terms of turning cubics, each where it dominates.

use super::*;
use crate::orientation::BakedRotation;
use crate::orientation::arc::Arc;
use crate::orientation::quaternion_cubic::QuaternionCubic;
use crate::rounding::norm;
use glam::DMat3;

/// Checks that the axes of a body are within the error of their cubics, which do not round them.
/// Returns the largest error found over the bound.
fn check(baked: &BakedRotation, (start, end): (f64, f64), given: &GivenRotation) -> f64 {
    let mut closest = 0.0_f64;
    for axis in DVec3::AXES {
        let points = baked.way(axis);
        for step in 0..=2 {
            let s = big(f64::from(step) / 2.0);
            let time = big(start) + &s * (big(end) - big(start));
            let off = off(&turned(&exact(given, &time), axis), &on_cubic(&points, &s));
            assert!(off <= baked.error(), "{off} {} {given:?}", baked.error());
            closest = closest.max(off / baked.error());
        }
    }
    closest
}

fn spin(rng: &mut ChaCha8Rng, speed: f64) -> GivenRotation {
    GivenRotation::Spin {
        time: 0.0,
        rotation: rotation(rng),
        angular_velocity: vector(rng, speed),
    }
}

/// Over so short a time that the interpolation is exact, near the origin and a million radians away.
#[test]
fn rounding_of_spins() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for time in [0.0, 1e6] {
        let mut closest = 0.0_f64;
        for _ in 0..50 {
            let given = spin(&mut rng, 1.0);
            let GivenRotation::Spin {
                rotation,
                angular_velocity,
                ..
            } = given
            else {
                unreachable!()
            };
            let unit = rotation * (1.0 / rotation.length());
            let arc = Arc::spin(0.0, unit, angular_velocity);
            let ends = (time, time + 1e-6);
            closest = closest.max(check(&arc.bake(ends, 1.0), ends, &given));
        }
        assert!(closest > 1e-3, "{time} {closest}");
    }
}

/// A rate between knots goes on for long, with small and with large angles between the knots.
#[test]
fn rounding_of_what_goes_on() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    for kind in 0..60 {
        let first = rotation(&mut rng).normalize();
        let angle = [1e-7, 1e-3, 1.0][kind % 3];
        let turn = DQuat::from_scaled_axis(vector(&mut rng, angle));
        let given = going_on(first, (turn * first).normalize())[kind % 2].clone();
        let orientation = Orientation::of(given.clone()).unwrap();
        let orientation = orientation.with_tolerance(0.1).unwrap();
        let turning = orientation.turning().unwrap();
        let time = [1e4, 3e5, 4e7][kind / 6 % 3];
        let section = turning.section_at(time, Accuracy::Exact);
        // A part of it would have the error of the interpolation.
        let mut ends = (section.start.max(time - 1.0), section.end.min(time + 1.0));
        ends.1 = ends.1.min(ends.0 + 1e-3 / angle);
        let baked = turning.pieces[2].bake(ends, 1.0);
        check(&baked, ends, &given);
    }
}

/// Returns the rotations at 0 and 1 s that go on beyond, as either kind of interpolation.
fn going_on(first: DQuat, second: DQuat) -> [GivenRotation; 2] {
    let (knots, outside) = (vec![(0.0, first), (1.0, second)], Outside::Coast);
    [
        GivenRotation::Slerp {
            knots: knots.clone(),
            outside,
        },
        GivenRotation::NormalizedCubic { knots, outside },
    ]
}

/// Neighbours that are one when they are normalised differ by rounding, which grows beyond them. Those that are one as
/// they are given are held for ever.
#[test]
fn rotations_that_differ_by_rounding_go_on() {
    let mut rng = ChaCha8Rng::seed_from_u64(28);
    for round in 0..100 {
        let first = rotation(&mut rng);
        let second = first * (1.0 + rng.random_range(-1e-10..1e-10));
        for given in going_on(first, second) {
            let orientation = Orientation::of(given.clone()).unwrap();
            let turning = orientation.turning().unwrap();
            let time = [1e4, 1e6, 1e7][round % 3];
            for time in [time, 1.0 - time] {
                let section = turning.section_at(time, Accuracy::Certified);
                let baked = turning.bake(&section, Accuracy::Certified);
                assert!(baked.error() < 2e-6, "{time} {section:?}");
                let ends = (time, time + 1.0);
                check(&baked.part(ends), ends, &given);
            }
        }
        for given in going_on(first, -first) {
            let orientation = Orientation::of(given).unwrap();
            let turning = orientation.turning().unwrap();
            let section = turning.section_at(1e300, Accuracy::Certified);
            let error = turning.bake(&section, Accuracy::Certified).error();
            assert!(error <= BakedRotation::ROUNDING, "{error}");
        }
    }
}

/// However slowly bodies turn, what is known of them at the last knot is known for some time.
#[test]
fn slow_rotations_are_known_beyond_their_knots() {
    let mut rng = ChaCha8Rng::seed_from_u64(29);
    for exponent in 5..16 {
        let first = rotation(&mut rng).normalize();
        let turn = DQuat::from_scaled_axis(vector(&mut rng, 10f64.powi(-exponent)));
        for given in going_on(first, (turn * first).normalize()) {
            let orientation = Orientation::of(given.clone()).unwrap();
            let turning = orientation.turning().unwrap();
            for (accuracy, tolerance) in [(Accuracy::Exact, 1e-3), (Accuracy::Certified, 1e-6)] {
                for time in [-1e5, -0.5, 1.5, 1e5] {
                    let section = turning.section_at(time, accuracy);
                    let baked = turning.bake(&section, accuracy);
                    let error = baked.error();
                    assert!(error < 2.0 * tolerance, "1e-{exponent} {time}: {error}");
                    let ends = (time, time + 0.25);
                    check(&baked.part(ends), ends, &given);
                }
            }
        }
    }
}

/// Hardly anything turns: what is left is rounding.
#[test]
fn rounding_of_cubics_of_quaternions() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    for round in 0..300 {
        let first = rotation(&mut rng).normalize();
        let near = [0.0, 1e-12, 1e-6][round % 3];
        let mut at = 0.0;
        let knots = (0..3).map(|_| {
            at += rng.random_range(0.1..1.0);
            let turn = DQuat::from_scaled_axis(vector(&mut rng, near));
            (at, (turn * first).normalize())
        });
        let given = GivenRotation::NormalizedCubic {
            knots: knots.collect(),
            outside: Outside::Absent,
        };
        let orientation = Orientation::of(given.clone()).unwrap();
        let turning = orientation.turning().unwrap();
        let section = turning.section_at(0.99 * at, Accuracy::Certified);
        check(
            &turning.bake(&section, Accuracy::Certified),
            (section.start, section.end),
            &given,
        );
    }
}

/// A cubic that comes near zero, or past it, has no direction there.
#[test]
fn cubics_that_vanish_are_unknown() {
    let one = DQuat::IDENTITY;
    for middle in [-0.3, -1.0 / 3.0, -0.5, -1.0] {
        let (ends, points) = ((0.0, 1.0), [one, one * middle, one * middle, one]);
        let baked = QuaternionCubic { ends, points }.bake(ends);
        assert!(baked.error() >= 1.0, "{middle} {baked:?}");
    }
}

fn matrices(rng: &mut ChaCha8Rng) -> [DMat3; 4] {
    [0; 4].map(|_| DMat3::from_quat(rotation(rng).normalize()) * rng.random_range(0.5..1.4))
}

/// Points at all distances, also where products underflow.
#[test]
fn ways_of_points_are_within_their_rounding() {
    let mut rng = ChaCha8Rng::seed_from_u64(24);
    for round in 0..400 {
        let points = matrices(&mut rng);
        let baked = BakedRotation::new((0.0, 1.0), points, 0.0);
        let point = vector(&mut rng, [1.0, 1e-300, 1e-310, 1e150][round % 4]);
        for (matrix, found) in points.iter().zip(baked.way(point)) {
            let [x, y, z] = point.to_array().map(big);
            let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
            let [a, b, c] = columns.map(|column| column.to_array().map(big));
            let place = [0, 1, 2].map(|axis| &a[axis] * &x + &b[axis] * &y + &c[axis] * &z);
            let off = off(&place, &found.to_array().map(big));
            assert!(off <= baked.error_of(point), "{round} {off} {point}");
        }
    }
}

#[test]
fn parts_are_within_their_rounding() {
    let mut rng = ChaCha8Rng::seed_from_u64(25);
    for _ in 0..200 {
        let (begin, length) = (rng.random_range(-1.0..1.0), rng.random_range(0.1..3.0));
        let whole = (begin, begin + length);
        let baked = BakedRotation::new(whole, matrices(&mut rng), 0.0);
        let start = rng.random_range(begin..begin + 0.5 * length);
        let end = rng.random_range(start..begin + length);
        let part = baked.part((start, end));
        for axis in DVec3::AXES {
            for step in 0..=2 {
                let s = big(f64::from(step) / 2.0);
                let time = big(start) + &s * (big(end) - big(start));
                let share = (time - big(whole.0)) / (big(whole.1) - big(whole.0));
                let place = on_cubic(&baked.way(axis), &share);
                let off = off(&place, &on_cubic(&part.way(axis), &s));
                assert!(off <= part.error(), "{off}");
            }
        }
    }
}

/// Spheres enlarged by the errors of their centres, as they are computed, lie in the sphere around all:
/// with any arm and radius, and where nothing is known.
#[test]
fn enlarged_spheres_are_within_reach() {
    let mut rng = ChaCha8Rng::seed_from_u64(26);
    let (mut unknown, mut closest) = (0, 0.0_f64);
    for kind in 0..600 {
        let (given, around, reach) = orientation(&mut rng, kind);
        let Ok(orientation) = Orientation::of(given) else {
            continue;
        };
        let tolerance = [0.1, 1e-3, 1e-9][kind % 3];
        let Ok(orientation) = orientation.with_tolerance(tolerance) else {
            continue;
        };
        let Some(turning) = orientation.turning() else {
            continue;
        };
        let time = around + reach * rng.random_range(-0.3..1.3);
        let section = turning.section_at(time, Accuracy::Exact);
        let baked = turning.bake(&section, Accuracy::Exact);
        unknown += usize::from(baked.error() >= 1.0);
        let [arm, radius] = [[1.0, 1.0], [1e-6, 1e6], [1.0, 0.0], [1e-310, 0.0]][kind / 3 % 4];
        let (centre, radius) = (vector(&mut rng, arm), rng.random_range(0.0..=radius));
        let enlarged = baked.radius_and_error((centre, radius), Accuracy::Exact).0;
        assert!(big(enlarged) >= big(radius) + big(baked.error_of(centre)));
        let farthest = norm(centre).next_up();
        let bound = turning.reach((farthest + radius).next_up(), farthest);
        let points = baked.way(centre);
        for step in 0..=8 {
            let place = on_cubic(&points, &big(f64::from(step) / 8.0));
            let needed = length(&place) + big(enlarged);
            assert!(needed <= big(bound), "{kind} {baked:?} {centre} {radius}");
            let excess = (needed - big(farthest)).to_f64().value() - radius;
            closest = closest.max(excess / (tolerance * farthest));
        }
    }
    assert!(unknown < 30 && closest > 0.9, "{unknown} {closest}");
}
