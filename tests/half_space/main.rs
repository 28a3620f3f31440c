//! Half-spaces, against exact heights in rational numbers.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

mod guards;
mod invariance;
mod monitor;
mod oracle;
mod together;
mod turning;

use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, Body, Conflict, Error, Hitbox, Layers, Orientation, Query, Scene, Sphere, State,
    Trajectory, Window,
};
use oracle::{Truth, exact, off, truths};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| rng.random_range(-half..=half)))
}

fn unit(rng: &mut ChaCha8Rng) -> DVec3 {
    match rng.random_range(0..4) {
        0 => [DVec3::X, DVec3::NEG_Y, DVec3::Z][rng.random_range(0..3)],
        _ => vector(rng, 1.0).normalize() * (1.0 + rng.random_range(-0.9e-9..0.9e-9)),
    }
}

/// A wandering plan over about 0..10 s.
fn plan(rng: &mut ChaCha8Rng, place: DVec3, reach: f64) -> Trajectory {
    let count = rng.random_range(2..6);
    let begin = rng.random_range(-1.0..1.0);
    let states: Vec<State> = (0..count)
        .map(|number| {
            let time = begin + 10.0 * f64::from(number) / f64::from(count - 1);
            State::new(time, place + vector(rng, reach), vector(rng, reach))
        })
        .collect();
    Trajectory::from_states(&states).unwrap()
}

fn cluster(rng: &mut ChaCha8Rng) -> Hitbox {
    let spheres = (0..rng.random_range(1..6)).map(|_| Sphere {
        offset: vector(rng, 1.5),
        radius: rng.random_range(0.0..0.5),
    });
    Hitbox::cluster(spheres.collect()).unwrap()
}

/// A plane and a body above, in, or below it.
fn pair(rng: &mut ChaCha8Rng) -> (Body, Body) {
    // Far along the plane, and far from the origin: neither must cost accuracy.
    let far = [0.0, 1e3, 1e6][rng.random_range(0..3)];
    let (origin, normal) = (vector(rng, far), unit(rng));
    let aside = vector(rng, 1.0).cross(normal) * [0.0, 1e2, 1e5][rng.random_range(0..3)];
    let reach = [0.0, 0.1, 3.0][rng.random_range(0..3)];
    let floor =
        Body::new(plan(rng, origin, reach)).with_hitbox(Hitbox::half_space(normal).unwrap());
    let height = rng.random_range(-6.0..6.0);
    let body = plan(rng, origin + aside + height * normal, 4.0);
    (floor, Body::new(body).with_hitbox(cluster(rng)))
}

fn screened(scene: &Scene, margin: f64, accuracy: Accuracy) -> Vec<Conflict> {
    let query = Query::default().with_margin(margin).with_accuracy(accuracy);
    scene.screen(&query).unwrap().conflicts
}

/// Certified conflicts hold the truth; the plain ones are close to it.
fn check(round: usize, truths: &[Truth], certified: &[Conflict], plain: &[Conflict], scale: f64) {
    let mut left: Vec<&Truth> = truths.iter().collect();
    for conflict in certified {
        let proof = conflict.certificate.unwrap();
        let (from, to) = (exact(proof.enter.earliest), exact(proof.exit.latest));
        let inside: Vec<&Truth> = left
            .iter()
            .copied()
            .filter(|truth| truth.enter <= to && truth.exit >= from)
            .collect();
        for truth in &inside {
            assert!(
                from <= truth.enter && truth.exit <= to,
                "{round} {conflict:?} {truth:?}"
            );
        }
        if proof.resolved {
            assert_eq!(inside.len(), 1, "{round} {conflict:?}");
            let truth = inside[0];
            assert!(
                truth.enter <= exact(proof.enter.latest),
                "{round} {conflict:?} {truth:?}"
            );
            assert!(
                exact(proof.exit.earliest) <= truth.exit,
                "{round} {conflict:?} {truth:?}"
            );
            let error = off(conflict.closest.separation, &truth.separation);
            assert!(
                error <= proof.error,
                "{round} {error:e} {conflict:?} {truth:?}"
            );
        }
        assert!(proof.error <= 1e-13 * scale + 1e-11, "{round} {proof:?}");
        left.retain(|truth| truth.enter > to || truth.exit < from);
    }
    assert!(left.is_empty(), "{round}: missed {left:?}");
    for truth in truths.iter().filter(|truth| !truth.is_touch) {
        let near = |conflict: &&Conflict| {
            off(conflict.closest.separation, &truth.separation) <= 1e-12 * scale + 1e-10
                && exact(conflict.enter) <= truth.exit
                && truth.enter <= exact(conflict.exit)
        };
        assert!(
            plain.iter().any(|conflict| near(&conflict)),
            "{round} {truth:?} {plain:?}"
        );
    }
}

/// No contact is lost, no enclosure fails, also where a body just touches the plane, above and below
/// it, with margins of either sign.
#[test]
fn conflicts_are_those_of_the_exact_heights() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let rng = &mut rng;
    let (mut count, mut touches, mut below) = (0, 0, 0);
    for round in 0..1_500 {
        let (floor, body) = pair(rng);
        let normal = floor.hitbox.normal().unwrap();
        let mut margin = rng.random_range(-2.0..2.0);
        let all = truths(&body, &floor, normal, 1e9);
        let Some(least) = all.iter().map(|truth| truth.separation.clone()).min() else {
            continue;
        };
        if round % 3 == 0 {
            // The least separation itself, or the number above or below.
            margin = least.to_f64().value();
            margin = [margin, margin.next_up(), margin.next_down()][round / 3 % 3];
        }
        let truths = truths(&body, &floor, normal, margin);
        let scale = body.trajectory.segments()[0].origin().abs().max_element();
        let mut scene = Scene::new();
        let bodies = if round % 2 == 0 {
            [floor, body]
        } else {
            [body, floor]
        };
        for body in bodies {
            scene.insert(body).unwrap();
        }
        let [certified, plain] =
            [Accuracy::Certified, Accuracy::Exact].map(|one| screened(&scene, margin, one));
        // Steps of positions far away are those of f64 there.
        check(round, &truths, &certified, &plain, scale.max(1.0));
        count += truths.len();
        touches += truths.iter().filter(|truth| truth.is_touch).count();
        below += usize::from(least.to_f64().value() < -3.0);
        let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
        let window = scene.planned().unwrap();
        let found = scene
            .certified_closest_approach(ids[0], ids[1], window)
            .unwrap()
            .unwrap();
        let error = off(found.approach.separation, &least);
        assert!(error <= found.error, "{round} {error:e} {found:?}");
        let found = scene
            .closest_approach(ids[0], ids[1], window)
            .unwrap()
            .unwrap();
        assert!(
            off(found.separation, &least) <= 1e-12 * scale.max(1.0) + 1e-10,
            "{round}"
        );
    }
    assert!(
        count > 1_200 && touches > 200 && below > 200,
        "{count} {touches} {below}"
    );
}

/// Closed answers: a ball that bounces off nothing sinks through a floor that rises.
#[test]
fn a_ball_and_a_rising_floor() {
    let fly = |place: DVec3, velocity: DVec3| {
        let states = [0.0, 8.0].map(|time| State::new(time, place + time * velocity, velocity));
        Body::new(Trajectory::from_states(&states).unwrap())
    };
    let mut scene = Scene::new();
    let floor = Hitbox::half_space(DVec3::Z).unwrap();
    scene
        .insert(fly(DVec3::ZERO, DVec3::Z).with_hitbox(floor))
        .unwrap();
    let ball = fly(DVec3::new(1e7, 3.0, 9.0), -DVec3::Z);
    scene
        .insert(ball.with_hitbox(Hitbox::sphere(1.0).unwrap()))
        .unwrap();
    let found = screened(&scene, 0.0, Accuracy::Exact);
    let numbers = found
        .iter()
        .map(|one| (one.enter, one.exit, one.closest.separation));
    assert_eq!(numbers.collect::<Vec<_>>(), [(4.0, 8.0, -8.0)]);
    // Below the plane the separation goes on falling, and a margin may ask for that.
    let found = screened(&scene, -5.0, Accuracy::Exact);
    assert_eq!((found.len(), found[0].enter), (1, 6.5));
    assert!(screened(&scene, -8.5, Accuracy::Exact).is_empty());
}

/// Two half-spaces never meet; layers and ignored pairs count as with spheres.
#[test]
fn filters_apply() {
    let rest = |height: f64| Body::new(Trajectory::at_rest(height * DVec3::Z).unwrap());
    let floor = |up: DVec3| rest(0.0).with_hitbox(Hitbox::half_space(up).unwrap());
    let mut scene = Scene::new();
    let a = scene.insert(floor(DVec3::Z)).unwrap();
    let b = scene.insert(floor(DVec3::NEG_Z)).unwrap();
    let query = Query::new(Window::new(0.0, 1.0).unwrap());
    assert!(scene.screen(&query).unwrap().conflicts.is_empty());
    let window = Window::new(0.0, 1.0).unwrap();
    assert_eq!(scene.closest_approach(a, b, window).unwrap(), None);
    let low = scene.insert(rest(-1.0)).unwrap();
    let found = scene.screen(&query).unwrap().conflicts;
    assert_eq!(
        found.iter().map(|one| (one.a, one.b)).collect::<Vec<_>>(),
        [(a, low)]
    );
    let asked = scene.closest_approach(low, b, window).unwrap().unwrap();
    assert!((asked.separation - 1.0).abs() <= 0.0);
    scene.ignore_pair(a, low).unwrap();
    assert!(scene.screen(&query).unwrap().conflicts.is_empty());
    scene.unignore_pair(a, low).unwrap();
    scene.set_layers(low, Layers::new(2, 2)).unwrap();
    scene.set_layers(a, Layers::new(1, 1)).unwrap();
    assert!(scene.screen(&query).unwrap().conflicts.is_empty());
    scene.set_layers(a, Layers::new(2, 2)).unwrap();
    assert_eq!(scene.screen(&query).unwrap().conflicts.len(), 1);
    // With only a margin that no radius could reach between spheres.
    let deep = scene.screen(&query.with_margin(-0.9)).unwrap();
    assert_eq!(deep.conflicts.len(), 1);
    scene.remove(a).unwrap();
    assert!(scene.screen(&query).unwrap().conflicts.is_empty());
}

/// A half-space that turns is refused wherever it could come from; nothing is changed.
#[test]
fn half_spaces_do_not_turn() {
    let is_refused = |result: Result<(), Error>| {
        assert!(matches!(
            result,
            Err(Error::InBody { body: 7, error, .. }) if *error == Error::TurningHalfSpace
        ));
    };
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::X).unwrap();
    let rest = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap()).with_tag(7);
    let floor = Hitbox::half_space(DVec3::Z).unwrap();
    let mut scene = Scene::new();
    let turning = rest.clone().with_orientation(spin.clone());
    is_refused(
        scene
            .insert(turning.clone().with_hitbox(floor.clone()))
            .map(drop),
    );
    let ship = scene.insert(turning).unwrap();
    is_refused(scene.set_hitbox(ship, floor.clone()).map(drop));
    let id = scene.insert(rest.with_hitbox(floor)).unwrap();
    is_refused(scene.set_orientation(id, spin).map(drop));
    let state = State::new(0.0, DVec3::ZERO, DVec3::ZERO);
    let told = nearmiss::BodyState::from(state).with_spin(DQuat::IDENTITY, DVec3::ZERO);
    is_refused(scene.update([(id, told)]));
    assert!(
        scene
            .body(id)
            .is_some_and(|body| body.orientation.is_fixed())
    );
    assert_eq!(scene.len(), 2);
    assert_eq!(
        scene.body(id).and_then(|body| body.spheres_at(0.0)),
        Some(Vec::new())
    );
}
