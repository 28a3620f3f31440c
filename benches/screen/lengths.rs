//! The automatic slice length against the best fixed one.

use nearmiss::internals::QueryInternals;
use nearmiss::{Query, Scene};
use std::num::NonZeroU32;
use std::time::Instant;

/// Fixed numbers of slices, as multiples of the chosen one.
const FACTORS: [f64; 9] = [0.125, 0.25, 0.5, 0.71, 1.0, 1.41, 2.0, 4.0, 8.0];

/// Turns; the least time of each number counts.
const TURNS: usize = 5;

/// Prints the time with the chosen number of slices, and with the best of others, in turns.
pub(crate) fn print_line(name: &str, scene: &Scene, query: &Query) {
    let milliseconds = |query: &Query| {
        let begin = Instant::now();
        let screening = scene.screen(query);
        let time = begin.elapsed().as_secs_f64() * 1e3;
        (
            time,
            screening.map_or(0, |screening| screening.stats.slices),
        )
    };
    let (_, chosen) = milliseconds(query);
    let fixed: Vec<NonZeroU32> = FACTORS
        .iter()
        .filter_map(|factor| {
            let count = (factor * chosen as f64).round().clamp(1.0, 1e6);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped"
            )]
            NonZeroU32::new(count as u32)
        })
        .collect();
    let mut automatic = f64::INFINITY;
    let mut times = vec![f64::INFINITY; fixed.len()];
    for _ in 0..TURNS {
        automatic = automatic.min(milliseconds(query).0);
        for (time, &count) in times.iter_mut().zip(&fixed) {
            *time = time.min(milliseconds(&query.with_slices(count)).0);
        }
    }
    let best = times.iter().zip(&fixed).min_by(|x, y| x.0.total_cmp(y.0));
    if let Some((&best, count)) = best {
        println!(
            "{name:<12} {chosen:>6} slices {automatic:>9.2} ms, best {count:>6} slices \
             {best:>9.2} ms: {:.2} times the best",
            automatic / best
        );
    }
}
