//! Times of a frame in units of a solve that is measured next to them: ratios hold on a busy machine.

use crate::peers;
use crate::workloads::Workload;
use nearmiss::kernels::ControlPoints;
use std::fmt::{self, Write as _};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// The pairs that are solved between frames.
pub(crate) const PAIRS: usize = 4096;

/// The tolerance of the literature, in local time.
const TOLERANCE: f64 = 6e-7;

/// `closest_approach/polycool/random`: the closest approach of a random pair by `polycool`.
pub(crate) struct Solve {
    pairs: Vec<ControlPoints<f64>>,
}

impl Default for Solve {
    fn default() -> Self {
        Self {
            pairs: Workload::Random.pairs(PAIRS, 1),
        }
    }
}

impl Solve {
    /// Solves all pairs once.
    pub(crate) fn run(&self) {
        for pair in black_box(&self.pairs) {
            black_box(peers::polycool(pair, TOLERANCE));
        }
    }

    /// Returns the seconds that one solve takes: the least of a few, which leaves out interruptions.
    fn seconds(&self) -> f64 {
        let times = (0..3).map(|_| {
            let begin = Instant::now();
            self.run();
            begin.elapsed().as_secs_f64() / PAIRS as f64
        });
        times.fold(f64::INFINITY, f64::min)
    }
}

/// Seconds of frames, and of a solve right after them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    /// The mean of the frames.
    mean: f64,
    /// The median of the frames.
    median: f64,
    solve: f64,
}

impl Turn {
    /// Measures a solve after frames that took so long each.
    pub(crate) fn new(frames: &[Duration], solve: &Solve) -> Self {
        Self {
            mean: frames.iter().sum::<Duration>().as_secs_f64() / frames.len() as f64,
            median: median(frames.iter().map(Duration::as_secs_f64)),
            solve: solve.seconds(),
        }
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// One line for each benchmark.
#[derive(Default)]
pub(crate) struct Table {
    lines: String,
}

impl Table {
    /// Adds a benchmark: its turns, and the counts of all its frames, of which there were so many.
    pub(crate) fn add(&mut self, id: &str, turns: &[Turn], frames: u64, sums: &[(u64, &str)]) {
        let frame = 1e3 * median(turns.iter().map(|turn| turn.mean));
        let solve = 1e9 * median(turns.iter().map(|turn| turn.solve));
        let means = turns.iter().map(|turn| turn.mean / turn.solve);
        let least = means.clone().fold(f64::INFINITY, f64::min);
        let (mean, typical) = (
            median(means),
            median(turns.iter().map(|turn| turn.median / turn.solve)),
        );
        let mut line =
            format!("{id:<20}{frame:>9.3}{solve:>7.0}{mean:>10.0}{least:>10.0}{typical:>10.0}");
        for (sum, what) in sums {
            let mean = *sum as f64 / frames as f64;
            let _ = write!(line, "{mean:>10.1} {what}");
        }
        let _ = writeln!(self.lines, "{line}");
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Medians of turns: ms a frame, ns a polycool solve, solves a frame (and the least turn), solves\n\
             a median frame; and means of what a frame has:"
        )?;
        f.write_str(&self.lines)
    }
}
