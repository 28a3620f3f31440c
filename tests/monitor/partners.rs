//! Bodies that get partners and lose them: by radii, where the margin is negative, and by layers.

use super::support::{bits, rng, vector};
use glam::DVec3;
use nearmiss::{
    AlertLevel, Body, BodyId, Command, Hitbox, Layers, Monitor, Query, Scene, State, Trajectory,
    Window,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;

fn ball(rng: &mut ChaCha8Rng, now: f64, radius: f64) -> Body {
    let state = State::new(now, vector(rng, 1.0), vector(rng, 0.3));
    Body::new(Trajectory::coasting(state).unwrap()).with_hitbox(Hitbox::sphere(radius).unwrap())
}

/// Ticks, and returns the number of conflicts: they are those of a screening of the same bodies in another scene.
fn checked_tick(monitor: &mut Monitor, now: f64, margin: f64) -> usize {
    monitor.advance(now, &mut Vec::new()).unwrap();
    let query = Query::new(Window::new(now, monitor.complete_until()).unwrap());
    let screened = monitor.scene().screen(&query.with_margin(margin)).unwrap();
    assert_eq!(monitor.conflicts(0).unwrap(), screened.conflicts, "{now}");
    // Radii decide nothing there: it has a body that is within reach of all others.
    let mut all = monitor.scene().clone();
    let huge = Body::new(Trajectory::at_rest(1e4 * DVec3::X).unwrap());
    let huge = huge.with_hitbox(Hitbox::sphere(100.0).unwrap());
    all.insert(huge.with_layers(Layers::ALL)).unwrap();
    let all = all.screen(&query.with_margin(margin)).unwrap();
    assert_eq!(bits(&all.conflicts), bits(&screened.conflicts), "{now}");
    screened.conflicts.len()
}

/// Small bodies can be in no pair until a body is large enough: bodies are inserted in the order of their radii, one by
/// one and several together.
#[test]
fn a_large_body_gives_small_ones_a_partner() {
    const MARGIN: f64 = -0.5;
    let mut rng = rng(32);
    let mut monitor = Monitor::new(Scene::new(), 0.0, 2.0, &[AlertLevel::at(MARGIN)]).unwrap();
    for _ in 0..30 {
        let radius = rng.random_range(0.1..0.12);
        monitor.insert(ball(&mut rng, 0.0, radius)).unwrap();
    }
    let (mut now, mut of_small, mut alone) = (0.0, 0, 0);
    for number in 0..120 {
        let radius = 0.2 + 0.006 * f64::from(number);
        let count = if number % 7 == 0 { 4 } else { 1 };
        let more: Vec<Body> = (0..count)
            .map(|more| ball(&mut rng, now, radius + 1e-5 * f64::from(more)))
            .collect();
        let ids = monitor
            .apply(more.into_iter().map(Command::Insert))
            .unwrap();
        if number % 3 > 0 {
            continue;
        }
        now += 0.05;
        let found = checked_tick(&mut monitor, now, MARGIN);
        alone += usize::from(found == 0);
        let radius_of = |id| monitor.scene().body(id).unwrap().hitbox.spheres()[0].radius;
        let conflicts = monitor.conflicts(0).unwrap().iter();
        of_small += conflicts
            .filter(|one| radius_of(one.a).min(radius_of(one.b)) < 0.12)
            .count();
        if number % 2 > 0 {
            monitor.remove(ids[0]).unwrap();
        }
    }
    assert!(of_small > 30 && alone >= 2, "{of_small} {alone}");
}

/// Kinds of one body come and go, beside one of many bodies.
#[test]
fn kinds_of_one_body_come_and_go() {
    const MARGIN: f64 = 0.1;
    let mut rng = rng(33);
    for many in [Layers::new(1, 3), Layers::new(1, 2)] {
        let mut scene = Scene::new();
        for _ in 0..40 {
            let body = ball(&mut rng, 0.0, 0.2);
            scene.insert(body.with_layers(many)).unwrap();
        }
        let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(MARGIN)]).unwrap();
        let mut others: Vec<BodyId> = Vec::new();
        let mut found = 0;
        for number in 0..100 {
            let now = 0.05 * f64::from(number);
            for _ in 0..rng.random_range(0..3) {
                let layers = [
                    Layers::new(2, 1),
                    Layers::new(4, 4),
                    Layers::new(2, 2),
                    many,
                ];
                let layers = layers[rng.random_range(0..4)];
                match rng.random_range(0..3) {
                    0 => {
                        let body = ball(&mut rng, now, 0.2).with_layers(layers);
                        others.push(monitor.insert(body).unwrap());
                    }
                    1 if !others.is_empty() => {
                        let gone = others.swap_remove(rng.random_range(0..others.len()));
                        monitor.remove(gone).unwrap();
                    }
                    _ => {
                        if let Some(&id) = others.last() {
                            monitor.set_layers(id, layers).unwrap();
                        }
                    }
                }
            }
            found += checked_tick(&mut monitor, now, MARGIN);
        }
        assert!(found > 100, "{found}");
    }
}

/// Shots come and go among scenery that meets nothing else: only the first one costs boxes of all of it.
#[test]
fn boxes_are_kept_while_no_partner_is_there() {
    let at_rest = |x: f64, layers| {
        let plan = Trajectory::at_rest(x * DVec3::X).unwrap();
        Body::new(plan).with_layers(layers)
    };
    let mut scene = Scene::new();
    for number in 0..1_000 {
        scene
            .insert(at_rest(f64::from(number), Layers::new(1, 2)))
            .unwrap();
    }
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(0.25)]).unwrap();
    let mut counts = Vec::new();
    for shot in 0..4_u32 {
        let now = f64::from(shot) / 30.0;
        let place = 50.2 + 300.0 * now;
        let id = monitor.insert(at_rest(place, Layers::new(2, 1))).unwrap();
        monitor.advance(now, &mut Vec::new()).unwrap();
        assert_eq!(monitor.conflicts(0).unwrap().len(), 1);
        counts.push(monitor.stats().boxes);
        monitor.remove(id).unwrap();
        monitor.advance(now + 0.01, &mut Vec::new()).unwrap();
    }
    let are_few = counts[1..].iter().all(|&count| count < 100);
    assert!(counts[0] >= 1_000 && are_few, "{counts:?}");
}

/// Scenery is compared with nothing: no tick forms a box of it, neither the first one nor those in which the lookahead
/// reaches another slice.
#[test]
fn bodies_without_a_partner_have_no_boxes() {
    let mut scene = Scene::new();
    for x in 0..200 {
        let plan = Trajectory::coasting(State::new(0.0, f64::from(x) * DVec3::X, DVec3::Y));
        let wall = Body::new(plan.unwrap()).with_layers(Layers::new(1, 2));
        scene.insert(wall).unwrap();
    }
    let mut monitor = Monitor::new(scene, 0.0, 2.0, &[AlertLevel::at(2.0)]).unwrap();
    for frame in 0..60 {
        let now = f64::from(frame) / 15.0;
        monitor.advance(now, &mut Vec::new()).unwrap();
        assert_eq!(monitor.stats().boxes, 0, "{frame}");
    }
}

/// A motion that is replaced where it is may come with layers: they count, and so do the partners that they give.
#[test]
fn layers_that_come_with_a_motion_give_partners() {
    let coasting = |now: f64, x: f64, velocity: DVec3| {
        Trajectory::coasting(State::new(now, x * DVec3::X, velocity)).unwrap()
    };
    let mut scene = Scene::new();
    let ids = [0.0, 9.0].map(|x| {
        let body = Body::new(coasting(0.0, x, DVec3::ZERO));
        scene.insert(body.with_layers(Layers::new(1, 2))).unwrap()
    });
    let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(2.0)]).unwrap();
    for now in [1.0, 1.1, 1.2] {
        let told = coasting(now, 0.0, now * 0.01 * DVec3::Y);
        monitor.replan(ids[0], now, told).unwrap();
        assert_eq!(checked_tick(&mut monitor, now, 2.0), 0);
    }
    let told = coasting(1.3, 0.0, DVec3::X);
    let commands = [
        Command::SetLayers(ids[0], Layers::new(2, 1)),
        Command::Replan(ids[0], 1.3, told.into()),
    ];
    monitor.apply(commands).unwrap();
    assert_eq!(checked_tick(&mut monitor, 1.3, 2.0), 1);
}
