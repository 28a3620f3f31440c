//! Distances that are constant but for rounding, and spheres that are equally near.

use super::is_as_screened;
use super::scenarios::tick;
use super::support::{rng, vector};
use glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, Body, BodyState, EventKind, Hitbox, Monitor, Orientation, RevisionThreshold, Scene,
    Sphere, State, Trajectory,
};
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

/// A cluster turns beside a ball on its axis, told each frame or left alone. Of the distance, the same but for
/// rounding, any instant may be the least: none is news. Told, its way and its radius are approximated anew each frame:
/// the threshold is twice the tolerance then.
#[test]
fn a_distance_that_stays_the_same_as_a_body_turns_is_no_event() {
    let turning = |time: f64| DQuat::from_rotation_z(2.0 * time);
    for is_told in [false, true] {
        let off_axis = Sphere {
            offset: DVec3::new(1.0, 0.3, 0.2),
            radius: 0.3,
        };
        let ball = Hitbox::sphere(0.5).unwrap();
        let spin = Orientation::spin(0.0, turning(0.0), 2.0 * DVec3::Z).unwrap();
        let [low, high] = [1.7, 4.0].map(|height| Trajectory::at_rest(DVec3::Z * height).unwrap());
        let mut scene = Scene::new();
        scene.insert(Body::new(high).with_hitbox(ball)).unwrap();
        let cluster = Hitbox::cluster(vec![off_axis]).unwrap();
        let turns = Body::new(low).with_hitbox(cluster);
        let id = scene.insert(turns.with_orientation(spin)).unwrap();
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(3.0)]).unwrap();
        if is_told {
            let threshold =
                RevisionThreshold::default().with_separation(2e-3 * off_axis.offset.length());
            monitor.set_revision_threshold(threshold).unwrap();
        }
        let mut count = 0;
        for frame in 0..600 {
            let now = f64::from(frame) / 60.0;
            if is_told {
                let state = State::new(now, DVec3::Z * 1.7, DVec3::ZERO);
                let state = BodyState::from(state).with_spin(turning(now), 2.0 * DVec3::Z);
                monitor.track(now, [(id, state)]).unwrap();
            }
            count += tick(&mut monitor, now).len();
        }
        assert_eq!(count, 1, "{is_told}");
    }
}

/// A ship comes to rest at a dock. Another plan brings it there later: the least distance is the same, its instant is
/// not, and the reported one is no longer as near.
#[test]
fn another_instant_of_the_same_distance_is_an_event() {
    let coming = |arrival: f64| {
        let far = State::new(0.0, DVec3::X * 2.0, -0.1 * DVec3::X);
        let docked = |time: f64| State::new(time, DVec3::ZERO, DVec3::ZERO);
        Trajectory::from_states(&[far, docked(arrival), docked(100.0)]).unwrap()
    };
    let mut scene = Scene::new();
    let dock = Trajectory::at_rest(DVec3::ZERO).unwrap();
    scene.insert(Body::new(dock)).unwrap();
    let ship = scene.insert(Body::new(coming(20.0))).unwrap();
    let mut monitor = Monitor::new(scene, 0.0, 60.0, &[AlertLevel::at(3.0)]).unwrap();
    tick(&mut monitor, 1.0);
    // It begins inside, and lasts beyond the lookahead: only the closest approach can change.
    for arrival in [30.0, 25.0, 26.0] {
        monitor.set_trajectory(ship, coming(arrival)).unwrap();
        let now = monitor.now() + 0.5;
        let events = tick(&mut monitor, now);
        let [event] = &events[..] else {
            panic!("{events:?}")
        };
        let EventKind::Revised(encounter) = event.kind else {
            panic!("{event}")
        };
        assert!((encounter.closest.time - arrival).abs() < 1e-3, "{event}");
    }
}
