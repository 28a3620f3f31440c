//! The same bits for any number of threads, every broad-phase method and instruction set.

#![cfg(feature = "parallel")]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::broad_phase::Level;
use nearmiss::{Accuracy, Method, Query, Window};
use support::{bits, scene_of, swarm};

#[test]
fn threads_methods_and_instructions() {
    for accuracy in [Accuracy::Fast, Accuracy::Exact, Accuracy::Certified] {
        one_answer_at(accuracy);
    }
}

fn one_answer_at(accuracy: Accuracy) {
    let scene = scene_of(&swarm(11, 150, 60.0));
    let query = Query::new(Window::ALL)
        .with_margin(1.0)
        .unwrap()
        .with_accuracy(accuracy);
    let mut answers = Vec::new();
    for method in Method::EVERY {
        for threads in 1..=4 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            for level in Level::available() {
                let query = query.with_method(method).with_level(level);
                let answer = pool.install(|| scene.screen(&query)).unwrap();
                assert!(!answer.conflicts.is_empty());
                answers.push((method, threads, level, bits(&answer.conflicts)));
            }
        }
    }
    for (method, threads, level, answer) in &answers {
        let by = (method, threads, level);
        assert_eq!(answer, &answers[0].3, "{by:?}");
    }
}

/// Whatever there is to do: from any thread, and at the end that all is done.
#[test]
fn progress_ends_with_one() {
    let bodies = swarm(3, 200, 100.0);
    for count in [0, 1, 200] {
        let scene = scene_of(&bodies[..count]);
        let told = std::sync::Mutex::new(Vec::new());
        let query = Query::default().with_margin(1.0).unwrap();
        let tell = |share: f64| told.lock().unwrap().push(share);
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
