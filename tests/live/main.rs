//! The live monitor's contract: floods, readers that stall, shutdowns; nothing lost on either side.

#![cfg(feature = "live")]
#![allow(
    clippy::unwrap_used,
    reason = "a monitor that cannot be built fails the test"
)]

mod queue;
mod readers;
#[path = "../support/mod.rs"]
mod support;

use nearmiss::live::crossbeam_channel::{RecvTimeoutError, bounded, select};
use nearmiss::live::{Handle, LiveOptions, Report, ReportKind, Request, Unsent};
use nearmiss::{
    AlertLevel, Body, BodyId, Command, EncounterId, Error, Event, EventKind, Hitbox, Monitor,
    Scene, State, Trajectory, Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use support::{bits, rng, screen, wander, with_every_change};

const MARGIN: f64 = 3.0;
const LOOKAHEAD: f64 = 5.0;
/// Longer than any report takes.
const PATIENCE: Duration = Duration::from_secs(5);

/// Wanderers in a cube, 40 s long.
fn crowd(seed: u64, count: u32) -> (Monitor, Vec<BodyId>) {
    let mut rng = rng(seed);
    let cube = 12.0 * f64::from(count).cbrt();
    let mut scene = Scene::new();
    let ids = (0..count)
        .map(|_| {
            let plan = Trajectory::from_states(&wander(&mut rng, 0.0, 40, 1.0, cube, 5.0));
            let body = Body::new(plan.unwrap()).with_hitbox(Hitbox::sphere(0.5).unwrap());
            scene.insert(body).unwrap()
        })
        .collect();
    let monitor =
        with_every_change(Monitor::new(scene, 0.0, LOOKAHEAD, &[AlertLevel::at(MARGIN)]).unwrap());
    (monitor, ids)
}

fn plan(rng: &mut ChaCha8Rng, now: f64, cube: f64) -> Trajectory {
    Trajectory::from_states(&wander(rng, now, 20, 2.0, cube, 5.0)).unwrap()
}

/// Checks that the events of each encounter make sense.
#[derive(Default)]
struct Ledger {
    ahead: BTreeSet<EncounterId>,
    under_way: BTreeSet<EncounterId>,
    ended: u64,
}

impl Ledger {
    fn read(&mut self, event: &Event) {
        match event.kind {
            EventKind::Predicted(encounter) => assert!(self.ahead.insert(encounter.id)),
            EventKind::Withdrawn(encounter) => assert!(self.ahead.remove(&encounter.id)),
            EventKind::Began(encounter) => {
                self.ahead.remove(&encounter.id);
                assert!(self.under_way.insert(encounter.id));
            }
            EventKind::Ended(encounter, _) => {
                assert!(self.under_way.remove(&encounter.id));
                self.ended += 1;
            }
            _ => {}
        }
    }

    fn read_all<'r>(&mut self, reports: impl IntoIterator<Item = &'r Report>) {
        for report in reports {
            if let ReportKind::Event(event) = &report.kind {
                self.read(event);
            }
        }
    }

    /// After the last event of a monitor that was closed.
    fn finish(&mut self, monitor: Monitor) {
        let mut events = Vec::new();
        monitor.close(&mut events);
        events.iter().for_each(|event| self.read(event));
        assert!(self.ahead.is_empty() && self.under_way.is_empty());
    }
}

/// Seconds of the flood; `NEARMISS_SECONDS` asks for more.
fn seconds(default: f64) -> f64 {
    let asked = std::env::var("NEARMISS_SECONDS").ok();
    asked.and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// Resident memory, bytes; none where the system does not say.
fn memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * 4096)
}

/// Sends replans as fast as it can, and the clock sixty times a second. Returns what was accepted
/// and what was handed back.
fn flood(handle: &Handle, ids: &[BodyId], until: &AtomicBool) -> (u64, u64) {
    let mut rng = rng(77);
    // Making plans is slower than sending them: a stock of them is enough.
    let stock: Vec<Trajectory> = (0..64).map(|_| plan(&mut rng, 0.0, 60.0)).collect();
    let begin = Instant::now();
    let mut next_tick = 0.0;
    let (mut accepted, mut busy) = (0, 0);
    while !until.load(Ordering::Relaxed) {
        let elapsed = begin.elapsed().as_secs_f64().min(30.0);
        let sent = if elapsed >= next_tick {
            next_tick += 1.0 / 60.0;
            handle.advance(elapsed)
        } else {
            let id = ids[rng.random_range(0..ids.len())];
            let plan = stock[rng.random_range(0..stock.len())].clone();
            handle.send(Command::SetTrajectory(id, plan))
        };
        match sent {
            Ok(_) => accepted += 1,
            Err(Unsent::Busy(_)) => busy += 1,
            Err(Unsent::Closed(_)) => panic!("closed"),
        }
    }
    (accepted, busy)
}

#[test]
fn a_flood_and_a_reader_that_sleeps_lose_nothing() {
    let (monitor, ids) = crowd(1, 300);
    let options = LiveOptions::default()
        .with_requests(1_000)
        .with_reports(200);
    let live = monitor.spawn(options).unwrap();
    let (handle, over) = (live.handle(), AtomicBool::new(false));
    let mut ledger = Ledger::default();
    let duration = Duration::from_secs_f64(seconds(2.0));
    std::thread::scope(|scope| {
        let flood = scope.spawn(|| flood(&handle, &ids, &over));
        let read_for = |ledger: &mut Ledger, duration: Duration| {
            let end = Instant::now() + duration;
            while let Ok(report) = live.reports().recv_deadline(end) {
                ledger.read_all([&report]);
            }
        };
        read_for(&mut ledger, duration / 4);
        let before = memory();
        // The reader sleeps: soon the monitor stands still, and says so.
        std::thread::sleep(duration / 4);
        let stalled = handle.complete_until();
        std::thread::sleep(duration / 8);
        assert!(live.reports().is_full());
        assert_eq!(handle.complete_until().to_bits(), stalled.to_bits());
        read_for(&mut ledger, duration / 4);
        if let (Some(before), Some(after)) = (before, memory()) {
            // Queues of 1,000 plans of 3 kB each, twice, and what the allocator keeps of them.
            assert!(after < before + (64 << 20), "{before} {after}");
        }
        over.store(true, Ordering::Relaxed);
        let (accepted, busy) = flood.join().unwrap();
        assert_eq!(handle.counts().sent, accepted);
        assert!(
            busy > accepted / 100,
            "a flood fills the queue: {busy} of {accepted}"
        );
        // Recovery: within a second all that waited is done and the lookahead is whole.
        let begin = Instant::now();
        let target = handle.now() + 0.5;
        while handle.advance(target.max(handle.now() + 0.5)).is_err() {
            read_for(&mut ledger, Duration::from_millis(1));
        }
        loop {
            read_for(&mut ledger, Duration::from_millis(5));
            let counts = handle.counts();
            let done = counts.sent == counts.applied + counts.superseded + counts.refused;
            if done && handle.complete_until() >= handle.now() + LOOKAHEAD {
                break;
            }
            assert!(begin.elapsed() < Duration::from_secs(1), "{counts:?}");
        }
    });
    let stopped = live.shutdown().unwrap();
    let counts = stopped.counts;
    assert!(stopped.unapplied.is_empty());
    assert_eq!(
        counts.sent,
        counts.applied + counts.superseded + counts.refused
    );
    assert!(counts.superseded > 0 && counts.applied > 0, "{counts:?}");
    ledger.read_all(&stopped.reports);
    // What it knows after all this is what screening says.
    let monitor = stopped.monitor;
    let window = Window::new(monitor.now(), monitor.now() + LOOKAHEAD).unwrap();
    let expected = screen(monitor.scene(), window, MARGIN);
    assert_eq!(bits(monitor.conflicts(0).unwrap()), bits(&expected));
    ledger.finish(monitor);
    assert!(ledger.ended > 0);
}

#[test]
fn shutdown_is_quick_and_hands_everything_back() {
    let (monitor, ids) = crowd(2, 1_000);
    let options = LiveOptions::default().with_requests(500).with_reports(3);
    let live = monitor.spawn(options).unwrap();
    let handle = live.handle();
    let mut rng = rng(5);
    let mut accepted = 0;
    handle.advance(0.1).unwrap();
    // Nobody reads: the queue fills up.
    let end = Instant::now() + Duration::from_millis(200);
    while Instant::now() < end {
        let plan = plan(&mut rng, 0.0, 60.0);
        let sent = handle.send(Command::SetTrajectory(ids[accepted % ids.len()], plan));
        accepted += usize::from(sent.is_ok());
    }
    let begin = Instant::now();
    let stopped = live.shutdown().unwrap();
    let took = begin.elapsed();
    assert!(took < Duration::from_millis(100), "{took:?}");
    let counts = stopped.counts;
    assert_eq!(counts.sent, accepted as u64 + 1);
    assert_eq!(
        counts.sent,
        counts.applied + counts.superseded + counts.refused
    );
    assert_eq!(counts.refused, stopped.unapplied.len() as u64);
    assert!(counts.refused > 0);
    assert!(stopped.unapplied.is_sorted_by_key(|(ticket, _)| *ticket));
    // All events of the clock order that was applied are among the reports.
    let mut ledger = Ledger::default();
    ledger.read_all(&stopped.reports);
    assert!(stopped.reports.len() > 3);
    ledger.finish(stopped.monitor);
    let refused = handle.send(Request::Clock(9.0)).unwrap_err();
    assert_eq!(refused, Unsent::Closed(Request::Clock(9.0)));
    assert_eq!(refused.into_request(), Request::Clock(9.0));
}

#[test]
fn a_full_queue_hands_the_order_back() {
    let (monitor, _) = crowd(3, 50);
    let options = LiveOptions::default().with_requests(2).with_reports(1);
    let live = monitor.spawn(options).unwrap();
    let handle = live.handle();
    let mut time = 0.0;
    let busy = loop {
        time += 0.01;
        if let Err(unsent) = handle.advance(time) {
            break unsent;
        }
        assert!(time < 10.0);
    };
    assert_eq!(busy, Unsent::Busy(Request::Clock(time)));
    drop(live);
    assert!(matches!(handle.advance(time), Err(Unsent::Closed(_))));
}

#[test]
fn reports_work_in_a_select_and_come_tick_by_tick() {
    let (monitor, ids) = crowd(4, 60);
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    let handle = live.handle();
    let (game, frames) = bounded(8);
    std::thread::spawn(move || {
        for frame in 1..=60 {
            game.send(frame).unwrap();
        }
    });
    let mut ledger = Ledger::default();
    let (mut ticks, mut last) = (0, 0.0);
    let mut sent_at = 0.0;
    loop {
        select! {
            recv(frames) -> frame => match frame {
                Ok(frame) => {
                    sent_at = f64::from(frame) / 60.0;
                    handle.advance(sent_at).unwrap();
                }
                Err(_) if last >= sent_at => break,
                Err(_) => {}
            },
            recv(live.reports()) -> report => match report.unwrap().kind {
                ReportKind::Event(event) => {
                    ledger.read(&event);
                    // Of this tick: not before the last one's clock.
                    assert!(event.time >= last);
                }
                ReportKind::Ticked { now, complete_until } => {
                    assert!(now >= last && complete_until <= now + LOOKAHEAD);
                    last = now;
                    ticks += 1;
                }
                other => panic!("{other:?}"),
            },
        }
    }
    assert!(ticks > 0);
    // A new body, and one that is refused: each with its ticket.
    let rest = Body::new(Trajectory::at_rest(glam::DVec3::ZERO).unwrap());
    let insertion = handle.send(Command::Insert(rest)).unwrap();
    let removal = handle.send(vec![Command::Remove(ids[0]), Command::Remove(ids[0])]);
    let mut answers = Vec::new();
    while answers.len() < 2 {
        match live
            .reports()
            .recv_timeout(PATIENCE)
            .map(|report| report.kind)
        {
            Ok(ReportKind::Inserted { ticket, ids }) => answers.push((ticket, ids.len())),
            Ok(ReportKind::Refused { ticket, .. }) => answers.push((ticket, 0)),
            Ok(_) => {}
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => panic!("no answer"),
        }
    }
    assert_eq!(answers, [(insertion, 1), (removal.unwrap(), 0)]);
    let stopped = live.shutdown().unwrap();
    assert_eq!(stopped.monitor.scene().len(), 61);
}

/// After all that was ordered before, and with the answer of a monitor that is not on a thread.
#[test]
fn a_question_is_answered_in_its_turn() {
    let (mut embedded, ids) = crowd(6, 120);
    let (monitor, _) = crowd(6, 120);
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    let handle = live.handle();
    embedded.advance(1.0, &mut Vec::new()).unwrap();
    let _ = handle.advance(1.0).unwrap();
    // Until all is known: an answer before it would be about less.
    while handle.complete_until() < embedded.complete_until() {
        live.reports().recv_timeout(PATIENCE).unwrap();
    }
    let rest = |id| {
        let trajectory = &embedded.scene().body(id).unwrap().trajectory;
        Trajectory::at_rest(trajectory.position(1.0).unwrap()).unwrap()
    };
    let (here, there) = (rest(ids[0]), rest(ids[1]));
    embedded.set_trajectory(ids[1], here.clone()).unwrap();
    let _ = handle
        .send(Command::SetTrajectory(ids[1], here.clone()))
        .unwrap();
    let asked = handle.what_if(ids[2], here.clone(), 0).unwrap();
    let both = [(ids[2], here.clone()), (ids[3], here.clone())];
    let together = handle.what_if_plans(both.clone(), 0).unwrap();
    let back = Command::SetTrajectory(ids[1], there.clone());
    let _ = handle.send(back).unwrap();
    let new = Body::new(here.clone());
    let about_new = handle.what_if_body(new.clone(), 0).unwrap();
    let unknown = handle.what_if(ids[2], here.clone(), 99).unwrap();
    let mut answered = 0;
    loop {
        match live.reports().recv_timeout(PATIENCE).unwrap().kind {
            ReportKind::WhatIf {
                ticket,
                conflicts,
                complete_until,
            } => {
                assert_eq!(
                    complete_until.to_bits(),
                    embedded.complete_until().to_bits()
                );
                answered += 1;
                if ticket == about_new {
                    let before = embedded.scene().body(ids[1]).unwrap().trajectory.clone();
                    let there = there.clone();
                    embedded.set_trajectory(ids[1], there).unwrap();
                    let expected = embedded.what_if_body(&new, 0).unwrap();
                    embedded.set_trajectory(ids[1], before).unwrap();
                    assert_eq!(bits(&conflicts), bits(&expected));
                    continue;
                }
                let (expected, partner) = if ticket == together {
                    let both = both.iter().map(|(id, plan)| (*id, plan));
                    (embedded.what_if_plans(both, 0).unwrap(), ids[3])
                } else {
                    assert_eq!(ticket, asked);
                    (embedded.what_if(ids[2], &here, 0).unwrap(), ids[1])
                };
                assert_eq!(bits(&conflicts), bits(&expected));
                let pair = (partner.min(ids[2]), partner.max(ids[2]));
                assert!(conflicts.iter().any(|found| (found.a, found.b) == pair));
            }
            ReportKind::Refused { ticket, error } => {
                assert_eq!(ticket, unknown);
                assert_eq!(error, Error::UnknownAlertLevel { level: 99 });
                break;
            }
            _ => {}
        }
    }
    assert_eq!(answered, 3);
    assert_eq!(live.shutdown().unwrap().counts.refused, 1);
}

#[test]
fn a_live_monitor_says_what_an_embedded_one_says() {
    let (mut embedded, ids) = crowd(6, 120);
    let (mut monitor, _) = crowd(6, 120);
    // What lies ahead at the start is told before, so that no catching up comes in between.
    embedded.advance(0.0, &mut Vec::new()).unwrap();
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    let options = LiveOptions::default().with_budget(Duration::MAX);
    let live = monitor.spawn(options).unwrap();
    let handle = live.handle();
    let mut rng = rng(9);
    let mut said = Vec::new();
    for tick in 1..120 {
        let now = f64::from(tick) / 30.0;
        let id = ids[rng.random_range(0..ids.len())];
        let state = embedded.scene().body(id).unwrap();
        let from = embedded.now();
        let position = state.trajectory.position(from).unwrap();
        let mut states = wander(&mut rng, from, 20, 2.0, 60.0, 5.0);
        states[0] = State::new(from, position, states[0].velocity);
        let plan = Trajectory::from_states(&states).unwrap();
        handle
            .send(Command::Replan(id, from, plan.clone().into()))
            .unwrap();
        handle.advance(now).unwrap();
        let mut heard = Vec::new();
        for report in live.reports() {
            match report.kind {
                ReportKind::Event(event) => heard.push(event),
                ReportKind::Ticked { .. } => break,
                other => panic!("{other:?}"),
            }
        }
        said.clear();
        embedded.replan(id, from, plan).unwrap();
        embedded.advance(now, &mut said).unwrap();
        assert!(heard == said, "tick {tick}");
    }
}

/// What one comparison of all boxes takes is no reason to wait: it is broken off.
#[test]
fn a_crowd_does_not_hold_up_a_shutdown() {
    let mut scene = Scene::new();
    for _ in 0..20_000 {
        let rest = Body::new(Trajectory::at_rest(glam::DVec3::ZERO).unwrap());
        scene.insert(rest).unwrap();
    }
    let monitor =
        with_every_change(Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(1.0)]).unwrap());
    let live = monitor.spawn(LiveOptions::default()).unwrap();
    live.handle().advance(0.1).unwrap();
    std::thread::sleep(Duration::from_millis(100));
    let begin = Instant::now();
    let stopped = live.shutdown().unwrap();
    assert!(begin.elapsed() < Duration::from_millis(500));
    // As after a budget that was spent: nothing is claimed that was not looked at.
    assert!(!stopped.monitor.is_caught_up());
    assert_eq!(stopped.monitor.conflicts(0).unwrap(), []);
}

/// However short a stretch of work is, the monitor catches up; also from clock 0 to today's.
#[test]
fn the_smallest_budget_gets_there() {
    let (monitor, _) = crowd(9, 30);
    let options = LiveOptions::default().with_budget(Duration::ZERO);
    let live = monitor.spawn(options).unwrap();
    for now in [1.0, 1.7e9] {
        live.handle().advance(now).unwrap();
        let is_there = |report: &Report| match &report.kind {
            ReportKind::Ticked { complete_until, .. } => *complete_until >= now + LOOKAHEAD,
            _ => false,
        };
        let mut reports = live.reports().iter().take(100_000);
        assert!(reports.any(|report| is_there(&report)), "{now}");
    }
    drop(live.shutdown());
}

#[test]
fn queues_hold_something_and_not_everything() {
    let too_many = LiveOptions::MAX + 1;
    for (orders, reports) in [(0, 1), (1, 0), (usize::MAX, 1), (1, too_many)] {
        let options = LiveOptions::default()
            .with_requests(orders)
            .with_reports(reports);
        let refused = crowd(1, 2).0.spawn(options).unwrap_err();
        assert_eq!(refused.kind(), std::io::ErrorKind::InvalidInput);
    }
}
