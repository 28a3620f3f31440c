//! Screenings that are ended before they are done.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::{Body, Error, Query, Scene, State, Trajectory};
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

/// Two bodies that are near for thousands of cubics are one pair: progress is asked within it, too.
#[test]
fn a_screening_ends_within_a_pair() {
    let along = |y: f64| {
        let state = |number: u32| {
            let aside = y + 0.3 * f64::from(number * 7 % 5);
            State::new(f64::from(number), aside * DVec3::Y, DVec3::X)
        };
        Trajectory::from_states(&(0..4_000).map(state).collect::<Vec<_>>()).unwrap()
    };
    let mut scene = Scene::new();
    for y in [0.0, 1.0] {
        scene.insert(Body::new(along(y))).unwrap();
    }
    let query = Query::default().with_margin(1.1);
    let calls_until = |most: u32| {
        let calls = AtomicU32::new(0);
        let done = scene.screen_with_progress(&query, |share| {
            let solved = u32::from(share >= 0.9);
            if calls.fetch_add(solved, Ordering::Relaxed) + solved >= most {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        (done.is_ok(), calls.into_inner())
    };
    let (is_done, all) = calls_until(u32::MAX);
    assert!(is_done && all > 10, "{all}");
    // The last call is made in any case.
    assert_eq!(calls_until(4), (false, 5));
}
