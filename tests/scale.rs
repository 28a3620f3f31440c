//! Many bodies in worlds of all shapes: the same answer by every slicing and method, and work that
//! stays within bounds. Work is counted, not timed.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

#[path = "../examples/scenes/mod.rs"]
mod scenes;
mod support;

use glam::DVec3;
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Body, Conflict, Hitbox, Query, Scene, Stats, Trajectory, Window};
use rand::RngExt;
use scenes::{Actor, Generated, Shape, generator, satellites, swarm};
use std::num::NonZeroU32;
use support::{bits, exceeded};

/// A change to one body of a swarm: its states, and a random share.
type Change = fn(&mut Actor, f64);

/// The swarm, and what makes another world of it.
const WORLDS: [(&str, Shape, Change); 9] = [
    ("cube", Shape::Cube, |_, _| {}),
    ("clusters", Shape::Clusters, |_, _| {}),
    ("flat", Shape::Flat, |_, _| {}),
    ("fast few", Shape::FastFew, |_, _| {}),
    ("any time", Shape::Cube, |actor, share| {
        for state in &mut actor.states {
            state.time += 1e3 * share;
        }
    }),
    ("at rest", Shape::Cube, |actor, _| {
        let place = actor.states[0].position;
        for state in &mut actor.states {
            (state.position, state.velocity) = (place, DVec3::ZERO);
        }
    }),
    ("from one place", Shape::Cube, |actor, _| {
        let place = actor.states[0].position;
        for state in &mut actor.states {
            state.position -= place;
        }
    }),
    ("large few", Shape::Cube, |actor, share| {
        if share < 0.01 {
            actor.radius = 200.0;
        }
    }),
    ("brief", Shape::Cube, |actor, share| {
        let first = (share * 30.0).floor();
        let start = f64::min(first, 30.0);
        actor.states.retain(|state| state.time >= 2.0 * start);
        actor.states.truncate(3);
    }),
];

fn world(count: usize, index: usize) -> Generated {
    let (_, shape, change) = WORLDS[index];
    let mut rng = generator(7);
    let mut generated = swarm(count, shape, 3);
    for actor in &mut generated.actors {
        change(actor, rng.random());
    }
    generated.actors.retain(|actor| actor.states.len() > 1);
    generated
}

fn scene(generated: &Generated) -> (Scene, Query) {
    let mut scene = Scene::new();
    for actor in &generated.actors {
        let plan = Trajectory::from_states(&actor.states).unwrap();
        let hitbox = Hitbox::sphere(actor.radius).unwrap();
        scene.insert(Body::new(plan).with_hitbox(hitbox)).unwrap();
    }
    (scene, Query::default().with_margin(generated.margin))
}

fn screened(scene: &Scene, query: &Query) -> (Vec<Conflict>, Stats) {
    let screening = scene.screen(query).unwrap();
    (screening.conflicts, screening.stats)
}

#[test]
fn slicing_and_method_make_no_difference() {
    for (index, (name, ..)) in WORLDS.iter().enumerate() {
        let (scene, query) = scene(&world(120, index));
        let (reference, _) = screened(&scene, &query.with_method(Method::BruteForce));
        for method in Method::EVERY {
            for slices in [1, 2, 7, 40, 1_000] {
                let query = query
                    .with_method(method)
                    .with_slices(NonZeroU32::new(slices).unwrap());
                let (found, stats) = screened(&scene, &query);
                assert_eq!(stats.slices, u64::from(slices));
                assert_eq!(
                    bits(&found),
                    bits(&reference),
                    "{name}, {method:?}, {slices} slices"
                );
            }
        }
    }
}

/// The work of the stages, in units of a box: about as in `search/slice_length.rs`, where a span stands
/// for the pair that is looked at as well; without what no slicing can change.
fn cost(stats: &Stats) -> f64 {
    let count = |number: u64| f64::from(u32::try_from(number).unwrap());
    count(stats.boxes) + 0.2 * count(stats.candidates) + 0.7 * count(stats.spans)
}

/// The length that is chosen is not far from the best of many.
#[test]
fn the_chosen_length_is_near_the_best() {
    for (index, (name, ..)) in WORLDS.iter().enumerate() {
        let (scene, query) = scene(&world(500, index));
        let (_, stats) = screened(&scene, &query);
        let best = (0..12)
            .map(|k| {
                let slices = NonZeroU32::new(2_u32.pow(k)).unwrap();
                cost(&screened(&scene, &query.with_slices(slices)).1)
            })
            .fold(f64::INFINITY, f64::min);
        let chosen = cost(&stats);
        // Lengths are tried in steps of two; the cost is flat there, and the sample is small.
        println!(
            "{name}: {} slices, {:.2} times the best",
            stats.slices,
            chosen / best
        );
        assert!(
            chosen <= 1.6 * best,
            "{name}: {chosen} for {best}, {stats:?}"
        );
    }
}

/// Per body, no shape takes more than a few times the work of the plain one.
#[test]
fn no_shape_takes_much_more_work() {
    let work = |generated: &Generated| {
        let (scene, query) = scene(generated);
        let (conflicts, stats) = screened(&scene, &query);
        // Contacts must be solved, however they are found.
        cost(&stats) - 10.0 * f64::from(u32::try_from(conflicts.len()).unwrap())
    };
    let plain = work(&world(3_000, 0));
    for (index, (name, ..)) in WORLDS.iter().enumerate() {
        if *name == "from one place" || *name == "large few" {
            // Most pairs are in contact, or their boxes meet: nothing beats comparing them.
            continue;
        }
        let share = work(&world(3_000, index)) / plain;
        println!("{name}: {share:.2}");
        assert!(share < 4.0, "{name}: {share} times the work of a cube");
    }
    // Bodies in orbit go through the same space again and again: more slices, the same work each.
    let (scene, query) = scene(&satellites(2_000, 1));
    let (_, stats) = screened(&scene, &query);
    assert!(stats.spans < stats.boxes, "{stats:?}");
}

/// What is counted depends on the scene alone, and so does every bit of the answer.
#[cfg(feature = "parallel")]
#[test]
fn threads_make_no_difference() {
    for index in [0, 1, 3] {
        let (scene, query) = scene(&world(1_500, index));
        let answers: Vec<_> = (1..=4)
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let pool = pool.build().unwrap();
                let (found, stats) = pool.install(|| screened(&scene, &query));
                let counts = [
                    stats.slices,
                    stats.boxes,
                    stats.candidates,
                    stats.spans,
                    stats.survivors,
                ];
                (bits(&found), counts)
            })
            .collect();
        assert!(answers.iter().all(|answer| *answer == answers[0]));
        assert!(!answers[0].0.is_empty());
    }
}

/// A crowd in one place has as many conflicts as pairs: what there is no room for is refused, not
/// tried.
#[test]
fn a_crowd_is_refused_beyond_its_limit() {
    let crowd = |count: usize| {
        let mut scene = Scene::new();
        for _ in 0..count {
            let body = Body::new(Trajectory::at_rest(DVec3::ONE).unwrap());
            scene.insert(body).unwrap();
        }
        scene
    };
    let query = Query::new(Window::new(0.0, 1.0).unwrap());
    for method in Method::EVERY {
        let query = query.with_method(method);
        let small = crowd(200);
        let (found, stats) = screened(&small, &query);
        assert_eq!(found.len(), 199 * 100);
        let spans = usize::try_from(stats.survivors).unwrap();
        let (again, _) = screened(&small, &query.with_max_spans(spans));
        assert_eq!(bits(&again), bits(&found));
        let query = query.with_max_spans(spans - 1);
        assert_eq!(exceeded(small.screen(&query)), Some(spans - 1));
        // Nothing is left of it.
        let query = query.with_max_spans(spans);
        assert_eq!(bits(&screened(&small, &query).0), bits(&found));
    }
    // Twice as many candidates as there is room for in one slice.
    let limit = exceeded(crowd(16_400).screen(&query));
    assert_eq!(limit, Some(Query::MAX_SPANS));
}

#[test]
fn no_body_one_body_two_bodies() {
    for count in 0..3 {
        let (scene, query) = scene(&world(count, 6));
        for method in Method::EVERY {
            let (found, stats) = screened(&scene, &query.with_method(method));
            assert_eq!(stats.bodies, count as u64);
            // The two begin at the same place.
            assert_eq!(found.len(), usize::from(count == 2), "{method:?}");
        }
    }
}
