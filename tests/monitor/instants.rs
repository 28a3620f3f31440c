//! Late on the clock, where instants are far apart: what begins or ends between two of them is reported at one, and
//! questions and jumps of the clock see it there.

use super::support::{bits, line, rng, vector};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Conflict, EndReason, EventKind, Monitor, Query, Scene, State,
    Trajectory, Window,
};
use rand::RngExt;

/// Instants are 2^-23 s apart; all lasts for a thousand of them.
const NOW: f64 = 1e9;
const ULP: f64 = 1.0 / 8_388_608.0;
const LOOKAHEAD: f64 = 1_024.0 * ULP;
const SPEED: f64 = 1e3;
/// Plans of a few lookaheads: what f32 knows of them is finer than how far they go between two instants.
const SHORT: (f64, f64) = (NOW - LOOKAHEAD, NOW + 3.0 * LOOKAHEAD);
const LONG: (f64, f64) = (NOW - LOOKAHEAD, NOW + 256.0 * LOOKAHEAD);

/// A body that is a metre from the origin at an instant, or so many spacings of them later.
#[derive(Clone, Copy, Debug)]
struct Passing {
    time: f64,
    later: f64,
    velocity: f64,
}

impl Passing {
    fn plan(self, (begin, end): (f64, f64)) -> Trajectory {
        let place = 1.0 - self.velocity * ((self.time - begin) + self.later * ULP);
        line(begin, end, DVec3::X * place, DVec3::X * self.velocity)
    }
}

fn resting(x: f64, (begin, end): (f64, f64)) -> Trajectory {
    line(begin, end, DVec3::X * x, DVec3::ZERO)
}

/// A body at rest in the origin, and another one.
fn pair(plan: Trajectory) -> (Scene, [BodyId; 2]) {
    let mut scene = Scene::new();
    let knots = plan.knots();
    let ends = (knots[0], knots[knots.len() - 1]);
    let plans = [resting(0.0, ends), plan];
    let ids = plans.map(|plan| scene.insert(Body::new(plan)).unwrap());
    (scene, ids)
}

fn monitor(scene: Scene) -> Monitor {
    Monitor::new(scene, NOW, LOOKAHEAD, &[AlertLevel::at(1.0)]).unwrap()
}

fn screened(scene: &Scene, from: f64, to: f64) -> Vec<Conflict> {
    let query = Query::new(Window::new(from, to).unwrap()).with_margin(1.0);
    scene.screen(&query).unwrap().conflicts
}

/// A contact that ends a third of a spacing before the clock, or begins as long after the lookahead: reported at
/// the clock, or at the end.
#[test]
fn questions_see_what_is_told_at_their_ends() {
    for is_recent in [false, true] {
        for (time, later, velocity) in [(NOW, -0.3, SPEED), (NOW + LOOKAHEAD, 0.3, -SPEED)] {
            let passing = Passing {
                time,
                later,
                velocity,
            };
            let (mut scene, [still, id]) = pair(resting(4.0, SHORT));
            if is_recent {
                scene.set_trajectory(still, resting(-4.0, SHORT)).unwrap();
            }
            let mut monitor = monitor(scene);
            monitor.advance(NOW, &mut Vec::new()).unwrap();
            if is_recent {
                monitor.set_trajectory(still, resting(0.0, SHORT)).unwrap();
            }
            let found = monitor.what_if(id, &passing.plan(SHORT), 0).unwrap();
            let (scene, _) = pair(passing.plan(SHORT));
            assert_eq!(screened(&scene, NOW, NOW + LOOKAHEAD).len(), 1);
            assert_eq!(found.len(), 1, "{is_recent} {passing:?}");
        }
    }
}

/// The same where two slices meet, and where a clock that jumps begins.
#[test]
fn slices_and_jumps_see_what_is_told_at_their_ends() {
    let mut rng = rng(1);
    for round in 0..400 {
        // Slices are whole spacings long: some of these instants are cuts.
        let time = NOW + ULP * f64::from(rng.random_range(0..1_024_u16));
        let passing = Passing {
            time: [NOW, NOW + LOOKAHEAD, NOW + 0.5 * LOOKAHEAD, time][round % 4],
            later: [-0.3, 0.3][round / 4 % 2],
            velocity: [SPEED, -SPEED][round / 8 % 2],
        };
        let (scene, _) = pair(passing.plan(SHORT));
        let mut monitor = monitor(scene);
        for now in [NOW, NOW + 0.5 * LOOKAHEAD, NOW + LOOKAHEAD] {
            monitor.advance(now, &mut Vec::new()).unwrap();
            let expected = screened(monitor.scene(), now, now + LOOKAHEAD);
            assert_eq!(monitor.conflicts(0).unwrap(), expected, "{passing:?} {now}");
        }
        let jump = |first: Option<f64>| {
            let (scene, _) = pair(passing.plan(LONG));
            let mut monitor = self::monitor(scene);
            let mut events = Vec::new();
            for now in first.into_iter().chain([NOW + 100.0 * LOOKAHEAD]) {
                monitor.advance(now, &mut events).unwrap();
            }
            !events.is_empty()
        };
        let (scene, _) = pair(passing.plan(LONG));
        let is_told = !screened(&scene, NOW, NOW + 100.0 * LOOKAHEAD).is_empty();
        assert_eq!(jump(None), is_told, "{passing:?}");
        assert_eq!(jump(Some(NOW)), is_told, "{passing:?}");
    }
}

/// A body that changes while the monitor is behind a clock that has jumped: what ended a third of a spacing before the
/// instant up to which all was reported is reported there.
#[test]
fn a_jump_that_goes_on_sees_what_is_told_at_its_beginning() {
    for ticks in 1..6 {
        let (scene, [_, id]) = pair(resting(9.0, LONG));
        let mut monitor = monitor(scene);
        let (clock, mut events) = (NOW + 100.0 * LOOKAHEAD, Vec::new());
        monitor.advance(NOW, &mut events).unwrap();
        for _ in 0..ticks {
            monitor
                .advance_within(clock, Budget::Work(1), &mut events)
                .unwrap();
        }
        let time = monitor.complete_until();
        assert!(NOW < time && time < clock && events.is_empty());
        let passing = Passing {
            time,
            later: -0.3,
            velocity: SPEED,
        };
        monitor.set_trajectory(id, passing.plan(LONG)).unwrap();
        assert_eq!(screened(monitor.scene(), time, clock).len(), 1);
        monitor.advance(clock, &mut events).unwrap();
        let begins = |kind: &EventKind| matches!(kind, EventKind::Began(it) if it.exit == time);
        let begun = events.iter().filter(|event| begins(&event.kind));
        assert_eq!(begun.count(), 1, "{ticks} {events:?}");
    }
}

/// A contact that begins just after the end of the lookahead, and is reported there. That is the instant of a knot: the
/// cubic before it, whose distance there is another one by rounding, is beyond the margin.
#[test]
fn a_contact_that_begins_at_a_knot_and_at_the_end_of_the_lookahead_is_as_screened() {
    let (mut rng, mut found) = (rng(29), 0);
    let end = NOW + LOOKAHEAD;
    for _ in 0..1_000 {
        let velocity = vector(&mut rng, 2e4);
        let direction = -velocity.normalize();
        let later = rng.random_range(0.0..0.4) * ULP;
        let place = direction * (1.0 + later * velocity.length());
        let states = [NOW - LOOKAHEAD, end, end + LOOKAHEAD].map(|time| {
            let bent = velocity + vector(&mut rng, 10.0);
            State::new(time, place + (time - end) * velocity, bent)
        });
        let (scene, _) = pair(Trajectory::from_states(&states).unwrap());
        // The first one keeps the cubic before the knot.
        let levels = [AlertLevel::at(5.0), AlertLevel::at(1.0)];
        let mut monitor = Monitor::new(scene, NOW, LOOKAHEAD, &levels).unwrap();
        monitor.advance(NOW, &mut Vec::new()).unwrap();
        let expected = bits(&screened(monitor.scene(), NOW, end));
        assert_eq!(bits(monitor.conflicts(1).unwrap()), expected, "{velocity}");
        found += expected.len();
    }
    assert!(found > 500, "{found}");
}

/// One body jumps away at the clock, where the other one has its first knot or not.
#[test]
fn a_contact_that_ends_at_a_jump_and_at_a_first_knot_is_seen() {
    let told = |time: f64, x: f64| State::new(time, x * DVec3::X, 0.01 * DVec3::Y);
    for first in [-1.0, 0.0, 0.5] {
        let plans = [State::new(first, DVec3::ZERO, DVec3::ZERO), told(-1.0, 0.5)];
        let mut monitor = Monitor::new(Scene::new(), -1.0, 5.0, &[AlertLevel::at(1.0)]).unwrap();
        let [other, jumping] = plans.map(|state| {
            let plan = Trajectory::coasting(state).unwrap();
            monitor.insert(Body::new(plan)).unwrap()
        });
        let mut events = Vec::new();
        monitor.advance(0.0, &mut events).unwrap();
        monitor.track(0.0, [(jumping, told(0.0, 60.0))]).unwrap();
        // Its motion so far stays until then.
        monitor.track(0.5, [(other, told(0.5, 0.0))]).unwrap();
        monitor.advance(0.3, &mut events).unwrap();
        let ends = events.iter().filter_map(|event| match event.kind {
            EventKind::Ended(_, reason) => Some((event.time, reason)),
            _ => None,
        });
        let ends: Vec<_> = ends.collect();
        assert_eq!(ends, [(0.0, EndReason::Separated)], "{first}");
    }
}

/// A search from nothing sees the end of the lookahead as well. All bodies change in each tick, so that there is one.
#[test]
fn searches_from_nothing_see_what_is_told_at_their_end() {
    let passing = |time: f64| Passing {
        time,
        later: 0.3,
        velocity: -SPEED,
    };
    let (scene, [still, id]) = pair(resting(4.0, SHORT));
    let mut monitor = monitor(scene);
    for step in 0..32 {
        let now = NOW + 8.0 * f64::from(step) * ULP;
        let aside = line(
            SHORT.0,
            SHORT.1,
            1e-9 * f64::from(step) * DVec3::Y,
            DVec3::ZERO,
        );
        monitor.set_trajectory(still, aside).unwrap();
        let plan = passing(now + LOOKAHEAD).plan(SHORT);
        monitor.set_trajectory(id, plan).unwrap();
        monitor.advance(now, &mut Vec::new()).unwrap();
        let expected = screened(monitor.scene(), now, now + LOOKAHEAD);
        assert_eq!(expected.len(), 1, "{step}");
        assert_eq!(monitor.conflicts(0).unwrap(), expected, "{step}");
    }
}
