//! The exact order of two critical values that enclosures cannot tell apart.
//!
//! A critical value z = unit P(r), with D(r) = 0, is an eigenvalue of the multiplication by
//! unit P in Q[u]/(D); its characteristic polynomial is a polynomial with rational coefficients
//! that vanishes at z. Two such numbers are equal if the greatest common divisor of their
//! polynomials has a root where both are isolated.

use super::minimum::{Candidate, Enclosure, Place};
use super::polynomial::Polynomial;
use super::roots::isolate;
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::cmp::Ordering;

/// Order of the squared distances at two candidates.
pub(crate) fn compare(a: &Candidate<'_>, b: &Candidate<'_>) -> Ordering {
    let (mut a, mut b) = (a.clone(), b.clone());
    let (of_a, of_b) = (value_polynomial(&a), value_polynomial(&b));
    let common = of_a.gcd(&of_b);
    let mut level = 64;
    loop {
        a.refine_to(level);
        b.refine_to(level);
        let (value_a, value_b) = (a.squared(), b.squared());
        if value_a.high < value_b.low {
            return Ordering::Less;
        }
        if value_b.high < value_a.low {
            return Ordering::Greater;
        }
        let shared = Enclosure {
            low: value_a.low.clone().max(value_b.low.clone()),
            high: value_a.high.clone().min(value_b.high.clone()),
        };
        if roots_within(&of_a, &value_a) == 1
            && roots_within(&of_b, &value_b) == 1
            && roots_within(&common, &shared) == 1
        {
            return Ordering::Equal;
        }
        level *= 2;
    }
}

/// Number of distinct roots in a closed interval.
fn roots_within(polynomial: &Polynomial, interval: &Enclosure) -> usize {
    if interval.is_exact() {
        return usize::from(polynomial.sign_at_rational(&interval.low) == 0);
    }
    isolate(&polynomial.compose(&interval.low, &interval.width())).len()
}

/// A polynomial that vanishes at the candidate's squared distance.
fn value_polynomial(candidate: &Candidate<'_>) -> Polynomial {
    match &candidate.place {
        Place::Critical(root) if !root.is_exact() => {
            let distance = candidate.distance;
            let unit = distance.unit();
            let product = multiplication(&distance.polynomial, root.polynomial());
            let characteristic = characteristic_polynomial(&product);
            // In z = unit * eigenvalue.
            let mut power = RBig::ONE;
            let scaled: Vec<RBig> = characteristic
                .into_iter()
                .map(|c| {
                    let scaled = c / &power;
                    power *= &unit;
                    scaled
                })
                .collect();
            Polynomial::from_rationals(&scaled)
        }
        _ => {
            let value = candidate.squared().low;
            Polynomial::from_rationals(&[-value, RBig::ONE])
        }
    }
}

type Matrix = Vec<Vec<RBig>>;

/// The matrix of the multiplication by `factor` modulo `divisor`: row j holds `factor u^j`.
fn multiplication(factor: &Polynomial, divisor: &Polynomial) -> Matrix {
    let rational = |c: &IBig| RBig::from(c.clone());
    let divisor: Vec<RBig> = divisor.coefficients().iter().map(rational).collect();
    let degree = divisor.len() - 1;
    let mut row: Vec<RBig> = factor.coefficients().iter().map(rational).collect();
    let mut matrix = Matrix::new();
    for _ in 0..degree {
        row = remainder(row, &divisor);
        matrix.push(row.clone());
        row.insert(0, RBig::ZERO);
    }
    matrix
}

/// `dividend mod divisor`, filled up with zeros to the divisor's degree.
fn remainder(mut dividend: Vec<RBig>, divisor: &[RBig]) -> Vec<RBig> {
    let degree = divisor.len() - 1;
    while dividend.len() > degree {
        let shift = dividend.len() - 1 - degree;
        let quotient = dividend.pop().unwrap() / &divisor[degree];
        for (i, c) in divisor[..degree].iter().enumerate() {
            dividend[i + shift] -= c * &quotient;
        }
    }
    dividend.resize(degree, RBig::ZERO);
    dividend
}

/// Coefficients of det(z - matrix), constant first (Faddeev and Le Verrier).
fn characteristic_polynomial(matrix: &Matrix) -> Vec<RBig> {
    let n = matrix.len();
    let mut coefficients = vec![RBig::ZERO; n + 1];
    coefficients[n] = RBig::ONE;
    let mut power: Matrix = vec![vec![RBig::ZERO; n]; n];
    for k in 1..=n {
        for (i, row) in power.iter_mut().enumerate() {
            row[i] += &coefficients[n + 1 - k];
        }
        power = product(matrix, &power);
        let trace = (0..n).fold(RBig::ZERO, |sum, i| sum + &power[i][i]);
        coefficients[n - k] = -trace / RBig::from(k);
    }
    coefficients
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |row: &[RBig], column: usize| {
        row.iter()
            .zip(b)
            .fold(RBig::ZERO, |sum, (x, other)| sum + x * &other[column])
    };
    a.iter()
        .map(|row| (0..b.len()).map(|column| entry(row, column)).collect())
        .collect()
}
