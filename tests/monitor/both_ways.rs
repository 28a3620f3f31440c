//! Where most is to be compared with most, a tick searches all of the lookahead from nothing; else
//! it compares what changed, slice by slice. Both tell the same.

use super::support::{bits, line, rng, vector, wander, with_every_change};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Command, Event, Hitbox, Monitor, Scene, State, Trajectory,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::ops::Range;

const LEVELS: [AlertLevel; 2] = [AlertLevel::at(2.0).with_release(3.0), AlertLevel::at(0.5)];

fn body(rng: &mut ChaCha8Rng, now: f64) -> Body {
    let plan = if rng.random_bool(0.2) {
        line(now, now + 40.0, vector(rng, 20.0), vector(rng, 3.0))
    } else {
        let states = wander(rng, now, 20, 1.0, 40.0, 4.0);
        Trajectory::from_states(&states).unwrap()
    };
    let hitbox = Hitbox::sphere(rng.random_range(0.0..0.5)).unwrap();
    Body::new(plan).with_hitbox(hitbox)
}

/// Number of bodies that are parked far from all others.
const PARKED: u32 = 1_200;

/// Returns the trajectory of a parked body.
fn parked(rng: &mut ChaCha8Rng, number: u32) -> Trajectory {
    let place = DVec3::X * (1_000.0 + 100.0 * f64::from(number));
    Trajectory::at_rest(place + vector(rng, 1.0)).unwrap()
}

/// The ways in which bodies come to move otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    /// Each by a command.
    Plans,
    /// All by one call, which tells where they are.
    Told,
}

#[test]
fn a_search_from_nothing_tells_what_slices_tell() {
    both_tell_the_same(Change::Plans, 0..12);
}

#[test]
fn a_search_from_nothing_of_told_bodies_tells_what_slices_tell() {
    both_tell_the_same(Change::Told, 12..18);
}

/// Lets two monitors live the same life: shares of all bodies change, bodies come and go, and the clock jumps. Parked bodies meet
/// nobody. Those of one monitor change as often as others, so that most bodies do; those of the other one never do.
fn both_tell_the_same(change: Change, seeds: Range<u64>) {
    let (mut reported, mut differ) = (0, 0);
    let lives = seeds.clone().count();
    for seed in seeds {
        let mut rng = rng(seed);
        let mut scene = Scene::new();
        let mut ids: Vec<BodyId> = (0..60)
            .map(|_| scene.insert(body(&mut rng, 0.0)).unwrap())
            .collect();
        let parked_ids: Vec<BodyId> = (0..PARKED)
            .map(|number| {
                let parked = parked(&mut rng, number);
                scene.insert(Body::new(parked)).unwrap()
            })
            .collect();
        let monitor_of = |scene| with_every_change(Monitor::new(scene, 0.0, 5.0, &LEVELS).unwrap());
        let mut monitors = [monitor_of(scene.clone()), monitor_of(scene)];
        let mut now = 0.0;
        for step in 0..60 {
            let share = [0.0, 0.05, 0.6, 1.0, 1.0, 1.0][rng.random_range(0..6)];
            let (mut commands, mut told) = (Vec::new(), Vec::new());
            for &id in &ids {
                if !rng.random_bool(share) {
                    continue;
                }
                match change {
                    Change::Plans => {
                        let plan = body(&mut rng, now).trajectory;
                        commands.push(Command::SetTrajectory(id, plan));
                    }
                    Change::Told => told.push(id),
                }
            }
            if rng.random_bool(0.2) {
                let gone = ids.swap_remove(rng.random_range(0..ids.len()));
                commands.retain(|one| !matches!(one, Command::SetTrajectory(id, _) if *id == gone));
                told.retain(|id| *id != gone);
                commands.push(Command::Remove(gone));
                commands.push(Command::Insert(body(&mut rng, now)));
            }
            // Far jumps are late: after one, ticks search from nothing for a while.
            now += match step {
                40 => 7.0,
                50 => 4.0,
                _ => rng.random_range(0.0..0.3),
            };
            let told = told.into_iter().map(|id| {
                let age = [0.0, 0.0, 0.1, -2.0][rng.random_range(0..4)];
                let (place, velocity) = (vector(&mut rng, 20.0), vector(&mut rng, 3.0));
                (id, State::new(now - age, place, velocity))
            });
            let told: Vec<(BodyId, State)> = told.collect();
            let mut events: [Vec<Event>; 2] = [Vec::new(), Vec::new()];
            let moves = parked_ids.iter().zip(0..).filter_map(|(&id, number)| {
                let parked = parked(&mut rng, number);
                (share >= 1.0).then_some(Command::SetTrajectory(id, parked))
            });
            let moves = [moves.collect(), Vec::new()];
            let mut new = Vec::new();
            for ((monitor, events), moves) in monitors.iter_mut().zip(&mut events).zip(moves) {
                monitor.apply(moves).unwrap();
                new = monitor.apply(commands.clone()).unwrap();
                monitor.track(now, told.iter().copied()).unwrap();
                monitor.advance(now, events).unwrap();
            }
            ids.extend(new);
            assert_eq!(events[0], events[1], "{seed} {step}");
            for level in 0..LEVELS.len() {
                let conflicts =
                    [&monitors[0], &monitors[1]].map(|one| bits(one.conflicts(level).unwrap()));
                assert_eq!(conflicts[0], conflicts[1], "{seed} {step}");
            }
            let id = ids[rng.random_range(0..ids.len())];
            let idea = body(&mut rng, now).trajectory;
            let answers =
                [&monitors[0], &monitors[1]].map(|one| bits(&one.what_if(id, &idea, 0).unwrap()));
            assert_eq!(answers[0], answers[1], "{seed} {step}");
            reported += events[0].len();
            let [one, other] = [&monitors[0], &monitors[1]].map(|one| one.stats().boxes);
            differ += usize::from(one != other);
        }
    }
    assert!(reported > 800 * lives, "{reported}");
    assert!(differ > 8 * lives, "both ways were gone: {differ}");
}
