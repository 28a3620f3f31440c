//! The history that a monitor keeps changes nothing that it reports.

use super::{rotation, vector};
use nearmiss::glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyState, EndReason, EventKind, Hitbox, Monitor, Orientation, Scene, Sphere,
    State, Trajectory,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Bodies that are told, oriented and replanned at the clock jump there: they are at both places, and have both rotations.
#[test]
fn events_are_those_without_a_history() {
    let mut separated = 0;
    for round in 0..20_u64 {
        let mut rng = ChaCha8Rng::seed_from_u64(round);
        let rng = &mut rng;
        let rod = [-1.5, -0.5, 0.5, 1.5].map(|x| Sphere::new(x * DVec3::X, 0.3));
        let rod = Hitbox::cluster(rod.to_vec()).unwrap();
        let mut scene = Scene::new();
        let mut ids = Vec::new();
        for _ in 0..12 {
            let state = State::new(0.0, vector(rng, 3.0), vector(rng, 0.5));
            let body = Body::new(Trajectory::coasting(state).unwrap());
            ids.push(scene.insert(body.with_hitbox(rod.clone())).unwrap());
        }
        let mut monitors = [0.0, 0.25, 1e3].map(|history| {
            let levels = [AlertLevel::at(0.1)];
            let mut monitor = Monitor::new(scene.clone(), 0.0, 1.0, &levels).unwrap();
            monitor.set_history(history).unwrap();
            monitor
        });
        for tick in 0..60_u32 {
            let now = 0.1 * f64::from(tick);
            let said = monitors.each_mut().map(|monitor| {
                let mut events = Vec::new();
                monitor.advance(now, &mut events).unwrap();
                events
            });
            assert_eq!(said[0], said[1], "{round} {now}");
            assert_eq!(said[0], said[2], "{round} {now}");
            let is_end =
                |kind: &EventKind| matches!(kind, EventKind::Ended(_, EndReason::Separated));
            separated += said[0].iter().filter(|event| is_end(&event.kind)).count();
            let id = ids[rng.random_range(0..ids.len())];
            // At the clock of the tick, or a little later.
            let from = now + [0.0, 0.05][rng.random_range(0..2)];
            let (turn, velocity) = (rotation(rng), vector(rng, 3.0));
            let state = State::new(from, vector(rng, 3.0), vector(rng, 0.5));
            let kind = rng.random_range(0..3);
            for monitor in &mut monitors {
                match kind {
                    0 => {
                        let spin = Orientation::spin(from, turn, velocity).unwrap();
                        monitor.orient(id, from, spin).unwrap();
                    }
                    1 => {
                        let told = BodyState::from(state).with_spin(turn, velocity);
                        monitor.track(from, [(id, told)]).unwrap();
                    }
                    _ => {
                        let plan = Trajectory::coasting(state).unwrap();
                        monitor.replan(id, from, plan).unwrap();
                    }
                }
            }
        }
    }
    assert!(separated > 1_000, "{separated}");
}
