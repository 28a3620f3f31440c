//! Bodies that come very near while they hardly move, as after a launch or before docking: there the
//! squared distance does not show what the distance does. Each proven conflict is found.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::{Accuracy, BodyId, Conflict, Query, Scene, State, Window};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use support::{rng, scene_of, vector};

/// A direction, much shorter than one.
fn tiny(rng: &mut ChaCha8Rng, exponents: std::ops::Range<f64>) -> DVec3 {
    vector(rng, 1.0) * 10_f64.powf(rng.random_range(exponents))
}

/// Control points of a relative motion within about a metre of the origin.
fn motion(rng: &mut ChaCha8Rng, kind: u64) -> [DVec3; 4] {
    let near = tiny(rng, -12.0..-3.0);
    let (way, other) = (vector(rng, 1.0), vector(rng, 1.0));
    let flat = rng.random_range(0.0..1.0);
    let (x, y): (f64, f64) = (-flat, 1.0 - flat);
    match kind {
        // Starts, or ends, near and slowly.
        0 => [near, near + tiny(rng, -14.0..-6.0), way, other],
        1 => [way, other, near + tiny(rng, -14.0..-6.0), near],
        // Straight past.
        2 => [near - way, near - way / 3.0, near + way / 3.0, near + way],
        // Stands still for an instant on the way: cubic, quadratic.
        3 => [x * x * x, x * x * y, x * y * y, y * y * y].map(|share| near + way * share),
        4 => {
            let [a, b, c] = [x * x, x * y, y * y];
            [a, (a + 2.0 * b) / 3.0, (2.0 * b + c) / 3.0, c].map(|share| near + way * share)
        }
        // Launch; from rest to rest; anything.
        5 => [near, near, near, way],
        6 => [near, near, near + way, near + way],
        _ => [vector(rng, 1.0), vector(rng, 1.0), way, other],
    }
}

fn overlaps(x: &Conflict, y: &Conflict) -> bool {
    x.enter <= y.exit && y.enter <= x.exit
}

#[test]
fn what_is_proven_is_found() {
    let mut rng = rng(51);
    let (mut proven, mut joined) = (0, 0);
    for round in 0..16_000 {
        let [p0, p1, p2, p3] = motion(&mut rng, round % 8);
        let unit = 10_f64.powi(rng.random_range(-3..7));
        let comes = [
            State::new(0.0, p0 * unit, 3.0 * (p1 - p0) * unit),
            State::new(1.0, p3 * unit, 3.0 * (p3 - p2) * unit),
        ];
        let rests = [0.0, 1.0].map(|time| State::new(time, DVec3::ZERO, DVec3::ZERO));
        let scene = scene_of(&[(comes.to_vec(), 0.0), (rests.to_vec(), 0.0)]);
        let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
        let rounding = 0.5 * f64::EPSILON * unit;
        let least = scene.certified_closest_approach(ids[0], ids[1], Window::ALL);
        let least = least.unwrap().unwrap();
        let nearest = scene.closest_approach(ids[0], ids[1], Window::ALL);
        let off = (nearest.unwrap().unwrap().separation - least.approach.separation).abs();
        assert!(off <= least.error + 400.0 * rounding, "{round}: {off:e}");
        // Just met, and by far; so large that rounding is not the question.
        let factor = [1.000_001, 1.01, 1.5, 4.0][rng.random_range(0..4)];
        let margin = least.approach.separation * factor + least.error + 400.0 * rounding;
        let screen = |scene: &Scene, accuracy: Accuracy| {
            let query = Query::default().with_margin(margin);
            let found = scene.screen(&query.with_accuracy(accuracy));
            found.unwrap().conflicts
        };
        let certified = screen(&scene, Accuracy::Certified);
        let resolved = certified
            .iter()
            .filter(|conflict| conflict.certificate.is_some_and(|proof| proof.resolved));
        let body = scene.body(ids[0]).unwrap();
        let found = screen(&scene, Accuracy::Exact);
        for conflict in resolved.clone() {
            let holds = found.iter().any(|found| overlaps(found, conflict));
            assert!(holds, "{round} {margin:e}: {conflict:?}");
        }
        joined += certified.len().saturating_sub(found.len());
        for instant in found.iter().flat_map(|found| [found.enter, found.exit]) {
            let distance = body.trajectory.position(instant).unwrap().length();
            assert!(
                distance <= margin + 400.0 * rounding,
                "{round} {distance:e}"
            );
        }
        proven += resolved.count();
    }
    assert!(proven > 15_000 && joined < 20, "{proven} {joined}");
}
