//! What would be if: answers against screenings of the scene with the plan in place.

use super::scenarios::tick;
use super::support::{bits, rng, rng as support_rng, vector, wander, with_every_change};
use super::{SMALL, hitbox};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Conflict, Error, Hitbox, Layers, Monitor, Outside, Query,
    Scene, State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

/// A cube (m) and speeds (m/s) with which a body crosses the boxes of most others in every second.
const CUBE: f64 = 400.0;
const SPEED: f64 = 300.0;
const LOOKAHEAD: f64 = 60.0;
const LEVELS: [AlertLevel; 2] = [AlertLevel::at(4.0), AlertLevel::at(1.0)];

/// A plan from about `start` on, to and fro in the cube: for some seconds, or longer than the
/// lookahead.
fn plan(rng: &mut ChaCha8Rng, start: f64) -> Trajectory {
    let mut time = start - rng.random_range(0.0..3.0);
    let knots = [4, 20, 80, 80][rng.random_range(0..4)];
    let mut states = Vec::new();
    for _ in 0..knots {
        states.push(State::new(
            time,
            vector(rng, CUBE / 2.0),
            vector(rng, SPEED),
        ));
        time += rng.random_range(0.5..1.5);
    }
    let outside = if rng.random_bool(0.1) {
        Outside::Coast
    } else {
        Outside::Absent
    };
    let trajectory = Trajectory::from_states(&states).unwrap();
    trajectory.with_outside(outside)
}

/// A plan that passes by where others are, every other second or so.
fn passing(rng: &mut ChaCha8Rng, monitor: &Monitor, ids: &[BodyId]) -> Trajectory {
    let mut time = monitor.now() - 1.0;
    let mut states = Vec::new();
    while time < monitor.now() + LOOKAHEAD {
        let id = ids[rng.random_range(0..ids.len())];
        let other = &monitor.scene().body(id).unwrap().trajectory;
        let near = other.position(time).unwrap_or_default() + vector(rng, 3.0);
        states.push(State::new(time, near, vector(rng, SPEED)));
        time += rng.random_range(1.0..4.0);
    }
    Trajectory::from_states(&states).unwrap()
}

fn body(rng: &mut ChaCha8Rng, start: f64) -> Body {
    let layers = if rng.random_bool(0.1) {
        Layers::new(0b10, 0b11)
    } else {
        Layers::ALL
    };
    Body::new(plan(rng, start))
        .with_hitbox(hitbox(rng, SMALL))
        .with_layers(layers)
}

/// A change of plans now, or of who is there.
fn change(rng: &mut ChaCha8Rng, monitor: &mut Monitor, ids: &mut [BodyId]) {
    let now = monitor.now();
    let (place, other) = (rng.random_range(1..ids.len()), ids[0]);
    let id = ids[place];
    match rng.random_range(0..5) {
        0 => {
            monitor.remove(id).unwrap();
            let start = now + rng.random_range(0.0..20.0);
            ids[place] = monitor.insert(body(rng, start)).unwrap();
        }
        1 => monitor.ignore_pair(id, other).unwrap(),
        2 => {
            let new = plan(rng, now);
            let from = now + rng.random_range(0.0..2.0);
            // Refused where there is no plan then.
            let _ = monitor.replan(id, from, new);
        }
        _ => {
            let new = plan(rng, now);
            monitor.set_trajectory(id, new).unwrap();
        }
    }
}

/// Asks about an idea for a body: as many conflicts as a screening finds, and the same.
pub(super) fn ask(monitor: &Monitor, id: BodyId, idea: &Trajectory, level: usize) -> usize {
    let would = monitor.what_if(id, idea, level);
    assert_as_screened(monitor, &[(id, idea)], level, would)
}

/// Asks about ideas for some bodies together: as many conflicts as a screening finds, and the same.
fn ask_together(monitor: &Monitor, ideas: &[(BodyId, &Trajectory)], level: usize) -> usize {
    let would = monitor.what_if_plans(ideas.iter().copied(), level);
    assert_as_screened(monitor, ideas, level, would)
}

/// Compares an answer with a screening of the scene in which the ideas are followed.
fn assert_as_screened(
    monitor: &Monitor,
    ideas: &[(BodyId, &Trajectory)],
    level: usize,
    would: Result<Vec<Conflict>, Error>,
) -> usize {
    let window = (monitor.now(), monitor.complete_until());
    if window.0 >= window.1 {
        assert!(matches!(would, Err(Error::NothingKnown { .. })));
        return 0;
    }
    let would = would.unwrap();
    let mut scene = monitor.scene().clone();
    for &(id, idea) in ideas {
        scene.set_trajectory(id, idea.clone()).unwrap();
    }
    let window = Window::new(window.0, window.1).unwrap();
    let query = Query::new(window).with_margin(monitor.levels()[level].margin);
    let mut screened = scene.screen(&query).unwrap().conflicts;
    screened.retain(|one| ideas.iter().any(|(id, _)| one.a == *id || one.b == *id));
    assert_eq!(bits(&would), bits(&screened), "{window:?} {level}");
    would.len()
}

/// Asks about a body that is not there yet: as many conflicts as a screening with it finds.
fn ask_about_body(monitor: &Monitor, body: &Body, level: usize) -> usize {
    let would = monitor.what_if_body(body, level);
    if monitor.complete_until() <= monitor.now() {
        assert!(matches!(would, Err(Error::NothingKnown { .. })));
        return 0;
    }
    let would = would.unwrap();
    let mut scene = monitor.scene().clone();
    let id = scene.insert(body.clone()).unwrap();
    let window = Window::new(monitor.now(), monitor.complete_until()).unwrap();
    let query = Query::new(window).with_margin(monitor.levels()[level].margin);
    let mut screened = scene.screen(&query).unwrap().conflicts;
    screened.retain(|one| one.a == id || one.b == id);
    assert_eq!(bits(&would), bits(&screened), "{level}");
    would.len()
}

/// Bodies that are part of no pair have no boxes; the new one may be their first partner, by its layers
/// or by its size.
#[test]
fn a_new_body_may_be_the_first_partner() {
    let mut rng = rng(31);
    let mut found = [0; 3];
    for round in 0..60 {
        let kind = round % 3;
        let count = [20, 20, 1][kind];
        let level = [
            AlertLevel::at(40.0),
            AlertLevel::at(-1.0),
            AlertLevel::at(40.0),
        ][kind];
        let mut scene = Scene::new();
        for _ in 0..count {
            let mut one = Body::new(plan(&mut rng, 0.0));
            if kind == 0 {
                one = one.with_layers(Layers::new(0b01, 0b10));
            }
            scene.insert(one).unwrap();
        }
        let mut monitor = Monitor::new(scene, 0.0, 20.0, &[level]).unwrap();
        tick(&mut monitor, 0.1);
        let mut new = Body::new(plan(&mut rng, 0.0)).with_layers(Layers::new(0b11, 0b11));
        if kind == 1 {
            new = new.with_model_error(50.0).unwrap();
        }
        found[kind] += ask_about_body(&monitor, &new, 0);
    }
    assert!(found.iter().all(|&found| found > 5), "{found:?}");
}

/// In many slices of time, each crossed with hardly anybody near: in a fresh lookahead, in one that is
/// known in part, and after changes, few and many.
#[test]
fn what_if_is_as_screened_where_many_slices_are_crossed() {
    let (mut found, mut in_part) = (0, 0);
    for seed in 71..73 {
        let mut rng = rng(seed);
        let mut scene = Scene::new();
        let mut ids: Vec<BodyId> = (0..120)
            .map(|_| scene.insert(body(&mut rng, 0.0)).unwrap())
            .collect();
        let mut monitor = with_every_change(Monitor::new(scene, 0.0, LOOKAHEAD, &LEVELS).unwrap());
        let (mut now, mut events) = (0.0, Vec::new());
        for step in 0..30 {
            let budget = match step % 4 {
                3 => Budget::Work(rng.random_range(0..6_000)),
                _ => Budget::Unlimited,
            };
            monitor.advance_within(now, budget, &mut events).unwrap();
            if step == 0 {
                let slices = monitor.stats().slices;
                assert!(slices > 60, "{slices}");
            }
            in_part += u32::from(!monitor.is_caught_up() && monitor.complete_until() > now);
            for question in 0..8 {
                let id = ids[rng.random_range(0..ids.len())];
                let own = &monitor.scene().body(id).unwrap().trajectory;
                let mut idea = match question % 3 {
                    0 => plan(&mut rng, now),
                    _ => passing(&mut rng, &monitor, &ids),
                };
                if question % 2 == 0 {
                    idea = own.spliced(now, &idea).unwrap_or(idea);
                }
                // (It may be over already, or the body not there.)
                if own.domain().contains(now) && idea.domain().contains(now) {
                    found += ask(&monitor, id, &idea, question % LEVELS.len());
                }
                let mut of_body = support_rng(seed * 1_000 + u64::try_from(question).unwrap());
                let new = body(&mut of_body, now);
                found += ask_about_body(&monitor, &new, question % LEVELS.len());
                for _ in 0..[0, 0, 1, 0, 30][question % 5] {
                    change(&mut rng, &mut monitor, &mut ids);
                }
            }
            now += match step % 10 {
                9 => rng.random_range(5.0..60.0),
                _ => rng.random_range(0.0..0.4),
            };
        }
    }
    assert!(found > 1_000 && in_part > 5, "{found} {in_part}");
}

/// Bodies that change their plans together meet each other as they would then, and no one as they do now. The last idea of
/// a body that is named twice counts.
#[test]
fn plans_that_change_together_are_as_screened() {
    let mut rng = rng(73);
    let mut scene = Scene::new();
    let mut ids: Vec<BodyId> = (0..80)
        .map(|_| scene.insert(body(&mut rng, 0.0)).unwrap())
        .collect();
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, LOOKAHEAD, &LEVELS).unwrap());
    let (mut found, mut with_each_other, mut twice) = (0, 0, 0);
    for step in 0..40 {
        let now = 0.3 * f64::from(step);
        tick(&mut monitor, now);
        change(&mut rng, &mut monitor, &mut ids);
        let mut ideas = Vec::new();
        while ideas.len() < 6 {
            let id = ids[rng.random_range(0..ids.len())];
            let mut idea = passing(&mut rng, &monitor, &ids);
            // Two of them pass by each other, whatever else they do.
            if let (1, Some((_, before))) = (ideas.len() % 2, ideas.last()) {
                idea = Trajectory::clone(before);
            }
            if monitor
                .scene()
                .body(id)
                .unwrap()
                .trajectory
                .domain()
                .contains(now)
            {
                ideas.push((id, idea));
            }
        }
        for count in 1..=ideas.len() {
            let named: Vec<_> = ideas[..count]
                .iter()
                .map(|(id, idea)| (*id, idea))
                .collect();
            found += ask_together(&monitor, &named, count % LEVELS.len());
        }
        let last_of = |one: usize| ideas[one + 1..].iter().all(|later| later.0 != ideas[one].0);
        twice += (0..6).filter(|&one| !last_of(one)).count();
        let named = |id| ideas.iter().any(|(named, _)| *named == id);
        let asked = ideas.iter().map(|(id, idea)| (*id, idea));
        let would = monitor.what_if_plans(asked, 0).unwrap();
        with_each_other += would
            .iter()
            .filter(|one| named(one.a) && named(one.b))
            .count();
    }
    assert!(
        found > 3_000 && with_each_other > 50 && twice > 3,
        "{found} {with_each_other} {twice}"
    );
    assert_eq!(ask_together(&monitor, &[], 0), 0);
}

/// What bodies do that have changed since the last tick counts, however often they have.
#[test]
fn what_if_sees_what_has_changed_since_the_last_tick() {
    let mut rng = rng(29);
    let level = AlertLevel::at(1.0);
    let mut plan = |start: f64| {
        let states = wander(&mut rng, start, 12, 1.0, 6.0, 3.0);
        Trajectory::from_states(&states).unwrap()
    };
    let mut scene = Scene::new();
    let mut ids: Vec<BodyId> = (0..50)
        .map(|_| scene.insert(Body::new(plan(-1.0))).unwrap())
        .collect();
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 5.0, &[level]).unwrap());
    let mut found = 0;
    for step in 0..60_usize {
        let now = 0.1 * f64::from(u32::try_from(step).unwrap());
        tick(&mut monitor, now);
        for ask in 0..40 {
            let (own, other) = ((7 * ask + step) % ids.len(), (11 * ask + 3) % ids.len());
            let idea = plan(now - 1.0);
            let would = monitor.what_if(ids[own], &idea, 0).unwrap();
            let mut changed = monitor.scene().clone();
            changed.set_trajectory(ids[own], idea.clone()).unwrap();
            let window = Window::new(monitor.now(), monitor.complete_until()).unwrap();
            let query = Query::new(window).with_margin(level.margin);
            let mut screened = changed.screen(&query).unwrap().conflicts;
            screened.retain(|one| one.a == ids[own] || one.b == ids[own]);
            assert_eq!(bits(&would), bits(&screened), "{step} {ask}");
            found += would.len();
            match ask % 8 {
                0 => {
                    monitor.remove(ids[other]).unwrap();
                    ids[other] = monitor.insert(Body::new(plan(now - 1.0))).unwrap();
                }
                1..4 => drop(monitor.replan(ids[own], now + 0.2, idea).unwrap()),
                4..7 => monitor.set_trajectory(ids[ask % 5], idea).unwrap(),
                _ => {}
            }
        }
    }
    assert!(found > 2_000, "{found}");
}

/// A body whose plan is over, or has not begun, is asked about with plans that begin now, later, or are over.
#[test]
fn a_body_that_is_not_there_now_may_get_a_whole_plan() {
    let mut rng = rng(17);
    let mut scene = Scene::new();
    let mut insert = |start: f64, rng: &mut ChaCha8Rng| scene.insert(body(rng, start)).unwrap();
    for _ in 0..300 {
        insert(98.0, &mut rng);
    }
    let absent = [0.0, 200.0].map(|start| insert(start, &mut rng));
    let mut monitor = Monitor::new(scene, 100.0, LOOKAHEAD, &LEVELS).unwrap();
    monitor.advance(100.0, &mut Vec::new()).unwrap();
    let (mut found, mut over) = (0, 0);
    for id in absent {
        let old = monitor.scene().body(id).unwrap().trajectory.domain();
        assert!(!old.contains(100.0));
        for start in [20.0, 95.0, 100.0, 101.0, 105.0, 109.0, 120.0] {
            for _ in 0..8 {
                let idea = plan(&mut rng, start);
                let (start, end) = (idea.domain().start(), idea.domain().end());
                if end > 100.0 {
                    found += ask(&monitor, id, &idea, 0);
                    continue;
                }
                let time = 100.0;
                let expected = Error::NoNewPlan { time, start, end };
                let refused = monitor.what_if(id, &idea, 0).unwrap_err();
                assert_eq!(refused, expected.in_body(0).with_id(id));
                over += 1;
            }
        }
    }
    assert!(over > 8, "{over}");
    assert!(found > 20, "{found}");
}

/// While nothing after now is known, a question is refused: an empty answer would look like a free way.
#[test]
fn nothing_is_said_before_the_first_tick() {
    let rest = |height: f64| Body::new(Trajectory::at_rest(height * DVec3::Z).unwrap());
    let floor = rest(0.0).with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
    let plan = Trajectory::at_rest(0.25 * DVec3::Z).unwrap();
    for (others, found) in [(vec![rest(0.5)], 1), (vec![rest(0.5), floor], 2)] {
        let mut scene = Scene::new();
        let mut ids = others
            .into_iter()
            .map(|other| scene.insert(other).unwrap())
            .collect::<Vec<_>>();
        ids.truncate(1);
        let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap();
        let asked = |monitor: &Monitor| {
            let of_plan = monitor.what_if(ids[0], &plan, 0);
            let of_body = monitor.what_if_body(&rest(0.0), 0);
            [of_plan, of_body].map(|answer| answer.map(|conflicts| conflicts.len()))
        };
        let refused = |now: f64, complete_until: f64| {
            let error = Error::NothingKnown {
                now,
                complete_until,
            };
            [Err(error.clone()), Err(error)]
        };
        assert_eq!(asked(&monitor), refused(0.0, 0.0));
        tick(&mut monitor, 0.0);
        assert_eq!(asked(&monitor), [Ok(found - 1), Ok(found)]);
        // The clock goes on, and no work is allowed.
        let none = Budget::Work(0);
        monitor.advance_within(99.0, none, &mut Vec::new()).unwrap();
        assert!(monitor.complete_until() <= monitor.now());
        assert_eq!(asked(&monitor), refused(99.0, monitor.complete_until()));
        assert!(monitor.conflicts(0).unwrap().is_empty());
    }
}
