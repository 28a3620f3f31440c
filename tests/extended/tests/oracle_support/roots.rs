//! Isolation of the real roots in [0, 1]: Descartes' rule of signs on Bernstein coefficients.
//!
//! Collins and Akritas 1976, in Bernstein form. The number of sign changes exceeds the number of
//! roots in the open interval by an even number; bisection until it is 0 or 1 ends for every
//! square-free polynomial.

use super::dyadic::{Dyadic, signum};
use super::polynomial::Polynomial;
use dashu::integer::IBig;
use std::cmp::Ordering;
use std::rc::Rc;

/// One root in [0, 1]: exactly `numerator / 2^level`, or alone in the open interval from there to
/// `(numerator + 1) / 2^level`.
#[derive(Clone, Debug)]
pub(crate) struct Root {
    /// Square-free.
    polynomial: Rc<Polynomial>,
    numerator: IBig,
    level: usize,
    is_exact: bool,
    /// Sign of the polynomial from the low end of the interval to the root.
    sign_before: i32,
}

impl Root {
    pub(crate) fn is_exact(&self) -> bool {
        self.is_exact
    }

    pub(crate) fn low(&self) -> Dyadic {
        Dyadic::new(self.numerator.clone(), -exponent(self.level))
    }

    pub(crate) fn high(&self) -> Dyadic {
        let step = i32::from(!self.is_exact);
        Dyadic::new(&self.numerator + IBig::from(step), -exponent(self.level))
    }

    pub(crate) fn polynomial(&self) -> &Polynomial {
        &self.polynomial
    }

    /// Binary digits known: the enclosure is at most `2^-level` wide.
    pub(crate) fn level(&self) -> usize {
        self.level
    }

    /// Halves the enclosure.
    pub(crate) fn refine(&mut self) {
        if self.is_exact {
            return;
        }
        let middle = &self.numerator * IBig::from(2) + IBig::ONE;
        self.level += 1;
        let sign = self.polynomial.sign_at(&middle, self.level);
        if sign == 0 {
            self.is_exact = true;
            self.numerator = middle;
        } else if sign == self.sign_before {
            self.numerator = middle;
        } else {
            self.numerator = middle - IBig::ONE;
        }
    }

    /// Makes the enclosure at most `2^-level` wide.
    pub(crate) fn refine_to(&mut self, level: usize) {
        while !self.is_exact && self.level < level {
            self.refine();
        }
    }

    /// Whether `factor`, a divisor of this root's polynomial up to multiplicities, vanishes here.
    pub(crate) fn is_root_of(&self, factor: &Polynomial) -> bool {
        if factor.is_zero() {
            return true;
        }
        if factor.degree() == 0 {
            return false;
        }
        if self.is_exact {
            return factor.sign_at(&self.numerator, self.level) == 0;
        }
        // Of all roots of the polynomial only this one lies in the open interval.
        let width = &self.high() - &self.low();
        let part = factor.square_free().over(&self.low(), &width);
        isolate(&part)
            .iter()
            .any(|root| !(root.is_exact && is_zero_or_one(&root.low())))
    }
}

fn is_zero_or_one(number: &Dyadic) -> bool {
    number.is_zero() || *number == Dyadic::from(1)
}

fn exponent(level: usize) -> isize {
    isize::try_from(level).unwrap()
}

/// All roots in the closed interval [0, 1], ascending, each once; none for the zero polynomial.
pub(crate) fn isolate(polynomial: &Polynomial) -> Vec<Root> {
    if polynomial.degree() == 0 {
        return Vec::new();
    }
    let free = Rc::new(polynomial.square_free());
    let coefficients = free.bernstein();
    let mut roots = Vec::new();
    if coefficients[0].is_zero() {
        roots.push(exact(&free, IBig::ZERO, 0));
    }
    descend(&free, &coefficients, &IBig::ZERO, 0, &mut roots);
    if coefficients.last().is_some_and(IBig::is_zero) {
        roots.push(exact(&free, IBig::ONE, 0));
    }
    roots
}

fn exact(polynomial: &Rc<Polynomial>, numerator: IBig, level: usize) -> Root {
    Root {
        polynomial: Rc::clone(polynomial),
        numerator,
        level,
        is_exact: true,
        sign_before: 0,
    }
}

/// Roots in the open interval from `numerator / 2^level`, one step wide, whose Bernstein
/// coefficients are given up to a positive factor.
fn descend(
    polynomial: &Rc<Polynomial>,
    coefficients: &[IBig],
    numerator: &IBig,
    level: usize,
    roots: &mut Vec<Root>,
) {
    let signs: Vec<i32> = coefficients
        .iter()
        .map(signum)
        .filter(|&s| s != 0)
        .collect();
    let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    match changes {
        0 => {}
        1 => roots.push(Root {
            polynomial: Rc::clone(polynomial),
            numerator: numerator.clone(),
            level,
            is_exact: false,
            // The first coefficient that does not vanish has the sign next to the low end.
            sign_before: signs[0],
        }),
        _ => {
            let (left, right) = halves(coefficients);
            let twice = numerator * IBig::from(2);
            let middle = &twice + IBig::ONE;
            descend(polynomial, &left, &twice, level + 1, roots);
            if right[0].is_zero() {
                roots.push(exact(polynomial, middle.clone(), level + 1));
            }
            descend(polynomial, &right, &middle, level + 1, roots);
        }
    }
}

/// Tells two different numbers apart, refining both until their enclosures are disjoint.
pub(crate) fn separate(a: &mut Root, b: &mut Root) -> Ordering {
    loop {
        // Two open intervals that meet in one point are disjoint.
        let touching_counts = !(a.is_exact && b.is_exact);
        if a.high() < b.low() || (touching_counts && a.high() == b.low()) {
            return Ordering::Less;
        }
        if b.high() < a.low() || (touching_counts && b.high() == a.low()) {
            return Ordering::Greater;
        }
        assert!(!(a.is_exact && b.is_exact), "different numbers");
        if b.is_exact || (!a.is_exact && a.level <= b.level) {
            a.refine();
        } else {
            b.refine();
        }
    }
}

/// The roots in [0, 1] and the signs between them: of 0..first root, of the gaps, of last root..1;
/// 0 for the first or last sign where the root lies on the end itself.
pub(crate) fn sign_pattern(polynomial: &Polynomial) -> (Vec<Root>, Vec<i32>) {
    let mut roots = isolate(polynomial);
    let mut signs = vec![polynomial.sign_at(&IBig::ZERO, 0)];
    for i in 1..roots.len() {
        let (before, after) = roots.split_at_mut(i);
        let (left, right) = (&mut before[i - 1], &mut after[0]);
        // An end of an enclosure may be a root itself: move away from it.
        while left.high() == right.low() && (left.is_exact || right.is_exact) {
            left.refine();
            right.refine();
        }
        let middle = (&left.high() + &right.low()).times_power_of_two(-1);
        signs.push(sign_at(polynomial, &middle));
    }
    if !roots.is_empty() {
        signs.push(polynomial.sign_at(&IBig::ONE, 0));
    }
    (roots, signs)
}

fn sign_at(polynomial: &Polynomial, at: &Dyadic) -> i32 {
    let level = usize::try_from(-at.exponent().min(0)).unwrap();
    polynomial.sign_at(&at.over(-exponent(level)), level)
}

/// De Casteljau at 1/2: Bernstein coefficients on both halves, both times `2^degree`.
pub(crate) fn halves(coefficients: &[IBig]) -> (Vec<IBig>, Vec<IBig>) {
    let degree = coefficients.len() - 1;
    let mut row = coefficients.to_vec();
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for step in 0..=degree {
        left.push(&row[0] << (degree - step));
        right.push(row.last().unwrap() << (degree - step));
        row = row.windows(2).map(|pair| &pair[0] + &pair[1]).collect();
    }
    right.reverse();
    (left, right)
}
