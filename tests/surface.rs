//! What a user makes, reads back and prints.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "what was set is what is read; a plan that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::{DVec3, Vec3};
use nearmiss::{
    AlertLevel, Body, Error, Monitor, Outside, RevisionThreshold, Scene, State, Trajectory,
};

#[test]
fn states_from_what_a_program_has() {
    let state = State::new(1.0, DVec3::new(0.5, 2.0, -3.0), DVec3::X);
    assert_eq!(State::new(1.0, [0.5, 2.0, -3.0], [1.0, 0.0, 0.0]), state);
    assert_eq!(State::new(1.0, (0.5, 2.0, -3.0), (1.0, 0.0, 0.0)), state);
    assert_eq!(State::new(1.0, Vec3::new(0.5, 2.0, -3.0), Vec3::X), state);
    // Each f32 is taken exactly, not by its decimals.
    let tenth = State::new(0.0, Vec3::splat(0.1), Vec3::ZERO);
    assert_eq!(tenth.position, DVec3::splat(f64::from(0.1_f32)));
}

/// The state is what position and velocity are, and there is one where they are.
#[test]
fn a_state_of_a_trajectory() {
    let states = support::wander(&mut support::rng(4), 0.0, 6, 1.5, 20.0, 5.0);
    let plan = Trajectory::from_states(&states).unwrap();
    let last = plan.knots()[plan.knots().len() - 1];
    for outside in [Outside::Absent, Outside::Coast, Outside::Extrapolate] {
        let plan = plan.clone().with_outside(outside);
        for state in &states {
            let found = plan.state(state.time).unwrap();
            assert_eq!((found.time, found.position), (state.time, state.position));
            // A velocity is good to some roundings.
            assert!(found.velocity.distance(state.velocity) < 1e-14);
        }
        for step in -10..40 {
            let time = 0.25 * f64::from(step);
            let state = plan.state(time);
            let exists = outside != Outside::Absent || (0.0..=last).contains(&time);
            assert_eq!(state.is_some(), exists, "{time} {outside:?}");
            assert_eq!(state.map(|it| it.position), plan.position(time));
            assert_eq!(state.map(|it| it.velocity), plan.velocity(time));
            assert!(state.is_none_or(|it| it.time == time));
        }
        for time in [f64::NAN, f64::INFINITY] {
            assert_eq!(plan.state(time), None);
        }
    }
}

#[test]
fn what_a_monitor_was_told() -> Result<(), Error> {
    let levels = [
        AlertLevel::at(3.0),
        AlertLevel {
            margin: 1.0,
            release: 2.0,
        },
    ];
    let mut scene = Scene::new();
    scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    let mut monitor = Monitor::new(scene, 5.0, 7.5, &levels)?;
    assert_eq!((monitor.lookahead(), monitor.levels()), (7.5, &levels[..]));
    assert_eq!(monitor.max_spans(), Monitor::MAX_SPANS);
    let revision_threshold = RevisionThreshold {
        time: 0.25,
        separation: 0.5,
    };
    monitor.set_history(3.0)?;
    monitor.set_max_spans(77);
    monitor.set_revision_threshold(revision_threshold)?;
    for tick in 0..3 {
        let told = (monitor.history(), monitor.max_spans());
        assert_eq!(told, (3.0, 77));
        assert_eq!(monitor.revision_threshold(), revision_threshold);
        monitor.advance(6.0 + f64::from(tick), &mut Vec::new())?;
    }
    assert_eq!((monitor.lookahead(), monitor.levels()), (7.5, &levels[..]));
    Ok(())
}
