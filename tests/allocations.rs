//! In steady state a tick allocates nothing, and a screening little: counted by the allocator itself.

#![allow(
    unsafe_code,
    reason = "a counting allocator: each call is handed on to the system's, unchanged"
)]
#![allow(
    clippy::unwrap_used,
    reason = "a monitor that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::{DQuat, DVec3};
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{
    AlertLevel, BodyId, BodyState, Command, Monitor, Outside, Query, Scene, State, Trajectory,
    Window,
};
use rand::RngExt;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
    static BYTES: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to `System` with the arguments it came with; counting touches
// thread-local `Cell`s that need no allocation and no destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        BYTES.with(|bytes| bytes.set(bytes.get() + layout.size()));
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
fn circling(outside: Outside, rng: &mut rand::rngs::ChaCha8Rng) -> Trajectory {
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
    Trajectory::from_states(&states)
        .unwrap()
        .with_outside(outside)
}

/// A body that drifts on from a knot of its own: where it is cut beyond that comes into sight at any
/// time. Slowly: it stays among the others.
fn drifting(_: Outside, rng: &mut rand::rngs::ChaCha8Rng) -> Trajectory {
    let (position, velocity) = (support::vector(rng, 12.0), support::vector(rng, 1e-4));
    let state = State::new(rng.random_range(0.0..110.0), position, velocity);
    Trajectory::coasting(state).unwrap()
}

/// What a body that flies so is told at an instant (s).
type Told = fn(&Trajectory, f64) -> Trajectory;

/// The same as before.
fn the_same(flown: &Trajectory, _: f64) -> Trajectory {
    flown.clone()
}

/// As a physics engine tells it: where it is, and how fast.
fn dead_reckoning(flown: &Trajectory, now: f64) -> Trajectory {
    Trajectory::coasting(state_at(flown, now)).unwrap()
}

/// A short cubic that goes on.
fn extrapolation(flown: &Trajectory, now: f64) -> Trajectory {
    let states = [now, now + 0.25].map(|time| state_at(flown, time));
    let plan = Trajectory::from_states(&states).unwrap();
    plan.with_outside(Outside::Extrapolate)
}

fn state_at(flown: &Trajectory, time: f64) -> State {
    let motion = flown.position(time).zip(flown.velocity(time));
    let (position, velocity) = motion.unwrap();
    State::new(time, position, velocity)
}

/// How many of them there are. Their pairs are fewer than 1024: the memory for those of a slice is kept
/// then, however near they are. And a round is a whole number of turns to be told something.
const BODIES: usize = 40;

/// What the ticks are counted of.
#[derive(Clone, Copy)]
struct Course {
    /// Every second body is one of these; the others circle, and are absent beyond their knots.
    other: fn(Outside, &mut rand::rngs::ChaCha8Rng) -> Trajectory,
    /// What those do beyond their knots.
    outside: Outside,
    /// So many bodies, one after the other, are told something every so many ticks.
    replanned: usize,
    every: usize,
    told: Told,
    by: By,
}

/// The call by which bodies are told.
#[derive(Clone, Copy)]
enum By {
    /// Plan by plan.
    Commands,
    /// All states in one call, which is made so many times between two ticks.
    Track(u32),
}

impl Course {
    /// Nobody is told anything.
    const UNTOLD: Self = Self {
        other: circling,
        outside: Outside::Coast,
        replanned: 0,
        every: 1,
        told: the_same,
        by: By::Commands,
    };
}

/// How many allocations 20 s of ticks make, after 100 s of the same. On one thread of a pool: a
/// pool's own queue may allocate where it is called from outside.
fn allocations_of_ticks(course: Course) -> u64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = pool.build().unwrap();
    pool.install(|| count_ticks(course))
}

fn count_ticks(course: Course) -> u64 {
    let mut rng = support::rng(5);
    let mut scene = Scene::new();
    let mut plans = Vec::new();
    for body in 0..BODIES {
        let trajectory = if body % 2 == 0 {
            circling(Outside::Absent, &mut rng)
        } else {
            (course.other)(course.outside, &mut rng)
        };
        let radius = rng.random_range(0.2..0.6);
        let hitbox = nearmiss::Hitbox::sphere(radius).unwrap();
        let body = nearmiss::Body::new(trajectory.clone()).with_hitbox(hitbox);
        plans.push((scene.insert(body).unwrap(), trajectory));
    }
    let levels = [AlertLevel::at(3.0).with_release(3.5), AlertLevel::at(0.0)];
    let mut monitor = Monitor::new(scene, 0.0, 5.0, &levels).unwrap();
    let mut events = Vec::new();
    // Up to seven slices of 1.25 s are in use, each with its own buffers: after 70 s all of them
    // have held every part of the round.
    let (mut told, mut during) = (0, 0);
    for tick in 0..120 * 60_u32 {
        let before = monitor.now();
        // The body flies the same on: what is found of it is found again.
        let (turn, within) = (tick as usize / course.every, tick as usize % course.every);
        let count = if within == 0 { course.replanned } else { 0 };
        let in_turn = plans
            .iter()
            .cycle()
            .skip(turn * course.replanned % plans.len())
            .take(count);
        let replan = |(id, flown): &(BodyId, _)| {
            Command::Replan(*id, before, (course.told)(flown, before).into())
        };
        let commands: Vec<Command> = match course.by {
            By::Commands => in_turn.clone().map(replan).collect(),
            By::Track(_) => Vec::new(),
        };
        events.clear();
        let counted = allocations();
        match course.by {
            By::Commands => drop(monitor.apply(commands).unwrap()),
            By::Track(steps) => {
                for step in 0..steps {
                    let now = before + f64::from(step) / f64::from(60 * steps);
                    let states = in_turn.clone();
                    let states = states.map(|(id, flown)| (*id, state_at(flown, now)));
                    monitor.track(now, states).unwrap();
                }
            }
        }
        monitor
            .advance(f64::from(tick + 1) / 60.0, &mut events)
            .unwrap();
        if tick >= 100 * 60 {
            during += allocations() - counted;
            told += events.len();
        }
    }
    assert!(told > 50, "encounters come and go: {told}");
    during
}

#[test]
fn a_tick_allocates_nothing() {
    assert_eq!(allocations_of_ticks(Course::UNTOLD), 0);
}

/// What they do beyond their knots is laid out on and on.
#[test]
fn a_tick_with_bodies_that_coast_allocates_nothing() {
    let course = Course {
        other: drifting,
        ..Course::UNTOLD
    };
    assert_eq!(allocations_of_ticks(course), 0);
}

/// Few, and more than one in eight: both ways to compare them. And all: nothing is worked out that
/// only a screening would need.
const COUNTS: [usize; 3] = [2, 20, BODIES];

#[test]
fn a_tick_with_new_plans_allocates_nothing() {
    for replanned in COUNTS {
        let course = Course {
            replanned,
            ..Course::UNTOLD
        };
        assert_eq!(allocations_of_ticks(course), 0, "{replanned}");
    }
}

/// Plans that go on without end, told as they come.
#[test]
fn a_tick_with_bodies_told_frame_by_frame_allocates_nothing() {
    for replanned in COUNTS {
        for told in [dead_reckoning as Told, extrapolation] {
            let course = Course {
                replanned,
                told,
                ..Course::UNTOLD
            };
            assert_eq!(allocations_of_ticks(course), 0, "{replanned}");
        }
    }
}

/// All of them, 30 % and few of them, each tick.
#[test]
fn a_tick_with_states_told_in_one_call_allocates_nothing() {
    for replanned in [BODIES, 3 * BODIES / 10, 2] {
        let course = Course {
            replanned,
            by: By::Track(1),
            ..Course::UNTOLD
        };
        assert_eq!(allocations_of_ticks(course), 0, "{replanned}");
    }
}

/// A physics engine may take several steps between two ticks.
#[test]
fn a_tick_with_states_told_several_times_allocates_nothing() {
    for steps in [2, 4] {
        let course = Course {
            replanned: BODIES,
            by: By::Track(steps),
            ..Course::UNTOLD
        };
        assert_eq!(allocations_of_ticks(course), 0, "{steps}");
    }
}

/// A spin replaces the one before in its memory, and what is over is forgotten.
#[test]
fn spins_told_in_one_call_allocate_nothing() {
    support::on_threads(1, || {
        let mut rng = support::rng(9);
        let mut scene = Scene::new();
        let arm = nearmiss::Sphere {
            offset: support::vector(&mut rng, 1.0),
            radius: 0.5,
        };
        let hitbox = nearmiss::Hitbox::cluster(vec![arm, nearmiss::Sphere::default()]).unwrap();
        let orbits: Vec<(BodyId, Trajectory)> = (0..BODIES)
            .map(|_| {
                let flown = circling(Outside::Absent, &mut rng);
                let body = nearmiss::Body::new(flown.clone()).with_hitbox(hitbox.clone());
                (scene.insert(body).unwrap(), flown)
            })
            .collect();
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(1.0)]).unwrap();
        let (mut during, mut events) = (0, Vec::new());
        for tick in 0..600_u32 {
            let now = f64::from(tick) / 60.0;
            let told = orbits.iter().map(|(id, flown)| {
                let turn = DQuat::from_rotation_z(now);
                let state = BodyState::from(state_at(flown, now));
                (*id, state.with_spin(turn, DVec3::Z + now * DVec3::X))
            });
            let before = allocations();
            monitor.track(now, told).unwrap();
            during += if tick < 60 { 0 } else { allocations() - before };
            monitor.advance(now, &mut events).unwrap();
        }
        assert!(events.len() > 50, "{}", events.len());
        assert_eq!(during, 0);
    });
}

/// Nor do spins told to a scene: each replaces the one before in its memory.
#[test]
fn spins_of_an_update_allocate_nothing() {
    let mut rng = support::rng(10);
    let mut scene = Scene::new();
    let orbits: Vec<(BodyId, Trajectory)> = (0..BODIES)
        .map(|_| {
            let flown = circling(Outside::Absent, &mut rng);
            let body = Trajectory::coasting(state_at(&flown, 0.0)).unwrap();
            (scene.insert(nearmiss::Body::new(body)).unwrap(), flown)
        })
        .collect();
    let mut during = 0;
    for frame in 0..60_u32 {
        let now = f64::from(frame) / 60.0;
        let told = orbits.iter().map(|(id, flown)| {
            let turn = DQuat::from_rotation_z(now);
            let state = BodyState::from(state_at(flown, now));
            (*id, state.with_spin(turn, DVec3::Z + now * DVec3::X))
        });
        let before = allocations();
        scene.update(told).unwrap();
        // The first one makes room.
        during += if frame == 0 {
            0
        } else {
            allocations() - before
        };
    }
    assert_eq!(during, 0);
    let turned = |(_, body): (BodyId, &nearmiss::Body)| !body.orientation.is_fixed();
    assert!(scene.bodies().all(turned));
}

/// Each frame, by the same orbits.
#[test]
fn a_screening_of_an_updated_scene_allocates_no_more_than_one_of_the_same_scene() {
    support::on_threads(1, || {
        let mut rng = support::rng(7);
        let mut scene = Scene::new();
        let mut plans = Vec::new();
        for _ in 0..300 {
            let flown = circling(Outside::Absent, &mut rng);
            let body = Trajectory::coasting(state_at(&flown, 0.0)).unwrap();
            plans.push((scene.insert(nearmiss::Body::new(body)).unwrap(), flown));
        }
        let of_frame = |scene: &mut Scene, now: f64, is_told: bool| {
            let window = Window::new(now, now + 2.0).unwrap();
            let query = Query::new(window).with_margin(1.0);
            let before = allocations();
            if is_told {
                let states = plans.iter().map(|(id, flown)| (*id, state_at(flown, now)));
                scene.update(states).unwrap();
            }
            let during = allocations() - before;
            assert!(!scene.screen(&query).unwrap().conflicts.is_empty());
            (during, allocations() - before)
        };
        let times = || (0..120).map(|frame| f64::from(frame) / 12.0);
        // Two rounds, after which no buffer has anything new to hold.
        for now in times().chain(times()) {
            of_frame(&mut scene, now, true);
        }
        let mut told = 0;
        for now in times() {
            let (update, updated) = of_frame(&mut scene, now, true);
            let (_, unchanged) = of_frame(&mut scene, now, false);
            assert_eq!(update, 0, "{now} s");
            assert!(updated <= unchanged, "{now} s: {updated} {unchanged}");
            told += unchanged;
        }
        assert!(told > 0, "{told}");
    });
}

/// What a screening works in is left to the next one of the same scene; a clone begins without it.
#[test]
fn a_second_screening_works_in_the_memory_of_the_first() {
    let scene = support::scene_of(&support::swarm(3, 300, 60.0));
    support::on_threads(1, || {
        for method in Method::EVERY {
            let query = Query::default().with_margin(1.0);
            let query = query.with_method(method);
            let of_screening = |scene: &Scene| {
                let before = (allocations(), BYTES.get());
                assert!(!scene.screen(&query).unwrap().conflicts.is_empty());
                (allocations() - before.0, BYTES.get() - before.1)
            };
            of_screening(&scene);
            let again = [(); 3].map(|()| of_screening(&scene));
            let fresh = of_screening(&scene.clone());
            println!("{method:?}: {again:?}, without what was left {fresh:?}");
            assert_eq!(again, [again[0]; 3], "{method:?}");
            let [count, bytes] = [fresh.0 - again[0].0, (fresh.1 - again[0].1) as u64];
            // Its lists are some 65; the boxes of a block of slices alone take 64 bytes a body in each.
            assert!(count > 50, "{method:?}: {count} fewer");
            assert!(bytes > 4 * 64 * 300, "{method:?}: {bytes} bytes fewer");
        }
    });
}

/// Each once a round: meanwhile it is cut beyond its knot, maybe several times.
#[test]
fn a_tick_with_bodies_told_now_and_then_allocates_nothing() {
    for told in [dead_reckoning as Told, extrapolation] {
        let course = Course {
            replanned: 1,
            every: 15,
            told,
            ..Course::UNTOLD
        };
        assert_eq!(allocations_of_ticks(course), 0);
    }
}

#[test]
fn the_counter_counts() {
    // One vector, one allocation.
    let before = allocations();
    drop(std::hint::black_box(vec![1_u8]));
    assert_eq!(allocations() - before, 1);
}
