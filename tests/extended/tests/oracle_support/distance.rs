//! The squared distance over a span, as an integer polynomial of degree 6 and an exact factor.

use super::dyadic::Dyadic;
use super::motion::{Body, Span, spans};
use super::polynomial::Polynomial;
use dashu::integer::IBig;
use dashu::rational::RBig;

/// `distance² = polynomial(u) * 2^exponent / scale²` at the instant `start + (end - start) u`.
#[derive(Clone, Debug)]
pub(crate) struct SquaredDistance {
    pub(crate) start: Dyadic,
    pub(crate) end: Dyadic,
    pub(crate) polynomial: Polynomial,
    exponent: isize,
    /// Positive: the product of the segments' durations cubed, or 1.
    scale: Dyadic,
}

/// The squared distance of two bodies over each of their spans, in the order of time.
pub(crate) fn squared_distances(
    a: &Body,
    b: &Body,
    window: Option<(f64, f64)>,
) -> Vec<SquaredDistance> {
    spans(a, b, window)
        .iter()
        .map(SquaredDistance::over)
        .collect()
}

impl SquaredDistance {
    pub(crate) fn over(span: &Span<'_>) -> Self {
        let width = &span.end - &span.start;
        let (a, scale_a) = span.a.restricted(&span.start, &width);
        let (b, scale_b) = span.b.restricted(&span.start, &width);
        // Equal factors need not be multiplied up.
        let (factor_a, factor_b, scale) = if scale_a == scale_b {
            (Dyadic::from(1), Dyadic::from(1), scale_a)
        } else {
            let product = &scale_a * &scale_b;
            (scale_b, scale_a, product)
        };
        let mut square: Vec<Dyadic> = vec![Dyadic::ZERO; 7];
        for axis in 0..3 {
            let relative: Vec<Dyadic> = (0..4)
                .map(|i| &(&a[i][axis] * &factor_a) - &(&b[i][axis] * &factor_b))
                .collect();
            for (i, x) in relative.iter().enumerate() {
                square[2 * i] = &square[2 * i] + &x.squared();
                for (j, y) in relative.iter().enumerate().skip(i + 1) {
                    square[i + j] = &square[i + j] + &(x * y).times_power_of_two(1);
                }
            }
        }
        let (polynomial, exponent) = Polynomial::from_dyadics(&square);
        Self {
            start: span.start.clone(),
            end: span.end.clone(),
            polynomial,
            exponent,
            scale,
        }
    }

    /// The instant of a local parameter.
    pub(crate) fn time(&self, u: &Dyadic) -> Dyadic {
        &self.start + &(&(&self.end - &self.start) * u)
    }

    /// `2^exponent / scale²`: squared metres per unit of the polynomial.
    pub(crate) fn unit(&self) -> RBig {
        Dyadic::new(IBig::ONE, self.exponent).to_rational() / self.scale.squared().to_rational()
    }

    /// `distance² - level`, up to a positive factor.
    pub(crate) fn minus(&self, level: &RBig) -> Polynomial {
        // polynomial 2^e m - n scale², with level = n / m, over the smaller power of two.
        let square = self.scale.squared();
        let exponent = self.exponent.min(square.exponent());
        let denominator = IBig::from(level.denominator().clone());
        let shift = usize::try_from(self.exponent - exponent).unwrap();
        let mut coefficients: Vec<IBig> = self
            .polynomial
            .coefficients()
            .iter()
            .map(|c| (c * &denominator) << shift)
            .collect();
        if coefficients.is_empty() {
            coefficients.push(IBig::ZERO);
        }
        coefficients[0] -= square.over(exponent) * level.numerator();
        Polynomial::new(coefficients)
    }

    /// Squared distance at a local parameter, m².
    pub(crate) fn at(&self, u: &Dyadic) -> RBig {
        let value = if u.exponent() >= 0 {
            self.polynomial.value_at(&u.over(0), 0)
        } else {
            let level = u.exponent().unsigned_abs();
            self.polynomial.value_at(u.mantissa(), level)
        };
        value.to_rational() * self.unit()
    }
}
