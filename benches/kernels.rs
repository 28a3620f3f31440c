//! The closest approach of two cubics: this crate's kernels, its scalar solvers, and others.
//!
//! `cargo bench --bench kernels` prints the accuracy of every method against exact arithmetic,
//! then times them. `NEARMISS_ACCURACY_PAIRS` sets the number of pairs of the table (4096; 0
//! leaves it out).
#![allow(
    missing_docs,
    clippy::cast_possible_truncation,
    reason = "criterion's macros make undocumented functions; rounding to f32 is wanted"
)]

#[path = "kernels/accuracy.rs"]
mod accuracy;
#[path = "../tests/kernels/exact.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod exact;
#[path = "kernels/peers.rs"]
mod peers;
#[path = "kernels/workloads.rs"]
mod workloads;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};
use nearmiss::narrow_phase::kernels::{
    ControlPoints, CubicBatch, Enclosure, Level, Verdict, closest_approach, enclose, scalar, within,
};
use std::hint::black_box;
use workloads::Workload;

/// The pairs of every iteration.
const PAIRS: usize = 4096;

/// The tolerance of the literature, in local time.
const TOLERANCE: f64 = 6e-7;

/// The error of the cubics given to the certified kernel, metres.
const ERROR: f64 = 1e-14;

/// Local time and distance of one pair.
type Single = fn(&ControlPoints<f64>) -> (f64, f64);

/// A way to find the closest approach, by the names of the benchmark ids.
#[derive(Clone, Copy, Debug)]
enum Method {
    Polycool,
    PolycoolFull,
    Yuksel,
    YukselFull,
    Companion,
    Sampled,
    Scalar,
    BatchF64,
    BatchF32,
    Certified,
}

impl Method {
    const ALL: [Self; 10] = [
        Self::Polycool,
        Self::PolycoolFull,
        Self::Yuksel,
        Self::YukselFull,
        Self::Companion,
        Self::Sampled,
        Self::Scalar,
        Self::BatchF64,
        Self::BatchF32,
        Self::Certified,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Polycool => "polycool",
            Self::PolycoolFull => "polycool_full",
            Self::Yuksel => "yuksel",
            Self::YukselFull => "yuksel_full",
            Self::Companion => "companion",
            Self::Sampled => "sampled",
            Self::Scalar => "scalar",
            Self::BatchF64 => "batch_f64",
            Self::BatchF32 => "batch_f32",
            Self::Certified => "certified",
        }
    }

    /// The method for one pair, if it is one for single pairs.
    fn single(self) -> Option<Single> {
        match self {
            Self::Polycool => Some(|pair| peers::polycool(pair, TOLERANCE)),
            Self::PolycoolFull => Some(|pair| peers::polycool(pair, 1e-12)),
            Self::Yuksel => Some(|pair| scalar::closest_approach_by_roots(pair, TOLERANCE)),
            Self::YukselFull => Some(|pair| scalar::closest_approach_by_roots(pair, 0.0)),
            Self::Companion => Some(peers::companion),
            Self::Sampled => Some(peers::sampled),
            Self::Scalar => Some(scalar::closest_approach),
            Self::BatchF64 | Self::BatchF32 | Self::Certified => None,
        }
    }

    /// The distances of many pairs; for enclosures their middle.
    fn distances(self, pairs: &[ControlPoints<f64>]) -> Vec<f64> {
        if let Some(method) = self.single() {
            return pairs.iter().map(|pair| method(pair).1).collect();
        }
        let mut work = Batch::new(pairs);
        match self {
            Self::BatchF32 => {
                work.closest_approach_f32();
                work.distances_f32.iter().map(|d| f64::from(*d)).collect()
            }
            Self::Certified => {
                work.enclose();
                work.enclosures
                    .iter()
                    .map(|e| 0.5 * (e.low + e.high))
                    .collect()
            }
            _ => {
                work.closest_approach();
                work.distances
            }
        }
    }
}

/// Pairs in the form that the kernels take, and room for the answers.
struct Batch {
    cubics: CubicBatch<f64>,
    cubics_f32: CubicBatch<f32>,
    times: Vec<f64>,
    distances: Vec<f64>,
    times_f32: Vec<f32>,
    distances_f32: Vec<f32>,
    errors: Vec<f64>,
    enclosures: Vec<Enclosure>,
    verdicts: Vec<Verdict>,
}

impl Batch {
    fn new(pairs: &[ControlPoints<f64>]) -> Self {
        let count = pairs.len();
        let (mut cubics, mut cubics_f32) = (CubicBatch::new(), CubicBatch::new());
        cubics.extend(pairs.iter().copied());
        cubics_f32.extend(
            pairs
                .iter()
                .map(|pair| pair.map(|point| point.map(|x| x as f32))),
        );
        let nowhere = Enclosure {
            low: 0.0,
            high: 0.0,
            time: 0.0,
        };
        Self {
            cubics,
            cubics_f32,
            times: vec![0.0; count],
            distances: vec![0.0; count],
            times_f32: vec![0.0; count],
            distances_f32: vec![0.0; count],
            errors: vec![ERROR; count],
            enclosures: vec![nowhere; count],
            verdicts: vec![Verdict::Undecided; count],
        }
    }

    fn closest_approach(&mut self) {
        let lanes = self.cubics.lanes();
        closest_approach(Level::best(), &lanes, &mut self.times, &mut self.distances);
    }

    fn closest_approach_f32(&mut self) {
        let lanes = self.cubics_f32.lanes();
        closest_approach(
            Level::best(),
            &lanes,
            &mut self.times_f32,
            &mut self.distances_f32,
        );
    }

    fn enclose(&mut self) {
        enclose(
            Level::best(),
            &self.cubics.lanes(),
            &self.errors,
            &mut self.enclosures,
        );
    }
}

fn closest_approach_group(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closest_approach");
    group.throughput(Throughput::Elements(PAIRS as u64));
    for workload in Workload::ALL {
        let pairs = workload.pairs(PAIRS, 1);
        let mut work = Batch::new(&pairs);
        for method in Method::ALL {
            group.bench_function(
                BenchmarkId::new(method.name(), workload.name()),
                |bencher| {
                    if let Some(single) = method.single() {
                        bencher.iter(|| {
                            for (i, pair) in pairs.iter().enumerate() {
                                (work.times[i], work.distances[i]) = single(black_box(pair));
                            }
                            black_box(&mut work.distances);
                        });
                        return;
                    }
                    bencher.iter(|| {
                        match method {
                            Method::BatchF32 => work.closest_approach_f32(),
                            Method::Certified => work.enclose(),
                            _ => work.closest_approach(),
                        }
                        black_box(&mut work);
                    });
                },
            );
        }
    }
    group.finish();
}

/// A threshold that 2 % of the pairs come within.
fn sparse_threshold(pairs: &[ControlPoints<f64>]) -> f64 {
    let mut distances: Vec<f64> = pairs
        .iter()
        .map(|p| scalar::closest_approach(p).1)
        .collect();
    distances.sort_by(f64::total_cmp);
    let rank = distances.len() / 50;
    // Between two distances, so that rounding to f32 does not matter.
    0.5 * (distances[rank - 1] + distances[rank])
}

fn within_group(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("within");
    group.throughput(Throughput::Elements(PAIRS as u64));
    let pairs = Workload::Random.pairs(PAIRS, 1);
    let threshold = sparse_threshold(&pairs);
    let limits = vec![threshold; PAIRS];
    let limits_f32 = vec![threshold as f32; PAIRS];
    let mut work = Batch::new(&pairs);
    group.bench_function(BenchmarkId::new("yuksel", "sparse"), |bencher| {
        bencher.iter(|| {
            let near = |pair| peers::within_by_roots(black_box(pair), threshold);
            pairs.iter().filter(|pair| near(pair)).count()
        });
    });
    group.bench_function(BenchmarkId::new("scalar", "sparse"), |bencher| {
        bencher.iter(|| {
            for (verdict, pair) in work.verdicts.iter_mut().zip(&pairs) {
                *verdict = scalar::within(black_box(pair), threshold, threshold);
            }
            black_box(&mut work.verdicts);
        });
    });
    group.bench_function(BenchmarkId::new("batch_f64", "sparse"), |bencher| {
        bencher.iter(|| {
            let lanes = work.cubics.lanes();
            within(Level::best(), &lanes, &limits, &limits, &mut work.verdicts);
            black_box(&mut work.verdicts);
        });
    });
    group.bench_function(BenchmarkId::new("batch_f32", "sparse"), |bencher| {
        bencher.iter(|| {
            let lanes = work.cubics_f32.lanes();
            within(
                Level::best(),
                &lanes,
                &limits_f32,
                &limits_f32,
                &mut work.verdicts,
            );
            black_box(&mut work.verdicts);
        });
    });
    group.finish();
}

criterion_group!(benches, closest_approach_group, within_group);

fn main() {
    let count = std::env::var("NEARMISS_ACCURACY_PAIRS")
        .ok()
        .and_then(|n| n.parse().ok());
    // A smoke test (`cargo test --benches`) passes `--test`: the table would only take time.
    let timing = std::env::args().any(|argument| argument == "--bench");
    let count = count.unwrap_or(if timing { PAIRS } else { 16 });
    if count > 0 {
        println!("Level: {}", Level::best().name());
        accuracy::print_table(count);
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
