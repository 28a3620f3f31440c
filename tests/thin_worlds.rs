//! Worlds without height, or without width either: games seen from above, traffic on a road. What they cost is counted, not
//! timed.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Hitbox, Monitor, Query, Scene, State, Stats, Trajectory, Window,
};
use rand::RngExt;
use std::f64::consts::TAU;
use support::rng;

/// Bodies on a plane, or on a line, are cut into as few slices as in a thin layer around it.
#[test]
fn a_world_without_height_costs_what_a_thin_one_does() {
    const COUNT: u32 = 10_000;
    let cost = |stats: &Stats| stats.boxes + stats.candidates;
    for is_line in [false, true] {
        // A third of them touch another one all the time.
        let long = if is_line { 20_000.0 } else { 224.0 };
        let [flat, thin] = [0.0, 1.0].map(|thickness| {
            let wide = if is_line { thickness } else { long };
            let mut rng = rng(3);
            let mut scene = Scene::new();
            for _ in 0..COUNT {
                let place = [long, wide, thickness].map(|side| side * rng.random_range(0.0..1.0));
                let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
                let velocity = 1.4 * DVec3::new(cos, if is_line { 0.0 } else { sin }, 0.0);
                let plan = Trajectory::coasting(State::new(0.0, place, velocity)).unwrap();
                let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.4).unwrap());
                scene.insert(body).unwrap();
            }
            let query = Query::new(Window::new(0.0, 2.0).unwrap());
            let screened = cost(&scene.screen(&query).unwrap().stats);
            let levels = [AlertLevel::at(0.0)];
            let mut monitor = Monitor::new(scene, 0.0, 2.0, &levels).unwrap();
            monitor.advance(0.0, &mut Vec::new()).unwrap();
            let first = cost(monitor.stats());
            let states = monitor.scene().bodies().map(|(id, body)| {
                let state = body.trajectory.state(0.1).unwrap();
                (id, state)
            });
            let states: Vec<(BodyId, State)> = states.collect();
            monitor.track(0.1, states).unwrap();
            monitor.advance(0.1, &mut Vec::new()).unwrap();
            [screened, first, cost(monitor.stats())]
        });
        for (flat, thin) in flat.into_iter().zip(thin) {
            assert!(flat < 4 * thin, "{flat} {thin} {is_line}");
        }
    }
}
