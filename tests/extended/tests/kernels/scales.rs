//! Pairs from rest, at rest, and of every size.

use super::{ControlPoints, InstructionSet, approaches, approaches_f32, enclosures, scalar, size};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// From rest: no step downhill is a number where nothing moves.
#[test]
fn launches_and_stops() {
    let mut random = ChaCha8Rng::seed_from_u64(13);
    let mut anywhere = |size: f64| [0; 3].map(|_| size * random.random_range(-1.0..1.0));
    let pairs: Vec<ControlPoints<f64>> = (0..40_000)
        .map(|round| {
            let exponent = -14.0 + 12.0 * f64::from(round) / 40_000.0;
            let near = anywhere(10_f64.powf(exponent));
            let (one, other) = (anywhere(1.7), anywhere(1.7));
            match round % 4 {
                0 => [near, near, near, one],
                1 => [one, near, near, near],
                2 => [near, near, one, other],
                _ => [near, near, one, one],
            }
        })
        .collect();
    let exact = enclosures(InstructionSet::best(), &pairs, &vec![0.0; pairs.len()]);
    let (_, distances) = approaches(InstructionSet::best(), &pairs);
    let (_, rough) = approaches_f32(InstructionSet::best(), &pairs);
    for (i, exact) in exact.iter().enumerate() {
        assert!((distances[i] - exact.high).abs() <= 1e-13, "{:?}", pairs[i]);
        let off = (f64::from(rough[i]) - exact.high).abs();
        assert!(off <= 1e-5, "{off:e} {:?}", pairs[i]);
    }
}

/// In f32 they are squared twice.
#[test]
fn launches_of_any_size_in_single_precision() {
    let mut random = ChaCha8Rng::seed_from_u64(14);
    for exponent in -60..60 {
        let mut anywhere = |size: f64| [0; 3].map(|_| size * random.random_range(-1.0..1.0));
        let pairs: Vec<ControlPoints<f64>> = (0..400)
            .map(|round| {
                let size = 2_f64.powi(exponent);
                let near = anywhere(size * 10_f64.powi(-(round % 9)));
                let points = [near, near, anywhere(0.6 * size), anywhere(size)];
                points.map(|point| point.map(|x| f64::from(x as f32)))
            })
            .collect();
        let exact = enclosures(InstructionSet::best(), &pairs, &vec![0.0; pairs.len()]);
        let (_, rough) = approaches_f32(InstructionSet::best(), &pairs);
        for ((pair, rough), exact) in pairs.iter().zip(rough).zip(exact) {
            let off = (f64::from(rough) - exact.high).abs();
            assert!(off <= 4e-6 * size(pair), "2^{exponent}: {off:e} {pair:?}");
        }
    }
}

/// A pair at rest is as near at any time: alone and in a batch it is the same one.
#[test]
fn pairs_at_rest() {
    for unit in [1e-9, 1.0, 1e6, 1e12] {
        let rests = [[unit, -2.0 * unit, 0.5 * unit]; 4];
        let pairs = vec![rests; 9];
        let (times, distances) = approaches(InstructionSet::best(), &pairs);
        let alone = scalar::closest_approach(&rests);
        for found in times.into_iter().zip(distances) {
            assert_eq!(found, alone, "{unit:e}");
        }
        let norm = 5.25_f64.sqrt() * unit;
        assert!((alone.1 - norm).abs() <= 1e-15 * unit);
    }
}

/// Returns a pair whose distance along one axis vanishes at three times, while it is about as far away along
/// another one: the least of three minima takes a search.
fn triple_pass(random: &mut ChaCha8Rng) -> ControlPoints<f64> {
    let [a, b, c] = [0.0, 0.35, 0.7].map(|least| least + random.random_range(0.0..0.3));
    // The blossom of (s - a) (s - b) (s - c).
    let at = |x: f64, y: f64, z: f64| {
        let (sum, pairs) = (a + b + c, a * b + b * c + c * a);
        x * y * z - sum * (x * y + y * z + z * x) / 3.0 + pairs * (x + y + z) / 3.0 - a * b * c
    };
    let along = [
        at(0.0, 0.0, 0.0),
        at(0.0, 0.0, 1.0),
        at(0.0, 1.0, 1.0),
        at(1.0, 1.0, 1.0),
    ];
    let aside = 10_f64.powf(random.random_range(-4.0..-1.0));
    along.map(|along| {
        let near = aside * (1.0 + 0.01 * random.random_range(-1.0..1.0));
        [along, near, 0.01 * aside * random.random_range(-1.0..1.0)]
    })
}

/// Squares overflow or underflow, of f64 or of the f32 that proofs are made in.
#[test]
fn the_same_at_every_scale() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let pairs: Vec<ControlPoints<f64>> = (0..2_000)
        .map(|_| {
            [[0; 3]; 4].map(|point| {
                point.map(|_| {
                    let size = 10_f64.powf(random.random_range(-3.0..0.0));
                    size * random.random_range(-1.0..1.0)
                })
            })
        })
        .collect();
    let passes = (0..2_000).map(|_| triple_pass(&mut random));
    let pairs: Vec<_> = pairs.into_iter().chain(passes).collect();
    let errors = vec![0.0; pairs.len()];
    let exact = enclosures(InstructionSet::best(), &pairs, &errors);
    for exponent in [
        -990, -700, -500, -185, -150, -70, -60, 55, 64, 70, 110, 150, 185, 300, 520, 980,
    ] {
        let unit = 2_f64.powi(exponent);
        let scaled: Vec<_> = pairs
            .iter()
            .map(|points| points.map(|point| point.map(|x| x * unit)))
            .collect();
        let (_, distances) = approaches(InstructionSet::best(), &scaled);
        for ((points, distance), exact) in scaled.iter().zip(distances).zip(&exact) {
            let off = (distance / unit - exact.low).max(exact.high - distance / unit);
            assert!(
                off <= 1e-13,
                "2^{exponent} {points:?}: {distance:e} {exact:?}"
            );
            let (_, alone) = scalar::closest_approach(points);
            assert!((alone - distance).abs() <= 1e-13 * unit, "{points:?}");
        }
    }
}
