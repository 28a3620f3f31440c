//! Where a window is cut, and on which side of an instant: what the window says, and nothing more.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::internals::QueryInternals;
use nearmiss::{
    Accuracy, AlertLevel, Body, Clip, Conflict, Hitbox, Monitor, Outside, Query, Scene, State,
    Trajectory, Window,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::num::NonZeroU32;
use support::{bits, line, scene_of, screen, swarm, with_every_change};

const MARGIN: f64 = 1.5;

/// What a window shows of a scene's conflicts is these, clipped to it. Gives how many it cuts.
fn assert_clipped(found: &[Conflict], whole: &[Conflict], (start, end): (f64, f64)) -> usize {
    let mut cut_inside = 0;
    let expected: Vec<&Conflict> = whole
        .iter()
        .filter(|c| c.exit >= start && c.enter <= end)
        .collect();
    assert_eq!(found.len(), expected.len(), "{start} {end}");
    for full in expected {
        let same_pair = |c: &&Conflict| {
            (c.a, c.b) == (full.a, full.b) && c.enter.to_bits() == full.enter.max(start).to_bits()
        };
        let part = found.iter().find(same_pair).unwrap();
        assert_eq!(part.exit.to_bits(), full.exit.min(end).to_bits());
        let cut = full.enter < start || full.exit > end;
        if cut {
            cut_inside += 1;
            assert!(part.closest.separation >= full.closest.separation);
            let clip = Clip {
                at_enter: full.clip.at_enter || full.enter <= start,
                at_exit: full.clip.at_exit || full.exit >= end,
            };
            assert_eq!(part.clip, clip);
        } else if start < full.enter && full.exit < end {
            // Wholly inside: the same bits.
            assert_eq!(bits(&[*part]), bits(&[*full]));
        }
    }
    cut_inside
}

#[test]
fn a_window_only_clips() {
    // Denser than elsewhere: many conflicts that a cut goes through.
    // Cubics, and straight motions from states that are older and younger than the windows.
    let cubics = scene_of(&swarm(4, 60, 15.0));
    let straight = coasting(&swarm(4, 240, 15.0));
    for scene in [cubics, straight] {
        for accuracy in [Accuracy::Exact, Accuracy::Certified] {
            let found = |(start, end)| {
                let query = Query::new(Window::new(start, end).unwrap());
                let query = query.with_margin(MARGIN).with_accuracy(accuracy);
                scene.screen(&query).unwrap().conflicts
            };
            let whole = found((-100.0, 200.0));
            let mut cut_inside = 0;
            for window in [
                (3.0, 9.0),
                (7.5, 7.5),
                (8.0, 8.25),
                (-5.0, 4.0),
                (15.0, 99.0),
            ] {
                cut_inside += assert_clipped(&found(window), &whole, window);
            }
            let is_enough = whole.len() > 50 && cut_inside > 10;
            assert!(is_enough, "{} {cut_inside}", whole.len());
        }
    }
}

/// Returns a scene of bodies that keep the velocity of one of their states.
fn coasting(bodies: &[(Vec<State>, f64)]) -> Scene {
    let mut scene = Scene::new();
    for (number, (states, radius)) in bodies.iter().enumerate() {
        let motion = Trajectory::coasting(states[number % states.len()]).unwrap();
        let hitbox = Hitbox::sphere(*radius).unwrap();
        scene.insert(Body::new(motion).with_hitbox(hitbox)).unwrap();
    }
    scene
}

/// Reported instants are rounded: where a window begins or ends at one, the motion may be beyond the
/// margin there by more than any rounding of positions. At 1.7e9 s and 5 m/s it is by a micrometre.
#[test]
fn a_window_may_begin_or_end_at_a_reported_instant() {
    for (seed, epoch) in [(11, 0.0), (12, 1.7e9)] {
        let mut bodies = swarm(seed, 40, 15.0);
        for (states, _) in &mut bodies {
            for state in states {
                state.time += epoch;
            }
        }
        let scene = scene_of(&bodies);
        let whole = screen(&scene, Window::ALL, MARGIN);
        assert!(whole.len() > 50);
        for one in &whole {
            for window in [
                (one.exit, one.exit),
                (one.exit, one.exit + 1.0),
                (one.enter, one.enter),
                (one.enter - 1.0, one.enter),
                (one.exit.next_up(), one.exit + 1.0),
                (one.enter - 1.0, one.enter.next_down()),
            ] {
                for slices in [None, NonZeroU32::new(7)] {
                    let mut query =
                        Query::new(Window::new(window.0, window.1).unwrap()).with_margin(MARGIN);
                    if let Some(slices) = slices {
                        query = query.with_slices(slices);
                    }
                    let found = scene.screen(&query).unwrap().conflicts;
                    assert_clipped(&found, &whole, window);
                }
            }
        }
    }
}

/// An encounter that begins just after a body's last knot, at an instant that rounds to it, is in a
/// window that ends there, whoever else is in the scene.
#[test]
fn an_instant_that_rounds_to_a_last_knot() {
    let t = 1.7e9;
    let coasts = line(t - 10.0, t, DVec3::X * -50.0, DVec3::X * 5.0);
    let jumps = line(t - 10.0, t + 9.0, DVec3::X * 1e6, DVec3::X);
    let jumps = jumps.spliced(t, &line(t - 10.0, t + 9.0, DVec3::Y * 1e6, DVec3::X));
    for third in [None, Some(jumps.unwrap())] {
        let mut scene = Scene::new();
        let place = DVec3::X * (1.0 + 4e-7);
        for plan in [
            Some(coasts.clone().with_outside(Outside::Coast)),
            Some(Trajectory::at_rest(place).unwrap()),
            third,
        ] {
            plan.map(|plan| scene.insert(Body::new(plan)).unwrap());
        }
        for start in [t - 8.0, t] {
            let found = screen(&scene, Window::new(start, t).unwrap(), 1.0);
            let times: Vec<_> = found.iter().map(|c| (c.enter, c.exit)).collect();
            assert_eq!(times, [(t, t)]);
        }
    }
}

/// Bodies in one place at time 0, most of which part there: encounters of no duration among others.
/// Of plans that begin at 0 there, all that is told, and when.
fn told_at_zero(zero: impl Fn(u64) -> f64) -> (String, String) {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut scene = Scene::new();
    for number in 0..24 {
        let time = zero(number);
        let from = f64::from(rng.random_range(0..3)) * DVec3::X;
        let velocity = f64::from(rng.random_range(-2..=2)) * DVec3::Y;
        let times = match number % 3 {
            0 => vec![time, 1.0, 2.0],
            1 => vec![-1.0, time],
            _ => vec![-1.0, time, 2.0],
        };
        let states: Vec<State> = times
            .iter()
            .map(|&time| State::new(time, from + velocity * time, velocity))
            .collect();
        let plan = Trajectory::from_states(&states).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let conflicts = screen(&scene, Window::new(zero(7), 2.0).unwrap(), 0.0);
    let levels = [AlertLevel::at(0.0)];
    let mut monitor = with_every_change(Monitor::new(scene, zero(8), 0.5, &levels).unwrap());
    let mut events = Vec::new();
    for now in [zero(9), 0.5, 1.0] {
        monitor.advance(now, &mut events).unwrap();
    }
    monitor.close(&mut events);
    assert!(conflicts.iter().any(|conflict| conflict.exit <= 0.0));
    (format!("{conflicts:?}"), format!("{events:?}"))
}

#[test]
fn which_zero_a_time_is() {
    let positive = told_at_zero(|_| 0.0);
    assert_eq!(told_at_zero(|_| -0.0), positive);
    let mixed = |number| if number % 2 == 0 { 0.0 } else { -0.0 };
    assert_eq!(told_at_zero(mixed), positive);
}

/// A plan that jumps is in two places at one instant, and both count in a window that begins or ends
/// there: also where the jump is at the first or the last knot of a plan that goes on beyond them.
#[test]
fn both_sides_of_a_jump_count() {
    let at = |y: f64| line(0.0, 10.0, DVec3::new(0.0, y, 0.0), DVec3::X);
    let still = |start: f64, end: f64| line(start, end, DVec3::new(5.0, 0.0, 0.0), DVec3::ZERO);
    let coasting = |plan: Trajectory| plan.with_outside(Outside::Coast);
    // Also one that goes on where its plan begins or ends at the jump.
    let others = [
        still(-100.0, 100.0),
        coasting(still(5.0, 9.0)),
        coasting(still(3.0, 5.0)),
        coasting(still(5.0, 5.5)),
    ];
    for outside in [Outside::Absent, Outside::Coast, Outside::Extrapolate] {
        // Beside the other body until it jumps away, and the other way round.
        for (before, after) in [(0.0, 50.0), (50.0, 0.0)] {
            let flown = at(before).with_outside(outside);
            let plan = at(after).with_outside(outside);
            // In the middle, at the first knot that is left, and after the last one.
            let joined = flown.spliced(5.0, &plan).unwrap();
            let mut jumps = vec![joined.clone().trimmed_before(5.0), joined];
            if outside == Outside::Coast {
                let begins = line(5.0, 10.0, DVec3::new(5.0, after, 0.0), DVec3::X);
                let coasts = line(7.0, 10.0, DVec3::new(7.0, before, 0.0), DVec3::X);
                let ended = line(0.0, 3.0, DVec3::new(0.0, after, 0.0), DVec3::X);
                for (flown, plan) in [(&coasts, &begins), (&flown, &ended), (&coasts, &ended)] {
                    let flown = flown.clone().with_outside(outside);
                    let plan = plan.clone().with_outside(outside);
                    jumps.push(flown.spliced(5.0, &plan).unwrap());
                }
            }
            let pairs = jumps
                .iter()
                .flat_map(|jumps| others.iter().map(move |other| (jumps, other)));
            for (trajectory, other) in pairs {
                let mut scene = Scene::new();
                let a = scene.insert(Body::new(trajectory.clone())).unwrap();
                let b = scene.insert(Body::new(other.clone())).unwrap();
                for (start, end) in [(4.0, 6.0), (5.0, 6.0), (4.0, 5.0), (5.0, 5.0)] {
                    let window = Window::new(start, end).unwrap();
                    let found = screen(&scene, window, 0.5);
                    let beside = if before < after {
                        (start.max(4.5), 5.0)
                    } else {
                        (5.0, end.min(5.5))
                    };
                    let times: Vec<_> = found.iter().map(|c| (c.enter, c.exit)).collect();
                    assert_eq!(times, [beside], "{start} {end} {trajectory:?} {other:?}");
                    let closest = scene.closest_approach(a, b, window).unwrap().unwrap();
                    assert_eq!(closest, found[0].closest);
                }
            }
        }
    }
}

/// The closest approach is at the last knot of a plan that goes on, where the other body ends. The velocity has the same
/// bits however far beyond the knot is looked, and when a monitor first saw the pair.
#[test]
fn a_velocity_at_the_last_knot_is_the_same_in_all_windows() {
    let (end, velocity) = (8.0_f64, -0.1_f64);
    let state =
        |time: f64, height: f64, speed: f64| State::new(time, DVec3::Z * height, DVec3::Z * speed);
    // Of some plans, the velocity that the cubic has at its end is not quite the one that was given.
    let plans = (1..100).map(|number| {
        let start = state(0.3, 0.7 + 0.01 * f64::from(number), -0.3);
        Trajectory::from_states(&[start, state(end, 0.0, velocity)]).unwrap()
    });
    let is_off =
        |plan: &Trajectory| plan.segments()[0].motion_at(end).1.z.to_bits() != velocity.to_bits();
    let plans: Vec<Trajectory> = plans.filter(is_off).collect();
    assert!(plans.len() > 10, "{}", plans.len());
    let floor = Hitbox::half_space(DVec3::Z).unwrap();
    let ground = line(0.0, end, DVec3::ZERO, DVec3::ZERO);
    for (outside, plan) in [Outside::Coast, Outside::Extrapolate]
        .into_iter()
        .flat_map(|outside| plans.iter().map(move |plan| (outside, plan)))
    {
        let ball = Body::new(plan.clone().with_outside(outside));
        let ends = Body::new(ground.clone()).with_hitbox(floor.clone());
        let mut scene = Scene::new();
        scene.insert(ball).unwrap();
        scene.insert(ends).unwrap();
        let at = |until: f64| {
            let found = screen(&scene, Window::new(7.6, until).unwrap(), 0.001);
            found[0].closest
        };
        let level = AlertLevel::at(0.001);
        let mut monitor = Monitor::new(scene.clone(), 4.0, 0.5, &[level]).unwrap();
        for now in [5.5, 7.6] {
            monitor.advance(now, &mut Vec::new()).unwrap();
        }
        assert_eq!(at(end).time.to_bits(), end.to_bits());
        assert_eq!(at(end), at(8.1));
        assert_eq!(monitor.conflicts(0).unwrap()[0].closest, at(8.1));
    }
}

/// A body follows another plan from the instant of the closest approach on, whose knots are over by then. The velocity is
/// that of the new plan, whatever a monitor knew of it when it first saw the pair.
#[test]
fn a_velocity_at_a_jump_beyond_all_knots_is_the_new_one() {
    let jump = 50.0_f64;
    let along = |start: f64, end: f64, at_jump: f64, speed: f64| {
        line(
            start,
            end,
            DVec3::X * (at_jump + (start - jump) * speed),
            DVec3::X * speed,
        )
    };
    let flown = along(-1.0, 60.0, -1.0, 0.1);
    for outside in [Outside::Coast, Outside::Extrapolate] {
        let next = along(20.0, 30.0, -100.0, -7.0).with_outside(outside);
        let mut scene = Scene::new();
        let plan = flown.spliced(jump, &next).unwrap();
        scene.insert(Body::new(plan)).unwrap();
        let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
        scene.insert(Body::new(rest)).unwrap();
        let level = AlertLevel::at(3.0);
        let mut monitor = Monitor::new(scene.clone(), 45.0, 2.0, &[level]).unwrap();
        for tick in 0..100 {
            let now = 45.0 + 0.05 * f64::from(tick);
            monitor.advance(now, &mut Vec::new()).unwrap();
            let window = Window::new(now, now + 2.0).unwrap();
            let screened = screen(&scene, window, 3.0);
            assert_eq!(monitor.conflicts(0).unwrap(), screened, "{now}");
            let closest = screened[0].closest;
            let is_at_jump = closest.time.to_bits() == jump.to_bits();
            let expected = if is_at_jump { -7.0 } else { 0.1 };
            assert!(
                (closest.relative_velocity.x - expected).abs() < 1e-12,
                "{closest:?}"
            );
        }
        let last = monitor.conflicts(0).unwrap()[0].closest;
        assert_eq!(last.time.to_bits(), jump.to_bits());
    }
}

/// Coasting bodies that are outside by less than the solver's rounding, which grows with the way that they go in some
/// seconds: in or out, they are so in every window.
#[test]
fn a_window_decides_nothing_within_rounding() {
    let mut found = 0;
    for number in 0..2_000 {
        let distance = 1.0 + 0.001 * f64::from(number % 97);
        let share = 0.5_f64.powi(44 + number % 10) * (0.5 + 0.001 * f64::from(number % 499));
        let velocity = 1e9 * DVec3::new(0.6, 0.64, 0.48);
        let excess = 6e9 * share;
        let aside = DVec3::new(0.8, -0.48, -0.36).normalize() * (distance + excess);
        let mut scene = Scene::new();
        for position in [DVec3::new(0.3, 0.2, 0.1), aside + DVec3::new(0.3, 0.2, 0.1)] {
            let state = State::new(0.0, position, velocity);
            scene
                .insert(Body::new(Trajectory::coasting(state).unwrap()))
                .unwrap();
        }
        let count = |end: f64| {
            let query = Query::new(Window::new(0.0, end).unwrap()).with_margin(distance);
            scene.screen(&query).unwrap().conflicts.len()
        };
        let whole = count(5.0);
        for end in [0.0, 1e-6, 0.5] {
            assert_eq!(count(end), whole, "{number} {end}");
        }
        found += whole;
    }
    assert!(found > 100, "{found}");
}

/// The scale of rounding is that of whole cubics, also where a window holds the end of a long one alone: questions about one
/// body find what a screening finds.
#[test]
fn a_short_window_at_the_end_of_a_long_cubic() {
    let (mut found, mut missed) = (0, 0);
    for number in 0..400 {
        let way = 10_f64.powi(4 + number % 6);
        let state = |time: f64, y: f64| State::new(time, y * DVec3::Y, DVec3::ZERO);
        let plan = Trajectory::from_states(&[state(-1e3, way), state(1.0, 0.0)]).unwrap();
        let moving = Body::new(plan.with_outside(Outside::Coast));
        let excess = way * 0.5_f64.powi(38 + number % 14);
        let post = Body::new(Trajectory::at_rest((2.0 + excess) * DVec3::X).unwrap());
        let mut scene = Scene::new();
        let id = scene.insert(moving.clone()).unwrap();
        let query = Query::new(Window::new(0.999, 2.0).unwrap()).with_margin(2.0);
        let asked = scene.conflicts_with(&post, &query).unwrap();
        scene.insert(post).unwrap();
        let screened = scene.screen(&query).unwrap().conflicts;
        assert_eq!(bits(&asked), bits(&screened), "{number}");
        let again = scene.what_if(id, &moving.trajectory, &query).unwrap();
        assert_eq!(bits(&again), bits(&screened), "{number}");
        found += usize::from(!screened.is_empty());
        missed += usize::from(screened.is_empty());
    }
    assert!(found > 50 && missed > 50, "{found} {missed}");
}
