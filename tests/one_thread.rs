//! A program whose only rayon thread is its own main thread, as it asks for no other: the whole process has that pool.

#![cfg(feature = "live")]
#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

use nearmiss::glam::DVec3;
use nearmiss::live::{LiveOptions, ReportKind};
use nearmiss::{AlertLevel, Body, Monitor, Query, Scene, Trajectory, Window};
use std::thread;
use std::time::Duration;

/// A row of bodies a metre apart.
fn row() -> Scene {
    let mut scene = Scene::new();
    for place in 0..3_000 {
        let at = Trajectory::at_rest(f64::from(place) * DVec3::X).unwrap();
        scene.insert(Body::new(at)).unwrap();
    }
    scene
}

/// A live monitor, and a screening on another thread, work while the only thread of the pool waits for them.
#[test]
fn other_threads_do_not_wait_for_the_only_one() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.use_current_thread().build_global().unwrap();
    let monitor = Monitor::new(row(), 0.0, 2.0, &[AlertLevel::at(1.5)]).unwrap();
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    live.handle().advance(0.1).unwrap();
    let mut ended = None;
    while ended.is_none() {
        match live.reports().recv_timeout(Duration::from_secs(60)) {
            Ok(report) => {
                if let ReportKind::Ticked { now, .. } = report.kind {
                    ended = (now >= 0.1).then_some(now);
                }
            }
            Err(error) => {
                // Dropping it would wait for ever.
                std::mem::forget(live);
                panic!("{error}");
            }
        }
    }
    live.shutdown().unwrap();
    let screening = thread::spawn(|| {
        let query = Query::new(Window::new(0.0, 2.0).unwrap()).with_margin(1.5);
        row().screen(&query).unwrap().conflicts.len()
    });
    let mut waited = 0;
    while !screening.is_finished() {
        assert!(waited < 600, "it takes more than a minute");
        thread::sleep(Duration::from_millis(100));
        waited += 1;
    }
    assert_eq!(screening.join().unwrap(), 2_999);
}
