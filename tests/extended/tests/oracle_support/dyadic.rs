//! Exact numbers m 2^e: sums, differences and products of f64 never leave them.

use dashu::base::Sign;
use dashu::integer::IBig;
use dashu::rational::RBig;
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// `mantissa * 2^exponent`; the mantissa is odd or zero (then the exponent is 0).
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Dyadic {
    mantissa: IBig,
    exponent: isize,
}

impl Dyadic {
    pub(crate) const ZERO: Self = Self {
        mantissa: IBig::ZERO,
        exponent: 0,
    };

    pub(crate) fn new(mantissa: IBig, exponent: isize) -> Self {
        match mantissa.trailing_zeros() {
            None => Self::ZERO,
            Some(0) => Self { mantissa, exponent },
            Some(zeros) => Self {
                mantissa: mantissa >> zeros,
                exponent: exponent + isize::try_from(zeros).unwrap(),
            },
        }
    }

    pub(crate) fn mantissa(&self) -> &IBig {
        &self.mantissa
    }

    pub(crate) fn exponent(&self) -> isize {
        self.exponent
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.mantissa.is_zero()
    }

    /// -1, 0 or 1.
    pub(crate) fn signum(&self) -> i32 {
        signum(&self.mantissa)
    }

    /// The integer `self / 2^exponent`; `exponent` must not exceed this number's own.
    pub(crate) fn over(&self, exponent: isize) -> IBig {
        if self.is_zero() {
            return IBig::ZERO;
        }
        &self.mantissa << usize::try_from(self.exponent - exponent).unwrap()
    }

    pub(crate) fn times_power_of_two(&self, power: isize) -> Self {
        if self.is_zero() {
            return Self::ZERO;
        }
        Self {
            mantissa: self.mantissa.clone(),
            exponent: self.exponent + power,
        }
    }

    pub(crate) fn times(&self, factor: i32) -> Self {
        Self::new(&self.mantissa * IBig::from(factor), self.exponent)
    }

    pub(crate) fn squared(&self) -> Self {
        self * self
    }

    pub(crate) fn cubed(&self) -> Self {
        &self.squared() * self
    }

    pub(crate) fn to_rational(&self) -> RBig {
        let shift = self.exponent.unsigned_abs();
        if self.exponent >= 0 {
            RBig::from(&self.mantissa << shift)
        } else {
            RBig::from_parts(self.mantissa.clone(), dashu::integer::UBig::ONE << shift)
        }
    }
}

/// -1, 0 or 1.
pub(crate) fn signum(number: &IBig) -> i32 {
    match (number.is_zero(), number.sign()) {
        (true, _) => 0,
        (false, Sign::Positive) => 1,
        (false, Sign::Negative) => -1,
    }
}

impl From<f64> for Dyadic {
    /// Exact, subnormal numbers included.
    fn from(value: f64) -> Self {
        assert!(value.is_finite(), "the oracle takes finite numbers");
        let bits = value.to_bits();
        let fraction = bits & ((1 << 52) - 1);
        let biased = isize::try_from((bits >> 52) & 0x7ff).unwrap();
        let (magnitude, exponent) = if biased == 0 {
            (fraction, -1074)
        } else {
            (fraction | 1 << 52, biased - 1075)
        };
        let mantissa = IBig::from(magnitude);
        let negative = bits >> 63 == 1;
        Self::new(if negative { -mantissa } else { mantissa }, exponent)
    }
}

impl From<i32> for Dyadic {
    fn from(value: i32) -> Self {
        Self::new(IBig::from(value), 0)
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: &Dyadic) -> Dyadic {
        if self.is_zero() {
            return other.clone();
        }
        if other.is_zero() {
            return self.clone();
        }
        let exponent = self.exponent.min(other.exponent);
        Dyadic::new(self.over(exponent) + other.over(exponent), exponent)
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: &Dyadic) -> Dyadic {
        self + &-other
    }
}

impl Neg for &Dyadic {
    type Output = Dyadic;

    fn neg(self) -> Dyadic {
        Dyadic {
            mantissa: -&self.mantissa,
            exponent: self.exponent,
        }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: &Dyadic) -> Dyadic {
        if self.is_zero() || other.is_zero() {
            return Dyadic::ZERO;
        }
        Dyadic {
            mantissa: &self.mantissa * &other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }
}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Dyadic {
    fn cmp(&self, other: &Self) -> Ordering {
        (self - other).signum().cmp(&0)
    }
}
