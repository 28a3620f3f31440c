//! Worlds in which boxes meet far more often than bodies: formations, fleets that pass each other, crowds
//! that are none. What they cost is counted, not timed.

#![allow(
    unsafe_code,
    reason = "a counting allocator: each call is handed on to the system's, unchanged"
)]
#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Error, EventKind, Hitbox, Layers, Monitor, Query, Scene, State,
    Stats, Trajectory,
};
use rand::RngExt;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use support::{exceeded, line, rng};

struct Counting;

/// Bytes in use, of all threads, and the most there ever were.
static USED: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to `System` with the arguments it came with.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let used = USED.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        PEAK.fetch_max(used, Ordering::Relaxed);
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

/// One test at a time: they share the counts.
fn alone() -> MutexGuard<'static, ()> {
    static ONE: Mutex<()> = Mutex::new(());
    let guard = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    PEAK.store(USED.load(Ordering::Relaxed), Ordering::Relaxed);
    guard
}

const GIB: usize = 1 << 30;

/// Balls of 0.2 m, 1 m apart in a grid 100 wide at a height, that fly so for a minute.
fn formation(scene: &mut Scene, count: u32, height: f64, velocity: impl FnMut() -> DVec3) {
    let mut velocity = velocity;
    for number in 0..count {
        let from = DVec3::new(f64::from(number % 100), f64::from(number / 100), height);
        let plan = line(0.0, 60.0, from, velocity());
        let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.2).unwrap());
        scene.insert(body).unwrap();
    }
}

const FAST: DVec3 = DVec3::new(100.0, 100.0, 0.0);

fn screen(scene: &Scene, margin: f64) -> (Stats, usize) {
    let query = Query::default().with_margin(margin);
    let screening = scene.screen(&query).unwrap();
    (screening.stats, screening.conflicts.len())
}

fn monitor(scene: Scene, margin: f64) -> Monitor {
    Monitor::new(scene, 0.0, 60.0, &[AlertLevel::at(margin)]).unwrap()
}

/// Only relative motion makes candidates.
#[test]
fn a_formation_has_no_candidates() {
    let _one = alone();
    let mut scene = Scene::new();
    formation(&mut scene, 20_000, 0.0, || FAST);
    // Some that fly elsewhere change nothing for the others.
    let mut rng = rng(1);
    for number in 0..200 {
        let from = DVec3::new(f64::from(number), -50.0, 0.0);
        let away = DVec3::new(0.0, rng.random_range(-9.0..0.0), 0.0);
        scene
            .insert(Body::new(line(0.0, 60.0, from, away)))
            .unwrap();
    }
    let (stats, conflicts) = screen(&scene, 0.0);
    assert_eq!(conflicts, 0);
    let cost = |stats: &Stats| stats.boxes + stats.candidates;
    assert!(cost(&stats) < 5_000_000, "{stats:?}");
    let mut monitor = monitor(scene, 0.0);
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    assert!(cost(monitor.stats()) < 5_000_000, "{:?}", monitor.stats());
    // Those 1 m apart are still found.
    assert_eq!(screen(monitor.scene(), 0.6).1, 2 * 20_000 - 200 - 100);
}

/// No frame serves two fleets. Either slices are so short that boxes of a fleet do not overlap, or so few that comparing all
/// of them costs less than the boxes of short slices would: fast fleets would need a million.
#[test]
fn fleets_that_pass_each_other_cost_little() {
    let _one = alone();
    for (one, other) in [
        (FAST, -FAST),
        (FAST, DVec3::ZERO),
        (70.0 * FAST, -70.0 * FAST),
    ] {
        let mut scene = Scene::new();
        for (height, velocity) in [(0.0, one), (10.0, other)] {
            // 10 m apart.
            for number in 0..2_000 {
                let place = DVec3::new(f64::from(number % 100), f64::from(number / 100), 0.0);
                let from = 10.0 * place + height * DVec3::Z;
                let plan = line(0.0, 60.0, from, velocity);
                let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.2).unwrap());
                scene.insert(body).unwrap();
            }
        }
        // A box costs as much as a few candidates.
        let cost = |stats: &Stats| 4 * stats.boxes + stats.candidates;
        let (stats, conflicts) = screen(&scene, 0.0);
        assert_eq!(conflicts, 0);
        assert!(cost(&stats) < 10_000_000, "{stats:?}");
        let mut monitor = monitor(scene, 0.0);
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        assert!(cost(monitor.stats()) < 15_000_000, "{:?}", monitor.stats());
    }
}

/// Bodies that fly every way, more conflicts than there is room for: an error, in little memory, also with
/// the next tick; and with more room an answer.
#[test]
fn a_storm_is_refused_in_little_memory() {
    let _one = alone();
    let mut rng = rng(2);
    let mut scene = Scene::new();
    formation(&mut scene, 20_000, 0.0, || {
        let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
        140.0 * DVec3::new(angle.cos(), angle.sin(), 0.0)
    });
    let mut monitor = monitor(scene, 0.0);
    monitor.set_max_spans(100_000);
    let mut events = Vec::new();
    // Each thread has its own candidates.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build();
    pool.unwrap().install(|| {
        for now in [0.0, 0.0, 0.1] {
            let done = monitor.advance(now, &mut events);
            assert_eq!(exceeded(done), Some(100_000));
            assert!(events.is_empty());
        }
    });
    // As much as the scene takes, and half a GiB more, were all slices to keep their candidates.
    let peak = PEAK.load(Ordering::Relaxed);
    assert!(peak < GIB * 5 / 8, "{peak}");
    monitor.set_max_spans(Monitor::MAX_SPANS);
    monitor.advance(0.1, &mut events).unwrap();
    assert!(monitor.conflicts(0).unwrap().len() > 100_000);
}

/// Returns the limit that a search exceeded, and the number of others in the crowd that it tells of.
fn crowd_of<T>(done: Result<T, Error>) -> (usize, Option<usize>) {
    match done.err().unwrap() {
        Error::TooCrowded { limit, crowd } => (limit, crowd.map(|crowd| crowd.others)),
        other => unreachable!("{other}"),
    }
}

/// Points at one place: each two of them are a pair for ever.
fn at_one_place(count: u32, layers: impl Fn(u32) -> Layers) -> (Scene, Vec<BodyId>) {
    let mut scene = Scene::new();
    let plan = line(0.0, 60.0, DVec3::ZERO, DVec3::ZERO);
    let body = |number| Body::new(plan.clone()).with_layers(layers(number));
    let ids = (0..count).map(|number| scene.insert(body(number)).unwrap());
    let ids = ids.collect();
    (scene, ids)
}

#[test]
fn one_place_is_refused_in_little_memory() {
    let _one = alone();
    let (scene, _) = at_one_place(100_000, |_| Layers::ALL);
    let limit = Query::MAX_SPANS;
    let refused = scene.screen(&Query::default());
    assert_eq!(crowd_of(refused), (limit, Some(99_999)));
    let mut monitor = monitor(scene, 0.0);
    for now in [0.0, 0.0, 0.1] {
        let done = monitor.advance(now, &mut Vec::new());
        assert_eq!(crowd_of(done), (Monitor::MAX_SPANS, Some(99_999)));
    }
    let peak = PEAK.load(Ordering::Relaxed);
    assert!(peak < GIB, "{peak}");
}

/// Bodies behind many walls, each a contact in each cubic: an error, in little memory.
#[test]
fn many_walls_are_refused_in_little_memory() {
    let _one = alone();
    let mut scene = Scene::new();
    for number in 0..400 {
        let place = DVec3::new(f64::from(number), 0.0, -5.0);
        let states = (0..=200).map(|time| State::new(f64::from(time), place, DVec3::ZERO));
        let plan = Trajectory::from_states(&states.collect::<Vec<_>>()).unwrap();
        let layers = Layers::new(1, 2);
        scene.insert(Body::new(plan).with_layers(layers)).unwrap();
    }
    for _ in 0..100 {
        let wall = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
        let wall = wall.with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
        scene.insert(wall.with_layers(Layers::new(2, 1))).unwrap();
    }
    let limit = 100_000;
    let query = Query::default().with_max_spans(limit);
    // Each body is behind all walls, and each wall before all bodies.
    assert_eq!(crowd_of(scene.screen(&query)), (limit, Some(400)));
    let mut monitor = Monitor::new(scene, 0.0, 200.0, &[AlertLevel::at(0.0)]).unwrap();
    monitor.set_max_spans(limit);
    let done = monitor.advance(0.0, &mut Vec::new());
    assert_eq!(crowd_of(done), (limit, Some(400)));
    // All spans would take 128 MiB.
    let peak = PEAK.load(Ordering::Relaxed);
    assert!(peak < GIB / 16, "{peak}");
}

/// Each sees the next kind, which does not see it.
fn in_a_circle(number: u32) -> Layers {
    Layers::new(1 << (number % 3), 1 << ((number + 1) % 3))
}

#[test]
fn bodies_that_see_nobody_cost_nothing() {
    let _one = alone();
    for layers in [|_| Layers::NONE, |_| Layers::new(1, 2), in_a_circle] {
        let (scene, ids) = at_one_place(20_000, layers);
        let (stats, conflicts) = screen(&scene, 0.0);
        assert_eq!((stats.candidates, conflicts), (0, 0));
        let mut monitor = monitor(scene, 0.0);
        let mut events = Vec::new();
        monitor.advance(0.0, &mut events).unwrap();
        let counts = |monitor: &Monitor| (monitor.stats().boxes, monitor.stats().candidates);
        assert_eq!(counts(&monitor), (0, 0));
        // Two of them see each other, and nobody else: at once in a question, and with the next tick.
        for &id in &ids[..2] {
            monitor.set_layers(id, Layers::new(1 << 9, 1 << 9)).unwrap();
        }
        let plan = line(0.0, 60.0, DVec3::X, DVec3::ZERO);
        let meets = |x: f64| line(0.0, 60.0, x * DVec3::X, DVec3::ZERO);
        assert_eq!(monitor.what_if(ids[0], &plan, 0).unwrap().len(), 0);
        assert_eq!(monitor.what_if(ids[0], &meets(0.0), 0).unwrap().len(), 1);
        monitor.advance(1.0, &mut events).unwrap();
        assert_eq!(monitor.encounters().count(), 1, "{events:?}");
        assert!(counts(&monitor).0 < 1_000);
        // And no more when one of them is gone; its partner is alone.
        monitor.remove(ids[0]).unwrap();
        events.clear();
        monitor.advance(2.0, &mut events).unwrap();
        let is_over =
            |kind: &EventKind| matches!(kind, EventKind::Ended(..) | EventKind::Withdrawn(_));
        assert_eq!(
            events.iter().filter(|one| is_over(&one.kind)).count(),
            1,
            "{events:?}"
        );
        assert!(monitor.encounters().next().is_none());
    }
}

/// A body whose partner comes later is found, wherever its partner was put in.
#[test]
fn partners_that_come_later_are_found() {
    let _one = alone();
    let mut scene = Scene::new();
    let body = |x: f64, layers| {
        let plan = Trajectory::at_rest(x * DVec3::X).unwrap();
        Body::new(plan).with_layers(layers)
    };
    let (red, blue) = (Layers::new(1, 2), Layers::new(2, 1));
    for number in 0..100 {
        scene.insert(body(f64::from(number), red)).unwrap();
    }
    let mut monitor = monitor(scene, 0.25);
    let mut events = Vec::new();
    monitor.advance(0.0, &mut events).unwrap();
    assert_eq!(monitor.stats().boxes, 0);
    let late = monitor.insert(body(50.2, blue)).unwrap();
    let far = Trajectory::at_rest(70.1 * DVec3::X).unwrap();
    assert_eq!(monitor.what_if(late, &far, 0).unwrap().len(), 1);
    monitor.advance(1.0, &mut events).unwrap();
    assert_eq!(monitor.conflicts(0).unwrap().len(), 1);
    let query = Query::new(nearmiss::Window::new(1.0, 61.0).unwrap()).with_margin(0.25);
    let screened = monitor.scene().screen(&query).unwrap();
    assert_eq!(screened.conflicts.len(), 1);
}

/// No distance is within a negative sum of radii and margin.
#[test]
fn what_no_distance_can_reach_is_no_pair() {
    let _one = alone();
    let (scene, _) = at_one_place(100_000, |_| Layers::ALL);
    assert_eq!(screen(&scene, -1.0).1, 0);
    let ball = |radius: f64| {
        let plan = line(0.0, 60.0, DVec3::ZERO, DVec3::ZERO);
        Body::new(plan).with_hitbox(Hitbox::sphere(radius).unwrap())
    };
    // One that is just large enough for all others, at their centre.
    let (mut scene, _) = at_one_place(3_000, |_| Layers::ALL);
    scene.insert(ball(1.0)).unwrap();
    assert_eq!(screen(&scene, -1.0).1, 3_000);
    // None is large enough for another one of its kind.
    let mut scene = Scene::new();
    for _ in 0..1_000 {
        scene.insert(ball(0.5_f64.next_down())).unwrap();
    }
    assert_eq!(screen(&scene, -1.0).1, 0);
    let mut monitor = monitor(scene, -1.0);
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    assert_eq!(monitor.conflicts(0).unwrap().len(), 0);
    for _ in 0..2 {
        monitor.insert(ball(0.5)).unwrap();
    }
    monitor.advance(1.0, &mut Vec::new()).unwrap();
    assert_eq!(monitor.conflicts(0).unwrap().len(), 1);
}

/// Answers are the same bits in a frame that moves: each pair by itself, which has a frame of its own.
#[test]
fn a_common_velocity_changes_no_bit() {
    let _one = alone();
    let mut rng = rng(5);
    let wind = DVec3::new(300.0, -170.0, 40.0);
    let bodies: Vec<Body> = (0..120)
        .map(|_| {
            let mut states = support::wander(&mut rng, 0.0, 12, 2.5, 60.0, 5.0);
            for state in &mut states {
                state.position += wind * state.time;
                state.velocity += wind;
            }
            let plan = Trajectory::from_states(&states).unwrap();
            Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap())
        })
        .collect();
    let query = Query::default().with_margin(2.0);
    let all = |bodies: &[&Body]| {
        let mut scene = Scene::new();
        for &body in bodies {
            scene.insert(body.clone()).unwrap();
        }
        scene.screen(&query).unwrap()
    };
    let listed: Vec<&Body> = bodies.iter().collect();
    let together = all(&listed);
    let mut apart = Vec::new();
    for (number, a) in bodies.iter().enumerate() {
        for b in &bodies[number + 1..] {
            apart.extend(all(&[a, b]).conflicts);
        }
    }
    let key = |one: &nearmiss::Conflict| {
        (
            one.enter.to_bits(),
            one.exit.to_bits(),
            one.closest.separation.to_bits(),
        )
    };
    let sorted = |conflicts: &[nearmiss::Conflict]| {
        let mut keys: Vec<_> = conflicts.iter().map(key).collect();
        keys.sort_unstable();
        keys
    };
    assert!(together.conflicts.len() > 100);
    assert_eq!(sorted(&together.conflicts), sorted(&apart));
    // Were boxes not to move, each would meet most others.
    assert!(
        together.stats.candidates < 20 * together.stats.boxes,
        "{:?}",
        together.stats
    );
}

/// Balls that pass one place one after another, for a few seconds of a long time, and perhaps a large one at rest far away.
fn passers_by(far: Option<f64>) -> Scene {
    const COUNT: u32 = 3_500;
    let mut rng = rng(11);
    let mut scene = Scene::new();
    for number in 0..COUNT {
        let at = 500.0 + 10.0 * f64::from(number) / f64::from(COUNT);
        let velocity = loop {
            let velocity = DVec3::from_array([0; 3].map(|_| rng.random_range(-1e3..1e3)));
            if velocity.length() > 300.0 {
                break velocity;
            }
        };
        let body = Body::new(line(0.0, 1000.0, -at * velocity, velocity));
        scene
            .insert(body.with_hitbox(Hitbox::sphere(0.5).unwrap()))
            .unwrap();
    }
    if let Some(radius) = far {
        let rest = Trajectory::at_rest([3.0 * radius, 0.0, 0.0]).unwrap();
        let body = Body::new(rest).with_hitbox(Hitbox::sphere(radius).unwrap());
        scene.insert(body).unwrap();
    }
    scene
}

/// A planet beside a swarm does not shrink with the slices. The swarm does.
#[test]
fn a_large_body_makes_no_crowd() {
    let _one = alone();
    let (alone, found) = screen(&passers_by(None), 1.0);
    for radius in [1e7, 1e8] {
        let scene = passers_by(Some(radius));
        let (beside, same) = screen(&scene, 1.0);
        assert_eq!(same, found);
        assert!(
            beside.candidates < 2 * alone.candidates,
            "{radius}: {beside:?} {alone:?}"
        );
        let mut monitor = Monitor::new(scene, 0.0, 1_000.0, &[AlertLevel::at(1.0)]).unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        assert_eq!(monitor.conflicts(0).unwrap().len(), found);
    }
}

/// A crowd of which half is gone before the other half comes. Halves of the time have fewer pairs, though boxes are as large; a
/// sample of the bodies by number may hold none of them.
#[test]
fn a_crowd_that_comes_after_another_is_divided() {
    let _one = alone();
    let is_sampled = |number: u32| number.wrapping_mul(0x9E37_79B9) <= u32::MAX / 8;
    // Two small spheres far apart: large boxes, and nobody touches another.
    let sphere = |at: f64| nearmiss::Sphere {
        offset: DVec3::splat(at),
        radius: 1e-3,
    };
    let hitbox = Hitbox::cluster(vec![sphere(-50.0), sphere(50.0)]).unwrap();
    for hides in [false, true] {
        let (mut scene, mut rng) = (Scene::new(), rng(7));
        for number in 0..3_430 {
            let is_far = if hides {
                is_sampled(number)
            } else {
                number >= 3_000
            };
            let mut place = DVec3::from_array(std::array::from_fn(|_| rng.random_range(0.0..10.0)));
            if is_far {
                place.x += 1e4 + 500.0 * f64::from(number);
            }
            let (from, to) = if number % 2 == 0 {
                (0.0, 40.0)
            } else {
                (60.0, 100.0)
            };
            let plan = line(from, to, place, DVec3::ZERO);
            let body = Body::new(plan).with_hitbox(hitbox.clone());
            scene.insert(body).unwrap();
        }
        let query = Query::default().with_max_spans(1 << 22);
        let found = scene
            .screen(&query)
            .map(|screening| screening.conflicts.len());
        assert!(matches!(found, Ok(0)), "{hides}: {found:?}");
    }
}
