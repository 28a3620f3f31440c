//! Model errors: what is said of the world, of which only the distance from the plans is known.

#![allow(
    clippy::float_cmp,
    clippy::unwrap_used,
    reason = "what is kept is the same number; a scene that cannot be built fails the test"
)]

mod answers;
#[path = "../support/mod.rs"]
mod support;
mod world;

use nearmiss::{Accuracy, Conflict, Query, Scene, Window};
use support::rng;
use world::{World, world};

/// Instants of the oracle's samples.
const SAMPLES: usize = 240;
/// A separation that is below the margin by more than this (m) is found, also of bodies that turn.
const FOUND: f64 = 1e-9;
/// A separation that exceeds the margin by more than this (m) at the lowest of three samples stays above it between them: the
/// bodies take 25 ms for half of the way, at less than 40 m/s.
const NEAR: f64 = 1.0;

/// Counts of a run over many worlds.
#[derive(Debug, Default)]
struct Tally {
    /// Instants within the margin.
    instants: usize,
    /// Encounters between samples.
    grazes: usize,
    conflicts: usize,
    resolved: usize,
    uncertain: usize,
}

/// 1e5 pairs of true motions.
#[test]
#[ignore = "100,000 worlds: a minute"]
fn no_encounter_of_many_worlds_is_missed() {
    let tally = all(0..100_000);
    println!("{tally:?}");
    assert!(tally.resolved > 20_000, "{tally:?}");
    assert!(tally.uncertain > 10_000, "{tally:?}");
}

#[test]
fn no_encounter_of_the_world_is_missed() {
    let tally = all(0..3_000);
    assert!(tally.instants > 1_000, "{tally:?}");
    assert!(tally.grazes > 20, "{tally:?}");
    assert!(tally.resolved > 600, "{tally:?}");
    assert!(tally.uncertain > 300, "{tally:?}");
}

fn all(seeds: std::ops::Range<u64>) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        let world = world(&mut rng(seed), seed);
        check(&world, seed, &mut tally);
    }
    tally
}

fn conflicts(scene: &Scene, world: &World, accuracy: Accuracy) -> Vec<Conflict> {
    let window = Window::new(world.window.0, world.window.1).unwrap();
    let query = Query::new(window)
        .with_margin(world.margin)
        .with_accuracy(accuracy);
    scene.screen(&query).unwrap().conflicts
}

/// Compares the answers about a world with what happens in it.
fn check(world: &World, seed: u64, tally: &mut Tally) {
    let mut scene = Scene::new();
    for body in &world.bodies {
        scene.insert(body.clone()).unwrap();
    }
    let exact = conflicts(&scene, world, Accuracy::Exact);
    let certified = conflicts(&scene, world, Accuracy::Certified);
    let (from, to) = world.window;
    let mut times: Vec<f64> = (0..=SAMPLES)
        .map(|k| from + (to - from) * k as f64 / SAMPLES as f64)
        .collect();
    // Where it matters.
    for conflict in exact.iter().chain(&certified) {
        times.extend([conflict.enter, conflict.exit, conflict.closest.time]);
        if let Some(proof) = conflict.certificate {
            for ends in [proof.enter, proof.exit, proof.closest] {
                let way = ends.latest - ends.earliest;
                times.extend([0.0, 0.01, 0.5, 0.99, 1.0].map(|k| ends.earliest + k * way));
            }
        }
    }
    times.extend(&world.special);
    times.sort_by(f64::total_cmp);
    let mut samples: Vec<(f64, f64)> = times
        .into_iter()
        .filter(|time| (from..=to).contains(time))
        .map(|time| (time, world.separation(time)))
        .collect();
    // An encounter may be shorter than the time between two samples.
    let mut lowest = Vec::new();
    for (place, &(_, least)) in samples.iter().enumerate() {
        let before = samples[place.saturating_sub(1)];
        let after = samples[(place + 1).min(samples.len() - 1)];
        if least <= world.margin + NEAR && least <= before.1.min(after.1) {
            let found = world.lowest((before.0, after.0));
            tally.grazes += usize::from(least > world.margin && found.1 <= world.margin);
            lowest.push(found);
        }
    }
    samples.extend(lowest);
    samples.sort_by(|one, other| one.0.total_cmp(&other.0));
    let rounding = world.rounding;
    for found in [&exact, &certified] {
        for &(time, separation) in &samples {
            let is_listed = found.iter().any(|conflict| {
                let proof = conflict.certificate;
                let from = proof.map_or(conflict.enter, |proof| proof.enter.earliest);
                let to = proof.map_or(conflict.exit, |proof| proof.exit.latest);
                (from..=to).contains(&time)
            });
            if separation <= world.margin - FOUND {
                tally.instants += 1;
                assert!(is_listed, "{seed}: {separation} m at {time} s, {found:?}");
            }
        }
        for conflict in found {
            let closest = conflict.closest;
            let sum: f64 = world.bodies.iter().map(|body| body.model_error()).sum();
            assert!((closest.model_error - sum).abs() <= 1e-15 * sum);
            let above = closest.separation - (world.margin + closest.model_error);
            assert!(above <= rounding, "{seed}: {conflict:?}");
        }
    }
    for conflict in &certified {
        tally.conflicts += 1;
        check_proof(world, seed, conflict, &samples, tally);
    }
}

/// Compares one certificate with the world.
fn check_proof(
    world: &World,
    seed: u64,
    conflict: &Conflict,
    samples: &[(f64, f64)],
    tally: &mut Tally,
) {
    let proof = conflict.certificate.unwrap();
    let rounding = world.rounding;
    let during = |(from, to): (f64, f64)| {
        let within = samples
            .iter()
            .filter(move |sample| from <= sample.0 && sample.0 <= to);
        within.copied()
    };
    let whole = (proof.enter.earliest, proof.exit.latest);
    if proof.resolved {
        tally.resolved += 1;
        for (time, separation) in during((proof.enter.latest, proof.exit.earliest)) {
            let is_inside = separation <= world.margin + rounding;
            assert!(
                is_inside,
                "{seed}: {separation} m at {time} s, {conflict:?}"
            );
        }
    } else {
        tally.uncertain += 1;
        // A dip of the splines far below the margin is certain, and so is the conflict.
        let depth = world.margin - world.error() - conflict.closest.separation;
        let is_one = proof.enter.latest > proof.exit.earliest;
        assert!(depth <= rounding || !is_one, "{seed}: {conflict:?}");
    }
    let (low, high) = (
        conflict.closest.separation - proof.error,
        conflict.closest.separation + proof.error,
    );
    let least = during(whole)
        .map(|sample| sample.1)
        .fold(f64::INFINITY, f64::min);
    assert!(least >= low - rounding, "{seed}: {least} {conflict:?}");
    assert!(least <= high + rounding, "{seed}: {least} {conflict:?}");
    let is_within = whole.0 <= proof.closest.earliest && proof.closest.latest <= whole.1;
    assert!(is_within, "{seed}: {conflict:?}");
    // No instant outside the enclosure of the closest approach is nearer than those in it.
    let ends = (proof.closest.earliest, proof.closest.latest);
    let inside = during(ends)
        .map(|sample| sample.1)
        .fold(f64::INFINITY, f64::min);
    let inside = inside.min(world.lowest(ends).1);
    for (time, separation) in during(whole) {
        let is_in = ends.0 <= time && time <= ends.1;
        assert!(
            is_in || separation >= inside - rounding,
            "{seed}: {separation} m at {time} s, {inside} m inside, {conflict:?}"
        );
    }
}
