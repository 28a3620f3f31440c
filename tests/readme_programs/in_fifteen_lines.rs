use nearmiss::{Body, Error, Hitbox, Query, Scene, State, Trajectory};

fn main() -> Result<(), Error> {
    let mut scene = Scene::new();
    for (start, speed) in [(0.0, 10.0), (100.0, -10.0)] {
        let state = |time| State::new(time, [start + speed * time, 0.0, 0.0], [speed, 0.0, 0.0]); // s, m, m/s
        let plan = Trajectory::from_states(&[state(0.0), state(10.0)])?;
        scene.insert(Body::new(plan).with_hitbox(Hitbox::sphere(0.5)?))?;
    }
    for conflict in scene.screen(&Query::default().with_margin(2.0))?.conflicts { // m between surfaces
        println!("{conflict}");
    }
    Ok(())
}
