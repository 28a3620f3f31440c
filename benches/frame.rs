//! Time of a frame of a game whose physics engine tells position and velocity of all bodies, each frame.
//!
//! Bodies as in the swarm of the other benchmarks: one in 65.6^3 m, up to 17 m/s fast, radius 0.5 m, margin
//! 5 m. A frame is 1/60 s; one body in 20 changes its velocity in it. The lookahead is 2 s. One iteration
//! is one frame; stepping the world is not timed.
//!
//! - `frame/update_screen/N`, one thread: `Scene::update` of all N bodies, then `Scene::screen` of the next 2 s;
//! - `frame/told/N`, one thread (100,000: two): `Monitor::track` of all bodies, then `Monitor::advance`, events
//!   included;
//! - `frame/told_far/10k`, one thread: as `told`, 10 s ahead;
//! - `frame/told_convoy/5k`, one thread: as `told`, with one body in 20^3 m, and all move on together at 316 m/s;
//! - `frame/told_dense/10k`, `frame/update_screen_dense/10k`, one thread: as `told` and `update_screen`, with one body in
//!   10^3 m and a margin of 0 m;
//! - `frame/told_crowd/10k`, `frame/update_screen_crowd/10k`, one thread: the same with one body in 3^3 m;
//! - `frame/told_flat/10k`, `frame/update_screen_flat/10k`, one thread: the same on a plane, with one body in 5^2 m;
//! - `frame/told_islands/10k`, `frame/update_screen_islands/10k`, one thread: as those of `dense`, in ten groups up to 1e9 m
//!   from each other on each axis;
//! - `frame/told_elsewhere/10k`, one thread: as `told_dense`, but only a hundred bodies are told, each another place in each
//!   frame;
//! - `frame/told_in_turns/10k`, one thread: as `told`, in every other frame. The clock moves in each;
//! - `frame/told_seldom/10k`, one thread: as `told`, in every tenth frame, and twenty bodies in each of the others;
//! - `frame/told_in_halves/10k`, one thread: as `told`, one half of the bodies in each frame;
//! - `frame/told_in_steps/10k`, one thread: as `told`, four times a frame, with the states of four steps;
//! - `frame/told_again/10k`, one thread: as `told`, twice for the same instant, with positions 1 mm apart;
//! - `frame/told_ahead/10k`, one thread: as `told`, with states of an instant 50 ms after the frame;
//! - `frame/untold_near/10k`, one thread: a tick with a lookahead of 1/60 s, and nobody is told anything;
//! - `frame/told_resting/10k`, one thread: as `told`, and half of the bodies rest;
//! - `frame/told_and_asked/10k`, one thread: as `told`, and then ten questions by `Monitor::what_if`;
//! - `frame/told_walls/10k`, one thread: as `told`, within six half-spaces, and with a second alert level of 0 m;
//! - `frame/told_walls_half/10k`, one thread: the same with a budget for each tick: half of what the median of 41 ticks
//!   took before. The table says how much of the 2 s is known;
//! - `frame/rapier/10k`, one thread: kinematic bodies with balls of 0.5 m as sensors in rapier's collision pipeline. It finds
//!   those that overlap now, and looks at nothing ahead;
//! - `frame/shots/5k`, `frame/shots_without_layers/5k`, one thread: as `told`, of 98 ships in 80^3 m each, with 50 shots
//!   each at 300 m/s, and a margin of 0 m. Shots ignore each other, or may meet;
//! - `closest_approach/polycool/random`: solves of the benchmark `kernels`, the unit of the ratios.
//!
//! After the run a table is printed: times in solves, which are measured after each sample, for the frames'
//! mean (as criterion's) and for their median, which holds on a busier machine; then the candidates, and the
//! conflicts, events or overlaps of a frame.

#[allow(dead_code, reason = "the benchmark `kernels` uses more of it")]
#[path = "kernels/peers.rs"]
mod peers;
#[path = "../examples/scenes/mod.rs"]
mod scenes;
#[allow(dead_code, reason = "the benchmark `kernels` uses more of it")]
#[path = "kernels/workloads.rs"]
mod workloads;

#[path = "frame/games.rs"]
mod games;
#[path = "frame/overlaps.rs"]
mod overlaps;
#[path = "frame/ratios.rs"]
mod ratios;
#[path = "../examples/tradeoff/stepped/sensors.rs"]
mod sensors;
#[path = "frame/shots.rs"]
mod shots;
#[path = "frame/world.rs"]
mod world;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use games::{Game, Told, UpdateScreen};
use ratios::{PAIRS, Solve, Table, Turn};
use std::time::Duration;

/// Samples of a benchmark, and turns of its ratio.
const SAMPLES: usize = 20;

/// The run: what measures, and the table of what was measured.
struct Run {
    criterion: Criterion,
    solve: Solve,
    table: Table,
}

impl Run {
    /// Measures frames of a game on so many threads; entering their pool is not timed.
    fn measure<G: Game + Send>(
        &mut self,
        (what, bodies): (&str, u32),
        threads: usize,
        make: fn(u32) -> G,
    ) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.unwrap_or_else(|error| panic!("{threads} threads: {error}"));
        let name = format!("{}k", bodies / 1_000);
        let (mut game, mut turns, mut frames, mut sums) = (None, Vec::new(), 0, [(0, ""); 2]);
        let mut measured = self.criterion.benchmark_group("frame");
        measured
            .sample_size(SAMPLES)
            .sampling_mode(SamplingMode::Flat)
            .warm_up_time(Duration::from_secs(1))
            .measurement_time(Duration::from_secs(5))
            .throughput(Throughput::Elements(u64::from(bodies)));
        measured.bench_function(BenchmarkId::new(what, &name), |bencher| {
            bencher.iter_custom(|rounds| {
                pool.install(|| {
                    let game = game.get_or_insert_with(|| make(bodies));
                    let mut times = Vec::new();
                    for _ in 0..rounds {
                        times.push(game.frame());
                        for (sum, count) in sums.iter_mut().zip(game.counts()) {
                            *sum = (sum.0 + count.0, count.1);
                        }
                    }
                    frames += rounds;
                    turns.push(Turn::new(&times, &self.solve));
                    times.iter().sum()
                })
            });
        });
        measured.finish();
        // The first ones are criterion's warm-up; none is there if the benchmark was filtered out.
        let last = &turns[turns.len().saturating_sub(SAMPLES)..];
        if !last.is_empty() {
            self.table
                .add(&format!("{what}/{name}"), last, frames, &sums);
        }
    }

    fn measure_solves(&mut self) {
        let mut group = self.criterion.benchmark_group("closest_approach");
        group.throughput(Throughput::Elements(PAIRS as u64));
        let id = BenchmarkId::new("polycool", "random");
        group.bench_function(id, |bencher| bencher.iter(|| self.solve.run()));
        group.finish();
    }
}

fn main() {
    let mut run = Run {
        criterion: Criterion::default().configure_from_args(),
        solve: Solve::default(),
        table: Table::default(),
    };
    run.measure_solves();
    for bodies in [10_000, 100_000] {
        run.measure(("update_screen", bodies), 1, UpdateScreen::new);
    }
    for (bodies, threads) in [(1_000, 1), (10_000, 1), (100_000, 2)] {
        run.measure(("told", bodies), threads, Told::new);
    }
    run.measure(("told_far", 10_000), 1, Told::far_ahead);
    run.measure(("told_convoy", 5_000), 1, Told::convoy);
    run.measure(("told_dense", 10_000), 1, Told::dense);
    run.measure(("update_screen_dense", 10_000), 1, UpdateScreen::dense);
    run.measure(("told_crowd", 10_000), 1, Told::crowd);
    run.measure(("update_screen_crowd", 10_000), 1, UpdateScreen::crowd);
    run.measure(("told_flat", 10_000), 1, Told::flat);
    run.measure(("update_screen_flat", 10_000), 1, UpdateScreen::flat);
    run.measure(("told_islands", 10_000), 1, Told::islands);
    run.measure(("update_screen_islands", 10_000), 1, UpdateScreen::islands);
    run.measure(("told_elsewhere", 10_000), 1, Told::elsewhere);
    run.measure(("told_in_turns", 10_000), 1, Told::in_turns);
    run.measure(("told_seldom", 10_000), 1, Told::seldom);
    run.measure(("told_in_halves", 10_000), 1, Told::in_halves);
    run.measure(("told_in_steps", 10_000), 1, Told::in_steps);
    run.measure(("told_again", 10_000), 1, Told::again);
    run.measure(("told_ahead", 10_000), 1, Told::ahead);
    run.measure(("untold_near", 10_000), 1, Told::near);
    run.measure(("told_resting", 10_000), 1, Told::half_at_rest);
    run.measure(("told_and_asked", 10_000), 1, Told::with_questions);
    run.measure(("told_walls", 10_000), 1, Told::within_walls);
    run.measure(("told_walls_half", 10_000), 1, Told::with_half_the_time);
    run.measure(("rapier", 10_000), 1, overlaps::Overlaps::new);
    run.measure(("shots", 5_000), 1, Told::shots);
    run.measure(
        ("shots_without_layers", 5_000),
        1,
        Told::shots_without_layers,
    );
    run.criterion.final_summary();
    // A smoke test passes `--test`: its times say nothing.
    let arguments: Vec<String> = std::env::args().collect();
    let has = |wanted: &str| arguments.iter().any(|argument| argument == wanted);
    if has("--bench") && !has("--test") {
        println!("{}", run.table);
    }
}
