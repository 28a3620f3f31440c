//! A monitor's tick against screening the whole lookahead afresh, 10,000 bodies, 10 s ahead.
//!
//! The bodies of `game_loop`; a share of them gets a new plan from now on each tick, sixty times a
//! second. `advance` is the time from handing the plans over until the events are there, `rescreen`
//! that of one screening of the same lookahead, without replacing a plan.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "a benchmark; what cannot be built ends it"
)]

#[allow(
    dead_code,
    reason = "the example's own module, of which a part is used"
)]
#[path = "../examples/game_loop/fleet.rs"]
mod fleet;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use fleet::{Fleet, LOOKAHEAD, Setting};
use nearmiss::{Query, Window};
use std::hint::black_box;
use std::time::{Duration, Instant};

const BODIES: usize = 10_000;
const STEP: f64 = 1.0 / 60.0;

fn fleet() -> Fleet {
    let mut fleet = Fleet::new(Setting::STRESS, BODIES, 1).unwrap();
    fleet.monitor.advance(0.0, &mut Vec::new()).unwrap();
    fleet
}

fn advance(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("monitor");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(4));
    for (name, share) in [("10k_1pct", 0.01), ("10k_20pct", 0.2), ("10k_100pct", 1.0)] {
        let mut fleet = fleet();
        let mut events = Vec::new();
        group.bench_function(BenchmarkId::new("advance", name), |bencher| {
            bencher.iter_custom(|ticks| {
                let mut total = Duration::ZERO;
                for _ in 0..ticks {
                    let mut plans = fleet.whims(share).unwrap();
                    for id in Fleet::running_out(&events) {
                        if plans.iter().all(|&(planned, _)| planned != id) {
                            plans.extend(fleet.fresh_plan(id).unwrap());
                        }
                    }
                    let commands = fleet.commands(plans);
                    let now = fleet.monitor.now() + STEP;
                    events.clear();
                    let begin = Instant::now();
                    fleet.monitor.apply(commands).unwrap();
                    fleet.monitor.advance(now, &mut events).unwrap();
                    total += begin.elapsed();
                }
                total
            });
        });
    }
    let fleet = fleet();
    let now = fleet.monitor.now();
    let window = Window::new(now, now + LOOKAHEAD).unwrap();
    let query = Query::new(window).with_margin(3.0).unwrap();
    group.bench_function(BenchmarkId::new("rescreen", "10k"), |bencher| {
        bencher.iter(|| black_box(fleet.monitor.scene().screen(&query).unwrap()));
    });
    group.finish();
}

criterion_group!(benches, advance);
criterion_main!(benches);
