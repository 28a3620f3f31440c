//! Monitors of turning bodies against one-shot screening.

use super::{moving, rotation, vector};
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, BodyPlan, BodyState, Command, Conflict, Error, Event,
    Hitbox, Monitor, Orientation, Outside, Query, Scene, Sphere, State, Trajectory, Window, pair,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const LOOKAHEAD: f64 = 5.0;
const MARGIN: f64 = 0.5;

/// What a screening of the monitor's scene says from now to the end of its lookahead.
fn screened(monitor: &Monitor) -> Vec<Conflict> {
    screened_at(monitor, MARGIN)
}

fn screened_at(monitor: &Monitor, margin: f64) -> Vec<Conflict> {
    let window = Window::new(monitor.now(), monitor.complete_until()).unwrap();
    let query = Query::new(window).with_margin(margin);
    monitor.scene().screen(&query).unwrap().conflicts
}

fn body(rng: &mut ChaCha8Rng) -> Body {
    let kind = rng.random_range(0..4);
    let mut body = moving(rng, kind, (0.0, 10.0)).body;
    body.trajectory = body.trajectory.with_outside(Outside::Coast);
    body
}

fn spin(rng: &mut ChaCha8Rng, time: f64) -> Orientation {
    let velocity = vector(rng, 6.0);
    Orientation::spin(time, rotation(rng), velocity).unwrap()
}

fn plan(rng: &mut ChaCha8Rng, from: f64) -> Trajectory {
    let (place, velocity) = (vector(rng, 5.0), vector(rng, 3.0));
    let states = [0.0, 2.0, 6.0].map(|time| {
        State::new(
            from + time,
            place + time * velocity,
            velocity + vector(rng, 0.5),
        )
    });
    Trajectory::from_states(&states)
        .unwrap()
        .with_outside(Outside::Coast)
}

/// Bodies of all kinds are put in, told, replanned, oriented and taken out: after each tick the
/// monitor has the conflicts of a screening, bit for bit, and answers questions alike.
#[test]
fn monitors_say_what_screenings_say() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let rng = &mut rng;
    let mut scene = Scene::new();
    let mut ids: Vec<BodyId> = (0..24).map(|_| scene.insert(body(rng)).unwrap()).collect();
    let levels = [AlertLevel::at(MARGIN)];
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &levels).unwrap();
    let (mut events, mut found, mut asked) = (Vec::new(), 0, 0);
    for tick in 0..60_usize {
        let now = 0.1 * tick as f64;
        let id = ids[rng.random_range(0..ids.len())];
        let from = now + rng.random_range(-0.3..2.0);
        let (next, turn) = (plan(rng, from), spin(rng, from));
        match tick % 8 {
            0 => drop(monitor.replan(id, from, BodyPlan::new(next, turn)).unwrap()),
            1 => monitor.orient(id, from, turn).unwrap(),
            2 => {
                let told: Vec<(BodyId, BodyState)> = ids
                    .iter()
                    .skip(tick % 3)
                    .map(|&id| {
                        let state = State::new(now, vector(rng, 6.0), vector(rng, 2.0));
                        let turn = rotation(rng);
                        (id, BodyState::from(state).with_spin(turn, vector(rng, 4.0)))
                    })
                    .collect();
                monitor.track(now, told.iter().copied()).unwrap();
                // Told again: nothing changes.
                monitor.track(now, told).unwrap();
            }
            3 => {
                let ship = monitor.insert(body(rng)).unwrap();
                ids.push(ship);
            }
            4 => {
                let gone = ids.swap_remove(0);
                monitor.remove(gone).unwrap();
            }
            5 => {
                let batch = [
                    Command::Replan(id, from, next.into()),
                    Command::Orient(id, from + 0.5, turn.clone()),
                    Command::Orient(id, from + 1.5, Orientation::FIXED),
                ];
                monitor.apply(batch).unwrap();
            }
            6 => monitor.set_orientation(id, turn).unwrap(),
            _ => {
                // From where it is: at a jump a body is at both places.
                let clock = monitor.now();
                let ship = monitor.scene().body(id).unwrap();
                let state = ship.trajectory.state(clock).unwrap();
                let turn = ship.orientation.rotation(clock);
                let (velocity, spin) = (vector(rng, 3.0), vector(rng, 6.0));
                let ahead = State::new(clock, state.position, velocity);
                let next = Trajectory::coasting(ahead).unwrap();
                let idea = BodyPlan::new(next, Orientation::spin(clock, turn, spin).unwrap());
                // Alone, and together with another that stops turning where it is.
                let other_id = *ids.iter().find(|&&other| other != id).unwrap();
                let place = monitor
                    .scene()
                    .body(other_id)
                    .unwrap()
                    .trajectory
                    .state(clock);
                let rest = Trajectory::at_rest(place.unwrap().position).unwrap();
                let rest = BodyPlan::new(rest, Orientation::FIXED);
                let mut other = monitor.scene().clone();
                for ideas in [vec![(id, &idea)], vec![(other_id, &rest), (id, &idea)]] {
                    let would = monitor.what_if_plans(ideas.iter().copied(), 0).unwrap();
                    for &(id, idea) in &ideas {
                        let turn = idea.orientation.clone().unwrap();
                        other.set_trajectory(id, idea.trajectory.clone()).unwrap();
                        other.set_orientation(id, turn).unwrap();
                    }
                    let window = Window::new(clock, monitor.complete_until()).unwrap();
                    let query = Query::new(window).with_margin(MARGIN);
                    let mut expected = other.screen(&query).unwrap().conflicts;
                    let is_named = |id| ideas.iter().any(|(named, _)| *named == id);
                    expected.retain(|one| is_named(one.a) || is_named(one.b));
                    assert_eq!(would, expected);
                    asked += would.len();
                }
            }
        }
        monitor.advance(now, &mut events).unwrap();
        let expected = screened(&monitor);
        assert_eq!(monitor.conflicts(0).unwrap(), expected, "{tick}");
        found += expected.len();
    }
    assert!(
        found > 200 && asked > 5 && events.len() > 100,
        "{found} {asked} {}",
        events.len()
    );
}

/// A spin that is told each frame, and screened by a scene that is told as well.
#[test]
fn bodies_told_with_their_spin() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let rng = &mut rng;
    let arm = |offset| Sphere {
        offset,
        radius: 0.3,
    };
    let hitbox = Hitbox::cluster(vec![arm(DVec3::X), arm(-DVec3::X)]).unwrap();
    let mut scene = Scene::new();
    let ids: Vec<BodyId> = (0..8)
        .map(|_| {
            let rest = Trajectory::at_rest(vector(rng, 3.0)).unwrap();
            scene
                .insert(Body::new(rest).with_hitbox(hitbox.clone()))
                .unwrap()
        })
        .collect();
    let mut other = scene.clone();
    let levels = [AlertLevel::at(MARGIN)];
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &levels).unwrap();
    let mut found = 0;
    for tick in 1..40 {
        let now = f64::from(tick) / 60.0;
        let told: Vec<(BodyId, BodyState)> = ids
            .iter()
            .map(|&id| {
                let body = monitor.scene().body(id).unwrap();
                let place = body.trajectory.position(now).unwrap();
                let state = State::new(now, place, vector(rng, 1.0) - 0.1 * place);
                let turn = body.orientation.rotation(now);
                (id, BodyState::from(state).with_spin(turn, vector(rng, 4.0)))
            })
            .collect();
        monitor.track(now, told.iter().copied()).unwrap();
        other.update(told).unwrap();
        monitor.advance(now, &mut Vec::new()).unwrap();
        let conflicts = monitor.conflicts(0).unwrap();
        assert_eq!(conflicts, screened(&monitor));
        // From now on it is the same motion, cut at the same instants.
        let window = Window::new(now, now + LOOKAHEAD).unwrap();
        let query = Query::new(window).with_margin(MARGIN);
        let conflicts: Vec<_> = conflicts.iter().map(|one| (one.a, one.b)).collect();
        let others = other.screen(&query).unwrap().conflicts;
        assert_eq!(
            others.iter().map(|one| (one.a, one.b)).collect::<Vec<_>>(),
            conflicts
        );
        found += conflicts.len();
    }
    assert!(found > 100, "{found}");
    // Refused as a whole.
    let state = BodyState::from(State::new(1.0, DVec3::ZERO, DVec3::ZERO));
    let bad = state.with_spin(rotation(rng), 1e9 * DVec3::X);
    let before = monitor.scene().body(ids[0]).cloned();
    let refused = monitor.track(1.0, [(ids[0], state), (ids[1], bad)]);
    assert!(matches!(
        refused,
        Err(Error::InBody { error, .. }) if matches!(*error, Error::AngularSpeed { .. })
    ));
    assert_eq!(monitor.scene().body(ids[0]), before.as_ref());
    let refused = other.update([(ids[0], state), (ids[1], bad)]);
    assert!(matches!(refused, Err(Error::InBody { .. })));
}

/// In a batch, too: each plan brings its orientation, from the instant on from which it is followed.
#[test]
fn commands_carry_plans_that_turn() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let rng = &mut rng;
    for round in 0..40 {
        let mut scene = Scene::new();
        let id = scene.insert(body(rng)).unwrap();
        let levels = [AlertLevel::at(MARGIN)];
        let monitor = || Monitor::new(scene.clone(), 0.0, LOOKAHEAD, &levels).unwrap();
        let [mut together, mut in_turn, mut apart] = [(); 3].map(|()| monitor());
        let (first, second) = (plan(rng, 1.0), plan(rng, 7.0));
        let turns = [spin(rng, 1.0), spin(rng, 3.0)];
        let [a, b] = turns.clone();
        let (a, b) = (a.with_tolerance(1e-4).unwrap(), b);
        let [replan, extend] = [(&first, &a), (&second, &b)]
            .map(|(plan, turn)| BodyPlan::new(plan.clone(), turn.clone()));
        let batch = [
            Command::Replan(id, 1.0, replan.clone()),
            Command::Extend(id, extend.clone()),
        ];
        #[cfg(feature = "serde")]
        let batch = batch.map(|command| {
            let written = serde_json::to_string(&command).unwrap();
            let read: Command = serde_json::from_str(&written).unwrap();
            assert_eq!(read, command);
            read
        });
        together.apply(batch).unwrap();
        in_turn.replan(id, 1.0, replan).unwrap();
        in_turn.extend(id, extend).unwrap();
        let last = *first.knots().last().unwrap();
        apart
            .apply([
                Command::Replan(id, 1.0, first.into()),
                Command::Orient(id, 1.0, a),
                Command::Extend(id, second.into()),
                Command::Orient(id, last, b),
            ])
            .unwrap();
        let found = together.scene().body(id).unwrap();
        assert_eq!(Some(found), in_turn.scene().body(id), "{round}");
        assert_eq!(Some(found), apart.scene().body(id), "{round}");
        assert_eq!(found.orientation.tolerance(), Some(1e-4));
        let [before, after] = [last - 0.1, last + 0.1].map(|time| found.orientation.rotation(time));
        assert_eq!(before, turns[0].rotation(last - 0.1));
        assert_eq!(after, turns[1].rotation(last + 0.1));
    }
}

/// Whichever of its motion and its spin changes, and however it comes to follow them.
#[test]
fn a_body_that_is_told_a_spin_counts_once_as_changed() {
    let mut scene = Scene::new();
    let arm = Hitbox::cluster(vec![Sphere::new(DVec3::X, 0.1)]).unwrap();
    let ids: Vec<BodyId> = (0..40)
        .map(|number| {
            let rest = Trajectory::at_rest(9.0 * f64::from(number) * DVec3::X).unwrap();
            let body = Body::new(rest).with_hitbox(arm.clone());
            scene.insert(body).unwrap()
        })
        .collect();
    let levels = [AlertLevel::at(MARGIN)];
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &levels).unwrap();
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    // The time of all states and the rate of all spins: they change from one call to the next, or do not.
    let calls = [
        // Bodies that rested begin to move and to turn.
        (0.1, 0.1, 40),
        (0.2, 0.2, 40),
        (0.3, 0.3, 40),
        // Told again: the two spins before are forgotten, and then nothing is left to change.
        (0.3, 0.3, 40),
        (0.3, 0.3, 40),
        (0.3, 0.3, 0),
        // The spin before ends at the clock; then it is forgotten.
        (0.3, 0.4, 40),
        (0.3, 0.4, 0),
        (0.3, 0.4, 40),
        (0.3, 0.4, 0),
        (0.9, 0.4, 40),
    ];
    for (call, (time, rate, changed)) in calls.into_iter().enumerate() {
        let now = 0.1 * (call + 1) as f64;
        let told = ids.iter().zip(0..).map(|(&id, number)| {
            let place = DVec3::new(9.0 * f64::from(number), time, 0.0);
            let state = BodyState::from(State::new(time, place, DVec3::Y));
            (id, state.with_spin(DQuat::IDENTITY, rate * DVec3::Z))
        });
        monitor.track(now, told).unwrap();
        monitor.advance(now, &mut Vec::new()).unwrap();
        assert_eq!(monitor.stats().changed, changed, "{call}");
    }
}

/// Two arms that sweep past each other begin and end encounters, though the bodies rest.
#[test]
fn turning_alone_makes_encounters() {
    let arm = |offset| Sphere {
        offset,
        radius: 0.1,
    };
    let hitbox = Hitbox::cluster(vec![arm(DVec3::X)]).unwrap();
    let turn = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z).unwrap();
    let place = |x: f64| Trajectory::at_rest(DVec3::new(x, 0.0, 0.0)).unwrap();
    let mut monitor = Monitor::new(Scene::new(), 0.0, 2.0, &[AlertLevel::at(0.0)]).unwrap();
    let turning = Body::new(place(0.0))
        .with_hitbox(hitbox.clone())
        .with_orientation(turn);
    monitor.insert(turning).unwrap();
    // It holds its arm towards the other one.
    let still = Hitbox::cluster(vec![arm(-0.95 * DVec3::X)]).unwrap();
    monitor
        .insert(Body::new(place(2.0)).with_hitbox(still))
        .unwrap();
    let mut events: Vec<Event> = Vec::new();
    for tick in 0..400 {
        monitor
            .advance(0.05 * f64::from(tick), &mut events)
            .unwrap();
    }
    let began = events
        .iter()
        .filter(|event| matches!(event.kind, nearmiss::EventKind::Began(_)));
    // In 20 s it passes three times, and once more from the beginning.
    assert_eq!(began.count(), 4);
}

/// A body whose plan gives way to a told motion, and which begins to turn with it: its box grows.
#[test]
fn a_told_spin_reaches_where_nothing_was() {
    let arm = Sphere {
        offset: 3.0 * DVec3::X,
        radius: 0.1,
    };
    let still = |time| State::new(time, DVec3::ZERO, DVec3::ZERO);
    let plan = Trajectory::from_states(&[still(0.0), still(10.0)]).unwrap();
    let mut scene = Scene::new();
    let hitbox = Hitbox::cluster(vec![arm]).unwrap();
    let id = scene.insert(Body::new(plan).with_hitbox(hitbox)).unwrap();
    let other = Trajectory::at_rest(-3.05 * DVec3::X).unwrap();
    scene
        .insert(Body::new(other).with_hitbox(Hitbox::sphere(0.1).unwrap()))
        .unwrap();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(0.0)]).unwrap();
    let mut events: Vec<Event> = Vec::new();
    monitor.advance(0.0, &mut events).unwrap();
    assert!(events.is_empty());
    let spin = std::f64::consts::PI * DVec3::Z;
    let told = BodyState::from(still(0.1)).with_spin(DQuat::IDENTITY, spin);
    monitor.track(0.1, [(id, told)]).unwrap();
    monitor.advance(0.1, &mut events).unwrap();
    assert_eq!(monitor.conflicts(0).unwrap(), screened_at(&monitor, 0.0));
    assert_eq!(events.len(), 1);
}

/// Each radius is enlarged by a centre's error: two of 0.05 m may overlap by a little more than 0.1 m. Whoever is
/// asked says the same, also where a level beside it has a larger margin.
#[test]
fn a_margin_below_the_radii_is_the_same_for_all_callers() {
    let ball = Sphere {
        offset: DVec3::X,
        radius: 0.05,
    };
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z).unwrap();
    let body = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap())
        .with_hitbox(Hitbox::cluster(vec![ball]).unwrap())
        .with_orientation(spin);
    let mut one = Scene::new();
    one.insert(body.clone()).unwrap();
    let mut both = one.clone();
    both.insert(body.clone()).unwrap();
    for (margin, expected) in [(-0.1, 1), (-0.1005, 1), (-0.104, 0)] {
        let window = Window::new(0.0, 1.0).unwrap();
        let query = Query::new(window).with_margin(margin);
        let found = both.screen(&query).unwrap().conflicts;
        assert_eq!(found.len(), expected, "{margin}");
        let pair = pair::conflicts(&body, &body, &query).unwrap();
        assert_eq!(found, pair, "{margin}");
        let asked = one.conflicts_with(&body, &query).unwrap();
        assert_eq!(found, asked, "{margin}");
        let level = AlertLevel::at(margin);
        let released = level.with_release(0.0);
        for levels in [&[level][..], &[released], &[level, AlertLevel::at(0.0)]] {
            let monitor_of = |scene: &Scene| {
                let mut monitor = Monitor::new(scene.clone(), 0.0, 1.0, levels).unwrap();
                monitor.advance(0.0, &mut Vec::new()).unwrap();
                monitor
            };
            let (with_one, with_both) = (monitor_of(&one), monitor_of(&both));
            assert_eq!(with_both.conflicts(0).unwrap(), found, "{margin}");
            let would = with_one.what_if_body(&body, 0).unwrap();
            assert_eq!(found, would, "{margin} {levels:?}");
        }
    }
}

/// A body has both rotations at an instant at which its orientation jumps, but for the last instant of its plan: it has the
/// one before there.
#[test]
fn at_the_last_instant_of_a_plan_an_orientation_does_not_jump() {
    let beside = Sphere {
        offset: DVec3::X,
        radius: 0.1,
    };
    let post = Body::new(Trajectory::at_rest(-3.0 * DVec3::X).unwrap());
    for (end, least) in [(1.0, 3.9), (2.0, 1.9)] {
        let rest = [0.0, end].map(|time| State::new(time, DVec3::ZERO, DVec3::ZERO));
        let body = Body::new(Trajectory::from_states(&rest).unwrap());
        let body = body.with_hitbox(Hitbox::cluster(vec![beside]).unwrap());
        let mut scene = Scene::new();
        let id = scene.insert(body).unwrap();
        let mut monitor = Monitor::new(scene, 0.0, 1.0, &[AlertLevel::at(0.0)]).unwrap();
        let half = DQuat::from_rotation_z(std::f64::consts::PI);
        let turned = Orientation::spin(1.0, half, DVec3::ZERO).unwrap();
        monitor.orient(id, 1.0, turned).unwrap();
        let body = monitor.scene().body(id).unwrap();
        let instant = Window::new(1.0, 1.0).unwrap();
        let found = pair::closest_approach(body, &post, instant)
            .unwrap()
            .unwrap();
        assert!((found.separation - least).abs() < 1e-12, "{end} {found:?}");
    }
}

/// Beyond knots that are almost at the same time a body would turn faster than a spin may be told. Its spheres may be
/// anywhere at their distance then, and what they may meet is reported, soon.
#[test]
fn what_turns_too_fast_beyond_its_knots_may_be_anywhere() {
    let beside = Sphere {
        offset: DVec3::X,
        radius: 0.1,
    };
    let knots = [(0.0, DQuat::IDENTITY), (1e-9, DQuat::from_rotation_z(2.0))];
    for build in [Orientation::slerp, Orientation::normalized_cubic] {
        let fast = build(&knots).unwrap().with_outside(Outside::Coast);
        let body = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
        let body = body.with_hitbox(Hitbox::cluster(vec![beside]).unwrap());
        let body = body.with_orientation(fast);
        for (away, is_met) in [(1.05, true), (2.3, false)] {
            let post = Body::new(Trajectory::at_rest(away * DVec3::Z).unwrap());
            let query = Query::new(Window::new(1.0, 1e6).unwrap());
            for accuracy in [Accuracy::Exact, Accuracy::Certified] {
                let query = query.with_accuracy(accuracy);
                let found = pair::conflicts(&body, &post, &query).unwrap();
                assert_eq!(found.len(), usize::from(is_met), "{accuracy:?} {away}");
                for conflict in found {
                    let Some(proof) = conflict.certificate else {
                        assert_eq!((conflict.enter, conflict.exit), (1.0, 1e6));
                        continue;
                    };
                    assert!(!proof.resolved && proof.error >= 1.0, "{proof:?}");
                    assert_eq!((proof.enter.earliest, proof.exit.latest), (1.0, 1e6));
                }
            }
        }
    }
}
