//! The oracle itself against answers that can be computed by hand, and against dense sampling in
//! exact arithmetic.

#![allow(clippy::unwrap_used, reason = "a panic is a failed test")]

#[path = "../oracle_support/mod.rs"]
mod oracle_support;
mod sampling;

use dashu::rational::RBig;
use oracle_support::{
    Body, Contact, Dyadic, Enclosure, Outside, PolynomialSegment, State, contacts, is_at_most,
    isolate, least_sign, minimum, never_above, never_below, reaches, squared_distances,
    stays_above,
};

const BITS: usize = 80;

fn state(t: f64, p: [f64; 3], v: [f64; 3]) -> State {
    State { t, p, v }
}

fn rational(numerator: i32, denominator: u32) -> RBig {
    RBig::from(numerator) / RBig::from(denominator)
}

fn exactly(numerator: i32, denominator: u32) -> Enclosure {
    let value = rational(numerator, denominator);
    Enclosure {
        low: value.clone(),
        high: value,
    }
}

/// x = t from -2 to 2 in one segment.
fn runner() -> Body {
    Body::from_states(&[
        state(-2.0, [-2.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        state(2.0, [2.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
    ])
}

fn resting(position: [f64; 3]) -> Body {
    Body::at_rest(position, -100.0, 100.0)
}

/// Cubics of absolute time over consecutive intervals, all with the same coefficients.
fn polynomial(knots: &[f64], coefficients: [[f64; 3]; 4]) -> Body {
    let segments: Vec<PolynomialSegment> = knots
        .windows(2)
        .map(|ends| PolynomialSegment {
            start: ends[0],
            end: ends[1],
            origin: 0.0,
            coefficients,
        })
        .collect();
    Body::from_polynomials(&segments)
}

fn all_contacts(a: &Body, b: &Body, window: Option<(f64, f64)>, d: &RBig) -> Vec<Contact> {
    contacts(&squared_distances(a, b, window), d, BITS)
}

/// Whether the enclosure is narrow and contains a square root: low² <= square <= high².
fn encloses_root(enclosure: &Enclosure, square: &RBig) -> bool {
    let (low, high) = (enclosure.low.clone(), enclosure.high.clone());
    let (near, far) = if low >= RBig::ZERO {
        (low.sqr(), high.sqr())
    } else {
        (high.sqr(), low.sqr())
    };
    near < *square && *square < far && enclosure.width() < rational(1, 1 << 30)
}

#[test]
fn floats_are_taken_exactly() {
    let two = RBig::from(2);
    let smallest = Dyadic::from(f64::from_bits(1)).to_rational();
    assert_eq!(smallest, two.pow(-1074));
    assert_eq!(
        Dyadic::from(f64::MIN_POSITIVE).to_rational(),
        two.pow(-1022)
    );
    assert_eq!(Dyadic::from(-0.75).to_rational(), rational(-3, 4));
    assert_eq!(Dyadic::from(-0.0), Dyadic::ZERO);
    let largest = (two.pow(53) - RBig::ONE) * two.pow(971);
    assert_eq!(Dyadic::from(f64::MAX).to_rational(), largest);
}

#[test]
fn each_stretch_of_a_span_has_its_own_minimum() {
    // x = t² - 2, y = 1 + t / 8: near twice, nearer before.
    let coefficients = [
        [-2.0, 1.0, 0.0],
        [0.0, 0.125, 0.0],
        [1.0, 0.0, 0.0],
        [0.0; 3],
    ];
    let a = polynomial(&[-2.0, 2.0], coefficients);
    let found = all_contacts(&a, &resting([0.0; 3]), None, &rational(3, 2));
    assert_eq!(found.len(), 2);
    for contact in &found {
        assert_eq!(contact.minimum.instants.len(), 1);
        let instant = &contact.minimum.instants[0].first;
        assert!(contact.enter.high < instant.low && instant.high < contact.exit.low);
    }
    assert!(found[0].minimum.squared.high < RBig::ONE);
    assert!(found[1].minimum.squared.low > RBig::ONE);
}

#[test]
fn fly_by_of_a_straight_line() {
    let (a, b) = (runner(), resting([0.0, 1.0, 0.0]));
    let least = minimum(&squared_distances(&a, &b, None), BITS).unwrap();
    assert_eq!(least.squared, exactly(1, 1));
    assert_eq!(least.instants.len(), 1);
    assert_eq!(least.instants[0].first, exactly(0, 1));

    // distance² = t² + 1: 5/4 is met at ±3/4, 1 touches at 0, 2 at ±sqrt 3, 1/2 never.
    let crossing = all_contacts(&a, &b, None, &rational(5, 4));
    assert_eq!(crossing.len(), 1);
    assert_eq!(crossing[0].enter, exactly(-3, 4));
    assert_eq!(crossing[0].exit, exactly(3, 4));
    assert_eq!(crossing[0].clip, 0);
    assert_eq!(crossing[0].minimum.squared, exactly(1, 1));
    let touch = all_contacts(&a, &b, None, &rational(1, 1));
    assert_eq!(touch.len(), 1);
    assert_eq!(touch[0].enter, exactly(0, 1));
    assert_eq!(touch[0].exit, exactly(0, 1));
    let wide = all_contacts(&a, &b, None, &rational(2, 1));
    assert!(encloses_root(&wide[0].enter, &rational(3, 1)));
    assert!(encloses_root(&wide[0].exit, &rational(3, 1)));
    assert!(all_contacts(&a, &b, None, &rational(1, 2)).is_empty());
    assert!(all_contacts(&a, &b, None, &rational(-1, 2)).is_empty());
}

#[test]
fn windows_and_domains_clip() {
    let (a, b) = (runner(), resting([0.0, 1.0, 0.0]));
    let d = rational(5, 4);
    let clip = |window| {
        let found = all_contacts(&a, &b, Some(window), &d);
        let ends = |c: &Contact| (c.enter.clone(), c.exit.clone(), c.clip);
        found.iter().map(ends).collect::<Vec<_>>()
    };
    assert_eq!(clip((-0.5, 9.0)), [(exactly(-1, 2), exactly(3, 4), 1)]);
    assert_eq!(clip((-9.0, 0.5)), [(exactly(-3, 4), exactly(1, 2), 2)]);
    assert_eq!(clip((0.0, 0.25)), [(exactly(0, 1), exactly(1, 4), 3)]);
    // The window begins exactly at the margin, and shares nothing else with the contact.
    assert_eq!(clip((0.75, 1.0)), [(exactly(3, 4), exactly(3, 4), 1)]);
    assert_eq!(clip((-1.0, -0.75)), [(exactly(-3, 4), exactly(-3, 4), 2)]);
    assert_eq!(clip((0.5, 0.5)), [(exactly(1, 2), exactly(1, 2), 3)]);
    assert_eq!(clip((1.0, 1.0)), []);
    assert_eq!(clip((3.0, 4.0)), []);
    // Domains that share one instant.
    let later = Body::at_rest([2.0, 1.0, 0.0], 2.0, 3.0);
    let shared = all_contacts(&a, &later, None, &rational(1, 1));
    assert_eq!(shared.len(), 1);
    assert_eq!((&shared[0].enter, shared[0].clip), (&exactly(2, 1), 3));
    assert!(all_contacts(&a, &later, None, &rational(1, 2)).is_empty());
}

#[test]
fn touching_at_a_third_is_found_exactly() {
    // x = 3 t - 1 has its root at 1/3, which no bisection meets.
    let a = polynomial(
        &[0.0, 1.0],
        [[-1.0, 2.0, 0.0], [3.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
    );
    let b = resting([0.0; 3]);
    let touch = all_contacts(&a, &b, None, &rational(2, 1));
    assert_eq!(touch.len(), 1);
    assert!(touch[0].enter.contains(&rational(1, 3)));
    assert_eq!(touch[0].enter, touch[0].exit);
    assert_eq!(touch[0].minimum.squared, exactly(4, 1));
    // A hair less and nothing is left, a hair more and it is a stretch around 1/3.
    let hair = RBig::ONE / RBig::from(10).pow(60);
    assert!(all_contacts(&a, &b, None, &(rational(2, 1) - &hair)).is_empty());
    let stretch = contacts(
        &squared_distances(&a, &b, None),
        &(rational(2, 1) + &hair),
        300,
    );
    assert_eq!(stretch.len(), 1);
    assert!(stretch[0].enter.high < rational(1, 3) && rational(1, 3) < stretch[0].exit.low);
}

#[test]
fn docking_and_triple_roots() {
    // x = (t - 1/4)², then (t - 1/4)³: distance² has a root of order 4 and 6.
    let docking = [
        [0.0625, 0.0, 0.0],
        [-0.5, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0; 3],
    ];
    let triple = [
        [-0.015_625, 0.0, 0.0],
        [0.1875, 0.0, 0.0],
        [-0.75, 0.0, 0.0],
        [1.0, 0.0, 0.0],
    ];
    let b = resting([0.0; 3]);
    for coefficients in [docking, triple] {
        let a = polynomial(&[0.0, 1.0], coefficients);
        let least = minimum(&squared_distances(&a, &b, None), BITS).unwrap();
        assert_eq!(least.squared, exactly(0, 1));
        assert_eq!(least.instants[0].first, exactly(1, 4));
        let touch = all_contacts(&a, &b, None, &RBig::ZERO);
        assert_eq!(touch.len(), 1);
        assert_eq!(
            (&touch[0].enter, &touch[0].exit),
            (&exactly(1, 4), &exactly(1, 4))
        );
    }
}

#[test]
fn touching_from_within_does_not_divide() {
    // x = 4 - t² on -3..3: distance 4 at 0 from within, met again at t² = 8.
    let a = polynomial(
        &[-3.0, 3.0],
        [[4.0, 0.0, 0.0], [0.0; 3], [-1.0, 0.0, 0.0], [0.0; 3]],
    );
    let found = all_contacts(&a, &resting([0.0; 3]), None, &rational(4, 1));
    assert_eq!(found.len(), 1);
    assert!(encloses_root(&found[0].enter, &rational(8, 1)));
    assert!(encloses_root(&found[0].exit, &rational(8, 1)));
    // Both zeros at ±2 are minima.
    assert_eq!(found[0].minimum.squared, exactly(0, 1));
    let firsts: Vec<&Enclosure> = found[0].minimum.instants.iter().map(|s| &s.first).collect();
    assert_eq!(firsts.len(), 2);
    assert!(firsts[0].contains(&rational(-2, 1)) && firsts[1].contains(&rational(2, 1)));
}

#[test]
fn ties_of_irrational_values_are_exact() {
    // distance² = z (z - 3)² + (z - 2)² with z = t²: least at z = (5 + sqrt 10) / 3, on both sides.
    let coefficients = [
        [-2.0, 0.0, 0.0],
        [0.0, -3.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let b = resting([0.0; 3]);
    for knots in [
        vec![-2.0, 2.0],
        vec![-2.0, 0.5, 2.0],
        vec![-2.0, -0.25, 0.0, 1.0, 2.0],
    ] {
        let a = polynomial(&knots, coefficients);
        let least = minimum(&squared_distances(&a, &b, None), BITS).unwrap();
        assert_eq!(least.instants.len(), 2, "{knots:?}");
        let (first, second) = (&least.instants[0].first, &least.instants[1].first);
        assert!(first.high < RBig::ZERO && second.low > RBig::ZERO);
        // (3 z - 5)² = 10.
        let square = |t: &RBig| (t.sqr() * RBig::from(3) - RBig::from(5)).sqr();
        assert!(square(&second.low) < RBig::from(10) && square(&second.high) > RBig::from(10));
        assert!(square(&first.low) > RBig::from(10) && square(&first.high) < RBig::from(10));
    }
    // Tilted by 2^-400, far below every enclosure that is tried first, only one is left.
    let mut tilted = coefficients;
    tilted[0][2] = 1.0;
    tilted[1][2] = 2f64.powi(-400);
    let a = polynomial(&[-2.0, 0.0, 2.0], tilted);
    let least = minimum(&squared_distances(&a, &b, None), BITS).unwrap();
    assert_eq!(least.instants.len(), 1);
    assert!(least.instants[0].last.high < RBig::ZERO);
}

#[test]
fn constant_and_coincident_motion() {
    let a = runner();
    let twin = runner();
    let beside = runner().offset([0.0, 3.0, 4.0]);
    let together = minimum(&squared_distances(&a, &twin, None), BITS).unwrap();
    assert_eq!(together.squared, exactly(0, 1));
    assert_eq!(together.instants.len(), 1);
    assert_eq!(together.instants[0].first, exactly(-2, 1));
    assert_eq!(together.instants[0].last, exactly(2, 1));
    let resting = all_contacts(&a, &twin, None, &RBig::ZERO);
    assert_eq!(resting.len(), 1);
    assert_eq!(
        (&resting[0].enter, &resting[0].exit),
        (&exactly(-2, 1), &exactly(2, 1))
    );
    assert_eq!(resting[0].clip, 3);

    let at_margin = all_contacts(&a, &beside, None, &rational(5, 1));
    assert_eq!(at_margin.len(), 1);
    assert_eq!(at_margin[0].clip, 3);
    assert_eq!(at_margin[0].minimum.squared, exactly(25, 1));
    let hair = RBig::ONE / RBig::from(10).pow(60);
    assert!(all_contacts(&a, &beside, None, &(rational(5, 1) - &hair)).is_empty());
    assert_eq!(
        all_contacts(&a, &beside, None, &(rational(5, 1) + hair)).len(),
        1
    );
}

#[test]
fn stretches_join_across_knots() {
    // The same straight line cut at many knots, also exactly where it touches and crosses.
    let knots = [-2.0, -0.75, -0.5, 0.0, 0.1, 0.75, 2.0];
    let states: Vec<State> = knots
        .iter()
        .map(|&t| state(t, [t, 0.0, 0.0], [1.0, 0.0, 0.0]))
        .collect();
    let (a, b) = (Body::from_states(&states), resting([0.0, 1.0, 0.0]));
    let distances = squared_distances(&a, &b, None);
    assert_eq!(distances.len(), 6);
    let least = minimum(&distances, BITS).unwrap();
    assert_eq!(least.instants.len(), 1);
    assert_eq!(least.instants[0].first, exactly(0, 1));
    let found = contacts(&distances, &rational(5, 4), BITS);
    assert_eq!(found.len(), 1);
    assert_eq!(
        (&found[0].enter, &found[0].exit),
        (&exactly(-3, 4), &exactly(3, 4))
    );
    assert_eq!(found[0].minimum.instants.len(), 1);
    let touch = contacts(&distances, &rational(1, 1), BITS);
    assert_eq!(touch.len(), 1);
    assert_eq!(
        (&touch[0].enter, &touch[0].exit),
        (&exactly(0, 1), &exactly(0, 1))
    );
}

#[test]
fn two_stretches_and_a_plateau() {
    // Comes to rest at distance 1, stays, and leaves: the plateau is one stretch of minimisers.
    let a = Body::from_states(&[
        state(0.0, [5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        state(4.0, [1.0, 0.0, 0.0], [0.0; 3]),
        state(6.0, [1.0, 0.0, 0.0], [0.0; 3]),
        state(7.0, [1.0, 0.0, 0.0], [0.0; 3]),
        state(9.0, [3.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
        state(11.0, [1.0, 0.0, 0.0], [0.0; 3]),
    ]);
    let b = resting([0.0; 3]);
    let distances = squared_distances(&a, &b, None);
    let least = minimum(&distances, BITS).unwrap();
    assert_eq!(least.squared, exactly(1, 1));
    let ends: Vec<_> = least.instants.iter().map(|s| (&s.first, &s.last)).collect();
    assert_eq!(
        ends,
        [
            (&exactly(4, 1), &exactly(7, 1)),
            (&exactly(11, 1), &exactly(11, 1))
        ]
    );
    let found = contacts(&distances, &RBig::ONE, BITS);
    let ends: Vec<_> = found.iter().map(|c| (&c.enter, &c.exit, c.clip)).collect();
    assert_eq!(
        ends,
        [
            (&exactly(4, 1), &exactly(7, 1), 0),
            (&exactly(11, 1), &exactly(11, 1), 2)
        ]
    );
}

#[test]
fn beyond_the_states() {
    let a = Body::from_states(&[
        state(0.0, [0.0; 3], [0.0; 3]),
        state(1.0, [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]),
    ]);
    // The cubic is s³ here: 3 s² - 2 s³ + 3 (s³ - s²).
    let b = Body::at_rest([8.0, 0.0, 0.0], -10.0, 10.0);
    let at_zero = |outside| {
        let body = a.clone().extended(outside, -10.0, 10.0);
        let least = minimum(&squared_distances(&body, &b, None), BITS).unwrap();
        (least.squared, least.instants[0].first.clone())
    };
    assert_eq!(at_zero(Outside::Absent), (exactly(49, 1), exactly(1, 1)));
    let (squared, instant) = at_zero(Outside::Extrapolate);
    assert!(squared == exactly(0, 1) && instant.contains(&rational(2, 1)));
    // Coasting from x = 1 with 3 m/s meets x = 8 at 1 + 7/3.
    let (squared, instant) = at_zero(Outside::Coast);
    assert!(squared == exactly(0, 1) && instant.contains(&rational(10, 3)));
}

#[test]
fn claims_at_equality() {
    let (a, b) = (runner(), resting([0.0, 1.0, 0.0]));
    let distance = &squared_distances(&a, &b, None)[0];
    let one = Dyadic::from(1);
    let above = Dyadic::from(1.0 + f64::EPSILON);
    let below = Dyadic::from(1.0 - f64::EPSILON);
    assert!(never_below(distance, &one) && !stays_above(distance, &one));
    assert!(stays_above(distance, &below) && never_below(distance, &below));
    assert!(!never_below(distance, &above));
    assert!(reaches(distance, &one) && reaches(distance, &above) && !reaches(distance, &below));
    assert!(is_at_most(distance, &Dyadic::from(0.5), &one));
    assert!(!is_at_most(distance, &Dyadic::from(0.25), &one));
    assert!(!never_above(distance, &Dyadic::from(2)));
    assert!(never_above(distance, &Dyadic::from(2.25)));
    // The largest distance is sqrt 5, between these two neighbours.
    let root = 5f64.sqrt();
    let signs = [root.next_down(), root, root.next_up()].map(|r| never_above(distance, &r.into()));
    assert!(!signs[0] && signs[2]);
}

#[test]
fn restricted_polynomials_keep_their_signs() {
    let distance = &squared_distances(&runner(), &resting([0.0, 1.0, 0.0]), None)[0];
    let excess = distance.minus(&rational(25, 16));
    assert_eq!(isolate(&excess).len(), 2);
    // u = 0.25..0.5 is t = -1..0: one root, at -3/4.
    let part = excess.over(&Dyadic::from(0.25), &Dyadic::from(0.25));
    assert_eq!(isolate(&part).len(), 1);
    assert_eq!(least_sign(&part), -1);
    let outer = excess.over(&Dyadic::from(0.75), &Dyadic::from(0.25));
    assert_eq!(least_sign(&outer), 1);
}
