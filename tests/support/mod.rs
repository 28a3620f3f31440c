//! Seeded scenes and small makers that several test files share.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test file uses some of it; a test that cannot build its scene fails"
)]

use glam::DVec3;
use nearmiss::internals::QueryInternals;
use nearmiss::{
    Body, Conflict, Error, Hitbox, Monitor, Query, RevisionThreshold, Scene, State, Trajectory,
    Window,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::num::NonZeroU32;

pub(crate) fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

pub(crate) fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::new(
        rng.random_range(-half..half),
        rng.random_range(-half..half),
        rng.random_range(-half..half),
    )
}

/// The limit that a search exceeded.
pub(crate) fn exceeded<T>(done: Result<T, Error>) -> Option<usize> {
    match done {
        Err(Error::TooCrowded { limit, .. }) => Some(limit),
        _ => None,
    }
}

/// A monitor that reports every change of an encounter, those of rounding included.
pub(crate) fn with_every_change(mut monitor: Monitor) -> Monitor {
    let every = RevisionThreshold::default()
        .with_time(0.0)
        .with_separation(0.0);
    monitor.set_revision_threshold(every).unwrap();
    monitor
}

/// Straight motion at constant velocity from `start` to `end` seconds.
pub(crate) fn line(start: f64, end: f64, from: DVec3, velocity: DVec3) -> Trajectory {
    Trajectory::from_states(&[
        State::new(start, from, velocity),
        State::new(end, from + velocity * (end - start), velocity),
    ])
    .unwrap()
}

/// A wandering trajectory: irregular knots from `start` on, smooth velocities of about `speed`.
pub(crate) fn wander(
    rng: &mut ChaCha8Rng,
    start: f64,
    segments: usize,
    mean_gap: f64,
    cube: f64,
    speed: f64,
) -> Vec<State> {
    let mut time = start;
    let mut position = vector(rng, cube / 2.0);
    let mut velocity = vector(rng, speed);
    let mut states = vec![State::new(time, position, velocity)];
    for _ in 0..segments {
        let gap = mean_gap * rng.random_range(0.4..1.6);
        let next = velocity * 0.7 + vector(rng, speed) * 0.6;
        // Pulled back into the cube, so that the density stays.
        let next = next - position * (speed / cube);
        position += (velocity + next) * (gap / 2.0);
        velocity = next;
        time += gap;
        states.push(State::new(time, position, velocity));
    }
    states
}

/// `count` wanderers with radii up to 0.5 m in a cube of this side (m), 20 s or so.
pub(crate) fn swarm(seed: u64, count: usize, cube: f64) -> Vec<(Vec<State>, f64)> {
    let mut rng = rng(seed);
    (0..count)
        .map(|_| {
            let start = rng.random_range(0.0..5.0);
            let states = wander(&mut rng, start, 12, 1.5, cube, 5.0);
            (states, rng.random_range(0.0..0.5))
        })
        .collect()
}

pub(crate) fn scene_of(bodies: &[(Vec<State>, f64)]) -> Scene {
    let mut scene = Scene::new();
    for (tag, (states, radius)) in (0..).zip(bodies) {
        let body = Body::new(Trajectory::from_states(states).unwrap())
            .with_hitbox(Hitbox::sphere(*radius).unwrap())
            .with_tag(tag);
        scene.insert(body).unwrap();
    }
    scene
}

pub(crate) fn screen(scene: &Scene, window: Window, margin: f64) -> Vec<Conflict> {
    let query = Query::new(window).with_margin(margin);
    scene.screen(&query).unwrap().conflicts
}

/// All bits of all conflicts: equal only if every number is the same to the last bit.
pub(crate) fn bits(conflicts: &[Conflict]) -> Vec<Vec<u64>> {
    conflicts
        .iter()
        .map(|conflict| {
            let closest = &conflict.closest;
            let mut bits = vec![
                u64::from(conflict.a.slot()),
                u64::from(conflict.b.slot()),
                conflict.enter.to_bits(),
                conflict.exit.to_bits(),
                closest.time.to_bits(),
                closest.separation.to_bits(),
                u64::from(closest.sphere_a),
                u64::from(closest.sphere_b),
                u64::from(conflict.clip.bits()),
            ];
            for vector in [
                closest.position_a,
                closest.position_b,
                closest.relative_velocity,
            ] {
                bits.extend(vector.to_array().map(f64::to_bits));
            }
            if let Some(proof) = conflict.certificate {
                bits.extend([proof.error.to_bits(), u64::from(proof.resolved)]);
                for times in [proof.enter, proof.exit, proof.closest] {
                    bits.extend([times.earliest.to_bits(), times.latest.to_bits()]);
                }
            }
            bits
        })
        .collect()
}

/// Those bits in one number: for many answers of many conflicts.
pub(crate) fn hash(conflicts: &[Conflict]) -> u64 {
    hash_of(&bits(conflicts))
}

pub(crate) fn hash_of(value: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

/// The query with the window cut into so many slices; 0 leaves the choice to it.
pub(crate) fn sliced(query: Query, slices: u32) -> Query {
    NonZeroU32::new(slices).map_or(query, |slices| query.with_slices(slices))
}

/// Returns the result of work on so many threads. (Without the feature `parallel` it has one of them.)
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}
