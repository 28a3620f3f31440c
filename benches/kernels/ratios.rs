//! Speed ratios that hold on a busy machine: methods in turn, ratios within each turn.

use std::hint::black_box;
use std::time::Instant;

use super::workloads::Workload;
use super::{Batch, Method, PAIRS, Screening};

/// Turns; the median of their ratios is printed.
const TURNS: usize = 61;

/// The time of one call in nanoseconds: the least of a few, which leaves out interruptions.
fn nanoseconds(mut work: impl FnMut()) -> f64 {
    (0..3)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64() * 1e9
        })
        .fold(f64::INFINITY, f64::min)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Prints the nanoseconds a pair of each method, and how many times faster it is than `polycool`
/// on the same workload (for `within` on `random`): medians over turns.
pub(crate) fn print_table() {
    println!("Nanoseconds a pair, and times faster than polycool (medians of {TURNS} turns):");
    for workload in Workload::ALL {
        let pairs = workload.pairs(PAIRS, 1);
        let mut work = Batch::new(&pairs);
        let screenings: &[Screening] = if workload == Workload::Random {
            &Screening::ALL
        } else {
            &[]
        };
        let limits = super::Limits::new(&pairs);
        let count = Method::ALL.len() + screenings.len();
        let mut times = vec![Vec::new(); count];
        let mut ratios = vec![Vec::new(); count];
        for _ in 0..TURNS {
            let mut turn = Vec::new();
            for method in Method::ALL {
                turn.push(nanoseconds(|| method.run(black_box(&pairs), &mut work)));
            }
            for screening in screenings {
                turn.push(nanoseconds(|| {
                    screening.run(black_box(&pairs), &limits, &mut work);
                }));
            }
            for (i, time) in turn.iter().enumerate() {
                times[i].push(time / PAIRS as f64);
                ratios[i].push(turn[0] / time);
            }
        }
        let names = Method::ALL
            .map(|method| ("closest_approach", method.name(), workload.name()))
            .into_iter()
            .chain(screenings.iter().map(|s| ("within", s.name(), "sparse")));
        for (((group, method, workload), times), ratios) in names.zip(times).zip(ratios) {
            let id = format!("{group}/{method}/{workload}");
            println!("{id:<44}{:>9.2}{:>9.2}", median(times), median(ratios));
        }
    }
}
