//! Simplified trajectories against exact arithmetic.

use super::distance;
use crate::error::Error;
use crate::rounding::exact::{Exact, number};
use crate::trajectory::exact_cubic::between_states;
use crate::trajectory::{Fit, Outside, Segment, State, TimeBase, Trajectory};
use dashu::rational::RBig;
use glam::DVec3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn made<T>(made: Result<T, Error>) -> T {
    made.unwrap_or_else(|error| unreachable!("{error}"))
}

/// Returns states of a motion that bends, rises and wavers, `rate` times a second for a minute.
fn flight(rate: u32, start: f64, far: f64) -> Vec<State> {
    let state = |step: u32| {
        let t = f64::from(step) / f64::from(rate);
        let ((sin, cos), (low, high)) = ((0.2 * t).sin_cos(), (0.05 * t * t).sin_cos());
        let position = DVec3::new(50.0 * cos + far, 50.0 * sin, 3.0 * low);
        let velocity = DVec3::new(-10.0 * sin, 10.0 * cos, 0.3 * t * high);
        State::new(start + t, position, velocity)
    };
    (0..=60 * rate).map(state).collect()
}

/// Returns the exact place between two instants on a cubic.
fn place(points: &[Exact; 4], time: &RBig, from: f64, to: f64) -> Exact {
    let share = (time - number(from)) / (number(to) - number(from));
    Exact::blossom(points, 0, &[share.clone(), share])
}

/// Returns how far the kept cubics are from the exact ones between states, at instants of each interval: within
/// `factor` errors or not.
fn is_within(fit: &Fit, states: &[State], factor: f64) -> bool {
    let plan = &fit.trajectory;
    let limit = number(fit.error()) * number(factor);
    states.windows(2).all(|pair| {
        let exact = between_states(&pair[0], &pair[1]);
        let after = plan.knots().partition_point(|&knot| knot <= pair[0].time);
        let segment = &plan.segments()[after - 1];
        let origin = Exact::of(segment.origin());
        let kept = segment
            .control_points()
            .map(|point| origin.plus(&Exact::of(point)));
        (0_u8..=7).all(|step| {
            let share = RBig::from(step) / RBig::from(7);
            let [from, to] = [pair[0].time, pair[1].time];
            let time = number(from) + (number(to) - number(from)) * share;
            let off = place(&kept, &time, segment.start(), segment.end())
                .minus(&place(&exact, &time, from, to));
            off.is_within_exactly(&limit)
        })
    })
}

/// The error is not exceeded, and not much larger than what occurs.
#[test]
fn the_error_holds() {
    for (start, far, tolerance) in [(0.0, 0.0, 1e-2), (1.7e9, 1e7, 1e-3), (-5.0, 1e3, 1.0)] {
        let states = flight(20, start, far);
        let plan = made(Trajectory::from_states(&states));
        let fit = made(plan.simplified(tolerance));
        assert!(fit.error() <= tolerance && fit.error() > 0.2 * tolerance && fit.is_proven());
        assert!(is_within(&fit, &states, 1.0));
        assert!(
            !is_within(&fit, &states, 0.5),
            "{tolerance}: a bound twice as large as need be"
        );
        // What is left has position and velocity of the motion at its knots.
        for state in &states {
            if fit.trajectory.knots().contains(&state.time) {
                let found = fit.trajectory.state(state.time).unwrap_or_default();
                assert!(found.position.distance(state.position) <= 2e-16 * far + 1e-13);
                assert!(found.velocity.distance(state.velocity) < 1e-12);
            }
        }
    }
}

/// Bounds of rounding are needed where rounding is the only difference.
#[test]
fn the_error_holds_for_rounding() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut merged = 0;
    for round in 0..60 {
        let far = [0.0, 1.0, 1e7][round % 3];
        let mut vector =
            |half: f64| DVec3::from_array([0; 3].map(|_| half * rng.random_range(-1.0..1.0)));
        let (from, velocity) = (vector(far), vector(1.0));
        let state = |step: u32| {
            let time = 0.1 * f64::from(step);
            State::new(time, from + velocity * time, velocity)
        };
        let states: Vec<State> = (0..40).map(state).collect();
        let fit = made(made(Trajectory::from_states(&states)).simplified(1e-14 + 2e-15 * far));
        merged += 39 - fit.trajectory.segments().len();
        assert!(is_within(&fit, &states, 1.0), "{states:?}");
    }
    assert!(merged > 300, "{merged}");
}

/// Two cubics that are kept alike may mean different ones, by the error of each.
#[test]
fn the_errors_of_both_count() {
    let with_error = |error: f64| {
        let points = [DVec3::X, DVec3::Y, DVec3::Z];
        made(Segment::from_control_points(
            (0.0, 4.0),
            DVec3::ONE,
            points,
            error,
            1,
        ))
    };
    let (one, other) = (with_error(0.25), with_error(0.5));
    for (from, to) in [(0.0, 4.0), (1.0, 2.0)] {
        let segment = &other;
        let found = distance(&one, segment, (from, to));
        assert!((0.75..0.75 + 1e-12).contains(&found), "{found}");
    }
}

/// A hundred states a second, where a few would do.
#[test]
fn a_track_shrinks() {
    let states = flight(100, 0.0, 0.0);
    let plan = made(Trajectory::from_states(&states));
    let counts = [1e-4, 1e-2, 1.0]
        .map(|tolerance| made(plan.simplified(tolerance)).trajectory.segments().len());
    println!("{} cubics, simplified: {counts:?}", plan.segments().len());
    assert!(
        counts[0] < 600 && counts[1] < 200 && counts[2] < 60,
        "{counts:?}"
    );
    // Long ones are quick, and become one.
    let line = |step: u32| State::new(f64::from(step), f64::from(step) * DVec3::X, DVec3::X);
    let straight = made(Trajectory::from_states(
        &(0..50_000).map(line).collect::<Vec<_>>(),
    ));
    let one = made(straight.simplified(1e-6));
    assert_eq!(one.trajectory.knots(), [0.0, 49_999.0]);
}

/// Beyond the knots nothing changes, nor do the ends.
#[test]
fn the_ends_stay() {
    let states = flight(20, 3.0, 0.0);
    let plan = made(Trajectory::from_states(&states));
    let (first, last) = (states[0].time, states[states.len() - 1].time);
    for outside in [Outside::Absent, Outside::Coast, Outside::Extrapolate] {
        let plan = plan.clone().with_outside(outside);
        let fit = made(plan.simplified(0.1));
        let simple = &fit.trajectory;
        assert!(simple.segments().len() * 5 < plan.segments().len());
        assert_eq!(simple.domain(), plan.domain());
        assert_eq!(simple.listed_domain(), plan.listed_domain());
        for time in [
            first - 7.0,
            first - 1e-3,
            first,
            last,
            last + 1e-3,
            last + 9.0,
        ] {
            assert_eq!(
                simple.position(time),
                plan.position(time),
                "{time} {outside:?}"
            );
        }
    }
}

/// A plan that lost its beginning is extrapolated by its first cubic.
#[test]
fn what_was_before_stays() {
    let states = flight(20, 0.0, 0.0);
    let trimmed = made(Trajectory::from_states(&states)).trimmed_before(10.01);
    let trimmed = trimmed.with_outside(Outside::Extrapolate);
    let simple = made(trimmed.simplified(0.1)).trajectory;
    assert!(simple.segments().len() * 5 < trimmed.segments().len());
    for step in 0..200 {
        let time = 0.1 * f64::from(step);
        let both = [&simple, &trimmed].map(|plan| plan.position(time));
        assert_eq!(both[0].is_some(), both[1].is_some());
        let apart = both[0].zip(both[1]).map_or(0.0, |(a, b)| a.distance(b));
        assert!(apart <= 0.1, "{time}: {apart}");
        if time < trimmed.knots()[0] {
            assert_eq!(both[0], both[1], "{time}");
        }
    }
}

/// A plan spliced into another one within a cubic of both: only parts of these are followed.
#[test]
fn parts_of_cubics() {
    let old = made(Trajectory::from_states(&flight(20, 0.0, 0.0)));
    let new = made(Trajectory::from_states(&flight(20, 0.013, 0.1)));
    let spliced = made(old.spliced(20.02, &new));
    let fit = made(spliced.simplified(0.02));
    assert!(fit.trajectory.segments().len() * 4 < spliced.segments().len());
    for step in 0..6000 {
        let time = 0.01 * f64::from(step);
        let apart = fit.trajectory.position(time).zip(spliced.position(time));
        assert!(
            apart.is_some_and(|(a, b)| a.distance(b) <= fit.error() + 1e-12),
            "{time}"
        );
    }
}

#[test]
fn jumps_stay_where_they_matter() {
    let corner = DVec3::new(100.0, 0.0, 0.0);
    let mut legs: Vec<_> = (0_u8..=10)
        .map(|k| (f64::from(k), f64::from(k) / 10.0 * corner))
        .collect();
    legs.extend((1_u8..=10).map(|k| (10.0 + f64::from(k), corner + 5.0 * f64::from(k) * DVec3::Y)));
    let plan = made(Trajectory::from_waypoints(&legs));
    let simple = made(plan.simplified(1e-9)).trajectory;
    assert_eq!(simple.knots(), [0.0, 10.0, 20.0]);
    // A corner less sharp than the tolerance is merged over.
    let bent = [
        (0.0, DVec3::ZERO),
        (10.0, corner),
        (20.0, 2.0 * corner + 0.1 * DVec3::Y),
    ];
    let plan = made(Trajectory::from_waypoints(&bent));
    let fit = made(plan.simplified(0.1));
    assert_eq!(fit.trajectory.knots(), [0.0, 20.0]);
    assert!(fit.error() > 0.01, "{}", fit.error());

    // Positions that jump.
    let still = |x: f64| [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, x * DVec3::X];
    let stairs = [still(0.0), still(0.0), still(5.0), still(5.0)];
    let knots = [0.0, 1.0, 2.0, 3.0, 4.0];
    let plan = made(Trajectory::from_coefficients(
        &knots,
        &stairs,
        TimeBase::SegmentLocal,
    ));
    let fit = made(plan.simplified(1.0));
    assert_eq!(fit.trajectory.knots(), [0.0, 2.0, 4.0]);
    assert_eq!(fit.trajectory.position(2.0), Some(5.0 * DVec3::X));
    assert!(fit.error() < 1e-12);
    // Merged over, the place before the jump is the farthest: 5 m (3 s² - 2 s³) at s = 2/3.
    let plan = Trajectory::from_coefficients(&knots[..4], &stairs[..3], TimeBase::SegmentLocal);
    let fit = made(made(plan).simplified(4.0));
    assert_eq!(fit.trajectory.knots(), [0.0, 3.0]);
    assert!(
        (fit.error() - 100.0 / 27.0).abs() < 1e-12,
        "{}",
        fit.error()
    );
}

#[test]
fn what_cannot_be_simplified() {
    let plan = made(Trajectory::from_states(&flight(1, 0.0, 0.0)));
    for plan in [
        plan,
        made(Trajectory::at_rest(DVec3::X)),
        made(Trajectory::coasting(State::new(3.0, DVec3::X, DVec3::Y))),
    ] {
        let fit = made(plan.simplified(1e-12));
        assert_eq!((&fit.trajectory, fit.error()), (&plan, 0.0));
    }
}
