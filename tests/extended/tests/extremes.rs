//! The table of extremes: what is promised where floating point is cruel, and what was measured.
//!
//! Every answer is certified, and checked in exact arithmetic: nothing is lost, what is resolved is
//! there, and every number lies in its enclosure. `Exact` must say the same to the rounding of the
//! local scale. No answer holds a NaN or an infinity. `cargo test --test extremes -- --nocapture`
//! prints the last three columns: conflicts, those of them that stay unresolved (half of the
//! questions ask for exactly the least distance), and the largest width of the separation relative
//! to the local scale.
//!
//! | row | promise | conflicts | unresolved | width/L |
//! |---|---|---|---|---|
//! | lengths × 1e-150 … 1e150 | served, nothing depends on the unit | 295 | 140 | 3.2e-15 |
//! | durations 1e-9 … 1e9 s | served | 293 | 140 | 3.2e-15 |
//! | durations in a ratio of 1e9 | served | 82 | 40 | 3.1e-15 |
//! | 1 ms segments 1.7e9 s after the epoch | the states' own times are the truth | 42 | 20 | 3.1e-15 |
//! | 1e9 m from the origin, 1 cm apart | the states' own positions are the truth | 44 | 20 | 3.0e-15 |
//! | velocities of 1e8 m/s | served | 41 | 20 | 3.2e-15 |
//! | zero velocity | served | 42 | 20 | 3.9e-15 |
//! | leading coefficients 0 or 1e-17 | served | 80 | 40 | 3.3e-15 |
//! | one motion for both | distance 0: unresolved at margin 0, certain above | 2 | 1 | 3.2e-16 |
//! | constant distance at the margin | one unresolved conflict over all of it | 1 | 1 | 4.0e-15 |
//! | margins 0 and below, radius 0 | a negative sum is never reached, a zero one only touched | | | |
//! | subnormal values | served, to some times the smallest normal number: all unresolved | 40 | 40 | 1.4e14 |
//! | squares that overflow (1e200 m) | served | 42 | 20 | 3.4e-15 |
//! | told states 1e9 s old, or of 1e9 s later | the state's own numbers are the truth | 40 | 20 | 1.7e-15 |
//! | told states 1e9 m away | the state's own numbers are the truth | 40 | 20 | 5.0e-23 |
//! | told states 1e-9 s old | the state's own numbers are the truth | 40 | 20 | 1.9e-15 |
//! | told bodies that rest | served | 40 | 20 | 3.8e-15 |
//! | bodies that are told twice | the last state counts | 40 | 20 | 1.7e-15 |
//! | beyond ±1e300 | a typed error with knot and value | | | |

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    dead_code,
    reason = "a case that cannot be built fails the test; exact cases are exact; the modules are those of the campaign"
)]

#[path = "oracle/cases.rs"]
mod cases;
#[path = "oracle/check.rs"]
mod check;
mod oracle_support;
#[path = "extremes/told.rs"]
mod told;

use cases::Case;
use check::Truth;
use glam::DVec3;
use nearmiss::{
    Accuracy, Body, Conflict, Error, Hitbox, Outside, Quantity, Query, Scene, State, Trajectory,
    Window,
};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// What came out of a row.
#[derive(Default)]
struct Row {
    conflicts: usize,
    unresolved: usize,
    widest: f64,
}

impl Row {
    fn print(&self, name: &str) {
        eprintln!(
            "| {name} | {} | {} | {:.1e} |",
            self.conflicts, self.unresolved, self.widest
        );
    }

    /// Asks at both accuracies, and checks both answers.
    fn ask(&mut self, case: &Case) -> Vec<Conflict> {
        let (scene, margin) = (case.scene(), case.margin);
        let certified = screen(&scene, margin, Accuracy::Certified);
        let exact = screen(&scene, margin, Accuracy::Exact);
        let truth = (&Truth::of(case), case.scale());
        self.check(&certified, &exact, truth, &format!("{case:?}"));
        certified
    }

    /// Checks certified answers and others, to a question of a local scale (m).
    fn check(
        &mut self,
        certified: &[Conflict],
        exact: &[Conflict],
        (truth, scale): (&Truth, f64),
        case: &str,
    ) {
        assert_eq!(truth.wrong(certified), None, "{case} {certified:?}");
        let thoroughly = truth.wrong_thoroughly(certified);
        assert_eq!(thoroughly, None, "{case} {certified:?}");
        for conflict in certified {
            let proof = conflict.certificate.unwrap();
            self.conflicts += 1;
            self.unresolved += usize::from(!proof.resolved);
            self.widest = self.widest.max(2.0 * proof.error / scale);
        }
        for conflict in exact.iter().chain(certified) {
            assert_finite(conflict);
        }
        // A touch is decided by rounding: `Exact` reports what comes that near, too.
        let resolved = certified
            .iter()
            .filter(|conflict| conflict.certificate.unwrap().resolved);
        for conflict in resolved {
            let proof = conflict.certificate.unwrap();
            let covers = |found: &&Conflict| {
                found.enter <= proof.enter.latest && found.exit >= proof.exit.earliest
            };
            let found = exact
                .iter()
                .find(covers)
                .unwrap_or_else(|| panic!("{case} {exact:?} {conflict:?}"));
            let off = (found.closest.separation - conflict.closest.separation).abs();
            // 64 roundings of the local scale, and the smallest numbers.
            assert!(off <= 64.0 * f64::EPSILON * scale + 1e-320, "{off} {case}");
        }
    }
}

fn screen(scene: &Scene, margin: f64, accuracy: Accuracy) -> Vec<Conflict> {
    let query = Query::new(Window::ALL)
        .with_margin(margin)
        .with_accuracy(accuracy);
    scene.screen(&query).unwrap().conflicts
}

fn assert_finite(conflict: &Conflict) {
    let closest = &conflict.closest;
    let vectors = [
        closest.position_a,
        closest.position_b,
        closest.relative_velocity,
    ];
    let times = [
        conflict.enter,
        conflict.exit,
        closest.time,
        closest.separation,
    ];
    assert!(
        times.iter().all(|number| number.is_finite()),
        "{conflict:?}"
    );
    assert!(
        vectors.iter().all(|vector| vector.is_finite()),
        "{conflict:?}"
    );
}

fn vector(rng: &mut ChaCha8Rng, half: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| rng.random_range(-half..=half)))
}

/// Two segments, from `start` on, with positions within `size` of a place and such velocities
/// that the way is about as long.
fn path(
    rng: &mut ChaCha8Rng,
    (start, duration): (f64, f64),
    (place, size): (DVec3, f64),
) -> Vec<State> {
    (0..3)
        .map(|k| {
            let time = start + f64::from(k) * duration * 0.5;
            State::new(
                time,
                place + vector(rng, size),
                vector(rng, size) / duration,
            )
        })
        .collect()
}

/// The same two paths twice: asked for a tenth more than the least distance, and for just that.
fn with_margins(states: [Vec<State>; 2]) -> [Case; 2] {
    let mut case = Case {
        states,
        margin: 0.0,
        window: None,
        outside: Outside::Absent,
    };
    let scene = case.scene();
    let ids: Vec<_> = scene.bodies().map(|(id, _)| id).collect();
    let least = scene.closest_approach(ids[0], ids[1], Window::ALL);
    let least = least.unwrap().unwrap().separation;
    case.margin = 1.1 * least;
    let mut touching = case.clone();
    touching.margin = least;
    [case, touching]
}

/// A row of random pairs.
fn random(
    name: &str,
    count: u32,
    seed: u64,
    mut pair: impl FnMut(&mut ChaCha8Rng) -> [Vec<State>; 2],
) -> Row {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut row = Row::default();
    for _ in 0..count {
        for case in with_margins(pair(&mut rng)) {
            assert!(!row.ask(&case).is_empty(), "{case:?}");
        }
    }
    row.print(name);
    row
}

/// Widths that are a few roundings of the local scale.
fn is_narrow(row: &Row) {
    assert!(row.widest < 1e-14, "{}", row.widest);
}

#[test]
fn lengths() {
    let units = [1e-150, 1e-100, 1e-50, 1.0, 1e50, 1e100, 1e150];
    let mut next = units.iter().cycle();
    let row = random("lengths", 140, 1, |rng| {
        let unit = *next.next().unwrap();
        [(); 2].map(|()| path(rng, (0.0, 1.0), (DVec3::ZERO, unit)))
    });
    is_narrow(&row);
}

#[test]
fn durations() {
    let units = [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9];
    let mut next = units.iter().cycle();
    let row = random("durations", 140, 2, |rng| {
        let unit = *next.next().unwrap();
        [(); 2].map(|()| path(rng, (0.0, unit), (DVec3::ZERO, 1.0)))
    });
    is_narrow(&row);
}

#[test]
fn durations_in_a_ratio_of_1e9() {
    let row = random("ratio of durations", 40, 3, |rng| {
        // One body's segments are an instant within the other's.
        let long = path(rng, (0.0, 1e6), (DVec3::ZERO, 1e3));
        let short = path(rng, (3e5, 1e-3), (DVec3::ZERO, 1e3));
        [long, short]
    });
    is_narrow(&row);
}

#[test]
fn milliseconds_long_after_the_epoch() {
    let row = random("1.7e9 s", 20, 4, |rng| {
        [(); 2].map(|()| path(rng, (1.7e9, 1e-3), (DVec3::ZERO, 1.0)))
    });
    is_narrow(&row);
}

#[test]
fn centimetres_far_from_the_origin() {
    let place = DVec3::new(1e9, -1e9, 5e8);
    let row = random("1e9 m", 20, 5, |rng| {
        [(); 2].map(|()| path(rng, (0.0, 1.0), (place, 0.01)))
    });
    is_narrow(&row);
}

#[test]
fn fast_bodies() {
    let row = random("1e8 m/s", 20, 6, |rng| {
        [(); 2].map(|()| path(rng, (0.0, 1.0), (DVec3::ZERO, 1e8)))
    });
    is_narrow(&row);
}

#[test]
fn bodies_without_velocity() {
    let row = random("zero velocity", 20, 7, |rng| {
        let mut flying = path(rng, (0.0, 1.0), (DVec3::ZERO, 1.0));
        for state in &mut flying {
            state.velocity = DVec3::ZERO;
        }
        let rest = vector(rng, 1.0);
        let resting = flying
            .iter()
            .map(|state| State::new(state.time, rest, DVec3::ZERO));
        [resting.collect(), flying]
    });
    is_narrow(&row);
}

/// Cubic and quadratic terms that vanish exactly, or are 1e-17 of the linear one.
#[test]
fn vanishing_coefficients() {
    let mut is_exact = false;
    let row = random("vanishing coefficients", 40, 8, |rng| {
        is_exact = !is_exact;
        [(); 2].map(|()| {
            // Quarters: sums and halves of them are exact.
            let quarter = |v: DVec3| (v * 4.0).round() / 4.0;
            let (from, velocity) = (quarter(vector(rng, 4.0)), quarter(vector(rng, 4.0)));
            let states = [0.0, 0.5, 1.0].map(|t| State::new(t, from + velocity * t, velocity));
            let bend = if is_exact { 0.0 } else { 1e-17 };
            states
                .map(|state| State {
                    velocity: state.velocity + bend * vector(rng, 4.0),
                    ..state
                })
                .to_vec()
        })
    });
    is_narrow(&row);
}

#[test]
fn one_motion_for_both() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let states = path(&mut rng, (0.0, 1.0), (DVec3::ZERO, 1.0));
    let mut row = Row::default();
    for (margin, is_certain) in [(0.0, false), (1e-9, true)] {
        let case = Case {
            states: [states.clone(), states.clone()],
            margin,
            window: None,
            outside: Outside::Absent,
        };
        let found = row.ask(&case);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].certificate.unwrap().resolved, is_certain);
        assert_eq!((found[0].enter, found[0].exit), (0.0, 1.0));
        assert_eq!(found[0].closest.separation, 0.0);
    }
    row.print("one motion for both");
    is_narrow(&row);
}

#[test]
fn a_constant_distance_at_the_margin() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let states = path(&mut rng, (0.0, 1.0), (DVec3::ZERO, 1.0));
    // A shift that rounds nothing: the positions are below 1, the shift is 1024.
    let shifted = states.iter().map(|state| State {
        position: (state.position * 1024.0).round() / 1024.0 + 1024.0 * DVec3::X,
        ..*state
    });
    let plain = states.iter().map(|state| State {
        position: (state.position * 1024.0).round() / 1024.0,
        ..*state
    });
    let case = Case {
        states: [plain.collect(), shifted.collect()],
        margin: 1024.0,
        window: None,
        outside: Outside::Absent,
    };
    let mut row = Row::default();
    let found = row.ask(&case);
    assert_eq!(found.len(), 1);
    assert!(!found[0].certificate.unwrap().resolved);
    assert_eq!((found[0].enter, found[0].exit), (0.0, 1.0));
    row.print("constant distance");
}

#[test]
fn margins_of_zero_and_below() {
    let line = |from: DVec3, velocity: DVec3, radius: f64| {
        let states = [0.0, 8.0].map(|t| State::new(t, from + velocity * t, velocity));
        Body::new(Trajectory::from_states(&states).unwrap())
            .with_hitbox(Hitbox::sphere(radius).unwrap())
    };
    let pair = |radius: f64, beside: f64| {
        let mut scene = Scene::new();
        scene
            .insert(line(DVec3::new(-4.0, beside, 0.0), DVec3::X, radius))
            .unwrap();
        scene
            .insert(line(DVec3::ZERO, DVec3::ZERO, radius))
            .unwrap();
        scene
    };
    for accuracy in [Accuracy::Exact, Accuracy::Certified] {
        // Points never overlap, however they meet.
        assert!(screen(&pair(0.0, 0.0), -1e-300, accuracy).is_empty());
        // They touch where they are at one place.
        let touch = screen(&pair(0.0, 0.0), 0.0, accuracy);
        assert_eq!(touch.len(), 1, "{accuracy:?}");
        assert!((touch[0].closest.time - 4.0).abs() < 1e-6);
        // Spheres of 1 m on a way through each other: overlapping by half a metre within 1.5 m.
        let found = screen(&pair(1.0, 0.0), -0.5, accuracy);
        assert_eq!(found.len(), 1);
        // Some roundings of the local scale, 5 m.
        assert!((found[0].enter - 2.5).abs() < 1e-14 && (found[0].exit - 5.5).abs() < 1e-14);
        assert!((found[0].closest.separation + 2.0).abs() < 1e-14);
        // A margin that swallows both radii.
        assert!(screen(&pair(1.0, 0.0), -2.0 - 1e-9, accuracy).is_empty());
    }
    let proof = screen(&pair(0.0, 0.0), 0.0, Accuracy::Certified)[0]
        .certificate
        .unwrap();
    assert!(!proof.resolved);
    assert!(proof.closest.earliest <= 4.0 && 4.0 <= proof.closest.latest);
}

/// Positions of some dozens of the smallest number: even the error bound is larger.
#[test]
fn subnormal_values() {
    let row = random("subnormal", 20, 11, |rng| {
        [(); 2].map(|()| path(rng, (0.0, 1.0), (DVec3::ZERO, 2e-322)))
    });
    assert_eq!(row.unresolved, row.conflicts);
}

#[test]
fn squares_that_overflow() {
    let row = random("overflowing squares", 20, 12, |rng| {
        [(); 2].map(|()| path(rng, (0.0, 1.0), (DVec3::ZERO, 1e200)))
    });
    is_narrow(&row);
}

#[test]
fn numbers_beyond_the_range() {
    let state = |position: f64| {
        [0.0, 1.0].map(|t| State::new(t, DVec3::X * position * (t + 0.1), DVec3::ZERO))
    };
    assert!(Trajectory::from_states(&state(1e298)).is_ok());
    let refused = Trajectory::from_states(&state(1e300)).unwrap_err();
    assert!(matches!(
        refused,
        Error::OutOfRange { knot: 1, quantity: Quantity::Position(0), value } if value > 1e300
    ));
    // None of the numbers is too large, but the way from one to the other.
    let far = [0.0, 1.0].map(|t| {
        let y = 9e299 * t;
        State::new(t, DVec3::new(0.0, y, y), DVec3::ZERO)
    });
    let refused = Trajectory::from_states(&far).unwrap_err();
    assert!(matches!(
        refused,
        Error::OutOfRange { knot: 1, quantity: Quantity::Distance, value } if value > 1e300
    ));
    // 1e10 m within 1e-200 s: no acceleration of that size is served.
    let sudden = [
        State::new(0.0, DVec3::ZERO, DVec3::ZERO),
        State::new(1e-200, DVec3::X * 1e10, DVec3::ZERO),
    ];
    let refused = Trajectory::from_states(&sudden).unwrap_err();
    assert!(matches!(refused, Error::OutOfRange { knot: 1, .. }));
    let query = Query::default().with_margin(1e301);
    assert!(matches!(
        Scene::new().screen(&query),
        Err(Error::Margin { .. })
    ));
}
