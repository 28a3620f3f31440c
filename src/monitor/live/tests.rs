//! Tests that need the inside: a panic, and the queue of requests.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "times are handed on unchanged; a monitor that cannot be built fails the test"
)]

use super::request::RequestQueue;
use super::*;
use crate::error::Error;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::monitor::{AlertLevel, Budget, Command, EndReason, Event, EventKind};
use crate::orientation::Orientation;
use crate::scene::{Body, BodyPlan, Scene};
use crate::trajectory::{State, Trajectory};
use glam::{DQuat, DVec3};
use std::time::Duration;

fn rest(x: f64) -> Trajectory {
    Trajectory::at_rest(DVec3::new(x, 0.0, 0.0)).unwrap()
}

/// A clock that is set ahead is known to those that read it, and encounters begin anew there.
#[test]
fn a_clock_may_be_set_ahead() {
    let (monitor, _) = monitor();
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    let handle = live.handle();
    handle.advance(1.0).unwrap();
    handle.skip_to(500.0).unwrap();
    handle.advance(501.0).unwrap();
    let patience = Duration::from_secs(10);
    let reports = std::iter::from_fn(|| live.reports().recv_timeout(patience).ok());
    let kinds = reports.filter_map(|report| match report.kind {
        ReportKind::Event(event) => match event.kind {
            EventKind::Began(_) => Some(("began", event.time)),
            EventKind::Ended(_, EndReason::ClockSet) => Some(("ended", event.time)),
            _ => None,
        },
        _ => None,
    });
    let expected = [("began", 0.0), ("ended", 1.0), ("began", 500.0)];
    assert_eq!(kinds.take(3).collect::<Vec<_>>(), expected);
}

/// Two bodies 1 m apart, watched at 2 m.
fn monitor() -> (Monitor, [BodyId; 2]) {
    let mut scene = Scene::new();
    let ids = [0.0, 1.0].map(|x| scene.insert(Body::new(rest(x))).unwrap());
    (
        Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(2.0)]).unwrap(),
        ids,
    )
}

#[test]
fn a_panic_comes_back_with_the_monitor() {
    let (monitor, [a, _]) = monitor();
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    let handle = live.handle();
    handle.advance(1.0).unwrap();
    handle.send(Request::Panic).unwrap();
    // The reports end where the thread does.
    let seen: Vec<Report> = live.reports().iter().collect();
    assert!(
        matches!(seen[0].kind, ReportKind::Event(event) if matches!(event.kind, EventKind::Began(_)))
    );
    assert!(
        matches!(handle.advance(2.0), Err(Unsent::Closed(Request::Clock(time))) if time == 2.0)
    );
    let panicked = live.shutdown().unwrap_err();
    assert_eq!(panicked.message, "requested to");
    let counts = panicked.counts;
    assert_eq!((counts.sent, counts.applied, counts.refused), (2, 1, 1));
    // It goes on where it was: the encounter that began is known and ends once.
    let mut monitor = *panicked.monitor.unwrap();
    assert_eq!(monitor.now(), 1.0);
    monitor.remove(a).unwrap();
    let mut events = Vec::new();
    monitor.advance(3.0, &mut events).unwrap();
    assert_eq!(events.len(), 1);
    assert!(matches!(
        events[0].kind,
        EventKind::Ended(_, EndReason::BodyRemoved)
    ));
}

#[test]
fn after_a_panic_only_what_is_planned_is_reported() {
    let fly = |from: f64, speed: f64| {
        let states = [0.0, 20.0]
            .map(|time| State::new(time, DVec3::X * (from + speed * time), DVec3::X * speed));
        Trajectory::from_states(&states).unwrap()
    };
    let mut scene = Scene::new();
    let [a, _, c, _] = [(0.0, 1.0), (9.0, -1.0), (100.0, 1.0), (109.0, -1.0)]
        .map(|(from, speed)| scene.insert(Body::new(fly(from, speed))).unwrap());
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap();
    let mut events = Vec::new();
    monitor.advance(0.0, &mut events).unwrap();
    assert_eq!((monitor.conflicts(0).unwrap().len(), events.len()), (2, 2));
    monitor.set_trajectory(a, fly(-50.0, 0.0)).unwrap();
    monitor.remove(c).unwrap();
    monitor.forget_search().unwrap();
    events.clear();
    monitor.advance(0.0, &mut events).unwrap();
    assert_eq!(
        (monitor.conflicts(0).unwrap(), monitor.encounters().count()),
        (&[][..], 0)
    );
    let is_withdrawn = |event: &Event| matches!(event.kind, EventKind::Withdrawn(_));
    assert_eq!(events.iter().filter(|event| is_withdrawn(event)).count(), 2);
}

/// A shutdown breaks a tick off. Without a budget it compares several slices at once, and claims no more than was
/// compared, as with one.
#[test]
fn what_was_broken_off_is_not_claimed() {
    for budget in [
        Budget::Unlimited,
        Budget::Time(Duration::MAX),
        Budget::Work(9),
    ] {
        let (mut monitor, _) = monitor();
        let interrupt = Interrupt::default();
        interrupt.request();
        monitor.interrupt = Some(Arc::new(interrupt));
        let mut events = Vec::new();
        monitor.advance_within(0.5, budget, &mut events).unwrap();
        assert_eq!(monitor.complete_until(), 0.0, "{budget:?}");
        assert!(events.is_empty() && !monitor.is_caught_up());
        monitor.interrupt = None;
        monitor.advance(1.0, &mut events).unwrap();
        assert!(monitor.is_caught_up() && events.len() == 1);
        // Bodies that meet all the time began to when the clock did.
        assert_eq!(events[0].time, 0.0, "{budget:?}");
    }
}

#[test]
fn waiting_orders_coalesce_as_the_contract_says() {
    let (_, [a, b]) = monitor();
    let mut queue = RequestQueue::at(0.0, 10.0);
    let mut number = 0;
    let mut push = |queue: &mut RequestQueue, request: Request| {
        number += 1;
        queue.push(Ticket(number), request)
    };
    let plan = |id, from| Request::Change(Command::Replan(id, from, rest(0.0).into()));
    let set = |id| Request::Change(Command::SetTrajectory(id, rest(0.0)));
    let layers = |id| Request::Change(Command::SetLayers(id, Layers::NONE));
    // The latest plan wins, whatever else lies between.
    assert_eq!(push(&mut queue, plan(a, 5.0)), 0);
    assert_eq!(push(&mut queue, plan(b, 5.0)), 0);
    assert_eq!(push(&mut queue, layers(a)), 0);
    assert_eq!(push(&mut queue, plan(a, 5.0)), 1);
    // A later beginning leaves a part of the earlier plan: both are needed.
    assert_eq!(push(&mut queue, plan(a, 6.0)), 0);
    assert_eq!(push(&mut queue, set(a)), 2);
    // Not across a clock request; clock requests merge only side by side, and only forwards.
    assert_eq!(push(&mut queue, Request::Clock(1.0)), 0);
    assert_eq!(push(&mut queue, Request::Clock(2.0)), 1);
    assert_eq!(push(&mut queue, Request::Clock(1.5)), 0);
    assert_eq!(push(&mut queue, set(a)), 0);
    assert_eq!(push(&mut queue, Request::Clock(3.0)), 0);
    // Nor across a batch.
    assert_eq!(push(&mut queue, set(b)), 0);
    assert_eq!(push(&mut queue, Request::Batch(vec![])), 0);
    assert_eq!(push(&mut queue, set(b)), 0);
    // Nor across a question.
    let question = || Request::WhatIf(a, rest(0.0).into(), 0);
    assert_eq!(push(&mut queue, question()), 0);
    assert_eq!(push(&mut queue, set(b)), 0);
    let left: Vec<Request> = std::iter::from_fn(|| queue.pop())
        .map(|(_, request)| request)
        .collect();
    assert_eq!(
        left,
        [
            plan(b, 5.0),
            layers(a),
            set(a),
            Request::Clock(2.0),
            Request::Clock(1.5),
            set(a),
            Request::Clock(3.0),
            set(b),
            Request::Batch(vec![]),
            set(b),
            question(),
            set(b),
        ]
    );
    // Numbers go on after requests were taken.
    assert_eq!(push(&mut queue, set(a)), 0);
    assert_eq!(push(&mut queue, set(a)), 1);
    assert_eq!(queue.pop().map(|(_, request)| request), Some(set(a)));
    // A plan that will be refused replaces nothing: it ends before it is to begin.
    let over = |id, from| {
        let states = [0.0, 1.0].map(|time| State::new(time, DVec3::ZERO, DVec3::ZERO));
        Request::Change(Command::Replan(
            id,
            from,
            Trajectory::from_states(&states).unwrap().into(),
        ))
    };
    assert_eq!(push(&mut queue, plan(a, 5.0)), 0);
    assert_eq!(push(&mut queue, over(a, 4.0)), 0);
    // Or before the clock by then.
    assert_eq!(push(&mut queue, Request::Clock(4.0)), 0);
    assert_eq!(push(&mut queue, plan(a, 3.0)), 0);
    assert_eq!(push(&mut queue, over(a, 0.5)), 0);
    assert_eq!(push(&mut queue, plan(a, 0.5)), 2);
    // Nor does one replace what another one may rest on.
    let extend = |id| Request::Change(Command::Extend(id, rest(1.0).into()));
    assert_eq!(push(&mut queue, plan(b, 5.0)), 0);
    assert_eq!(push(&mut queue, extend(b)), 0);
    assert_eq!(push(&mut queue, plan(b, 5.0)), 0);
    assert_eq!(push(&mut queue, set(b)), 3);
}

/// A plan with an orientation is replaced where nothing is left of that.
#[test]
fn an_orientation_is_not_lost_with_the_plan_that_carried_it() {
    let spin = Orientation::spin(0.0, DQuat::IDENTITY, DVec3::Z).unwrap();
    let fine = spin.clone().with_tolerance(1e-4).unwrap();
    let plans = [None, Some(spin), Some(fine), Some(Orientation::FIXED)];
    let (_, [id, _]) = monitor();
    let replan = |orientation: &Option<Orientation>| {
        let (trajectory, orientation) = (rest(0.0), orientation.clone());
        let plan = BodyPlan {
            orientation,
            ..trajectory.into()
        };
        Request::Change(Command::Replan(id, 5.0, plan))
    };
    // By the earlier plan: whether each of the later ones, and a whole trajectory, replaces it.
    let expected = [
        [1, 1, 1, 1, 1],
        [0, 1, 1, 1, 0],
        [0, 0, 1, 0, 0],
        [0, 0, 1, 0, 0],
    ];
    for (earlier, expected) in plans.iter().zip(expected) {
        let set = Request::Change(Command::SetTrajectory(id, rest(0.0)));
        let later = plans.iter().map(replan).chain([set]);
        for (later, superseded) in later.zip(expected) {
            let mut queue = RequestQueue::at(0.0, 10.0);
            queue.push(Ticket(0), replan(earlier));
            assert_eq!(queue.push(Ticket(1), later), superseded, "{earlier:?}");
        }
    }
}

/// Nothing is remembered of requests that were taken, however long others wait.
#[test]
fn orders_that_were_taken_leave_nothing() {
    let mut queue = RequestQueue::at(0.0, 10.0);
    for number in 0..1_000 {
        let id = BodyId {
            slot: number % 90,
            generation: number,
        };
        let request = Command::SetTrajectory(id, rest(0.0)).into();
        queue.push(Ticket(number.into()), request);
        if number >= 10 {
            assert!(queue.pop().is_some());
        }
        assert!(queue.plans() <= queue.len());
    }
}

/// A failure to catch up is reported, and again after each request.
#[test]
fn a_monitor_that_is_stuck_says_so() {
    /// Longer than any report takes.
    const PATIENCE: Duration = Duration::from_secs(10);
    let (mut monitor, _) = monitor();
    monitor.set_max_spans(0);
    let options = LiveOptions {
        budget: Duration::ZERO,
        ..LiveOptions::default()
    };
    let live = monitor.spawn(options).unwrap();
    let game = live.handle();
    for id in 0..2 {
        game.advance(0.0).unwrap();
        // Within the budget or after it.
        let is_reported = |report: &Report| match &report.kind {
            ReportKind::Stuck { error } | ReportKind::Refused { error, .. } => {
                matches!(error, Error::TooCrowded { limit: 0, .. })
            }
            _ => false,
        };
        let mut reports = std::iter::from_fn(|| live.reports().recv_timeout(PATIENCE).ok());
        assert!(reports.any(|report| is_reported(&report)), "{id}");
    }
    assert!(!live.shutdown().unwrap().monitor.is_caught_up());
}

/// A plan with a model error is replaced by one with another.
#[test]
fn a_model_error_is_not_lost_with_the_plan_that_carried_it() {
    let (_, [id, _]) = monitor();
    let plan = |metres: Option<f64>| BodyPlan {
        model_error: metres,
        ..rest(0.0).into()
    };
    let replan = |metres| Request::Change(Command::Replan(id, 5.0, plan(metres)));
    let set = Request::Change(Command::SetTrajectory(id, rest(0.0)));
    for (earlier, later, superseded) in [
        (replan(Some(1.0)), replan(None), 0),
        (replan(Some(1.0)), replan(Some(0.0)), 1),
        (replan(None), replan(Some(1.0)), 1),
        (replan(Some(1.0)), set.clone(), 0),
        (replan(None), set, 1),
    ] {
        let mut queue = RequestQueue::at(0.0, 10.0);
        assert_eq!(queue.push(Ticket(1), earlier), 0);
        assert_eq!(queue.push(Ticket(2), later), superseded);
    }
}
