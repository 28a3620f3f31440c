//! Bodies that are told another place, far away.

use super::is_as_screened;
use super::support::{rng, vector};
use glam::DVec3;
use nearmiss::{AlertLevel, Body, BodyId, Hitbox, Monitor, Scene, State, Trajectory};
use rand::RngExt;

const LEVEL: AlertLevel = AlertLevel::at(1.5);

/// A stream of shots 600 m long, whose boxes overlap: each that has come to its end is told to begin again. They are
/// compared at their old places and at their new ones, but not with all that is in between.
#[test]
fn shots_that_begin_again_are_compared_at_both_places_alone() {
    const SHOTS: u32 = 800;
    const LENGTH: f64 = 600.0;
    const STEP: f64 = 1.0 / 60.0;
    let rng = &mut rng(911);
    let mut scene = Scene::new();
    let mut shots: Vec<(BodyId, DVec3, DVec3)> = (0..SHOTS)
        .map(|number| {
            let along = LENGTH * f64::from(number) / f64::from(SHOTS);
            let place = along * DVec3::X + vector(rng, 45.0) * DVec3::new(0.0, 1.0, 1.0);
            let velocity = 300.0 * DVec3::X + vector(rng, 3.0);
            let plan = Trajectory::coasting(State::new(0.0, place, velocity)).unwrap();
            let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.1).unwrap());
            (scene.insert(body).unwrap(), place, velocity)
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap();
    let (mut events, mut spans, mut teleports) = (Vec::new(), 0, 0_u64);
    for frame in 0..40 {
        let now = STEP * f64::from(frame);
        let told = shots
            .iter()
            .map(|&(id, place, velocity)| (id, State::new(now, place, velocity)));
        monitor.track(now, told).unwrap();
        monitor.advance(now, &mut events).unwrap();
        is_as_screened(&monitor, LEVEL);
        if frame > 2 {
            spans += monitor.stats().spans;
        }
        for (_, place, velocity) in &mut shots {
            *place += STEP * *velocity;
            if place.x > LENGTH {
                teleports += u64::from(frame > 2);
                place.x -= LENGTH * rng.random_range(0.9..1.0);
            }
        }
    }
    assert!(
        teleports > 200 && events.len() > 2,
        "{teleports} {}",
        events.len()
    );
    assert!(spans < 40 * teleports, "{spans} of {teleports}");
}
