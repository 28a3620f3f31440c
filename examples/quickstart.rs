//! The example of the README: two bodies that fly at each other.

use nearmiss::{Body, Hitbox, Query, Scene, State, Trajectory};
use std::error::Error;
use std::io::{ErrorKind, Write, stdout};

fn main() -> Result<(), Box<dyn Error>> {
    let mut scene = Scene::new();
    for (start, speed) in [(0.0, 10.0), (100.0, -10.0)] {
        // s, m, m/s
        let state = |time| State::new(time, [start + speed * time, 0.0, 0.0], [speed, 0.0, 0.0]);
        let plan = Trajectory::from_states(&[state(0.0), state(10.0)])?;
        scene.insert(Body::new(plan).with_hitbox(Hitbox::sphere(0.5)?))?;
    }
    // m between surfaces
    for conflict in scene.screen(&Query::default().with_margin(2.0))?.conflicts {
        match writeln!(stdout(), "{conflict}") {
            // Nobody reads any more: `println!` would panic.
            Err(error) if error.kind() == ErrorKind::BrokenPipe => return Ok(()),
            written => written?,
        }
    }
    Ok(())
}
