//! Pairs of cubics: random ones, near ones, and ones that are hard.

use nearmiss::kernels::ControlPoints;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// The kinds of pairs, by the names of the benchmark ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Workload {
    /// Both bodies start and end anywhere in a 10 m cube, with velocities of N(0, 5 m/s) in each
    /// coordinate, over one second.
    Random,
    /// The same, but every second pair passes within 1 m of each other at a random time.
    Near,
    /// Many nearly equal minima, multiple roots, docking, constant distances.
    Adversarial,
}

impl Workload {
    pub(crate) const ALL: [Self; 3] = [Self::Random, Self::Near, Self::Adversarial];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Near => "near",
            Self::Adversarial => "adversarial",
        }
    }

    /// The first `count` pairs of a seed.
    pub(crate) fn pairs(self, count: usize, seed: u64) -> Vec<ControlPoints<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..count)
            .map(|i| match self {
                Self::Random => random_pair(&mut random),
                Self::Near if i % 2 == 0 => near_pair(&mut random),
                Self::Near => random_pair(&mut random),
                Self::Adversarial => adversarial_pair(&mut random, i % 8),
            })
            .collect()
    }
}

type Vector = [f64; 3];

fn combine(a: f64, x: Vector, b: f64, y: Vector) -> Vector {
    std::array::from_fn(|i| a * x[i] + b * y[i])
}

/// A normally distributed number, by the method of Box and Muller.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random_range(0.0..1.0_f64)).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random_range(0.0..1.0_f64)).cos()
}

fn normal_vector(random: &mut ChaCha8Rng) -> Vector {
    std::array::from_fn(|_| normal(random))
}

fn body(random: &mut ChaCha8Rng) -> ControlPoints<f64> {
    let mut place = || std::array::from_fn(|_| random.random_range(0.0..10.0));
    let (start, end): (Vector, Vector) = (place(), place());
    // Over one second a third of the velocity is the first leg of the polygon.
    let (leaving, arriving) = (normal_vector(random), normal_vector(random));
    [
        start,
        combine(1.0, start, 5.0 / 3.0, leaving),
        combine(1.0, end, -5.0 / 3.0, arriving),
        end,
    ]
}

fn random_pair(random: &mut ChaCha8Rng) -> ControlPoints<f64> {
    let (a, b) = (body(random), body(random));
    std::array::from_fn(|i| combine(1.0, a[i], -1.0, b[i]))
}

fn near_pair(random: &mut ChaCha8Rng) -> ControlPoints<f64> {
    let pair = random_pair(random);
    let s = random.random_range(0.0..1.0_f64);
    let t = 1.0 - s;
    let weights = [t * t * t, 3.0 * s * t * t, 3.0 * s * s * t, s * s * s];
    let miss: Vector = loop {
        let point = std::array::from_fn(|_| random.random_range(-1.0..1.0));
        if point.iter().map(|x: &f64| x * x).sum::<f64>() < 1.0 {
            break point;
        }
    };
    let shift: Vector = std::array::from_fn(|axis| {
        miss[axis] - (0..4).map(|i| weights[i] * pair[i][axis]).sum::<f64>()
    });
    pair.map(|point| combine(1.0, point, 1.0, shift))
}

/// From `16^-1` down to `1e-18`, evenly in the exponent, or exactly zero.
fn tiny(random: &mut ChaCha8Rng) -> f64 {
    match random.random_range(0..6) {
        0 => 0.0,
        _ => 10.0_f64.powf(random.random_range(-18.0..-1.2)),
    }
}

/// The control points of `c0 + c1 u + c2 u² + c3 u³` for `u` in -1..=1.
fn from_centred(c: [Vector; 4]) -> ControlPoints<f64> {
    let blossom = |u: f64, v: f64, w: f64| {
        let second = (u * v + v * w + w * u) / 3.0;
        let linear = combine(1.0, c[0], (u + v + w) / 3.0, c[1]);
        combine(1.0, combine(1.0, linear, second, c[2]), u * v * w, c[3])
    };
    [
        blossom(-1.0, -1.0, -1.0),
        blossom(-1.0, -1.0, 1.0),
        blossom(-1.0, 1.0, 1.0),
        blossom(1.0, 1.0, 1.0),
    ]
}

fn adversarial_pair(random: &mut ChaCha8Rng, family: usize) -> ControlPoints<f64> {
    let zero = [0.0; 3];
    let along = normal_vector(random).map(|x| 5.0 * x);
    let across = normal_vector(random);
    let small = tiny(random);
    let a = random.random_range(-1.1..1.1);
    match family {
        // Along a line and back and forth again: three minima that are nearly equal.
        0 => {
            let b = random.random_range(-1.0..1.0);
            let c = random.random_range(-1.0..1.0);
            let line = [-a * b * c, a * b + b * c + c * a, -(a + b + c), 1.0];
            let offset = combine(small, across, 0.0, zero);
            let tilt = combine(small * tiny(random), along, 0.0, zero);
            from_centred([
                combine(line[0], along, 1.0, offset),
                combine(line[1], along, 1.0, tilt),
                combine(line[2], along, 0.0, zero),
                combine(line[3], along, 0.0, zero),
            ])
        }
        // A triple root of the position, a sextic minimum of the squared distance.
        1 => from_centred([
            combine(-a * a * a, along, small, across),
            combine(3.0 * a * a, along, 0.0, zero),
            combine(-3.0 * a, along, 0.0, zero),
            along,
        ]),
        // A double root, a quartic minimum.
        2 => from_centred([
            combine(a * a, along, small, across),
            combine(-2.0 * a, along, small, across),
            along,
            combine(tiny(random), across, 0.0, zero),
        ]),
        // Docking: at rest in the end, nearly there.
        3 => {
            let end = combine(small, across, 0.0, zero);
            let third = combine(1.0, end, tiny(random), along);
            [combine(3.0, along, 1.0, across), along, third, end]
        }
        // An arc around the other body: the distance is constant up to 3e-4 of itself.
        4 => {
            let angle: f64 = random.random_range(0.1..1.6);
            let handle = 4.0 / 3.0 * (angle / 4.0).tan();
            let radius = 5.0 + across[0];
            let (sin, cos) = angle.sin_cos();
            [
                [radius, 0.0, small],
                [radius, radius * handle, small],
                [
                    radius * (cos + handle * sin),
                    radius * (sin - handle * cos),
                    0.0,
                ],
                [radius * cos, radius * sin, 0.0],
            ]
        }
        // At rest, or nearly; or on a straight line at constant velocity.
        5 => {
            let drift = [0.0, small, 1.0][random.random_range(0..3)];
            from_centred([along, combine(drift, across, 0.0, zero), zero, zero])
        }
        // A parabola that comes as near on its left as on its right, but for a tilt.
        6 => from_centred([
            combine(1.0, across, -random.random_range(0.1..1.0), along),
            combine(1.0, [along[1], -along[0], 0.0], small, across),
            along,
            combine(small, across, 0.0, zero),
        ]),
        // Farthest in the middle: both ends are equally near.
        _ => {
            let side = combine(2.0, along, 0.0, zero);
            [
                combine(1.0, across, small, along),
                combine(1.0, across, 1.0, side),
                combine(1.0, across, 1.0, side),
                across,
            ]
        }
    }
}
