//! Scenes for which a monitor has too little room.

use super::is_as_screened;
use super::scenarios::tick;
use super::support::{bits, exceeded, line, rng, vector, with_every_change};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Budget, Error, Hitbox, Monitor, Scene, Sphere, State, Trajectory,
};

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
    // Two meet at 7 s, far from all others: a jump comes past them before it comes to the crowd.
    for (x, velocity) in [(1e3, DVec3::X), (1e3 + 14.0, -DVec3::X)] {
        let plan = line(0.0, 9.0, DVec3::new(x, 0.0, 0.0), velocity);
        scene.insert(Body::new(plan)).unwrap();
    }
    let mut monitor = with_every_change(Monitor::new(scene, 0.0, 6.0, &[LEVEL]).unwrap());
    monitor.set_max_spans(1_000);
    (monitor, ids)
}

const LIMIT: usize = 1_000;

/// 60 bodies, 1,770 pairs; by frames, in one step, and in a jump so far that it is bridged.
#[test]
fn a_crowd_is_refused_and_leaves_the_monitor_as_it_was() {
    for (to, steps) in [(12.0, 1_000), (12.0, 1), (1e4, 1)] {
        for budget in [Budget::Unlimited, Budget::Work(500)] {
            refuse_and_go_on((to, steps), budget);
        }
    }
}

fn refuse_and_go_on((to, steps): (f64, u32), budget: Budget) {
    let bodies = crowd(60);
    let (mut monitor, ids) = monitor_of(&bodies);
    let (mut roomy, _) = monitor_of(&bodies);
    roomy.set_max_spans(Monitor::MAX_SPANS);
    let (mut events, mut as_roomy) = (Vec::new(), Vec::new());
    let state = |monitor: &Monitor| {
        let conflicts = bits(monitor.conflicts(0).unwrap());
        (monitor.now(), monitor.complete_until(), conflicts)
    };
    let mut step = 0;
    let now = loop {
        let now = to * f64::from(step.min(steps)) / f64::from(steps);
        let (before, reported) = (state(&monitor), events.len());
        if let Err(error) = monitor.advance_within(now, budget, &mut events) {
            assert_eq!(exceeded::<()>(Err(error)), Some(LIMIT));
            assert_eq!((state(&monitor), events.len()), (before, reported));
            break now;
        }
        roomy.advance_within(now, budget, &mut as_roomy).unwrap();
        step += 1;
    };
    // Still so, however often; and what is asked meanwhile has its answer.
    monitor.set_max_spans(500);
    for _ in 0..10 {
        let refused = monitor.advance(now, &mut events);
        assert_eq!(exceeded(refused), Some(500));
        assert!(!monitor.is_caught_up());
    }
    monitor.set_max_spans(1_000);
    let plan = bodies[1].trajectory.clone();
    if plan.domain().contains(now) {
        is_as_screened(&monitor, LEVEL);
        let found = monitor.what_if(ids[0], &plan, 0).unwrap();
        assert!(!found.is_empty(), "both fly the same");
        let as_found = roomy.what_if(ids[0], &plan, 0).unwrap();
        assert_eq!(bits(&found), bits(&as_found));
    }
    // 40 bodies, 780 pairs.
    for (monitor, events) in [(&mut monitor, &mut events), (&mut roomy, &mut as_roomy)] {
        for &id in &ids[40..] {
            monitor.remove(id).unwrap();
        }
        while monitor.now() < now || !monitor.is_caught_up() {
            monitor.advance_within(now, budget, events).unwrap();
        }
        is_as_screened(monitor, LEVEL);
    }
    if budget == Budget::Unlimited {
        assert!(events == as_roomy, "{to} {steps}");
    }
}

/// The same events as those of a monitor that had room from the beginning.
#[test]
fn more_room_is_enough() {
    let (mut roomy, _) = monitor_of(&crowd(60));
    roomy.set_max_spans(Monitor::MAX_SPANS);
    let (mut monitor, _) = monitor_of(&crowd(60));
    let mut refused = 0;
    for step in 0..300 {
        let now = 0.1 * f64::from(step);
        let mut events = Vec::new();
        if let Err(error) = monitor.advance(now, &mut events) {
            assert_eq!(exceeded::<()>(Err(error)), Some(LIMIT));
            refused += 1;
            monitor.set_max_spans(2_000);
            events = tick(&mut monitor, now);
        }
        assert_eq!(events, tick(&mut roomy, now));
        is_as_screened(&monitor, LEVEL);
    }
    assert_eq!(refused, 1);
}

/// Returns so many spheres that are spread evenly over a shell of 1 m.
fn shell(count: u32) -> Hitbox {
    let sphere = |number: u32| {
        let height = 1.0 - (2.0 * f64::from(number) + 1.0) / f64::from(count);
        let (sin, cos) = (2.4 * f64::from(number)).sin_cos();
        let across = (1.0 - height * height).sqrt();
        Sphere::new(DVec3::new(across * cos, across * sin, height) * 0.8, 0.2)
    };
    Hitbox::cluster((0..count).map(sphere).collect()).unwrap()
}

/// Clusters that coast past each other for as long as a piece of their way, within a wide release margin: few of 16,384
/// pairs of spheres are the nearest ones at some time.
#[test]
fn few_pairs_of_spheres_are_kept_of_coasting_clusters() {
    let level = AlertLevel::at(0.0).with_release(3.0);
    let mut scene = Scene::new();
    let places = [DVec3::ZERO, DVec3::new(-14.0, 1.9, 0.3)];
    for (place, velocity) in places.into_iter().zip([DVec3::ZERO, DVec3::X * 7.0]) {
        let plan = Trajectory::coasting(State::new(0.0, place, velocity)).unwrap();
        scene
            .insert(Body::new(plan).with_hitbox(shell(128)))
            .unwrap();
    }
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[level]).unwrap();
    // There were more than 8,192 when the search halved six seconds twice.
    monitor.set_max_spans(256);
    for now in [0.0, 0.5, 2.0] {
        assert!(!tick(&mut monitor, now).is_empty() || now > 0.0);
        is_as_screened(&monitor, level);
    }
}

/// A crowd in the slice after the lookahead is compared ahead of time. It is no reason to refuse a tick before that slice
/// is needed, when the lookahead reaches a third of itself farther.
#[test]
fn a_crowd_beyond_the_lookahead_is_not_refused_yet() {
    let mut scene = Scene::new();
    for number in 0..40 {
        let (sin, cos) = (0.15 * f64::from(number)).sin_cos();
        let velocity = 100.0 * DVec3::new(cos, sin, 0.02 * f64::from(number));
        let plan = Trajectory::coasting(State::new(1.5, DVec3::ZERO, velocity)).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    let mut monitor = Monitor::new(scene, 0.0, 1.0, &[AlertLevel::at(0.5)]).unwrap();
    monitor.set_max_spans(300);
    for frame in 0..20 {
        tick(&mut monitor, f64::from(frame) / 60.0);
    }
    let refused = monitor.advance(20.0 / 60.0, &mut Vec::new());
    assert_eq!(exceeded(refused), Some(300));
}

/// Two clusters of many spheres take little room while their contact lies ahead, and more once the clock cuts it.
#[test]
fn a_contact_that_the_clock_cuts_needs_room() {
    let mut rng = rng(17);
    let mut scene = Scene::new();
    for side in [-1.0, 1.0] {
        let spheres = (0..40).map(|_| Sphere::new(vector(&mut rng, 1.5), 0.3));
        let plan = line(0.0, 30.0, 9.0 * side * DVec3::X, -side * DVec3::X);
        let hitbox = Hitbox::cluster(spheres.collect()).unwrap();
        scene.insert(Body::new(plan).with_hitbox(hitbox)).unwrap();
    }
    let ahead = (1..).find_map(|limit| {
        let mut monitor = Monitor::new(scene.clone(), 0.0, 20.0, &[LEVEL]).unwrap();
        monitor.set_max_spans(limit);
        let done = monitor.advance(0.0, &mut Vec::new());
        done.is_ok().then_some(monitor)
    });
    let mut monitor = ahead.unwrap();
    let before: Vec<_> = monitor.encounters().copied().collect();
    for _ in 0..2 {
        let refused = monitor.advance(9.0, &mut Vec::new());
        assert!(matches!(refused, Err(Error::TooCrowded { .. })));
        assert_eq!(monitor.now(), 0.0);
        assert!(monitor.encounters().eq(before.iter()));
    }
    monitor.set_max_spans(Monitor::MAX_SPANS);
    assert_eq!(tick(&mut monitor, 9.0).len(), 1);
    is_as_screened(&monitor, LEVEL);
}
