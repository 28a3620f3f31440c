//! The closest approach of two cubics: this crate's kernels, its scalar solvers, and others.
//!
//! `cargo bench --bench kernels` prints the accuracy of every method against exact arithmetic, the
//! ratios of their speeds (taken in turns, so that they hold on a busy machine), and then times
//! them one by one. `NEARMISS_INSTRUCTIONS` (`portable`, `avx2`, `avx512`) forces the instruction set;
//! `NEARMISS_ACCURACY_PAIRS` sets the number of random pairs of the first table (4096; 0 leaves it
//! out); the other workloads have a tenth as many.
#![allow(
    missing_docs,
    clippy::cast_possible_truncation,
    reason = "criterion's macros make undocumented functions; rounding to f32 is wanted"
)]

#[path = "kernels/accuracy.rs"]
mod accuracy;
#[path = "../tests/extended/tests/kernels/exact.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod exact;
#[path = "kernels/peers.rs"]
mod peers;
#[path = "kernels/ratios.rs"]
mod ratios;
#[path = "kernels/workloads.rs"]
mod workloads;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};
use nearmiss::kernels::{
    ControlPoints, CubicBatch, Enclosure, InstructionSet, Verdict, closest_approach, enclose,
    scalar, within,
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

    /// One run over all pairs.
    fn run(self, pairs: &[ControlPoints<f64>], work: &mut Batch) {
        match (self, self.single()) {
            (_, Some(single)) => {
                for (i, pair) in pairs.iter().enumerate() {
                    (work.times[i], work.distances[i]) = single(pair);
                }
            }
            (Self::BatchF32, _) => work.closest_approach_f32(),
            (Self::Certified, _) => work.enclose(),
            _ => work.closest_approach(),
        }
        black_box(work);
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
        closest_approach(
            InstructionSet::best(),
            &lanes,
            &mut self.times,
            &mut self.distances,
        );
    }

    fn closest_approach_f32(&mut self) {
        let lanes = self.cubics_f32.lanes();
        closest_approach(
            InstructionSet::best(),
            &lanes,
            &mut self.times_f32,
            &mut self.distances_f32,
        );
    }

    fn enclose(&mut self) {
        enclose(
            InstructionSet::best(),
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
            let id = BenchmarkId::new(method.name(), workload.name());
            group.bench_function(id, |bencher| {
                bencher.iter(|| method.run(black_box(&pairs), &mut work));
            });
        }
    }
    group.finish();
}

/// A way to screen pairs, by the names of the benchmark ids.
#[derive(Clone, Copy, Debug)]
enum Screening {
    Yuksel,
    Scalar,
    BatchF64,
    BatchF32,
}

/// A threshold that 2 % of the pairs come within, once and for each pair.
struct Limits {
    threshold: f64,
    each: Vec<f64>,
    each_f32: Vec<f32>,
}

impl Limits {
    fn new(pairs: &[ControlPoints<f64>]) -> Self {
        let mut distances: Vec<f64> = pairs
            .iter()
            .map(|pair| scalar::closest_approach(pair).1)
            .collect();
        distances.sort_by(f64::total_cmp);
        let rank = distances.len() / 50;
        // Between two distances, so that rounding to f32 does not matter.
        let threshold = 0.5 * (distances[rank - 1] + distances[rank]);
        Self {
            threshold,
            each: vec![threshold; pairs.len()],
            each_f32: vec![threshold as f32; pairs.len()],
        }
    }
}

impl Screening {
    const ALL: [Self; 4] = [Self::Yuksel, Self::Scalar, Self::BatchF64, Self::BatchF32];

    fn name(self) -> &'static str {
        match self {
            Self::Yuksel => "yuksel",
            Self::Scalar => "scalar",
            Self::BatchF64 => "batch_f64",
            Self::BatchF32 => "batch_f32",
        }
    }

    /// One run over all pairs.
    fn run(self, pairs: &[ControlPoints<f64>], limits: &Limits, work: &mut Batch) {
        let Limits {
            threshold,
            each,
            each_f32,
        } = limits;
        let (instructions, verdicts) = (InstructionSet::best(), &mut work.verdicts);
        match self {
            Self::Yuksel => {
                for (verdict, pair) in verdicts.iter_mut().zip(pairs) {
                    let near = peers::within_by_roots(pair, *threshold);
                    *verdict = if near {
                        Verdict::Inside
                    } else {
                        Verdict::Outside
                    };
                }
            }
            Self::Scalar => {
                for (verdict, pair) in verdicts.iter_mut().zip(pairs) {
                    *verdict = scalar::within(pair, *threshold, *threshold);
                }
            }
            Self::BatchF64 => within(instructions, &work.cubics.lanes(), each, each, verdicts),
            Self::BatchF32 => within(
                instructions,
                &work.cubics_f32.lanes(),
                each_f32,
                each_f32,
                verdicts,
            ),
        }
        black_box(work);
    }
}

fn within_group(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("within");
    group.throughput(Throughput::Elements(PAIRS as u64));
    let pairs = Workload::Random.pairs(PAIRS, 1);
    let limits = Limits::new(&pairs);
    let mut work = Batch::new(&pairs);
    for screening in Screening::ALL {
        group.bench_function(BenchmarkId::new(screening.name(), "sparse"), |bencher| {
            bencher.iter(|| screening.run(black_box(&pairs), &limits, &mut work));
        });
    }
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
    println!("Instruction set: {}", InstructionSet::best().name());
    if count > 0 {
        accuracy::print_table(count);
    }
    if timing {
        ratios::print_table();
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
