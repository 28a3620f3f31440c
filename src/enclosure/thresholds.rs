//! Relation of a squared distance to squared thresholds.

use super::scaled::TINY;
use crate::rounding::UNIT_ROUNDOFF;

/// Squared thresholds: values below `inside` are certainly inside, values above `outside` certainly
/// outside. Minus infinity where nothing can be inside, or everything must be outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct SquaredThresholds {
    pub(super) inside: f64,
    pub(super) outside: f64,
}

impl SquaredThresholds {
    /// Returns the thresholds for distances with an error of at most `error`.
    pub(super) fn new(low: f64, high: f64, error: f64) -> Self {
        let (near, far) = (low - error, high + error);
        Self {
            inside: if near > 0.0 {
                near * near * (1.0 - 8.0 * UNIT_ROUNDOFF) - TINY
            } else {
                f64::NEG_INFINITY
            },
            outside: if far >= 0.0 {
                far * far * (1.0 + 8.0 * UNIT_ROUNDOFF) + TINY
            } else {
                f64::NEG_INFINITY
            },
        }
    }
}

/// Signs of a part's Bernstein coefficients against one squared threshold.
///
/// With at most one uncertain coefficient between the certain ones of either side, the number of
/// sign changes is known whatever its sign: none or one, and so is the number of crossings
/// (Descartes' rule in Bernstein form).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SignPattern {
    Below,
    Above,
    /// Crosses once, from below.
    Rising,
    /// Crosses once, from above.
    Falling,
    Unclear,
}

impl SignPattern {
    pub(super) fn of(coefficients: &[f64; 7], error: f64, threshold: f64) -> Self {
        let (low, high) = (threshold - error, threshold + error);
        let first = coefficients[0];
        let mut pattern = if first < low {
            Self::Below
        } else if first > high {
            Self::Above
        } else {
            return Self::Unclear;
        };
        let mut is_doubtful = false;
        for &c in &coefficients[1..] {
            pattern = match pattern {
                Self::Below if c > high => Self::Rising,
                Self::Above if c < low => Self::Falling,
                Self::Below if c < low && !is_doubtful => continue,
                Self::Above if c > high && !is_doubtful => continue,
                Self::Rising if c > high => continue,
                Self::Falling if c < low => continue,
                // Neither: once, right before the side changes.
                Self::Below | Self::Above if !is_doubtful && low <= c && c <= high => {
                    is_doubtful = true;
                    continue;
                }
                _ => return Self::Unclear,
            };
            is_doubtful = false;
        }
        if is_doubtful { Self::Unclear } else { pattern }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounding::exact::number;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    fn pattern(coefficients: [f64; 7]) -> SignPattern {
        SignPattern::of(&coefficients, 0.5, 10.0)
    }

    #[test]
    fn only_what_is_certain_counts() {
        assert_eq!(pattern([1.0; 7]), SignPattern::Below);
        assert_eq!(pattern([20.0; 7]), SignPattern::Above);
        assert_eq!(
            pattern([1.0, 1.0, 1.0, 20.0, 20.0, 20.0, 20.0]),
            SignPattern::Rising
        );
        assert_eq!(
            pattern([20.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
            SignPattern::Falling
        );
        // One uncertain coefficient where the side changes, and nowhere else.
        assert_eq!(
            pattern([1.0, 1.0, 10.2, 20.0, 20.0, 20.0, 20.0]),
            SignPattern::Rising
        );
        assert_eq!(
            pattern([20.0, 10.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
            SignPattern::Falling
        );
        for unclear in [
            [10.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
            [1.0, 1.0, 10.0, 1.0, 1.0, 1.0, 1.0],
            [1.0, 10.0, 1.0, 20.0, 20.0, 20.0, 20.0],
            [20.0, 10.0, 20.0, 1.0, 1.0, 1.0, 1.0],
            [1.0, 10.0, 10.0, 20.0, 20.0, 20.0, 20.0],
            [1.0, 20.0, 20.0, 10.0, 20.0, 20.0, 20.0],
            [1.0, 20.0, 1.0, 20.0, 20.0, 20.0, 20.0],
            [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 10.0],
            [1.0, 1.0, 1.0, 1.0, 1.0, 20.0, 10.0],
            [f64::NAN, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
            [1.0, f64::NAN, 1.0, 1.0, 1.0, 1.0, 1.0],
        ] {
            assert_eq!(pattern(unclear), SignPattern::Unclear, "{unclear:?}");
        }
    }

    #[test]
    fn impossible_thresholds_are_at_minus_infinity() {
        let nothing_inside = SquaredThresholds::new(1.0, 1.0, 2.0);
        assert!(nothing_inside.inside <= f64::NEG_INFINITY);
        assert!((9.0..9.1).contains(&nothing_inside.outside));
        let all_outside = SquaredThresholds::new(-3.0, -3.0, 2.0);
        assert!(all_outside.outside <= f64::NEG_INFINITY);
    }

    /// Includes thresholds that the error nearly cancels.
    #[test]
    fn thresholds_are_rounded_outward() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for round in 0..5_000 {
            let size = 10f64.powf(random.random_range(-59.0..59.0));
            let radius = size * random.random_range(0.5..1.0);
            let error = radius * [1e-15, 1e-3, 0.999][round % 3];
            let thresholds = SquaredThresholds::new(radius, radius, error);
            let (near, far) = (
                number(radius) - number(error),
                number(radius) + number(error),
            );
            assert!(
                number(thresholds.inside) <= &near * &near,
                "{radius} {error}"
            );
            assert!(
                number(thresholds.outside) >= &far * &far,
                "{radius} {error}"
            );
        }
    }
}
