//! Velocities that are not the derivative of the position end a fit early; no other velocity does.

use crate::motions::{Case, Motion, all};
use nearmiss::glam::{DVec3, Vec3Swizzles};
use nearmiss::{Error, FitOptions, Quantity, Trajectory};

/// Makes a wrong velocity from a position and the velocity there.
type Mistake = fn(DVec3, DVec3) -> DVec3;

const MISTAKES: [(&str, Mistake); 7] = [
    ("minutes", |_, velocity| 60.0 * velocity),
    ("kilometres", |_, velocity| 1e-3 * velocity),
    ("another sign", |_, velocity| -velocity),
    ("none", |_, _| DVec3::ZERO),
    ("a frame that turns", |position, velocity| {
        velocity - (7.3e-5 * DVec3::Z).cross(position)
    }),
    ("axes in another order", |_, velocity| velocity.zxy()),
    ("a drift", |_, velocity| velocity + 0.1 * DVec3::Z),
];

/// Fits a motion; returns the knots, or the error, and how often the motion was asked.
fn fit(motion: &Motion, case: &Case, tolerance: f64) -> (Result<usize, Error>, u32) {
    let mut calls = 0;
    let counted = |time: f64| {
        calls += 1;
        motion(time)
    };
    let options = FitOptions::default().with_max_knots(20_000);
    let found = Trajectory::fit_with(counted, case.window(), tolerance, &options);
    (found.map(|fit| fit.knot_count()), calls)
}

#[test]
fn wrong_velocities_are_named_early() {
    let mut refused = 0;
    for case in [
        "circle",
        "low orbit",
        "ellipse",
        "chirp",
        "jumps",
        "far circle",
    ] {
        let case = all().into_iter().find(|known| known.name == case).unwrap();
        let [start, end] = case.window;
        for (mistake, change) in MISTAKES {
            let right = all().into_iter().find(|known| known.name == case.name);
            let right = right.unwrap().motion;
            let told: Motion = Box::new(move |time| {
                let (position, velocity) = right(time);
                (position, change(position, velocity))
            });
            // Some thousand knots would be needed.
            let off = |share: f64| {
                let time = start + share * (end - start);
                told(time).1.distance((case.motion)(time).1)
            };
            let off = (0..64).map(|k| off(f64::from(k) / 64.0)).sum::<f64>() / 64.0;
            let tolerance = off * (end - start) / 8.0 / 4000.0;
            let place = (case.motion)(start).0.length();
            // The drift is nothing beside the rounding of the far circle.
            if tolerance < 1e-13 * place {
                continue;
            }
            let (found, calls) = fit(&told, &case, tolerance);
            let Err(Error::FitVelocity {
                time,
                quantity: Quantity::Velocity(axis),
                told: value,
                found,
            }) = found
            else {
                panic!("{} {mistake}: {found:?}", case.name)
            };
            // Found at 256 knots: the twentieth part of what the fit would ask for.
            assert!(calls < 6000, "{} {mistake}: {calls}", case.name);
            assert!(case.window().contains(time));
            let (given, right) = (told(time).1[axis], (case.motion)(time).1[axis]);
            let near = 0.3 * (given - right).abs();
            assert!((value - given).abs() <= near && (found - right).abs() <= near);
            refused += 1;
        }
    }
    assert_eq!(refused, 6 * MISTAKES.len() - 1);
}

/// Motions that need many knots, for reasons of their own.
#[test]
fn right_velocities_are_never_refused() {
    let motion = |motion: fn(f64) -> (DVec3, DVec3)| -> Motion { Box::new(motion) };
    let extra = [
        // A corner every 0.02 s.
        (
            "corners",
            motion(|t| {
                let number = (50.0 * t).floor();
                let phase = 50.0 * t - number;
                let sign = if (0.5 * number).fract() < 0.25 {
                    1.0
                } else {
                    -1.0
                };
                let height = if sign > 0.0 { phase } else { 1.0 - phase };
                (
                    DVec3::new(t, height, 0.0),
                    DVec3::new(1.0, 50.0 * sign, 0.0),
                )
            }),
            [1e-3, 1e-9],
        ),
        // Waves within waves: the finest of 3 mm within 0.2 ms.
        (
            "waves",
            motion(|t| {
                let wave = |rate: f64| {
                    (
                        DVec3::new(t, (rate * t).sin(), 0.0) / rate.sqrt(),
                        DVec3::new(1.0, rate * (rate * t).cos(), 0.0) / rate.sqrt(),
                    )
                };
                let waves = [1.0, 31.0, 1009.0, 30_011.0].map(wave);
                (
                    waves.iter().map(|wave| wave.0).sum(),
                    waves.iter().map(|wave| wave.1).sum(),
                )
            }),
            [1e-2, 1e-6],
        ),
        // Values in f32.
        (
            "f32",
            motion(|t| {
                let (sin, cos) = t.sin_cos();
                (
                    DVec3::new(1e3 * sin, 0.0, 0.0).as_vec3().as_dvec3(),
                    DVec3::new(1e3 * cos, 0.0, 0.0).as_vec3().as_dvec3(),
                )
            }),
            [1e-3, 3e-4],
        ),
        // Trembling by less than the tolerance, at whole multiples of what a fit looks at.
        (
            "trembling",
            motion(|t| {
                let (sin, cos) = (1024.0 * std::f64::consts::TAU * t).sin_cos();
                (
                    DVec3::new(1e-3 * sin, t * t, 0.0),
                    DVec3::new(1.024 * std::f64::consts::TAU * cos, 2.0 * t, 0.0),
                )
            }),
            [1e-3, 1e-5],
        ),
    ];
    let extra = extra.map(|(name, motion, tolerances)| Case {
        name,
        motion,
        window: [0.0, 10.0],
        tolerances,
        fourth_derivative: None,
    });
    let mut many = 0;
    for case in all().into_iter().chain(extra) {
        for factor in [1.0, 1e-3, 1e-6] {
            for tolerance in case.tolerances {
                let (found, _) = fit(&case.motion, &case, factor * tolerance);
                assert!(
                    !matches!(found, Err(Error::FitVelocity { .. })),
                    "{}: {found:?}",
                    case.name
                );
                many += u32::from(match found {
                    Ok(knots) => knots > 256,
                    other => matches!(other, Err(Error::FitKnots { .. })),
                });
            }
        }
    }
    assert!(many >= 30, "{many}");
}

/// A velocity that is off by less than matters: the pieces are short because the motion needs that.
#[test]
fn slight_errors_are_covered() {
    let case = all()
        .into_iter()
        .find(|case| case.name == "circle")
        .unwrap();
    let right = all()
        .into_iter()
        .find(|case| case.name == "circle")
        .unwrap()
        .motion;
    let told: Motion = Box::new(move |time| {
        let (position, velocity) = right(time);
        (position, velocity + 6e-7 * DVec3::Z)
    });
    let (found, _) = fit(&told, &case, 1e-7);
    assert!(found.clone().is_ok_and(|knots| knots > 512), "{found:?}");
}
