//! Monitors, screenings and covers give the same bits on every instruction set of the processor.
//!
//! A process has one best set. So this program runs itself, once for each.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::{DQuat, DVec3};
use nearmiss::kernels::InstructionSet;
use nearmiss::parry3d::math::Vector;
use nearmiss::parry3d::shape::{Cone, Cuboid, Cylinder, Shape, TriMesh};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, BodyState, Command, CoverOptions, Hitbox, Monitor,
    Orientation, Outside, Query, Scene, Sphere, SphereCover, State, Trajectory, Window, pair,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::process::Command as Process;
use support::{bits, hash_of, rng, vector, wander, with_every_change};

const VARIABLE: &str = "NEARMISS_INSTRUCTIONS";
const BODIES: usize = 400;
const CUBE: f64 = 40.0;

/// A processor without AVX2 has one set, and nothing is compared there.
#[test]
fn answers_are_the_same_on_every_set() {
    let of = |set: InstructionSet| {
        let run = Process::new(std::env::current_exe().unwrap())
            .args(["--ignored", "--exact", "answers", "--nocapture"])
            .env(VARIABLE, set.name())
            .output()
            .unwrap();
        let said = String::from_utf8(run.stdout).unwrap();
        assert!(run.status.success(), "{}: {said}", set.name());
        let answers = said.lines().filter(|line| line.starts_with("- "));
        let answers: Vec<String> = answers.map(String::from).collect();
        assert_eq!(answers.len(), 4, "{said}");
        answers
    };
    let portable = of(InstructionSet::PORTABLE);
    for set in InstructionSet::available().into_iter().skip(1) {
        assert_eq!(of(set), portable, "{}", set.name());
    }
}

/// Prints hashes of answers, found on the set that the environment names.
#[test]
#[ignore = "is run by the other test, on each set"]
fn answers() {
    let Ok(name) = std::env::var(VARIABLE) else {
        return;
    };
    assert_eq!(InstructionSet::best().name(), name);
    // The name of a test is printed without an end of its line.
    println!();
    let (reported, events) = flown();
    assert!(events > 2_000, "{events}");
    println!("- monitor: {reported:x} of {events} events");
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let (found, conflicts) = screened(accuracy);
        assert!(conflicts > 500, "{conflicts}");
        println!("- {accuracy:?} screening: {found:x} of {conflicts} conflicts");
    }
    println!("- covers: {:x}", covered());
}

fn plan(rng: &mut ChaCha8Rng, now: f64) -> Trajectory {
    let states = wander(rng, now - 0.5, 8, 1.2, CUBE, 4.0);
    let plan = Trajectory::from_states(&states).unwrap();
    plan.with_outside([Outside::Absent, Outside::Coast][rng.random_range(0..2)])
}

/// Spheres, clusters that turn or do not, and a half-space.
fn scene(rng: &mut ChaCha8Rng) -> (Scene, Vec<BodyId>) {
    let mut scene = Scene::new();
    let bodies = (0..BODIES).map(|number| {
        let body = Body::new(plan(rng, 0.0));
        let radius = rng.random_range(0.0..0.5);
        if number % 4 > 0 {
            return body.with_hitbox(Hitbox::sphere(radius).unwrap());
        }
        let arms = (0..6).map(|_| Sphere::new(vector(rng, 1.0), radius));
        let body = body.with_hitbox(Hitbox::cluster(arms.collect()).unwrap());
        if number % 8 > 0 {
            return body;
        }
        let spin = vector(rng, 3.0);
        body.with_orientation(Orientation::spin(0.0, DQuat::IDENTITY, spin).unwrap())
    });
    let bodies: Vec<Body> = bodies.collect();
    let ids = bodies.into_iter().map(|body| scene.insert(body).unwrap());
    let ids = ids.collect();
    let ground = Body::new(Trajectory::at_rest(DVec3::new(0.0, 0.0, -CUBE / 3.0)).unwrap());
    let ground = ground.with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
    scene.insert(ground).unwrap();
    (scene, ids)
}

/// Returns the hash of what a monitor reports while bodies are given plans, and states.
fn flown() -> (u64, usize) {
    let mut rng = rng(91);
    let (scene, ids) = scene(&mut rng);
    let levels = [AlertLevel::at(3.0), AlertLevel::at(0.5)];
    let monitor = Monitor::new(scene, 0.0, 2.0, &levels).unwrap();
    let mut monitor = with_every_change(monitor);
    let (mut reported, mut count, mut news) = (Vec::new(), 0, Vec::new());
    for tick in 0..30 {
        let now = monitor.now();
        let some = |rng: &mut ChaCha8Rng, count: usize| {
            let first = rng.random_range(0..BODIES);
            ids.iter().cycle().skip(first).take(count).copied()
        };
        let replanned = some(&mut rng, [0, 2, 30, BODIES][tick % 4]);
        let replan = replanned.map(|id| Command::Replan(id, now, plan(&mut rng, now).into()));
        let replan: Vec<Command> = replan.collect();
        monitor.apply(replan).unwrap();
        let told = some(&mut rng, [0, 5, 100][tick % 3]);
        let told = told.map(|id| {
            let (place, velocity) = (vector(&mut rng, CUBE / 2.0), vector(&mut rng, 4.0));
            let state = BodyState::from(State::new(now, place, velocity));
            (id, state.with_spin(DQuat::IDENTITY, vector(&mut rng, 2.0)))
        });
        let told: Vec<_> = told.collect();
        monitor.track(now, told).unwrap();
        news.clear();
        monitor.advance(now + 0.1, &mut news).unwrap();
        count += news.len();
        // The shortest text that gives the same number back: all bits.
        reported.push(hash_of(&format!("{news:?}")));
        reported.push(hash_of(&bits(monitor.conflicts(0).unwrap())));
        let tried = plan(&mut rng, monitor.now());
        let tried = monitor.what_if(ids[tick], &tried, 0).unwrap();
        reported.push(hash_of(&bits(&tried)));
    }
    (hash_of(&reported), count)
}

/// Returns the hash of what is found in a scene, and between pairs of its bodies.
fn screened(accuracy: Accuracy) -> (u64, usize) {
    let mut rng = rng(92);
    let (scene, ids) = scene(&mut rng);
    let query = Query::new(Window::new(0.0, 8.0).unwrap()).with_margin(1.0);
    let query = query.with_accuracy(accuracy);
    let found = scene.screen(&query).unwrap().conflicts;
    let pairs = ids.windows(2).flat_map(|ids| {
        let [a, b] = [0, 1].map(|which| scene.body(ids[which]).unwrap());
        pair::conflicts(a, b, &query).unwrap()
    });
    let pairs: Vec<_> = pairs.collect();
    (hash_of(&[bits(&found), bits(&pairs)]), found.len())
}

/// Returns the hash of the covers of some solids.
fn covered() -> u64 {
    let cuboid = Cuboid::new(Vector::new(0.5, 1.0, 2.0));
    let (points, triangles) = Cylinder::new(1.0, 0.4).to_trimesh(9);
    let mesh = TriMesh::new(points, triangles).unwrap();
    let solids: [&dyn Shape; 4] = [
        &cuboid,
        &Cylinder::new(1.0, 0.4),
        &Cone::new(1.0, 0.7),
        &mesh,
    ];
    let covers = solids.map(|solid| SphereCover::fit(solid, &CoverOptions::new(6)).unwrap());
    hash_of(&format!("{covers:?}"))
}
