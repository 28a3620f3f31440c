//! The closest approach of many pairs: guess, certify, retry, and at last all roots.

use super::batch::Lanes;
use super::cubic::ControlPoints;
use super::dispatch::{BLOCK, Block, Level, guess_block};
use super::exhaustive::all_roots;
use super::guess::guess;
use super::pending::Pending;
use super::real::Real;

/// Samples on each side of the middle in the first and the second try.
const FIRST: usize = 4;
const SECOND: usize = 8;

/// Tries again with more samples and a finer certificate; what fails again gets all roots.
fn retry<R: Real>(
    level: Level,
    block: &mut Block<R>,
    pending: &mut Pending<R, 0>,
    times: &mut [R],
    distances: &mut [R],
) {
    let mut retried = [[R::default(); BLOCK]; 3];
    let [time, distance, certificate] = retried.each_mut().map(|slot| &mut slot[..pending.len()]);
    let lanes = pending.lanes();
    guess_block::<R, SECOND, 8>(level, block, &lanes, time, distance, certificate);
    for i in 0..pending.len() {
        let pair = pending.pair(i);
        (times[pair], distances[pair]) = if is_positive(certificate[i]) {
            (time[i], distance[i])
        } else {
            last_resort(&lanes.control_points(i))
        };
    }
    pending.clear();
}

/// Whether a certificate is one: not if it is not a number.
#[inline]
fn is_positive<R: Real>(certificate: R) -> bool {
    certificate > R::from_f64(0.0)
}

/// All roots, in f64 whatever the type.
fn last_resort<R: Real>(points: &ControlPoints<R>) -> (R, R) {
    let wide = points.map(|point| point.map(R::to_f64));
    let (time, distance) = all_roots(&wide, 0.0);
    (R::from_f64(time), R::from_f64(distance))
}

/// The closest approach of each pair, on one thread: local times in 0..=1, distances in metres.
pub(super) fn closest_approach<R: Real>(
    level: Level,
    lanes: &Lanes<'_, R>,
    times: &mut [R],
    distances: &mut [R],
) {
    let mut pending = Pending::new();
    let mut block = Block::new();
    let mut certificates = [R::default(); BLOCK];
    let mut start = 0;
    while start < lanes.len() {
        let end = (start + BLOCK).min(lanes.len());
        let certificates = &mut certificates[..end - start];
        guess_block::<R, FIRST, 2>(
            level,
            &mut block,
            &lanes.range(start, end),
            &mut times[start..end],
            &mut distances[start..end],
            certificates,
        );
        for (pair, certificate) in (start..end).zip(certificates.iter()) {
            if !is_positive(*certificate) {
                pending.push(pair, lanes, []);
                if pending.is_full() {
                    retry(level, &mut block, &mut pending, times, distances);
                }
            }
        }
        start = end;
    }
    retry(level, &mut block, &mut pending, times, distances);
}

/// The closest approach of one pair: local time and distance.
pub(super) fn closest_approach_of<R: Real>(points: &ControlPoints<R>) -> (R, R) {
    let mut found = guess::<R, FIRST, 2>(*points);
    if !is_positive(found.certificate) {
        found = guess::<R, SECOND, 8>(*points);
        if !is_positive(found.certificate) {
            return last_resort(points);
        }
    }
    (
        R::from_f64(0.5) * (found.time + R::from_f64(1.0)),
        R::from_f64(0.125) * found.square.sqrt(),
    )
}
