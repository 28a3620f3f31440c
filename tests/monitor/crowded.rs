//! Scenes for which a monitor has too little room.

use super::scenarios::tick;
use super::support::{bits, line, rng, vector};
use glam::DVec3;
use nearmiss::{AlertLevel, Body, BodyId, Budget, Error, Monitor, Query, Scene, Window};

const LEVEL: AlertLevel = AlertLevel::at(2.0);

/// Bodies that are at one place at 15 s, and 30 m from it at 0 and 30 s; each two of them make a pair
/// that may touch only around then.
fn crowd(count: usize) -> Vec<Body> {
    let mut rng = rng(7);
    let flights = (0..count).map(|_| {
        let velocity = 2.0 * vector(&mut rng, 1.0).normalize();
        line(0.0, 30.0, -15.0 * velocity, velocity)
    });
    flights.map(Body::new).collect()
}

fn monitor_of(bodies: &[Body]) -> (Monitor, Vec<BodyId>) {
    let mut scene = Scene::new();
    let ids = bodies
        .iter()
        .map(|body| scene.insert(body.clone()).unwrap());
    let ids = ids.collect();
    let mut monitor = Monitor::new(scene, 0.0, 6.0, &[LEVEL]).unwrap();
    monitor.set_most_spans(1_000);
    (monitor, ids)
}

fn is_as_screened(monitor: &Monitor) {
    let window = Window::new(monitor.now(), monitor.certified_until()).unwrap();
    let query = Query::new(window).with_margin(LEVEL.margin).unwrap();
    let screened = monitor.scene().screen(&query).unwrap();
    assert_eq!(bits(monitor.conflicts(0)), bits(&screened.conflicts));
}

const REFUSED: Error = Error::TooCrowded { limit: 1_000 };

/// 60 bodies, 1,770 pairs.
#[test]
fn a_crowd_is_refused_and_leaves_the_monitor_as_it_was() {
    // By frames, in one step, and in a jump so far that it is bridged.
    for steps in [1_000, 1, 0] {
        for budget in [Budget::Unlimited, Budget::Work(500)] {
            let (mut monitor, ids) = monitor_of(&crowd(60));
            let mut events = Vec::new();
            let mut refused = None;
            let to = if steps == 0 { 1e4 } else { 12.0 };
            for step in 0..=10 * steps.max(1) {
                let now = to * (f64::from(step) / f64::from(steps.max(1))).min(1.0);
                let before = (
                    monitor.now(),
                    monitor.certified_until(),
                    bits(monitor.conflicts(0)),
                );
                let told = events.len();
                if let Err(error) = monitor.advance_within(now, budget, &mut events) {
                    assert_eq!(events.len(), told);
                    let after = (
                        monitor.now(),
                        monitor.certified_until(),
                        bits(monitor.conflicts(0)),
                    );
                    assert_eq!(before, after);
                    refused = Some((now, error));
                    break;
                }
            }
            let (now, error) = refused.unwrap();
            assert_eq!(error, REFUSED, "{steps} {budget:?}");
            // Still so, and what is asked meanwhile has its answer: nothing had come near by then.
            assert_eq!(monitor.advance(now, &mut events), Err(REFUSED));
            if steps > 0 {
                is_as_screened(&monitor);
            }
            let plan = line(0.0, 30.0, -14.0 * DVec3::X, DVec3::X);
            let alone = monitor.what_if(ids[0], &plan, 0).unwrap();
            let mut scene = monitor.scene().clone();
            scene.set_trajectory(ids[0], plan).unwrap();
            let window = Window::new(monitor.now(), monitor.certified_until()).unwrap();
            let query = Query::new(window).with_margin(LEVEL.margin).unwrap();
            let mut screened = scene.screen(&query).unwrap().conflicts;
            screened.retain(|conflict| conflict.a == ids[0] || conflict.b == ids[0]);
            assert_eq!(bits(&alone), bits(&screened));
            // 40 bodies, 780 pairs.
            for &id in &ids[40..] {
                monitor.remove(id).unwrap();
            }
            while monitor.now() < now || !monitor.is_caught_up() {
                monitor.advance_within(now, budget, &mut events).unwrap();
            }
            is_as_screened(&monitor);
        }
    }
}

/// The same events as those of a monitor that had room from the beginning.
#[test]
fn more_room_is_enough() {
    let (mut roomy, _) = monitor_of(&crowd(60));
    roomy.set_most_spans(Monitor::MOST_SPANS);
    let (mut monitor, _) = monitor_of(&crowd(60));
    let mut refused = 0;
    for step in 0..300 {
        let now = 0.1 * f64::from(step);
        let mut events = Vec::new();
        if let Err(error) = monitor.advance(now, &mut events) {
            assert_eq!(error, REFUSED);
            refused += 1;
            monitor.set_most_spans(2_000);
            events = tick(&mut monitor, now);
        }
        assert_eq!(events, tick(&mut roomy, now));
        is_as_screened(&monitor);
    }
    assert_eq!(refused, 1);
}
