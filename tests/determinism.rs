//! The same bits for any number of threads, every broad-phase method, instruction set and
//! slicing.

#![cfg(feature = "parallel")]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::internals::InstructionSet;
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Accuracy, Query, Window};
use std::ops::ControlFlow;
use support::{hash, on_threads, scene_of, sliced, swarm};

#[test]
fn threads_methods_instructions_and_slices() {
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        // One begins and ends before most of the conflicts do: its first and last slices matter.
        for window in [Window::ALL, Window::new(6.0, 12.0).unwrap()] {
            let query = Query::new(window).with_accuracy(accuracy);
            one_answer_to(&query.with_margin(1.0));
        }
    }
}

fn one_answer_to(query: &Query) {
    let scene = scene_of(&swarm(11, 150, 60.0));
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
