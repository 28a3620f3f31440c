//! Curves that cannot be built, and what is said about them: beside those of `tests/wrong_calls.rs`.

use super::made;
use crate::error::{Error, Quantity};
use crate::trajectory::{Keyframe, PositionOptions, Trajectory};
use glam::DVec3;

fn refused<T: std::fmt::Debug>(made: Result<T, Error>) -> Error {
    made.err().unwrap_or_else(|| unreachable!("refused"))
}

#[test]
fn numbers_that_are_refused() {
    let fast = [(0.0, DVec3::ZERO), (1e-200, 1e200 * DVec3::X)];
    assert!(matches!(
        refused(Trajectory::from_waypoints(&fast)),
        Error::OutOfRange { knot: 1, .. }
    ));
    let far = [DVec3::ZERO, 2e300 * DVec3::X, DVec3::Y, DVec3::Z];
    let found = refused(Trajectory::from_bezier(&[0.0, 1.0], &[far]));
    assert_eq!(
        found.to_string(),
        "knot 0: control point 1 in x reaches 2e300, beyond ±1e300: check the units"
    );
}

#[test]
fn b_splines_that_are_refused() {
    let piece = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let spline = Trajectory::from_b_spline;
    let found = refused(spline(&[0.0; 7], &piece[..3]));
    assert_eq!(
        found.to_string(),
        "a cubic B-spline needs at least four control points, not 3"
    );
    let clamped = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    for (knot, time) in [
        (2, -1.0),
        (4, 0.0),
        (5, f64::NAN),
        (6, 0.5),
        (7, f64::INFINITY),
    ] {
        let mut knots = clamped;
        knots[knot] = time;
        let found = refused(spline(&knots, &piece));
        let is_named = match found {
            Error::TimeNotIncreasing { knot: named, .. } => named == knot,
            Error::NotFinite {
                knot: named,
                quantity,
                ..
            } => named == knot && quantity == Quantity::Time,
            _ => false,
        };
        assert!(is_named, "{knot} {found}");
    }
    let found = refused(spline(&[0.0, 1.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0], &piece));
    assert!(
        matches!(found, Error::TimeNotIncreasing { knot: 4, .. }),
        "{found}"
    );
    // Five times, and a control point would count for nothing.
    let five = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let found = refused(spline(&five, &[&piece[..], &[DVec3::ONE]].concat()));
    assert!(
        matches!(found, Error::TimeNotIncreasing { knot: 4, .. }),
        "{found}"
    );
    // A knot that occurs four times parts the curve, if its points differ.
    let broken = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0];
    let mut eight = [piece, piece.map(|point| point + 2.0 * DVec3::Z)].concat();
    assert_eq!(
        refused(spline(&broken, &eight)),
        Error::Discontinuous {
            knot: 4,
            distance: 1.0
        }
    );
    eight[4] = eight[3];
    assert_eq!(made(spline(&broken, &eight)).segments().len(), 2);
}

#[test]
fn uniform_b_splines_that_are_refused() {
    let piece = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let uniform = Trajectory::from_uniform_b_spline;
    for interval in [0.0, -1.0, f64::NAN, 1e-20] {
        let found = refused(uniform(1.0, interval, &piece));
        let is_named = matches!(
            found,
            Error::TimeNotIncreasing { knot: 1, .. } | Error::NotFinite { knot: 1, .. }
        );
        assert!(is_named, "{interval} {found}");
    }
    let nan = DVec3::new(0.0, f64::NAN, 0.0);
    let found = refused(uniform(0.0, 1.0, &[piece.to_vec(), vec![nan]].concat()));
    assert_eq!(
        found.to_string(),
        "knot 1: control point 4 in y is NaN, not a finite number"
    );
}

#[test]
fn velocities_that_are_refused() {
    let (nan, far) = (DVec3::new(0.0, f64::NAN, 0.0), DVec3::new(2e300, 0.0, 0.0));
    let text = |error: Error| error.to_string();
    // Also what shapes no segment.
    let frame = |time| Keyframe {
        time,
        ..Keyframe::default()
    };
    let unused = Keyframe {
        in_tangent: nan,
        ..frame(0.0)
    };
    let found = text(refused(Trajectory::from_keyframes(&[unused, frame(1.0)])));
    assert_eq!(found, "knot 0: velocity y is NaN, not a finite number");
    let options = PositionOptions::new().with_last_velocity(far);
    let two = [(0.0, DVec3::ZERO), (1.0, DVec3::X)];
    let found = text(refused(Trajectory::from_positions_with(&two, &options)));
    assert_eq!(
        found,
        "knot 1: velocity x reaches 2e300, beyond ±1e300: check the units"
    );
}
