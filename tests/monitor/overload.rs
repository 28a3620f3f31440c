//! Bodies that are told again and again, and less time than it takes to search the whole lookahead each time.

use super::budgets::lived;
use super::is_as_screened;
use super::questions::ask;
use super::support::{rng, vector};
use glam::DQuat;
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Command, Event, Hitbox, Monitor, Orientation, Scene, Sphere,
    State, Trajectory,
};
use rand::rngs::ChaCha8Rng;

const LEVEL: AlertLevel = AlertLevel::at(2.0).with_release(2.5);
const LOOKAHEAD: f64 = 2.0;
/// Half the width of the room that the balls fly in, m.
const HALF: f64 = 20.0;
const FRAME: f64 = 1.0 / 30.0;

/// Balls that bounce in a room of six walls.
struct Balls {
    ids: Vec<BodyId>,
    states: Vec<State>,
}

impl Balls {
    fn new(rng: &mut ChaCha8Rng, count: usize) -> (Self, Scene) {
        let mut scene = Scene::new();
        let states: Vec<State> = (0..count)
            .map(|_| State::new(0.0, vector(rng, HALF), vector(rng, 6.0)))
            .collect();
        let ids = states
            .iter()
            .map(|&state| {
                let body = Body::new(Trajectory::coasting(state).unwrap());
                let body = body.with_hitbox(Hitbox::sphere(0.5).unwrap());
                scene.insert(body).unwrap()
            })
            .collect();
        for normal in [DVec3::X, DVec3::Y, DVec3::Z] {
            for normal in [normal, -normal] {
                let wall = Body::new(Trajectory::at_rest(-(HALF + 1.0) * normal).unwrap());
                let wall = wall.with_hitbox(Hitbox::half_space(normal).unwrap());
                scene.insert(wall).unwrap();
            }
        }
        (Self { ids, states }, scene)
    }

    /// Moves all balls to an instant (s).
    fn step(&mut self, now: f64) {
        for state in &mut self.states {
            state.position += (now - state.time) * state.velocity;
            state.time = now;
            for axis in 0..3 {
                let height = state.position[axis];
                if height.abs() > HALF && height * state.velocity[axis] > 0.0 {
                    state.velocity[axis] *= -1.0;
                }
            }
        }
    }

    /// Tells a monitor where the balls are that `is_told` returns true for.
    fn tell(&self, monitor: &mut Monitor, is_told: impl Fn(usize) -> bool) {
        let told = self.ids.iter().copied().zip(self.states.iter().copied());
        let told = told.enumerate().filter(|(number, _)| is_told(*number));
        let now = self.states[0].time;
        monitor.track(now, told.map(|(_, told)| told)).unwrap();
    }

    /// Returns the largest number of knots that a monitor keeps of a ball.
    fn most_knots(&self, monitor: &Monitor) -> usize {
        let knots = |&id| monitor.scene().body(id).unwrap().trajectory.knots().len();
        self.ids.iter().map(knots).max().unwrap()
    }
}

/// What is known may end sooner, but it is a 16th of the lookahead at least, in each tick: so the same events are told as without a
/// budget. A budget that suffices makes no difference at all.
#[test]
fn all_bodies_are_told_and_each_tick_knows_beyond_the_clock() {
    let (mut balls, scene) = Balls::new(&mut rng(7), 400);
    let budgets = [u64::MAX, 2_500, 1, 0].map(Budget::Work);
    let new = || Monitor::new(scene.clone(), 0.0, LOOKAHEAD, &[LEVEL]).unwrap();
    let (mut rich, mut expected) = (new(), Vec::new());
    let mut others = budgets.map(|budget| (budget, new(), Vec::<Event>::new(), Vec::new()));
    for tick in 0..120 {
        let now = f64::from(tick) * FRAME;
        balls.step(now);
        balls.tell(&mut rich, |_| true);
        rich.advance(now, &mut expected).unwrap();
        for (budget, monitor, events, known) in &mut others {
            balls.tell(monitor, |_| true);
            let budget = if tick < 2 { Budget::Unlimited } else { *budget };
            monitor.advance_within(now, budget, events).unwrap();
            is_as_screened(monitor, LEVEL);
            assert!(
                monitor.complete_until() >= now + 0.06 * LOOKAHEAD,
                "{budget:?} {now}"
            );
            assert!(balls.most_knots(monitor) <= 3, "{budget:?} {now}");
            known.push((monitor.complete_until() - now) / LOOKAHEAD);
        }
    }
    let known = others.each_ref().map(|(.., known)| {
        let settled = &known[60..];
        settled.iter().sum::<f64>() / settled.len() as f64
    });
    assert!(known[0] > 0.999, "{known:?}");
    assert!(0.2 < known[1] && known[1] < 0.9, "{known:?}");
    assert!(
        known[2..].iter().all(|share| (0.06..0.07).contains(share)),
        "{known:?}"
    );
    rich.close(&mut expected);
    let expected = lived(&expected);
    assert!(expected.len() > 500, "{}", expected.len());
    for (budget, monitor, mut events, _) in others {
        monitor.close(&mut events);
        assert_eq!(lived(&events), expected, "{budget:?}");
    }
}

/// Asks what a ball would meet that turned round now; returns the number of answers, those of a screening.
fn ask_to_turn(monitor: &Monitor, (id, state): (BodyId, State)) -> usize {
    let back = State::new(state.time, state.position, -state.velocity);
    ask(monitor, id, &Trajectory::coasting(back).unwrap(), 0)
}

/// Boxes for questions are formed by the first one after a tick. Then bodies change, are inserted and removed.
#[test]
fn questions_between_ticks_in_which_all_bodies_are_told() {
    let mut found = 0;
    for budget in [Budget::Unlimited, Budget::Work(1_500)] {
        for lookahead in [0.1, LOOKAHEAD, 20.0] {
            let mut rng = rng(9);
            let (mut balls, scene) = Balls::new(&mut rng, 200);
            let mut monitor = Monitor::new(scene, 0.0, lookahead, &[LEVEL]).unwrap();
            let mut more = Vec::new();
            for tick in 0..20 {
                let now = f64::from(tick) * FRAME;
                balls.step(now);
                balls.tell(&mut monitor, |_| true);
                monitor
                    .advance_within(now, budget, &mut Vec::new())
                    .unwrap();
                if monitor.complete_until() <= now {
                    continue;
                }
                let ball = |number: usize| (balls.ids[number], balls.states[number]);
                for number in 0..5 {
                    found += ask_to_turn(&monitor, ball(7 * number + 1));
                }
                let (other, place) = (balls.ids[100], vector(&mut rng, HALF));
                let moved = Trajectory::coasting(State::new(now, place, DVec3::X)).unwrap();
                let body = Body::new(moved.clone());
                let mut changes = vec![Command::SetTrajectory(other, moved), Command::Insert(body)];
                changes.extend(more.pop().map(Command::Remove));
                more = monitor.apply(changes).unwrap();
                for number in 0..5 {
                    found += ask_to_turn(&monitor, ball(7 * number + 3));
                }
            }
        }
    }
    assert!(found > 500, "{found}");
}

/// Some of the bodies are told in each tick, or half of them, or all in every other one. A monitor that falls behind for long
/// knows less ahead, too, and is not behind any more.
#[test]
fn a_monitor_does_not_stay_behind_the_clock() {
    let some = |tick: u32, number: usize| number % 20 == tick as usize % 20;
    let half = |tick: u32, number: usize| number % 2 == tick as usize % 2;
    let in_turns = |tick: u32, _: usize| tick.is_multiple_of(2);
    let patterns: [(&dyn Fn(u32, usize) -> bool, _); 3] =
        [(&some, 21..40), (&half, 0..4), (&in_turns, 0..4)];
    for (is_told, late_ticks) in patterns {
        for work in [0, 1, 50] {
            let (mut balls, scene) = Balls::new(&mut rng(8), 200);
            let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &[LEVEL]).unwrap();
            let (mut events, mut late) = (Vec::new(), 0);
            for tick in 0..200 {
                let now = f64::from(tick) * FRAME;
                balls.step(now);
                balls.tell(&mut monitor, |number| is_told(tick, number));
                let budget = Budget::Work(work);
                monitor.advance_within(now, budget, &mut events).unwrap();
                if monitor.complete_until() > now {
                    is_as_screened(&monitor, LEVEL);
                }
                if tick < 50 {
                    late += u32::from(monitor.complete_until() < now);
                } else {
                    assert!(
                        monitor.complete_until() >= now - 1.01 * FRAME,
                        "{work} {now}"
                    );
                    assert!(balls.most_knots(&monitor) <= 4, "{work} {now}");
                }
            }
            assert!(late_ticks.contains(&late), "{work} {late}");
            assert!(!events.is_empty(), "{work}");
        }
    }
}

/// A tick that searches less ahead solves spans of turning bodies only so far. It must leave slices beyond alone.
#[test]
fn turning_bodies_in_ticks_that_search_less_ahead() {
    for (every, frame) in [(2, 0.01), (10, 0.01), (10, FRAME), (30, FRAME)] {
        let mut rng = rng(8);
        let mut scene = Scene::new();
        let rods: Vec<(BodyId, State)> = (0..60)
            .map(|_| {
                let state = State::new(0.0, vector(&mut rng, 10.0), vector(&mut rng, 3.0));
                let spheres = [-1.0, 1.0].map(|x| Sphere::new(x * DVec3::X, 0.3));
                let body = Body::new(Trajectory::coasting(state).unwrap());
                let body = body.with_hitbox(Hitbox::cluster(spheres.to_vec()).unwrap());
                let spin = Orientation::spin(0.0, DQuat::IDENTITY, vector(&mut rng, 2.0));
                (
                    scene.insert(body.with_orientation(spin.unwrap())).unwrap(),
                    state,
                )
            })
            .collect();
        let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &[LEVEL]).unwrap();
        for tick in 0..200_u32 {
            let now = f64::from(tick) * frame;
            // A few each time: the others are looked at by what was known of them.
            let told = rods.iter().skip(tick as usize % every).step_by(every);
            let told = told.map(|&(id, state)| {
                let position = state.position + now * state.velocity;
                let velocity = state.velocity + 1e-3 * f64::from(tick) * DVec3::X;
                (id, State::new(now, position, velocity))
            });
            monitor.track(now, told).unwrap();
            let budget = if tick % 40 == 39 {
                Budget::Unlimited
            } else {
                Budget::Work(1)
            };
            monitor
                .advance_within(now, budget, &mut Vec::new())
                .unwrap();
            if monitor.complete_until() > now {
                is_as_screened(&monitor, LEVEL);
            }
        }
    }
}

#[test]
fn a_clock_that_stands_still_is_caught_up_with() {
    let (mut balls, scene) = Balls::new(&mut rng(8), 200);
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &[LEVEL]).unwrap();
    for tick in 0..60_u32 {
        let now = f64::from(tick.min(10)) * FRAME;
        balls.step(now);
        for state in &mut balls.states {
            state.velocity += 1e-3 * DVec3::X;
        }
        balls.tell(&mut monitor, |number| number % 2 == tick as usize % 2);
        monitor
            .advance_within(now, Budget::Work(1), &mut Vec::new())
            .unwrap();
    }
    assert!(monitor.complete_until() > monitor.now());
}

/// Where many bodies are told, the boxes of all take less time than those of the told ones in each slice that is kept.
#[test]
fn a_tick_in_which_many_bodies_are_told_forms_as_many_boxes_as_if_all_were() {
    let boxes_if_told = |one_in: usize| {
        let (mut balls, scene) = Balls::new(&mut rng(9), 400);
        let mut monitor = Monitor::new(scene, 0.0, 0.3, &[LEVEL]).unwrap();
        let boxes = (0..60_u32).map(|tick| {
            let now = f64::from(tick) * FRAME;
            balls.step(now);
            balls.tell(&mut monitor, |number| {
                number % one_in == tick as usize % one_in
            });
            monitor.advance(now, &mut Vec::new()).unwrap();
            is_as_screened(&monitor, LEVEL);
            monitor.stats().boxes
        });
        boxes.skip(10).collect::<Vec<u64>>()
    };
    let all = boxes_if_told(1);
    for some in [boxes_if_told(2), boxes_if_told(4)] {
        // Some are not where they were going: they have two boxes.
        let as_all = |(some, all): (&u64, &u64)| some.abs_diff(*all) < 40;
        assert!(some.iter().zip(&all).all(as_all), "{some:?} {all:?}");
    }
    let few: u64 = boxes_if_told(50).iter().sum();
    assert!(2 * few < all.iter().sum(), "{few} {all:?}");
}
