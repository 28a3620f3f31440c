//! `Accuracy::Fast` against `Exact`: nothing is missed, separations are good to 1e-5 of the local
//! scale, and what is too much is within that of the margin.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::DVec3;
use nearmiss::{
    Accuracy, Body, BodyId, Conflict, Hitbox, Query, Scene, Sphere, State, Trajectory, Window,
};
use rand::RngExt;
use support::{scene_of, swarm};

fn screen(scene: &Scene, window: Window, margin: f64, accuracy: Accuracy) -> Vec<Conflict> {
    let query = Query::new(window)
        .with_margin(margin)
        .unwrap()
        .with_accuracy(accuracy);
    scene.screen(&query).unwrap().conflicts
}

/// An upper bound of the local scale of a pair: over all of its segments, hitboxes included.
fn scale(scene: &Scene, a: BodyId, b: BodyId, margin: f64) -> f64 {
    let reach = |id: BodyId, from: DVec3| {
        let body = scene.body(id).unwrap();
        let bounding = body.hitbox.bounding();
        let segments = body.trajectory.segments().iter();
        let farthest = segments
            .map(|segment| segment.origin().distance(from) + segment.extent())
            .fold(0.0, f64::max);
        farthest + bounding.offset.length() + bounding.radius
    };
    let middle = scene.body(a).unwrap().trajectory.segments()[0].origin();
    reach(a, middle) + reach(b, middle) + margin.abs()
}

/// The least separation of the spheres of a pair at an instant, m.
fn separation(scene: &Scene, conflict: &Conflict, instant: f64) -> f64 {
    let [a, b] = [conflict.a, conflict.b].map(|id| {
        let body = scene.body(id).unwrap();
        (
            body.trajectory.position(instant).unwrap(),
            body.hitbox.spheres(),
        )
    });
    let distances = a.1.iter().flat_map(|one| {
        b.1.iter().map(|other| {
            let apart = (a.0 + one.offset).distance(b.0 + other.offset);
            apart - one.radius - other.radius
        })
    });
    distances.fold(f64::INFINITY, f64::min)
}

/// Returns how many of the exact conflicts were found, and how many were reported.
fn compare(scene: &Scene, window: Window, margin: f64) -> (usize, usize) {
    let exact = screen(scene, window, margin, Accuracy::Exact);
    let fast = screen(scene, window, margin, Accuracy::Fast);
    let is_same = |x: &Conflict, y: &Conflict| (x.a, x.b) == (y.a, y.b);
    for conflict in &exact {
        let covers = |found: &&Conflict| is_same(conflict, found) && found.enter <= conflict.enter;
        let found = fast
            .iter()
            .filter(covers)
            .find(|found| found.exit >= conflict.exit);
        let found = found.unwrap_or_else(|| panic!("missed: {conflict:?}"));
        let off = found.closest.separation - conflict.closest.separation;
        let allowed = 1e-5 * scale(scene, conflict.a, conflict.b, margin);
        // One that joins several has the least of all.
        assert!(off <= allowed, "{off:e} {allowed:e} {conflict:?}");
    }
    for conflict in &fast {
        assert!(conflict.enter <= conflict.closest.time && conflict.closest.time <= conflict.exit);
        let part = Window::new(conflict.enter, conflict.exit).unwrap();
        let least = scene.closest_approach(conflict.a, conflict.b, part);
        let least = least.unwrap().unwrap().separation;
        let allowed = 1e-5 * scale(scene, conflict.a, conflict.b, margin);
        assert!(
            (least - conflict.closest.separation).abs() <= allowed,
            "{conflict:?}"
        );
        assert!(least <= margin + allowed, "{conflict:?}");
        // The exact solver finds contact in it.
        let holds = |found: &&Conflict| {
            is_same(conflict, found) && found.enter >= conflict.enter && found.exit <= conflict.exit
        };
        assert!(exact.iter().any(|found| holds(&found)), "{conflict:?}");
        // It begins and ends where the bodies come near, but for a little of a span.
        for instant in [conflict.enter, conflict.exit] {
            let least = separation(scene, conflict, instant);
            assert!(least <= margin + 10.0 * allowed, "{instant} {conflict:?}");
        }
    }
    (exact.len(), fast.len())
}

#[test]
fn a_swarm() {
    let scene = scene_of(&swarm(31, 200, 60.0));
    for window in [Window::ALL, Window::new(7.3, 19.0).unwrap()] {
        let (exact, fast) = compare(&scene, window, 1.0);
        // Few margins are hit to 1e-5: nearly nothing is joined or too much.
        assert!(exact > 100 && fast.abs_diff(exact) <= 2, "{exact} {fast}");
    }
}

/// In other units and elsewhere: what f32 loses is relative to the pair, not to the world.
#[test]
fn any_unit_and_any_place() {
    for (unit, shift) in [
        (1e-150, 0.0),
        (1e-30, 1e-24),
        (1.0, 1e9),
        (1e40, 0.0),
        (1e140, 1e144),
    ] {
        let bodies = swarm(5, 60, 40.0).into_iter().map(|(states, radius)| {
            let states = states.iter().map(|state| {
                let position = state.position * unit + DVec3::splat(shift);
                State::new(state.time, position, state.velocity * unit)
            });
            (states.collect(), radius * unit)
        });
        let (exact, fast) = compare(&scene_of(&bodies.collect::<Vec<_>>()), Window::ALL, unit);
        assert!(
            exact > 10 && fast.abs_diff(exact) <= 1,
            "{unit:e}: {exact} {fast}"
        );
    }
}

/// Clusters whose bodies rest, touch, overlap and fly in formation.
#[test]
fn clusters_and_constant_distances() {
    let sphere = |x: f64| Sphere {
        offset: DVec3::new(x, 0.0, 0.0),
        radius: 0.5,
    };
    let cluster = Hitbox::cluster([-2.0, 0.0, 3.0].map(sphere).to_vec()).unwrap();
    let mut scene = Scene::new();
    for (y, speed) in [
        (0.0, 1.0),
        (2.0, 1.0),
        (1.0, -3.0),
        (-1.0, 0.0),
        (-1.5, 0.0),
    ] {
        let velocity = DVec3::X * speed;
        let states = [0.0, 4.0, 9.0]
            .map(|t| State::new(t, DVec3::new(-5.0, y, 0.0) + velocity * t, velocity));
        let body = Body::new(Trajectory::from_states(&states).unwrap());
        scene.insert(body.with_hitbox(cluster.clone())).unwrap();
    }
    let exact = [-0.4, 0.0, 0.5, 1.0].map(|margin| compare(&scene, Window::ALL, margin).0);
    // Wider margins join what narrower ones part.
    assert!(exact.iter().all(|&count| count > 0), "{exact:?}");
}

/// On one line at one velocity, with other knots: what is left of the relative motion is rounding, of
/// f64 already.
#[test]
fn formations() {
    let mut rng = support::rng(12);
    let mut found = 0;
    for round in 0..300 {
        let (speed, duration) = [(3.0, 12.0), (7e3, 600.0), (1e-3, 1e5)][round % 3];
        let velocity = support::vector(&mut rng, speed);
        let mut flight = || {
            let knot = duration * rng.random_range(0.1..0.9);
            let times = [0.0, knot, duration];
            let states = times.map(|time| State::new(time, time * velocity, velocity));
            (states.to_vec(), 0.0)
        };
        let scene = scene_of(&[flight(), flight()]);
        let window = [(0.0, 1.0), (0.3, 0.6), (0.5, 0.5)][round % 7 % 3];
        let window = Window::new(window.0 * duration, window.1 * duration).unwrap();
        for margin in [0.0, 1e-12, 1e-9] {
            found += compare(&scene, window, margin).0;
        }
    }
    assert!(found >= 900, "{found}");
}

/// Margins that are missed or met by less than f32 can tell: the same pairs as the exact solver's, also
/// where the window cuts a span.
/// Fast passes at small margins: a conflict is no longer than it may be by what f32 loses.
#[test]
fn passes_begin_and_end_in_time() {
    let mut rng = support::rng(6);
    for _ in 0..2_000 {
        let speed = 10_f64.powf(rng.random_range(-3.0..5.0));
        let half = rng.random_range(0.5..2.0);
        let radius = speed * 10_f64.powf(rng.random_range(-5.0..-1.0));
        let way = DVec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0))).normalize();
        let aside = way.any_orthonormal_vector() * radius * rng.random_range(0.0..1.9);
        let velocity = speed * way;
        let plan = |place: DVec3, velocity: DVec3| {
            let states = [-half, half].map(|t| State::new(t, place + velocity * t, velocity));
            Body::new(Trajectory::from_states(&states).unwrap())
                .with_hitbox(Hitbox::sphere(radius).unwrap())
        };
        let mut scene = Scene::new();
        let a = scene.insert(plan(DVec3::ZERO, DVec3::ZERO)).unwrap();
        let b = scene.insert(plan(aside, velocity)).unwrap();
        let [exact, fast] = [Accuracy::Exact, Accuracy::Fast].map(|accuracy| {
            let found = screen(&scene, Window::ALL, 0.0, accuracy);
            assert_eq!(found.len(), 1);
            found[0]
        });
        let near = 1e-5 * scale(&scene, a, b, 0.0) + 2.0 * half * speed / 65_536.0;
        for (exact, fast) in [(exact.enter, fast.enter), (-exact.exit, -fast.exit)] {
            assert!(fast <= exact, "{exact} {fast}");
        }
        for instant in [fast.enter, fast.exit] {
            let least = separation(&scene, &fast, instant);
            assert!(least <= near, "{least} {near}");
        }
    }
}

#[test]
fn grazes() {
    let mut rng = support::rng(13);
    let (mut met, mut missed) = (0, 0);
    for round in 0..400 {
        let bodies = swarm(1000 + round, 2, 10.0);
        let scene = scene_of(&bodies);
        let ids: Vec<BodyId> = scene.bodies().map(|(id, _)| id).collect();
        let window = [Window::ALL, Window::new(7.3, 19.0).unwrap()][usize::from(round % 2 == 1)];
        let nearest = scene.closest_approach(ids[0], ids[1], window);
        let Some(nearest) = nearest.unwrap() else {
            continue;
        };
        let off = 10f64.powf(rng.random_range(-10.0..-5.0));
        for sign in [-1.0, 1.0] {
            let margin = nearest.separation + sign * off * nearest.separation.abs();
            let (exact, fast) = compare(&scene, window, margin);
            assert_eq!(exact > 0, fast > 0, "{margin}");
            met += exact.min(1);
            missed += usize::from(exact == 0);
        }
    }
    assert!(met > 300 && missed > 300, "{met} {missed}");
}

/// A window of the very instant at which a conflict begins or ends: where instants are coarse, the bodies go
/// farther between two of them than f32 can tell.
#[test]
fn windows_of_one_instant() {
    const START: f64 = 1.7e9;
    let mut found = 0;
    for step in 0..400 {
        let fast = if step % 2 == 0 { 1.0 } else { 2_000.0 };
        let (speed, margin) = (fast * (0.5 + 0.01 * f64::from(step)), 0.001 * fast);
        let comes = [-1.0, 1.0].map(|side| {
            let velocity = DVec3::X * speed;
            State::new(START + 1.0 + side, side * velocity, velocity)
        });
        let rests = [0.0, 2.0].map(|time| State::new(START + time, DVec3::ZERO, DVec3::ZERO));
        let scene = scene_of(&[(comes.to_vec(), 0.0), (rests.to_vec(), 0.0)]);
        let whole = screen(&scene, Window::ALL, margin, Accuracy::Exact);
        for instant in [whole[0].enter, whole[0].exit] {
            let window = Window::new(instant, instant).unwrap();
            let [exact, fast] = [Accuracy::Exact, Accuracy::Fast]
                .map(|accuracy| screen(&scene, window, margin, accuracy).len());
            assert_eq!(exact, fast, "{speed} {instant}");
            found += exact;
        }
    }
    assert!(found > 700, "{found}");
}
