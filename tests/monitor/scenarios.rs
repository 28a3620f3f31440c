//! What a monitor of two bodies tells, event by event: one scenario a test.

use super::support::{line, rng, wander, with_every_change};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Event, EventKind, Monitor, Outside, Query, RevisionThreshold, Scene,
    State, Trajectory, Window,
};
use rand::RngExt;

/// A monitor of two points on straight lines, and what it tells at each tick.
pub(crate) fn two(
    a: Trajectory,
    b: Trajectory,
    levels: &[AlertLevel],
) -> (Monitor, BodyId, BodyId) {
    let mut scene = Scene::new();
    let a = scene.insert(Body::new(a)).unwrap();
    let b = scene.insert(Body::new(b)).unwrap();
    (
        with_every_change(Monitor::new(scene, 0.0, 10.0, levels).unwrap()),
        a,
        b,
    )
}

pub(crate) fn tick(monitor: &mut Monitor, now: f64) -> Vec<Event> {
    let mut events = Vec::new();
    monitor.advance(now, &mut events).unwrap();
    events
}

pub(crate) fn kinds(events: &[Event]) -> Vec<String> {
    let name = |event: &Event| match event.kind {
        EventKind::Predicted(e) => format!("predicted {}", e.level),
        EventKind::Revised(e) => format!("revised {}", e.level),
        EventKind::Withdrawn(e) => format!("withdrawn {}", e.level),
        EventKind::Began(e) => format!("began {}", e.level),
        EventKind::Ended(e, reason) => format!("ended {} {reason:?}", e.level),
        EventKind::PlanEnds { .. } => "plan ends".to_owned(),
        _ => "another".to_owned(),
    };
    events.iter().map(name).collect()
}

/// Head on along x, 20 m apart at t = 0, each 1 m/s, passing at 0.5 m; they meet at t = 10.
pub(crate) fn head_on() -> (Trajectory, Trajectory) {
    let end = 100.0;
    (
        line(0.0, end, DVec3::ZERO, DVec3::X),
        line(0.0, end, DVec3::new(20.0, 0.5, 0.0), -DVec3::X),
    )
}

#[test]
fn an_encounter_from_first_sight_to_end() {
    let (a, b) = head_on();
    let (mut monitor, ..) = two(a, b, &[AlertLevel::at(2.0)]);
    // Enters 2 m at 10 - sqrt(3.75)/2 = 9.03: within the lookahead of 10 s, its exit is not.
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), ["predicted 0"]);
    assert!(monitor.encounters().next().unwrap().open);
    // The closest approach at 10 s is inside the lookahead now, and reported once.
    assert_eq!(kinds(&tick(&mut monitor, 0.5)), ["revised 0"]);
    assert_eq!(kinds(&tick(&mut monitor, 0.6)), [""; 0]);
    // Now the whole of it is known: the exit is reported once.
    assert_eq!(kinds(&tick(&mut monitor, 2.0)), ["revised 0"]);
    assert_eq!(kinds(&tick(&mut monitor, 2.0)), [""; 0]);
    let began = tick(&mut monitor, 9.5);
    assert_eq!(kinds(&began), ["began 0"]);
    assert!((began[0].time - (10.0 - 3.75_f64.sqrt() / 2.0)).abs() < 1e-12);
    let ended = tick(&mut monitor, 11.0);
    assert_eq!(kinds(&ended), ["ended 0 Separated"]);
    assert_eq!(ended[0].kind.encounter().unwrap().closest.separation, 0.5);
    assert_eq!(kinds(&tick(&mut monitor, 30.0)), [""; 0]);
}

/// Within the margin all along, and nearer all the time: 0.1 m/s.
#[test]
fn how_near_bodies_come_that_close_in_for_long_is_told_once_a_lookahead() {
    let end = 200.0;
    let (mut monitor, ..) = two(
        line(0.0, end, DVec3::ZERO, DVec3::ZERO),
        line(0.0, end, DVec3::X * 30.0, DVec3::X * -0.1),
        &[AlertLevel::at(40.0)],
    );
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), ["began 0"]);
    let mut revised = Vec::new();
    for now in 1..=120 {
        if now == 81 {
            let least = RevisionThreshold::default().with_separation(1.5);
            monitor.set_revision_threshold(least).unwrap();
        }
        for event in tick(&mut monitor, f64::from(now)) {
            assert!(matches!(event.kind, EventKind::Revised(_)), "{event:?}");
            let encounter = event.kind.encounter().unwrap();
            revised.push((now, encounter.closest.separation.round()));
        }
    }
    // Each 1 m, and then 1.6 m, since what was reported last.
    let first = (1..=8).map(|k| (10 * k, f64::from(29 - k)));
    let expected: Vec<_> = first.chain([(96, 19.0), (112, 18.0)]).collect();
    assert_eq!(revised, expected);
}

#[test]
fn plans_that_change() {
    let (a, b) = head_on();
    let (mut monitor, id, _) = two(a.clone(), b, &[AlertLevel::at(2.0)]);
    tick(&mut monitor, 1.0);
    // Away in time: withdrawn. Back again: another encounter.
    let away = line(0.0, 100.0, DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0));
    let would = monitor.what_if(id, &away, 0).unwrap();
    assert_eq!(would, []);
    assert_eq!(
        monitor.what_if(id, &a, 0).unwrap(),
        monitor.conflicts(0).unwrap()
    );
    monitor.replan(id, 1.0, away.clone()).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 1.5)), ["withdrawn 0"]);
    monitor.replan(id, 2.0, a).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 2.0)), ["predicted 0"]);
    // In the middle of it: it ends where the clock last stood, with what had passed.
    assert_eq!(kinds(&tick(&mut monitor, 9.5)), ["began 0"]);
    monitor.set_trajectory(id, away).unwrap();
    let ended = tick(&mut monitor, 9.6);
    assert_eq!(kinds(&ended), ["ended 0 PlanChanged"]);
    let encounter = ended[0].kind.encounter().unwrap();
    assert_eq!(encounter.exit, 9.5);
    // At 9.5 s they were 1 m apart along x, 0.5 m across.
    assert!((encounter.closest.separation - 1.25_f64.sqrt()).abs() < 1e-12);
}

/// What has begun is over once plans have changed and the bodies are apart, however soon they meet again.
#[test]
fn bodies_that_part_by_a_change_and_meet_again_have_two_encounters() {
    let still = |place: f64| line(0.0, 100.0, DVec3::X * place, DVec3::ZERO);
    let (mut monitor, _, b) = two(still(0.0), still(1.0), &[AlertLevel::at(2.0)]);
    assert_eq!(kinds(&tick(&mut monitor, 1.0)), ["began 0"]);
    let away_and_back = [(0.0, 1000.0), (8.0, 1000.0), (12.0, 0.0), (100.0, 0.0)];
    let states = away_and_back.map(|(t, x)| State::new(t, DVec3::X * x, DVec3::ZERO));
    let back = Trajectory::from_states(&states).unwrap();
    monitor.set_trajectory(b, back).unwrap();
    let events = tick(&mut monitor, 2.0);
    assert_eq!(kinds(&events), ["ended 0 PlanChanged", "predicted 0"]);
    assert_eq!(events[0].time, 1.0);
    let ids = events
        .iter()
        .map(|event| event.kind.encounter().unwrap().id);
    assert_ne!(ids.clone().next(), ids.clone().next_back());
    assert_eq!(kinds(&tick(&mut monitor, 11.0)), ["revised 0"]);
    assert_eq!(kinds(&tick(&mut monitor, 13.0)), ["began 0"]);
}

#[test]
fn inside_from_the_start_removed_and_closed() {
    let rest = |x: f64| line(0.0, 100.0, DVec3::new(x, 0.0, 0.0), DVec3::ZERO);
    let (mut monitor, a, _) = two(rest(0.0), rest(1.0), &[AlertLevel::at(2.0)]);
    assert_eq!(kinds(&tick(&mut monitor, 0.0)), ["began 0"]);
    // A clip that moves with the window is no revision.
    for now in 1..50 {
        assert_eq!(kinds(&tick(&mut monitor, f64::from(now))), [""; 0]);
    }
    let third = monitor.insert(Body::new(rest(1.5))).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 50.0)), ["began 0", "began 0"]);
    monitor.remove(a).unwrap();
    assert_eq!(
        kinds(&tick(&mut monitor, 51.0)),
        ["ended 0 BodyRemoved", "ended 0 BodyRemoved"]
    );
    assert!(monitor.remove(a).is_err());
    assert_eq!(monitor.conflicts_of(third, 0).unwrap().count(), 1);
    let mut last = Vec::new();
    let scene = monitor.close(&mut last);
    assert_eq!(kinds(&last), ["ended 0 MonitorClosed"]);
    assert_eq!(scene.len(), 2);
}

#[test]
fn trajectories_and_plans_that_end() {
    let (a, b) = (
        line(0.0, 12.0, DVec3::ZERO, DVec3::ZERO),
        line(0.0, 100.0, DVec3::X, DVec3::ZERO),
    );
    let (mut monitor, id, _) = two(a, b, &[AlertLevel::at(2.0)]);
    assert_eq!(kinds(&tick(&mut monitor, 1.0)), ["began 0"]);
    let reported = tick(&mut monitor, 2.0);
    // The exit is known now, and so is the end of the plan.
    assert_eq!(kinds(&reported), ["revised 0", "plan ends"]);
    assert_eq!(reported[1].time, 12.0);
    // Extended: the end moves out of sight again.
    let more = line(12.0, 60.0, DVec3::ZERO, DVec3::ZERO);
    monitor.extend(id, more).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 3.0)), ["revised 0"]);
    assert_eq!(kinds(&tick(&mut monitor, 50.0)), ["revised 0", "plan ends"]);
    assert_eq!(
        kinds(&tick(&mut monitor, 61.0)),
        ["ended 0 TrajectoryEnded"]
    );
}

#[test]
fn hysteresis_keeps_an_encounter_that_hovers() {
    // Hovers around 2 m: 1.8 m and 2.2 m in turn, every second, then leaves.
    let mut states: Vec<State> = (0..9)
        .map(|k| {
            let x = if k % 2 == 0 { 2.2 } else { 1.8 };
            State::new(f64::from(k), DVec3::new(x, 0.0, 0.0), DVec3::ZERO)
        })
        .collect();
    states.push(State::new(9.0, DVec3::new(5.0, 0.0, 0.0), DVec3::ZERO));
    let hover = Trajectory::from_states(&states).unwrap();
    let post = line(0.0, 100.0, DVec3::ZERO, DVec3::ZERO);
    let count = |release: f64| {
        let level = AlertLevel::at(2.0).with_release(release);
        let (mut monitor, ..) = two(hover.clone(), post.clone(), &[level]);
        let mut began = 0;
        let mut ended = 0;
        for now in 0..90 {
            for event in tick(&mut monitor, f64::from(now) * 0.11) {
                began += u32::from(matches!(event.kind, EventKind::Began(_)));
                ended += u32::from(matches!(event.kind, EventKind::Ended(..)));
            }
        }
        assert_eq!(began, ended);
        began
    };
    assert_eq!(count(2.0), 4);
    assert_eq!(count(2.5), 1);
}

/// Returns a monitor of two bodies that meet, which reports changes from 0.1 s and 0.1 m on, and the first one's id.
fn two_with_coarse_revisions() -> (Monitor, BodyId) {
    let (a, b) = head_on();
    let (mut monitor, id, _) = two(a, b, &[AlertLevel::at(2.0)]);
    let revision_threshold = RevisionThreshold::default()
        .with_time(0.1)
        .with_separation(0.1);
    monitor.set_revision_threshold(revision_threshold).unwrap();
    (monitor, id)
}

/// Returns the first body's path of [`two_with_coarse_revisions`], moved sideways (m).
fn nudged(y: f64) -> Trajectory {
    line(0.0, 100.0, DVec3::new(0.0, y, 0.0), DVec3::X)
}

#[test]
fn small_changes_are_not_told() {
    let (mut monitor, id) = two_with_coarse_revisions();
    tick(&mut monitor, 2.0);
    monitor.set_trajectory(id, nudged(0.05)).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 2.1)), [""; 0]);
    // Measured from what was last sent, not from the last tick.
    monitor.set_trajectory(id, nudged(0.15)).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 2.2)), ["revised 0"]);
    // What was kept back is reported once it is no longer too little.
    monitor.set_trajectory(id, nudged(0.2)).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 2.3)), [""; 0]);
    monitor
        .set_revision_threshold(RevisionThreshold::default())
        .unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 2.4)), ["revised 0"]);
    assert_eq!(kinds(&tick(&mut monitor, 2.5)), [""; 0]);
}

/// Revisions are measured from the first event and the last revision, also if `Began` told other numbers since.
#[test]
fn changes_are_measured_from_the_prediction_also_after_the_beginning() {
    let (mut monitor, id) = two_with_coarse_revisions();
    // The exit is in sight.
    tick(&mut monitor, 2.0);
    // The least separation is 0.5 m at first, then 0.44 and 0.36 m.
    monitor.set_trajectory(id, nudged(0.06)).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 9.1)), ["began 0"]);
    monitor.set_trajectory(id, nudged(0.14)).unwrap();
    assert_eq!(kinds(&tick(&mut monitor, 9.2)), ["revised 0"]);
}

/// An encounter that begins at the clock's instant, and is revised in the same tick.
#[test]
fn what_begins_at_the_clock_begins_before_it_is_revised() {
    let plan = |speed: f64| {
        let state =
            |time: f64, x: f64, speed: f64| State::new(time, x * DVec3::X, speed * DVec3::X);
        let states = [
            state(0.0, 0.0, 1.0),
            state(8.0, 8.0, 1.0),
            state(20.0, 8.0 + 12.0 * speed, speed),
        ];
        Trajectory::from_states(&states).unwrap()
    };
    let target = Trajectory::at_rest(10.0 * DVec3::X).unwrap();
    let (mut monitor, id, _) = two(plan(1.0), target, &[AlertLevel::at(2.0)]);
    assert_eq!(kinds(&tick(&mut monitor, 7.0)), ["predicted 0"]);
    monitor.set_trajectory(id, plan(0.5)).unwrap();
    let events = tick(&mut monitor, 8.0);
    assert_eq!(kinds(&events), ["began 0", "revised 0"]);
    assert!(events.iter().all(|event| event.time == 8.0));
}

/// A distance that changes by less than a billionth of a metre: reported by a monitor that reports all.
#[test]
fn rounding_is_not_told() {
    let (a, b) = head_on();
    let nudged = line(0.0, 100.0, DVec3::Y * 1e-10, DVec3::X);
    for threshold in [None, Some(RevisionThreshold::default())] {
        let (mut monitor, id, _) = two(a.clone(), b.clone(), &[AlertLevel::at(2.0)]);
        if let Some(threshold) = threshold {
            monitor.set_revision_threshold(threshold).unwrap();
        }
        tick(&mut monitor, 2.0);
        monitor.set_trajectory(id, nudged.clone()).unwrap();
        let reported = kinds(&tick(&mut monitor, 2.1)).len();
        assert_eq!(reported, usize::from(threshold.is_none()), "{threshold:?}");
    }
}

#[test]
fn a_splice_keeps_what_was_flown() {
    let mut rng = rng(8);
    for _ in 0..200 {
        let old = Trajectory::from_states(&wander(&mut rng, 0.0, 6, 1.0, 20.0, 4.0)).unwrap();
        let end = *old.knots().last().unwrap();
        let from = rng.random_range(0.0..end);
        let states = wander(&mut rng, from - 1.0, 6, 1.0, 20.0, 4.0);
        let new = Trajectory::from_states(&states).unwrap();
        let both = old.spliced(from, &new).unwrap();
        for step in 0..=100 {
            let time = f64::from(step) * 0.01 * (from + 3.0);
            let expected = if time < from { &old } else { &new };
            assert_eq!(
                both.position(time),
                expected.position(time),
                "{time} {from}"
            );
        }
        let late = both.clone().trimmed_before(from);
        assert_eq!(late.position(from + 0.5), both.position(from + 0.5));
        assert!(late.knots().len() < both.knots().len() || from < old.knots()[1]);
    }
}

/// The encounter ends where the plan of one ends, which goes on: at a jump of the other one. It was
/// found when plans were laid out as far as that.
#[test]
fn a_plan_that_goes_on_does_not_cut_an_encounter() {
    let still = line(0.0, 4.0, DVec3::ZERO, DVec3::ZERO).with_outside(Outside::Coast);
    let away = line(4.0, 9.0, DVec3::X * 100.0, DVec3::ZERO);
    let comes = line(0.0, 8.0, DVec3::X * 4.1, -DVec3::X);
    let comes = comes.spliced(4.0, &away).unwrap();
    let levels = [AlertLevel::at(1.5)];
    let mut scene = Scene::new();
    let bodies = [still, comes].map(|plan| scene.insert(Body::new(plan)).unwrap());
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 1.5, &levels).unwrap());
    for now in [0.0, 1.4, 2.55] {
        tick(&mut monitor, now);
        let window = Window::new(now, now + 1.5).unwrap();
        let query = Query::new(window).with_margin(1.5);
        let screened = monitor.scene().screen(&query).unwrap().conflicts;
        assert_eq!(monitor.conflicts(0).unwrap(), screened, "{now}");
    }
    let found = monitor.conflicts(0).unwrap()[0];
    assert_eq!(([found.a, found.b], found.exit), (bodies, 4.0));
}

/// Two margins that differ in their last bits are crossed in any order, by rounding.
#[test]
fn a_release_margin_next_to_the_margin_loses_no_encounter() {
    let mut rng = rng(23);
    let mut scene = Scene::new();
    for number in 0..400 {
        let at = DVec3::new(0.0, 100.0 * f64::from(number), 0.0);
        for _ in 0..2 {
            let states = wander(&mut rng, 0.0, 12, 1.0, 0.5, 1.0);
            let states = states
                .iter()
                .map(|state| State::new(state.time, state.position + at, state.velocity));
            let plan = Trajectory::from_states(&states.collect::<Vec<_>>()).unwrap();
            scene.insert(Body::new(plan)).unwrap();
        }
    }
    let margin = 0.3;
    for release in [margin, 0.1 + 0.2, margin * (1.0 + 1e-15)] {
        let level = AlertLevel::at(margin).with_release(release);
        let mut monitor =
            with_every_change(Monitor::new(scene.clone(), 0.0, 10.0, &[level]).unwrap());
        let reported = tick(&mut monitor, 0.0);
        let conflicts = monitor.conflicts(0).unwrap();
        assert!(conflicts.len() > 200, "{}", conflicts.len());
        let is_told = |conflict: &&nearmiss::Conflict| {
            reported.iter().any(|event| {
                event.kind.encounter().is_some_and(|encounter| {
                    let ids = (encounter.a, encounter.b) == (conflict.a, conflict.b);
                    ids && encounter.enter <= conflict.enter && encounter.exit >= conflict.exit
                })
            })
        };
        let lost = conflicts
            .iter()
            .filter(|conflict| !is_told(conflict))
            .count();
        assert_eq!(lost, 0, "{release:?}");
    }
}
