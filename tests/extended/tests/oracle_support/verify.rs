//! Fast exact proofs of claims about the distance over a span.
//!
//! Bernstein coefficients of `distance² - bound²`, halved until their signs decide; what 16
//! halvings leave open (a bound that is touched exactly) goes to the isolation of all roots.

use super::distance::SquaredDistance;
use super::dyadic::{Dyadic, signum};
use super::polynomial::Polynomial;
use super::roots::{halves, sign_pattern};
use dashu::integer::IBig;
use dashu::rational::RBig;

const HALVINGS: usize = 16;

/// Whether `distance >= bound` all over the span.
pub(crate) fn never_below(distance: &SquaredDistance, bound: &Dyadic) -> bool {
    bound.signum() <= 0 || least_sign(&distance.minus(&square(bound))) >= 0
}

/// Whether `distance > bound` all over the span.
pub(crate) fn stays_above(distance: &SquaredDistance, bound: &Dyadic) -> bool {
    bound.signum() < 0 || least_sign(&distance.minus(&square(bound))) > 0
}

/// Whether `distance <= bound` somewhere on the span.
pub(crate) fn reaches(distance: &SquaredDistance, bound: &Dyadic) -> bool {
    bound.signum() >= 0 && least_sign(&distance.minus(&square(bound))) <= 0
}

/// Whether `distance <= bound` all over the span.
pub(crate) fn never_above(distance: &SquaredDistance, bound: &Dyadic) -> bool {
    bound.signum() >= 0 && least_sign(&distance.minus(&square(bound)).negated()) >= 0
}

/// Whether `distance <= bound` at a local parameter: the quickest proof of an upper bound.
pub(crate) fn is_at_most(distance: &SquaredDistance, u: &Dyadic, bound: &Dyadic) -> bool {
    bound.signum() >= 0 && distance.at(u) <= square(bound)
}

fn square(bound: &Dyadic) -> RBig {
    bound.squared().to_rational()
}

/// The least sign that the polynomial takes on [0, 1]: -1, 0 or 1.
pub(crate) fn least_sign(polynomial: &Polynomial) -> i32 {
    if polynomial.is_zero() {
        return 0;
    }
    let mut least = 1;
    let mut pieces = vec![(polynomial.bernstein(), 0)];
    while let Some((coefficients, halvings)) = pieces.pop() {
        let ends = [
            signum(&coefficients[0]),
            signum(coefficients.last().unwrap()),
        ];
        least = least.min(ends[0]).min(ends[1]);
        if least < 0 {
            return -1;
        }
        if coefficients.iter().all(|c| signum(c) >= 0) {
            continue;
        }
        if halvings == HALVINGS {
            return least_sign_by_roots(polynomial);
        }
        let (left, right) = halves(&coefficients);
        pieces.push((without_common_power(left), halvings + 1));
        pieces.push((without_common_power(right), halvings + 1));
    }
    least
}

fn without_common_power(coefficients: Vec<IBig>) -> Vec<IBig> {
    let zeros = coefficients.iter().filter_map(IBig::trailing_zeros).min();
    match zeros {
        Some(zeros) if zeros > 0 => coefficients.into_iter().map(|c| c >> zeros).collect(),
        _ => coefficients,
    }
}

fn least_sign_by_roots(polynomial: &Polynomial) -> i32 {
    let (roots, signs) = sign_pattern(polynomial);
    if signs.iter().any(|&sign| sign < 0) {
        -1
    } else {
        i32::from(roots.is_empty())
    }
}
