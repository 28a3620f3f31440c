//! Bodies that turn, half-spaces, and bodies that are told each frame.

use super::strategies::{
    knotted, near, number, ordinary, orientation, outside, quaternion, rotations, told, tolerance,
    trajectory, turning_body, vector,
};
use super::{assert_sound, run, scene_of, screened};
use glam::DQuat;
use nearmiss::{
    AlertLevel, Body, BodyId, BodyPlan, BodyState, Conflict, Error, Event, Hitbox, Monitor,
    Orientation, Query, Scene, Trajectory, Window,
};
use proptest::collection::vec;
use proptest::prelude::{Just, Strategy, any, prop_oneof};
use std::collections::BTreeMap;

/// Returns true if two quaternions are about one rotation.
fn is_near(x: DQuat, y: DQuat) -> bool {
    // The length of a given one is 1 to 1e-9.
    (x.dot(y).abs() - 1.0).abs() < 1e-8
}

#[test]
fn orientations() {
    let spin = (number(), quaternion(), prop_oneof![vector(), near()]);
    let question = (
        (spin, knotted(), rotations()),
        (outside(), tolerance(), number()),
    );
    run(
        2_000,
        0.5,
        question,
        |((spin, kind, knots), (outside, tolerance, time))| {
            let (start, rotation, velocity) = spin;
            let mut made = Vec::new();
            if let Ok(spin) = Orientation::spin(start, rotation, velocity) {
                assert!(is_near(spin.rotation(start), rotation), "{spin:?}");
                made.push(spin);
            }
            if let Ok(turn) = kind.through(&knots) {
                for &(knot, rotation) in &knots {
                    assert!(is_near(turn.rotation(knot), rotation), "{turn:?} {knot}");
                }
                made.push(turn.with_outside(outside));
            }
            for turn in &made {
                let other = tolerance.map(|tolerance| turn.clone().with_tolerance(tolerance));
                let other = other.and_then(Result::ok);
                for turn in [turn].into_iter().chain(&other) {
                    let rotation = turn.rotation(time);
                    let is_one = is_near(rotation, rotation) || time.is_nan();
                    assert!(is_one, "{turn:?} {time}");
                }
            }
            !made.is_empty()
        },
    );
}

fn bodies_of(scene: &Scene) -> Vec<(BodyId, Body)> {
    let bodies = scene.bodies();
    bodies.map(|(id, body)| (id, body.clone())).collect()
}

/// Some of the bodies, by their places, with what is told of them.
fn some_told() -> impl Strategy<Value = Vec<(usize, BodyState)>> {
    vec((0..5_usize, told()), 0..5)
}

fn of_bodies(told: Vec<(usize, BodyState)>, ids: &[BodyId]) -> Vec<(BodyId, BodyState)> {
    let known = told
        .into_iter()
        .filter_map(|(place, state)| Some((*ids.get(place)?, state)));
    known.collect()
}

#[test]
fn told_and_turning_screenings() {
    let window = (-3.0..3.0_f64, 0.0..10.0_f64);
    let margin = prop_oneof![4 => 0.0..5.0_f64, 1 => number()];
    let question = (vec(turning_body(), 0..5), some_told(), window, margin);
    run(
        1_500,
        0.1,
        question,
        |(bodies, told, (start, length), margin)| {
            let mut scene = Scene::new();
            for body in bodies.into_iter().flatten() {
                let turns = body.hitbox.normal().is_some() && !body.orientation.is_fixed();
                assert_eq!(scene.insert(body).is_err(), turns);
            }
            let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
            let told = of_bodies(told, &ids);
            let before = bodies_of(&scene);
            match scene.update(told.iter().copied()) {
                Err(_) => assert!(bodies_of(&scene) == before, "{told:?}"),
                Ok(()) => {
                    // The last state of a body counts.
                    let told: BTreeMap<BodyId, BodyState> = told.into_iter().collect();
                    for (id, BodyState { state, .. }) in told {
                        let plan = &scene.body(id).unwrap().trajectory;
                        assert!(plan.position(state.time).is_some(), "{state:?}");
                    }
                }
            }
            let window = Window::new(start, start + length).unwrap();
            !screened(&scene, &Query::new(window).with_margin(margin)).is_empty()
        },
    );
}

/// One call between two ticks.
#[derive(Clone, Debug)]
enum Call {
    Track(Vec<(usize, BodyState)>),
    Orient(f64, Orientation),
    Replan(f64, Option<Trajectory>, Option<Orientation>),
    Extend(Option<Trajectory>, Option<Orientation>),
    SetHitbox(Hitbox),
    SetModelError(f64),
    WhatIf(Option<Trajectory>, Option<Orientation>),
    Insert(Option<Body>),
    Remove,
}

fn call() -> impl Strategy<Value = Call> {
    let time = || prop_oneof![1 => number(), 4 => -1.0..8.0_f64];
    let plan = || prop_oneof![1 => trajectory(), 3 => ordinary()];
    let turn = || prop_oneof![Just(None), orientation().prop_map(Some)];
    let hitbox = turning_body().prop_map(|body| body.map(|body| body.hitbox).unwrap_or_default());
    prop_oneof![
        4 => some_told().prop_map(Call::Track),
        2 => (time(), orientation()).prop_map(|(from, turn)| Call::Orient(from, turn)),
        2 => (time(), plan(), turn()).prop_map(|(from, plan, turn)| Call::Replan(from, plan, turn)),
        2 => (plan(), turn()).prop_map(|(plan, turn)| Call::Extend(plan, turn)),
        1 => hitbox.prop_map(Call::SetHitbox),
        1 => number().prop_map(Call::SetModelError),
        2 => (plan(), turn()).prop_map(|(plan, turn)| Call::WhatIf(plan, turn)),
        1 => turning_body().prop_map(Call::Insert),
        1 => Just(Call::Remove),
    ]
}

/// Makes the call about one of the bodies. Returns its refusal, if it could be made.
fn make(monitor: &mut Monitor, id: BodyId, call: Call, now: f64) -> Result<(), Error> {
    let body_plan = |trajectory: Trajectory, orientation| BodyPlan {
        orientation,
        ..trajectory.into()
    };
    match call {
        Call::Track(told) => {
            let ids: Vec<BodyId> = monitor.scene().bodies().map(|(id, _)| id).collect();
            monitor.track(now, of_bodies(told, &ids))
        }
        Call::Orient(from, turn) => monitor.orient(id, from, turn),
        Call::Replan(from, Some(plan), turn) => {
            monitor.replan(id, from, body_plan(plan, turn)).map(drop)
        }
        Call::Extend(Some(plan), turn) => monitor.extend(id, body_plan(plan, turn)),
        Call::SetHitbox(hitbox) => monitor.set_hitbox(id, hitbox),
        Call::SetModelError(metres) => monitor.set_model_error(id, metres),
        Call::WhatIf(Some(plan), turn) => {
            let idea = body_plan(plan, turn);
            let found = monitor.what_if(id, &idea, 0)?;
            found.iter().for_each(assert_sound);
            Ok(())
        }
        Call::Insert(Some(body)) => {
            let asked = monitor.what_if_body(&body, 0);
            if let Ok(found) = asked {
                found.iter().for_each(assert_sound);
            }
            monitor.insert(body).map(drop)
        }
        Call::Remove => monitor.remove(id).map(drop),
        Call::Replan(_, None, _)
        | Call::Extend(None, _)
        | Call::WhatIf(None, _)
        | Call::Insert(None) => Ok(()),
    }
}

/// Returns the state that a refused call must leave as it was.
fn state_of(monitor: &Monitor) -> (Vec<(BodyId, Body)>, Vec<Conflict>) {
    let conflicts = monitor.conflicts(0).unwrap().to_vec();
    (bodies_of(monitor.scene()), conflicts)
}

/// Returns true if two conflicts are one. Where a sphere is so large that distances are lost in it, any approach is
/// the closest.
fn is_same(x: &Conflict, y: &Conflict) -> bool {
    let of_pair = |one: &Conflict| (one.a, one.b, one.clip);
    let times = |one: &Conflict| [one.enter, one.exit].map(f64::to_bits);
    let [first, second] = [x, y].map(|one| one.closest.separation);
    let off = (first - second).abs();
    of_pair(x) == of_pair(y) && times(x) == times(y) && off <= 1e-12 * first.abs()
}

#[test]
fn told_and_turning_monitors() {
    const MARGIN: f64 = 1.0;
    let step = (call(), any::<u8>(), 0.0..0.8_f64);
    let life = (vec(turning_body(), 1..6), 0.1..5.0_f64, vec(step, 1..7));
    run(2_000, 0.1, life, |(bodies, lookahead, steps)| {
        let bodies = bodies.into_iter().map(|body| {
            let turns =
                |body: &Body| body.hitbox.normal().is_some() && !body.orientation.is_fixed();
            body.filter(|body| !turns(body))
        });
        let scene = scene_of(bodies.collect());
        let levels = [AlertLevel::at(MARGIN)];
        let Ok(mut monitor) = Monitor::new(scene, 0.0, lookahead, &levels) else {
            return false;
        };
        let (mut events, mut found): (Vec<Event>, usize) = (Vec::new(), 0);
        for (call, choice, step) in steps {
            let now = monitor.now() + step;
            let ids: Vec<BodyId> = monitor.scene().bodies().map(|(id, _)| id).collect();
            if !ids.is_empty() {
                let id = ids[usize::from(choice) % ids.len()];
                let before = state_of(&monitor);
                if make(&mut monitor, id, call.clone(), now).is_err() {
                    assert!(state_of(&monitor) == before, "{call:?}");
                }
            }
            if monitor.advance(now, &mut events).is_err() {
                continue;
            }
            let conflicts = monitor.conflicts(0).unwrap();
            conflicts.iter().for_each(assert_sound);
            let window = Window::new(monitor.now(), monitor.complete_until()).unwrap();
            let query = Query::new(window).with_margin(MARGIN);
            let screened = monitor.scene().screen(&query).unwrap().conflicts;
            let is_same = conflicts.len() == screened.len()
                && conflicts.iter().zip(&screened).all(|(x, y)| is_same(x, y));
            assert!(is_same, "{call:?} at {now}: {conflicts:?} {screened:?}");
            found += screened.len();
        }
        assert!(events.iter().all(|event| event.time.is_finite()));
        monitor.close(&mut events);
        found > 0
    });
}
