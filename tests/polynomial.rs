//! Real roots of polynomials against roots that are known.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "tests may panic, and compare exact results"
)]

use nearmiss::internals::polynomial::{Bernstein, Polynomial, quadratic};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// The isolated roots in an interval, to full precision.
fn roots<const N: usize>(coefficients: [f64; N], low: f64, high: f64) -> Vec<f64> {
    let found = Polynomial::new(coefficients).roots_in(low, high, 0.0);
    found.isolated().unwrap().to_vec()
}

/// The product of (x - root), padded with zeros.
fn product<const N: usize>(roots: &[f64]) -> [f64; N] {
    let mut coefficients = [0.0; N];
    coefficients[0] = 1.0;
    for (degree, root) in roots.iter().enumerate() {
        for i in (0..=degree).rev() {
            coefficients[i + 1] += coefficients[i];
            coefficients[i] *= -root;
        }
    }
    coefficients
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?} for {expected:?}");
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance, "{found:?} for {expected:?}");
    }
}

#[test]
fn zero_polynomial_is_zero_everywhere_and_constants_nowhere() {
    assert!(
        Polynomial::new([0.0; 7])
            .roots_in(0.0, 1.0, 0.0)
            .is_everywhere()
    );
    assert!(Polynomial::new([0.0, -0.0]).real_roots(0.0).is_everywhere());
    assert!(
        Polynomial::new([0.0])
            .roots_in(2.0, 2.0, 0.0)
            .is_everywhere()
    );
    assert!(roots([3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], -1.0, 1.0).is_empty());
    assert_eq!(
        Polynomial::new([1e-300]).real_roots(0.0).isolated(),
        Some(&[][..])
    );
}

#[test]
fn quadratic_keeps_the_digits_of_both_roots() {
    assert_eq!(&quadratic([2.0, -3.0, 1.0])[..], &[1.0, 2.0]);
    assert_eq!(&quadratic([1.0, 2.0, 1.0])[..], &[-1.0]);
    assert!(quadratic([1.0, 0.0, 1.0]).is_empty());
    assert!(quadratic([1.0, 0.0, 0.0]).is_empty());
    assert!(quadratic([0.0; 3]).is_empty());
    assert_eq!(&quadratic([0.0, 0.0, 5.0])[..], &[0.0]);
    assert_eq!(&quadratic([1.0, -2.0, 0.0])[..], &[0.5]);
    // The second root is beyond the range.
    assert_eq!(&quadratic([1.0, -2.0, 1e-310])[..], &[0.5]);
    // Powers of two: the discriminant rounds to exactly 1.
    let small = 2.0_f64.powi(-30);
    assert_eq!(&quadratic([small, -1.0, small])[..], &[small, 1.0 / small]);
    // `powi` of an exponent below -1023 may be 0: it may divide by an overflow.
    let power = |exponent: i32| 2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent / 2);
    for factor in [-1060, -1000, -530, 530, 1020].map(power) {
        assert_eq!(
            &quadratic([3.0 * factor, -4.0 * factor, factor])[..],
            &[1.0, 3.0]
        );
    }
}

#[test]
fn ends_belong_to_the_interval_and_multiple_roots_come_once() {
    assert_eq!(
        roots(product::<4>(&[0.0, 0.5, 1.0]), 0.0, 1.0),
        [0.0, 0.5, 1.0]
    );
    assert_eq!(roots([0.0, 1.0], 0.0, 0.0), [0.0]);
    assert!(roots([0.0, 1.0], 1.0, 2.0).is_empty());
    assert!(roots([0.0, 1.0], 2.0, -2.0).is_empty());
    // Multiplicity m: known to the m-th root of the rounding, about 40 units.
    for multiplicity in 1..=6_u8 {
        let tolerance = 1e-14_f64.powf(1.0 / f64::from(multiplicity));
        let repeated = vec![0.3; usize::from(multiplicity)];
        assert_close(&roots(product::<7>(&repeated), 0.0, 1.0), &[0.3], tolerance);
        assert_close(&roots(product::<7>(&repeated), 0.3, 1.0), &[0.3], tolerance);
        assert_close(
            &roots(product::<7>(&repeated), -1.0, 0.3),
            &[0.3],
            tolerance,
        );
    }
    // A power of x has no rounding at all.
    assert_close(
        &roots([0.0, 0.0, 0.0, 1.0, 0.0, 0.0], -1.0, 1.5),
        &[0.0],
        1e-100,
    );
}

#[test]
fn two_double_roots_are_two_touches() {
    // Half the digits: each touch is a root of multiplicity 2.
    assert_close(
        &roots(product::<5>(&[0.25, 0.25, 0.75, 0.75]), 0.0, 1.0),
        &[0.25, 0.75],
        1e-7,
    );
    assert_close(
        &roots(product::<7>(&[0.1, 0.1, 0.6, 0.6, 0.9, 0.9]), 0.0, 1.0),
        &[0.1, 0.6, 0.9],
        1e-6,
    );
    // Lifted off the axis by far more than the rounding there is none.
    let mut lifted = product::<5>(&[0.25, 0.25, 0.75, 0.75]);
    lifted[0] += 1e-12;
    assert!(roots(lifted, 0.0, 1.0).is_empty());
    // Lowered there are four; they are 4e-6 away from the touches.
    lifted[0] -= 2e-12;
    let around = [0.25 - 2e-6, 0.25 + 2e-6, 0.75 - 2e-6, 0.75 + 2e-6];
    assert_close(&roots(lifted, 0.0, 1.0), &around, 1e-9);
}

#[test]
fn chebyshev_polynomials() {
    let sixth = [-1.0, 0.0, 18.0, 0.0, -48.0, 0.0, 32.0];
    let expected: Vec<f64> = [11.0, 9.0, 7.0, 5.0, 3.0, 1.0]
        .map(|odd: f64| (odd * std::f64::consts::PI / 12.0).cos())
        .to_vec();
    // Well-conditioned: some units of rounding, with coefficients up to 48.
    assert_close(&roots(sixth, -1.0, 1.0), &expected, 1e-14);
    let fifth = [0.0, 5.0, 0.0, -20.0, 0.0, 16.0];
    let expected: Vec<f64> = [9.0, 7.0, 5.0, 3.0, 1.0]
        .map(|odd: f64| (odd * std::f64::consts::PI / 10.0).cos())
        .to_vec();
    assert_close(&roots(fifth, -1.0, 1.0), &expected, 1e-14);
}

#[test]
fn wilkinson_of_degree_six_on_the_whole_line() {
    let known = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let found = Polynomial::new(product::<7>(&known)).real_roots(0.0);
    // Condition of the roots: up to 3e5 units of rounding.
    assert_close(found.isolated().unwrap(), &known, 1e-10);
    let shifted = [1e3, 1e3 + 1.0, 1e3 + 2.0];
    let found = Polynomial::new(product::<4>(&shifted)).real_roots(0.0);
    // 1e9 / 1 units of rounding of 1e3.
    assert_close(found.isolated().unwrap(), &shifted, 1e-6);
}

/// How far a root moves if each coefficient moves by some units of rounding.
fn conditioned_error(known: &[f64], root: f64, units: f64) -> f64 {
    let magnitude: f64 = known.iter().map(|r| root.abs() + r.abs()).product();
    let slope: f64 = known
        .iter()
        .filter(|r| **r != root)
        .map(|r| (root - r).abs())
        .product();
    units * f64::EPSILON * magnitude / slope
}

#[test]
fn products_of_random_factors_give_their_roots_back() {
    let mut random = ChaCha8Rng::seed_from_u64(20_220_501);
    let mut checked = 0;
    for _ in 0..20_000 {
        let degree = random.random_range(1..=6_usize);
        let mut known: Vec<f64> = (0..degree)
            .map(|_| random.random_range(-2.0..2.0))
            .collect();
        known.sort_by(f64::total_cmp);
        let coefficients = product::<7>(&known);
        // 32 units: 12 for the product of up to six factors, the rest for the evaluation.
        let allowed: Vec<f64> = known
            .iter()
            .map(|&r| conditioned_error(&known, r, 32.0))
            .collect();
        // Roots that rounding can join are tested elsewhere.
        let apart = known
            .windows(2)
            .zip(allowed.windows(2))
            .all(|(r, e)| r[1] - r[0] > 16.0 * (e[0] + e[1]));
        if !apart {
            continue;
        }
        checked += 1;
        let tolerance = [0.0, 1e-9][checked % 2];
        let found = Polynomial::new(coefficients).real_roots(tolerance);
        let found = found.isolated().unwrap();
        assert_eq!(found.len(), known.len(), "{found:?} for {known:?}");
        for ((f, k), e) in found.iter().zip(&known).zip(&allowed) {
            assert!(
                (f - k).abs() <= e + tolerance,
                "{found:?} for {known:?}, {e:e}"
            );
        }
        // A sub-interval has the roots that are in it, up to those at its ends.
        let inner = Polynomial::new(coefficients).roots_in(-1.0, 1.0, tolerance);
        let expected = known.iter().filter(|r| r.abs() < 1.0).count();
        if known
            .iter()
            .zip(&allowed)
            .all(|(r, e)| (r.abs() - 1.0).abs() > e + 2.0 * tolerance)
        {
            assert_eq!(inner.isolated().unwrap().len(), expected, "{known:?}");
        }
    }
    // The generator must not skip its way out: about 3 % of the draws are too close.
    assert!(checked > 18_000, "{checked}");
}

#[test]
fn clusters_give_at_least_one_root_and_none_twice() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..20_000 {
        let centre = random.random_range(-1.0..1.0_f64);
        let spread = 10.0_f64.powf(random.random_range(-18.0..-2.0));
        let size = random.random_range(2..=6_usize);
        let known: Vec<f64> = (0..size)
            .map(|_| centre + spread * random.random_range(-1.0..1.0))
            .collect();
        let coefficients = product::<7>(&known);
        let found = roots(coefficients, -2.0, 2.0);
        assert!(
            !found.is_empty() && found.len() <= size,
            "{found:?} for {known:?}"
        );
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]), "{found:?}");
        // The sixth root of the rounding of terms up to 2^6, the worst of all multiplicities.
        let reach = spread + (64.0 * 64.0 * f64::EPSILON).powf(1.0 / 6.0);
        assert!(
            found.iter().all(|f| (f - centre).abs() <= reach),
            "{found:?} for {known:?}"
        );
    }
}

#[test]
fn tiny_leading_coefficients_do_not_disturb_the_roots() {
    let expected = [0.25, 0.5];
    for tiny in [0.0, 1e-300, 1e-30, -1e-17] {
        let mut coefficients = product::<7>(&expected);
        coefficients[6] = tiny;
        coefficients[5] = -tiny;
        // Absolute error of a root from a change of 1e-17 of a coefficient, and rounding.
        assert_close(&roots(coefficients, 0.0, 1.0), &expected, 1e-15);
    }
    // On the line the roots far out are found as well: x (1 + 1e-60 x).
    let far = Polynomial::new([0.0, 1.0, 1e-60, 0.0, 0.0]).real_roots(0.0);
    let far = far.isolated().unwrap();
    assert!(
        (far[0] / -1e60 - 1.0).abs() < 1e-15 && far[1].abs() < 1e-300,
        "{far:?}"
    );
}

#[test]
fn scaling_by_powers_of_two_changes_nothing() {
    let known = [-0.75, 0.125, 0.5, 0.9];
    let base = roots(product::<5>(&known), -1.0, 1.0);
    for exponent in [-1000, -400, -290, 290, 400, 1000] {
        let factor = 2.0_f64.powi(exponent);
        let scaled = product::<5>(&known).map(|c| c * factor);
        assert_eq!(roots(scaled, -1.0, 1.0), base);
    }
}

#[test]
fn coefficients_of_any_size_give_finite_sorted_roots() {
    let mut random = ChaCha8Rng::seed_from_u64(150);
    for _ in 0..50_000 {
        let mut coefficients: [f64; 7] = std::array::from_fn(|_| {
            let size = 10.0_f64.powf(random.random_range(-150.0..150.0));
            [size, -size, 0.0][random.random_range(0..3_usize)]
        });
        // A root at 0 would be found as a number that only underflow tells from 0.
        coefficients[0] = 10.0_f64.powf(random.random_range(-150.0..150.0));
        let polynomial = Polynomial::new(coefficients);
        for found in [
            polynomial.real_roots(0.0),
            polynomial.roots_in(0.0, 1.0, 1e-9),
        ] {
            let Some(found) = found.isolated() else {
                panic!("{coefficients:?} is not zero");
            };
            assert!(
                found.iter().all(|f| f.is_finite()),
                "{found:?} of {coefficients:?}"
            );
            assert!(
                found.windows(2).all(|p| p[0] < p[1]),
                "{found:?} of {coefficients:?}"
            );
        }
        // Descartes' rule, exact on the signs of the coefficients: the number of positive roots
        // is at most the number of sign changes, and odd if that is odd. So 1 means 1.
        let signs: Vec<f64> = coefficients
            .iter()
            .filter(|c| **c != 0.0)
            .map(|c| c.signum())
            .collect();
        let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if changes == 1 {
            let found = polynomial.real_roots(0.0);
            let positive = found
                .isolated()
                .unwrap()
                .iter()
                .filter(|f| **f > 0.0)
                .count();
            assert_eq!(positive, 1, "{found:?} of {coefficients:?}");
        }
    }
}

#[test]
fn bernstein_form_agrees_with_the_power_form() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..1_000 {
        let form = Bernstein::<7>::new(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        let power = form.to_power();
        let (low, high) = form.bounds();
        let (left, right) = form.halves();
        for _ in 0..10 {
            let x: f64 = random.random_range(0.0..1.0);
            let value = form.evaluate(x);
            // Averages: some units. The power form: the sum of 2^j binomial(6, j) is 3^6 units.
            assert!(value >= low - 1e-15 && value <= high + 1e-15);
            assert!((power.evaluate(x) - value).abs() < 729.0 * f64::EPSILON);
            let half = if x < 0.5 {
                left.evaluate(2.0 * x)
            } else {
                right.evaluate(2.0 * x - 1.0)
            };
            assert!((half - value).abs() < 1e-14);
        }
        assert_eq!(form.evaluate(0.0), form.coefficients[0]);
        assert_eq!(form.evaluate(1.0), form.coefficients[6]);
    }
    assert_eq!(Bernstein::new([4.0]).to_power(), Polynomial::new([4.0]));
}

#[test]
fn evaluation_and_derivative() {
    let quintic = Polynomial::new([1.0, -2.0, 3.0, -4.0, 5.0, -6.0]);
    assert_eq!(
        quintic.evaluate(2.0),
        1.0 - 4.0 + 12.0 - 32.0 + 80.0 - 192.0
    );
    let slope = -2.0 + 12.0 - 48.0 + 160.0 - 480.0;
    assert_eq!(
        quintic.evaluate_with_derivative(2.0),
        (quintic.evaluate(2.0), slope)
    );
    assert_eq!(quintic.derivative().evaluate(2.0), slope);
    assert_eq!(Polynomial::new([5.0]).cauchy_bound(), None);
    assert_eq!(
        Polynomial::new([0.0, 5.0, 0.0])
            .cauchy_bound()
            .unwrap()
            .round(),
        1.0
    );
    assert!(Polynomial::new([6.0, 1.0]).cauchy_bound().unwrap() >= 7.0);
}

#[test]
fn endless_intervals_and_what_is_not_finite() {
    // (1 - x)² (1 + 2 x): a double root, and one on the other side.
    let cubic = Polynomial::new([1.0, 0.0, -3.0, 2.0]);
    let roots = cubic.roots_in(f64::NEG_INFINITY, f64::INFINITY, 0.0);
    assert_eq!(roots.isolated().unwrap().len(), 2);
    assert_eq!(
        cubic
            .roots_in(0.0, f64::INFINITY, 0.0)
            .isolated()
            .unwrap()
            .len(),
        1
    );
    let three = Polynomial::new([0.0, -1.0, 0.0, 1.0]);
    let roots = three.roots_in(f64::NEG_INFINITY, f64::INFINITY, 0.0);
    assert_eq!(roots.isolated().unwrap(), [-1.0, 0.0, 1.0]);
    // What is found of these means nothing, but it is found.
    for bad in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let _ = quadratic([1.0, bad, -3.0]);
        let _ = Polynomial::new([1.0, bad, 0.0, 2.0]).roots_in(0.0, 1.0, 0.0);
        let _ = Polynomial::new([1.0, bad, 0.0, 2.0]).real_roots(0.0);
    }
}
