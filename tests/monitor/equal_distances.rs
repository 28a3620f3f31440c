//! Distances that are constant but for rounding, and spheres that are equally near.

use super::is_as_screened;
use super::scenarios::tick;
use super::support::{rng, vector};
use glam::DVec3;
use nearmiss::{AlertLevel, Body, EventKind, Hitbox, Monitor, Scene, Sphere, State, Trajectory};
use rand::rngs::ChaCha8Rng;

/// Moves the clock of a monitor of two bodies; its conflicts are those of a screening, bit for bit, after each tick.
fn stays_as_screened(bodies: [Body; 2], level: AlertLevel, clocks: &[f64]) {
    let mut scene = Scene::new();
    for body in bodies {
        scene.insert(body).unwrap();
    }
    let mut monitor = Monitor::new(scene, 0.0, 5.0, &[level]).unwrap();
    for &now in clocks {
        tick(&mut monitor, now);
        assert!(!monitor.conflicts(0).unwrap().is_empty());
        is_as_screened(&monitor, level);
    }
}

/// Returns two bodies that fly along one curved path in a cube (half side in m), about a metre apart, for so many seconds.
fn formation(rng: &mut ChaCha8Rng, half_side: f64, seconds: u32) -> [Body; 2] {
    let offset = vector(rng, 1.0);
    let (mut leader, mut follower) = (Vec::new(), Vec::new());
    for second in 0..=seconds {
        let (place, velocity) = (vector(rng, half_side), vector(rng, 3.0));
        leader.push(State::new(f64::from(second), place, velocity));
        follower.push(State::new(f64::from(second), place + offset, velocity));
    }
    [leader, follower].map(|states| Body::new(Trajectory::from_states(&states).unwrap()))
}

/// Conflicts name the instant that a screening names, though their distance is constant but for rounding.
#[test]
fn bodies_in_formation_are_reported_as_screened() {
    // Nearer by some roundings from state to state.
    let nearing = (0..5).map(|k| {
        let place = DVec3::X * (1.0 - 3e-15 * f64::from(k));
        State::new(2.5 * f64::from(k), place, DVec3::ZERO)
    });
    let nearing = Trajectory::from_states(&nearing.collect::<Vec<_>>()).unwrap();
    let bodies = [Trajectory::at_rest(DVec3::ZERO).unwrap(), nearing].map(Body::new);
    stays_as_screened(bodies, AlertLevel::at(2.0), &[0.0, 3.0, 4.0]);
    let mut rng = rng(3);
    let clocks: Vec<f64> = (0..150).map(|step| 0.1 * f64::from(step)).collect();
    for _ in 0..20 {
        let bodies = formation(&mut rng, 1000.0, 20);
        stays_as_screened(bodies, AlertLevel::at(4.0), &clocks);
    }
}

/// Two that fly in formation come closest when they begin to, and nothing is revised but the exit.
#[test]
fn the_rounding_of_a_constant_distance_is_no_event() {
    let mut rng = rng(4);
    for _ in 0..20 {
        let mut scene = Scene::new();
        for body in formation(&mut rng, 10.0, 10) {
            scene.insert(body).unwrap();
        }
        let mut monitor = Monitor::new(scene, 0.0, 3.0, &[AlertLevel::at(4.0)]).unwrap();
        let (mut revised, mut ended) = (0, 0);
        for step in 0..120 {
            for event in tick(&mut monitor, 0.1 * f64::from(step)) {
                match event.kind {
                    EventKind::Revised(encounter) => {
                        revised += 1;
                        assert!(!encounter.open);
                    }
                    EventKind::Ended(encounter, _) => {
                        ended += 1;
                        assert_eq!(encounter.closest.time, 0.0);
                    }
                    _ => {}
                }
            }
        }
        assert_eq!((revised, ended), (1, 1));
    }
}

/// Spheres that are equally near when the window begins.
#[test]
fn of_equally_near_spheres_the_one_that_is_screened_is_reported() {
    let sphere = |x: f64, y: f64| Sphere {
        offset: DVec3::new(x, y, 0.0),
        radius: 0.0,
    };
    let point = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
    let rising = Trajectory::coasting(State::new(0.0, DVec3::ZERO, DVec3::Y)).unwrap();
    for spheres in [
        vec![sphere(4.0, 2.0), sphere(3.0, 3.0)],
        vec![sphere(3.0, 3.0), sphere(4.0, 2.0)],
    ] {
        let cluster = Body::new(rising.clone()).with_hitbox(Hitbox::cluster(spheres).unwrap());
        stays_as_screened([point.clone(), cluster], AlertLevel::at(6.0), &[0.0, 1.0]);
    }
}
