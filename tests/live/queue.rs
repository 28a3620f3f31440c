//! Requests that wait: what is superseded is not needed, whatever becomes of the requests around it.

use super::{LOOKAHEAD, PATIENCE, crowd};
use glam::DVec3;
#[cfg(feature = "serde")]
use nearmiss::live::Ticket;
use nearmiss::live::{Live, LiveOptions, ReportKind, Request};
use nearmiss::{Body, BodyId, Command, Error, State, Trajectory};
use std::time::Duration;

/// A live monitor that carries out what it is asked once its reports are read.
fn held(live: &Live) {
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    let body = Body::new(rest);
    // There is room for one answer.
    for _ in 0..3 {
        live.handle().what_if_body(body.clone(), 0).unwrap();
    }
}

fn live() -> (Live, Vec<BodyId>) {
    let (mut monitor, ids) = crowd(3, 2);
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    let options = LiveOptions::default().with_reports(1);
    (monitor.spawn(options).unwrap(), ids)
}

/// From 0 s to an end (s).
fn until(end: f64, y: f64) -> Trajectory {
    let states = [0.0, end].map(|time| State::new(time, y * DVec3::Y, DVec3::ZERO));
    Trajectory::from_states(&states).unwrap()
}

/// A request for an earlier clock is refused: the plan that goes on from that clock alone, too.
#[test]
fn a_clock_that_goes_back_supersedes_no_plan() {
    let (live, ids) = live();
    let handle = live.handle();
    held(&live);
    for time in [10.0, 5.0] {
        handle.send(Request::Clock(time)).unwrap();
    }
    let always = Trajectory::coasting(State::new(0.0, DVec3::X, DVec3::ZERO)).unwrap();
    for plan in [always.clone(), until(7.0, 9.0)] {
        handle
            .send(Command::Replan(ids[0], 0.0, plan.into()))
            .unwrap();
    }
    live.stop_requests();
    let reports: Vec<_> = live.reports().iter().collect();
    let refused = reports.iter();
    let refused = refused.filter(|report| matches!(report.kind, ReportKind::Refused { .. }));
    assert_eq!(refused.count(), 2, "{reports:?}");
    let stopped = live.shutdown().unwrap();
    assert_eq!(stopped.counts.superseded, 0);
    let flown = &stopped.monitor.scene().body(ids[0]).unwrap().trajectory;
    assert_eq!(flown.position(12.0), always.position(12.0));
}

/// Plans that end long before such a clock are superseded as ever once it was refused.
#[test]
fn a_clock_that_is_refused_is_forgotten() {
    let (live, ids) = live();
    let handle = live.handle();
    for time in [1e299, f64::INFINITY] {
        let ticket = handle.send(Request::Clock(time)).unwrap();
        let is_refused =
            |kind| matches!(kind, ReportKind::Refused { ticket: it, .. } if it == ticket);
        while !is_refused(live.reports().recv_timeout(PATIENCE).unwrap().kind) {}
    }
    held(&live);
    handle.send(Request::Clock(0.5)).unwrap();
    for y in [1.0, 2.0, 3.0] {
        let replan = Command::Replan(ids[0], 0.0, until(20.0 + LOOKAHEAD, y).into());
        handle.send(replan).unwrap();
    }
    live.stop_requests();
    while live.reports().recv().is_ok() {}
    let stopped = live.shutdown().unwrap();
    assert_eq!(stopped.counts.superseded, 2);
    let flown = &stopped.monitor.scene().body(ids[0]).unwrap().trajectory;
    assert_eq!(flown.position(9.0), Some(3.0 * DVec3::Y));
}

/// A clock request that is refused whatever the monitor is at takes no earlier one away.
#[test]
fn a_clock_that_will_be_refused_supersedes_none() {
    // 1e17 s: f64 does not resolve the lookahead there.
    for refused in [f64::INFINITY, f64::NAN, 1e301, 1e17] {
        let (live, _) = live();
        let handle = live.handle();
        held(&live);
        for time in [1.0, refused] {
            handle.send(Request::Clock(time)).unwrap();
        }
        live.stop_requests();
        while live.reports().recv().is_ok() {}
        let stopped = live.shutdown().unwrap();
        assert!((stopped.monitor.now() - 1.0).abs() < 1e-12);
        let counts = &stopped.counts;
        assert_eq!((counts.superseded, counts.refused), (0, 1));
    }
}

/// As long as nothing is known, there is no answer; then there is one.
#[test]
fn a_question_is_refused_while_nothing_is_known() {
    let (monitor, _) = crowd(3, 500);
    // A step at a time, and no more than a few before reports are read.
    let options = LiveOptions::default()
        .with_reports(1)
        .with_budget(Duration::ZERO);
    let live = monitor.spawn(options).unwrap();
    let body = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap());
    let early = live.handle().what_if_body(body.clone(), 0).unwrap();
    loop {
        match live.reports().recv_timeout(PATIENCE).unwrap().kind {
            ReportKind::Refused { ticket, error } => {
                assert_eq!(ticket, early);
                assert!(matches!(error, Error::NothingKnown { .. }), "{error}");
                break;
            }
            ReportKind::WhatIf { .. } => panic!("an answer before anything is known"),
            _ => {}
        }
    }
    while live.handle().complete_until() < LOOKAHEAD {
        live.reports().recv_timeout(PATIENCE).unwrap();
    }
    let late = live.handle().what_if_body(body, 0).unwrap();
    let answers =
        |kind: &ReportKind| matches!(kind, ReportKind::WhatIf { ticket, .. } if *ticket == late);
    while !answers(&live.reports().recv_timeout(PATIENCE).unwrap().kind) {}
    assert_eq!(live.shutdown().unwrap().counts.refused, 1);
}

/// Reports that were written down are told apart by their tickets.
#[cfg(feature = "serde")]
#[test]
fn a_ticket_is_read_as_it_was_written() {
    let (monitor, _) = crowd(7, 2);
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    for now in [0.1, 0.2] {
        let ticket = live.handle().advance(now).unwrap();
        let written = serde_json::to_string(&ticket).unwrap();
        assert_eq!(serde_json::from_str::<Ticket>(&written).unwrap(), ticket);
    }
    drop(live.shutdown().unwrap());
}
