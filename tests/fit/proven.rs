//! Proven errors of functions of time.

use crate::motions::all;
use dashu::rational::RBig;
use nearmiss::{Error, FitOptions, Trajectory, Window};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

#[test]
fn no_proven_error_is_exceeded() {
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
            let share = case.assert_error(&fit, 20_000, 12);
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
