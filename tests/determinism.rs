//! The same bits for any number of threads, every broad-phase method, instruction set and
//! slicing.

#![cfg(feature = "parallel")]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::{DQuat, DVec3};
use nearmiss::internals::{InstructionSet, Method, QueryInternals};
use nearmiss::{
    Accuracy, Body, BodyState, Conflict, Hitbox, Query, Scene, Sphere, State, Trajectory, Window,
};
use std::ops::ControlFlow;
use support::{hash, on_threads, rng, scene_of, sliced, swarm, vector};

#[test]
fn threads_methods_instructions_and_slices() {
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        // One begins and ends before most of the conflicts do: its first and last slices matter.
        for window in [Window::ALL, Window::new(6.0, 12.0).unwrap()] {
            let mut scene = scene_of(&swarm(11, 150, 60.0));
            let splines = scene.len();
            // They go on for ever: no window of all time has an end for them.
            if window.is_closed() {
                add_straight(&mut scene);
            }
            let query = Query::new(window).with_accuracy(accuracy);
            let query = query.with_margin(1.0);
            let found = scene.screen(&query).unwrap().conflicts;
            let is_straight = |one: &&Conflict| one.b.slot() as usize >= splines;
            let count = found.iter().filter(is_straight).count();
            assert!(count > 20 || !window.is_closed(), "{count}");
            one_answer_to(&scene, &query);
        }
    }
}

/// Adds bodies that rest, coast, and are told where they are: for the past, for the future, with a spin.
fn add_straight(scene: &mut Scene) {
    let mut rng = rng(12);
    for number in 0..60 {
        let place = vector(&mut rng, 20.0);
        let state = State::new(
            [-1e3, 7.0, 9.0, 40.0][number % 4],
            place,
            vector(&mut rng, 3.0),
        );
        let motion = match number % 3 {
            0 => Trajectory::at_rest(place),
            1 => Trajectory::coasting(State::new(9.0, place, state.velocity)),
            _ => Trajectory::at_rest(DVec3::ZERO),
        };
        let arms = [-1.0, 1.0].map(|x| Sphere::new(x * DVec3::X, 0.5));
        let body = Body::new(motion.unwrap()).with_hitbox(Hitbox::cluster(arms.to_vec()).unwrap());
        let id = scene.insert(body).unwrap();
        if number % 3 == 2 {
            let mut told = BodyState::from(State::new(state.time, place, state.velocity / 1e3));
            if number % 2 == 0 {
                told = told.with_spin(DQuat::IDENTITY, vector(&mut rng, 2.0));
            }
            scene.update([(id, told)]).unwrap();
        }
    }
}

fn one_answer_to(scene: &Scene, query: &Query) {
    let mut reference = None;
    for threads in 1..=4 {
        on_threads(threads, || {
            for method in Method::EVERY {
                for instructions in InstructionSet::available() {
                    for slices in [0, 1, 7, 100] {
                        let by = query.with_method(method).with_instruction_set(instructions);
                        let answer = scene.screen(&sliced(by, slices)).unwrap();
                        assert!(!answer.conflicts.is_empty());
                        let found = hash(&answer.conflicts);
                        let expected = *reference.get_or_insert(found);
                        let by = (method, threads, instructions, slices);
                        assert_eq!(found, expected, "{by:?}, {query:?}");
                    }
                }
            }
        });
    }
}

/// Whatever there is to do: from any thread, and at the end that all is done.
#[test]
fn progress_ends_with_one() {
    let bodies = swarm(3, 200, 100.0);
    for count in [0, 1, 200] {
        let scene = scene_of(&bodies[..count]);
        let told = std::sync::Mutex::new(Vec::new());
        let query = Query::default().with_margin(1.0);
        let tell = |share: f64| {
            told.lock().unwrap().push(share);
            ControlFlow::Continue(())
        };
        scene.screen_with_progress(&query, tell).unwrap();
        let told = told.into_inner().unwrap();
        let (last, before) = told.split_last().unwrap();
        assert!(*last >= 1.0);
        assert!(
            before.iter().all(|share| (0.0..1.0).contains(share)),
            "{told:?}"
        );
    }
}
