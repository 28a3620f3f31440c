//! Turning clusters above a half-space, against dense samples.

use super::{cluster, plan, unit, vector};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, Body, Conflict, Hitbox, Orientation, Query, Scene, State, Trajectory, Window,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn orientation(rng: &mut ChaCha8Rng) -> Orientation {
    let mut rotation =
        || DQuat::from_array([0; 4].map(|_| rng.random_range(-1.0..1.0))).normalize();
    let knots: Vec<(f64, DQuat)> = (0..6)
        .map(|knot| (2.0 * f64::from(knot), rotation()))
        .collect();
    match rng.random_range(0..3) {
        0 => {
            let speed = 10f64.powf(rng.random_range(-1.0..1.8));
            Orientation::spin(0.0, knots[0].1, vector(rng, speed)).unwrap()
        }
        1 => Orientation::slerp(&knots).unwrap(),
        _ => Orientation::normalized_cubic(&knots).unwrap_or(Orientation::FIXED),
    }
}

fn separation(body: &Body, floor: &Body, normal: DVec3, time: f64) -> f64 {
    let ground = floor.trajectory.position(time).unwrap();
    let spheres = body.spheres_at(time).unwrap();
    let heights = spheres
        .iter()
        .map(|sphere| (sphere.offset - ground).dot(normal) - sphere.radius);
    heights.fold(f64::INFINITY, f64::min)
}

fn is_in(conflicts: &[Conflict], time: f64) -> bool {
    let holds = |one: &Conflict| one.enter <= time && time <= one.exit;
    conflicts.iter().any(holds)
}

/// At every sample within the margin there is a conflict, at every one clearly beyond it there is
/// none, and the enclosures of the least separation hold.
#[test]
fn turning_clusters_meet_planes_where_samples_say() {
    const SAMPLES: i32 = 4_000;
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let rng = &mut rng;
    let (mut inside, mut conflicts) = (0, 0);
    for round in 0..150 {
        let normal = unit(rng).normalize();
        let floor =
            Body::new(plan(rng, DVec3::ZERO, 0.5)).with_hitbox(Hitbox::half_space(normal).unwrap());
        let body = Body::new(plan(rng, rng_height(round) * normal, 1.5))
            .with_hitbox(cluster(rng))
            .with_orientation(orientation(rng));
        let margin = rng.random_range(-1.0..1.0);
        let (mut start, mut end) = (f64::NEG_INFINITY, f64::INFINITY);
        for one in [&body, &floor] {
            let domain = one.trajectory.domain();
            (start, end) = (start.max(domain.start()), end.min(domain.end()));
        }
        let mut scene = Scene::new();
        let a = scene.insert(body.clone()).unwrap();
        let b = scene.insert(floor.clone()).unwrap();
        let query = Query::new(Window::new(start, end).unwrap()).with_margin(margin);
        let plain = scene.screen(&query).unwrap().conflicts;
        let certified = query.with_accuracy(Accuracy::Certified);
        let certified = scene.screen(&certified).unwrap().conflicts;
        conflicts += plain.len();
        // Baked with 1e-3 of the largest arm, 2.6 m, twice.
        let slack = 6e-3;
        let mut least = f64::INFINITY;
        for sample in 0..=SAMPLES {
            let time = start + (end - start) * f64::from(sample) / f64::from(SAMPLES);
            let time = time.min(end);
            let separation = separation(&body, &floor, normal, time);
            least = least.min(separation);
            if separation <= margin - 1e-9 {
                inside += 1;
                assert!(is_in(&plain, time), "{round} {time} {separation} {plain:?}");
                assert!(is_in(&certified, time), "{round} {time} {certified:?}");
            } else if separation > margin + slack {
                assert!(
                    !is_in(&plain, time),
                    "{round} {time} {separation} {plain:?}"
                );
            }
            if separation > margin + 1e-5 {
                assert!(!is_in(&certified, time), "{round} {time} {separation}");
            }
        }
        let window = Window::new(start, end).unwrap();
        let found = scene
            .certified_closest_approach(a, b, window)
            .unwrap()
            .unwrap();
        let low = found.approach.separation - found.error;
        assert!(low <= least + 1e-12, "{round} {least} {found:?}");
        assert!(found.error < 1e-4, "{found:?}");
        // Samples are dense: the truth is not much lower than the lowest one.
        let high = found.approach.separation + found.error;
        assert!(high > least - 0.2, "{round} {least} {found:?}");
    }
    assert!(inside > 50_000 && conflicts > 100, "{inside} {conflicts}");
}

fn rng_height(round: i32) -> f64 {
    f64::from(round % 7) - 1.0
}

/// A beam that spins above a floor for a long time touches it with its end, once per half turn.
#[test]
fn a_spinning_beam_touches_every_half_turn() {
    let spheres = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|x| nearmiss::Sphere {
        offset: x * DVec3::X,
        radius: 0.1,
    });
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, std::f64::consts::TAU * DVec3::Y).unwrap();
    let beam = Body::new(Trajectory::at_rest(DVec3::Z).unwrap())
        .with_hitbox(Hitbox::cluster(spheres.to_vec()).unwrap())
        .with_orientation(spin);
    let floor = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap())
        .with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
    let mut scene = Scene::new();
    let beam = scene.insert(beam).unwrap();
    scene.insert(floor).unwrap();
    let query = Query::new(Window::new(0.0, 100.0).unwrap());
    let found = scene.screen(&query).unwrap().conflicts;
    assert_eq!(found.len(), 200);
    for (number, conflict) in (0_u32..).zip(&found) {
        let lowest = 0.25 + 0.5 * f64::from(number);
        assert!(
            (conflict.closest.time - lowest).abs() < 0.02,
            "{conflict:?}"
        );
        assert!(
            (conflict.closest.separation + 0.1).abs() < 3e-3,
            "{conflict:?}"
        );
        assert_eq!(
            conflict.closest.sphere_a,
            if number % 2 == 0 { 4 } else { 0 }
        );
    }
    // A window has the same bits.
    let part = scene
        .screen(&Query::new(Window::new(30.4, 60.1).unwrap()))
        .unwrap();
    let inside: Vec<&Conflict> = found
        .iter()
        .filter(|one| one.enter > 30.4 && one.exit < 60.1)
        .collect();
    assert_eq!(part.conflicts.iter().collect::<Vec<_>>(), inside);
    // Lower, it never leaves.
    let low = State::new(0.0, 0.05 * DVec3::Z, DVec3::ZERO);
    scene.update([(beam, low)]).unwrap();
    assert_eq!(scene.screen(&query).unwrap().conflicts.len(), 1);
}
