//! Real roots of polynomials against roots that are known.
#![allow(clippy::float_cmp, reason = "tests compare exact results")]

use nearmiss::internals::polynomial::roots;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

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

/// Asserts the roots of the product of known ones, as one of degree 5 and of degree 6.
fn assert_found(known: &[f64], expected: &[f64], tolerance: f64) {
    if known.len() < 6 {
        assert_close(&roots(product::<6>(known), 0.0), expected, tolerance);
    }
    assert_close(&roots(product::<7>(known), 0.0), expected, tolerance);
}

#[test]
fn constants_have_no_roots() {
    assert!(roots([0.0; 6], 0.0).is_empty());
    assert!(roots([0.0, -0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0).is_empty());
    assert!(roots([3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0).is_empty());
    assert!(roots([1e-300, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0).is_empty());
}

#[test]
fn quadratics_keep_the_digits_of_both_roots() {
    assert_found(&[-0.5, 0.75], &[-0.5, 0.75], 0.0);
    assert_found(&[-0.5, -0.5], &[-0.5], 1e-8);
    assert_found(&[0.0, 0.0], &[0.0], 1e-100);
    assert!(roots([1.0, 0.0, 1.0, 0.0, 0.0, 0.0], 0.0).is_empty());
    // The second root is beyond the interval, or the range.
    let small = 2.0_f64.powi(-30);
    for tiny in [small, 1e-310, 0.0] {
        let line = roots([1.0, -2.0, tiny, 0.0, 0.0, 0.0], 0.0);
        assert_close(&line, &[0.5], small);
        // A small root has all its digits.
        let line = roots([tiny, -1.0, tiny, 0.0, 0.0, 0.0, 0.0], 0.0);
        assert_close(&line, &[tiny], tiny * f64::EPSILON);
    }
}

#[test]
fn ends_belong_to_the_interval_and_multiple_roots_come_once() {
    assert_found(&[-1.0, 0.5, 1.0], &[-1.0, 0.5, 1.0], 0.0);
    assert_found(&[-1.0], &[-1.0], 0.0);
    assert_found(&[1.0], &[1.0], 0.0);
    assert_found(&[1.5, -2.0], &[], 0.0);
    // Multiplicity m: known to the m-th root of the rounding, about 40 units.
    for multiplicity in 1..=6_u8 {
        let tolerance = 1e-14_f64.powf(1.0 / f64::from(multiplicity));
        for place in [0.3, -0.7, 1.0, -1.0] {
            let repeated = vec![place; usize::from(multiplicity)];
            assert_found(&repeated, &[place], tolerance);
        }
    }
    // A power of x has no rounding at all.
    let cube = roots([0.0, 0.0, 0.0, 1.0, 0.0, 0.0], 0.0);
    assert_close(&cube, &[0.0], 1e-100);
}

#[test]
fn two_double_roots_are_two_touches() {
    // Half the digits: each touch is a root of multiplicity 2.
    let doubles = [0.25, 0.25, 0.75, 0.75];
    assert_found(&doubles, &[0.25, 0.75], 1e-7);
    let three = [0.1, 0.1, 0.6, 0.6, 0.9, 0.9];
    assert_found(&three, &[0.1, 0.6, 0.9], 1e-6);
    // Lifted off the axis by far more than the rounding there is none.
    let mut lifted = product::<6>(&doubles);
    lifted[0] += 1e-12;
    assert!(roots(lifted, 0.0).is_empty());
    // Lowered there are four; they are 4e-6 away from the touches.
    lifted[0] -= 2e-12;
    let around = [0.25 - 2e-6, 0.25 + 2e-6, 0.75 - 2e-6, 0.75 + 2e-6];
    assert_close(&roots(lifted, 0.0), &around, 1e-9);
}

#[test]
fn chebyshev_polynomials() {
    let sixth = [-1.0, 0.0, 18.0, 0.0, -48.0, 0.0, 32.0];
    let cosine = |odd: f64, degree: f64| (odd * std::f64::consts::PI / (2.0 * degree)).cos();
    let expected = [11.0, 9.0, 7.0, 5.0, 3.0, 1.0].map(|odd| cosine(odd, 6.0));
    // Well-conditioned: some units of rounding, with coefficients up to 48.
    assert_close(&roots(sixth, 0.0), &expected, 1e-14);
    let fifth = [0.0, 5.0, 0.0, -20.0, 0.0, 16.0];
    let expected = [9.0, 7.0, 5.0, 3.0, 1.0].map(|odd| cosine(odd, 5.0));
    assert_close(&roots(fifth, 0.0), &expected, 1e-14);
}

/// The roots 1 to 6, in sixths.
#[test]
fn wilkinson_of_degree_six() {
    let known = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|number| number / 6.0);
    // Condition of the roots: up to 3e5 units of rounding.
    assert_found(&known, &known, 1e-10);
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
            .map(|_| random.random_range(-1.5..1.5))
            .collect();
        known.sort_by(f64::total_cmp);
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
        let tolerance = [0.0, 1e-9][checked % 2];
        // So are roots at the ends of the interval.
        let mut ends = known.iter().zip(&allowed);
        if !apart || ends.any(|(r, e)| (r.abs() - 1.0).abs() <= e + 2.0 * tolerance) {
            continue;
        }
        checked += 1;
        let fifth = (degree < 6).then(|| roots(product::<6>(&known), tolerance));
        let sixth = roots(product::<7>(&known), tolerance);
        let inside: Vec<_> = known
            .iter()
            .zip(&allowed)
            .filter(|(r, _)| r.abs() < 1.0)
            .collect();
        for found in fifth.into_iter().chain([sixth]) {
            assert_eq!(found.len(), inside.len(), "{found:?} for {known:?}");
            for (f, (k, e)) in found.iter().zip(&inside) {
                let is_near = (f - *k).abs() <= *e + tolerance;
                assert!(is_near, "{found:?} for {known:?}, {e:e}");
            }
        }
    }
    // The generator must not skip its way out: about 3 % of the draws are too close.
    assert!(checked > 18_000, "{checked}");
}

#[test]
fn clusters_give_at_least_one_root_and_none_twice() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..20_000 {
        let centre = random.random_range(-0.9..0.9_f64);
        let spread = 10.0_f64.powf(random.random_range(-18.0..-2.0));
        let size = random.random_range(2..=6_usize);
        let known: Vec<f64> = (0..size)
            .map(|_| centre + spread * random.random_range(-1.0..1.0))
            .collect();
        let found = roots(product::<7>(&known), 0.0);
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
        assert_close(&roots(coefficients, 0.0), &expected, 1e-15);
    }
}

#[test]
fn scaling_by_powers_of_two_changes_nothing() {
    let known = [-0.75, 0.125, 0.5, 0.9];
    let base = roots(product::<6>(&known), 0.0);
    assert_eq!(base.len(), 4);
    for exponent in [-1000, -400, -290, 290, 400, 1000] {
        let factor = 2.0_f64.powi(exponent);
        let scaled = product::<6>(&known).map(|c| c * factor);
        assert_eq!(roots(scaled, 0.0), base);
    }
}

#[test]
fn coefficients_of_any_size_give_finite_sorted_roots() {
    let mut random = ChaCha8Rng::seed_from_u64(150);
    let mut counts = [0; 2];
    for _ in 0..50_000 {
        let mut coefficients: [f64; 7] = std::array::from_fn(|_| {
            let size = 10.0_f64.powf(random.random_range(-150.0..150.0));
            [size, -size, 0.0][random.random_range(0..3_usize)]
        });
        // A root at 0 would be found as a number that only underflow tells from 0.
        coefficients[0] = 10.0_f64.powf(random.random_range(-150.0..150.0));
        let [exact, rough] = [0.0, 1e-9].map(|tolerance| roots(coefficients, tolerance));
        for found in [&exact, &rough] {
            let are_inside = found.iter().all(|f| (-1.0..=1.0).contains(f));
            assert!(are_inside, "{found:?} of {coefficients:?}");
            assert!(
                found.windows(2).all(|p| p[0] < p[1]),
                "{found:?} of {coefficients:?}"
            );
        }
        // Descartes' rule, exact on the signs of the coefficients: one change of sign means one
        // positive root. It is below 1 if the value there is negative.
        let signs: Vec<f64> = coefficients
            .iter()
            .filter(|c| **c != 0.0)
            .map(|c| c.signum())
            .collect();
        let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if changes == 1 {
            let expected = usize::from(coefficients.iter().sum::<f64>() < 0.0);
            let positive = exact.iter().filter(|f| **f > 0.0).count();
            assert_eq!(positive, expected, "{exact:?} of {coefficients:?}");
            counts[expected] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 1_000), "{counts:?}");
}

#[test]
fn what_is_not_finite_has_an_answer() {
    // What is found of these means nothing, but it is found.
    for bad in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let _ = roots([1.0, bad, 0.0, 2.0, 0.0, 0.0], 0.0);
        let _ = roots([bad, 1.0, 0.0, 2.0, 0.0, 0.0, bad], 0.0);
    }
}
