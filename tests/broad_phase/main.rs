//! Every broad phase method gives exactly the pairs of boxes that meet.

#![allow(clippy::unwrap_used, reason = "a failure is the answer of a test")]

mod boxes;

use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use boxes::{SHAPES, SIDE, SPACING, Shape};
use nearmiss::internals::broad_phase::{
    BodyBox, BroadPhase, BruteForce, Candidate, Everyone, Groups, InstructionSet, PairFilter,
    Sweep, Tree,
};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;

/// Everything from the degenerate to several sets of every structure.
const COUNTS: [usize; 14] = [0, 1, 2, 3, 4, 15, 16, 17, 255, 256, 300, 500, 1_000, 2_200];

/// The pairs that meet, by comparisons written down once more, and from nothing else.
fn expected<F: PairFilter>(boxes: &[BodyBox], filter: &F) -> Vec<Candidate> {
    let mut pairs = Vec::new();
    for one in boxes {
        for other in boxes {
            let apart = (0..3).any(|axis| {
                one.aabb.maxs[axis] < other.aabb.mins[axis]
                    || other.aabb.maxs[axis] < one.aabb.mins[axis]
            });
            if one.body < other.body && !apart && filter.admits(one.body, other.body) {
                pairs.push(Candidate {
                    a: one.body,
                    b: other.body,
                });
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

fn found<B: BroadPhase, F: PairFilter>(
    method: &mut B,
    boxes: &[BodyBox],
    filter: &F,
) -> Vec<Candidate> {
    let mut pairs = Vec::new();
    method.pairs(boxes, filter, &mut pairs);
    pairs.sort_unstable();
    pairs
}

/// All shapes and numbers with one value of the method, so that scratch left by one meets the next.
fn gives_what_brute_force_gives<B: BroadPhase>() {
    let mut method = B::default();
    for shape in SHAPES {
        for (seed, count) in (0..).zip(COUNTS) {
            let boxes = shape.boxes(count, seed);
            let pairs = found(&mut method, &boxes, &Everyone);
            let wanted = expected(&boxes, &Everyone);
            assert!(
                pairs == wanted,
                "{count} boxes of {}: {} pairs found, {} expected",
                shape.name,
                pairs.len(),
                wanted.len()
            );
        }
    }
}

#[test]
fn brute_force_finds_what_meets() {
    gives_what_brute_force_gives::<BruteForce>();
}

#[test]
fn tree_finds_what_meets() {
    gives_what_brute_force_gives::<Tree>();
}

#[test]
fn sweep_finds_what_meets() {
    gives_what_brute_force_gives::<Sweep>();
}

/// Boxes of two shapes in one world.
fn mixed(one: &Shape, other: &Shape, count: usize) -> Vec<BodyBox> {
    let mut boxes = one.boxes(count, 5);
    boxes.extend(other.boxes(count, 6).into_iter().map(|one| BodyBox {
        // The bodies of one shape are multiples of three.
        body: one.body + 1,
        ..one
    }));
    boxes
}

#[test]
fn mixed_shapes_make_no_difference() {
    let (mut sweep, mut tree) = (Sweep::default(), Tree::default());
    for (i, one) in (0..).zip(SHAPES) {
        for other in &SHAPES[..i] {
            let boxes = mixed(&one, other, 150);
            let wanted = expected(&boxes, &Everyone);
            let names = (one.name, other.name);
            assert!(found(&mut sweep, &boxes, &Everyone) == wanted, "{names:?}");
            assert!(found(&mut tree, &boxes, &Everyone) == wanted, "{names:?}");
        }
    }
}

/// Members of even thirds of the bodies ignore each other; written without symmetry on purpose.
struct OddSums;

impl PairFilter for OddSums {
    fn admits(&self, a: u32, b: u32) -> bool {
        assert!(a < b, "the filter is asked about {a}, {b}");
        (a / 3 + b / 3) % 2 == 1
    }
}

fn honours_the_filter<B: BroadPhase>() {
    let mut method = B::default();
    for shape in SHAPES {
        let boxes = shape.boxes(400, 7);
        let pairs = found(&mut method, &boxes, &OddSums);
        assert_eq!(pairs, expected(&boxes, &OddSums), "{}", shape.name);
    }
}

#[test]
fn filters_are_honoured() {
    honours_the_filter::<BruteForce>();
    honours_the_filter::<Sweep>();
    honours_the_filter::<Tree>();
}

/// Bodies in groups, of which some form no pairs.
struct Grouped {
    groups: Groups,
    /// The group of a body, of so many groups.
    group: fn(u32, usize) -> usize,
    /// Pairs asked about that can be none by their groups.
    in_vain: AtomicUsize,
}

/// A number of groups, and which of them form pairs.
type Rule = (usize, fn(usize, usize) -> bool);

impl Grouped {
    const RULES: [Rule; 6] = [
        (2, |one, other| one != other),
        (2, |one, other| one + other < 2),
        (3, |one, other| one + other == 2),
        (4, |one, other| one.abs_diff(other) < 2),
        (8, |one, other| (one ^ other) & 1 == 1),
        (5, |_, _| false),
    ];

    /// Bodies are multiples of three: neighbours in the list are of different groups.
    fn of(rule: Rule) -> Self {
        Self::with(rule, |body, count| {
            let mixed = (body / 3).wrapping_mul(0x9E37_79B9) >> 16;
            mixed as usize % count
        })
    }

    fn with((count, rule): Rule, group: fn(u32, usize) -> usize) -> Self {
        Self {
            groups: Groups::new(count, rule),
            group,
            in_vain: AtomicUsize::new(0),
        }
    }
}

impl PairFilter for Grouped {
    fn admits(&self, a: u32, b: u32) -> bool {
        let [one, other] = [a, b].map(|body| usize::from(self.group(body)));
        let admits = self.groups.admits(one, other);
        self.in_vain
            .fetch_add(usize::from(!admits), Ordering::Relaxed);
        admits
    }

    fn groups(&self) -> Groups {
        self.groups
    }

    fn group(&self, body: u32) -> u8 {
        u8::try_from((self.group)(body, self.groups.count())).unwrap()
    }
}

#[test]
fn groups_lose_no_pair() {
    let mut sweep = Sweep::default();
    for rule in Grouped::RULES {
        let filter = Grouped::of(rule);
        for shape in SHAPES {
            for (seed, count) in (20..).zip([17, 256, 300, 1_000]) {
                let boxes = shape.boxes(count, seed);
                let pairs = found(&mut sweep, &boxes, &filter);
                let wanted = expected(&boxes, &filter);
                assert!(pairs == wanted, "{count} boxes of {}", shape.name);
            }
        }
    }
}

/// 1,000 boxes, all in one place: nobody asks about pairs of groups that form none.
#[test]
fn groups_that_form_no_pairs_are_not_compared() {
    let shape = SHAPES.iter().find(|shape| shape.name == "one_place");
    let boxes = shape.unwrap().boxes(1_000, 1);
    for rule in Grouped::RULES {
        let filter = Grouped::of(rule);
        let pairs = found(&mut Sweep::default(), &boxes, &filter);
        assert_eq!(filter.in_vain.into_inner(), 0);
        assert!(pairs == expected(&boxes, &Grouped::of(rule)));
    }
}

/// 64 ships in a cube, each among 50 shots that ignore each other. Few comparisons are expected of evenly spread
/// boxes, but nearly all of them find an overlap.
#[test]
fn crowds_of_a_group_that_forms_no_pairs_are_not_compared() {
    let places: Vec<Vector> = Shape::named("swarm")
        .boxes(64, 1)
        .iter()
        .map(|one| 40.0 * one.aabb.mins)
        .collect();
    let boxes: Vec<BodyBox> = (0_u8..51)
        .flat_map(|number| places.iter().map(move |&place| (number, place)))
        .zip(0..)
        .map(|((number, place), body)| {
            let low = place + 0.01 * f32::from(number);
            BodyBox {
                aabb: Aabb::new(low, low + 10.0),
                body,
            }
        })
        .collect();
    let rule: Rule = (2, |one, other| one + other < 2);
    let filter = || Grouped::with(rule, |body, _| usize::from(body >= 64));
    let (asked, wanted) = (filter(), expected(&boxes, &filter()));
    let pairs = found(&mut Sweep::default(), &boxes, &asked);
    assert_eq!(asked.in_vain.into_inner(), 0);
    assert!(pairs.len() >= 64 * 50 && pairs == wanted);
}

fn appends_in_the_same_order_each_time<B: BroadPhase>() {
    let sentinel = Candidate::new(7, 8);
    let mut method = B::default();
    let mut run = |shape: &Shape| {
        let mut pairs = vec![sentinel];
        method.pairs(&shape.boxes(1_000, 3), &Everyone, &mut pairs);
        pairs
    };
    let first = SHAPES.map(|shape| run(&shape));
    let second = SHAPES.map(|shape| run(&shape));
    assert_eq!(first, second, "earlier calls change the order");
    assert!(first.iter().all(|pairs| pairs[0] == sentinel));
}

#[test]
fn order_depends_on_the_boxes_alone() {
    appends_in_the_same_order_each_time::<BruteForce>();
    appends_in_the_same_order_each_time::<Sweep>();
    appends_in_the_same_order_each_time::<Tree>();
}

#[test]
fn every_level_gives_the_same_pairs_in_the_same_order() {
    for shape in SHAPES {
        for count in [3, 200, 3_000] {
            let boxes = shape.boxes(count, 11);
            let runs: Vec<Vec<Candidate>> = InstructionSet::available()
                .into_iter()
                .map(|instructions| {
                    let mut pairs = Vec::new();
                    Sweep::with_instruction_set(instructions).pairs(&boxes, &Everyone, &mut pairs);
                    pairs
                })
                .collect();
            assert!(
                runs.windows(2).all(|two| two[0] == two[1]),
                "{}",
                shape.name
            );
        }
    }
}

#[test]
fn boxes_that_touch_meet() {
    let cube = |x: f32, body| BodyBox {
        aabb: Aabb::new(Vector::new(x, 0.0, 0.0), Vector::new(x + 1.0, 1.0, 1.0)),
        body,
    };
    assert!(cube(0.0, 0).meets(&cube(1.0, 1)));
    assert!(!cube(0.0, 0).meets(&cube(1.0_f32.next_up(), 1)));
}

#[test]
fn the_generators_draw_what_they_say() {
    let mean_side = |boxes: &[BodyBox]| {
        let sum: Vector = boxes.iter().map(|one| one.aabb.extents()).sum();
        sum / 10_000.0
    };
    let density = |name: &str| {
        let boxes = Shape::named(name).boxes(10_000, 1);
        let bodies: HashSet<u32> = boxes.iter().map(|one| one.body).collect();
        assert_eq!(bodies.len(), 10_000, "{name}: one box a body");
        let mut pairs = Vec::new();
        Tree::default().pairs(&boxes, &Everyone, &mut pairs);
        (mean_side(&boxes), pairs.len())
    };

    // Ten thousand sides uniform in 0.5..1.5: the mean's deviation is 0.3 %.
    let (side, pairs) = density("swarm");
    assert!((side / SIDE - 1.0).abs().max_element() < 0.02, "{side}");
    // Each of n^2/2 pairs meets with probability (2 SIDE / side of the cube)^3: n/2 pairs, less
    // some 5 % at the faces; deviation 1.4 %.
    let even = 5_000.0 * (2.0 * SIDE / SPACING).powi(3);
    let share = f64::from(u32::try_from(pairs).unwrap()) / f64::from(even);
    assert!((0.85..1.05).contains(&share), "{pairs}");

    // Clusters are as dense as the swarm (more of the bodies are near a face), and far apart.
    let (_, clustered) = density("clusters");
    assert!(clustered > pairs / 2 && clustered < pairs, "{clustered}");

    // All of n^2/2 pairs, and none but those with the neighbours that follow: 13 less the faces.
    assert_eq!(density("identical").1, 49_995_000);
    assert_eq!(density("onion").1, 49_995_000);
    let touching = density("touching").1;
    assert!((110_000..130_000).contains(&touching), "{touching}");
}
