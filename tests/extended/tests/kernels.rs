//! The batch kernels against exact arithmetic, and against themselves with every instruction set.
//!
//! `NEARMISS_KERNEL_PAIRS` sets the number of random pairs of the long comparison (a tenth of it
//! adversarial); 20,000 if it is not set.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::cast_possible_truncation,
    reason = "tests may panic, compare exact results, and round to f32 on purpose"
)]

#[path = "kernels/bits.rs"]
mod bits;
#[path = "kernels/exact.rs"]
mod exact;
#[path = "kernels/extremes.rs"]
mod extremes;
#[path = "kernels/scales.rs"]
mod scales;
#[path = "kernels/slow_passes.rs"]
mod slow_passes;
#[path = "kernels/spans.rs"]
mod spans;
#[path = "../../../benches/kernels/workloads.rs"]
#[allow(dead_code, reason = "the benchmarks use the names as well")]
mod workloads;

use exact::Exact;
use nearmiss::kernels::{
    ControlPoints, CubicBatch, Enclosure, InstructionSet, Verdict, closest_approach, enclose,
    scalar, within,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use workloads::Workload;

/// Half the distance from 1 to the next number.
const U: f64 = 0.5 * f64::EPSILON;

fn batch(pairs: &[ControlPoints<f64>]) -> CubicBatch<f64> {
    let mut batch = CubicBatch::new();
    batch.extend(pairs.iter().copied());
    batch
}

fn rounded(points: &ControlPoints<f64>) -> ControlPoints<f32> {
    points.map(|point| point.map(|x| x as f32))
}

fn batch_f32(pairs: &[ControlPoints<f64>]) -> CubicBatch<f32> {
    let mut batch = CubicBatch::new();
    batch.extend(pairs.iter().map(rounded));
    batch
}

/// The largest distance of a control point.
fn size(points: &ControlPoints<f64>) -> f64 {
    let square = |point: &[f64; 3]| point.iter().map(|x| x * x).sum::<f64>();
    points.iter().map(square).fold(0.0, f64::max).sqrt()
}

fn approaches(instructions: InstructionSet, pairs: &[ControlPoints<f64>]) -> (Vec<f64>, Vec<f64>) {
    let (mut times, mut distances) = (vec![0.0; pairs.len()], vec![0.0; pairs.len()]);
    closest_approach(
        instructions,
        &batch(pairs).lanes(),
        &mut times,
        &mut distances,
    );
    (times, distances)
}

fn approaches_f32(
    instructions: InstructionSet,
    pairs: &[ControlPoints<f64>],
) -> (Vec<f32>, Vec<f32>) {
    let (mut times, mut distances) = (vec![0.0; pairs.len()], vec![0.0; pairs.len()]);
    closest_approach(
        instructions,
        &batch_f32(pairs).lanes(),
        &mut times,
        &mut distances,
    );
    (times, distances)
}

fn enclosures(
    instructions: InstructionSet,
    pairs: &[ControlPoints<f64>],
    errors: &[f64],
) -> Vec<Enclosure> {
    let nowhere = Enclosure {
        low: 0.0,
        high: 0.0,
        time: 0.0,
    };
    let mut enclosures = vec![nowhere; pairs.len()];
    enclose(instructions, &batch(pairs).lanes(), errors, &mut enclosures);
    enclosures
}

fn distance_at(points: &ControlPoints<f64>, s: f64) -> f64 {
    let t = 1.0 - s;
    let weights = [t * t * t, 3.0 * s * t * t, 3.0 * s * s * t, s * s * s];
    let square = |axis: usize| {
        (0..4)
            .map(|i| weights[i] * points[i][axis])
            .sum::<f64>()
            .powi(2)
    };
    (square(0) + square(1) + square(2)).sqrt()
}

#[test]
fn oracle_agrees_with_geometry() {
    // A straight line past the origin, 3 m off; through it; and away from it.
    let line = |a: f64, b: f64, miss: f64| -> ControlPoints<f64> {
        [0.0, 1.0, 2.0, 3.0].map(|i| [a + (b - a) * i / 3.0, miss, 0.0])
    };
    assert_eq!(Exact::new(&line(-6.0, 6.0, 3.0)).distance(), 3.0);
    assert!(Exact::new(&line(-6.0, 3.0, 0.0)).distance() < 1e-17);
    assert_eq!(Exact::new(&line(4.0, 10.0, 3.0)).distance(), 5.0);
    let exact = Exact::new(&line(-6.0, 6.0, 3.0));
    assert!(exact.is_certainly_below(3.000_000_000_000_001));
    assert!(exact.is_certainly_above(2.999_999_999_999_999));
    assert!((exact.excess(3.5) - 0.5).abs() < 1e-15);
}

#[test]
fn distances_agree_with_the_exact_oracle() {
    for workload in Workload::ALL {
        let pairs = workload.pairs(1_200, 11);
        let (times, distances) = approaches(InstructionSet::best(), &pairs);
        let (times_f32, distances_f32) = approaches_f32(InstructionSet::best(), &pairs);
        for (i, pair) in pairs.iter().enumerate() {
            let exact = Exact::new(pair);
            let error = exact.excess(distances[i]).abs();
            // The centred form has 7 roundings of numbers of up to 5 M in sum.
            assert!(
                error <= 40.0 * U * size(pair),
                "{error:e} of {workload:?} {i}: {pair:?}"
            );
            // The time is one at which that distance is attained (the test's own rounding added).
            let there = distance_at(pair, times[i]);
            assert!(
                (there - distances[i]).abs() <= 60.0 * U * size(pair),
                "{workload:?} {i}"
            );
            // Measured 2e-7 on these.
            let error = exact.excess(f64::from(distances_f32[i])).abs();
            assert!(
                error <= 1e-6 * size(pair),
                "{error:e} of {workload:?} {i} in f32: {pair:?}"
            );
            assert!((0.0..=1.0).contains(&times[i]) && (0.0..=1.0).contains(&times_f32[i]));
        }
    }
}

#[test]
fn enclosures_contain_the_exact_distance_and_are_narrow() {
    for workload in Workload::ALL {
        let pairs = workload.pairs(1_200, 12);
        let batch = enclosures(InstructionSet::best(), &pairs, &vec![0.0; pairs.len()]);
        for (i, pair) in pairs.iter().enumerate() {
            let exact = Exact::new(pair);
            for found in [batch[i], scalar::enclose(pair, 0.0)] {
                assert!(
                    !exact.is_certainly_below(found.low),
                    "{workload:?} {i} {found:?}"
                );
                assert!(
                    !exact.is_certainly_above(found.high),
                    "{workload:?} {i} {found:?}"
                );
                // Twice 15 units for the splits, 4 for the goal, and the roundings outward.
                let width = found.high - found.low;
                assert!(
                    width <= 64.0 * U * size(pair),
                    "{width:e} {workload:?} {i} {pair:?}"
                );
            }
        }
    }
}

#[test]
fn enclosures_hold_for_every_cubic_within_the_error() {
    let mut random = ChaCha8Rng::seed_from_u64(13);
    for workload in Workload::ALL {
        let pairs = workload.pairs(800, 14);
        let errors: Vec<f64> = pairs
            .iter()
            .map(|_| 10.0_f64.powf(random.random_range(-17.0..0.0)))
            .collect();
        let found = enclosures(InstructionSet::best(), &pairs, &errors);
        for (i, pair) in pairs.iter().enumerate() {
            // A shift by less than the error, since the control points move alike.
            let direction: [f64; 3] = std::array::from_fn(|_| random.random_range(-0.57..0.57));
            let moved = pair
                .map(|point| std::array::from_fn(|axis| point[axis] + errors[i] * direction[axis]));
            // The rounding of that sum is not part of the error.
            let exact = Exact::new(&moved);
            let slack = 4.0 * U * size(pair);
            assert!(
                !exact.is_certainly_below((found[i].low - slack).max(0.0)),
                "{workload:?} {i}"
            );
            assert!(
                !exact.is_certainly_above(found[i].high + slack),
                "{workload:?} {i}"
            );
            let width = found[i].high - found[i].low;
            assert!(
                width <= 2.6 * errors[i] + 64.0 * U * size(pair),
                "{width:e} {workload:?} {i}"
            );
        }
    }
}

/// Thresholds from far away down to the last digits of the least distance, on either side.
fn thresholds(random: &mut ChaCha8Rng, distance: f64, size: f64) -> f64 {
    let offset = 10.0_f64.powf(random.random_range(-17.0..0.5));
    let scale = if random.random_bool(0.5) {
        distance
    } else {
        size
    };
    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    (distance + sign * scale * offset).max(0.0)
}

#[test]
fn verdicts_are_never_wrong_and_rarely_undecided() {
    let mut random = ChaCha8Rng::seed_from_u64(15);
    let (mut decided, mut decided_f32, mut clear, mut clear_f32) = (0, 0, 0, 0);
    for workload in Workload::ALL {
        let pairs = workload.pairs(1_600, 16);
        let exact: Vec<Exact> = pairs.iter().map(Exact::new).collect();
        let limits: Vec<f64> = pairs
            .iter()
            .zip(&exact)
            .map(|(pair, exact)| thresholds(&mut random, exact.distance(), size(pair)))
            .collect();
        let limits_f32: Vec<f32> = limits.iter().map(|x| *x as f32).collect();
        let mut verdicts = vec![Verdict::Undecided; pairs.len()];
        let mut verdicts_f32 = verdicts.clone();
        within(
            InstructionSet::best(),
            &batch(&pairs).lanes(),
            &limits,
            &limits,
            &mut verdicts,
        );
        within(
            InstructionSet::best(),
            &batch_f32(&pairs).lanes(),
            &limits_f32,
            &limits_f32,
            &mut verdicts_f32,
        );
        for (i, pair) in pairs.iter().enumerate() {
            let one = scalar::within(pair, limits[i], limits[i]);
            let one_f32 = scalar::within(&rounded(pair), limits_f32[i], limits_f32[i]);
            for (verdict, limit) in [
                (verdicts[i], limits[i]),
                (one, limits[i]),
                // The points before rounding are what counts.
                (verdicts_f32[i], f64::from(limits_f32[i])),
                (one_f32, f64::from(limits_f32[i])),
            ] {
                let wrong = match verdict {
                    Verdict::Outside => exact[i].is_certainly_below(limit),
                    Verdict::Inside => exact[i].is_certainly_above(limit),
                    Verdict::Undecided => false,
                };
                assert!(!wrong, "{verdict:?} {limit:e} {workload:?} {i}: {pair:?}");
            }
            // Twice the width of the tight enclosure.
            let off = exact[i].excess(limits[i]).abs();
            if off > 128.0 * U * size(pair) {
                clear += 1;
                decided += usize::from(verdicts[i] != Verdict::Undecided);
            }
            // The same, and 2 · 1.8 units of the rounding to f32, which is 2^29 times coarser.
            if off > 4.0 * f64::from(f32::EPSILON) * size(pair) {
                clear_f32 += 1;
                decided_f32 += usize::from(verdicts_f32[i] != Verdict::Undecided);
            }
        }
    }
    assert_eq!((decided, decided_f32), (clear, clear_f32));
    // The generator must aim at both: most thresholds are clear, many are not in f32.
    assert!(
        clear > 3_500 && clear < 4_800 && clear_f32 > 1_500,
        "{clear} {clear_f32}"
    );
}

#[test]
fn long_comparison_finds_no_wrong_basin() {
    let count = std::env::var("NEARMISS_KERNEL_PAIRS").map_or(20_000, |n| n.parse().unwrap());
    for (workload, count, seed) in [
        (Workload::Random, count, 100),
        (Workload::Near, count / 2, 200),
        (Workload::Adversarial, count / 10, 300),
    ] {
        let mut done = 0;
        while done < count {
            let part = (count - done).min(50_000);
            compare_with_enclosures(workload, part, seed + done as u64);
            done += part;
        }
    }
}

/// Every distance against its enclosure, which is proven.
fn compare_with_enclosures(workload: Workload, count: usize, seed: u64) {
    let pairs = workload.pairs(count, seed);
    let (_, distances) = approaches(InstructionSet::best(), &pairs);
    let (_, distances_f32) = approaches_f32(InstructionSet::best(), &pairs);
    for (i, pair) in pairs.iter().enumerate() {
        let found = scalar::enclose(pair, 0.0);
        // As against the oracle; the enclosure is wider than that.
        let slack = 40.0 * U * size(pair);
        let inside = distances[i] >= found.low - slack && distances[i] <= found.high + slack;
        assert!(
            inside,
            "{} not in {found:?}: {workload:?} {seed} {i} {pair:?}",
            distances[i]
        );
        let slack = 1e-6 * size(pair);
        let single = f64::from(distances_f32[i]);
        let inside = single >= found.low - slack && single <= found.high + slack;
        assert!(
            inside,
            "{single} not in {found:?}: f32 {workload:?} {seed} {i} {pair:?}"
        );
    }
}
