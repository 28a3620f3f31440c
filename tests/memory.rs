//! The memory of a scene and a monitor is that of their documentation: counted by the allocator.

#![allow(
    unsafe_code,
    reason = "a counting allocator: each call is handed on to the system's, unchanged"
)]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

use nearmiss::glam::DVec3;
use nearmiss::internals::QueryInternals;
use nearmiss::{
    AlertLevel, Body, Hitbox, Monitor, Outside, Query, Scene, State, Trajectory, Window,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::num::NonZeroU32;
use std::sync::atomic::{AtomicUsize, Ordering};

struct Counting;

/// Bytes that are in use, of all threads.
static USED: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to `System` with the arguments it came with.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        USED.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        USED.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A body far from all others, with a plan of so many segments for 80 s.
fn body(number: u32, segments: u32, outside: Outside) -> Body {
    let from = 1e3 * DVec3::new(f64::from(number % 64), f64::from(number / 64), 0.0);
    let states: Vec<State> = (0..=segments)
        .map(|knot| {
            let time = 80.0 * f64::from(knot) / f64::from(segments);
            let (sin, cos) = time.sin_cos();
            let position = from + DVec3::new(sin, cos, time);
            State::new(time, position, DVec3::new(cos, -sin, 1.0))
        })
        .collect();
    let plan = Trajectory::from_states(&states).unwrap();
    Body::new(plan.with_outside(outside)).with_hitbox(Hitbox::sphere(0.5).unwrap())
}

/// Bytes that were taken since `before`, for each of so many bodies.
fn share(before: usize, bodies: u32) -> f64 {
    let taken = u32::try_from(USED.load(Ordering::Relaxed) - before).unwrap();
    f64::from(taken) / f64::from(bodies)
}

/// Of a scene without pages of its own, which the allocator knows nothing of, when its lists are
/// full: the least there is.
fn of_scene(segments: u32) -> f64 {
    let before = USED.load(Ordering::Relaxed);
    let mut scene = Scene::new();
    let shares = (1..=400).map(|number| {
        scene
            .insert(body(number, segments, Outside::Absent))
            .unwrap();
        share(before, number)
    });
    shares.skip(100).fold(f64::INFINITY, f64::min)
}

/// Returns the bytes for each body of a scene of bodies that coast from a single state.
fn of_straight() -> f64 {
    const BODIES: u32 = 4_096;
    let before = USED.load(Ordering::Relaxed);
    let mut scene = Scene::new();
    for number in 0..BODIES {
        let place = 1e3 * DVec3::new(f64::from(number % 64), f64::from(number / 64), 0.0);
        let motion = Trajectory::coasting(State::new(0.0, place, DVec3::X)).unwrap();
        scene.insert(Body::new(motion)).unwrap();
    }
    share(before, BODIES)
}

/// What a screening beyond the plans' ends leaves in a scene of bodies that go on there, or do not.
fn of_screening(segments: u32, outside: Outside) -> f64 {
    const BODIES: u32 = 2_000;
    let mut scene = Scene::new();
    for number in 0..BODIES {
        scene.insert(body(number, segments, outside)).unwrap();
    }
    let before = USED.load(Ordering::Relaxed);
    let window = Window::new(0.0, 100.0).unwrap();
    // One: the memory of a search is kept, and differs with their number, and with the threads that share them.
    let query = Query::new(window).with_slices(NonZeroU32::MIN);
    scene.screen(&query).unwrap();
    share(before, BODIES)
}

fn of_monitor(segments: u32, outside: Outside) -> f64 {
    const BODIES: u32 = 16_384;
    let mut scene = Scene::new();
    for number in 0..BODIES {
        scene.insert(body(number, segments, outside)).unwrap();
    }
    let before = USED.load(Ordering::Relaxed);
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap();
    for tick in 0..40 {
        let now = 0.25 * f64::from(tick);
        monitor.advance(now, &mut Vec::new()).unwrap();
    }
    share(before, BODIES)
}

/// One test: what another one takes at the same time would count as well.
#[test]
fn figures_are_as_documented() {
    let is = |what: &str, counted: f64, documented: f64| {
        println!("{what}: {counted:.0} bytes, {documented} documented");
        let is_near = (counted - documented).abs() <= 0.1 * documented;
        assert!(is_near, "{what}: {counted} {documented}");
    };
    for segments in [1, 8, 20] {
        let many = f64::from(segments);
        is("a body", of_scene(segments), 1000.0 + 230.0 * many);
        // What a body does beyond its knots takes nothing.
        let beyond =
            of_screening(segments, Outside::Coast) - of_screening(segments, Outside::Absent);
        assert!(beyond.abs() <= 50.0, "{beyond}");
    }
    is("a body of one state", of_straight(), 190.0);
    is("monitored", of_monitor(8, Outside::Absent), 1100.0);
    let coasting = of_monitor(8, Outside::Coast);
    is("monitored and coasting", coasting, 1100.0);
}
