//! Error bounds of segments against exact arithmetic.

use super::*;
use crate::rounding::exact::{Exact, number, vector};
use crate::trajectory::exact_cubic::{assert_within, between_states, of_polynomial};
use crate::trajectory::{TimeBase, Trajectory};
use dashu::rational::RBig;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const ROUNDS: u32 = 2_000;

/// Returns 1, or in every fourth round a factor that makes all numbers smaller than 2^-1022.
fn unit(round: u32) -> f64 {
    [1.0, 1.0, 1.0, 1e-318][round as usize % 4]
}

fn made(segment: Result<Segment, Error>) -> Segment {
    segment.unwrap_or_else(|error| unreachable!("{error}"))
}

/// Asserts the extent. Lengths below 2^-1022 m are rounded to the nearest.
fn assert_near(point: DVec3, segment: &Segment) {
    let extent = segment.extent() + f64::from_bits(1);
    assert!(Exact::of(point).is_within(extent), "{segment:?}");
}

/// Asserts the error of the control points, of point 0 only its distance.
fn assert_points(segment: &Segment, exact: &[Exact; 4]) {
    for (point, exact) in segment.control_points().into_iter().zip(exact) {
        let off = Exact::of(point).minus(exact);
        assert!(off.is_within(segment.error()), "{segment:?} {off:?}");
        assert_near(point, segment);
    }
}

/// Velocities matter as much as the displacement, more, less, and against it.
#[test]
fn points_between_states() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for round in 0..ROUNDS {
        let (way, speed) = [(1.0, 1.0), (1e-3, 1.0), (1.0, 0.0)][round as usize % 3];
        let (begin, lasting) = (rng.random_range(-9.0..9.0), rng.random_range(1.0..3.0));
        let unit = unit(round);
        let mut state = |time: f64, way: f64| State {
            time,
            position: vector(&mut rng, way * unit),
            velocity: vector(&mut rng, speed * unit),
        };
        let (first, mut second) = (state(begin, way), state(begin + lasting, way));
        if round % 5 == 0 {
            second.velocity = -(second.position - first.position);
        }
        let segment = made(Segment::hermite(&first, &second, 1));
        let origin = Exact::of(first.position);
        let exact = between_states(&first, &second).map(|point| point.minus(&origin));
        assert_points(&segment, &exact);
    }
}

/// The end of a line may be rounded; then its unit is not a power of two.
#[test]
fn points_of_lines() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut inexact = 0;
    for round in 0..ROUNDS {
        let begin = [0.0, 1023.9, -1e9, 1e-3][round as usize % 4];
        let state = State {
            time: begin + rng.random_range(0.0..0.1),
            position: DVec3::ZERO,
            velocity: vector(&mut rng, unit(round / 4)),
        };
        let segment = made(Segment::line(&state, rng.random_range(0.5..2.0), 0.0, 1));
        let thirds = (number(segment.end()) - number(state.time)) / RBig::from(3);
        let step = Exact::of(state.velocity).times(&thirds);
        let exact = [0_u8, 1, 2, 3].map(|count| step.times(&RBig::from(count)));
        inexact += u32::from(segment.error() > 0.0);
        if segment.error() > 0.0 {
            assert_points(&segment, &exact);
        }
        // The last point is rounded though the motion is exact: its parts hold that.
        let whole = segment.restrict(segment.start(), segment.end());
        for (point, exact) in whole.points.into_iter().zip(&exact) {
            let off = Exact::of(point).minus(exact);
            assert!(off.is_within(whole.error), "{segment:?} {off:?}");
            assert_near(point, &segment);
        }
        let shares = [rng.random_range(0.0..0.5), rng.random_range(0.5..1.0)];
        let ends = shares.map(|share| segment.start() + (segment.end() - segment.start()) * share);
        let part = segment.restrict(ends[0], ends[1]);
        let lasting = number(segment.end()) - number(segment.start());
        let shares = ends.map(|time| (number(time) - number(segment.start())) / &lasting);
        for (number, point) in part.points.into_iter().enumerate() {
            let off = Exact::of(point).minus(&Exact::blossom(&exact, number, &shares));
            assert!(off.is_within(part.error), "{segment:?} {ends:?} {off:?}");
        }
    }
    assert!(inexact > 100, "{inexact}");
}

/// Parts of segments whose control points are off by the whole error bound, or exact.
#[test]
fn points_of_parts() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for round in 0..ROUNDS {
        let unit = unit(round);
        let begin = [0.0, 1.7e9][round as usize / 4 % 2] + rng.random_range(0.0..1.0);
        let end = begin + rng.random_range(0.5..2.0);
        let control = [0; 3].map(|_| vector(&mut rng, unit));
        let error = [0.0, 1.0][round as usize / 8 % 2] * unit;
        let segment = made(Segment::from_control_points(
            (begin, end),
            DVec3::ZERO,
            control,
            error,
            1,
        ));
        for point in control {
            assert_near(point, &segment);
        }
        // On an axis, where its length is not rounded; all off the same way.
        let off = Exact::of(DVec3::new(0.0, error, 0.0));
        let exact = segment
            .control_points()
            .map(|point| Exact::of(point).plus(&off));
        let share = |time: f64| (number(time) - number(begin)) / (number(end) - number(begin));
        let inside = |rng: &mut ChaCha8Rng| {
            (begin + (end - begin) * rng.random_range(0.0..1.0)).clamp(begin, end)
        };
        let (one, other) = (inside(&mut rng), inside(&mut rng));
        for (from, to) in [(begin, end), (one.min(other), one.max(other)), (one, one)] {
            let part = segment.restrict(from, to);
            let ends = [share(from), share(to)];
            for (number, point) in part.points.into_iter().enumerate() {
                let off = Exact::of(point).minus(&Exact::blossom(&exact, number, &ends));
                assert!(off.is_within(part.error), "{segment:?} {from} {to} {off:?}");
            }
        }
    }
}

/// Polynomials in absolute time, also far from the origin, and with terms that cancel.
#[test]
fn points_of_polynomials() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for round in 0..ROUNDS {
        let (unit, base) = (
            unit(round),
            [TimeBase::Absolute, TimeBase::SegmentLocal][round as usize / 4 % 2],
        );
        let far: f64 = [0.0, 1e3, 1e15][round as usize / 8 % 3];
        // Over a long time, what is lost by underflow grows.
        let long = [1.0, 1e9][round as usize / 24 % 2];
        let knots = [far, far + long * rng.random_range(0.5..2.0)];
        let power = |count: i32| 1.0 / (1.0 + far).powi(count);
        let mut coefficients = [3, 2, 1, 0].map(|count| {
            let size = if unit < 1.0 { unit } else { power(count) };
            vector(&mut rng, size)
        });
        if round % 3 == 0 {
            coefficients = [0.0, 1.0, -2.0 * far, far * far].map(|x| DVec3::splat(x * unit));
        }
        let Ok(motion) = Trajectory::from_coefficients(&knots, &[coefficients], base) else {
            unreachable!("all is finite")
        };
        let shift = if base == TimeBase::Absolute { far } else { 0.0 };
        let exact = of_polynomial(&coefficients, shift, knots);
        let segment = &motion.segments()[0];
        assert_within(segment, segment.control_points(), &exact, segment.error());
    }
}

/// Position and velocity vanish at the first knot except for rounding, and the next knot is the
/// next number. The double-double rounding then exceeds that of all control points.
#[test]
fn points_of_polynomials_that_vanish() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut vanishing = 0;
    for _ in 0..60_000 {
        let begin: f64 = rng.random_range(1.0..2.0);
        let mut any = || rng.random_range(-1.0..1.0);
        let (a, b): (f64, f64) = (any(), any());
        let nearest = |exact: &RBig| exact.to_f64().value();
        let time = number(begin);
        let slope = (number(a) * RBig::from(3) * &time + number(b) * RBig::from(2)) * &time;
        let c = -nearest(&slope);
        let rest = ((number(a) * &time + number(b)) * &time + number(c)) * &time;
        let d = -nearest(&rest);
        // What is left is rounded to less than that.
        if nearest(&(rest + number(d))).abs() > 2f64.powi(-58) {
            continue;
        }
        vanishing += 1;
        let coefficients = [a, b, c, d].map(|x| DVec3::X * x);
        let knots = [begin, begin.next_up()];
        let motion = Trajectory::from_coefficients(&knots, &[coefficients], TimeBase::Absolute);
        let motion = motion.unwrap_or_else(|error| unreachable!("{error}"));
        let segment = &motion.segments()[0];
        let exact = of_polynomial(&coefficients, begin, knots);
        assert_within(segment, segment.control_points(), &exact, segment.error());
    }
    assert!(vanishing > 500, "{vanishing}");
}

/// A line with the position and velocity of a cubic at an instant is off by their rounding: far from the origin, and
/// where the cubic is nearly at rest.
#[test]
fn lines_from_within_cubics() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for round in 0..ROUNDS {
        let far = DVec3::splat([0.0, 1e6][round as usize % 2]);
        let mut state = |time: f64, speed: f64| State {
            time,
            position: far + vector(&mut rng, 1.0),
            velocity: vector(&mut rng, speed),
        };
        let speed = [0.0, 1.0, 1.0][round as usize % 3];
        let (first, second) = (state(0.7, 1.0), state(2.0, speed));
        let segment = made(Segment::hermite(&first, &second, 1));
        let lasting = segment.end() - segment.start();
        let share = [rng.random_range(0.0..1.0), 1.0 - 1e-9][round as usize / 2 % 2];
        let time = segment.start() + share * lasting;
        let line = segment.line_at(time);
        let lasting = number(segment.end()) - number(segment.start());
        let share = (number(time) - number(segment.start())) / &lasting;
        let shares = [share.clone(), share + RBig::ONE];
        let points = segment.control_points().map(Exact::of);
        let [here, next] = [0, 1].map(|place| Exact::blossom(&points, place, &shares));
        let position = here.plus(&Exact::of(segment.origin()));
        // Over a third of the cubic's duration.
        let way = next.minus(&here);
        let thirds = (number(line.end()) - number(line.start())) / &lasting;
        let whole = line.restrict(line.start(), line.end());
        let exact =
            [0_u8, 1, 2, 3].map(|count| way.times(&(&thirds * RBig::from(count))).plus(&position));
        assert_within(&line, whole.points, &exact, whole.error);
    }
}
