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

use nearmiss::{AlertLevel, Monitor, Outside, Scene, Trajectory};
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

#[test]
fn a_tick_with_unchanged_plans_allocates_nothing() {
    let mut rng = support::rng(5);
    let mut scene = Scene::new();
    for index in 0..90 {
        let states = support::wander(&mut rng, 0.0, 50, 1.0, 40.0, 6.0);
        let outside = [Outside::Absent, Outside::Coast][index % 2];
        let trajectory = Trajectory::from_states(&states)
            .unwrap()
            .with_outside(outside);
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
    for _ in 0..20 * 60 {
        tick(&mut monitor, &mut events);
    }
    let before = allocations();
    for _ in 0..15 * 60 {
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
