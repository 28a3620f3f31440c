//! The same conflicts whatever the window, the slices, the threads, the order of bodies, and where
//! the world is.

#[path = "../support/mod.rs"]
mod support;

use super::{cluster, plan, vector};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, Body, Conflict, Hitbox, Orientation, Outside, Query, Scene, State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use support::{bits, on_threads, rng, sliced};

/// A floor, a ceiling that moves, a slope, and a crowd of all kinds between them.
pub(crate) fn bodies(rng: &mut ChaCha8Rng, count: usize) -> Vec<Body> {
    let slope = Hitbox::half_space(DVec3::new(1.0, 2.0, 2.0) / 3.0).unwrap();
    let lift = State::new(0.0, 9.0 * DVec3::Z, -0.3 * DVec3::Z);
    let floor = Body::new(Trajectory::at_rest(-6.0 * DVec3::Z).unwrap());
    let ceiling = Body::new(Trajectory::coasting(lift).unwrap());
    let third = plan(rng, DVec3::splat(-8.0), 0.5).with_outside(Outside::Coast);
    let mut bodies = vec![
        floor.with_hitbox(Hitbox::half_space(DVec3::Z).unwrap()),
        ceiling.with_hitbox(Hitbox::half_space(DVec3::NEG_Z).unwrap()),
        Body::new(third).with_hitbox(slope),
    ];
    bodies.extend((0..count).map(|_| body(rng)));
    bodies
}

pub(crate) fn body(rng: &mut ChaCha8Rng) -> Body {
    let place = vector(rng, 9.0);
    let plan = match rng.random_range(0..4) {
        0 => {
            let state = State::new(0.0, place, vector(rng, 2.0));
            Trajectory::coasting(state).unwrap()
        }
        1 => plan(rng, place, 3.0).with_outside(Outside::Coast),
        _ => plan(rng, place, 3.0),
    };
    let body = Body::new(plan);
    match rng.random_range(0..3) {
        0 => body.with_hitbox(Hitbox::sphere(rng.random_range(0.0..0.5)).unwrap()),
        1 => body.with_hitbox(cluster(rng)),
        _ => {
            let turn = Orientation::spin(0.0, DQuat::IDENTITY, vector(rng, 3.0)).unwrap();
            body.with_hitbox(cluster(rng)).with_orientation(turn)
        }
    }
}

fn scene_of(bodies: &[Body]) -> Scene {
    let mut scene = Scene::new();
    for (tag, body) in (0..).zip(bodies) {
        scene.insert(body.clone().with_tag(tag)).unwrap();
    }
    scene
}

#[test]
fn slices_threads_and_windows_change_no_bit() {
    let scene = scene_of(&bodies(&mut rng(5), 400));
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let query = |from: f64, to: f64| {
            Query::new(Window::new(from, to).unwrap())
                .with_margin(0.25)
                .with_accuracy(accuracy)
        };
        let all = scene.screen(&query(0.0, 8.0)).unwrap().conflicts;
        let with_planes = all.iter().filter(|one| one.tag_a < 3).count();
        assert!(with_planes > 150, "{with_planes}");
        for slices in [1, 7, 100] {
            let found = scene.screen(&sliced(query(0.0, 8.0), slices)).unwrap();
            assert_eq!(bits(&found.conflicts), bits(&all), "{slices}");
        }
        for threads in [1, 2, 5] {
            let found = on_threads(threads, || scene.screen(&query(0.0, 8.0)).unwrap());
            assert_eq!(bits(&found.conflicts), bits(&all), "{threads}");
        }
        if accuracy == Accuracy::Certified {
            // A window that cuts a span has enclosures of its own.
            continue;
        }
        let part = scene.screen(&query(2.5, 6.5)).unwrap().conflicts;
        let inside = |one: &&Conflict| one.enter > 2.5 && one.exit < 6.5;
        let both = [&part, &all].map(|some| {
            let inside: Vec<Conflict> = some.iter().filter(inside).copied().collect();
            bits(&inside)
        });
        assert_eq!(both[0], both[1]);
        assert!(both[0].len() > 20);
    }
}

/// Conflicts by the tags of their bodies, with times and separation, and the half-space first.
fn named(scene: &Scene) -> Vec<(u64, u64, [f64; 3])> {
    let query = Query::new(Window::new(0.0, 8.0).unwrap()).with_margin(0.25);
    let found = scene.screen(&query).unwrap().conflicts;
    let mut named: Vec<(u64, u64, [f64; 3])> = found
        .iter()
        .map(|one| {
            let (a, b) = (one.tag_a.min(one.tag_b), one.tag_a.max(one.tag_b));
            (a, b, [one.enter, one.exit, one.closest.separation])
        })
        .collect();
    named.sort_by(|x, y| (x.0, x.1).cmp(&(y.0, y.1)).then(x.2[0].total_cmp(&y.2[0])));
    named
}

/// Bodies in the opposite order, and the whole world elsewhere and turned.
#[test]
fn neither_order_nor_place_matters() {
    let list = bodies(&mut rng(6), 200);
    let expected = named(&scene_of(&list));
    let mut reversed = Scene::new();
    let tagged: Vec<(u64, &Body)> = (0..).zip(&list).collect();
    for &(tag, body) in tagged.iter().rev() {
        reversed.insert(body.clone().with_tag(tag)).unwrap();
    }
    assert_eq!(named(&reversed), expected);
    let (turn, shift) = (DQuat::from_rotation_y(0.7), DVec3::new(2e3, -5e3, 1e3));
    let moved: Vec<Body> = list
        .iter()
        // Orientations of turning bodies stay as they are.
        .filter(|body| body.orientation.is_fixed())
        .map(|body| {
            let knots = body.trajectory.knots();
            let state = |time: f64| {
                let place = body.trajectory.position(time).unwrap();
                let velocity = body.trajectory.velocity(time).unwrap();
                State::new(time, turn * place + shift, turn * velocity)
            };
            let plan = match knots {
                [only] => Trajectory::coasting(state(*only)),
                knots => {
                    let states: Vec<State> = knots.iter().map(|&time| state(time)).collect();
                    Trajectory::from_states(&states)
                }
            };
            let plan = plan.unwrap().with_outside(body.trajectory.outside_after());
            let hitbox = match body.hitbox.normal() {
                Some(normal) => Hitbox::half_space((turn * normal).normalize()),
                None => Hitbox::cluster(
                    body.hitbox
                        .spheres()
                        .iter()
                        .map(|sphere| nearmiss::Sphere {
                            offset: turn * sphere.offset,
                            ..*sphere
                        })
                        .collect(),
                ),
            };
            Body::new(plan).with_hitbox(hitbox.unwrap())
        })
        .collect();
    let fixed: Vec<Body> = list
        .into_iter()
        .filter(|body| body.orientation.is_fixed())
        .collect();
    let (expected, found) = (named(&scene_of(&fixed)), named(&scene_of(&moved)));
    assert_eq!(found.len(), expected.len());
    assert!(found.len() > 100);
    for (one, other) in found.iter().zip(&expected) {
        assert_eq!((one.0, one.1), (other.0, other.1));
        for (x, y) in one.2.iter().zip(other.2) {
            assert!((x - y).abs() < 1e-6, "{one:?} {other:?}");
        }
    }
}
