//! Rotations that are hardly any, and rotations in no time.

use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{Body, Hitbox, Orientation, Query, Sphere, State, Trajectory, Window, pair};

/// Two balls 10 m from the axis; a spin that comes to rest goes through all rates on its way.
#[test]
fn a_spin_that_nearly_rests_is_known() {
    let balls = [10.0, -10.0].map(|x| Sphere {
        offset: x * DVec3::X,
        radius: 0.1,
    });
    let rod = Hitbox::cluster(balls.to_vec()).unwrap();
    let passing =
        [0.0, 10.0].map(|time| State::new(time, DVec3::new(0.0, 5.0, time - 5.0), DVec3::Z));
    let passing = Body::new(Trajectory::from_states(&passing).unwrap())
        .with_hitbox(Hitbox::sphere(0.1).unwrap());
    let window = Window::new(0.0, 10.0).unwrap();
    // The ball passes 5 m from the axis.
    let expected = 125_f64.sqrt() - 0.2;
    for rate in [
        0.0, 5e-324, 1e-308, 2.3e-308, 3e-308, 3.4e-308, 3.6e-308, 1e-300,
    ] {
        let spin = Orientation::spin(0.0, DQuat::IDENTITY, rate * DVec3::Z).unwrap();
        let rod = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap())
            .with_hitbox(rod.clone())
            .with_orientation(spin);
        let nearest = pair::closest_approach(&rod, &passing, window).unwrap();
        let separation = nearest.unwrap().separation;
        assert!(
            (separation - expected).abs() < 0.03,
            "{rate} rad/s: {separation} m, not {expected} m"
        );
        let proven = pair::certified_closest_approach(&rod, &passing, window).unwrap();
        // Twice the tolerance of certified answers at the balls' distance.
        assert!(proven.unwrap().error <= 2.1e-5, "{rate} rad/s: {proven:?}");
        let query = Query::new(window).with_margin(0.5);
        assert!(pair::conflicts(&rod, &passing, &query).unwrap().is_empty());
    }
}

#[test]
fn a_quaternion_cubic_may_jump_between_knots_one_rounding_apart() {
    for degrees in [1.0_f64, 4.0, 5.0, 6.0, 20.0, 90.0] {
        for time in [1.0_f64, 1e6, 1.7e9] {
            let turned = DQuat::from_rotation_z(degrees.to_radians());
            let knots = [
                (time - 1.0, DQuat::IDENTITY),
                (time, DQuat::IDENTITY),
                (time.next_up(), turned),
                (time + 1.0, turned),
            ];
            let made = Orientation::normalized_cubic(&knots);
            assert!(made.is_ok(), "{degrees} degrees at {time} s: {made:?}");
        }
    }
}

/// Three thousand million rad/s: a spin would be refused.
#[test]
fn rotations_between_knots_may_be_fast() {
    let turned = DQuat::from_rotation_z(170_f64.to_radians());
    let knots = [(0.0, DQuat::IDENTITY), (1e-9, turned)];
    let ball = Sphere {
        offset: 10.0 * DVec3::X,
        radius: 0.1,
    };
    let half_way = DQuat::from_rotation_z(85_f64.to_radians()) * ball.offset;
    let there = Body::new(Trajectory::at_rest(half_way).unwrap());
    let window = Window::new(0.0, 1e-9).unwrap();
    for orientation in [
        Orientation::slerp(&knots),
        Orientation::normalized_cubic(&knots),
    ] {
        let arm = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap())
            .with_hitbox(Hitbox::cluster(vec![ball]).unwrap())
            .with_orientation(orientation.unwrap().with_tolerance(1e-6).unwrap());
        let nearest = pair::closest_approach(&arm, &there, window).unwrap();
        let nearest = nearest.unwrap();
        // Twice the tolerance at 10 m.
        assert!((nearest.separation + 0.1).abs() < 2e-5, "{nearest:?}");
        assert!((nearest.time - 0.5e-9).abs() < 1e-12, "{nearest:?}");
    }
}
