//! Crossings of a threshold: an estimate by Newton's method, then the nearest certain points.

use super::scaled::TINY;
use crate::blossom::ControlPolygon;

/// Returns an estimate of the crossing of `radius`, from 0 at the inner end to 1 at the outer end,
/// and the closing rate there. Bracketed Newton; callers do not rely on it.
pub(super) fn crossing_estimate(
    points: &ControlPolygon,
    radius: f64,
    guess: Option<f64>,
) -> (f64, f64) {
    const STEPS: u32 = 40;
    const SHORT: f64 = 1e-10;
    let k0 = points[0];
    let (d1, d2, d3) = (points[1] - k0, points[2] - k0, points[3] - k0);
    let (linear, square, cube) = (d1 * 3.0, (d2 - d1 * 2.0) * 3.0, d3 - (d2 - d1) * 3.0);
    let motion = |x: f64| {
        (
            k0 + (linear + (square + cube * x) * x) * x,
            linear + (square * 2.0 + cube * (3.0 * x)) * x,
        )
    };
    let squared_radius = radius * radius;
    let (start, end) = (k0.length_squared(), points[3].length_squared());
    let (mut low, mut high) = (0.0, 1.0);
    // Next to a minimum the squared distance grows with the square of the time.
    let first = guess.unwrap_or_else(|| ((squared_radius - start) / (end - start)).sqrt());
    let mut x = if 0.0 < first && first < 1.0 {
        first
    } else {
        0.5
    };
    let mut rate = 0.0;
    for _ in 0..STEPS {
        let (position, velocity) = motion(x);
        let square = position.length_squared();
        let slope = position.dot(velocity);
        rate = slope.abs() / (square.sqrt() + TINY);
        let excess = square - squared_radius;
        if excess < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - 0.5 * excess / slope;
        let next = if low <= newton && newton <= high {
            newton
        } else {
            0.5 * (low + high)
        };
        let step = (next - x).abs();
        x = next;
        // What is left is of the order of this step's square.
        if step <= SHORT * x {
            break;
        }
    }
    (x, rate)
}

/// Returns a short step below `room` after which the test holds; `step` is the expected length.
///
/// The step is doubled until the test holds. A coarse expectation, as next to a turning point with
/// hardly any closing speed, is not assumed to be needed.
pub(super) fn nearest_certain(
    mut step: f64,
    room: f64,
    at: impl Fn(f64) -> f64,
    is_certain: impl Fn(f64) -> bool,
) -> Option<f64> {
    const COARSE: f64 = 1e-10;
    debug_assert!(step >= 0.0 || step.is_nan(), "a step forward");
    // Also where it is infinite or NaN.
    step = if step < COARSE { step } else { COARSE };
    while step < room {
        let s = at(step);
        if is_certain(s) {
            return Some(s);
        }
        step *= 2.0;
    }
    None
}
