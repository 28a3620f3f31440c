//! The accuracy of the benchmarked methods against exact integer arithmetic.

use nearmiss::kernels::ControlPoints;

use super::Method;
use super::exact::Exact;
use super::workloads::Workload;

/// An error that no rounding explains: the method went to another minimum.
const WRONG_BASIN: f64 = 1e-4;

/// Pairs that are held in memory at once, with their exact polynomials.
const PART: usize = 10_000;

/// Prints, for each method and workload, the largest error of the distance, the error that 99.99 %
/// stay below, and how often it exceeds `WRONG_BASIN`; all relative to the size of the polygon.
/// `count` pairs are random, a tenth as many near, and as many adversarial.
pub(crate) fn print_table(count: usize) {
    println!("Errors of the distance relative to the polygon's size:");
    println!(
        "{:<16}{:<13}{:>9}{:>10}{:>10}{:>13}",
        "method", "workload", "pairs", "max", "99.99 %", "wrong basin"
    );
    for workload in Workload::ALL {
        let count = match workload {
            Workload::Random => count,
            Workload::Near | Workload::Adversarial => count.div_ceil(10),
        };
        let mut errors = Method::ALL.map(|_| Vec::with_capacity(count));
        for (part, start) in (0..count).step_by(PART).enumerate() {
            let pairs = workload.pairs(PART.min(count - start), 7 + part as u64);
            let exact: Vec<Exact> = pairs.iter().map(Exact::new).collect();
            for (method, errors) in Method::ALL.into_iter().zip(&mut errors) {
                let distances = method.distances(&pairs);
                errors.extend(
                    distances.iter().zip(exact.iter().zip(&pairs)).map(
                        |(distance, (exact, pair))| exact.excess(*distance).abs() / size(pair),
                    ),
                );
            }
        }
        for (method, errors) in Method::ALL.into_iter().zip(&mut errors) {
            errors.sort_by(f64::total_cmp);
            let most = errors.last().copied().unwrap_or(0.0);
            let nearly_most = errors[(errors.len() * 9_999 / 10_000).min(errors.len() - 1)];
            let wrong = errors.iter().filter(|error| **error > WRONG_BASIN).count();
            println!(
                "{:<16}{:<13}{count:>9}{most:>10.1e}{nearly_most:>10.1e}{wrong:>13}",
                method.name(),
                workload.name(),
            );
        }
    }
}

/// The largest distance of a control point, metres.
fn size(pair: &ControlPoints<f64>) -> f64 {
    let square = |p: &[f64; 3]| p.iter().map(|x| x * x).sum::<f64>();
    pair.iter().map(square).fold(0.0, f64::max).sqrt()
}
