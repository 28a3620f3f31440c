//! A guess of the closest approach refined in f64.

use super::cubic::{
    CentredCubic, ControlPoints, coordinates, distance, largest_coordinate, local_time,
};
use super::{descend, halley_step, long_step, lowest_sample, polish, settle, squared_distance};
use crate::blossom::ControlPolygon;
use crate::real::Real;
use crate::rounding::scale_to_one;

/// Steps of refinement before a proof, and after a failed one: at a root of multiplicity five a
/// step shortens the error by a third.
pub(crate) const QUICK: u32 = 6;
pub(crate) const THOROUGH: u32 = 10;

/// Returns the local time at which the distance of a cubic of size one, or of a part of it, seems
/// least. Not proven.
pub(crate) fn least_point(points: &ControlPolygon) -> f64 {
    let cubic = CentredCubic::new(coordinates(points));
    let square = squared_distance::<f64>(&cubic.rough()).square;
    let rough = descend(&square, lowest_sample(&square), f64::STEPS);
    local_time(settle(&cubic, polish(&cubic, f64::from(rough))).time)
}

/// Returns time and distance of a guess, refined until the distance shrinks no more.
pub(crate) fn refined(points: &ControlPoints<f64>, time: f64, steps: u32) -> (f64, f64) {
    let (points, unit) = normalised(points);
    let cubic = CentredCubic::new(points);
    let mut u = 2.0 * time - 1.0;
    let mut square = cubic.square(u);
    for _ in 0..steps {
        let derivatives = cubic.derivatives(u);
        let steps = [long_step(&derivatives), halley_step(&derivatives).step];
        let better = steps.into_iter().find_map(|step| {
            let next = (u - step).clamp(-1.0, 1.0);
            let there = cubic.square(next);
            // Not where the step is not a number.
            (there < square).then_some((next, there))
        });
        let Some(better) = better else {
            break;
        };
        (u, square) = better;
    }
    (local_time(u), distance(square) * unit)
}

/// Returns the polygon divided by a power of two if its squares could leave the range, and that
/// power. Exact except for underflow.
#[inline]
pub(crate) fn normalised(points: &ControlPoints<f64>) -> (ControlPoints<f64>, f64) {
    let largest = largest_coordinate(points);
    if (1e-40..=1e40).contains(&largest) {
        return (*points, 1.0);
    }
    let power = scale_to_one(largest);
    (points.map(|point| point.map(|x| x * power)), 1.0 / power)
}
