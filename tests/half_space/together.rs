//! Half-spaces with model errors, and in questions about one body.

use super::{cluster, plan};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, AlertLevel, Body, Error, Hitbox, Monitor, Orientation, Query, Scene, State,
    Trajectory, Window, pair,
};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

fn floor(model_error: f64) -> Body {
    let plan = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let hitbox = Hitbox::half_space(DVec3::Z).unwrap();
    let body = Body::new(plan).with_hitbox(hitbox);
    body.with_model_error(model_error).unwrap()
}

fn falling(model_error: f64) -> Body {
    let state = State::new(0.0, DVec3::new(0.0, 0.0, 11.0), -DVec3::Z);
    let body = Body::new(Trajectory::coasting(state).unwrap());
    let body = body.with_hitbox(Hitbox::sphere(1.0).unwrap());
    body.with_model_error(model_error).unwrap()
}

/// The errors of both widen the margin, whoever is the half-space.
#[test]
fn model_errors_of_both_count() {
    let query = Query::new(Window::new(0.0, 20.0).unwrap()).with_margin(2.0);
    for (ground, ball) in [(0.0, 0.0), (0.5, 0.0), (0.0, 0.25), (0.5, 0.25)] {
        let (ground, ball) = (floor(ground), falling(ball));
        let sum = ground.model_error() + ball.model_error();
        for order in [[&ground, &ball], [&ball, &ground]] {
            let found = pair::conflicts(order[0], order[1], &query).unwrap();
            assert_eq!(found.len(), 1);
            assert!(
                (found[0].enter - (8.0 - sum)).abs() < 1e-12,
                "{sum}: {found:?}"
            );
            assert!((found[0].closest.model_error - sum).abs() < 1e-12);
            let certified = query.with_accuracy(Accuracy::Certified);
            let proof = pair::conflicts(order[0], order[1], &certified).unwrap()[0]
                .certificate
                .unwrap();
            assert!(proof.resolved);
            assert!(proof.enter.earliest <= 8.0 - sum && 8.0 + sum <= proof.enter.latest);
            let mut scene = Scene::new();
            for body in order {
                scene.insert(body.clone()).unwrap();
            }
            assert_eq!(scene.screen(&query).unwrap().conflicts, found);
            let mut monitor = Monitor::new(scene, 0.0, 20.0, &[AlertLevel::at(2.0)]).unwrap();
            monitor.advance(0.0, &mut Vec::new()).unwrap();
            assert_eq!(monitor.conflicts(0).unwrap(), found);
        }
    }
}

/// A ball that stays 2.4 m above the floor is within 2 m only by the errors, wherever they are.
#[test]
fn a_body_that_hovers() {
    let query = Query::new(Window::new(0.0, 20.0).unwrap()).with_margin(2.0);
    for (ground, ball, count) in [(0.0, 0.0, 0), (0.5, 0.0, 1), (0.0, 0.5, 1), (0.25, 0.25, 1)] {
        let mut above = falling(ball);
        above.trajectory = Trajectory::at_rest(DVec3::new(5.0, 0.0, 3.4)).unwrap();
        let ground = floor(ground);
        assert_eq!(
            pair::conflicts(&ground, &above, &query).unwrap().len(),
            count
        );
        let mut scene = Scene::new();
        scene.insert(ground).unwrap();
        scene.insert(above).unwrap();
        assert_eq!(scene.screen(&query).unwrap().conflicts.len(), count);
        let mut monitor = Monitor::new(scene, 0.0, 20.0, &[AlertLevel::at(2.0)]).unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        assert_eq!(monitor.conflicts(0).unwrap().len(), count);
    }
}

/// Half-spaces that are asked about together do not meet each other; a ball that is asked about with them does.
#[test]
fn half_spaces_asked_about_together() {
    let mut scene = Scene::new();
    let mut insert = |body: Body| scene.insert(body).unwrap();
    let walls = [insert(floor(0.0)), insert(floor(0.0))];
    let ball = insert(falling(0.0));
    let mut monitor = Monitor::new(scene, 0.0, 20.0, &[AlertLevel::at(1.0)]).unwrap();
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    let place = |height: f64| Trajectory::at_rest(height * DVec3::Z).unwrap();
    let (low, high) = (place(1.0), place(100.0));
    // Both walls far above the ball contain it.
    let plans = [(walls[0], &high), (walls[1], &high), (ball, &low)];
    let would = monitor.what_if_plans(plans, 0).unwrap();
    let pairs: Vec<_> = would.iter().map(|one| (one.a, one.b)).collect();
    assert_eq!(pairs, [(walls[0], ball), (walls[1], ball)]);
    // Now the ball is far above them.
    let plans = [(ball, &high), (walls[1], &low), (walls[0], &low)];
    assert_eq!(monitor.what_if_plans(plans, 0).unwrap(), []);
}

/// Asking about a body that is not there gives what inserting it would give.
#[test]
fn one_against_all() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let window = Window::new(0.0, 10.0).unwrap();
    let query = Query::new(window).with_margin(0.3);
    for round in 0..40 {
        let mut scene = Scene::new();
        for _ in 0..12 {
            let body = Body::new(plan(&mut rng, DVec3::ZERO, 4.0)).with_hitbox(cluster(&mut rng));
            scene.insert(body).unwrap();
        }
        let mut asked = floor(0.0);
        if round % 2 == 0 {
            scene.insert(asked).unwrap();
            asked = Body::new(plan(&mut rng, DVec3::ZERO, 4.0)).with_hitbox(cluster(&mut rng));
        }
        let alone = scene.conflicts_with(&asked, &query).unwrap();
        let mut with = scene.clone();
        let id = with.insert(asked.clone()).unwrap();
        let mut expected = with.screen(&query).unwrap().conflicts;
        expected.retain(|one| one.a == id || one.b == id);
        assert_eq!(alone, expected, "{round}");
    }
}

/// Two half-spaces do not meet, and none turns, whoever asks.
#[test]
fn what_cannot_be_asked() {
    let window = Window::new(0.0, 1.0).unwrap();
    let query = Query::new(window);
    let (one, other) = (floor(0.0), floor(0.0));
    assert!(pair::conflicts(&one, &other, &query).unwrap().is_empty());
    assert_eq!(pair::closest_approach(&one, &other, window), Ok(None));
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::X).unwrap();
    let turning = floor(0.0).with_orientation(spin).with_tag(7);
    let refused = Error::TurningHalfSpace;
    let is_refused =
        |error: Error| matches!(error, Error::InBody { body: 7, error, .. } if *error == refused);
    assert!(is_refused(
        pair::conflicts(&turning, &other, &query).unwrap_err()
    ));
    assert!(is_refused(
        Scene::new().conflicts_with(&turning, &query).unwrap_err()
    ));
    let monitor = Monitor::new(Scene::new(), 0.0, 1.0, &[AlertLevel::at(0.0)]).unwrap();
    assert!(is_refused(monitor.what_if_body(&turning, 0).unwrap_err()));
}
