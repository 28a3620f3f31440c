//! Bodies that turn, against dense sampling with refinement of intervals.

#![allow(clippy::unwrap_used, reason = "a failure fails the test")]

mod extremes;
mod history;
mod invariance;
mod monitor;
mod turned_world;

use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, Body, BodyId, Conflict, Hitbox, Orientation, Outside, Query, Scene, Sphere, State,
    Trajectory, Window, pair,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::rc::Rc;

/// A body with bounds of the speed of its spheres' centres, m/s, and of their acceleration, m/s².
struct Moving {
    body: Body,
    speed: f64,
    acceleration: f64,
    /// Instants at which velocities jump, s, in time order.
    kinks: Vec<f64>,
    arm: f64,
}

/// A way of turning.
struct Turn {
    orientation: Orientation,
    /// Bounds of the first and second derivative of a rotation's columns, by s.
    rate: f64,
    bend: f64,
    kinks: Vec<f64>,
}

impl Turn {
    fn smooth(orientation: Orientation, rate: f64) -> Self {
        Self {
            orientation,
            rate,
            bend: rate * rate,
            kinks: Vec::new(),
        }
    }
}

fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| rng.random_range(-half..=half)))
}

fn rotation(rng: &mut ChaCha8Rng) -> DQuat {
    let any = [0; 4].map(|_| rng.random_range(-1.0..1.0));
    DQuat::from_array(any).normalize()
}

/// Returns an orientation of some kind over 0..duration (s).
fn orientation(rng: &mut ChaCha8Rng, kind: usize, (start, duration): (f64, f64)) -> Turn {
    match kind % 4 {
        0 => {
            // From slow to a hundred revolutions in all.
            let turns = 10f64.powf(rng.random_range(-1.5..2.0));
            let speed = turns * std::f64::consts::TAU / duration;
            let axis = vector(rng, 1.0).normalize();
            let time = start + rng.random_range(-1.0..1.0) * duration;
            let spin = Orientation::spin(time, rotation(rng), axis * speed);
            Turn::smooth(spin.unwrap(), speed * 1.001)
        }
        1 | 2 => {
            let count = rng.random_range(2..12);
            let times: Vec<f64> = (0..count)
                .map(|number| {
                    let share =
                        (f64::from(number) + rng.random_range(-0.3..0.3)) / f64::from(count - 1);
                    start + duration * (1.4 * share - 0.2)
                })
                .collect();
            let knots: Vec<(f64, DQuat)> = times
                .into_iter()
                .map(|time| (time, rotation(rng)))
                .collect();
            let outside = [Outside::Absent, Outside::Coast][rng.random_range(0..2)];
            let turn = if kind % 4 == 1 {
                Orientation::slerp(&knots)
            } else {
                Orientation::normalized_cubic(&knots)
            };
            let Ok(turn) = turn else {
                return Turn::smooth(Orientation::FIXED, 0.0);
            };
            let turn = turn.with_outside(outside);
            // Twice the largest differences between samples; those over a knot say too much.
            let steps = 4_000;
            let length = duration * 1.6 / f64::from(steps);
            let columns = (0..=steps).map(|step| {
                let time = start + duration * (1.6 * f64::from(step) / f64::from(steps) - 0.3);
                let rotation = turn.rotation(time);
                [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| rotation * axis)
            });
            let columns: Vec<[DVec3; 3]> = columns.collect();
            let largest = |of: fn(&[[DVec3; 3]], usize) -> DVec3, samples: usize| {
                let parts = columns.windows(samples);
                let all = parts.flat_map(|part| [0, 1, 2].map(|axis| of(part, axis).length()));
                all.fold(0.0, f64::max)
            };
            let rate = 2.0 * largest(|c, axis| c[1][axis] - c[0][axis], 2) / length;
            let bend = |c: &[[DVec3; 3]], axis: usize| c[2][axis] - 2.0 * c[1][axis] + c[0][axis];
            if kind % 4 == 1 {
                // At a constant rate between knots.
                let kinks = knots.iter().map(|knot| knot.0).collect();
                return Turn {
                    kinks,
                    ..Turn::smooth(turn, rate)
                };
            }
            Turn {
                bend: 2.0 * largest(bend, 3) / (length * length),
                kinks: [knots[0].0, knots[knots.len() - 1].0].into(),
                ..Turn::smooth(turn, rate)
            }
        }
        _ => Turn::smooth(Orientation::FIXED, 0.0),
    }
}

/// Returns a body within some metres of the origin over a time (s).
fn moving(rng: &mut ChaCha8Rng, kind: usize, (start, duration): (f64, f64)) -> Moving {
    let count = rng.random_range(2..6);
    let wild = [0.5, 3.0, 8.0][rng.random_range(0..3)];
    let drift = vector(rng, 6.0);
    let states: Vec<State> = (0..count)
        .map(|number| {
            let share = f64::from(number) / f64::from(count - 1);
            let place = drift * (2.0 * share - 1.0) + vector(rng, wild);
            let velocity = (2.0 * drift + vector(rng, wild)) / duration;
            State::new(start + share * duration, place, velocity)
        })
        .collect();
    let plan = Trajectory::from_states(&states).unwrap();
    let slope = plan.segments().iter().map(|segment| {
        let points = segment.control_points();
        let steps = points.windows(2).map(|two| two[0].distance(two[1]));
        3.0 * steps.fold(0.0, f64::max) / (segment.end() - segment.start())
    });
    let speed = slope.fold(0.0, f64::max);
    let spheres = (0..rng.random_range(1..6)).map(|_| Sphere {
        offset: vector(rng, 1.5),
        radius: rng.random_range(0.0..0.5),
    });
    let hitbox = Hitbox::cluster(spheres.collect()).unwrap();
    let arm = hitbox.spheres().iter().map(|sphere| sphere.offset.length());
    let arm = arm.fold(0.0, f64::max);
    let bends = plan.segments().iter().map(|segment| {
        let [p0, p1, p2, p3] = segment.control_points();
        let bend = (p2 - 2.0 * p1 + p0)
            .length()
            .max((p3 - 2.0 * p2 + p1).length());
        6.0 * bend / (segment.end() - segment.start()).powi(2)
    });
    let bend = bends.fold(0.0, f64::max);
    let turn = orientation(rng, kind, (start, duration));
    let body = Body::new(plan).with_hitbox(hitbox);
    Moving {
        body: body.with_orientation(turn.orientation),
        speed: speed + turn.rate * arm,
        acceleration: bend + turn.bend * arm,
        kinks: turn.kinks,
        arm,
    }
}

fn separation(a: &Body, b: &Body, time: f64) -> f64 {
    let (a, b) = (a.spheres_at(time).unwrap(), b.spheres_at(time).unwrap());
    let mut least = f64::INFINITY;
    for x in &a {
        for y in &b {
            least = least.min(x.offset.distance(y.offset) - x.radius - y.radius);
        }
    }
    least
}

/// The spheres of two bodies at an instant.
struct Instant {
    time: f64,
    spheres: [Vec<Sphere>; 2],
}

impl Instant {
    fn of(a: &Moving, b: &Moving, time: f64) -> Rc<Self> {
        let spheres = [a, b].map(|one| one.body.spheres_at(time).unwrap());
        Rc::new(Self { time, spheres })
    }

    /// Returns the least separation of two spheres whose relative position goes straight from that of
    /// one instant to that of another one.
    fn straight_to(&self, other: &Self) -> f64 {
        let mut least = f64::INFINITY;
        let [a, b] = &self.spheres;
        let [later_a, later_b] = &other.spheres;
        for (x, later_x) in a.iter().zip(later_a) {
            for (y, later_y) in b.iter().zip(later_b) {
                let start = x.offset - y.offset;
                let way = (later_x.offset - later_y.offset) - start;
                let share = -start.dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
                let nearest = start + share.clamp(0.0, 1.0) * way;
                least = least.min(nearest.length() - x.radius - y.radius);
            }
        }
        least
    }
}

/// The least separation over an interval to `fine` (m), by the speed and the acceleration at which it
/// can change; and its instant.
fn least(a: &Moving, b: &Moving, (from, to): (f64, f64), fine: f64, below: f64) -> (f64, f64) {
    let (speed, acceleration) = (a.speed + b.speed, a.acceleration + b.acceleration);
    let ends = [from, to].map(|time| Instant::of(a, b, time));
    let mut best = (f64::INFINITY, from);
    for end in &ends {
        let found = end.straight_to(end);
        if found < best.0 {
            best = (found, end.time);
        }
    }
    let is_smooth = |from: f64, to: f64| {
        let has_kink = |one: &Moving| one.kinks.iter().any(|&kink| from < kink && kink < to);
        !has_kink(a) && !has_kink(b)
    };
    let [first, last] = ends;
    let mut intervals = vec![(first, last)];
    let mut work = 0;
    while let Some((first, last)) = intervals.pop() {
        work += 1;
        assert!(work < 3_000_000, "too fine");
        let (from, to) = (first.time, last.time);
        // Between two instants a motion leaves the straight one by at most an eighth of its acceleration.
        let off = 0.125 * acceleration * (to - from).powi(2);
        let needed = (best.0 - fine).min(below);
        if is_smooth(from, to) && first.straight_to(&last) - off >= needed {
            continue;
        }
        let time = 0.5 * (from + to);
        let middle = Instant::of(a, b, time);
        let found = middle.straight_to(&middle);
        if found < best.0 {
            best = (found, time);
        }
        let reach = found - 0.5 * (to - from) * speed;
        if reach < (best.0 - fine).min(below) && from < time && time < to {
            intervals.push((first, middle.clone()));
            intervals.push((middle, last));
        }
    }
    best
}

struct Tally {
    conflicts: usize,
    unresolved: usize,
    slack: f64,
}

/// Checks one pair; returns what was found.
fn check(seed: u64, tally: &mut Tally) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let rng = &mut rng;
    let start = [0.0, 1e6][rng.random_range(0..2)];
    let duration = [1.0, 30.0][rng.random_range(0..2)];
    let over = (start, duration);
    let kinds = [rng.random_range(0..4), rng.random_range(0..3)];
    let (a, b) = (moving(rng, kinds[0], over), moving(rng, kinds[1], over));
    let mut scene = Scene::new();
    let ids = [&a, &b].map(|one| scene.insert(one.body.clone()).unwrap());
    let whole = (start, start + duration);
    let window = Window::new(whole.0, whole.1).unwrap();
    let fine = 1e-6;
    let (nearest, when) = least(&a, &b, whole, fine, f64::INFINITY);

    // The closest approach, to the error of the cubics and the sampling.
    let tolerance = 2.0 * 1e-3 * (a.arm + b.arm) + 1e-9;
    let found = scene
        .closest_approach(ids[0], ids[1], window)
        .unwrap()
        .unwrap();
    assert!(
        found.separation <= nearest + 1e-9,
        "{seed}: {found:?} {nearest}"
    );
    assert!(
        found.separation >= nearest - fine - tolerance,
        "{seed}: {found:?} {nearest}"
    );
    let proven = scene
        .certified_closest_approach(ids[0], ids[1], window)
        .unwrap()
        .unwrap();
    let (low, high) = (
        proven.approach.separation - proven.error,
        proven.approach.separation + proven.error,
    );
    assert!(
        low <= nearest + 1e-9 && high >= nearest - fine,
        "{seed}: {proven:?} {nearest}"
    );
    assert!(
        proven.error <= 1e-5 * (a.arm + b.arm) + 1e-9,
        "{seed}: {proven:?}"
    );
    if nearest < separation(&a.body, &b.body, proven.time.earliest) - 1e-3 {
        assert!(when >= proven.time.earliest - 1e-3 * duration, "{seed}");
    }

    // Margins around the least separation, and others.
    let margin = match rng.random_range(0..3) {
        0 => nearest + rng.random_range(-1e-3..1e-3),
        1 => nearest + rng.random_range(-1e-7..1e-7),
        _ => nearest + rng.random_range(0.0..2.0),
    };
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let query = Query::new(window)
            .with_margin(margin)
            .with_accuracy(accuracy);
        let conflicts = scene.screen(&query).unwrap().conflicts;
        check_conflicts((&a, &b), (ids, seed), margin, whole, &conflicts, tally);
    }
}

fn check_conflicts(
    (a, b): (&Moving, &Moving),
    (ids, seed): ([BodyId; 2], u64),
    margin: f64,
    (start, end): (f64, f64),
    conflicts: &[Conflict],
    tally: &mut Tally,
) {
    let fine = 1e-6;
    let mut from = start;
    let instant = 1e-9 * (end - start) + 4.0 * f64::EPSILON * end;
    for conflict in conflicts {
        assert_eq!([conflict.a, conflict.b], ids);
        let [enter, exit] = match &conflict.certificate {
            Some(proof) => [proof.enter.earliest, proof.exit.latest],
            None => [conflict.enter, conflict.exit],
        };
        if enter - instant > from {
            let (found, when) = least(a, b, (from, enter - instant), fine, margin);
            assert!(
                found > margin - 1e-9,
                "{seed}: {found} at {when}, margin {margin}"
            );
        }
        from = from.max(exit + instant);
        tally.conflicts += 1;
        let (inside, _) = least(a, b, (enter, exit), fine, f64::INFINITY);
        match &conflict.certificate {
            Some(proof) => {
                let off = (conflict.closest.separation - inside).abs();
                assert!(
                    off <= proof.error + fine + 1e-9,
                    "{seed}: {conflict:?} {inside}"
                );
                tally.slack = tally.slack.max(proof.error / (a.arm + b.arm));
                if proof.resolved {
                    assert!(inside <= margin + fine, "{seed}: {conflict:?} {inside}");
                    // All of the proven part is inside.
                    for step in 0..=50 {
                        let share = f64::from(step) / 50.0;
                        let (first, last) = (proof.enter.latest, proof.exit.earliest);
                        let there = separation(&a.body, &b.body, first + share * (last - first));
                        assert!(first > last || there <= margin + 1e-9, "{seed}: {there}");
                    }
                } else {
                    tally.unresolved += 1;
                }
            }
            None => {
                let tolerance = 2.0 * 1e-3 * (a.arm + b.arm) + 1e-9;
                assert!(
                    inside <= margin + fine + tolerance,
                    "{seed}: {conflict:?} {inside}"
                );
                assert!(conflict.closest.separation <= inside + 1e-9, "{seed}");
            }
        }
        let count = |one: &Moving| one.body.hitbox.spheres().len();
        assert!((conflict.closest.sphere_a as usize) < count(a));
        assert!((conflict.closest.sphere_b as usize) < count(b));
    }
    if from < end {
        let (found, when) = least(a, b, (from, end), fine, margin);
        assert!(
            found > margin - 1e-9,
            "{seed}: {found} at {when}, margin {margin}"
        );
    }
}

impl Tally {
    const NONE: Self = Self {
        conflicts: 0,
        unresolved: 0,
        slack: 0.0,
    };

    fn with(self, other: Self) -> Self {
        Self {
            conflicts: self.conflicts + other.conflicts,
            unresolved: self.unresolved + other.unresolved,
            slack: self.slack.max(other.slack),
        }
    }
}

fn campaign(seeds: std::ops::Range<u64>) -> Tally {
    let tallies = seeds.into_par_iter().map(|seed| {
        let mut tally = Tally::NONE;
        check(seed, &mut tally);
        tally
    });
    tallies.reduce(|| Tally::NONE, Tally::with)
}

/// Between two equal rotations a body may swing to one side and back. Where a segment of its plan is a part of that
/// time, so is its swing.
#[test]
fn a_part_of_a_swing_is_not_all_of_it() {
    let knots = [(0.0, 0.0), (1.0, 0.2), (2.0, 0.2), (3.0, 0.0)];
    let knots = knots.map(|(time, angle)| (time, DQuat::from_rotation_z(angle)));
    let swing = Orientation::normalized_cubic(&knots).unwrap();
    let arm = Sphere {
        offset: 10.0 * DVec3::X,
        radius: 0.0,
    };
    let states = [0.0, 1.4, 1.6, 3.0].map(|time| State::new(time, DVec3::ZERO, DVec3::ZERO));
    let other = Body::new(Trajectory::at_rest(10.0 * DVec3::X).unwrap());
    for tolerance in [1e-2, 1e-3] {
        let swinging = Body::new(Trajectory::from_states(&states).unwrap())
            .with_hitbox(Hitbox::cluster(vec![arm]).unwrap())
            .with_orientation(swing.clone().with_tolerance(tolerance).unwrap());
        for time in [1.0, 1.3, 1.4, 1.45, 1.5, 1.6, 2.0] {
            let window = Window::new(time, time).unwrap();
            let place = swinging.spheres_at(time).unwrap()[0].offset;
            let expected = place.distance(other.trajectory.position(time).unwrap());
            let nearest = pair::closest_approach(&swinging, &other, window).unwrap();
            let separation = nearest.unwrap().separation;
            assert!(
                separation <= expected && expected < separation + 20.0 * tolerance,
                "{time} s, tolerance {tolerance}: {separation} m, not {expected} m"
            );
            let proven = pair::certified_closest_approach(&swinging, &other, window).unwrap();
            let (proven, separation) = (proven.unwrap(), proven.unwrap().approach.separation);
            assert!(
                (separation - expected).abs() <= proven.error,
                "{time} s, tolerance {tolerance}: {separation} m is not within {proven:?}"
            );
        }
    }
}

#[test]
fn no_contact_is_lost_and_enclosures_hold() {
    let tally = campaign(0..150);
    assert!(tally.conflicts > 100, "{}", tally.conflicts);
}

/// `NEARMISS_SEEDS=0..100000 cargo test --release --test turning -- --ignored --nocapture`
#[test]
#[ignore = "takes minutes"]
fn campaign_of_many_pairs() {
    let seeds = std::env::var("NEARMISS_SEEDS").unwrap_or_else(|_| "1000..2000".into());
    let (first, last) = seeds.split_once("..").unwrap();
    let tally = campaign(first.parse().unwrap()..last.parse().unwrap());
    println!(
        "{} conflicts, {} unresolved, largest error {:e} of the arms",
        tally.conflicts, tally.unresolved, tally.slack
    );
}
