//! Input that cannot be right, and motions that cannot be followed.

use nearmiss::glam::DVec3;
use nearmiss::{Error, Fit, FitOptions, Quantity, TimeBase, Trajectory, Window};

fn straight(time: f64) -> (DVec3, DVec3) {
    (time * DVec3::X, DVec3::X)
}

fn window() -> Window {
    Window::new(0.0, 10.0).unwrap()
}

fn refused(fit: Result<Fit, Error>) -> Error {
    fit.map(|fit| fit.trajectory.knots().to_vec()).unwrap_err()
}

#[test]
fn tolerances() {
    for metres in [0.0, -1.0, f64::INFINITY, 2e300] {
        let expected = Error::FitTolerance { metres };
        assert_eq!(
            refused(Trajectory::fit(straight, window(), metres)),
            expected
        );
        let polynomials = [[DVec3::X; 8]];
        let base = TimeBase::SegmentLocal;
        let fit = Trajectory::fit_polynomials(&[0.0, 1.0], &polynomials, base, metres);
        assert_eq!(refused(fit), expected);
    }
    let found = refused(Trajectory::fit(straight, window(), f64::NAN));
    assert!(matches!(found, Error::FitTolerance { metres } if metres.is_nan()));
}

#[test]
fn windows() {
    for (start, end) in [
        (0.0, f64::INFINITY),
        (f64::NEG_INFINITY, 0.0),
        (1.0, 1.0),
        (0.0, 2e300),
    ] {
        let window = Window::new(start, end).unwrap();
        let found = refused(Trajectory::fit(straight, window, 0.1));
        assert_eq!(found, Error::FitWindow { start, end });
    }
}

/// Windows with hardly an instant between their ends.
#[test]
fn shortest_windows() {
    let least = f64::from_bits(1);
    for start in [0.0, -least, 1.0] {
        for length in [1.0, 2.0, 30.0, 500.0, 513.0, 4e4] {
            let end = f64::max(start + length * least, start.next_up());
            let window = Window::new(start, end).unwrap();
            let constant = |_: f64| (DVec3::X, DVec3::ZERO);
            let bounded = FitOptions::default().with_fourth_derivative(0.0);
            for options in [FitOptions::default(), bounded] {
                let fit = Trajectory::fit_with(constant, window, 0.01, &options).unwrap();
                assert_eq!(fit.trajectory.knots(), [start, end]);
                match Trajectory::fit_with(straight, window, 0.01, &options) {
                    Ok(fit) => assert_eq!(fit.trajectory.knots(), [start, end]),
                    // Numbers of a cubic so short are out of range, unless it rests.
                    Err(error) => {
                        assert!(start < 1.0 && matches!(error, Error::FitUnreachable { .. }));
                    }
                }
            }
        }
    }
}

#[test]
fn options() {
    let none = FitOptions::default();
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        for options in [none.with_fourth_derivative(value), none.with_ulps(value)] {
            let found = refused(Trajectory::fit_with(straight, window(), 0.1, &options));
            assert!(matches!(found, Error::FitOption { .. }), "{found}");
        }
    }
}

#[test]
fn values_of_the_motion() {
    for bad in [f64::NAN, f64::INFINITY, -2e300] {
        let position = |t: f64| ([t, if t > 7.0 { bad } else { 0.0 }, 0.0], DVec3::X);
        match refused(Trajectory::fit(position, window(), 0.1)) {
            Error::Motion {
                time,
                quantity: Quantity::Position(1),
                value,
            } => assert!(time > 7.0 && value.to_bits() == bad.to_bits()),
            other => panic!("{other}"),
        }
        let velocity = |t: f64| ([t, 0.0, 0.0], [1.0, 0.0, if t < 0.1 { bad } else { 0.0 }]);
        match refused(Trajectory::fit(velocity, window(), 0.1)) {
            Error::Motion {
                time,
                quantity: Quantity::Velocity(2),
                ..
            } => assert!(time < 0.1),
            other => panic!("{other}"),
        }
    }
}

#[test]
fn tolerances_below_rounding() {
    let far = |t: f64| ([1e9 + t.sin(), 0.0, 0.0], [t.cos(), 0.0, 0.0]);
    let found = refused(Trajectory::fit(far, window(), 1e-9));
    assert!(
        matches!(found, Error::FitUnreachable { reached, .. } if reached > 1e-9),
        "{found}"
    );
    let polynomial = [
        DVec3::X,
        DVec3::ZERO,
        DVec3::ZERO,
        DVec3::ZERO,
        1e9 * DVec3::X,
    ];
    let base = TimeBase::SegmentLocal;
    let found = refused(Trajectory::fit_polynomials(
        &[0.0, 1.0],
        &[polynomial],
        base,
        1e-9,
    ));
    assert!(matches!(found, Error::FitUnreachable { .. }), "{found}");
}

/// Only towards the end of the window the motion is so far away that its rounding exceeds the tolerance.
#[test]
fn rounding_is_looked_at_first() {
    let fit = |end: f64| {
        let mut calls = 0;
        let leaving = |t: f64| {
            calls += 1;
            let (sin, cos) = (100.0 * t).sin_cos();
            let far = [1e9 * t.powi(20), 2e10 * t.powi(19)];
            (
                [far[0] + sin, cos, 0.0],
                [far[1] + 100.0 * cos, -100.0 * sin, 0.0],
            )
        };
        let fit = Trajectory::fit(leaving, Window::new(0.0, end).unwrap(), 1e-7);
        (fit, calls)
    };
    let (found, calls) = fit(1.0);
    let found = refused(found);
    let is_named = matches!(found, Error::FitUnreachable { time, reached, .. } if time > 0.8 && reached > 1e-7);
    assert!(is_named && calls < 70, "{found} {calls}");
    // Up to there it takes many knots.
    let (found, calls) = fit(0.8);
    assert!(found.is_ok() && calls > 10_000, "{calls}");
}

#[test]
fn positions_that_jump() {
    let jump = |t: f64| ([t, if t < 4.3 { 0.0 } else { 1.0 }, 0.0], DVec3::X);
    match refused(Trajectory::fit(jump, window(), 0.1)) {
        Error::FitUnreachable { time, .. } => assert!((time - 4.3).abs() < 1e-6, "{time}"),
        other => panic!("{other}"),
    }
}

#[test]
fn more_knots_than_allowed() {
    let wild = |t: f64| {
        (
            [(1e3 * t).sin(), 0.0, 0.0],
            [1e3 * (1e3 * t).cos(), 0.0, 0.0],
        )
    };
    let options = FitOptions::default().with_max_knots(100);
    let found = refused(Trajectory::fit_with(wild, window(), 1e-6, &options));
    assert!(
        matches!(found, Error::FitKnots { limit: 100, time } if time < 1.0),
        "{found}"
    );
}

#[test]
fn polynomials() {
    let fit = |knots: &[f64], polynomials: &[[DVec3; 8]]| {
        refused(Trajectory::fit_polynomials(
            knots,
            polynomials,
            TimeBase::SegmentLocal,
            0.1,
        ))
    };
    let good = [DVec3::X; 8];
    assert_eq!(fit(&[0.0], &[]), Error::TooFewStates { count: 1 });
    let expected = Error::SegmentCount {
        knots: 3,
        segments: 1,
    };
    assert_eq!(fit(&[0.0, 1.0, 2.0], &[good]), expected);
    assert!(matches!(
        fit(&[0.0, 1.0, 1.0], &[good; 2]),
        Error::TimeNotIncreasing { knot: 2, .. }
    ));
    let mut bad = good;
    bad[1].z = f64::NAN;
    match fit(&[0.0, 1.0, 2.0], &[good, bad]) {
        Error::NotFinite { knot, quantity, .. } => {
            assert_eq!(
                (knot, quantity),
                (1, Quantity::Coefficient { power: 6, axis: 2 })
            );
        }
        other => panic!("{other}"),
    }
    bad[1].z = 1e200;
    assert!(matches!(
        fit(&[0.0, 1e20], &[bad]),
        Error::OutOfRange { knot: 0, .. }
    ));
}

/// Both ends of the range of f64: a typed answer, or a fit.
#[test]
fn extremes_end() {
    for size in [1e-320, 1e-200, 1e-30, 1.0, 1e30, 1e200, 1e299] {
        for length in [1e-300, 1e-10, 1.0, 1e10, 1e299] {
            let motion = |t: f64| {
                let s = t / length;
                (
                    [size * s.sin(), 0.0, 0.0],
                    [size / length * s.cos(), 0.0, 0.0],
                )
            };
            let window = Window::new(0.0, length).unwrap();
            for tolerance in [1e-300, 1e-3, 1e290] {
                let options = FitOptions::default().with_max_knots(2000);
                for options in [options, options.with_fourth_derivative(1e-5)] {
                    if let Ok(fit) = Trajectory::fit_with(motion, window, tolerance, &options) {
                        assert!(fit.error() <= tolerance);
                    }
                }
                let polynomial = [size * DVec3::X; 6];
                let base = TimeBase::SegmentLocal;
                let knots = [0.0, length];
                if size < 1e200
                    && let Ok(fit) = Trajectory::fit_polynomials(
                        &knots,
                        &[polynomial],
                        base,
                        tolerance.max(1e-6 * size),
                    )
                {
                    assert!(fit.is_proven());
                }
            }
        }
    }
}
