//! Times that can be compared on a busy machine: works in turn, medians over the turns.

use std::time::Instant;

/// The median of some numbers, or NaN if there are none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Returns the result of some work and its time, s.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begin = Instant::now();
    let result = work();
    (result, begin.elapsed().as_secs_f64())
}

/// Runs each work once in each of some turns. Returns the median time of each, s, and the median of its ratio
/// to the time of the first in the same turn.
pub(crate) fn in_turns<W: FnMut()>(turns: usize, works: &mut [W]) -> Vec<(f64, f64)> {
    let mut times = vec![Vec::with_capacity(turns); works.len()];
    for _ in 0..turns {
        for (work, times) in works.iter_mut().zip(&mut times) {
            times.push(timed(&mut *work).1);
        }
    }
    let ratios: Vec<f64> = times
        .iter()
        .map(|own| {
            median(
                own.iter()
                    .zip(&times[0])
                    .map(|(own, first)| own / first)
                    .collect(),
            )
        })
        .collect();
    times.into_iter().map(median).zip(ratios).collect()
}

/// Does some work a few times. Returns its last result and the median time, s.
pub(crate) fn repeated<T, E>(
    runs: usize,
    mut work: impl FnMut() -> Result<T, E>,
) -> Result<(T, f64), E> {
    let (mut last, time) = timed(&mut work);
    let mut times = vec![time];
    for _ in 1..runs {
        let (result, time) = timed(&mut work);
        last?;
        last = result;
        times.push(time);
    }
    Ok((last?, median(times)))
}
