//! Proven errors of functions of time.

use crate::motions::{Case, all, bend, bend_bound, chirp, chirp_bound};
use dashu::rational::RBig;
use nearmiss::{Error, FitOptions, Trajectory, Window};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Fits all motions whose fourth derivative is bounded, and looks at so many instants of each fit.
fn assert_proofs(instants: u32) {
    let mut proven = 0;
    for case in all() {
        let Some(bound) = case.fourth_derivative else {
            continue;
        };
        let options = FitOptions::default().with_fourth_derivative(bound);
        for tolerance in case.tolerances {
            let fit =
                Trajectory::fit_with(&case.motion, case.window(), tolerance, &options).unwrap();
            assert!(fit.is_proven() && fit.error() <= tolerance);
            let share = case.assert_error(&fit, instants, 12);
            println!(
                "{} within {tolerance} m: {} knots, error {:e} m, of which {share:.3} seen",
                case.name,
                fit.knot_count(),
                fit.error()
            );
            proven += 1;
        }
    }
    assert_eq!(proven, 10);
}

#[test]
fn no_proven_error_is_exceeded() {
    assert_proofs(20_000);
}

#[test]
#[ignore = "a campaign of some seconds: 10 million instants"]
fn no_proven_error_is_exceeded_at_a_million_instants() {
    assert_proofs(1_000_000);
}

/// One hard bend, or ever faster oscillations: the knots lie where they are needed, and the proof holds.
#[test]
fn bounds_by_window_are_never_violated_and_need_few_knots() {
    type Bound = fn(Window) -> f64;
    let cases: [(_, _, _, _, Bound); 3] = [
        ("bend", bend(0.1), [-10.0, 10.0], [1e-2, 1e-5], |window| {
            bend_bound(0.1, window)
        }),
        // The corner is cut by 4 mm: coarser tolerances do not see a bend.
        (
            "hard bend",
            bend(0.001),
            [-7.0, 12.0],
            [1e-4, 1e-6],
            |window| bend_bound(0.001, window),
        ),
        ("chirp", chirp(0.2), [0.0, 25.0], [1e-2, 1e-5], |window| {
            chirp_bound(0.2, window.end()) * (1.0 + 1e-12)
        }),
    ];
    for (name, motion, window, tolerances, bound) in cases {
        let case = Case {
            name,
            motion,
            window,
            tolerances,
            fourth_derivative: Some(bound(Window::new(window[0], window[1]).unwrap())),
        };
        let by_window = FitOptions::default().with_fourth_derivative_over(&bound);
        for tolerance in case.tolerances {
            let fit = Trajectory::fit_with(&case.motion, case.window(), tolerance, &by_window);
            let fit = fit.unwrap();
            assert!(fit.is_proven() && fit.error() <= tolerance);
            let share = case.assert_error(&fit, 20_000, 13);
            let (knots, fewest) = (fit.knot_count(), case.fewest_knots(tolerance));
            println!(
                "{name} within {tolerance} m: {knots} knots, {fewest} at the least, error {:e} m, of which \
                 {share:.3} seen",
                fit.error()
            );
            assert!(share > 0.5, "{name}: {share}");
            assert!(
                knots as f64 <= 1.3 * fewest as f64,
                "{name}: {knots} {fewest}"
            );
        }
        // With the one bound for the whole window a bend of a millisecond is out of reach.
        let constant = FitOptions::default()
            .with_fourth_derivative(case.fourth_derivative.unwrap())
            .with_max_knots(10_000);
        let even = Trajectory::fit_with(&case.motion, case.window(), 1e-5, &constant);
        assert_eq!(
            name == "hard bend",
            matches!(even, Err(Error::FitKnots { .. })),
            "{even:?}"
        );
    }
}

#[test]
fn bounds_by_window_that_are_wrong_or_unknown() {
    let window = Window::new(-3.0, 4.0).unwrap();
    let fit = |bound: &dyn Fn(Window) -> f64| {
        let options = FitOptions::default().with_fourth_derivative_over(bound);
        Trajectory::fit_with(bend(0.5), window, 1e-3, &options)
    };
    for wrong in [-1.0, f64::NAN] {
        let found = fit(&|window| if window.contains(0.3) { wrong } else { 1e3 });
        assert!(
            matches!(found, Err(Error::FitOption { value, .. }) if value.to_bits() == wrong.to_bits()),
            "{found:?}"
        );
    }
    let found = fit(&|window| bend_bound(0.5, window) / 8.0);
    assert!(matches!(found, Err(Error::FitBound { .. })), "{found:?}");
    let found = fit(&|_| f64::INFINITY);
    assert!(
        matches!(found, Err(Error::FitUnreachable { .. })),
        "{found:?}"
    );
    // Known of short windows only.
    let short = fit(&|window| {
        if window.end() - window.start() > 0.5 {
            f64::INFINITY
        } else {
            bend_bound(0.5, window)
        }
    });
    assert!(short.unwrap().knot_count() > 14);
}

/// Straight motion far away, whose values are rounded twice: nothing but rounding is left of the error.
#[test]
fn rounding_is_part_of_the_proof() {
    let number = |x: f64| RBig::try_from(x).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let mut exceeded = 0;
    for _ in 0..2_000 {
        let (place, speed) = (rng.random_range(1e9..2e9), rng.random_range(-0.1..0.1));
        let start = rng.random_range(0.0..1e3);
        let motion = |t: f64| ([place + speed * t, 0.0, 0.0], [speed, 0.0, 0.0]);
        let window = Window::new(start, start + 1.0).unwrap();
        let straight = FitOptions::default().with_fourth_derivative(0.0);
        let fit = |options| Trajectory::fit_with(motion, window, 1e-3, &options).unwrap();
        let (rounded, exact) = (fit(straight.with_ulps(1.5)), fit(straight.with_ulps(0.0)));
        assert_eq!(rounded.knot_count(), 2);
        for _ in 0..10 {
            let time = rng.random_range(start..start + 1.0);
            let position = rounded.trajectory.position(time).unwrap();
            let difference = number(position.x) - number(place) - number(speed) * number(time);
            let is_within = |error: f64| {
                let error = number(error);
                -&error <= difference && difference <= error
            };
            assert!(is_within(rounded.error()));
            exceeded += u32::from(!is_within(exact.error()));
        }
    }
    // Without the rounding of the motion's own values there is no proof.
    assert!(exceeded > 100, "{exceeded}");
}

/// A bound that is too small, and a velocity in other units.
#[test]
fn contradictions_are_refused() {
    let circle = |t: f64| ([t.cos(), t.sin(), 0.0], [-t.sin(), t.cos(), 0.0]);
    let window = Window::new(0.0, 9.0).unwrap();
    let fit = |bound| {
        let options = FitOptions::default().with_fourth_derivative(bound);
        Trajectory::fit_with(circle, window, 1e-3, &options)
    };
    assert!(fit(1.0).is_ok());
    assert!(matches!(fit(0.3), Err(Error::FitBound { .. })));
    let wrong = |t: f64| {
        (
            [t.cos(), t.sin(), 0.0],
            [-t.sin() * 60.0, t.cos() * 60.0, 0.0],
        )
    };
    let options = FitOptions::default().with_fourth_derivative(1.0);
    let found = Trajectory::fit_with(wrong, window, 1e-3, &options);
    assert!(matches!(found, Err(Error::FitBound { .. })), "{found:?}");
}

/// A bound that is hardly more than 0 counts over 1e90 s.
#[test]
fn no_bound_underflows() {
    let options = FitOptions::default().with_fourth_derivative(1e-322);
    let window = Window::new(0.0, 1e90).unwrap();
    let rest = |_| ([0.0; 3], [0.0; 3]);
    let fit = Trajectory::fit_with(rest, window, 1.0, &options);
    assert!(matches!(fit, Err(Error::FitKnots { .. })), "{fit:?}");
}
