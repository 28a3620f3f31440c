//! Ten thousand bodies: one answer by every method, slicing and number of threads, and nothing in it
//! that is not each pair's own.

#![allow(
    clippy::unwrap_used,
    reason = "a scene that cannot be built fails the test"
)]

#[path = "../examples/scenes/mod.rs"]
mod scenes;
mod support;

use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Body, Conflict, Query, Scene, Trajectory, Window};
use scenes::{Actor, Shape, swarm};
use std::collections::BTreeSet;
use support::{bits, hash, on_threads, sliced};

const BODIES: usize = 10_000;

/// m. Eight times the swarm's own: nearly every body is in conflict with some others, so that none is
/// taken for another, or left out, without a trace.
const MARGIN: f64 = 40.0;

/// Method, slices (0: as it chooses), threads. Boxes are more than 4,000 in a slice, and so are the
/// bodies: what is done otherwise where there are many of them is done.
const WAYS: [(Method, u32, usize); 9] = [
    (Method::Tree, 0, 1),
    (Method::Tree, 7, 2),
    (Method::Sweep, 0, 1),
    (Method::Sweep, 0, 2),
    (Method::Sweep, 0, 4),
    (Method::Sweep, 7, 4),
    (Method::Sweep, 30, 1),
    (Method::Sweep, 30, 3),
    (Method::Sweep, 100, 2),
];

fn actors() -> Vec<Actor> {
    swarm(BODIES, Shape::Cube, 5).actors
}

/// Its slots are the places in the list.
fn scene_of<'a>(actors: impl IntoIterator<Item = &'a Actor>) -> Scene {
    let mut scene = Scene::new();
    for actor in actors {
        let plan = Trajectory::from_states(&actor.states).unwrap();
        scene.insert(Body::new(plan)).unwrap();
    }
    scene
}

fn query() -> Query {
    Query::default().with_margin(MARGIN)
}

/// What is said of two bodies is about these two: they are asked again by themselves.
fn is_of_its_pair(scene: &Scene, conflict: &Conflict) {
    let Conflict { a, b, .. } = *conflict;
    let window = Window::new(conflict.enter, conflict.exit).unwrap();
    let closest = scene.closest_approach(a, b, window).unwrap().unwrap();
    // Both are good to far less than a nanometre: coordinates are up to some kilometres.
    let off = (closest.separation - conflict.closest.separation).abs();
    assert!(off < 1e-9, "{conflict:?}, but {closest:?}");
}

#[test]
fn one_answer_whatever_the_way() {
    let scene = scene_of(&actors());
    let mut reference = None;
    for way in WAYS {
        let (method, slices, threads) = way;
        let query = sliced(query().with_method(method), slices);
        let found = on_threads(threads, || scene.screen(&query)).unwrap();
        let found = found.conflicts;
        let expected = *reference.get_or_insert_with(|| {
            let in_conflict: BTreeSet<_> = found.iter().flat_map(|one| [one.a, one.b]).collect();
            let alone = BODIES - in_conflict.len();
            assert!(alone < BODIES / 100, "{alone} bodies without a conflict");
            found.iter().for_each(|one| is_of_its_pair(&scene, one));
            hash(&found)
        });
        assert_eq!(hash(&found), expected, "{way:?}, {} conflicts", found.len());
    }
}

/// A thousand bodies in the middle, and what each two of a few of them are asked by themselves.
#[test]
fn a_part_has_the_conflicts_that_it_has_in_the_whole() {
    const PART: usize = 1_000;
    const FEW: usize = 200;
    let actors = actors();
    let whole = scene_of(&actors);
    let mut members: Vec<usize> = (0..BODIES).collect();
    let from_the_middle = |&place: &usize| actors[place].states[0].position.length();
    members.sort_by(|x, y| from_the_middle(x).total_cmp(&from_the_middle(y)));
    members.truncate(PART);
    members.sort_unstable();
    let found = on_threads(2, || whole.screen(&query())).unwrap().conflicts;
    let member = |slot: u32| members.binary_search(&usize::try_from(slot).unwrap()).ok();
    let is_inside = |one: &&Conflict| {
        let places = [one.a, one.b].map(|id| member(id.slot()));
        places.iter().all(Option::is_some)
    };
    let inside: Vec<Conflict> = found.iter().filter(is_inside).copied().collect();
    assert!(inside.len() > PART, "{}", inside.len());

    let part = scene_of(members.iter().map(|&place| &actors[place]));
    let by_force = sliced(query().with_method(Method::BruteForce), 4);
    let mut alone = bits(&part.screen(&by_force).unwrap().conflicts);
    for bits in &mut alone {
        for slot in &mut bits[..2] {
            *slot = members[usize::try_from(*slot).unwrap()] as u64;
        }
    }
    assert!(bits(&inside) == alone);

    // Nobody looks for candidates here.
    let ids: Vec<_> = whole.bodies().map(|(id, _)| id).collect();
    let (mut near, mut asked) = (BTreeSet::new(), BTreeSet::new());
    for (number, &a) in members[..FEW].iter().enumerate() {
        for &b in &members[number + 1..FEW] {
            let (a, b) = (ids[a], ids[b]);
            let closest = whole.closest_approach(a, b, Window::ALL).unwrap();
            if closest.is_some_and(|closest| closest.separation <= MARGIN) {
                near.insert((a, b));
            }
        }
        asked.insert(ids[a]);
    }
    let pairs = inside.iter().map(|one| (one.a, one.b));
    let pairs = pairs.filter(|(a, b)| asked.contains(a) && asked.contains(b));
    assert_eq!(pairs.collect::<BTreeSet<_>>(), near);
    assert!(near.len() > FEW / 10, "{}", near.len());
}
