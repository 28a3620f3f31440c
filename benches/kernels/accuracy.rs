//! The accuracy of the benchmarked methods against exact integer arithmetic.

use super::Method;
use super::exact::Exact;
use super::workloads::Workload;

/// An error that no rounding explains: the method went to another minimum.
const WRONG_BASIN: f64 = 1e-4;

/// Prints, for each method and workload, the largest error of the distance, the error that 99.99 %
/// stay below, and how often it exceeds `WRONG_BASIN`; all relative to the size of the polygon.
pub(crate) fn print_table(count: usize) {
    println!("Errors of the distance relative to the polygon's size, {count} pairs each:");
    println!(
        "{:<16}{:<13}{:>10}{:>10}{:>13}",
        "method", "workload", "max", "99.99 %", "wrong basin"
    );
    for workload in Workload::ALL {
        let pairs = workload.pairs(count, 7);
        let exact: Vec<Exact> = pairs.iter().map(Exact::new).collect();
        for method in Method::ALL {
            let distances = method.distances(&pairs);
            let mut errors: Vec<f64> = distances
                .iter()
                .zip(exact.iter().zip(&pairs))
                .map(|(distance, (exact, pair))| {
                    let square = |p: &[f64; 3]| p.iter().map(|x| x * x).sum::<f64>();
                    let size = pair.iter().map(square).fold(0.0, f64::max).sqrt();
                    exact.excess(*distance).abs() / size
                })
                .collect();
            errors.sort_by(f64::total_cmp);
            let most = errors.last().copied().unwrap_or(0.0);
            let nearly_most = errors[(errors.len() * 9_999 / 10_000).min(errors.len() - 1)];
            let wrong = errors.iter().filter(|error| **error > WRONG_BASIN).count();
            println!(
                "{:<16}{:<13}{most:>10.1e}{nearly_most:>10.1e}{wrong:>13}",
                method.name(),
                workload.name(),
            );
        }
    }
}
