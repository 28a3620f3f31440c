//! Integer polynomials of small degree, known up to a positive factor.

use super::dyadic::{Dyadic, signum};
use dashu::base::{Gcd, Signed, UnsignedAbs};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;

/// `sum of coefficients[i] u^i`, without vanishing leading coefficients; empty = zero.
///
/// Operations that say "up to a positive factor" keep roots and signs, not values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Polynomial {
    coefficients: Vec<IBig>,
}

/// A prime below 2^61, for the quick proof that two polynomials have no common factor.
const PRIME: u64 = 2_305_843_009_213_693_951;

impl Polynomial {
    pub(crate) fn new(mut coefficients: Vec<IBig>) -> Self {
        while coefficients.last().is_some_and(IBig::is_zero) {
            coefficients.pop();
        }
        Self { coefficients }
    }

    /// The polynomial times a power of two that makes all coefficients integers, and the
    /// exponent e for which `polynomial * 2^e` has the coefficients given.
    pub(crate) fn from_dyadics(coefficients: &[Dyadic]) -> (Self, isize) {
        let exponent = coefficients
            .iter()
            .filter(|c| !c.is_zero())
            .map(Dyadic::exponent)
            .min()
            .unwrap_or(0);
        let integers = coefficients.iter().map(|c| c.over(exponent)).collect();
        (Self::new(integers), exponent)
    }

    /// Up to a positive factor.
    pub(crate) fn from_rationals(coefficients: &[RBig]) -> Self {
        let mut common = UBig::ONE;
        for coefficient in coefficients {
            let denominator = coefficient.denominator();
            common = &common / (&common).gcd(denominator) * denominator;
        }
        let integers = coefficients
            .iter()
            .map(|c| c.numerator() * IBig::from(&common / c.denominator()))
            .collect();
        Self::new(integers).primitive()
    }

    pub(crate) fn coefficients(&self) -> &[IBig] {
        &self.coefficients
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// 0 for constants and for the zero polynomial.
    pub(crate) fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }

    pub(crate) fn negated(&self) -> Self {
        Self::new(self.coefficients.iter().map(|c| -c).collect())
    }

    pub(crate) fn derivative(&self) -> Self {
        let coefficients = self.coefficients.iter().enumerate().skip(1);
        Self::new(coefficients.map(|(i, c)| c * IBig::from(i)).collect())
    }

    /// Divided by the greatest common divisor of the coefficients.
    pub(crate) fn primitive(&self) -> Self {
        let mut divisor = UBig::ZERO;
        for coefficient in self.coefficients.iter().filter(|c| !c.is_zero()) {
            let magnitude = coefficient.unsigned_abs();
            divisor = if divisor.is_zero() {
                magnitude
            } else {
                divisor.gcd(magnitude)
            };
            if divisor.is_one() {
                return self.clone();
            }
        }
        let divisor = IBig::from(divisor);
        Self::new(self.coefficients.iter().map(|c| c / &divisor).collect())
    }

    /// Sign at `numerator / 2^level`.
    pub(crate) fn sign_at(&self, numerator: &IBig, level: usize) -> i32 {
        signum(&self.scaled_value(numerator, level))
    }

    /// Value at `numerator / 2^level`.
    pub(crate) fn value_at(&self, numerator: &IBig, level: usize) -> Dyadic {
        let shift = isize::try_from(level * self.degree()).unwrap();
        Dyadic::new(self.scaled_value(numerator, level), -shift)
    }

    /// Value times `2^(level * degree)`, by Horner's rule.
    fn scaled_value(&self, numerator: &IBig, level: usize) -> IBig {
        let mut value = IBig::ZERO;
        for (i, coefficient) in self.coefficients.iter().rev().enumerate() {
            value = value * numerator + (coefficient << (level * i));
        }
        value
    }

    /// Sign at a rational number.
    pub(crate) fn sign_at_rational(&self, at: &RBig) -> i32 {
        let denominator = IBig::from(at.denominator().clone());
        let (mut value, mut power) = (IBig::ZERO, IBig::ONE);
        for coefficient in self.coefficients.iter().rev() {
            value = value * at.numerator() + coefficient * &power;
            power *= &denominator;
        }
        signum(&value)
    }

    /// `self(start + width u)` for rational numbers, up to a positive factor.
    pub(crate) fn compose(&self, start: &RBig, width: &RBig) -> Self {
        let mut result: Vec<RBig> = Vec::new();
        for coefficient in self.coefficients.iter().rev() {
            let mut next = vec![RBig::ZERO; result.len() + 1];
            for (i, c) in result.iter().enumerate() {
                next[i] += c * start;
                next[i + 1] += c * width;
            }
            next[0] += RBig::from(coefficient.clone());
            result = next;
        }
        Self::from_rationals(&result)
    }

    /// `self(start + width u)`, up to a positive factor.
    pub(crate) fn over(&self, start: &Dyadic, width: &Dyadic) -> Self {
        let mut result: Vec<Dyadic> = Vec::new();
        for coefficient in self.coefficients.iter().rev() {
            let mut next = vec![Dyadic::ZERO; result.len() + 1];
            for (i, c) in result.iter().enumerate() {
                next[i] = &next[i] + &(c * start);
                next[i + 1] = &next[i + 1] + &(c * width);
            }
            next[0] = &next[0] + &Dyadic::new(coefficient.clone(), 0);
            result = next;
        }
        Self::from_dyadics(&result).0
    }

    /// Greatest common divisor, primitive, up to sign.
    pub(crate) fn gcd(&self, other: &Self) -> Self {
        let (mut a, mut b) = if self.degree() >= other.degree() {
            (self.primitive(), other.primitive())
        } else {
            (other.primitive(), self.primitive())
        };
        while !b.is_zero() {
            let remainder = a.pseudo_remainder(&b).primitive();
            a = b;
            b = remainder;
        }
        a
    }

    /// Whether a quick check modulo a prime proves that there is no common factor.
    fn is_coprime_modulo_prime(&self, other: &Self) -> bool {
        let (Some(mut a), Some(mut b)) = (self.modulo_prime(), other.modulo_prime()) else {
            return false;
        };
        if a.len() < b.len() {
            std::mem::swap(&mut a, &mut b);
        }
        while b.len() > 1 {
            let remainder = remainder_modulo_prime(a, &b);
            a = b;
            b = remainder;
        }
        b.len() == 1
    }

    /// Coefficients modulo the prime; none where the degree would fall.
    fn modulo_prime(&self) -> Option<Vec<u64>> {
        let prime = IBig::from(PRIME);
        let residues: Vec<u64> = self
            .coefficients
            .iter()
            .map(|c| {
                let residue = c % &prime;
                let residue = if residue.is_negative() {
                    residue + &prime
                } else {
                    residue
                };
                u64::try_from(residue).unwrap()
            })
            .collect();
        (*residues.last()? != 0).then_some(residues)
    }

    /// A polynomial with the same roots, each of them once.
    pub(crate) fn square_free(&self) -> Self {
        let derivative = self.derivative();
        if self.degree() < 2 || self.is_coprime_modulo_prime(&derivative) {
            return self.clone();
        }
        let common = self.gcd(&derivative);
        if common.degree() == 0 {
            return self.clone();
        }
        self.exact_quotient(&common)
    }

    /// `self * (positive constant) mod divisor`.
    fn pseudo_remainder(&self, divisor: &Self) -> Self {
        let leading = divisor.coefficients.last().unwrap();
        let mut rest = self.clone();
        while !rest.is_zero() && rest.coefficients.len() >= divisor.coefficients.len() {
            let shift = rest.coefficients.len() - divisor.coefficients.len();
            let top = rest.coefficients.last().unwrap().clone();
            let factor = IBig::from(leading.unsigned_abs());
            let top = if leading.is_negative() { -top } else { top };
            let mut next: Vec<IBig> = rest.coefficients.iter().map(|c| c * &factor).collect();
            for (i, c) in divisor.coefficients.iter().enumerate() {
                next[i + shift] -= c * &top;
            }
            rest = Self::new(next);
        }
        rest
    }

    /// The quotient by a divisor known to divide, up to a positive factor.
    fn exact_quotient(&self, divisor: &Self) -> Self {
        let leading = divisor.coefficients.last().unwrap();
        let factor = IBig::from(leading.unsigned_abs());
        let mut rest = self.clone();
        let mut quotient = vec![IBig::ZERO; self.coefficients.len() - divisor.degree()];
        while !rest.is_zero() && rest.coefficients.len() >= divisor.coefficients.len() {
            let shift = rest.coefficients.len() - divisor.coefficients.len();
            let top = rest.coefficients.last().unwrap().clone();
            let top = if leading.is_negative() { -top } else { top };
            for c in &mut quotient {
                *c *= &factor;
            }
            quotient[shift] += &top;
            let mut next: Vec<IBig> = rest.coefficients.iter().map(|c| c * &factor).collect();
            for (i, c) in divisor.coefficients.iter().enumerate() {
                next[i + shift] -= c * &top;
            }
            rest = Self::new(next);
        }
        assert!(rest.is_zero(), "the divisor divides");
        Self::new(quotient).primitive()
    }

    /// Bernstein coefficients on [0, 1], up to a positive factor.
    pub(crate) fn bernstein(&self) -> Vec<IBig> {
        let degree = self.degree();
        if self.is_zero() {
            return Vec::new();
        }
        let binomials: Vec<u64> = binomials(degree);
        let common = binomials.iter().fold(1, |lcm, &b| lcm / gcd(lcm, b) * b);
        let scaled: Vec<IBig> = self
            .coefficients
            .iter()
            .zip(&binomials)
            .map(|(c, b)| c * IBig::from(common / b))
            .collect();
        // b_k = sum over i <= k of C(k, i) c_i / C(n, i): repeated sums of neighbours.
        let mut row = scaled;
        let mut result = Vec::with_capacity(degree + 1);
        while !row.is_empty() {
            result.push(row[0].clone());
            row = row.windows(2).map(|pair| &pair[0] + &pair[1]).collect();
        }
        result
    }
}

fn binomials(n: usize) -> Vec<u64> {
    let n = u64::try_from(n).unwrap();
    let mut row = vec![1];
    for i in 1..=n {
        row.push(row.last().unwrap() * (n + 1 - i) / i);
    }
    row
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn times_modulo_prime(a: u64, b: u64) -> u64 {
    u64::try_from(u128::from(a) * u128::from(b) % u128::from(PRIME)).unwrap()
}

/// `a` times a constant modulo `b`, for `a` at least as long as `b`.
fn remainder_modulo_prime(mut a: Vec<u64>, b: &[u64]) -> Vec<u64> {
    let leading = *b.last().unwrap();
    while a.len() >= b.len() {
        let shift = a.len() - b.len();
        let top = a.pop().unwrap();
        for c in &mut a {
            *c = times_modulo_prime(*c, leading);
        }
        for (i, &c) in b[..b.len() - 1].iter().enumerate() {
            a[i + shift] = (a[i + shift] + PRIME - times_modulo_prime(c, top)) % PRIME;
        }
    }
    while a.last() == Some(&0) {
        a.pop();
    }
    a
}
