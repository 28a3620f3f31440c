//! A monitor that runs for hours: memory stays flat, and it goes on saying what screening says.
//!
//! `NEARMISS_HOURS=10 cargo test --release --test soak -- --nocapture` simulates ten hours.

#![allow(
    clippy::unwrap_used,
    reason = "a monitor that cannot be built fails the test"
)]

mod support;

use nearmiss::{
    AlertLevel, Body, BodyId, Command, Event, EventKind, Hitbox, Monitor, Scene, State, Trajectory,
    Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicIsize, Ordering};
use support::{bits, rng, screen, wander};

/// Bytes that are allocated at the moment.
static LIVE: AtomicIsize = AtomicIsize::new(0);

struct Counting;

#[allow(
    unsafe_code,
    reason = "an allocator is unsafe by contract; this one hands everything on to the system's"
)]
// SAFETY: all calls go to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LIVE.fetch_add(layout.size().cast_signed(), Ordering::Relaxed);
        // SAFETY: the caller's promise is the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size().cast_signed(), Ordering::Relaxed);
        // SAFETY: the caller's promise is the system's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const CUBE: f64 = 25.0;
const LOOKAHEAD: f64 = 5.0;
const MARGIN: f64 = 1.0;

fn plan(rng: &mut ChaCha8Rng, from: State) -> Trajectory {
    let mut states = wander(rng, from.time, 12, 2.0, CUBE, 4.0);
    states[0] = from;
    Trajectory::from_states(&states).unwrap()
}

/// New plans for one body in a hundred, and for those whose plans end.
fn commands(
    rng: &mut ChaCha8Rng,
    monitor: &Monitor,
    ids: &[BodyId],
    events: &[Event],
) -> Vec<Command> {
    let now = monitor.now();
    let mut chosen: Vec<BodyId> = ids
        .iter()
        .copied()
        .filter(|_| rng.random_bool(0.01))
        .collect();
    chosen.extend(events.iter().filter_map(|event| match event.kind {
        EventKind::PlanEnds { body, .. } => Some(body),
        _ => None,
    }));
    chosen.sort_unstable();
    chosen.dedup();
    let follow = |id: BodyId| {
        let old = &monitor.scene().body(id).unwrap().trajectory;
        let state = State::new(now, old.position(now).unwrap(), old.velocity(now).unwrap());
        Command::Replan(id, now, plan(rng, state).into())
    };
    chosen.into_iter().map(follow).collect()
}

#[test]
fn hours_pass() {
    let hours = std::env::var("NEARMISS_HOURS").ok();
    let hours: f64 = hours.and_then(|text| text.parse().ok()).unwrap_or(0.05);
    let mut rng = rng(8);
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..40)
        .map(|_| {
            let states = wander(&mut rng, 0.0, 12, 2.0, CUBE, 4.0);
            let body = Body::new(Trajectory::from_states(&states).unwrap());
            let hitbox = Hitbox::sphere(0.4).unwrap();
            scene.insert(body.with_hitbox(hitbox)).unwrap()
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &[AlertLevel::at(MARGIN)]).unwrap();
    let (mut events, mut told, mut compared) = (Vec::new(), 0, 0);
    // Plans have their own lengths: what is compared is the largest of many ticks.
    let (mut early, mut late) = (0, 0);
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a number of ticks"
    )]
    let ticks = (hours * 3600.0 * 60.0) as u32;
    for tick in 1..=ticks {
        let commands = commands(&mut rng, &monitor, &ids, &events);
        events.clear();
        monitor.apply(commands).unwrap();
        monitor
            .advance(f64::from(tick) / 60.0, &mut events)
            .unwrap();
        told += events.len();
        let live = LIVE.load(Ordering::Relaxed);
        if tick > ticks / 4 && tick <= ticks / 2 {
            early = live.max(early);
        } else if tick > ticks / 4 * 3 {
            late = live.max(late);
        }
        if tick % 200 == 0 {
            let window = Window::new(monitor.now(), monitor.now() + LOOKAHEAD).unwrap();
            let expected = screen(monitor.scene(), window, MARGIN);
            assert_eq!(
                bits(monitor.conflicts(0).unwrap()),
                bits(&expected),
                "tick {tick}"
            );
            compared += 1;
        }
    }
    eprintln!(
        "{hours} h: {ticks} ticks, {told} events, {compared} comparisons; \
         largest memory in the second quarter {early} bytes, in the last {late}"
    );
    assert!(told > 100);
    // Buffers may still meet a moment more crowded than all before. A leak of one plan (some 2 kB)
    // in a hundred ticks would double the memory in five minutes.
    assert!(late < early + early / 4, "{early} {late}");
}
