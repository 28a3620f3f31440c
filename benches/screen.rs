//! Time of a whole screening, from trajectories to conflicts, on one thread: `screen/METHOD/SCENE`;
//! and of `swarm_10k` where each body is a cube covered by so many spheres: `spheres/ACCURACY/COUNT`,
//! and `spheres/turning/COUNT` if it turns.
//!
//! `elem/s` counts bodies. With `NEARMISS_DATA`, a folder of recordings, in the environment, those are
//! screened as well, by the default method. With `NEARMISS_SLICE_LENGTHS=1` in the environment it first prints how
//! far the automatic slice length is from the best fixed one.

#[path = "screen/lengths.rs"]
mod lengths;
#[allow(
    dead_code,
    reason = "the example's own module, of which a part is used"
)]
#[path = "../examples/screen/read/mod.rs"]
mod read;
#[path = "../examples/scenes/mod.rs"]
mod scenes;
/// As much of it as reading needs.
#[path = "../examples/terminal/escape.rs"]
mod terminal;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group,
};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Accuracy, Body, BodyId, Hitbox, Orientation, Query, Scene, Sphere, Trajectory};
use rayon::ThreadPool;
use scenes::{Generated, Shape, satellites, swarm};

/// Names, and how to make them. `swarm_N`: N bodies at constant density; the three that follow
/// have the bodies of `swarm_10k` in another shape.
const SCENES: [(&str, Generate); 7] = [
    ("swarm_1k", || swarm(1_000, Shape::Cube, SEED)),
    ("swarm_10k", || swarm(10_000, Shape::Cube, SEED)),
    ("swarm_40k", || swarm(40_000, Shape::Cube, SEED)),
    ("clusters", || swarm(10_000, Shape::Clusters, SEED)),
    ("flat", || swarm(10_000, Shape::Flat, SEED)),
    ("fast_few", || swarm(10_000, Shape::FastFew, SEED)),
    ("satellites", || satellites(10_000, SEED)),
];
const SEED: u64 = 1;

type Generate = fn() -> Generated;

/// Recordings by name, and the distance that is asked about, m.
const RECORDINGS: [(&str, f64); 4] = [
    ("sat-large-a", 5_000.0),
    ("crowd-a", 0.4),
    ("aircraft-a", 1_852.0),
    ("game-a", 1.5),
];

/// Scenes in which every pair of boxes is compared in bearable time.
const SMALL: usize = 1_000;

fn build(generated: &Generated) -> (Scene, Query) {
    let mut scene = Scene::new();
    for actor in &generated.actors {
        let body = Trajectory::from_states(&actor.states)
            .and_then(|plan| Ok(Body::new(plan).with_hitbox(Hitbox::sphere(actor.radius)?)));
        let inserted = body.and_then(|body| scene.insert(body));
        inserted.unwrap_or_else(|error| panic!("a generated body is refused: {error}"));
    }
    let query = Query::default().with_margin(generated.margin);
    (scene, query)
}

/// The recordings of the folder in `NEARMISS_DATA`, if that is set; each must be there.
fn recordings() -> impl Iterator<Item = (&'static str, Scene, Query)> {
    let folder = std::env::var_os("NEARMISS_DATA").map(PathBuf::from);
    folder.into_iter().flat_map(|folder| {
        RECORDINGS.map(|(name, margin)| {
            let file = read::bodies(&folder.join(format!("{name}.csv.gz")));
            let mut scene = Scene::new();
            for body in file.unwrap_or_else(|error| panic!("{error}")).bodies {
                let inserted = scene.insert(Body::new(body.trajectory).with_tag(body.tag));
                inserted.unwrap_or_else(|error| panic!("{name}: {error}"));
            }
            let query = Query::default().with_margin(margin);
            (name, scene, query)
        })
    })
}

/// Screens on the pool; entering it is not timed.
fn measure(
    group: &mut BenchmarkGroup<'_, WallTime>,
    id: BenchmarkId,
    pool: &ThreadPool,
    scene: &Scene,
    query: &Query,
) {
    group.throughput(Throughput::Elements(scene.len() as u64));
    group.bench_function(id, |bencher| {
        bencher.iter_custom(|rounds| {
            pool.install(|| {
                let begin = Instant::now();
                for _ in 0..rounds {
                    let _ = black_box(scene.screen(black_box(query)));
                }
                begin.elapsed()
            })
        });
    });
}

fn one_thread() -> ThreadPool {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.unwrap_or_else(|error| panic!("one thread: {error}"))
}

fn group<'c>(criterion: &'c mut Criterion, name: &str) -> BenchmarkGroup<'c, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .sampling_mode(SamplingMode::Flat)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    group
}

fn screen(criterion: &mut Criterion) {
    let pool = one_thread();
    let mut group = group(criterion, "screen");
    for (name, generate) in SCENES {
        let (scene, query) = build(&generate());
        for (method, title) in [
            (Method::Sweep, "sweep"),
            (Method::Tree, "bvh"),
            (Method::BruteForce, "brute_force"),
        ] {
            if method == Method::BruteForce && scene.len() > SMALL {
                continue;
            }
            let (query, id) = (query.with_method(method), BenchmarkId::new(title, name));
            measure(&mut group, id, &pool, &scene, &query);
        }
    }
    for (name, scene, query) in recordings() {
        let id = BenchmarkId::new("sweep", name);
        measure(&mut group, id, &pool, &scene, &query);
    }
    group.finish();
}

/// A cube of 4 m, covered by as many spheres along each side.
fn cube(along: u32) -> Hitbox {
    let side = 4.0 / f64::from(along);
    let numbers = 0..along.pow(3);
    let spheres = numbers.map(|number| {
        let cell = [number, number / along, number / along.pow(2)];
        let place = cell.map(|cell| (f64::from(cell % along) + 0.5) * side - 2.0);
        Sphere {
            offset: DVec3::from_array(place),
            radius: side * 0.75_f64.sqrt(),
        }
    });
    let hitbox = Hitbox::cluster(spheres.collect());
    hitbox.unwrap_or_else(|error| panic!("a cube is refused: {error}"))
}

/// Returns a rotation by one revolution in 12 s, about an axis of the body's own.
fn turning(id: BodyId) -> Orientation {
    let number = f64::from(id.slot());
    let axis = DVec3::new(number.cos(), number.sin(), (0.7 * number).cos());
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, axis.normalize() * (TAU / 12.0));
    spin.unwrap_or_else(|error| panic!("a spin is refused: {error}"))
}

fn spheres(criterion: &mut Criterion) {
    let pool = one_thread();
    let mut group = group(criterion, "spheres");
    let (mut scene, query) = build(&swarm(10_000, Shape::Cube, SEED));
    let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
    for along in 1..=5 {
        for &id in &ids {
            let replaced = scene.set_hitbox(id, cube(along));
            replaced.unwrap_or_else(|error| panic!("{error}"));
        }
        let query = query.with_margin(0.0);
        for (accuracy, turns, title) in [
            (Accuracy::Exact, false, "exact"),
            (Accuracy::Certified, false, "certified"),
            (Accuracy::Exact, true, "turning"),
        ] {
            for &id in &ids {
                let orientation = if turns {
                    turning(id)
                } else {
                    Orientation::FIXED
                };
                let replaced = scene.set_orientation(id, orientation);
                replaced.unwrap_or_else(|error| panic!("{error}"));
            }
            let (query, id) = (
                query.with_accuracy(accuracy),
                BenchmarkId::new(title, along.pow(3)),
            );
            measure(&mut group, id, &pool, &scene, &query);
        }
    }
    group.finish();
}

fn print_lengths() {
    for (name, generate) in SCENES {
        let (scene, query) = build(&generate());
        one_thread().install(|| lengths::print_line(name, &scene, &query));
    }
    for (name, scene, query) in recordings() {
        one_thread().install(|| lengths::print_line(name, &scene, &query));
    }
}

criterion_group!(benches, screen, spheres);

fn main() {
    if std::env::var_os("NEARMISS_SLICE_LENGTHS").is_some() {
        print_lengths();
    }
    benches();
    Criterion::default().configure_from_args().final_summary();
}
