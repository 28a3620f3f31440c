//! A monitor's tick against screening the whole lookahead afresh, 10,000 bodies, 10 s ahead.
//!
//! The bodies of `game_loop`; a share of them gets a new plan from now on each tick, sixty times a
//! second. `advance` is the time from handing the plans over until the events are there (two
//! levels), `rescreen/10k` that of screening a scene that has the plans (one level, the wider one).
//! For a fair comparison at high shares, `replan_and_rescreen` adds the time in which a scene takes
//! the plans over: then both end with the plans in place and the old ones dropped. Making the plans
//! is not timed.
//!
//! `floor_10k` is `advance` at 1 % with a floor below: `untold`, told each tick that it is `resting` or `rising`,
//! or with `none`.

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
#[allow(dead_code, reason = "as above")]
#[path = "../examples/game_loop/floor.rs"]
mod floor;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use fleet::{Fleet, LOOKAHEAD, Setting};
use nearmiss::glam::DVec3;
use nearmiss::{BodyId, Command, Event, Query, Scene, State, Trajectory, Window};
use std::hint::black_box;
use std::time::{Duration, Instant};

const BODIES: usize = 10_000;
const STEP: f64 = 1.0 / 60.0;

/// A fleet whose lookahead is known.
fn fleet() -> Fleet {
    let mut fleet = Fleet::new(Setting::STRESS, BODIES, 1).unwrap();
    fleet.monitor.advance(0.0, &mut Vec::new()).unwrap();
    fleet
}

/// Replans a share of the fleet in each of some ticks; adds up what `take` says of the time that it
/// took. It is given the plans, and the time that the clock comes to.
fn run(
    fleet: &mut Fleet,
    (share, ticks): (f64, u64),
    mut take: impl FnMut(&mut Fleet, Vec<Command>, f64) -> Duration,
) -> Duration {
    let mut total = Duration::ZERO;
    for _ in 0..ticks {
        let plans = fleet.whims(share).unwrap();
        let commands = fleet.commands(plans);
        let now = fleet.monitor.now() + STEP;
        total += take(fleet, commands, now);
    }
    total
}

/// A tick of the fleet's own monitor.
fn advance(
    fleet: &mut Fleet,
    commands: Vec<Command>,
    now: f64,
    events: &mut Vec<Event>,
) -> Duration {
    events.clear();
    let begin = Instant::now();
    fleet.monitor.apply(commands).unwrap();
    fleet.monitor.advance(now, events).unwrap();
    begin.elapsed()
}

/// Measures the time in which a scene that follows the fleet takes the plans over, and then is
/// screened.
fn rescreen(
    fleet: &mut Fleet,
    commands: Vec<Command>,
    now: f64,
    scene: &mut Scene,
) -> [Duration; 2] {
    let plan_of = |command: &Command| match command {
        Command::Replan(id, _, plan) => Some((*id, plan.trajectory.clone())),
        _ => None,
    };
    let plans: Vec<(BodyId, Trajectory)> = commands.iter().filter_map(plan_of).collect();
    advance(fleet, commands, now, &mut Vec::new());
    let window = Window::new(now, now + LOOKAHEAD).unwrap();
    let query = Query::new(window).with_margin(3.0);
    // Whoever has no monitor has the scene in the caches, not the monitor.
    black_box(scene.screen(&query).unwrap());
    let begin = Instant::now();
    for (id, plan) in plans {
        scene.set_trajectory(id, plan).unwrap();
    }
    let planned = Instant::now();
    black_box(scene.screen(&query).unwrap());
    [planned - begin, planned.elapsed()]
}

/// A floor below all but a few bodies, and how it is told each tick.
#[derive(Clone, Copy)]
enum Ground {
    /// Not at all.
    Untold,
    /// That it rests where it is.
    Resting,
    /// That it rises, slowly.
    Rising,
}

/// Ticks of bodies above a floor, of which few get a new plan.
fn floors(criterion: &mut Criterion) {
    /// Depth of the floor below the cube that the bodies keep to, m.
    const BELOW: f64 = 150.0;
    let mut group = criterion.benchmark_group("monitor");
    group
        .sample_size(20)
        .measurement_time(Duration::from_secs(4));
    for (name, ground) in [
        ("none", None),
        ("untold", Some(Ground::Untold)),
        ("resting", Some(Ground::Resting)),
        ("rising", Some(Ground::Rising)),
    ] {
        let mut own = fleet();
        let height = -own.half() - BELOW;
        let floor = own.monitor.insert(floor::Floor::body(height).unwrap());
        let floor = floor.unwrap();
        if ground.is_none() {
            own.monitor.remove(floor).unwrap();
        }
        let mut events = Vec::new();
        group.bench_function(BenchmarkId::new("floor_10k", name), |bencher| {
            bencher.iter_custom(|ticks| {
                run(&mut own, (0.01, ticks), |fleet, commands, now| {
                    events.clear();
                    let speed = match ground {
                        None | Some(Ground::Untold) => None,
                        Some(Ground::Resting) => Some(0.0),
                        Some(Ground::Rising) => Some(1e-3),
                    };
                    let before = fleet.monitor.now();
                    let told = speed.map(|speed| {
                        let place = (height + speed * before) * DVec3::Y;
                        (floor, State::new(before, place, speed * DVec3::Y))
                    });
                    let begin = Instant::now();
                    fleet.monitor.apply(commands).unwrap();
                    fleet.monitor.track(before, told).unwrap();
                    fleet.monitor.advance(now, &mut events).unwrap();
                    begin.elapsed()
                })
            });
        });
    }
    group.finish();
}

fn ticks(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("monitor");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(4));
    for (name, share) in [("10k_1pct", 0.01), ("10k_20pct", 0.2), ("10k_100pct", 1.0)] {
        let (mut own, mut events) = (fleet(), Vec::new());
        group.bench_function(BenchmarkId::new("advance", name), |bencher| {
            bencher.iter_custom(|ticks| {
                run(&mut own, (share, ticks), |fleet, commands, now| {
                    advance(fleet, commands, now, &mut events)
                })
            });
        });
        let mut followed = fleet();
        let mut scene = followed.monitor.scene().clone();
        group.bench_function(BenchmarkId::new("replan_and_rescreen", name), |bencher| {
            bencher.iter_custom(|ticks| {
                run(&mut followed, (share, ticks), |fleet, commands, now| {
                    rescreen(fleet, commands, now, &mut scene).iter().sum()
                })
            });
        });
    }
    let mut followed = fleet();
    let mut scene = followed.monitor.scene().clone();
    group.bench_function(BenchmarkId::new("rescreen", "10k"), |bencher| {
        bencher.iter_custom(|ticks| {
            run(&mut followed, (0.01, ticks), |fleet, commands, now| {
                rescreen(fleet, commands, now, &mut scene)[1]
            })
        });
    });
    group.finish();
}

criterion_group!(benches, ticks, floors);
criterion_main!(benches);
