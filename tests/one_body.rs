//! Questions about one body or two, against screenings of a scene that has them.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

mod support;

use glam::{DQuat, DVec3};
use nearmiss::{
    Accuracy, AlertLevel, Body, BodyId, BodyPlan, Conflict, ConflictIndex, Error, Hitbox, Layers,
    Monitor, Orientation, Outside, Query, Scene, Sphere, State, TimeBase, Trajectory, Window, pair,
};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use support::{bits, on_threads, rng, scene_of, swarm, vector, wander};

/// Bodies of all kinds in a cube of 12 m.
fn body(rng: &mut ChaCha8Rng) -> Body {
    let start = rng.random_range(-3.0..6.0);
    let trajectory = match rng.random_range(0..6) {
        0 => Trajectory::at_rest(vector(rng, 6.0)).unwrap(),
        1 => {
            let state = State::new(start, vector(rng, 6.0), vector(rng, 3.0));
            Trajectory::coasting(state).unwrap()
        }
        kind => {
            let states = wander(rng, start, 8, 1.2, 12.0, 4.0);
            let plan = Trajectory::from_states(&states).unwrap();
            plan.with_outside(match kind {
                2 => Outside::Coast,
                3 => Outside::Extrapolate,
                _ => Outside::Absent,
            })
        }
    };
    let hitbox = if rng.random_bool(0.3) {
        let spheres = (0..3).map(|_| Sphere {
            offset: vector(rng, 1.0),
            radius: rng.random_range(0.0..0.5),
        });
        Hitbox::cluster(spheres.collect()).unwrap()
    } else {
        Hitbox::sphere(rng.random_range(0.0..1.0)).unwrap()
    };
    let mut body = Body::new(trajectory)
        .with_hitbox(hitbox)
        .with_tag(rng.random());
    if rng.random_bool(0.3) {
        let turn = DQuat::from_scaled_axis(vector(rng, 2.0));
        let spin = Orientation::spin(0.0, turn, vector(rng, 1.0)).unwrap();
        body = body.with_orientation(spin);
    }
    if rng.random_bool(0.3) {
        body = body.with_layers(Layers::new(0b10, 0b01));
    }
    if rng.random_bool(0.2) {
        body = body.with_model_error(rng.random_range(0.0..0.5)).unwrap();
    }
    body
}

fn queries(rng: &mut ChaCha8Rng) -> Vec<Query> {
    let from = rng.random_range(-2.0..4.0);
    let window = Window::new(from, from + rng.random_range(0.0..9.0)).unwrap();
    let mut all = Vec::new();
    for query in [Query::default(), Query::new(window)] {
        for margin in [-0.8, 0.0, 1.5] {
            for accuracy in [Accuracy::Exact, Accuracy::Certified] {
                all.push(query.with_margin(margin).with_accuracy(accuracy));
            }
        }
    }
    all
}

#[test]
fn one_body_has_the_conflicts_of_a_screening_with_it() {
    let mut found = [0; 2];
    for seed in 0..40 {
        let mut rng = rng(seed);
        let mut scene = Scene::new();
        let count = [0, 1, 20, 60][usize::try_from(seed % 4).unwrap()];
        let mut ids: Vec<_> = (0..count)
            .map(|_| scene.insert(body(&mut rng)).unwrap())
            .collect();
        // Its slot may be one that was left.
        for _ in 0..ids.len() / 10 {
            let id = ids.swap_remove(rng.random_range(0..ids.len()));
            scene.remove(id).unwrap();
        }
        let own = body(&mut rng);
        let mut with = scene.clone();
        let id = with.insert(own.clone()).unwrap();
        for query in queries(&mut rng) {
            let screened = with.screen(&query).map(|screening| {
                let all = screening.conflicts.into_iter();
                all.filter(|one| one.a == id || one.b == id)
                    .collect::<Vec<Conflict>>()
            });
            let threads = 1 + usize::try_from(seed % 3).unwrap();
            let asked = on_threads(threads, || scene.conflicts_with(&own, &query));
            match (screened, asked) {
                (Ok(screened), Ok(asked)) => {
                    assert_eq!(bits(&asked), bits(&screened), "{seed} {query:?}");
                    found[usize::from(query.accuracy() == Accuracy::Certified)] += asked.len();
                }
                (screened, asked) => {
                    assert_eq!(
                        asked.unwrap_err(),
                        screened.unwrap_err(),
                        "{seed} {query:?}"
                    );
                }
            }
        }
    }
    assert!(found.iter().all(|&found| found > 100), "{found:?}");
}

/// A body with another plan has the conflicts of a screening of the scene with that plan; some pairs are ignored.
#[test]
fn another_plan_has_the_conflicts_of_a_screening_with_it() {
    let mut found = [0; 2];
    for seed in 0..40 {
        let mut rng = rng(1_000 + seed);
        let mut scene = Scene::new();
        let bodies = [1, 2, 30, 60][usize::try_from(seed % 4).unwrap()];
        let ids = (0..bodies).map(|_| scene.insert(body(&mut rng)).unwrap());
        let ids: Vec<_> = ids.collect();
        let id = ids[rng.random_range(0..bodies)];
        for &other in ids.iter().filter(|&&other| other != id).take(5) {
            scene.ignore_pair(id, other).unwrap();
        }
        let other = body(&mut rng);
        let (mut with, mut plan) = (scene.clone(), BodyPlan::from(other.trajectory));
        with.set_trajectory(id, plan.trajectory.clone()).unwrap();
        if seed % 2 == 0 {
            plan.orientation = Some(other.orientation.clone());
            with.set_orientation(id, other.orientation).unwrap();
        }
        for query in queries(&mut rng) {
            let screened = with.screen(&query).map(|screening| {
                let all = screening.conflicts.into_iter();
                all.filter(|one| one.a == id || one.b == id)
                    .collect::<Vec<Conflict>>()
            });
            let asked = scene.what_if(id, &plan, &query);
            match (screened, asked) {
                (Ok(screened), Ok(asked)) => {
                    assert_eq!(bits(&asked), bits(&screened), "{seed} {query:?}");
                    found[usize::from(query.accuracy() == Accuracy::Certified)] += asked.len();
                }
                (screened, asked) => assert_eq!(asked.unwrap_err(), screened.unwrap_err()),
            }
        }
    }
    assert!(found.iter().all(|&found| found > 100), "{found:?}");
    let mut scene = Scene::new();
    let id = scene.insert(body(&mut rng(0))).unwrap();
    let plan = scene.remove(id).unwrap().trajectory;
    let gone = scene.what_if(id, &plan, &Query::default());
    assert_eq!(gone, Err(Error::UnknownBody { id }));
}

/// An index has what going through all conflicts finds, also for bodies that are not in the list.
#[test]
fn an_index_has_the_conflicts_of_each_body() {
    let mut scene = scene_of(&swarm(5, 300, 40.0));
    let gone = scene.insert(body(&mut rng(5))).unwrap();
    scene.remove(gone).unwrap();
    let screening = scene.screen(&Query::default().with_margin(3.0)).unwrap();
    let index = ConflictIndex::new(&screening.conflicts);
    let mut most = 0;
    for (id, _) in scene.bodies() {
        let own: Vec<Conflict> = index.of(id).copied().collect();
        let listed: Vec<Conflict> = screening.conflicts_of(id).copied().collect();
        assert_eq!(bits(&own), bits(&listed), "{id}");
        assert_eq!(index.of(id).len(), own.len());
        most = most.max(own.len());
    }
    assert!(most > 3, "{most}");
    assert_eq!(index.of(gone).len(), 0);
    assert_eq!(ConflictIndex::new(&[]).of(gone).len(), 0);
}

/// Many bodies, most of them far away.
#[test]
fn one_body_among_many() {
    let scene = scene_of(&swarm(3, 3_000, 200.0));
    let (states, radius) = swarm(8, 1, 200.0).remove(0);
    let own = Body::new(Trajectory::from_states(&states).unwrap())
        .with_hitbox(Hitbox::sphere(radius).unwrap());
    let mut with = scene.clone();
    let id = with.insert(own.clone()).unwrap();
    let query = Query::default().with_margin(6.0);
    let mut screened = with.screen(&query).unwrap().conflicts;
    screened.retain(|one| one.a == id || one.b == id);
    let asked = scene.conflicts_with(&own, &query).unwrap();
    assert!(asked.len() > 5, "{}", asked.len());
    assert_eq!(bits(&asked), bits(&screened));
}

#[test]
fn two_bodies_without_a_scene_are_as_in_one() {
    let (mut found, mut met) = (0, 0);
    for seed in 100..300 {
        let mut rng = rng(seed);
        let both = [body(&mut rng), body(&mut rng)].map(|body| body.with_layers(Layers::ALL));
        let mut scene = Scene::new();
        let [a, b] = both.clone().map(|body| scene.insert(body).unwrap());
        for query in queries(&mut rng) {
            let screened = scene.screen(&query).map(|screening| screening.conflicts);
            let asked = pair::conflicts(&both[0], &both[1], &query);
            match (screened, asked) {
                (Ok(screened), Ok(asked)) => {
                    assert_eq!(bits(&asked), bits(&screened), "{seed} {query:?}");
                    found += asked.len();
                }
                (screened, asked) => assert_eq!(asked.unwrap_err(), screened.unwrap_err()),
            }
            let Some(window) = query.window() else {
                continue;
            };
            let (own, other) = (&both[0], &both[1]);
            let nearest = scene.closest_approach(a, b, window).unwrap();
            assert_eq!(pair::closest_approach(own, other, window).unwrap(), nearest);
            let proven = scene.certified_closest_approach(a, b, window).unwrap();
            assert_eq!(
                pair::certified_closest_approach(own, other, window).unwrap(),
                proven
            );
            if let Some(nearest) = nearest {
                met += 1;
                let relative = nearest.position_a - nearest.position_b;
                assert_eq!(nearest.relative_position(), relative);
                let back = pair::closest_approach(other, own, window).unwrap().unwrap();
                assert!((back.separation - nearest.separation).abs() < 1e-9);
            }
        }
    }
    assert!(found > 100 && met > 100, "{found} {met}");
}

/// Returns what the question about the body finds: as many conflicts as a screening with it, and a monitor's.
fn asked_as_screened(others: &[Body], own: &Body, query: &Query) -> usize {
    let mut scene = Scene::new();
    for other in others {
        scene.insert(other.clone()).unwrap();
    }
    let mut with = scene.clone();
    let id = with.insert(own.clone()).unwrap();
    let mut screened = with.screen(query).unwrap().conflicts;
    screened.retain(|one| one.a == id || one.b == id);
    let asked = scene.conflicts_with(own, query).unwrap();
    assert_eq!(bits(&asked), bits(&screened), "{query:?}");
    if query.accuracy() == Accuracy::Exact {
        let window = query.window().unwrap();
        let levels = [AlertLevel::at(query.margin())];
        let lookahead = window.end() - window.start();
        let mut monitor = Monitor::new(scene, window.start(), lookahead, &levels).unwrap();
        monitor.advance(window.start(), &mut Vec::new()).unwrap();
        let asked = monitor.what_if_body(own, 0).unwrap();
        assert_eq!(bits(&asked), bits(&screened), "{query:?}");
    }
    screened.len()
}

/// The coefficients cancel: each point of the cubic is good to half a metre.
#[test]
fn errors_of_segments_count() {
    let time = f64::from(1 << 30);
    let (t, window) = (DVec3::X * time, Window::new(time, time + 1.0).unwrap());
    let cube = [DVec3::X, -3.0 * t, 3.0 * t * time, -t * time * time];
    let plan = Trajectory::from_coefficients(&[time, time + 1.0], &[cube], TimeBase::Absolute);
    let moving = Body::new(plan.unwrap());
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let query = Query::new(window).with_accuracy(accuracy);
        for (x, count) in [(1.01, 1), (1.1, 1), (1.3, 1), (1.45, 1), (2.0, 0)] {
            let rest = Body::new(Trajectory::at_rest(x * DVec3::X).unwrap());
            for (own, other) in [(&moving, &rest), (&rest, &moving)] {
                let found = asked_as_screened(std::slice::from_ref(other), own, &query);
                assert_eq!(found, count, "{x}");
            }
        }
    }
}

/// The margin cancels the radii: what is left of them is less than their rounding.
#[test]
fn radii_are_rounded() {
    let ball = |x: f64, radius: f64| {
        Body::new(Trajectory::at_rest(x * DVec3::X).unwrap())
            .with_hitbox(Hitbox::sphere(radius).unwrap())
    };
    let (large, half) = (2_f64.powi(34), 2_f64.powi(33));
    let window = Window::new(0.0, 1.0).unwrap();
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        let query = Query::new(window).with_accuracy(accuracy);
        let query = query.with_margin(-(large + half));
        for (gap, count) in [(1e-6, 1), (1.0, 0)] {
            let (one, other) = (ball(0.0, large), ball(gap, half + 2_f64.powi(-19)));
            for (own, other) in [(&one, &other), (&other, &one)] {
                let found = asked_as_screened(std::slice::from_ref(other), own, &query);
                assert_eq!(found, count, "{gap}");
            }
        }
    }
}

/// Two bodies of one tag; the one that cannot be followed is told by its id.
#[test]
fn the_body_that_cannot_be_followed_is_named() {
    let state = |t: f64| {
        State::new(
            t,
            t * t * t * 1e290 * DVec3::X,
            3.0 * t * t * 1e290 * DVec3::X,
        )
    };
    let far = Trajectory::from_states(&[state(0.0), state(1.0)]).unwrap();
    let far = far.with_outside(Outside::Extrapolate);
    let rest = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap()).with_tag(3);
    let mut scene = Scene::new();
    let fine = scene.insert(rest.clone()).unwrap();
    let window = Window::new(0.0, 1e5).unwrap();
    let mut monitor = Monitor::new(scene.clone(), 0.0, 1e5, &[AlertLevel::at(1.0)]).unwrap();
    let bad = scene.insert(Body::new(far.clone()).with_tag(3)).unwrap();
    let query = Query::new(window);
    let named = |error: Error, of: BodyId| {
        let id = match &error {
            Error::InBody { body: 3, id, .. } => *id,
            _ => None,
        };
        assert_eq!(id, Some(of), "{error}");
    };
    named(scene.screen(&query).unwrap_err(), bad);
    named(scene.conflicts_with(&rest, &query).unwrap_err(), bad);
    for (a, b) in [(fine, bad), (bad, fine)] {
        named(scene.closest_approach(a, b, window).unwrap_err(), bad);
        named(
            scene.certified_closest_approach(a, b, window).unwrap_err(),
            bad,
        );
    }
    let made = Monitor::new(scene, 0.0, 1e5, &[AlertLevel::at(1.0)]);
    named(made.unwrap_err(), bad);
    monitor.advance(0.0, &mut Vec::new()).unwrap();
    named(monitor.what_if(fine, &far, 0).unwrap_err(), fine);
    named(monitor.set_trajectory(fine, far.clone()).unwrap_err(), fine);
    // A body that is not there has no id.
    let new = Body::new(far).with_tag(3);
    for error in [
        monitor.what_if_body(&new, 0).unwrap_err(),
        monitor.scene().conflicts_with(&new, &query).unwrap_err(),
    ] {
        assert!(
            matches!(
                error,
                Error::InBody {
                    body: 3,
                    id: None,
                    ..
                }
            ),
            "{error}"
        );
    }
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let rest = Body::new(Trajectory::at_rest(DVec3::ZERO).unwrap()).with_tag(3);
    let scene = Scene::new();
    for (query, refusal) in [
        (Query::default(), "no body has a plan"),
        (Query::new(Window::ALL), "body 3 exists beyond its knots"),
        (Query::default().with_margin(f64::NAN), "margin NaN m"),
    ] {
        for error in [
            scene.conflicts_with(&rest, &query).unwrap_err(),
            pair::conflicts(&rest, &rest, &query).unwrap_err(),
        ] {
            assert!(error.to_string().starts_with(refusal), "{error}");
        }
    }
}

/// Returns a plan at a constant velocity (m/s) along x, from a place (m) at its beginning.
fn along_x(begin: f64, end: f64, place: f64, velocity: f64) -> Trajectory {
    let velocity = velocity * DVec3::X;
    support::line(begin, end, place * DVec3::X, velocity)
}

/// A contact a third of an instant beyond the window, which is reported at its end.
#[test]
fn a_contact_that_rounds_to_an_end_of_the_window() {
    const NOW: f64 = 1e9;
    const ULP: f64 = 1.0 / 8_388_608.0;
    const LENGTH: f64 = 1_024.0 * ULP;
    let (begin, end) = (NOW - LENGTH, NOW + 3.0 * LENGTH);
    let window = Window::new(NOW, NOW + LENGTH).unwrap();
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        for (time, later, velocity) in [(NOW, -0.3, 1e3), (NOW + LENGTH, 0.3, -1e3)] {
            let place = 1.0 - velocity * ((time - begin) + later * ULP);
            let own = Body::new(along_x(begin, end, place, velocity));
            let rest = Body::new(along_x(begin, end, 0.0, 0.0));
            let query = Query::new(window).with_margin(1.0).with_accuracy(accuracy);
            let mut scene = Scene::new();
            scene.insert(rest).unwrap();
            let asked = scene.conflicts_with(&own, &query).unwrap();
            scene.insert(own).unwrap();
            let screened = scene.screen(&query).unwrap().conflicts;
            // A certified contact lies in the window itself.
            let is_told = accuracy == Accuracy::Exact;
            assert_eq!(screened.len(), usize::from(is_told), "{time} {later}");
            assert_eq!(bits(&asked), bits(&screened), "{time} {later}");
        }
    }
}

/// Times since 1970, and windows that end when a conflict begins, as it was reported.
#[test]
fn windows_up_to_a_reported_beginning() {
    let start = 1.7e9;
    for number in 0..200 {
        let mut scene = Scene::new();
        let rest = Body::new(along_x(start, start + 60.0, 0.0, 0.0));
        scene.insert(rest).unwrap();
        let place = 200.0 + 0.37 * f64::from(number);
        let own = Body::new(along_x(start, start + 60.0, place, -7.5));
        let mut all = scene.clone();
        all.insert(own.clone()).unwrap();
        let query = Query::default().with_margin(5.0);
        let first = all.screen(&query).unwrap().conflicts[0];
        let window = Window::new(start, first.enter).unwrap();
        let query = Query::new(window).with_margin(5.0);
        let asked = scene.conflicts_with(&own, &query).unwrap();
        let screened = all.screen(&query).unwrap().conflicts;
        assert_eq!(bits(&asked), bits(&screened), "{number}");
    }
}

/// Returns a plan with a piece of an end motion at its beginning. Terms of 3e16 m cancel there: it is known to some 200 m.
fn known_badly() -> Trajectory {
    let (factor, zero) = (1e6, 3_069.0_f64);
    let cubic = [
        factor * DVec3::X,
        -factor * zero * DVec3::X,
        DVec3::ZERO,
        DVec3::ZERO,
    ];
    let old = Trajectory::from_coefficients(&[-3.0, 0.0], &[cubic], TimeBase::Absolute).unwrap();
    let from = zero.next_up();
    let plan = support::line(from, from + 1.0, DVec3::ZERO, DVec3::ZERO);
    let all = old.with_outside(Outside::Extrapolate).spliced(from, &plan);
    let short = all.unwrap().trimmed_before(from);
    assert_eq!(short.knots(), [zero, from, from + 1.0]);
    short
}

/// A question and a screening both report a body that may, within its error, come near a place or a floor.
#[test]
fn pieces_beyond_their_cubic_are_known_badly() {
    let place = Trajectory::at_rest(-60.0 * DVec3::X).unwrap();
    let floor = Hitbox::half_space(DVec3::X).unwrap();
    let window = Window::new(3_069.0, 3_070.0).unwrap();
    for (hitbox, accuracy) in [
        (Hitbox::POINT, Accuracy::Exact),
        (Hitbox::POINT, Accuracy::Certified),
        (floor.clone(), Accuracy::Exact),
        (floor, Accuracy::Certified),
    ] {
        let other = Body::new(place.clone()).with_hitbox(hitbox);
        let query = Query::new(window).with_accuracy(accuracy);
        let mut scene = Scene::new();
        scene.insert(Body::new(known_badly())).unwrap();
        let asked = scene.conflicts_with(&other, &query).unwrap();
        scene.insert(other).unwrap();
        let screened = scene.screen(&query).unwrap().conflicts;
        assert_eq!(screened.len(), 1, "{accuracy:?}");
        assert_eq!(bits(&asked), bits(&screened), "{accuracy:?}");
    }
}
