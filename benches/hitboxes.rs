//! Time of clusters of spheres, turning and not.
//!
//! - `pair/spheres1`, `pair/fixed16`, `pair/turning16`: the closest approach of one pair, in turn from a list
//!   of 1,024. Each body is one sphere, or 16 spheres within about 1.3 m; of `turning16` both turn once in the
//!   window, about any axis. Each body follows one cubic. The bounding spheres overlap 40 % of the time.
//! - `scene/swarm_10k_fixed8`, `scene/swarm_10k_turning8`: a screening of the swarm of the other benchmarks, on
//!   one thread, with 8 spheres within 2 m around each body; each body turns once in 12 s.
//! - `scene/swarm_10k_fixed_beams`, `scene/swarm_10k_turning_beams`: the same with 8 spheres in a row, from the body's
//!   position 30 m out.
//! - `scene/swarm_10k_100balls`, `scene/swarm_10k_100turning`: points, and 100 more bodies: balls of 2 m, or
//!   turning clusters of that reach.
//! - `scene/swarm_10k`, `scene/swarm_10k_floor`: points, and a floor below all but a few of them.
//! - `monitor/1k_balls`, `monitor/1k_turning8`: a frame of a monitor of 1,000 bodies that is told of all of them:
//!   balls of 2 m, or 8 spheres of that reach, which turn once in 12 s and are told with their spin. The world is
//!   that of the benchmark `frame`; stepping it is not timed.
//! - `dense_clusters/screening`, `dense_clusters/monitor`: two bodies of 2,000 spheres each, which stay near each
//!   other for 200 segments: a screening of all that time on one thread, and a monitor with that time as
//!   lookahead, from its first tick.
//! - `closest_approach/polycool/random`: solves of the benchmark `kernels`, the unit of the ratios.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "a benchmark; what cannot be built ends it"
)]

#[allow(dead_code, reason = "the benchmark `kernels` uses more of it")]
#[path = "kernels/peers.rs"]
mod peers;
#[path = "../examples/scenes/mod.rs"]
mod scenes;
#[path = "hitboxes/tracked.rs"]
mod tracked;
#[allow(dead_code, reason = "the benchmark `kernels` uses more of it")]
#[path = "kernels/workloads.rs"]
mod workloads;
#[path = "frame/world.rs"]
mod world;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyId, Hitbox, Monitor, Orientation, Query, Scene, Sphere, State,
    Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use scenes::{Shape, generator, normal_vector, swarm};
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Duration;
use tracked::{Tracked, Turn};
use workloads::Workload;

const PAIRS: usize = 1_024;
/// Solves of the unit, and their tolerance in local time.
const SOLVES: usize = 4_096;
const TOLERANCE: f64 = 6e-7;
/// The swarm's window, s.
const DURATION: f64 = 60.0;

fn direction(rng: &mut ChaCha8Rng) -> DVec3 {
    normal_vector(rng, 1.0).normalize()
}

/// Returns `count` spheres whose surfaces are within `reach` (m), some of them at it.
fn cluster(rng: &mut ChaCha8Rng, count: usize, reach: f64) -> Hitbox {
    if count == 1 {
        return Hitbox::sphere(reach).unwrap();
    }
    let sphere = |_| {
        let radius = reach * rng.random_range(0.15..0.35);
        let away = (reach - radius) * rng.random_range(0.4..1.0);
        Sphere {
            offset: direction(rng) * away,
            radius,
        }
    };
    Hitbox::cluster((0..count).map(sphere).collect()).unwrap()
}

/// Returns 8 spheres in a row, from the position 30 m out.
fn beam() -> Hitbox {
    let spheres = (0..8).map(|number| Sphere {
        offset: (2.0 + 4.0 * f64::from(number)) * DVec3::X,
        radius: 1.0,
    });
    Hitbox::cluster(spheres.collect()).unwrap()
}

/// Returns an orientation that turns once in a time (s).
fn turn(rng: &mut ChaCha8Rng, duration: f64) -> Orientation {
    let rotation = DQuat::from_scaled_axis(direction(rng) * rng.random_range(0.0..3.0));
    Orientation::spin(0.0, rotation, direction(rng) * (TAU / duration)).unwrap()
}

/// Two bodies that pass each other in one second.
struct Pairs {
    scene: Scene,
    ids: Vec<[BodyId; 2]>,
}

impl Pairs {
    fn new(spheres: usize, turns: bool) -> Self {
        /// Largest distance of a surface, m, and the share of the time in which the spheres around the
        /// bodies overlap.
        const REACH: f64 = 1.3;
        const SHARE: f64 = 0.4;
        let mut rng = generator(1);
        let rng = &mut rng;
        let mut scene = Scene::new();
        let mut body = |rng: &mut ChaCha8Rng, states: &[State]| {
            let plan = Trajectory::from_states(states).unwrap();
            let body = Body::new(plan).with_hitbox(cluster(rng, spheres, REACH));
            let turn = turn(rng, 1.0);
            let body = if turns {
                body.with_orientation(turn)
            } else {
                body
            };
            scene.insert(body).unwrap()
        };
        let ids = (0..PAIRS)
            .map(|_| {
                // They pass at a distance at which most touch, and some do not.
                let way = direction(rng);
                let aside = way.cross(direction(rng)).normalize();
                let miss = REACH * rng.random_range(0.6..1.9);
                let chord = 2.0 * (4.0 * REACH * REACH - miss * miss).sqrt();
                let (place, velocity) = (
                    aside * miss - way * (0.5 * chord / SHARE),
                    way * (chord / SHARE),
                );
                let common = normal_vector(rng, 2.0);
                let bend = normal_vector(rng, 0.5);
                let state = |time: f64, place: DVec3, velocity: DVec3| {
                    State::new(time, place + common * time, velocity + common)
                };
                let end = place + velocity;
                let first = [
                    state(0.0, place, velocity + bend),
                    state(1.0, end, velocity - bend),
                ];
                let still = DVec3::ZERO;
                let second = [state(0.0, still, bend), state(1.0, still, -bend)];
                [body(rng, &first), body(rng, &second)]
            })
            .collect();
        Self { scene, ids }
    }
}

fn pairs(c: &mut Criterion) {
    let mut group = c.benchmark_group("hitboxes");
    let window = Window::new(0.0, 1.0).unwrap();
    for (name, spheres, turns) in [
        ("spheres1", 1, false),
        ("fixed16", 16, false),
        ("turning16", 16, true),
    ] {
        let pairs = Pairs::new(spheres, turns);
        let mut next = pairs.ids.iter().cycle();
        group.bench_function(BenchmarkId::new("pair", name), |bencher| {
            bencher.iter(|| {
                let [a, b] = *next.next().unwrap();
                pairs.scene.closest_approach(a, b, black_box(window))
            });
        });
    }
    group.finish();
    let pairs = Workload::Random.pairs(SOLVES, 1);
    let mut group = c.benchmark_group("closest_approach");
    group.throughput(Throughput::Elements(SOLVES as u64));
    group.bench_function(BenchmarkId::new("polycool", "random"), |bencher| {
        bencher.iter(|| {
            for pair in black_box(&pairs) {
                black_box(peers::polycool(pair, TOLERANCE));
            }
        });
    });
    group.finish();
}

/// The kinds of bodies in a swarm.
#[derive(Clone, Copy)]
enum Kind {
    Point,
    Ball,
    Cluster,
    Turning,
    Beam,
    TurningBeam,
    /// A floor at rest, which some of the swarm sink into.
    Floor,
}

/// Returns a height (m) below which one in a thousand of the swarm's states lies.
fn ground(states: impl Iterator<Item = State>) -> f64 {
    let mut heights: Vec<f64> = states.map(|state| state.position.z).collect();
    heights.sort_unstable_by(f64::total_cmp);
    heights[heights.len() / 1_000]
}

/// Returns the swarm with bodies of a kind, and some more.
fn scene_of(all: Kind, more: Option<(usize, Kind)>) -> (Scene, Query) {
    const REACH: f64 = 2.0;
    /// s.
    const REVOLUTION: f64 = 12.0;
    let (generated, others) = (swarm(10_000, Shape::Cube, 1), swarm(10_000, Shape::Cube, 2));
    let mut rng = generator(3);
    let states = generated.actors.iter().flat_map(|actor| &actor.states);
    let ground = ground(states.copied());
    let mut scene = Scene::new();
    let mut insert = |states: &[State], kind: Kind| {
        let body = Body::new(Trajectory::from_states(states).unwrap());
        let body = match kind {
            Kind::Floor => Body::new(Trajectory::at_rest(ground * DVec3::Z).unwrap())
                .with_hitbox(Hitbox::half_space(DVec3::Z).unwrap()),
            Kind::Point => body,
            Kind::Ball => body.with_hitbox(Hitbox::sphere(REACH).unwrap()),
            Kind::Cluster => body.with_hitbox(cluster(&mut rng, 8, REACH)),
            Kind::Beam => body.with_hitbox(beam()),
            Kind::TurningBeam => body
                .with_hitbox(beam())
                .with_orientation(turn(&mut rng, REVOLUTION)),
            Kind::Turning => body
                .with_hitbox(cluster(&mut rng, 8, REACH))
                .with_orientation(turn(&mut rng, REVOLUTION)),
        };
        scene.insert(body).unwrap();
    };
    for actor in &generated.actors {
        insert(&actor.states, all);
    }
    let (count, kind) = more.unwrap_or((0, all));
    for actor in others.actors.iter().take(count) {
        insert(&actor.states, kind);
    }
    let window = Window::new(0.0, DURATION).unwrap();
    (scene, Query::new(window).with_margin(generated.margin))
}

/// Returns a pool of one thread.
fn one_thread() -> rayon::ThreadPool {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build().unwrap()
}

/// Returns two balls of small spheres whose surfaces stay close, over so many seconds.
fn dense(duration: u32) -> Scene {
    const SPHERES: usize = 2_000;
    let mut rng = generator(5);
    let rng = &mut rng;
    let mut scene = Scene::new();
    for place in [DVec3::ZERO, 2.0 * DVec3::X] {
        let states = (0..=duration).map(|time| {
            let place = place + normal_vector(rng, 0.1);
            State::new(f64::from(time), place, normal_vector(rng, 0.2))
        });
        let plan = Trajectory::from_states(&states.collect::<Vec<State>>()).unwrap();
        let spheres = (0..SPHERES).map(|_| Sphere {
            offset: direction(rng) * rng.random_range(0.3..1.0),
            radius: rng.random_range(0.02..0.1),
        });
        let hitbox = Hitbox::cluster(spheres.collect()).unwrap();
        scene.insert(Body::new(plan).with_hitbox(hitbox)).unwrap();
    }
    scene
}

fn dense_clusters(c: &mut Criterion) {
    const SEGMENTS: u32 = 200;
    const MARGIN: f64 = 0.3;
    let (pool, scene) = (one_thread(), dense(SEGMENTS));
    let end = f64::from(SEGMENTS);
    let query = Query::new(Window::new(0.0, end).unwrap()).with_margin(MARGIN);
    let mut group = c.benchmark_group("hitboxes");
    group.sample_size(10);
    group.bench_function(BenchmarkId::new("dense_clusters", "screening"), |bencher| {
        pool.install(|| bencher.iter(|| scene.screen(&query).unwrap()));
    });
    group.bench_function(BenchmarkId::new("dense_clusters", "monitor"), |bencher| {
        let watch = |scene: Scene| {
            let mut events = Vec::new();
            let mut monitor = Monitor::new(scene, 0.0, end, &[AlertLevel::at(MARGIN)]).unwrap();
            monitor.advance(0.0, &mut events).unwrap();
            (monitor, events)
        };
        pool.install(|| bencher.iter_batched(|| scene.clone(), watch, BatchSize::PerIteration));
    });
    group.finish();
}

fn scenes(c: &mut Criterion) {
    let pool = one_thread();
    let mut group = c.benchmark_group("hitboxes");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_secs(1))
        .measurement_time(Duration::from_secs(5));
    for (name, all, more) in [
        ("swarm_10k", Kind::Point, None),
        ("swarm_10k_floor", Kind::Point, Some((1, Kind::Floor))),
        ("swarm_10k_fixed8", Kind::Cluster, None),
        ("swarm_10k_turning8", Kind::Turning, None),
        ("swarm_10k_fixed_beams", Kind::Beam, None),
        ("swarm_10k_turning_beams", Kind::TurningBeam, None),
        ("swarm_10k_100balls", Kind::Point, Some((100, Kind::Ball))),
        (
            "swarm_10k_100turning",
            Kind::Point,
            Some((100, Kind::Turning)),
        ),
    ] {
        let mut made = None;
        group.bench_function(BenchmarkId::new("scene", name), |bencher| {
            let (scene, query) = made.get_or_insert_with(|| scene_of(all, more));
            pool.install(|| bencher.iter(|| scene.screen(query).unwrap()));
        });
    }
    group.finish();
}

fn monitors(c: &mut Criterion) {
    const BODIES: u32 = 1_000;
    const REACH: f64 = 2.0;
    /// s.
    const REVOLUTION: f64 = 12.0;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let mut group = c.benchmark_group("hitboxes");
    for (name, turns) in [("1k_balls", false), ("1k_turning8", true)] {
        let mut made = None;
        group.bench_function(BenchmarkId::new("monitor", name), |bencher| {
            let tracked = made.get_or_insert_with(|| {
                let mut rng = generator(4);
                let turning = |rng: &mut ChaCha8Rng| Turn {
                    rotation: DQuat::from_scaled_axis(direction(rng) * rng.random_range(0.0..3.0)),
                    angular_velocity: direction(rng) * (TAU / REVOLUTION),
                };
                Tracked::new(BODIES, || {
                    if turns {
                        (cluster(&mut rng, 8, REACH), Some(turning(&mut rng)))
                    } else {
                        (Hitbox::sphere(REACH).unwrap(), None)
                    }
                })
            });
            pool.install(|| {
                bencher.iter_custom(|frames| (0..frames).map(|_| tracked.frame()).sum());
            });
        });
    }
    group.finish();
}

criterion_group!(benches, pairs, scenes, dense_clusters, monitors);
criterion_main!(benches);
