//! Batch kernels.

mod batch;
mod closest;
mod cubic;
mod dispatch;
mod enclosure;
mod enclosures;
mod exhaustive;
mod guess;
mod minorant;
mod pending;
mod real;
mod screen;
mod within;

pub use batch::{CubicBatch, Lanes};
pub use cubic::ControlPoints;
pub use dispatch::Level;
pub use enclosure::Enclosure;
pub use real::Real;
pub use within::Verdict;

/// temp
pub fn closest_approach<R: Real>(
    level: Level,
    lanes: &Lanes<'_, R>,
    times: &mut [R],
    distances: &mut [R],
) {
    closest::closest_approach(level, lanes, times, distances);
}
/// temp
pub fn closest_approach_of<R: Real>(points: &ControlPoints<R>) -> (R, R) {
    closest::closest_approach_of(points)
}
/// temp
pub fn all_roots(points: &ControlPoints<f64>, tolerance: f64) -> (f64, f64) {
    exhaustive::all_roots(points, tolerance)
}
/// temp
pub fn debug_guess<const H: usize, const P: usize>(points: &ControlPoints<f64>) -> (f64, f64, f64) {
    let a = guess::guess::<f64, H, P>(*points);
    (a.time, a.square.sqrt() / 8.0, a.certificate)
}
/// temp
pub fn pass1<R: Real, const H: usize, const P: usize>(
    level: Level,
    lanes: &Lanes<'_, R>,
    t: &mut [R],
    d: &mut [R],
    c: &mut [R],
) {
    let mut block = dispatch::Block::new();
    let mut s = 0;
    while s < lanes.len() {
        let e = (s + 128).min(lanes.len());
        dispatch::guess_block::<R, H, P>(
            level,
            &mut block,
            &lanes.range(s, e),
            &mut t[s..e],
            &mut d[s..e],
            &mut c[s..e],
        );
        s = e;
    }
}

/// temp
pub fn enclosures_temp(level: Level, lanes: &Lanes<'_, f64>, errors: &[f64], out: &mut [Enclosure]) { enclosures::enclosures(level, lanes, errors, out) }
/// temp
pub fn within<R: Real>(level: Level, lanes: &Lanes<'_, R>, inner: &[R], outer: &[R], out: &mut [Verdict]) { within::within(level, lanes, inner, outer, out) }
/// temp
pub fn within_of<R: Real>(points: &ControlPoints<R>, inner: R, outer: R) -> Verdict { within::within_of(points, inner, outer) }
/// temp
pub fn enclose_of(points: &ControlPoints<f64>, error: f64) -> Enclosure { enclosure::enclose(points, error) }
/// temp
pub fn debug_tight(lanes: &Lanes<'_, f64>, errors: &[f64]) -> usize { let mut n=0; let _=(lanes,errors); n+=0; n }
