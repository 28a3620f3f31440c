//! Recordings of bodies over half-spaces.

use super::support::{rng, vector};
use super::{Memory, replay, text};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Command, Hitbox, Monitor, Scene, State, Trajectory,
};
use rand::RngExt;

/// Floors that come, move and go are recorded and replayed, in ticks with and without a budget.
#[test]
fn floors_are_replayed() {
    let mut rng = rng(33);
    let rng = &mut rng;
    let mut scene = Scene::new();
    let floor = Hitbox::half_space(DVec3::new(0.6, 0.0, 0.8)).unwrap();
    let rest = Body::new(Trajectory::at_rest(-2.0 * DVec3::Z).unwrap());
    scene
        .insert(rest.clone().with_hitbox(floor.clone()))
        .unwrap();
    let ids: Vec<BodyId> = (0..40)
        .map(|_| {
            let state = State::new(0.0, vector(rng, 5.0), vector(rng, 1.0));
            let body = Body::new(Trajectory::coasting(state).unwrap());
            scene
                .insert(body.with_hitbox(Hitbox::sphere(0.2).unwrap()))
                .unwrap()
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 3.0, &[AlertLevel::at(0.1)]).unwrap();
    let file = Memory::default();
    monitor.start_recording(file.clone()).unwrap();
    let mut events = Vec::new();
    let mut walls = Vec::new();
    for tick in 0..80_u8 {
        let now = 0.1 * f64::from(tick);
        let id = ids[rng.random_range(0..ids.len())];
        let state = State::new(now, vector(rng, 4.0), vector(rng, 1.0));
        match tick % 5 {
            0 => {
                let body = rest.clone().with_hitbox(floor.clone());
                walls.extend(monitor.apply([Command::Insert(body)]).unwrap());
            }
            1 => monitor
                .track(now, [(walls[0], state), (id, state)])
                .unwrap(),
            2 if walls.len() > 3 => drop(monitor.remove(walls.swap_remove(1)).unwrap()),
            3 => drop(monitor.apply([Command::IgnorePair(walls[0], id)]).unwrap()),
            _ => monitor.track(now, [(id, state)]).unwrap(),
        }
        let budget = match tick % 3 {
            0 => Budget::Work(rng.random_range(1..200)),
            _ => Budget::Unlimited,
        };
        monitor.advance_within(now, budget, &mut events).unwrap();
    }
    monitor.close(&mut events);
    let (again, end) = replay(&file.bytes());
    end.unwrap();
    assert_eq!(text(&events), text(&again));
    assert!(events.len() > 200, "{}", events.len());
}
