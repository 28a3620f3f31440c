//! Polynomials, against exact arithmetic.

use dashu::rational::RBig;
use nearmiss::glam::DVec3;
use nearmiss::{Error, Fit, TimeBase, Trajectory};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const BASES: [TimeBase; 2] = [TimeBase::SegmentLocal, TimeBase::Absolute];

fn number(x: f64) -> RBig {
    RBig::try_from(x).unwrap()
}

/// Returns the coordinates of a polynomial, exactly.
fn exact<const N: usize>(polynomial: &[DVec3; N], time: &RBig) -> [RBig; 3] {
    [0, 1, 2].map(|axis| {
        let terms = polynomial
            .iter()
            .map(|coefficient| number(coefficient[axis]));
        terms.fold(RBig::ZERO, |sum, term| sum * time + term)
    })
}

fn is_within(difference: &[RBig; 3], length: f64) -> bool {
    let [x, y, z] = difference;
    x * x + y * y + z * z <= number(length) * number(length)
}

fn length(difference: &[RBig; 3]) -> f64 {
    let [x, y, z] = difference.each_ref().map(|x| x.to_f64().value());
    DVec3::new(x, y, z).length()
}

/// Returns polynomials between random knots.
fn random_plan<const N: usize>(
    rng: &mut ChaCha8Rng,
    start: f64,
    scale: f64,
) -> (Vec<f64>, Vec<[DVec3; N]>) {
    let mut knots = vec![start];
    let mut polynomials = Vec::new();
    for _ in 0..3 {
        let duration = rng.random_range(0.3..4.0);
        knots.push(knots[knots.len() - 1] + duration);
        let mut power = N;
        polynomials.push([DVec3::ZERO; N].map(|_| {
            power -= 1;
            let size = scale / f64::powi(duration, i32::try_from(power).unwrap());
            DVec3::from_array([0; 3].map(|_| size * rng.random_range(-1.0..1.0)))
        }));
    }
    (knots, polynomials)
}

/// Asserts the error of a fit at random instants, of the cubics as they are and of what positions are returned.
/// Returns the largest difference in units of the error.
fn assert_exact_error<const N: usize>(
    fit: &Fit,
    (knots, polynomials): &(Vec<f64>, Vec<[DVec3; N]>),
    base: TimeBase,
    rng: &mut ChaCha8Rng,
    instants: u32,
) -> f64 {
    let mut largest = 0.0_f64;
    for _ in 0..instants {
        let segments = fit.trajectory.segments();
        let segment = segments[rng.random_range(0..segments.len())];
        let (start, end) = (segment.start(), segment.end());
        let time = rng.random_range(start..end);
        let piece = knots.partition_point(|&knot| knot <= start) - 1;
        let since = match base {
            TimeBase::Absolute => number(time),
            TimeBase::SegmentLocal => number(time) - number(knots[piece]),
        };
        let truth = exact(&polynomials[piece], &since);
        let share = (number(time) - number(start)) / (number(end) - number(start));
        let rest = RBig::ONE - &share;
        let weights = [
            &rest * &rest * &rest,
            RBig::from(3) * &rest * &rest * &share,
            RBig::from(3) * &rest * &share * &share,
            &share * &share * &share,
        ];
        let points = segment.control_points();
        let cubic = [0, 1, 2].map(|axis| {
            let terms = weights.iter().zip(points);
            let offset = terms.fold(RBig::ZERO, |sum, (weight, point)| {
                sum + weight * number(point[axis])
            });
            number(segment.origin()[axis]) + offset - &truth[axis]
        });
        assert!(
            is_within(&cubic, fit.error()),
            "{time} {}",
            length(&cubic) / fit.error()
        );
        let position = fit.trajectory.position(time).unwrap();
        let returned = [0, 1, 2].map(|axis| number(position[axis]) - &truth[axis]);
        assert!(
            is_within(&returned, fit.error()),
            "{time} {}",
            length(&returned) / fit.error()
        );
        largest = largest.max(length(&returned) / fit.error());
    }
    largest
}

/// Tolerances from coarse to a few roundings.
fn assert_proofs(rounds: usize, instants: u32) {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let mut largest = 0.0_f64;
    for round in 0..rounds {
        let base = BASES[round % 2];
        let start = match base {
            TimeBase::Absolute => [0.0, -3.0, 5.0][round / 2 % 3],
            TimeBase::SegmentLocal => [0.0, 1e3, 1.7e9][round / 2 % 3],
        };
        let scale = [1.0, 1e4, 1e-3][round / 6 % 3];
        let tolerance = scale * [1e-1, 1e-3, 1e-6, 1e-9][round / 18 % 4];
        let plan = random_plan::<8>(&mut rng, start, scale);
        // Of absolute time, terms are much larger than their sum, and positions large.
        let time = plan.0[3].abs().max(start.abs());
        let size = |polynomial: &[DVec3; 8]| {
            let sizes = polynomial.iter().map(|term| term.length());
            sizes.fold(0.0, |sum, size| sum * time + size)
        };
        let largest_term = plan.1.iter().map(size).fold(0.0, f64::max);
        let tolerance = match base {
            TimeBase::Absolute => tolerance.max(1e-12 * largest_term),
            TimeBase::SegmentLocal => tolerance,
        };
        let fit = Trajectory::fit_polynomials(&plan.0, &plan.1, base, tolerance).unwrap();
        assert!(fit.is_proven() && fit.error() <= tolerance);
        assert!(
            plan.0
                .iter()
                .all(|knot| fit.trajectory.knots().contains(knot))
        );
        largest = largest.max(assert_exact_error(&fit, &plan, base, &mut rng, instants));
    }
    println!("largest difference: {largest} errors");
    assert!(largest > 0.9, "{largest}");
}

#[test]
fn no_proven_error_is_exceeded() {
    assert_proofs(144, 140);
}

#[test]
#[ignore = "a campaign of some minutes of exact arithmetic: a million instants"]
fn no_proven_error_is_exceeded_at_a_million_instants() {
    assert_proofs(1440, 700);
}

/// The tolerance is little more than the rounding: the terms for it are needed.
#[test]
fn rounding_is_part_of_the_proof() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    for base in BASES {
        for round in 0..20 {
            let start = [0.0, 100.0][round % 2];
            let plan = random_plan::<4>(&mut rng, start, 1.0);
            let fit = Trajectory::fit_polynomials(&plan.0, &plan.1, base, 1.0).unwrap();
            // A cubic stays one: only rounding is left.
            assert_eq!(fit.knot_count(), 4);
            let reached = if base == TimeBase::Absolute { 1e8 } else { 1.0 };
            assert!(fit.error() < 1e-13 * reached, "{}", fit.error());
            assert_exact_error(&fit, &plan, base, &mut rng, 100);
        }
    }
}

/// Of each polynomial alone, as many equal parts as the truth allows.
#[test]
fn even_spacing_needs_almost_as_many_knots() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    for round in 0..60 {
        let (knots, polynomials) = random_plan::<8>(&mut rng, 0.0, 10.0);
        let tolerance = [1e-2, 1e-4, 1e-6][round % 3];
        let (knots, polynomial) = (&knots[..2], polynomials[0]);
        let base = TimeBase::SegmentLocal;
        let fit = Trajectory::fit_polynomials(knots, &[polynomial], base, tolerance).unwrap();
        let limit = (fit.knot_count() * 10).div_ceil(13);
        let at = move |time: f64| {
            let position = polynomial
                .iter()
                .fold(DVec3::ZERO, |sum, &term| sum * time + term);
            let (mut velocity, mut power) = (DVec3::ZERO, 7.0);
            for &term in &polynomial[..7] {
                velocity = velocity * time + power * term;
                power -= 1.0;
            }
            (position, velocity)
        };
        let case = crate::motions::Case {
            name: "polynomial",
            motion: Box::new(at),
            window: [knots[0], knots[1]],
            tolerances: [tolerance; 2],
            fourth_derivative: None,
        };
        let uniform = case.uniform_knots(tolerance, limit);
        assert!(
            uniform.is_none(),
            "{} knots, evenly {uniform:?}",
            fit.knot_count()
        );
    }
}

/// Powers of a time that overflow do not count where they have no coefficient.
#[test]
fn low_degrees_have_no_high_powers() {
    let still = [DVec3::ONE];
    let knots = [0.0, 1e46];
    let fit = Trajectory::fit_polynomials(&knots, &[still], TimeBase::SegmentLocal, 1e-3).unwrap();
    assert_eq!(fit.knot_count(), 2);
    assert!(fit.error() < 1e-12, "{}", fit.error());
    let uniform = [1e-40 * DVec3::X, DVec3::ONE];
    let fit =
        Trajectory::fit_polynomials(&knots, &[uniform], TimeBase::SegmentLocal, 1e-3).unwrap();
    assert_eq!(fit.knot_count(), 2);
}

/// The number of knots between all that are given has one limit; no velocity was told, and there is no option.
#[test]
fn the_limit_of_knots_is_named() {
    let quintic = [1.875, -9.375, 12.5, 0.0, 0.0, 0.0].map(|c| c * DVec3::X);
    let count = 4_000_u32;
    let knots: Vec<f64> = (0..=count).map(|knot| 2.0 * f64::from(knot)).collect();
    let all = vec![quintic; knots.len() - 1];
    let fit = Trajectory::fit_polynomials(&knots, &all, TimeBase::SegmentLocal, 1e-10);
    let Err(Error::FitKnots { limit, time }) = fit else {
        panic!("{fit:?}");
    };
    assert_eq!(limit, 1_000_000);
    assert!(time > 1.0 && time < 2.0 * f64::from(count));
}
