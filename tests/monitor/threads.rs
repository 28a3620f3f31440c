//! Any number of threads: the same conflicts and events, while few and many plans change.

use super::support::{bits, hash_of, line, on_threads, rng, vector, wander, with_every_change};
use super::{LEVELS, is_as_screened};
use nearmiss::glam::DVec3;
use nearmiss::{
    Body, BodyId, Command, Hitbox, Monitor, Outside, Query, Scene, State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// So many that threads share the slices, the changed bodies and the reading of what was found.
const BODIES: usize = 2_000;

/// Eight seconds or so from half a second before the clock on.
fn plan(rng: &mut ChaCha8Rng, now: f64) -> Trajectory {
    let states = wander(rng, now - 0.5, 8, 1.2, 120.0, 4.0);
    let outside = [Outside::Absent, Outside::Coast][rng.random_range(0..2)];
    let plan = Trajectory::from_states(&states).unwrap();
    plan.with_outside(outside)
}

/// All that is reported on the way, and how much of it there was.
fn flown(threads: usize) -> (Vec<u64>, usize, usize) {
    let mut rng = rng(43);
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..BODIES)
        .map(|_| {
            let hitbox = Hitbox::sphere(rng.random_range(0.0..0.5)).unwrap();
            let body = Body::new(plan(&mut rng, 0.0)).with_hitbox(hitbox);
            scene.insert(body).unwrap()
        })
        .collect();
    on_threads(threads, || {
        let mut monitor = with_every_change(Monitor::new(scene, 0.0, 2.0, &LEVELS).unwrap());
        let (mut reported, mut conflicts, mut events) = (Vec::new(), 0, 0);
        for tick in 0..24 {
            let now = monitor.now();
            let count = [0, 3, 40, 600, BODIES][tick % 5];
            let first = rng.random_range(0..BODIES);
            let changed = ids.iter().cycle().skip(first).take(count);
            let commands = changed.map(|&id| Command::Replan(id, now, plan(&mut rng, now).into()));
            let commands: Vec<Command> = commands.collect();
            monitor.apply(commands).unwrap();
            let mut news = Vec::new();
            monitor.advance(now + 0.1, &mut news).unwrap();
            // The shortest text that gives the same number back: all bits.
            let mut hashes = vec![hash_of(&format!("{news:?}"))];
            for level in 0..LEVELS.len() {
                hashes.push(hash_of(&bits(monitor.conflicts(level).unwrap())));
            }
            reported.push(hash_of(&hashes));
            conflicts += monitor.conflicts(0).unwrap().len();
            events += news.len();
        }
        is_as_screened(&monitor, LEVELS[0]);
        (reported, conflicts, events)
    })
}

#[test]
fn threads_make_no_difference() {
    let one = flown(1);
    println!("{} conflicts and {} events", one.1, one.2);
    assert!(one.1 > 20_000 && one.2 > 10_000);
    for threads in [2, 4] {
        assert!(flown(threads) == one, "{threads} threads");
    }
}

/// So many that threads share their boxes and their turns.
const TRACKED: usize = 5_000;

/// Returns what is reported, and found by screenings, where the states of nearly all bodies are told each frame.
fn tracked(threads: usize) -> (Vec<u64>, usize, usize) {
    const CUBE: f64 = 90.0;
    const FRAME: f64 = 0.05;
    let mut rng = rng(47);
    let mut scene = Scene::new();
    let mut world: Vec<(DVec3, DVec3)> = (0..TRACKED)
        .map(|_| (vector(&mut rng, CUBE / 2.0), vector(&mut rng, 4.0)))
        .collect();
    let ids: Vec<BodyId> = (0..TRACKED)
        .map(|number| {
            let (place, velocity) = world[number];
            let motion = match number % 50 {
                0 => line(-1.0, 9.0, place - velocity, velocity).with_outside(Outside::Coast),
                // Ends soon, and is told nothing.
                1 => line(-1.0, 0.3, place - velocity, velocity),
                _ => Trajectory::coasting(State::new(0.0, place, velocity)).unwrap(),
            };
            let hitbox = Hitbox::sphere(rng.random_range(0.0..0.5)).unwrap();
            scene.insert(Body::new(motion).with_hitbox(hitbox)).unwrap()
        })
        .collect();
    on_threads(threads, || {
        let monitor = Monitor::new(scene.clone(), 0.0, 1.0, &LEVELS).unwrap();
        let mut monitor = with_every_change(monitor);
        let (mut reported, mut conflicts, mut events) = (Vec::new(), 0, 0);
        for tick in 0..12 {
            let now = FRAME * f64::from(tick);
            for (place, velocity) in &mut world {
                *place += *velocity * FRAME;
                if rng.random_bool(0.2) {
                    *velocity = vector(&mut rng, 4.0);
                }
            }
            // All, or all but some of them; the first ones follow their plans for some time.
            let count = TRACKED - [0, 1, 700, 1_500][rng.random_range(0..4)];
            let some = ids.iter().zip(&world);
            let some = some.skip(if tick < 4 { 60 } else { 0 }).take(count);
            let some = some.filter(|(id, _)| id.slot() % 50 != 1);
            let states =
                some.map(|(&id, &(place, velocity))| (id, State::new(now, place, velocity)));
            let states: Vec<_> = states.collect();
            scene.update(states.iter().copied()).unwrap();
            let window = Window::new(now, now + 1.0).unwrap();
            let found = scene.screen(&Query::new(window).with_margin(1.0)).unwrap();
            conflicts += found.conflicts.len();
            reported.push(hash_of(&bits(&found.conflicts)));
            monitor.track(now, states).unwrap();
            let mut news = Vec::new();
            monitor.advance(now, &mut news).unwrap();
            reported.push(hash_of(&format!("{news:?}")));
            events += news.len();
        }
        is_as_screened(&monitor, LEVELS[0]);
        (reported, conflicts, events)
    })
}

#[test]
fn threads_that_share_states_make_no_difference() {
    let one = tracked(1);
    println!("{} conflicts and {} events", one.1, one.2);
    assert!(one.1 > 10_000 && one.2 > 10_000);
    for threads in [2, 4] {
        assert!(tracked(threads) == one, "{threads} threads");
    }
}

/// So many that threads share the bodies of a slice.
const REPLANNED: usize = 5_000;

/// Returns what is reported where all bodies get other plans before each tick, some of which end within the lookahead;
/// and the number of conflicts.
fn replanned(threads: usize) -> (Vec<u64>, usize) {
    const LOOKAHEAD: f64 = 5.0;
    let mut rng = rng(51);
    let mut plan = |now: f64, place: Option<DVec3>| {
        let segments = [3, 9][usize::from(rng.random_bool(0.7))];
        let mut states = wander(&mut rng, now, segments, 1.2, 300.0, 4.0);
        // It begins where the body is.
        let way = place.map_or(DVec3::ZERO, |place| place - states[0].position);
        states.iter_mut().for_each(|state| state.position += way);
        Trajectory::from_states(&states).unwrap()
    };
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..REPLANNED)
        .map(|_| scene.insert(Body::new(plan(0.0, None))).unwrap())
        .collect();
    on_threads(threads, || {
        let monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &LEVELS).unwrap();
        let mut monitor = with_every_change(monitor);
        let (mut reported, mut conflicts, mut news) = (Vec::new(), 0, Vec::new());
        for _ in 0..4 {
            let now = monitor.now();
            let replan = |&id: &BodyId| {
                let place = monitor.scene().body(id).unwrap().trajectory.position(now);
                Command::Replan(id, now, plan(now, place).into())
            };
            let commands: Vec<Command> = ids.iter().map(replan).collect();
            monitor.apply(commands).unwrap();
            news.clear();
            monitor.advance(now + 0.1, &mut news).unwrap();
            let found = monitor.conflicts(0).unwrap();
            conflicts += found.len();
            reported.push(hash_of(&(format!("{news:?}"), bits(found))));
        }
        is_as_screened(&monitor, LEVELS[0]);
        (reported, conflicts)
    })
}

#[test]
fn threads_that_share_plans_make_no_difference() {
    let one = replanned(1);
    println!("{} conflicts", one.1);
    assert!(one.1 > 1_000);
    for threads in [2, 3] {
        assert!(replanned(threads) == one, "{threads} threads");
    }
}
