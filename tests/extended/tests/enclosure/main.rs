//! The certified enclosures: by hand, and against the exact oracle on adversarial families.
//!
//! The long campaign (see `campaign`) runs by name only:
//!
//! ```text
//! NEARMISS_SEEDS=0..1000 cargo test --release --test enclosure campaign -- --ignored --nocapture
//! ```

#![allow(clippy::unwrap_used, reason = "a panic is a failed test")]

mod campaign;
mod case;
#[path = "../oracle_support/mod.rs"]
mod oracle_support;
mod sharp;

use campaign::{Table, run};
use case::{Case, largest_norm};
use nearmiss::glam::DVec3;
use nearmiss::internals::enclosure::{
    Effort, OutOfRange, Stretch, Threshold, UncertainCubic, Verdict,
};
use oracle_support::{FAMILIES, Polygon};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

fn cubic(points: Polygon, error: f64) -> UncertainCubic {
    UncertainCubic::new(points.map(DVec3::from_array), error).unwrap()
}

/// x from -1 to 1 with constant speed, y = 1.
fn fly_by() -> Polygon {
    let third = 1.0 / 3.0;
    [
        [-1.0, 1.0, 0.0],
        [-third, 1.0, 0.0],
        [third, 1.0, 0.0],
        [1.0, 1.0, 0.0],
    ]
}

fn exactly(threshold: f64) -> Threshold {
    Threshold {
        low: threshold,
        high: threshold,
    }
}

fn sides(stretches: &[Stretch]) -> Vec<Verdict> {
    stretches.iter().map(|stretch| stretch.side).collect()
}

#[test]
fn a_straight_line_passes_at_its_foot() {
    let least = cubic(fly_by(), 0.0).least_distance();
    assert!(least.distance.low <= 1.0 && 1.0 <= least.distance.high);
    // 9 roundings of the largest norm, sqrt 2, on both sides, 8 for the search, a few at the end.
    assert!(least.distance.high - least.distance.low < 5e-15);
    assert!(least.parameter.first <= 0.5 && 0.5 <= least.parameter.last);
    // The slope is known to 36u, the curvature of the squared distance is 4.
    assert!(least.parameter.last - least.parameter.first < 1e-13);
    assert_eq!(least.effort, Effort::Tight);
}

#[test]
fn a_straight_line_enters_and_leaves() {
    // distance² = 1 + (2s - 1)², 1.25² is met at 2s - 1 = ±3/4.
    let found = cubic(fly_by(), 0.0).stretches(exactly(1.25));
    let found = found.as_slice();
    let [out, into] = [Verdict::Outside, Verdict::Undecided];
    assert_eq!(sides(found), [out, into, Verdict::Inside, into, out]);
    for (stretch, exact) in [(found[1], 0.125), (found[3], 0.875)] {
        assert!(stretch.first < exact && exact < stretch.last);
        // 20 roundings of 1.4 m, at a closing speed of 1.2 m per unit, on both sides.
        assert!(stretch.last - stretch.first < 1e-14);
    }
}

#[test]
fn thresholds_of_all_signs() {
    let line = cubic(fly_by(), 0.0);
    let whole = |threshold: Threshold| {
        let found = line.stretches(threshold);
        assert_eq!(found.as_slice().len(), 1, "{threshold:?}");
        assert_eq!(found.effort(), Effort::Tight);
        found.as_slice()[0].side
    };
    assert_eq!(whole(exactly(-1.0)), Verdict::Outside);
    assert_eq!(whole(exactly(0.0)), Verdict::Outside);
    assert_eq!(whole(exactly(0.999)), Verdict::Outside);
    assert_eq!(whole(exactly(1.5)), Verdict::Inside);
    assert_eq!(whole(exactly(1e200)), Verdict::Inside);
    let (low, high) = (-1.0, 2.0);
    assert_eq!(whole(Threshold { low, high }), Verdict::Undecided);
}

#[test]
fn nothing_is_inside_a_negative_threshold() {
    // Found by the long campaign (seed 1000030, Zeros): a negative threshold nearer to zero than
    // the error, where the cubic rests at the origin.
    let mut points = [[0.0; 3]; 4];
    points[3] = [0.936_899, 0.294_404, -0.853_524];
    for threshold in [-1e-300, -0.009_318, -0.1] {
        let found = cubic(points, 0.009_368_9).stretches(exactly(threshold));
        assert_eq!(sides(found.as_slice()), [Verdict::Outside], "{threshold}");
    }
}

#[test]
fn a_touch_is_undecided_and_nothing_else() {
    let found = cubic(fly_by(), 0.0).stretches(exactly(1.0));
    let found = found.as_slice();
    assert_eq!(
        sides(found),
        [Verdict::Outside, Verdict::Undecided, Verdict::Outside]
    );
    assert!(found[1].first <= 0.5 && 0.5 <= found[1].last);
    // distance - 1 = 2 (s - 1/2)² there: within 10 times 12 roundings for |s - 1/2| < 1e-7.
    assert!(found[1].last - found[1].first < 2e-7);
}

#[test]
fn constant_distance() {
    let beside = cubic([[0.0, 3.0, 4.0]; 4], 0.0);
    let least = beside.least_distance();
    assert!(least.distance.low <= 5.0 && 5.0 <= least.distance.high);
    assert!(least.parameter.first <= 0.0 && 1.0 <= least.parameter.last);
    let side = |threshold: f64| beside.stretches(exactly(threshold)).as_slice()[0].side;
    assert_eq!(side(5.0), Verdict::Undecided);
    assert_eq!(side(5.0 - 1e-13), Verdict::Outside);
    assert_eq!(side(5.0 + 1e-13), Verdict::Inside);
    // Coincident and exactly known: at most the smallest number.
    let together = cubic([[0.0; 3]; 4], 0.0).least_distance();
    assert!(together.distance.low <= 0.0 && together.distance.high <= f64::from_bits(1));
}

#[test]
fn what_is_out_of_range_is_refused() {
    let mut points = fly_by().map(DVec3::from_array);
    for error in [-1.0, f64::NAN, f64::INFINITY, 1e301] {
        assert_eq!(UncertainCubic::new(points, error), Err(OutOfRange));
    }
    for bad in [f64::NAN, f64::NEG_INFINITY, 1e301, -1e301] {
        points[2].y = bad;
        assert_eq!(UncertainCubic::new(points, 0.0), Err(OutOfRange));
    }
    points[2].y = 1e300;
    let largest = UncertainCubic::new(points, 1e300).unwrap().least_distance();
    assert!(largest.distance.high.is_finite());
}

#[test]
fn powers_of_two_change_nothing() {
    // Within the unscaled range every operation scales along; beyond it the ends may move by one
    // unit in the last place outward.
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut checked = 0;
    for family in FAMILIES {
        for _ in 0..20 {
            let case = Case::draw(&mut random, family);
            let size = largest_norm(&case.points);
            if !(1e-10..1e10).contains(&size) {
                continue;
            }
            checked += 1;
            let plain = case.cubic.least_distance();
            for power in [-100, 100, -700, 700] {
                let factor = 2f64.powi(power);
                let points = case.points.map(|point| point.map(|x| x * factor));
                let least = cubic(points, case.error * factor).least_distance();
                for (end, scaled) in [
                    (plain.distance.low, least.distance.low),
                    (plain.distance.high, least.distance.high),
                ] {
                    // Two units in the last place, and what the fixed terms against underflow
                    // (1e-250 in squares of 1e-60) add to a distance.
                    let difference = (scaled / factor - end).abs();
                    assert!(difference <= 4.0 * f64::EPSILON * end + 1e-30 * size);
                }
            }
        }
    }
    assert!(checked > 200, "{checked}");
}

#[test]
fn claims_hold_on_all_families() {
    let mut table = Table::default();
    // 14 families, 20 seeds, 100 cases each, every one with a least distance and a partition.
    for seed in 0..20 {
        run(seed, 100, 8, &mut table);
    }
    table.assert_sound();
}

#[test]
#[ignore = "takes as long as NEARMISS_SEEDS says"]
fn long_campaign() {
    campaign::long();
}

#[test]
fn nothing_is_certain_about_a_threshold_that_is_none() {
    let cubic = UncertainCubic::new([DVec3::X; 4], 0.0).unwrap();
    for (low, high) in [
        (f64::NAN, f64::NAN),
        (0.5, f64::NAN),
        (f64::NAN, 0.5),
        (2.0, 0.5),
    ] {
        let stretches = cubic.stretches(Threshold { low, high });
        let sides: Vec<Verdict> = stretches.as_slice().iter().map(|one| one.side).collect();
        assert_eq!(sides, [Verdict::Undecided], "{low} {high}");
    }
}
