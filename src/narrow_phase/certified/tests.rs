//! Outward rounding against exact sums.

use super::separation::minus_radii;
use super::*;
use crate::rounding::exact::number;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Returns a number of random magnitude, so that sums are rounded, or lose one summand.
fn any(rng: &mut ChaCha8Rng) -> f64 {
    10f64.powf(rng.random_range(-20.0..2.0))
}

#[test]
fn thresholds_hold_the_exact_sum() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..5_000 {
        let (a, b) = (any(&mut rng), any(&mut rng));
        let margin = any(&mut rng) * if rng.random() { 1.0 } else { -1.0 };
        let Threshold { low, high } = threshold(a, b, margin);
        let exact = number(a) + number(b) + number(margin);
        let holds = number(low) <= exact && exact <= number(high);
        assert!(holds, "{a} {b} {margin}");
    }
}

/// Includes spheres much larger than their distance, or than each other.
#[test]
fn separations_hold_the_exact_difference() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..5_000 {
        let (distance, a, b) = (any(&mut rng), any(&mut rng), any(&mut rng));
        let exact = number(distance) - number(a) - number(b);
        let low = minus_radii(distance, (a, b), f64::next_down);
        let high = minus_radii(distance, (a, b), f64::next_up);
        let holds = number(low) <= exact && exact <= number(high);
        assert!(holds, "{distance} {a} {b}");
    }
}

/// The half-width around the reported value covers both ends, for very different magnitudes.
#[test]
fn half_widths_reach_both_ends() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let span = Span {
        start: 0.0,
        end: 1.0,
        cubic_a: 0,
        cubic_b: 0,
    };
    let time = TimeEnclosure {
        earliest: 0.0,
        latest: 1.0,
    };
    for _ in 0..5_000 {
        let (low, high) = (-any(&mut rng), any(&mut rng));
        let least = SeparationEnclosure {
            low,
            high,
            time,
            span,
            spheres: (0, 0),
            own: time,
        };
        let separation = rng.random_range(low..high);
        let (found, error) = least.settle(Approach::at(0.5, separation, (0, 0), span));
        let (found, error) = (number(found.separation), number(error));
        let holds = &found - &error <= number(low) && number(high) <= &found + &error;
        assert!(holds, "{low} {high} {separation}");
    }
}
