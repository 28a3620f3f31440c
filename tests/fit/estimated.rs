//! Estimated errors.

use crate::motions::all;
use nearmiss::Trajectory;

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
