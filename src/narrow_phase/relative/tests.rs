//! Error terms of a relative motion against exact arithmetic, each where it dominates.

use super::*;
use crate::rounding::exact::{Exact, number, vector};
use crate::trajectory::{State, TimeBase, Trajectory};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const ROUNDS: u32 = 3_000;

/// Returns a motion with these exact control points.
fn motion(apart: DVec3, local: [DVec3; 4], error: f64) -> RelativeMotion {
    RelativeMotion {
        start: 0.0,
        end: 1.0,
        apart,
        local,
        error,
    }
}

fn body(states: &[State; 2]) -> Trajectory {
    Trajectory::from_states(states).unwrap_or_else(|error| unreachable!("{error}"))
}

/// Large terms that cancel: origins, offsets, the cubics' own points, all of them, none.
#[test]
fn sums_are_within_the_error() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for round in 0..ROUNDS {
        let [origin, offset, way] = [
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 1.0],
            [1e-3, 0.0, 1.0],
            [1e-9, 1.0, 1e-3],
            [1e-3, 1e-9, 1e-9],
            [1.0, 1.0, 1.0],
        ][round as usize % 7];
        let origins = [vector(&mut rng, origin), vector(&mut rng, 1e-3 * origin)];
        let mut offsets = [vector(&mut rng, offset), vector(&mut rng, 1e-3 * offset)];
        let mut points = [0; 2].map(|_| [0; 4].map(|_| vector(&mut rng, way)));
        let apart = origins[0] - origins[1];
        if offset >= 1.0 {
            // What is left of both is small.
            offsets[0] = offsets[1] - apart + vector(&mut rng, 1e-6);
        } else if way >= 1.0 && round % 2 == 0 {
            points[0] = points[1].map(|point| point - apart + vector(&mut rng, 1e-6));
        }
        let local = [0, 1, 2, 3].map(|j| points[0][j] - points[1][j]);
        let cubic = motion(apart, local, 0.0).of_spheres(offsets[0] - offsets[1]);
        let [a, b] = [0, 1].map(|k: usize| Exact::of(origins[k]).plus(&Exact::of(offsets[k])));
        for (j, point) in cubic.points.into_iter().enumerate() {
            let exact = Exact::of(points[0][j]).minus(&Exact::of(points[1][j]));
            let off = Exact::of(point).minus(&a.minus(&b).plus(&exact));
            assert!(off.is_within(cubic.error), "{round} {cubic:?} {off:?}");
        }
    }
}

/// Differences half-way between two numbers, and a norm rounded down: only the bound's terms of
/// second order remain.
#[test]
fn sums_are_within_the_error_to_second_order() {
    let size = DVec3::new(1.0, 2f64.powi(-26), 0.0);
    // Exactly size (1 + u), rounded to size; and the origins are as far apart as that was rounded by.
    let lost = UNIT_ROUNDOFF * size;
    let local = size - -lost;
    let cubic = motion(lost, [local; 4], 0.0).of_spheres(DVec3::ZERO);
    let exact = Exact::of(size)
        .plus(&Exact::of(lost))
        .plus(&Exact::of(lost));
    for point in cubic.points {
        let off = exact.minus(&Exact::of(point));
        assert!(off.is_within(cubic.error), "{cubic:?} {off:?}");
    }
}

#[test]
fn errors_of_both_bodies_add_up() {
    let states = |size: f64| {
        [0.0, 1.0].map(|time| State::new(time, DVec3::ZERO, DVec3::X * size * (time - 0.5)))
    };
    let (small, large) = (body(&states(1e-9)), body(&states(1.0)));
    let whole = (0.0, 1.0);
    let large_error = large.segments()[0].restrict(0.0, 1.0).error;
    for (a, b) in [(&small, &large), (&large, &small)] {
        let cubic = RelativeCubic::between(&a.segments()[0], &b.segments()[0], whole, DVec3::ZERO);
        assert!(cubic.error >= large_error);
    }
}

/// Values of exact cubics are within the tolerance.
#[test]
fn distances_are_within_the_tolerance() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for round in 0..ROUNDS {
        let local = [0; 4].map(|_| vector(&mut rng, 1.0));
        let size = largest_norm(&local);
        let cubic = RelativeCubic {
            start: 0.0,
            end: 1.0,
            points: local,
            error: [0.0, 0.5][round as usize % 2],
            size,
        };
        let s: f64 = rng.random_range(0.0..1.0);
        let shares = [number(s), number(s)];
        // The exact cubic is off by the error, away from the origin.
        let (position, _) = cubic.at(s);
        let off = position.normalize() * cubic.error;
        let exact = local.map(|point| Exact::of(point).plus(&Exact::of(off)));
        let exact = Exact::blossom(&exact, 0, &shares);
        let (distance, tolerance) = (cubic.distance(s), cubic.tolerance());
        assert!(exact.is_within(distance + tolerance), "{cubic:?} {s}");
        let inner = distance - tolerance;
        assert!(inner < 0.0 || !exact.is_within(inner), "{cubic:?} {s}");
    }
}

/// Instants near the ends of the span, near zero between both, and beyond a power of two.
#[test]
fn instants_are_enclosed() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for round in 0..20_000 {
        let (start, end) = [(0.0, 1.0), (-0.3, 0.7), (1e9, 1e9 + 3.0), (-1e-3, 5.0)][round % 4];
        let (start, end) = (
            start + 1e-3 * rng.random_range(-1.0..1.0),
            end + 1e-3 * rng.random_range(-1.0..1.0),
        );
        let mut cubic = motion(DVec3::X, [DVec3::ZERO; 4], 0.0).of_spheres(DVec3::ZERO);
        (cubic.start, cubic.end) = (start, end);
        let mut s = rng.random_range(0.0..1.0);
        if round % 3 == 0 && start < 0.0 && end > 0.0 {
            s = -start / (end - start);
        }
        let exact = number(start) + number(s) * (number(end) - number(start));
        let (earliest, latest) = (cubic.earliest(s), cubic.latest(s));
        assert!(
            number(earliest) <= exact && exact <= number(latest),
            "{start} {end} {s}"
        );
    }
}

/// Returns an exact body at rest.
fn resting(position: DVec3) -> Segment {
    match Trajectory::at_rest(position) {
        Ok(body) => body.segment_after(),
        other => unreachable!("{other:?}"),
    }
}

/// A rejection keeps twice the solver's tolerance, and a hundred roundings of its own, whatever
/// dominates the scale: origins, offsets, displacement, the motion's own error.
#[test]
fn rejections_keep_clear_of_the_tolerance() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for round in 0..ROUNDS {
        let [far, offset, way] = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [1e-320, 0.0, 0.0],
            [0.0, 0.0, 1e-320],
        ][round as usize % 6];
        let mut flight = |sign: f64| {
            let place = vector(&mut rng, far);
            let states = [0.0, 1.0]
                .map(|time| State::new(time, place + sign * way * DVec3::X * time, DVec3::X * way));
            body(&states)
        };
        let (a, b) = (flight(1.0), flight(-1.0));
        let (mut a, mut b) = (a.segments()[0], b.segments()[0]);
        if way <= 0.0 && round % 4 < 2 {
            (a, b) = (resting(a.origin()), resting(b.origin()));
        }
        let (a, b) = (&a, &b);
        let known = |x: f64| {
            let places = [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, DVec3::X * x];
            let motion = Trajectory::from_coefficients(&[0.0, 1.0], &[places], TimeBase::Absolute);
            motion.unwrap_or_else(|error| unreachable!("{error}"))
        };
        let (far_a, far_b) = (known(1e9), known(1e9 + 1.0));
        let (a, b) = if round % 5 == 0 {
            (&far_a.segments()[0], &far_b.segments()[0])
        } else {
            (a, b)
        };
        let offset = vector(&mut rng, offset);
        for span in [(0.0, 1.0), (0.25, 0.75)] {
            let cubic = RelativeCubic::between(a, b, span, offset);
            let scale = local_scale(a, b, span, offset);
            let size = a.extent() + b.extent() + norm(a.origin() - b.origin()) + norm(offset);
            let needed = 2.0 * cubic.tolerance() + 100.0 * UNIT_ROUNDOFF * size;
            assert!(
                rejection_threshold(0.0, scale) >= needed,
                "{round} {cubic:?}"
            );
            let radius = cubic.size;
            let kept = rejection_threshold(radius, scale) - radius;
            assert!(kept >= needed * (1.0 - 1e-3), "{round} {cubic:?}");
        }
    }
}

/// Returns a unit vector to rounding, or off by as much as is accepted.
fn normal(rng: &mut ChaCha8Rng) -> DVec3 {
    vector(rng, 1.0).normalize() * (1.0 + [0.0, 0.9e-9, -0.9e-9][rng.random_range(0..3)])
}

/// Vectors along the plane, of which little is left in a height: origins, ways, both; and such that
/// products underflow.
#[test]
fn heights_are_within_the_error() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for round in 0..ROUNDS {
        let [origin, way] =
            [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1e-310, 1e-310]][round as usize % 4];
        let normal = normal(&mut rng);
        let along = |rng: &mut ChaCha8Rng, size: f64| {
            let across = normal.cross(vector(rng, 1.0)).normalize();
            (across + vector(rng, 1e-9)) * size
        };
        let apart = along(&mut rng, origin);
        let local = [0; 4].map(|_| along(&mut rng, way));
        let scale = 1.0 / normal.length();
        let heights = motion(apart, local, 0.0).heights(normal, scale);
        for (local, found) in local.into_iter().zip(heights.points) {
            let exact = Exact::of(apart).plus(&Exact::of(local));
            let is_within = exact.is_at_height(normal, &number(found), heights.error);
            assert!(
                is_within,
                "{round} {apart:?} {local:?} {normal:?} {heights:?}"
            );
        }
    }
}
