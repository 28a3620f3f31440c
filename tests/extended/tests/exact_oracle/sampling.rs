//! The oracle on random motions, against dense sampling in exact arithmetic and against itself.

use crate::oracle_support::{
    Body, Dyadic, Enclosure, SquaredDistance, State, contacts, minimum, never_below, reaches,
    squared_distances, stays_above,
};
use crate::{BITS, rational, state};
use dashu::rational::RBig;
use rand::rngs::ChaCha8Rng;
use rand::{Rng, RngExt, SeedableRng};

/// A number with random sign, fraction and an exponent from the range.
fn number(random: &mut impl Rng, exponents: std::ops::Range<i32>) -> f64 {
    let fraction: f64 = random.random_range(-1.0..1.0);
    fraction * 2f64.powi(random.random_range(exponents))
}

fn random_body(random: &mut impl Rng, exponents: &std::ops::Range<i32>) -> Body {
    let mut t = number(random, -3..2);
    let count = random.random_range(2..5);
    let states: Vec<State> = (0..count)
        .map(|_| {
            t += random.random_range(0.01..1.0) * 2f64.powi(random.random_range(-2..3));
            let mut vector = || std::array::from_fn(|_| number(random, exponents.clone()));
            let (p, v) = (vector(), vector());
            state(t, p, v)
        })
        .collect();
    Body::from_states(&states)
}

/// Every sampled instant obeys the minimum and the contacts.
fn check_by_sampling(distances: &[SquaredDistance], d: &RBig, samples: i32) {
    let least = minimum(distances, BITS).unwrap();
    let found = contacts(distances, d, BITS);
    let level = d.sqr();
    for pair in found.windows(2) {
        assert!(
            pair[0].exit.high < pair[1].enter.low,
            "stretches are apart and sorted"
        );
    }
    for distance in distances {
        for i in 0..=samples {
            let u = Dyadic::from(f64::from(i) / f64::from(samples));
            let (value, time) = (distance.at(&u), distance.time(&u).to_rational());
            assert!(value >= least.squared.low, "a sample below the minimum");
            // Between the ends' enclosures neither answer is demanded.
            let surely = found
                .iter()
                .any(|c| c.enter.high <= time && time <= c.exit.low);
            let perhaps = found
                .iter()
                .any(|c| c.enter.low <= time && time <= c.exit.high);
            assert!(
                !surely || value <= level,
                "a sample above D inside a contact"
            );
            assert!(
                perhaps || value > level,
                "a sample within D outside all contacts"
            );
        }
    }
    // The minimum is reached where it says so, and contacts exist exactly if it is within D.
    assert_eq!(least.squared.high <= level, !found.is_empty());
    for stretch in &least.instants {
        let middle = (&stretch.first.low + &stretch.first.high) / RBig::from(2);
        let nearest = distances
            .iter()
            .filter(|distance| {
                let ends = Enclosure {
                    low: distance.start.to_rational(),
                    high: distance.end.to_rational(),
                };
                ends.contains(&middle)
            })
            .map(|distance| {
                let start = distance.start.to_rational();
                let width = distance.end.to_rational() - &start;
                let u = f64_of(&((&middle - start) / width));
                distance.at(&Dyadic::from(u))
            })
            .min()
            .unwrap();
        // u is rounded to f64: off by 2^-53 at most, and the slope vanishes or u is an exact end.
        let scale = distances
            .iter()
            .map(|distance| {
                distance
                    .at(&Dyadic::ZERO)
                    .max(distance.at(&Dyadic::from(1)))
            })
            .max()
            .unwrap();
        let slack = scale / RBig::from(1_u64 << 40);
        assert!(
            nearest <= &least.squared.high + slack,
            "not reached where claimed"
        );
    }
}

fn f64_of(value: &RBig) -> f64 {
    value.to_f64_fast()
}

#[test]
fn random_motions_agree_with_dense_exact_sampling() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut checked = 0;
    for case in 0..150 {
        let exponents = [-1..1, -30..30, 900..1000, -1070..-1000][case % 4].clone();
        let (a, b) = (
            random_body(&mut random, &exponents),
            random_body(&mut random, &exponents),
        );
        let distances = squared_distances(&a, &b, None);
        if distances.is_empty() {
            continue;
        }
        let least = minimum(&distances, BITS).unwrap();
        let factor = rational([1, 2, 8, 30][case / 4 % 4], 2);
        let root = f64_of(&least.squared.low.clone()).sqrt();
        let root = if root.is_finite() && root > 0.0 {
            root
        } else {
            2f64.powi(exponents.end)
        };
        let d = Dyadic::from(root).to_rational() * factor;
        check_by_sampling(&distances, &d, 64);
        checked += 1;
    }
    assert!(checked > 80, "{checked}");
}

#[test]
fn claims_agree_with_the_isolated_minimum() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..300 {
        let (a, b) = (
            random_body(&mut random, &(-1..1)),
            random_body(&mut random, &(-1..1)),
        );
        for distance in squared_distances(&a, &b, None) {
            let one = std::slice::from_ref(&distance);
            let least = minimum(one, 120).unwrap();
            // f64 neighbours of the least distance, from 3 ulp below to 3 above.
            let mut bound = f64_of(&least.squared.low).sqrt() * (1.0 - 3.0 * f64::EPSILON);
            for _ in 0..7 {
                let exact = Dyadic::from(bound);
                let square = exact.squared().to_rational();
                if square < least.squared.low {
                    assert!(stays_above(&distance, &exact) && !reaches(&distance, &exact));
                } else if square > least.squared.high {
                    assert!(!never_below(&distance, &exact) && reaches(&distance, &exact));
                }
                bound = bound.next_up();
            }
        }
    }
}

#[test]
fn powers_of_two_change_nothing() {
    // Lengths times 2^k and times times 2^j: all enclosures scale along, bit for bit.
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..40 {
        let mut draw = || -> Vec<State> {
            (0..3)
                .map(|i| {
                    let p = std::array::from_fn(|_| number(&mut random, -2..2));
                    let v = std::array::from_fn(|_| number(&mut random, -2..2));
                    state(f64::from(i), p, v)
                })
                .collect()
        };
        let (a, b) = (draw(), draw());
        let scaled = |states: &[State]| -> Body {
            let (length, time) = (2f64.powi(-400), 2f64.powi(300));
            let states: Vec<State> = states
                .iter()
                .map(|s| {
                    let p = s.p.map(|x| x * length);
                    let v = s.v.map(|x| x * length / time);
                    state(s.t * time, p, v)
                })
                .collect();
            Body::from_states(&states)
        };
        let plain = squared_distances(&Body::from_states(&a), &Body::from_states(&b), None);
        let big = squared_distances(&scaled(&a), &scaled(&b), None);
        let (one, two) = (minimum(&plain, BITS).unwrap(), minimum(&big, BITS).unwrap());
        let area = RBig::from(2).pow(-800);
        let time = RBig::from(2).pow(300);
        assert_eq!(one.squared.low * &area, two.squared.low);
        assert_eq!(
            one.instants[0].first.low.clone() * time,
            two.instants[0].first.low
        );
    }
}
