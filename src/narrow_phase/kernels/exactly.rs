//! Underflow against exact arithmetic.

use super::Verdict;
use super::screen::{screen_eighths, screen_halves};
use crate::real::Real;
use crate::rounding::exact::number;
use dashu::rational::RBig;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn square(point: [f64; 3]) -> RBig {
    let squares = point.map(|x| number(x) * number(x));
    squares.into_iter().fold(RBig::ZERO, |sum, x| sum + x)
}

/// Checks constant cubics: their least distance is that of a point.
fn resting<R: Real>(rng: &mut ChaCha8Rng, least: i32) {
    for round in 0..20_000 {
        let unit =
            10f64.powf(f64::from(least) + [0.0, 3.0][round % 2] * rng.random_range(0.0..1.0));
        let point = [(); 3].map(|()| R::from_f64(unit * rng.random_range(-1.0..1.0)));
        let exact = square(point.map(R::to_f64));
        // The threshold is just reached, or just not.
        let mut threshold = R::not_above(exact.to_f64().value().sqrt());
        let step = R::from_f64(1.0) + R::from_f64(2.0) * R::ROUNDING;
        let squared = |x: R| number(x.to_f64()) * number(x.to_f64());
        while squared(threshold) < exact {
            threshold = (threshold * step)
                .max_or_other(threshold + R::from_f64(f64::from(f32::from_bits(1))));
        }
        for verdict in [
            screen_halves([point; 4], threshold, threshold),
            screen_eighths([point; 4], threshold, threshold),
        ] {
            assert_ne!(verdict, Verdict::Outside, "{round} {unit:e}");
        }
        let threshold = R::not_above(threshold.to_f64() * (1.0 - 4.0 * R::ROUNDING.to_f64()));
        if squared(threshold) <= exact {
            let verdict = screen_halves([point; 4], threshold, threshold);
            assert_ne!(verdict, Verdict::Inside, "{round} {unit:e}");
        }
    }
}

/// Squares that lose some or all of their digits to underflow.
#[test]
fn screens_are_rounded_outward() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    resting::<f32>(&mut rng, -23);
    resting::<f32>(&mut rng, 0);
}
