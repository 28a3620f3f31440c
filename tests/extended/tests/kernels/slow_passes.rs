//! Pairs that meet slowly while they accelerate across their velocity.
//!
//! There the slope of the squared distance has a second derivative of zero: the estimate of a step's error,
//! which holds no other, is too small.

use super::{ControlPoints, InstructionSet, U, approaches, approaches_f32, scalar, size};
use nearmiss::glam::DVec3;
use nearmiss::{Accuracy, Body, Query, Scene, State, Trajectory, Window};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Error in f64 and in f32 that the kernels allow themselves, as parts of the polygon's size.
const ALLOWED: [f64; 2] = [40.0 * U, 1e-6];

fn assert_accurate(pairs: &[ControlPoints<f64>]) {
    let (_, distances) = approaches(InstructionSet::best(), pairs);
    let (_, distances_f32) = approaches_f32(InstructionSet::best(), pairs);
    for (i, pair) in pairs.iter().enumerate() {
        let exact = scalar::enclose(pair, 0.0);
        for (found, allowed) in [distances[i], f64::from(distances_f32[i])]
            .into_iter()
            .zip(ALLOWED)
        {
            let off = (exact.low - found).max(found - exact.high) / size(pair);
            assert!(off <= allowed, "{found:e} is off by {off:e}: {pair:?}");
        }
    }
}

#[test]
fn slow_passes_that_a_search_found() {
    assert_accurate(&[
        [
            [0.6764178657757178, 0.46588975186941234, -0.6204976528808616],
            [
                -0.2506086404476484,
                -0.15544768962152747,
                0.22195791997710185,
            ],
            [
                -0.22484406874445811,
                -0.15551359365955655,
                0.20655638015107652,
            ],
            [0.7537115808852887, 0.46569203975532514, -0.6667022723589375],
        ],
        [
            [0.21417235891786895, 0.41926042143206677, 0.8735049623334898],
            [
                -0.07019763143276782,
                -0.10426356406007314,
                -0.30418545378819917,
            ],
            [
                -0.10324579488448266,
                -0.2129315756542905,
                -0.3185763564379629,
            ],
            [0.30925919253788464, 0.530641078904825, 0.9984571977332165],
        ],
    ]);
}

/// In powers of the centred time from the meeting: a velocity, an acceleration across it, and for every
/// second pair any jerk.
fn random_pairs(count: u32, seed: u64) -> Vec<ControlPoints<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|round| {
            let mut anywhere = |size: f64| [0; 3].map(|_| size * random.random_range(-1.0..1.0));
            let (quadratic, other, mut cubic) = (anywhere(1.0), anywhere(1.0), anywhere(1.0));
            let [a, b, c] = quadratic;
            let [x, y, z] = other;
            let across = [b * z - c * y, c * x - a * z, a * y - b * x];
            let length = |v: [f64; 3]| v.map(|x| x * x).iter().sum::<f64>().sqrt();
            let mut power = |low: f64| 10_f64.powf(random.random_range(low..-1.0));
            let speed = power(-3.0) * length(quadratic) / length(across);
            let jerk = if round % 2 == 0 {
                0.0
            } else {
                10.0 * power(-5.0)
            };
            cubic = cubic.map(|x| jerk * x);
            let time = random.random_range(-1.0..1.0);
            // Blossoms: the products of three times, and their sums, counted from the meeting.
            let point = |times: [f64; 3]| {
                let [t, u, v] = times.map(|end| end - time);
                let (sum, pairs, all) =
                    ((t + u + v) / 3.0, (t * u + u * v + v * t) / 3.0, t * u * v);
                std::array::from_fn(|axis| {
                    sum * speed * across[axis] + pairs * quadratic[axis] + all * cubic[axis]
                })
            };
            [
                point([-1.0; 3]),
                point([-1.0, -1.0, 1.0]),
                point([-1.0, 1.0, 1.0]),
                point([1.0; 3]),
            ]
        })
        .collect()
}

#[test]
fn slow_passes_at_random() {
    assert_accurate(&random_pairs(200_000, 18));
}

/// A screening finds the meeting by another way than the kernels.
#[test]
fn screenings_of_slow_passes() {
    for pair in random_pairs(4_000, 19) {
        let [p0, p1, p2, p3] = pair.map(DVec3::from_array);
        let states = [
            State::new(0.0, p0, 3.0 * (p1 - p0)),
            State::new(1.0, p3, 3.0 * (p3 - p2)),
        ];
        let mut scene = Scene::new();
        for trajectory in [
            Trajectory::at_rest(DVec3::ZERO),
            Trajectory::from_states(&states),
        ] {
            scene.insert(Body::new(trajectory.unwrap())).unwrap();
        }
        let query = Query::new(Window::new(0.0, 1.0).unwrap()).with_margin(100.0);
        let found = scene.screen(&query).unwrap().conflicts[0]
            .closest
            .separation;
        let certified = query.with_accuracy(Accuracy::Certified);
        let proven = scene.screen(&certified).unwrap().conflicts[0];
        let error = proven.certificate.unwrap().error;
        let off = (found - proven.closest.separation).abs() - error;
        assert!(off <= ALLOWED[0] * size(&pair), "{off:e}: {pair:?}");
    }
}
