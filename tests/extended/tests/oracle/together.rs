//! Many questions in one scene: each pair has the answer that it has alone, bit for bit, whatever the
//! method, the slicing and the number of threads; and that of the pair that is asked about is true.
//!
//! Two bodies are one comparison. Here there are rows, slices and threads, and bodies from others'
//! questions in the way.

use crate::cases::{Case, FAMILIES, Family};
use crate::check::Truth;
use crate::support::{bits, on_threads, sliced};
use glam::DVec3;
use nearmiss::internals::{Method, QueryInternals};
use nearmiss::{Conflict, Scene};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use std::collections::BTreeMap;

/// More bodies than are simply compared with each other, and work for several threads.
const PAIRS: u32 = 100;

/// One question in so many is asked: of all pairs at once.
const EVERY: u32 = 5;

/// Method, slices (0: as it chooses), threads.
const WAYS: [(Method, u32, usize); 7] = [
    (Method::Sweep, 0, 1),
    (Method::Sweep, 100, 2),
    (Method::Tree, 7, 3),
    (Method::Sweep, 7, 4),
    (Method::Sweep, 1, 2),
    (Method::BruteForce, 100, 1),
    (Method::Sweep, 0, 3),
];

/// Pairs sit a few times their size from each other: neighbours meet now and then.
fn place(number: u32) -> DVec3 {
    let lane = |step: u32| 4.0 * f64::from(number / step % 5);
    DVec3::new(lane(1), lane(5), lane(25))
}

/// The bits of conflicts but for the ids, by pairs of a scene into which one pair was put after the other.
fn by_pairs(conflicts: &[Conflict]) -> BTreeMap<u32, Vec<Vec<u64>>> {
    let mut found: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for (conflict, bits) in conflicts.iter().zip(bits(conflicts)) {
        let (a, b) = (conflict.a.slot(), conflict.b.slot());
        if a / 2 == b / 2 {
            found.entry(a / 2).or_default().push(bits[2..].to_vec());
        }
    }
    found
}

/// How many conflicts there were to compare.
fn each_answer_is_its_own(cases: &[Case]) -> usize {
    let mut scene = Scene::new();
    for case in cases {
        case.join(&mut scene);
    }
    let alone: Vec<Scene> = cases.iter().map(Case::scene).collect();
    let mut compared = 0;
    for (case, (way, number)) in cases.iter().zip(WAYS.into_iter().cycle().zip(0_u32..)) {
        if !number.is_multiple_of(EVERY) {
            continue;
        }
        let (method, slices, threads) = way;
        let query = sliced(case.query().with_method(method), slices);
        let together = on_threads(threads, || scene.screen(&query)).unwrap();
        let mut found = by_pairs(&together.conflicts);
        for (alone, pair) in alone.iter().zip(0..) {
            let expected = bits(&alone.screen(&case.query()).unwrap().conflicts);
            let expected: Vec<_> = expected.iter().map(|bits| bits[2..].to_vec()).collect();
            let found = found.remove(&pair).unwrap_or_default();
            assert_eq!(found, expected, "pair {pair}, question {number}, {way:?}");
            compared += found.len();
        }
        let is_own = |one: &&Conflict| (one.a.slot(), one.b.slot()) == (2 * number, 2 * number + 1);
        let own: Vec<Conflict> = together.conflicts.iter().filter(is_own).copied().collect();
        assert_eq!(Truth::of(case).wrong(&own), None, "{case:?} {way:?}");
    }
    compared
}

#[test]
fn pairs_in_one_scene_have_their_own_answers() {
    let cases_of = |seed: u64, families: &[Family]| -> Vec<Case> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let families = families.iter().cycle();
        (0..PAIRS)
            .zip(families)
            .map(|(number, &family)| Case::draw_around(&mut rng, family, place(number)))
            .collect()
    };
    for (seed, family) in (50..).zip(FAMILIES) {
        let compared = each_answer_is_its_own(&cases_of(seed, &[family]));
        println!("{family:?}: {compared} conflicts");
        assert!(compared > 100, "{family:?}: {compared}");
    }
    // All of them in one world. (But for those that go on for ever: not every window is closed.)
    let families: Vec<_> = FAMILIES
        .into_iter()
        .filter(|&f| f != Family::Beyond)
        .collect();
    let compared = each_answer_is_its_own(&cases_of(70, &families));
    println!("all: {compared} conflicts");
    assert!(compared > 100, "{compared}");
}
