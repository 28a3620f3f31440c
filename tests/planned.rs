//! Queries without a window look at the time that plans cover.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "ends of windows are exact; a scene that cannot be built fails the test"
)]

mod support;

use nearmiss::glam::DVec3;
use nearmiss::{Accuracy, Body, Error, Hitbox, Outside, Query, Scene, State, Trajectory, Window};

/// The README's example, with a wall at rest where its bodies meet.
#[test]
fn a_wall_at_rest_among_plans() {
    let mut scene = Scene::new();
    for (from, to) in [
        (DVec3::ZERO, 100.0 * DVec3::X),
        (100.0 * DVec3::X, DVec3::Y),
    ] {
        let plan = support::line(0.0, 10.0, from, (to - from) / 10.0);
        let body = Body::new(plan).with_hitbox(Hitbox::sphere(0.5).unwrap());
        scene.insert(body).unwrap();
    }
    let query = Query::default().with_margin(2.0);
    assert_eq!(scene.screen(&query).unwrap().conflicts.len(), 1);
    let wall = Trajectory::at_rest(50.0 * DVec3::X).unwrap();
    let wall = scene.insert(Body::new(wall)).unwrap();
    let screening = scene.screen(&query).unwrap();
    assert_eq!(screening.window, Window::new(0.0, 10.0).unwrap());
    assert_eq!(screening.conflicts.len(), 3);
    // One coasts past, far from when plans are known: that does not widen the window.
    let passing = State::new(-50.0, DVec3::new(50.0, 0.0, -55.0), DVec3::Z);
    let passing = Trajectory::coasting(passing).unwrap();
    scene.insert(Body::new(passing)).unwrap();
    let screening = scene.screen(&query).unwrap();
    assert_eq!(screening.window, Window::new(0.0, 10.0).unwrap());
    let with_wall = |conflict: &&nearmiss::Conflict| conflict.a == wall;
    let met: Vec<_> = screening.conflicts.iter().filter(with_wall).collect();
    assert_eq!(met.len(), 1);
    assert!((met[0].enter - 3.0).abs() < 1e-9 && (met[0].exit - 7.0).abs() < 1e-9);
    // All of time by name stays what it was.
    let all = Query::new(Window::ALL).with_margin(2.0);
    assert_eq!(
        scene.screen(&all).unwrap_err(),
        Error::WindowNotClosed {
            body: 0,
            id: Some(wall)
        }
    );
}

#[test]
fn no_plan_no_window() {
    let mut scene = Scene::new();
    // Of an empty scene there is nothing to tell, at any time.
    let empty = scene.screen(&Query::default()).unwrap();
    assert!(empty.conflicts.is_empty() && empty.window == Window::ALL);
    let rest = Trajectory::at_rest(DVec3::ZERO).unwrap();
    scene.insert(Body::new(rest)).unwrap();
    let state = State::new(7.0, DVec3::X, DVec3::ZERO);
    let coasting = Trajectory::coasting(state).unwrap();
    scene.insert(Body::new(coasting)).unwrap();
    assert_eq!(scene.planned(), None);
    let refused = scene.screen(&Query::default().with_margin(2.0));
    let refused = refused.unwrap_err();
    assert_eq!(refused, Error::NoPlan);
    assert!(refused.to_string().contains("name a window"));
    let window = Window::new(0.0, 1.0).unwrap();
    let query = Query::new(window).with_margin(2.0);
    let screening = scene.screen(&query).unwrap();
    assert_eq!((screening.window, screening.conflicts.len()), (window, 1));
    // Nobody in the window, and fewer than two bodies: the window is the one asked for.
    let nobody = Scene::new().screen(&Query::new(Window::ALL)).unwrap();
    assert_eq!(nobody.window, Window::ALL);
}

/// Where no body exists beyond its knots, the time that plans cover is all of time: the same bits, clips
/// and certificates too.
#[test]
fn of_bodies_that_end_it_is_all_of_time() {
    let (mut found, mut cut) = (0, 0);
    for seed in 0..12 {
        // They begin and end at many different times.
        let scene = support::scene_of(&support::swarm(seed, 24, 20.0));
        let planned = scene.planned().unwrap();
        for (accuracy, margin) in [Accuracy::Exact, Accuracy::Certified]
            .into_iter()
            .flat_map(|accuracy| [0.5, 4.0].map(|margin| (accuracy, margin)))
        {
            let [silent, all] = [Query::default(), Query::new(Window::ALL)].map(|query| {
                let query = query.with_margin(margin).with_accuracy(accuracy);
                scene.screen(&query).unwrap()
            });
            assert_eq!((silent.window, all.window), (planned, Window::ALL));
            assert_eq!(silent.conflicts, all.conflicts);
            assert_eq!(
                support::bits(&silent.conflicts),
                support::bits(&all.conflicts)
            );
            found += silent.conflicts.len();
            let is_cut = |clip: nearmiss::Clip| clip.at_enter || clip.at_exit;
            let cut_off = silent.conflicts.iter().filter(|one| is_cut(one.clip));
            cut += cut_off.count();
        }
    }
    assert!(found > 500 && cut > 50, "{found} {cut}");
}

/// What bodies do beyond their plans is seen as far as any plan goes, and no farther.
#[test]
fn the_hull_of_all_plans() {
    let mut scene = Scene::new();
    let coast = |start, end, place: DVec3| {
        support::line(start, end, place, DVec3::ZERO).with_outside(Outside::Coast)
    };
    scene
        .insert(Body::new(coast(0.0, 1.0, DVec3::ZERO)))
        .unwrap();
    scene.insert(Body::new(coast(5.0, 8.0, DVec3::X))).unwrap();
    let screening = scene.screen(&Query::default().with_margin(2.0)).unwrap();
    assert_eq!(screening.window, Window::new(0.0, 8.0).unwrap());
    let conflict = screening.conflicts[0];
    assert_eq!(
        (conflict.enter, conflict.exit, conflict.clip.bits()),
        (0.0, 8.0, 3)
    );
}
