//! Estimated errors.

use crate::motions::all;
use nearmiss::glam::DVec3;
use nearmiss::{Error, Trajectory};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Fits all motions, and asserts their errors at random instants.
fn assert_errors(instants: u32) {
    for case in all() {
        for tolerance in case.tolerances {
            let fit = Trajectory::fit(&case.motion, case.window(), tolerance).unwrap();
            assert!(!fit.is_proven() && fit.error() <= tolerance);
            let share = case.assert_error(&fit, instants, 11);
            println!(
                "{} within {tolerance} m: {} knots, error {:e} m, of which {share:.3} seen",
                case.name,
                fit.knot_count(),
                fit.error()
            );
        }
    }
}

#[test]
fn no_error_is_exceeded() {
    assert_errors(20_000);
}

#[test]
#[ignore = "a campaign of some seconds: 20 million instants"]
fn no_error_is_exceeded_at_a_million_instants() {
    assert_errors(1_000_000);
}

#[test]
fn even_spacing_needs_almost_as_many_knots() {
    for case in all() {
        for tolerance in case.tolerances {
            let fit = Trajectory::fit(&case.motion, case.window(), tolerance).unwrap();
            let knots = fit.knot_count();
            // 1.3 times as many are allowed.
            let limit = (knots * 10).div_ceil(13);
            if let Some(uniform) = case.uniform_knots(tolerance, limit) {
                panic!(
                    "{} within {tolerance} m: {knots} knots, evenly {uniform}",
                    case.name
                );
            }
        }
    }
}

/// Far from the origin rounding is a large part of small tolerances. Down to them knots are few and no error is
/// exceeded; below them a fit is refused.
#[test]
fn tolerances_down_to_rounding() {
    let known = |name| all().into_iter().find(|case| case.name == name).unwrap();
    let cases = ["chirp", "bang-bang", "jumps", "legs"].map(|name| known(name).far_away());
    let mut fitted = 0;
    for case in [known("far circle"), known("low orbit")]
        .into_iter()
        .chain(cases)
    {
        let finest = 2.5e-15 * (case.motion)(case.window[0]).0.length();
        let mut tolerance = 1e3 * finest;
        while tolerance > 0.5 * finest {
            match Trajectory::fit(&case.motion, case.window(), tolerance) {
                Ok(fit) => {
                    let knots = fit.knot_count();
                    let uniform = case.uniform_knots(tolerance, (knots * 10).div_ceil(13));
                    let name = case.name;
                    assert_eq!(uniform, None, "{name} within {tolerance} m: {knots} knots");
                    case.assert_error(&fit, 2_000, 14);
                    fitted += 1;
                }
                Err(error) => {
                    let is_refused = matches!(error, Error::FitUnreachable { .. });
                    assert!(
                        is_refused && tolerance < 1.01 * finest,
                        "{tolerance} {error}"
                    );
                }
            }
            tolerance *= 0.95;
        }
    }
    assert!(fitted > 6 * 130, "{fitted}");
}

/// Values are off by as many units of the last place as a fit expects: to any side, or all to the same. The error
/// covers the motion meant.
#[test]
fn rounding_of_values_is_part_of_the_error() {
    let case = all()
        .into_iter()
        .find(|case| case.name == "far circle")
        .unwrap();
    let (motion, middle) = (&case.motion, DVec3::splat(1e9));
    let off = 3.9 * f64::EPSILON * middle.length();
    let mut largest = 0.0_f64;
    for side in [None, Some(1.0), Some(-1.0)] {
        let told = |time: f64| {
            let (position, velocity) = motion(time);
            let mut rng = ChaCha8Rng::seed_from_u64(time.to_bits());
            let any = DVec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0)));
            let way = side.map_or(any, |side| side * (position - middle));
            (position + off * way.normalize_or_zero(), velocity)
        };
        for tolerance in [4.0, 5.0, 6.0, 8.0, 12.0].map(|times| times * off) {
            let fit = Trajectory::fit(told, case.window(), tolerance).unwrap();
            largest = largest.max(case.assert_error(&fit, 20_000, 15));
        }
    }
    assert!(largest > 0.85, "{largest}");
}

#[test]
fn the_last_piece_is_no_remnant() {
    for case in all().iter().filter(|case| case.name.contains("circle")) {
        for tolerance in case.tolerances {
            let fit = Trajectory::fit(&case.motion, case.window(), tolerance).unwrap();
            let knots = fit.trajectory.knots();
            let lengths = knots.windows(2).map(|pair| pair[1] - pair[0]);
            let longest = lengths.fold(0.0, f64::max);
            let [.., before, last] = knots else {
                unreachable!()
            };
            assert!(last - before > 0.7 * longest, "{} {knots:?}", case.name);
        }
    }
}

#[test]
fn what_a_cubic_can_follow_takes_two_knots() {
    let motion = |t: f64| {
        (
            [t * (1.0 - t * t), t * t, 5.0],
            [1.0 - 3.0 * t * t, 2.0 * t, 0.0],
        )
    };
    let window = nearmiss::Window::new(-3.0, 5.0).unwrap();
    let fit = Trajectory::fit(motion, window, 1e-9).unwrap();
    assert_eq!(fit.knot_count(), 2);
    assert!(fit.error() < 1e-10, "{}", fit.error());
}
