//! Roundings of a quadratic's answers against exact arithmetic, with worst-case errors of a cubic.

use super::super::stationary::stationary_reach;
use super::Minorant;
use crate::rounding::UNIT_ROUNDOFF;
use crate::rounding::exact::number;
use dashu::rational::RBig;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Returns a quadratic of any size; its parts may differ much in size, or one may be next to zero.
fn any(rng: &mut ChaCha8Rng) -> Minorant {
    let mut size = || 10f64.powf(rng.random_range(-3.0..3.0));
    let (base, slope, leading) = (size(), size(), size());
    let sign = |rng: &mut ChaCha8Rng| [-1.0, 1.0][rng.random_range(0..2)];
    let base = [base, 1.0_f64.next_down(), 0.0][rng.random_range(0..3)];
    let slope = sign(rng) * slope;
    let leading =
        sign(rng) * [leading, slope.abs() * rng.random_range(0.9..1.1)][rng.random_range(0..2)];
    Minorant {
        base,
        slope,
        leading,
        floor: [f64::NEG_INFINITY, -size_of(rng)][rng.random_range(0..2)],
    }
}

fn size_of(rng: &mut ChaCha8Rng) -> f64 {
    10f64.powf(rng.random_range(-3.0..3.0))
}

/// Returns the least exact squared distance whose computed value may be the base (three roundings).
fn least_base(minorant: &Minorant) -> RBig {
    number(minorant.base) * (number(1.0) - number(3.0 * UNIT_ROUNDOFF))
}

/// Returns the quadratic's increase from the base to `x`.
fn at(minorant: &Minorant, x: &RBig) -> RBig {
    (number(minorant.leading) * x + number(minorant.slope)) * x
}

#[test]
fn the_lower_bound_is_below_the_quadratic() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..40_000 {
        let minorant = any(&mut rng);
        let (slope, leading) = (minorant.slope, minorant.leading);
        let mut least = at(&minorant, &RBig::ONE).min(RBig::ZERO);
        if slope < 0.0 && leading > 0.0 {
            let lowest = -number(slope) / (number(leading) * RBig::from(2));
            if lowest <= RBig::ONE {
                least = at(&minorant, &lowest);
            }
        }
        if minorant.floor.is_finite() {
            least = least.max(number(minorant.floor).min(RBig::ZERO));
        }
        let lower = number(minorant.lower());
        assert!(lower <= least_base(&minorant) + least, "{minorant:?}");
    }
}

/// Beyond the reach of a threshold the quadratic is above it, for thresholds from next to the base on.
#[test]
fn the_quadratic_is_above_a_threshold_beyond_its_reach() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut inside = 0;
    for round in 0..80_000 {
        let minorant = any(&mut rng);
        let above = [0.0, 1e-15, 1e-3, 1.0][round % 4] * size_of(&mut rng);
        let threshold = minorant.base + above;
        let reach = minorant.parameter_bound(threshold);
        if reach >= 1.0 {
            continue;
        }
        inside += 1;
        let reach = number(reach);
        // From there to the end it rises, or lies above the chord.
        for x in [
            reach.clone(),
            (reach + RBig::ONE) / RBig::from(2),
            RBig::ONE,
        ] {
            let value = least_base(&minorant) + at(&minorant, &x);
            assert!(value >= number(threshold), "{minorant:?} {threshold}");
        }
    }
    assert!(inside > 10_000, "{inside}");
}

/// Uses the error with the fastest growth beyond the end of a part (a Chebyshev polynomial), in the
/// direction of the point there. It moves the nearest point as far as the error's derivatives
/// allow.
#[test]
fn nearest_points_are_within_reach_whatever_the_error() {
    // Of the error, its value, and of its derivative.
    let value = |x: f64| -1.0 - x * (18.0 + x * (48.0 + x * 32.0));
    let rate = |x: f64| 18.0 + x * (96.0 + x * 96.0);
    for step in 1..=125 {
        let range = f64::from(step) * 1e-3;
        for (size, error) in [(1.0, 1e-7), (1e3, 1e-5)] {
            // Along the way to the origin: the distance is `size` and half of `leading` times x squared.
            let leading = 1.0001 * error * size * rate(range) / range;
            let second = leading / size;
            let place = |x: f64| DVec3::X * (size + 0.5 * second * x * x);
            let points = bezier(&[place(0.0), DVec3::ZERO, DVec3::X * (0.5 * second)]);
            // Behind the base: the quadratic term pulls back, the error pushes on.
            let slope = |x: f64| {
                let distance = place(x).x + error * value(x);
                distance * (error * rate(x) - second * x)
            };
            let (mut low, mut high) = (0.0, range);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if slope(middle) > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let found = stationary_reach(&points, error, range);
            assert!(found >= low * (1.0 - 1e-9), "{range}: {found} {low}");
        }
        // Across it: what flies by, far faster than it is far.
        let (speed, error) = (1.0, 1e-3 * range);
        let points = bezier(&[DVec3::X * 1e-9, DVec3::Y * speed, DVec3::ZERO]);
        let found = stationary_reach(&points, error, range);
        assert!(found >= error / speed, "{range}: {found}");
    }
}

/// Cubics known exactly, from a base that is all but nearest: the slope there is rounding.
#[test]
fn nearest_points_are_within_reach_of_a_rounded_slope() {
    const RANGE: f64 = 1e-6;
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut narrowed = 0;
    for round in 0..5_000 {
        let mut vector = || DVec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0)));
        let (place, way, second) = (vector(), vector(), 1e-3 * vector());
        let way = way - place * (way.dot(place) / place.length_squared());
        let points = bezier(&[place, way * [1.0, 1e3][round % 2], second]);
        let found = stationary_reach(&points, 0.0, RANGE);
        if found >= RANGE {
            continue;
        }
        narrowed += 1;
        // Half the slope of the squared distance.
        let slope = |x: RBig| {
            [0, 1, 2].into_iter().fold(RBig::ZERO, |sum, axis| {
                let [p0, p1, p2, p3] = points.map(|point| number(point[axis]));
                let three = RBig::from(3);
                let linear = &three * (&p1 - &p0);
                let square = &three * (&p2 - RBig::from(2) * &p1 + &p0);
                let cube = p3 - &three * p2 + &three * p1 - &p0;
                let value = ((&cube * &x + &square) * &x + &linear) * &x + p0;
                let rate = (three * cube * &x + RBig::from(2) * square) * &x + linear;
                sum + value * rate
            })
        };
        assert!(slope(number(found)) >= RBig::ZERO, "{round} {points:?}");
        assert!(slope(-number(found)) <= RBig::ZERO, "{round} {points:?}");
    }
    assert!(narrowed > 2_000, "{narrowed}");
}

/// A first coefficient that is off by more than its four roundings, found by hill climbing: the
/// rounding of the difference counts as well.
#[test]
fn the_slope_is_below_the_exact_one() {
    let place = DVec3::new(
        0.9997800515421201,
        0.23660909337775649,
        -0.08787439578875968,
    );
    let next = DVec3::new(
        0.4773174369878091,
        0.10433464367808756,
        -0.27598995957901795,
    );
    let minorant = Minorant::of(&[place, next, next, next]);
    let terms = [0, 1, 2].map(|k| number(place[k]) * (number(next[k]) - number(place[k])));
    let exact = terms.into_iter().fold(RBig::ZERO, |sum, term| sum + term);
    assert!(
        number(minorant.slope) <= exact * RBig::from(6),
        "{minorant:?}"
    );
}

/// Returns the control points of a + b x + c x².
fn bezier(&[a, b, c]: &[DVec3; 3]) -> [DVec3; 4] {
    [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c]
}

/// Uniform straight motion from a base: its least squared distance is known exactly.
#[test]
fn lower_bounds_are_below_straight_motions() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for round in 0..40_000 {
        let bits = [4, 11][round % 2];
        let mut coordinate = || rng.random_range(-(1 << bits)..=1 << bits);
        let (start, step) = (
            [coordinate(), coordinate(), coordinate()],
            [coordinate(), coordinate(), coordinate()],
        );
        let points: [[i32; 3]; 4] =
            [0, 1, 2, 3].map(|count| [0, 1, 2].map(|k| start[k] + count * step[k]));
        let dot = |x: [i32; 3], y: [i32; 3]| {
            let terms = [0, 1, 2].map(|k| i64::from(x[k]) * i64::from(y[k]));
            RBig::from(terms.into_iter().sum::<i64>())
        };
        let way = step.map(|coordinate| 3 * coordinate);
        let (square, slope, leading) = (dot(start, start), dot(start, way), dot(way, way));
        let share = if leading > RBig::ZERO {
            -slope.clone() / &leading
        } else {
            RBig::ZERO
        };
        let share = share.max(RBig::ZERO).min(RBig::ONE);
        let least = (&leading * &share + RBig::from(2) * slope) * share + &square;
        let found =
            Minorant::of(&points.map(|point| DVec3::from_array(point.map(f64::from)))).lower();
        assert!(number(found) <= least, "{points:?}");
    }
}
