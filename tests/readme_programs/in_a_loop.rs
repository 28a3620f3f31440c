use nearmiss::{AlertLevel, Body, Error, Hitbox, Monitor, Scene, State, Trajectory};

fn main() -> Result<(), Error> {
    let (mut scene, mut balls) = (Scene::new(), Vec::new()); // `balls`: what your engine moves
    for (tag, x, speed) in [(7, -20.0, 10.0), (8, 20.0, -10.0)] {
        let start = State::new(0.0, [x, 0.0, 0.0], [speed, 0.0, 0.0]);
        let body = Body::new(Trajectory::coasting(start)?).with_hitbox(Hitbox::sphere(1.0)?).with_tag(tag);
        balls.push((scene.insert(body)?, start));
    }
    let contact = AlertLevel::at(0.0).with_release(0.05); // begins at a separation of 0 m, ends above 5 cm
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[contact])?; // at 0 s, 2 s ahead
    let mut events = Vec::new();
    for now in (1..180).map(|frame| f64::from(frame) / 60.0) {
        let moved = |start: State| State::new(now, start.position + now * start.velocity, start.velocity);
        monitor.track(now, balls.iter().map(|&(id, start)| (id, moved(start))))?;
        monitor.advance(now, &mut events)?;
        events.drain(..).for_each(|event| println!("{event:.2}"));
    }
    Ok(())
}
