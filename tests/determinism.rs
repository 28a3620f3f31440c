//! The same bits for any number of threads, and for every broad-phase method.

#![cfg(feature = "parallel")]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::{Accuracy, Method, Query, Window};
use support::{bits, scene_of, swarm};

#[test]
fn threads_and_methods() {
    for accuracy in [Accuracy::Fast, Accuracy::Exact, Accuracy::Certified] {
        threads_and_methods_at(accuracy);
    }
}

fn threads_and_methods_at(accuracy: Accuracy) {
    let scene = scene_of(&swarm(11, 150, 60.0));
    let mut answers = Vec::new();
    for method in Method::EVERY {
        for threads in 1..=4 {
            let query = Query::new(Window::ALL)
                .with_margin(1.0)
                .unwrap()
                .with_accuracy(accuracy)
                .with_method(method);
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let answer = pool.install(|| scene.screen(&query)).unwrap();
            assert!(!answer.conflicts.is_empty());
            answers.push((method, threads, bits(&answer.conflicts)));
        }
    }
    for (method, threads, answer) in &answers {
        assert_eq!(answer, &answers[0].2, "{method:?} on {threads} threads");
    }
}
