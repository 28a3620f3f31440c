//! Monitors with half-spaces against one-shot screening.

use super::invariance::{bodies, body};
use super::vector;
use nearmiss::glam::{DQuat, DVec3};
use nearmiss::{
    AlertLevel, BodyId, Budget, Command, Conflict, Event, EventKind, Hitbox, Layers, Monitor,
    Orientation, Query, Scene, Sphere, State, Trajectory, Window,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

const LOOKAHEAD: f64 = 4.0;
const MARGIN: f64 = 0.3;

fn screened(monitor: &Monitor) -> Vec<Conflict> {
    let window = Window::new(monitor.now(), monitor.complete_until()).unwrap();
    let query = Query::new(window).with_margin(MARGIN);
    monitor.scene().screen(&query).unwrap().conflicts
}

fn monitor_of(rng: &mut ChaCha8Rng, count: usize) -> (Monitor, Vec<BodyId>) {
    let mut scene = Scene::new();
    let ids = bodies(rng, count)
        .into_iter()
        .map(|body| scene.insert(body).unwrap())
        .collect();
    let levels = [AlertLevel::at(MARGIN)];
    (Monitor::new(scene, 0.0, LOOKAHEAD, &levels).unwrap(), ids)
}

fn coasting(rng: &mut ChaCha8Rng, now: f64) -> State {
    State::new(now, vector(rng, 8.0), vector(rng, 3.0))
}

/// Tells half-spaces at rest that they rest where they are: nothing of what is foreseen changes.
fn tell_floors(monitor: &mut Monitor, ids: &[BodyId], now: f64) {
    let mut told = Vec::new();
    for &id in ids {
        let body = monitor.scene().body(id).unwrap();
        let is_floor = body.hitbox.normal().is_some();
        if let Some(state) = body.trajectory.state(now).filter(|_| is_floor)
            && state.velocity == DVec3::ZERO
        {
            told.push((id, state));
        }
    }
    drop(monitor.track(now, told));
}

/// One of the changes that a game makes, to one or all bodies.
fn change(monitor: &mut Monitor, ids: &mut Vec<BodyId>, rng: &mut ChaCha8Rng, now: f64) {
    let place = rng.random_range(0..ids.len());
    let id = ids[place];
    match rng.random_range(0..14) {
        12 => {
            let layers = [Layers::ALL, Layers::NONE, Layers::new(1, 1)][rng.random_range(0..3)];
            monitor.set_layers(id, layers).unwrap();
        }
        13 => monitor
            .set_model_error(id, rng.random_range(0.0..0.4))
            .unwrap(),
        0 => {
            let states: Vec<(BodyId, State)> =
                ids.iter().map(|&id| (id, coasting(rng, now))).collect();
            drop(monitor.track(now, states));
        }
        1 => {
            let plan = Trajectory::coasting(coasting(rng, now)).unwrap();
            drop(monitor.replan(id, now + 0.5, plan));
        }
        2 => ids.push(monitor.insert(body(rng)).unwrap()),
        3 if ids.len() > 40 => {
            monitor.remove(ids.swap_remove(place)).unwrap();
        }
        4 => {
            // It may become one, or be one no more.
            let hitbox = match rng.random_range(0..2) {
                0 => Hitbox::sphere(0.3).unwrap(),
                _ => Hitbox::half_space(vector(rng, 1.0).normalize()).unwrap(),
            };
            drop(monitor.set_hitbox(id, hitbox));
        }
        5 => {
            let other = ids[rng.random_range(0..ids.len())];
            let pair = [Command::IgnorePair(id, other)];
            drop(monitor.apply(pair));
        }
        6 => {
            let other = ids[rng.random_range(0..ids.len())];
            drop(monitor.unignore_pair(id, other));
        }
        // Of a plan that is over, it is refused.
        _ => drop(monitor.track(now, [(id, coasting(rng, now))])),
    }
}

/// After each tick the monitor has the conflicts of a screening, bit for bit, and answers questions
/// alike, of spheres and of half-spaces.
#[test]
fn monitors_say_what_screenings_say() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let rng = &mut rng;
    let (mut monitor, mut ids) = monitor_of(rng, 60);
    let (mut events, mut found, mut asked, mut now) = (Vec::new(), 0, 0, 0.0);
    for tick in 0..150 {
        // A far jump now and then.
        now += match tick % 25 {
            24 => 9.0,
            5 | 15 => 0.0,
            _ => rng.random_range(0.01..0.3),
        };
        for _ in 0..rng.random_range(0..3) {
            change(&mut monitor, &mut ids, rng, now);
        }
        if tick % 3 > 0 {
            tell_floors(&mut monitor, &ids, now);
        }
        monitor.advance(now, &mut events).unwrap();
        let expected = screened(&monitor);
        assert_eq!(monitor.conflicts(0).unwrap(), expected, "{tick} {now}");
        let is_plane = |one: &&Conflict| {
            let scene = monitor.scene();
            [one.a, one.b]
                .iter()
                .any(|&id| scene.body(id).unwrap().hitbox.normal().is_some())
        };
        found += expected.iter().filter(is_plane).count();
        // The body's own plan again: what is foreseen of it anyway.
        let id = ids[rng.random_range(0..ids.len())];
        let plan = monitor.scene().body(id).unwrap().trajectory.clone();
        if plan.domain().contains(now) && plan.outside_after() != nearmiss::Outside::Absent {
            let answer = monitor.what_if(id, &plan, 0).unwrap();
            let own: Vec<Conflict> = expected
                .iter()
                .filter(|one| one.a == id || one.b == id)
                .copied()
                .collect();
            assert_eq!(answer, own, "{tick} {now}");
            asked += own.len();
        }
    }
    assert!(found > 5_000 && asked > 200, "{found} {asked}");
}

/// A half-space some way off the bodies, or through them, that may come nearer.
fn moving_wall(rng: &mut ChaCha8Rng, now: f64) -> nearmiss::Body {
    let normal = vector(rng, 1.0).normalize();
    let wall = Hitbox::half_space(normal).unwrap();
    nearmiss::Body::new(Trajectory::coasting(wall_state(rng, normal, now)).unwrap())
        .with_hitbox(wall)
}

fn wall_state(rng: &mut ChaCha8Rng, normal: DVec3, now: f64) -> State {
    let distance = rng.random_range(5.0..40.0);
    let speed = [0.0, 1.0, 6.0][rng.random_range(0..3)];
    State::new(now, -distance * normal, speed * normal + vector(rng, 0.1))
}

/// Changes a half-space in one of all ways; now and then another body becomes one, or is changed as well.
fn change_wall(monitor: &mut Monitor, ids: &mut Vec<BodyId>, rng: &mut ChaCha8Rng, now: f64) {
    let normal_of = |monitor: &Monitor, id| monitor.scene().body(id).unwrap().hitbox.normal();
    let walls = ids
        .iter()
        .filter(|&&id| normal_of(monitor, id).is_some())
        .count();
    let number = rng.random_range(0..walls.max(1));
    let mut places = (0..ids.len()).filter(|&place| normal_of(monitor, ids[place]).is_some());
    let Some(place) = places.nth(number).filter(|_| walls > 4) else {
        ids.push(monitor.insert(moving_wall(rng, now)).unwrap());
        return;
    };
    let id = ids[place];
    let state = wall_state(rng, normal_of(monitor, id).unwrap(), now);
    let plan = Trajectory::coasting(state).unwrap();
    match rng.random_range(0..9) {
        0 => ids.push(monitor.insert(moving_wall(rng, now)).unwrap()),
        1 => drop(monitor.remove(ids.swap_remove(place)).unwrap()),
        2 => monitor.set_trajectory(id, plan).unwrap(),
        3 => drop(monitor.replan(id, now + 0.4, plan)),
        4 => monitor
            .set_model_error(id, rng.random_range(0.0..0.4))
            .unwrap(),
        5 => {
            let hitbox = Hitbox::half_space(vector(rng, 1.0).normalize()).unwrap();
            drop(monitor.set_hitbox(ids[rng.random_range(0..ids.len())], hitbox));
        }
        6 => {
            monitor
                .set_hitbox(id, Hitbox::sphere(0.3).unwrap())
                .unwrap();
        }
        _ => drop(monitor.track(now, [(id, state)])),
    }
    if rng.random_bool(0.3) {
        let id = ids[rng.random_range(0..ids.len())];
        drop(monitor.track(now, [(id, coasting(rng, now))]));
    }
}

/// Compares all bodies with all half-spaces again: each of these gets the trajectory that it has.
fn tell_all_walls(monitor: &mut Monitor, ids: &[BodyId]) {
    for &id in ids {
        let body = monitor.scene().body(id).unwrap();
        if body.hitbox.normal().is_some() {
            let plan = body.trajectory.clone();
            monitor.set_trajectory(id, plan).unwrap();
        }
    }
}

/// The half-spaces that do not change are met as before while others change: the monitor says what a screening
/// says, and has the events of one that compares all again in each tick.
#[test]
fn half_spaces_that_change_leave_the_others_known() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let rng = &mut rng;
    let (mut monitor, mut ids) = monitor_of(rng, 40);
    let mut anew = Monitor::restore(monitor.snapshot()).unwrap();
    let (mut events, mut expected_events) = (Vec::new(), Vec::new());
    let (mut now, mut found, mut reported) = (0.0, 0, 0);
    for tick in 0..250 {
        now += match tick % 50 {
            49 => 6.0,
            _ => rng.random_range(0.0..0.3),
        };
        if rng.random_bool(0.7) {
            let [mut one, mut other] = [tick; 2].map(ChaCha8Rng::seed_from_u64);
            let mut same_ids = ids.clone();
            change_wall(&mut monitor, &mut ids, &mut one, now);
            change_wall(&mut anew, &mut same_ids, &mut other, now);
            assert_eq!(ids, same_ids);
        }
        tell_all_walls(&mut anew, &ids);
        events.clear();
        expected_events.clear();
        monitor.advance(now, &mut events).unwrap();
        anew.advance(now, &mut expected_events).unwrap();
        let expected = screened(&monitor);
        assert_eq!(monitor.conflicts(0).unwrap(), expected, "{tick} {now}");
        // Of a trajectory that is set again, the end is reported again.
        for events in [&mut events, &mut expected_events] {
            events.retain(|event| !matches!(event.kind, EventKind::PlanEnds { .. }));
        }
        assert_eq!(events, expected_events, "{tick} {now}");
        found += expected.len();
        reported += events.len();
    }
    assert!(found > 5_000 && reported > 1_000, "{found} {reported}");
}

/// Budgets run out while bodies are compared: what is known is right, and in the end all is known.
#[test]
fn half_spaces_that_change_while_others_are_compared_are_met() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    let rng = &mut rng;
    let (mut monitor, mut ids) = monitor_of(rng, 100);
    let (mut events, mut behind, mut found) = (Vec::new(), 0, 0);
    for tick in 0..400 {
        let now = 0.03 * f64::from(tick);
        if tick % 9 < 3 {
            let clock = monitor.now();
            change_wall(&mut monitor, &mut ids, rng, clock);
        }
        let budget = Budget::Work(rng.random_range(1..200));
        monitor.advance_within(now, budget, &mut events).unwrap();
        behind += usize::from(monitor.complete_until() <= now);
        if monitor.complete_until() > now {
            let expected = screened(&monitor);
            assert_eq!(monitor.conflicts(0).unwrap(), expected, "{tick}");
            found += expected.len();
        }
    }
    monitor.advance(12.0, &mut events).unwrap();
    assert_eq!(monitor.conflicts(0).unwrap(), screened(&monitor));
    assert!(behind > 20 && found > 1_000, "{behind} {found}");
}

/// With budgets, whatever is known is right, and in the end all is; any number of threads does the
/// same.
#[test]
fn budgets_keep_what_is_known_right() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let rng = &mut rng;
    let (mut monitor, mut ids) = monitor_of(rng, 300);
    let mut events = Vec::new();
    let mut partial = 0;
    for tick in 0..120 {
        let now = 0.02 * f64::from(tick);
        if tick % 10 == 0 {
            change(&mut monitor, &mut ids, rng, now);
        }
        if tick % 3 > 0 {
            tell_floors(&mut monitor, &ids, now);
        }
        let budget = Budget::Work(rng.random_range(1..400));
        monitor.advance_within(now, budget, &mut events).unwrap();
        partial += usize::from(!monitor.is_caught_up());
        if monitor.complete_until() > monitor.now() {
            assert_eq!(monitor.conflicts(0).unwrap(), screened(&monitor), "{tick}");
        }
    }
    assert!(partial > 10, "{partial}");
    for _ in 0..2_000 {
        if monitor.is_caught_up() {
            break;
        }
        let now = monitor.now();
        monitor
            .advance_within(now, Budget::Work(500), &mut events)
            .unwrap();
    }
    assert!(monitor.is_caught_up());
    assert_eq!(monitor.conflicts(0).unwrap(), screened(&monitor));
}

/// A snapshot goes on as the monitor itself; each ball's bounce is told when it comes.
#[test]
fn snapshots_go_on_alike() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let rng = &mut rng;
    let (mut monitor, ids) = monitor_of(rng, 80);
    let mut before = Vec::new();
    for tick in 0..40 {
        monitor
            .advance(0.05 * f64::from(tick), &mut before)
            .unwrap();
    }
    let mut copy = Monitor::restore(monitor.snapshot()).unwrap();
    let (mut events, mut again): (Vec<Event>, Vec<Event>) = (Vec::new(), Vec::new());
    for tick in 40..120_u8 {
        let now = 0.05 * f64::from(tick);
        let told = [(ids[usize::from(tick) % ids.len()], coasting(rng, now))];
        monitor.track(now, told).unwrap();
        copy.track(now, told).unwrap();
        monitor.advance(now, &mut events).unwrap();
        copy.advance(now, &mut again).unwrap();
        assert_eq!(monitor.conflicts(0).unwrap(), copy.conflicts(0).unwrap());
    }
    assert_eq!(events, again);
    assert!(events.len() > 100);
}

/// A body that falls for a thousand lookaheads is foreseen when its time has come, and not lost.
#[test]
fn what_lies_far_ahead_is_met_in_time() {
    let mut scene = Scene::new();
    let floor = nearmiss::Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
    scene
        .insert(floor.with_hitbox(Hitbox::half_space(DVec3::Z).unwrap()))
        .unwrap();
    let fall = State::new(0.0, 20_000.0 * DVec3::Z, -DVec3::Z);
    let ball = nearmiss::Body::new(Trajectory::coasting(fall).unwrap());
    scene.insert(ball).unwrap();
    let levels = [AlertLevel::at(0.0)];
    let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &levels).unwrap();
    let mut events = Vec::new();
    let mut now = 0.0;
    while now < 19_990.0 {
        monitor.advance(now, &mut events).unwrap();
        assert!(events.is_empty(), "{now}");
        now += 3.7;
    }
    while now < 20_010.0 {
        monitor.advance(now, &mut events).unwrap();
        now += 1.0;
    }
    assert!(events.len() > 2, "{events:?}");
    assert!(events[0].time < 20_000.0 && (events[1].time - 20_000.0).abs() < 1e-6);
}

/// A body that turns for ever, and is to come down beyond the time that is searched, is met when its time has
/// come. Until then the parts of its turning are not gone through.
#[test]
fn a_turning_body_that_comes_later_is_met_in_time() {
    let floor = nearmiss::Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap())
        .with_hitbox(Hitbox::half_space(DVec3::Z).unwrap());
    let arm = Sphere {
        offset: 0.1 * DVec3::X,
        radius: 0.6,
    };
    let beam = nearmiss::Body::new(Trajectory::at_rest(100.0 * DVec3::Z).unwrap())
        .with_hitbox(Hitbox::cluster(vec![arm]).unwrap())
        .with_orientation(Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Y).unwrap());
    for from in [3.5, 4.5, 5.5, 6.5, 9.0] {
        let mut scene = Scene::new();
        scene.insert(floor.clone()).unwrap();
        let id = scene.insert(beam.clone()).unwrap();
        let levels = [AlertLevel::at(0.0)];
        let mut monitor = Monitor::new(scene, 0.0, 3.0, &levels).unwrap();
        let down = Trajectory::at_rest(0.5 * DVec3::Z).unwrap();
        monitor.replan(id, from, down).unwrap();
        let mut events = Vec::new();
        for tick in 0..100 {
            monitor.advance(0.1 * f64::from(tick), &mut events).unwrap();
        }
        let began = events.iter().find_map(|event| match event.kind {
            EventKind::Began(_) => Some(event.time),
            _ => None,
        });
        assert_eq!(began, Some(from));
    }
}

/// The outcome of a batch counts, not what lies between: a body that turned becomes a half-space that does not, and
/// later again a cluster that turns.
#[test]
fn a_turning_body_becomes_a_half_space_in_a_batch() {
    let arm = Sphere {
        offset: DVec3::X,
        radius: 0.5,
    };
    let arm = Hitbox::cluster(vec![arm]).unwrap();
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z).unwrap();
    let rest = |height: f64| Trajectory::at_rest(height * DVec3::Z).unwrap();
    let body = |height: f64| nearmiss::Body::new(rest(height)).with_hitbox(arm.clone());
    let floor = Hitbox::half_space(DVec3::Z).unwrap();
    for spun_first in [false, true] {
        let mut scene = Scene::new();
        let turning = body(50.0).with_orientation(spin.clone());
        let changed = scene.insert(turning).unwrap();
        let removed = scene.insert(body(60.0)).unwrap();
        let level = AlertLevel::at(1.0);
        let mut monitor = Monitor::new(scene, 0.0, LOOKAHEAD, &[level]).unwrap();
        monitor.advance(0.0, &mut Vec::new()).unwrap();
        let mut shape = [
            Command::SetOrientation(changed, Orientation::FIXED),
            Command::SetHitbox(changed, floor.clone()),
        ];
        let mut back = [
            Command::SetOrientation(changed, spin.clone()),
            Command::SetHitbox(changed, arm.clone()),
        ];
        if spun_first {
            shape.reverse();
            back.reverse();
        }
        let others = [
            Command::Remove(removed),
            Command::SetTrajectory(changed, rest(0.0)),
            Command::Insert(body(1.0)),
        ];
        let inserted = monitor.apply(others.into_iter().chain(shape)).unwrap();
        assert_eq!(inserted.len(), 1);
        assert!(monitor.scene().body(removed).is_none());
        for (time, commands) in [(1.0, None), (2.0, Some(back)), (3.0, None)] {
            monitor.apply(commands.into_iter().flatten()).unwrap();
            monitor.advance(time, &mut Vec::new()).unwrap();
            let window = Window::new(time, time + LOOKAHEAD).unwrap();
            let query = Query::new(window).with_margin(level.margin);
            let screened = monitor.scene().screen(&query).unwrap().conflicts;
            assert_eq!(monitor.conflicts(0).unwrap(), screened, "{time}");
            assert!(!screened.is_empty(), "{time}");
        }
    }
}
