//! In steady state a tick allocates nothing: counted by the allocator itself.

#![allow(
    unsafe_code,
    reason = "a counting allocator: each call is handed on to the system's, unchanged"
)]
#![allow(
    clippy::unwrap_used,
    reason = "a monitor that cannot be built fails the test"
)]

mod support;

use nearmiss::{AlertLevel, Monitor, Outside, Scene, State, Trajectory};
use rand::RngExt;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call goes to `System` with the arguments it came with; counting touches a
// thread-local `Cell` that needs no allocation and no destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations() -> u64 {
    ALLOCATIONS.with(Cell::get)
}

/// Bodies that go round and round: after some rounds no buffer has anything new to hold.
fn circling(index: u32, rng: &mut rand_chacha::ChaCha8Rng) -> Trajectory {
    const PERIOD: f64 = 10.0;
    let middle = support::vector(rng, 12.0);
    let (across, along) = (support::vector(rng, 10.0), support::vector(rng, 10.0));
    let states: Vec<State> = (0..=12 * 14)
        .map(|knot| {
            let time = f64::from(knot) * PERIOD / 12.0;
            let pace = std::f64::consts::TAU / PERIOD;
            let (sin, cos) = (pace * f64::from(knot % 12) * PERIOD / 12.0).sin_cos();
            let position = middle + across * sin + along * cos;
            State::new(time, position, (across * cos - along * sin) * pace)
        })
        .collect();
    let outside = if index.is_multiple_of(2) {
        Outside::Absent
    } else {
        Outside::Coast
    };
    Trajectory::from_states(&states)
        .unwrap()
        .with_outside(outside)
}

#[test]
fn a_tick_with_unchanged_plans_allocates_nothing() {
    let mut rng = support::rng(5);
    let mut scene = Scene::new();
    for index in 0..60 {
        let trajectory = circling(index, &mut rng);
        let radius = rng.random_range(0.2..0.6);
        let hitbox = nearmiss::Hitbox::sphere(radius).unwrap();
        scene
            .insert(nearmiss::Body::new(trajectory).with_hitbox(hitbox))
            .unwrap();
    }
    let levels = [
        AlertLevel {
            margin: 3.0,
            release: 3.5,
        },
        AlertLevel::at(0.0),
    ];
    let mut monitor = Monitor::new(scene, 0.0, 5.0, &levels).unwrap();
    let mut events = Vec::new();
    let mut now = 0.0;
    let mut told = 0;
    let mut tick = |monitor: &mut Monitor, events: &mut Vec<_>| {
        events.clear();
        now += 1.0 / 60.0;
        monitor.advance(now, events).unwrap();
        events.len()
    };
    // Up to seven slices of 1.25 s are in use, each with its own buffers: after 70 s all of them
    // have held every part of the round.
    for _ in 0..100 * 60 {
        tick(&mut monitor, &mut events);
    }
    let before = allocations();
    for _ in 0..20 * 60 {
        told += tick(&mut monitor, &mut events);
    }
    let during = allocations() - before;
    assert!(told > 100, "encounters come and go: {told}");
    assert_eq!(during, 0);
    // The counter counts: one vector, one allocation.
    let before = allocations();
    drop(std::hint::black_box(vec![1_u8]));
    assert_eq!(allocations() - before, 1);
}
