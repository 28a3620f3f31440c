//! A game with few bodies does not wait for other threads, however busy they are.

#![cfg(feature = "parallel")]
#![allow(
    clippy::unwrap_used,
    reason = "a monitor that cannot be built fails the test"
)]

mod support;

use nearmiss::{AlertLevel, Body, BodyId, Command, Monitor, Scene, Trajectory};
use std::sync::mpsc::channel;
use std::sync::{Arc, RwLock};
use std::time::Duration;
use support::{rng, wander};

/// Boxes formed in the last of some ticks, before each of which all bodies are told a plan.
fn ticks() -> u64 {
    const BODIES: usize = 200;
    let mut rng = rng(61);
    let mut plan = |now: f64| {
        let states = wander(&mut rng, now, 12, 1.0, 88.0, 5.0);
        Trajectory::from_states(&states).unwrap()
    };
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..BODIES)
        .map(|_| scene.insert(Body::new(plan(0.0))).unwrap())
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap();
    let mut boxes = 0;
    for tick in 0..20 {
        let now = f64::from(tick) / 60.0;
        let told = ids
            .iter()
            .map(|&id| Command::Replan(id, now, plan(now).into()));
        monitor.apply(told.collect::<Vec<_>>()).unwrap();
        monitor.advance(now, &mut Vec::new()).unwrap();
        boxes = monitor.stats().boxes;
    }
    boxes
}

#[test]
fn few_changes_stay_on_the_callers_thread() {
    const THREADS: usize = 2;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(THREADS);
    pool.build_global().unwrap();
    // All threads of the pool are busy until the gate opens.
    let gate = Arc::new(RwLock::new(()));
    let (entered, busy) = channel();
    let closed = gate.write().unwrap();
    let waiting = Arc::clone(&gate);
    rayon::spawn_broadcast(move |_| {
        entered.send(()).unwrap();
        drop(waiting.read());
    });
    for _ in 0..THREADS {
        busy.recv().unwrap();
    }
    let (done, game) = channel();
    std::thread::spawn(move || done.send(ticks()));
    let boxes = game.recv_timeout(Duration::from_secs(20));
    drop(closed);
    let boxes = boxes.unwrap();
    // In three slices of time or more.
    assert!(boxes >= 600, "{boxes}");
}
