//! Roundings outward, and what underflows, against exact arithmetic.

use super::cubic::ControlPoints;
use super::enclosure::{SPLIT, enclose_between};
use super::minorant::lower_bound;
use super::real::Real;
use super::screen::{Verdict, screen_eighths, screen_halves};
use crate::rounding::exact::number;
use dashu::rational::RBig;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn square(point: [f64; 3]) -> RBig {
    let squares = point.map(|x| number(x) * number(x));
    squares.into_iter().fold(RBig::ZERO, |sum, x| sum + x)
}

/// The error of the cubic, the rounding of its parts, and that of the least square found, whichever is largest.
fn enclosures<R: Real>(rng: &mut ChaCha8Rng) {
    let u = number(R::ROUNDING.to_f64());
    for round in 0..20_000 {
        let mut size = |from: i32| R::from_f64(10f64.powi(from) * rng.random_range(1.0..9.0));
        let (error, best) = [
            (R::from_f64(0.0), size(0)),
            (size(0), R::from_f64(0.0)),
            (size(-3), size(-2)),
            (R::from_f64(0.0), R::from_f64(0.0)),
        ][round % 4];
        let lanes = [(); 3].map(|()| size(-1));
        // A length that is known exactly, where it is added to one.
        let lanes = if round % 4 == 3 {
            lanes
        } else {
            [lanes[0], R::from_f64(0.0), R::from_f64(0.0)]
        };
        let points: ControlPoints<R> = [lanes; 4];
        let found = enclose_between(points, best, best, error, SPLIT);
        let wide = |x: R| number(x.to_f64());
        let length = square(lanes.map(R::to_f64));
        let part = number(SPLIT) * &u;
        let (low, high) = (wide(found.low), wide(found.high));
        let rest = &high - wide(error);
        if round % 4 == 3 {
            assert!(&rest * &rest >= length * &part * &part, "{round}");
            continue;
        }
        // The square that was found may be too small by three roundings.
        let total = wide(error) + part * wide(lanes[0].abs());
        let above = &high - &total;
        let least = wide(best) * (RBig::ONE + RBig::from(3) * &u);
        assert!(above >= RBig::ZERO && &above * &above >= least, "{round}");
        let below = &low + &total;
        assert!(
            low <= RBig::ZERO || &below * &below <= wide(best),
            "{round}"
        );
    }
}

#[test]
fn enclosures_are_rounded_outward() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    enclosures::<f64>(&mut rng);
    enclosures::<f32>(&mut rng);
}

/// Of cubics that rest the least distance is that of a point.
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
            threshold =
                (threshold * step).or_more(threshold + R::from_f64(f64::from(f32::from_bits(1))));
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

/// Squares of which the last digits are lost, or all.
#[test]
fn screens_are_rounded_outward() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    resting::<f32>(&mut rng, -23);
    resting::<f32>(&mut rng, 0);
}

/// From a base that moves on evenly: the least of the squared distance is known exactly.
fn straight<R: Real>(rng: &mut ChaCha8Rng) {
    for round in 0..40_000 {
        let bits = [4, 11][round % 2];
        let mut lane = || rng.random_range(-(1 << bits)..=1 << bits);
        let (start, step) = ([lane(), lane(), lane()], [lane(), lane(), lane()]);
        let points: [[i32; 3]; 4] =
            [0, 1, 2, 3].map(|count| [0, 1, 2].map(|k| start[k] + count * step[k]));
        let dot = |x: [i32; 3], y: [i32; 3]| {
            let terms = [0, 1, 2].map(|k| i64::from(x[k]) * i64::from(y[k]));
            RBig::from(terms.into_iter().sum::<i64>())
        };
        let way = step.map(|lane| 3 * lane);
        let (square, slope, bend) = (dot(start, start), dot(start, way), dot(way, way));
        let share = if bend > RBig::ZERO {
            -slope.clone() / &bend
        } else {
            RBig::ZERO
        };
        let share = share.max(RBig::ZERO).min(RBig::ONE);
        let least = (&bend * &share + RBig::from(2) * slope) * share + &square;
        let found = lower_bound(points.map(|point| point.map(|x| R::from_f64(f64::from(x)))));
        assert!(number(found.to_f64()) <= least, "{points:?}");
    }
}

#[test]
fn lower_bounds_are_below_straight_motions() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    straight::<f64>(&mut rng);
    straight::<f32>(&mut rng);
}
