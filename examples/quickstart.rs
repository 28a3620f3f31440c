//! The example of the README: two drones on crossing plans.

use glam::DVec3;
use nearmiss::{Body, Error, Hitbox, Query, Scene, State, Trajectory};

fn main() -> Result<(), Error> {
    let mut scene = Scene::new();
    for (from, to) in [
        (DVec3::ZERO, 100.0 * DVec3::X),
        (100.0 * DVec3::X, DVec3::Y),
    ] {
        let velocity = (to - from) / 10.0;
        let plan = [
            State::new(0.0, from, velocity),
            State::new(10.0, to, velocity),
        ];
        let body = Body::new(Trajectory::from_states(&plan)?).with_hitbox(Hitbox::sphere(0.5)?);
        scene.insert(body)?;
    }
    for conflict in scene.screen(&Query::default().with_margin(2.0))?.conflicts {
        println!("{conflict}");
    }
    Ok(())
}
