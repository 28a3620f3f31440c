//! Velocities that follow from positions.

use super::{ROUNDS, made, times, vector};
use crate::trajectory::{PositionOptions, Trajectory};
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// No coordinate leaves the range of the two positions between which it is; without the limit some do.
#[test]
fn limited_velocities_do_not_overshoot() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let limited = PositionOptions::new().with_limited_velocities();
    let (mut beyond, mut same) = (0, 0);
    for round in 0..ROUNDS {
        let count = rng.random_range(2..9);
        let times = times(&mut rng, round, count);
        // Often at rest on an axis, and of very different speeds.
        let mut place = DVec3::ZERO;
        let mut positions = Vec::new();
        for time in times {
            positions.push((time, place));
            let size = 10_f64.powi(rng.random_range(-2..3));
            let moves = [0; 3].map(|_| f64::from(rng.random_bool(0.8)));
            place += vector(&mut rng, size) * DVec3::from_array(moves);
        }
        let free = made(Trajectory::from_positions(&positions));
        let held = made(Trajectory::from_positions_with(&positions, &limited));
        let overshoot = |plan: &Trajectory| {
            let mut most = f64::NEG_INFINITY;
            for pair in positions.windows(2) {
                let (low, high) = (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1));
                for step in 0..=40 {
                    let time = pair[0].0 + (pair[1].0 - pair[0].0) * f64::from(step) / 40.0;
                    let found = plan.position(time.min(pair[1].0)).unwrap_or(DVec3::NAN);
                    most = most.max((low - found).max(found - high).max_element());
                }
            }
            most
        };
        assert!(overshoot(&held) < 1e-12, "{positions:?}");
        beyond += usize::from(overshoot(&free) > 1e-3);
        same += usize::from(free == held);
    }
    assert!(beyond > 200 && same > 10, "{beyond} {same}");
}

#[test]
fn velocities_at_the_ends() {
    let positions = [
        (0.0, DVec3::ZERO),
        (1.0, DVec3::X),
        (3.0, DVec3::Y),
        (4.0, DVec3::Z),
    ];
    let [first, last] = [DVec3::new(9.0, -8.0, 7.0), DVec3::new(-1.0, 2.0, 0.0)];
    let options = PositionOptions::new()
        .with_first_velocity(first)
        .with_last_velocity(last);
    // Velocities are good to some roundings.
    let is_near = |found: Option<DVec3>, meant: DVec3| {
        found.is_some_and(|found| found.distance(meant) < 1e-14)
    };
    for options in [options, options.with_limited_velocities()] {
        let plan = made(Trajectory::from_positions_with(&positions, &options));
        assert!(is_near(plan.velocity(0.0), first));
        assert!(is_near(plan.velocity(4.0), last));
    }
    let plan = made(Trajectory::from_positions_with(&positions, &options));
    let free = made(Trajectory::from_positions(&positions));
    assert_eq!(plan.segments()[1], free.segments()[1]);
    let two = made(Trajectory::from_positions_with(&positions[..2], &options));
    assert!(is_near(two.velocity(0.0), first) && is_near(two.velocity(1.0), last));
}
