//! Curves against exact arithmetic: what is kept is as near the curve meant as the error bounds say.

mod b_splines;
mod positions;
mod refused;

use super::Keyframe;
use crate::error::Error;
use crate::rounding::exact::{Exact, number, vector};
use crate::trajectory::{Outside, Segment, State, Trajectory, exact_cubic};
use dashu::rational::RBig;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const ROUNDS: u32 = 300;

/// Near and far from the origin, and now and then without any motion.
fn points(rng: &mut ChaCha8Rng, round: u32, count: usize) -> Vec<DVec3> {
    let size = [1.0, 1e-3, 1e5, 0.0][round as usize % 4];
    let around = vector(rng, [0.0, 1.0, 1e7][round as usize % 3]);
    (0..count).map(|_| around + vector(rng, size)).collect()
}

/// Increasing instants, near and far from 0.
fn times(rng: &mut ChaCha8Rng, round: u32, count: usize) -> Vec<f64> {
    let mut time = [0.0, -3.7, 1.7e9][round as usize / 2 % 3];
    let mut next = || {
        time += rng.random_range(0.1..3.0);
        time
    };
    (0..count).map(|_| next()).collect()
}

fn made(plan: Result<Trajectory, Error>) -> Trajectory {
    plan.unwrap_or_else(|error| unreachable!("{error}"))
}

/// Returns an instant's place between two others: 0 and 1 there.
fn share(time: f64, (from, to): (f64, f64)) -> RBig {
    (number(time) - number(from)) / (number(to) - number(from))
}

/// Asserts the error of a segment's control points, and that it is some roundings.
fn assert_points(segment: &Segment, exact: &[Exact; 4]) {
    exact_cubic::assert_within(segment, segment.control_points(), exact, segment.error());
    let size = segment.origin().length() + segment.extent();
    assert!(
        segment.error() <= 4.0 * f64::EPSILON * size + 1e-300,
        "{segment:?}"
    );
}

/// Asserts the end motions of a plan whose first and last cubic have these control points.
fn assert_ends(plan: &Trajectory, first: &[Exact; 4], last: &[Exact; 4]) {
    for durations in [0.5, 2.5] {
        exact_cubic::assert_ends(plan, first, last, durations);
    }
}

#[test]
fn legs_are_straight() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for round in 0..ROUNDS {
        let count = rng.random_range(2..6);
        let (times, places) = (
            times(&mut rng, round, count),
            points(&mut rng, round, count),
        );
        let waypoints: Vec<_> = times.into_iter().zip(places).collect();
        let plan = made(Trajectory::from_waypoints(&waypoints));
        let exact: Vec<[Exact; 4]> = waypoints
            .windows(2)
            .map(|pair| {
                let from = Exact::of(pair[0].1);
                let way = Exact::of(pair[1].1).minus(&from);
                [0_u8, 1, 2, 3]
                    .map(|thirds| from.plus(&way.times(&(RBig::from(thirds) / RBig::from(3)))))
            })
            .collect();
        for (segment, exact) in plan.segments().iter().zip(&exact) {
            assert!(segment.is_straight());
            assert_points(segment, exact);
        }
        assert_ends(&plan, &exact[0], &exact[count - 2]);
        let coasts = plan.clone().with_outside(Outside::Coast);
        for &(time, position) in &waypoints {
            let found = coasts.position(time);
            assert_eq!(found, Some(position));
        }
    }
}

#[cfg(feature = "serde")]
#[test]
fn legs_in_files() {
    let corner = DVec3::new(0.1, 0.7, -1e3);
    let legs = [
        (0.3, DVec3::ZERO),
        (1.7, corner),
        (2.0, corner),
        (7.1, DVec3::X),
    ];
    let plan = made(Trajectory::from_waypoints(&legs));
    let text = serde_json::to_string(&plan).unwrap_or_default();
    assert_eq!(serde_json::from_str::<Trajectory>(&text).ok(), Some(plan));
}

#[test]
fn bezier_pieces() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for round in 0..ROUNDS {
        let count = rng.random_range(1..4);
        let knots = times(&mut rng, round, count + 1);
        let all = points(&mut rng, round, 3 * count + 1);
        let pieces: Vec<[DVec3; 4]> = (0..count)
            .map(|piece| [0, 1, 2, 3].map(|point| all[3 * piece + point]))
            .collect();
        let plan = made(Trajectory::from_bezier(&knots, &pieces));
        assert_eq!(plan.knots(), knots);
        let exact: Vec<_> = pieces.iter().map(|piece| piece.map(Exact::of)).collect();
        for (segment, exact) in plan.segments().iter().zip(&exact) {
            assert_points(segment, exact);
            // The way of each point is rounded once.
            assert!(segment.error() <= 0.6 * f64::EPSILON * segment.extent() + 1e-300);
        }
        assert_ends(&plan, &exact[0], &exact[count - 1]);
    }
}

#[test]
fn keyframes_with_two_tangents() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for round in 0..ROUNDS {
        let count = rng.random_range(2..5);
        let (times, places) = (
            times(&mut rng, round, count),
            points(&mut rng, round, count),
        );
        let frames: Vec<Keyframe> = times
            .into_iter()
            .zip(places)
            .map(|(time, place)| {
                Keyframe::new(time, vector(&mut rng, 2.0), place, vector(&mut rng, 2.0))
            })
            .collect();
        let plan = made(Trajectory::from_keyframes(&frames));
        let exact: Vec<[Exact; 4]> = frames
            .windows(2)
            .map(|pair| exact_cubic::between_states(&pair[0].leaving(), &pair[1].arriving()))
            .collect();
        for (segment, exact) in plan.segments().iter().zip(&exact) {
            assert_points(segment, exact);
        }
        assert_ends(&plan, &exact[0], &exact[count - 2]);
        // With one tangent they are states.
        let smooth: Vec<Keyframe> = frames
            .iter()
            .map(|frame| Keyframe {
                in_tangent: frame.out_tangent,
                ..*frame
            })
            .collect();
        let states: Vec<State> = smooth
            .iter()
            .map(|frame| State::new(frame.time, frame.position, frame.in_tangent))
            .collect();
        assert_eq!(
            Trajectory::from_keyframes(&smooth),
            Trajectory::from_states(&states)
        );
    }
}
