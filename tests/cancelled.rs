//! Screenings that are ended before they are done.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::{Error, Query};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};
use support::{bits, on_threads, scene_of, swarm};

/// A screening ends at any share, on any number of threads; afterwards the scene answers as before.
#[test]
fn a_screening_can_be_ended() {
    let scene = scene_of(&swarm(3, 400, 40.0));
    let query = Query::default().with_margin(1.0);
    let expected = scene.screen(&query).unwrap().conflicts;
    for threads in [1, 2] {
        for most in [0.0, 0.3, 0.9, 0.95, 1.0] {
            let calls = AtomicU32::new(0);
            let screened = on_threads(threads, || {
                scene.screen_with_progress(&query, |share| {
                    calls.fetch_add(1, Ordering::Relaxed);
                    if share >= most {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    }
                })
            });
            assert!(matches!(screened, Err(Error::Cancelled)), "{most}");
            assert!(calls.into_inner() >= 2);
        }
        let again = on_threads(threads, || scene.screen(&query).unwrap().conflicts);
        assert_eq!(bits(&again), bits(&expected));
    }
    // It saves work: after the first share nothing is searched.
    let (all, few) = [false, true]
        .map(|ends| {
            let calls = AtomicU32::new(0);
            let _ = scene.screen_with_progress(&query, |_| {
                calls.fetch_add(1, Ordering::Relaxed);
                if ends {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
            calls.into_inner()
        })
        .into();
    assert!(few < all, "{few} {all}");
}
