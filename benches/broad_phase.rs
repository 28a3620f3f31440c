//! Time of the broad phase methods on boxes of all shapes: a slice of one shape per measurement.
//!
//! `elem/s` counts boxes: its inverse is the time per box.

#[path = "../tests/broad_phase/boxes.rs"]
mod boxes;

use std::hint::black_box;
use std::time::Duration;

use boxes::Shape;
use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use nearmiss::internals::broad_phase::{
    BodyBox, BroadPhase, BruteForce, Everyone, InstructionSet, Sweep, Tree,
};

/// Boxes of the reference swarm are half as long as the mean spacing.
const NUMBERS: [(&str, usize); 4] = [
    ("100", 100),
    ("1k", 1_000),
    ("10k", 10_000),
    ("100k", 100_000),
];
const UGLY: [&str; 9] = [
    "clusters",
    "many_clusters",
    "flat",
    "fast_few",
    "largest_few",
    "all_sizes",
    "nested",
    "rods",
    "touching",
];

/// Runs one method over several slices of boxes in turn, so that no branch is learnt by heart.
fn measure<B: BroadPhase>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: BenchmarkId,
    mut method: B,
    slices: &[Vec<BodyBox>],
) {
    let boxes: usize = slices.iter().map(Vec::len).sum();
    group.throughput(Throughput::Elements(boxes as u64));
    let mut candidates = Vec::new();
    group.bench_function(id, |bencher| {
        bencher.iter(|| {
            for boxes in slices {
                candidates.clear();
                method.pairs(black_box(boxes), &Everyone, &mut candidates);
                black_box(&candidates);
            }
        });
    });
}

fn slices(name: &str, count: usize) -> Vec<Vec<BodyBox>> {
    let shape = Shape::named(name);
    let slices = (40_000 / count).clamp(1, 8);
    (0..8)
        .take(slices)
        .map(|seed| shape.boxes(count, seed))
        .collect()
}

fn broad_phase(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("broad_phase");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for (name, count) in NUMBERS {
        let slices = slices("swarm", count);
        let id = |method: &str| BenchmarkId::new(method, format!("swarm_{name}"));
        measure(&mut group, id("sweep"), Sweep::default(), &slices);
        measure(&mut group, id("tree"), Tree::default(), &slices);
        if count <= 10_000 {
            measure(&mut group, id("brute_force"), BruteForce, &slices);
        }
    }
    for name in UGLY {
        let slices = slices(name, 10_000);
        let id = |method: &str| BenchmarkId::new(method, name);
        measure(&mut group, id("sweep"), Sweep::default(), &slices);
        measure(&mut group, id("tree"), Tree::default(), &slices);
    }
    for name in ["one_place", "identical", "all_scales"] {
        let slices = slices(name, 1_000);
        let id = |method: &str| BenchmarkId::new(method, format!("{name}_1k"));
        measure(&mut group, id("sweep"), Sweep::default(), &slices);
        measure(&mut group, id("tree"), Tree::default(), &slices);
        measure(&mut group, id("brute_force"), BruteForce, &slices);
    }
    group.finish();
}

fn levels(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("broad_phase_levels");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for name in ["swarm", "fast_few", "many_clusters"] {
        let slices = slices(name, 10_000);
        for instructions in InstructionSet::available() {
            let id = BenchmarkId::new(instructions.name(), name);
            measure(
                &mut group,
                id,
                Sweep::with_instruction_set(instructions),
                &slices,
            );
        }
    }
    group.finish();
}

criterion_group!(benches, broad_phase, levels);
criterion_main!(benches);
