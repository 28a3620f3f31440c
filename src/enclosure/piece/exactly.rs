//! Each rounding of a quadratic's answers against exact arithmetic, and errors of a cubic at their worst.

use super::super::normal::UNIT;
use super::{Minorant, stationary_reach};
use crate::rounding::exact::number;
use dashu::rational::RBig;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// A quadratic of any size, whose parts may be of very different sizes, or one of them next to zero.
fn any(rng: &mut ChaCha8Rng) -> Minorant {
    let mut size = || 10f64.powf(rng.random_range(-3.0..3.0));
    let (base, slope, bend) = (size(), size(), size());
    let sign = |rng: &mut ChaCha8Rng| [-1.0, 1.0][rng.random_range(0..2)];
    let base = [base, 1.0_f64.next_down(), 0.0][rng.random_range(0..3)];
    let slope = sign(rng) * slope;
    let bend = sign(rng) * [bend, slope.abs() * rng.random_range(0.9..1.1)][rng.random_range(0..2)];
    Minorant {
        base,
        slope,
        bend,
        floor: [f64::NEG_INFINITY, -size_of(rng)][rng.random_range(0..2)],
    }
}

fn size_of(rng: &mut ChaCha8Rng) -> f64 {
    10f64.powf(rng.random_range(-3.0..3.0))
}

/// The least squared distance of which the base may be the computed one: with three roundings of its own.
fn least_base(minorant: &Minorant) -> RBig {
    number(minorant.base) * (number(1.0) - number(3.0 * UNIT))
}

/// How much the quadratic adds to that.
fn at(minorant: &Minorant, x: &RBig) -> RBig {
    (number(minorant.bend) * x + number(minorant.slope)) * x
}

#[test]
fn the_lower_bound_is_below_the_quadratic() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..40_000 {
        let minorant = any(&mut rng);
        let (slope, bend) = (minorant.slope, minorant.bend);
        let mut least = at(&minorant, &RBig::ONE).min(RBig::ZERO);
        if slope < 0.0 && bend > 0.0 {
            let lowest = -number(slope) / (number(bend) * RBig::from(2));
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

/// Beyond the reach of a level the quadratic is above it: levels from next to the base on.
#[test]
fn the_quadratic_is_above_a_level_beyond_its_reach() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut inside = 0;
    for round in 0..80_000 {
        let minorant = any(&mut rng);
        let above = [0.0, 1e-15, 1e-3, 1.0][round % 4] * size_of(&mut rng);
        let level = minorant.base + above;
        let reach = minorant.reach(level);
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
            assert!(value >= number(level), "{minorant:?} {level}");
        }
    }
    assert!(inside > 10_000, "{inside}");
}

/// An error that grows as fast as one can beyond the end of a part: a Chebyshev polynomial, by the way from
/// there. It moves the nearest point as far as the error's derivatives may.
#[test]
fn nearest_points_are_within_reach_whatever_the_error() {
    // Of the error, its value, and of its derivative.
    let value = |x: f64| -1.0 - x * (18.0 + x * (48.0 + x * 32.0));
    let rate = |x: f64| 18.0 + x * (96.0 + x * 96.0);
    for step in 1..=125 {
        let range = f64::from(step) * 1e-3;
        for (size, error) in [(1.0, 1e-7), (1e3, 1e-5)] {
            // Along the way to the origin: the distance is `size` and half a bend times x squared.
            let bend = 1.0001 * error * size * rate(range) / range;
            let second = bend / size;
            let place = |x: f64| DVec3::X * (size + 0.5 * second * x * x);
            let points = bezier(&[place(0.0), DVec3::ZERO, DVec3::X * (0.5 * second)]);
            // Behind the base: the bend pulls back, the error pushes on.
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

/// Cubics that are known exactly, from a base at which they are all but nearest: what is computed of their
/// slope there is rounding.
#[test]
fn nearest_points_are_within_reach_of_a_rounded_slope() {
    const RANGE: f64 = 1e-6;
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut narrowed = 0;
    for round in 0..5_000 {
        let mut vector = || DVec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0)));
        let (place, way, bend) = (vector(), vector(), 1e-3 * vector());
        let way = way - place * (way.dot(place) / place.length_squared());
        let points = bezier(&[place, way * [1.0, 1e3][round % 2], bend]);
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

/// A first coefficient that is off by more than its four roundings, found by hill climbing: that of the
/// difference with these counts as well.
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

/// The control points of a + b x + c x².
fn bezier(&[a, b, c]: &[DVec3; 3]) -> [DVec3; 4] {
    [a, a + b / 3.0, a + (2.0 * b + c) / 3.0, a + b + c]
}
