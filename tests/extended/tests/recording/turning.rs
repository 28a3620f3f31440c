//! Recordings of bodies that turn.

use super::support::{rng, vector};
use super::{Memory, replay, text};
use glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyId, BodyPlan, BodyState, Command, Hitbox, Monitor, Orientation, Scene,
    Sphere, State, Trajectory,
};
use rand::RngExt;

/// All that sets an orientation is recorded, and replayed.
#[test]
fn turning_bodies_are_replayed() {
    let mut rng = rng(31);
    let rng = &mut rng;
    let sphere = |offset| Sphere {
        offset,
        radius: 0.3,
    };
    let hitbox = Hitbox::cluster(vec![sphere(1.5 * DVec3::X), sphere(-DVec3::Y)]).unwrap();
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..10)
        .map(|_| {
            let state = State::new(0.0, vector(rng, 5.0), vector(rng, 1.0));
            let plan = Trajectory::coasting(state).unwrap();
            let spin = Orientation::spin(0.0, DQuat::IDENTITY, vector(rng, 3.0)).unwrap();
            let body = Body::new(plan).with_hitbox(hitbox.clone());
            scene.insert(body.with_orientation(spin)).unwrap()
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 3.0, &[AlertLevel::at(0.2)]).unwrap();
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    let mut events = Vec::new();
    for tick in 0..60_u8 {
        let now = 0.1 * f64::from(tick);
        let id = ids[rng.random_range(0..ids.len())];
        let turn = DQuat::from_scaled_axis(vector(rng, 1.0));
        let knots = [(now, DQuat::IDENTITY), (now + 2.0, turn)];
        let state = State::new(now, vector(rng, 4.0), vector(rng, 1.0));
        let plan = Trajectory::coasting(state).unwrap();
        match tick % 4 {
            0 => monitor
                .orient(id, now, Orientation::slerp(&knots).unwrap())
                .unwrap(),
            1 => {
                let smooth = Orientation::normalized_cubic(&knots).unwrap();
                monitor
                    .replan(id, now, BodyPlan::new(plan, smooth))
                    .unwrap();
            }
            2 => {
                let told = BodyState::from(state).with_spin(turn, vector(rng, 2.0));
                monitor.track(now, [(id, told)]).unwrap();
            }
            _ => {
                let fixed = Command::SetOrientation(id, Orientation::FIXED);
                monitor.apply([fixed]).unwrap();
            }
        }
        monitor.advance(now, &mut events).unwrap();
    }
    monitor.close(&mut events);
    let (again, end) = replay(&file.bytes());
    end.unwrap();
    assert_eq!(text(&events), text(&again));
    assert!(events.len() > 30, "{}", events.len());
}
