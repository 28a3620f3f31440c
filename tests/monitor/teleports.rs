//! Bodies that are told another place, far away.

use super::is_as_screened;
use super::support::{bits, rng, vector};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Hitbox, Monitor, Query, Scene, State, Trajectory, Window,
};
use rand::RngExt;

const LEVEL: AlertLevel = AlertLevel::at(1.5);

/// A stream of shots 600 m long, whose boxes overlap: each that has come to its end is told to begin again. They are
/// compared at their old places and at their new ones, but not with all that is in between.
#[test]
fn shots_that_begin_again_are_compared_at_both_places_alone() {
    const SHOTS: u32 = 800;
    const LENGTH: f64 = 600.0;
    const STEP: f64 = 1.0 / 60.0;
    let rng = &mut rng(911);
    let mut scene = Scene::new();
    let mut shots: Vec<(BodyId, DVec3, DVec3)> = (0..SHOTS)
        .map(|number| {
            let along = LENGTH * f64::from(number) / f64::from(SHOTS);
            let place = along * DVec3::X + vector(rng, 45.0) * DVec3::new(0.0, 1.0, 1.0);
            let velocity = 300.0 * DVec3::X + vector(rng, 3.0);
            let plan = Trajectory::coasting(State::new(0.0, place, velocity)).unwrap();
            let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.1).unwrap());
            (scene.insert(body).unwrap(), place, velocity)
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap();
    let (mut events, mut spans, mut teleports) = (Vec::new(), 0, 0_u64);
    for frame in 0..40 {
        let now = STEP * f64::from(frame);
        let told = shots
            .iter()
            .map(|&(id, place, velocity)| (id, State::new(now, place, velocity)));
        monitor.track(now, told).unwrap();
        monitor.advance(now, &mut events).unwrap();
        is_as_screened(&monitor, LEVEL);
        if frame > 2 {
            spans += monitor.stats().spans;
        }
        for (_, place, velocity) in &mut shots {
            *place += STEP * *velocity;
            if place.x > LENGTH {
                teleports += u64::from(frame > 2);
                place.x -= LENGTH * rng.random_range(0.9..1.0);
            }
        }
    }
    assert!(
        teleports > 200 && events.len() > 2,
        "{teleports} {}",
        events.len()
    );
    assert!(spans < 40 * teleports, "{spans} of {teleports}");
}

/// A crowd that is told another place all at once, and pairs far away: there is room for all of their spans, or an error.
/// Those of the crowd are found at both places; a limit that counted them twice would end the search before the last pairs.
#[test]
fn a_crowd_that_teleports_hides_no_other_pair() {
    const CROWD: u32 = 40;
    const BODIES: u32 = 340;
    let rng = &mut rng(912);
    let mut scene = Scene::new();
    let mut states: Vec<(BodyId, DVec3)> = (0..BODIES)
        .map(|number| {
            let place = if number < CROWD {
                vector(rng, 0.2)
            } else {
                let (row, column) = (f64::from(number / 2), f64::from(number % 2));
                // Last along each axis: they are searched last.
                DVec3::splat(2_000.0 + 10.0 * row) + 0.3 * column * DVec3::X
            };
            let plan = Trajectory::coasting(State::new(0.0, place, 0.1 * DVec3::X)).unwrap();
            let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.1).unwrap());
            (scene.insert(body).unwrap(), place)
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap();
    let mut events = Vec::new();
    for frame in 1..4 {
        let now = f64::from(frame) / 60.0;
        if frame == 3 {
            let crowd = states.iter_mut().take(CROWD as usize);
            crowd.for_each(|(_, place)| place.x += 1_000.0);
        }
        let velocity = DVec3::new(0.1, 0.01 * f64::from(frame), 0.0);
        let told = states
            .iter()
            .map(|&(id, place)| (id, State::new(now, place, velocity)));
        monitor.track(now, told).unwrap();
        monitor.advance(now, &mut events).unwrap();
        is_as_screened(&monitor, LEVEL);
    }
    let window = Window::new(2.0 / 60.0, 1.0).unwrap();
    let screened = |room: usize| {
        let query = Query::new(window).with_margin(LEVEL.margin);
        let query = query.with_max_spans(room);
        monitor
            .scene()
            .screen(&query)
            .map(|found| bits(&found.conflicts))
    };
    let all = screened(1_000_000).unwrap();
    let answers: Vec<bool> = (100..6_000)
        .step_by(50)
        .map(|room| screened(room).map(|found| assert_eq!(found, all, "{room}")))
        .map(|answer| answer.is_ok())
        .collect();
    let complete = answers.iter().filter(|&&answer| answer).count();
    assert!((10..answers.len() - 10).contains(&complete), "{complete}");
}

/// A few bodies that are told another place among many that nobody tells: the same ones in each frame (so that they teleport
/// several times in a slice), or others. Each is compared with the bodies about its places, not with all between them.
#[test]
fn few_that_teleport_among_many_are_compared_at_their_places_alone() {
    const BODIES: usize = 3_000;
    const HALF: f64 = 75.0;
    const TOLD: usize = 20;
    const FRAMES: usize = 40;
    for is_same in [true, false] {
        let rng = &mut rng(913);
        let mut scene = Scene::new();
        let ids: Vec<BodyId> = (0..BODIES)
            .map(|_| {
                let state = State::new(0.0, vector(rng, HALF), vector(rng, 5.0));
                let body = Body::new(Trajectory::coasting(state).unwrap());
                let body = body.with_hitbox(Hitbox::sphere(0.5).unwrap());
                scene.insert(body).unwrap()
            })
            .collect();
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap();
        let mut events = Vec::new();
        monitor.advance(0.0, &mut events).unwrap();
        let mut spans = 0;
        for frame in 1..=FRAMES {
            let now = frame as f64 / 60.0;
            let first = if is_same { 0 } else { frame * TOLD };
            let told = ids.iter().cycle().skip(first).take(TOLD);
            let told = told.map(|&id| (id, State::new(now, vector(rng, HALF), vector(rng, 5.0))));
            monitor.track(now, told.collect::<Vec<_>>()).unwrap();
            monitor.advance(now, &mut events).unwrap();
            spans += monitor.stats().spans;
            if frame % 4 == 0 {
                is_as_screened(&monitor, LEVEL);
            }
        }
        let teleports = (FRAMES * TOLD) as u64;
        assert!(events.len() > 200, "{}", events.len());
        assert!(spans < 25 * teleports, "{spans} of {teleports}");
    }
}

/// A round that begins again: all bodies are told another place in one frame. None is compared with all that is between its
/// places, in that tick and in the next one.
#[test]
fn all_that_teleport_at_once_are_compared_at_their_places_alone() {
    const BODIES: u64 = 3_000;
    const HALF: f64 = 120.0;
    let rng = &mut rng(914);
    let mut scene = Scene::new();
    let mut states: Vec<(BodyId, DVec3, DVec3)> = (0..BODIES)
        .map(|_| {
            let (place, velocity) = (vector(rng, HALF), vector(rng, 5.0));
            let plan = Trajectory::coasting(State::new(0.0, place, velocity)).unwrap();
            let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap());
            (scene.insert(body).unwrap(), place, velocity)
        })
        .collect();
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[LEVEL]).unwrap();
    let (mut events, mut spans) = (Vec::new(), Vec::new());
    for frame in 1..12 {
        let now = f64::from(frame) / 60.0;
        for (_, place, velocity) in &mut states {
            *place += *velocity / 60.0;
            if frame == 8 {
                *place = vector(rng, HALF);
            }
        }
        let told = states
            .iter()
            .map(|&(id, place, velocity)| (id, State::new(now, place, velocity)));
        monitor.track(now, told).unwrap();
        monitor.advance(now, &mut events).unwrap();
        is_as_screened(&monitor, LEVEL);
        spans.push(monitor.stats().spans);
    }
    assert!(events.len() > 100, "{}", events.len());
    assert!(spans[4..].iter().all(|&few| few < 4 * BODIES), "{spans:?}");
}
