//! The results of a run: tables, and a line of JSON.

use crate::Arguments;
use crate::tally::{Counts, Outcome};
use crate::watch::LOOKAHEAD;
use nearmiss::SphereCover;
use serde_json::{Map, Value, json};
use std::io::{self, Write};

/// The kinds of pairs, by the number of boxes in them: names for readers, and for JSON.
const PAIRS: [(&str, &str); 3] = [
    ("two balls", "ball_ball"),
    ("ball and box", "ball_box"),
    ("two boxes", "box_box"),
];

/// A row of the table of counts: its name, and what is counted.
type Row = (&'static str, fn(&Counts) -> u64);

const ROWS: [Row; 10] = [
    ("contacts in rapier", |counts| counts.contacts),
    ("  free: neither body just deflected", |counts| counts.free),
    ("    predicted", |counts| counts.predicted),
    ("    not predicted", Counts::unpredicted),
    ("predictions", |counts| counts.predictions),
    ("  a body was deflected before", |counts| counts.deflected),
    ("  still ahead at the end", |counts| counts.ahead),
    ("  came true", |counts| counts.came_true),
    ("  passed between two frames", |counts| {
        counts.between_frames
    }),
    ("  no contact came", |counts| counts.failed),
];

/// Everything that is printed.
#[derive(Debug)]
pub(crate) struct Report {
    pub(crate) arguments: Arguments,
    /// Threads of the monitor.
    pub(crate) threads: usize,
    pub(crate) cover: SphereCover,
    pub(crate) outcome: Outcome,
    /// Times of rapier's steps, ms.
    pub(crate) physics: Vec<f64>,
    /// Times of the monitor's calls, ms.
    pub(crate) nearmiss: Vec<f64>,
}

impl Report {
    pub(crate) fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let arguments = &self.arguments;
        writeln!(
            out,
            "{} balls and {} boxes for {} frames of 1/60 s, {} contacts with walls\n\
             a box is {} spheres to the monitor, which reach up to {:.3} m out of it ({:.2} % of \
             its diameter)\n",
            arguments.bodies,
            arguments.boxes,
            arguments.frames,
            self.outcome.walls,
            self.cover.spheres().len(),
            self.cover.overshoot(),
            self.cover.overshoot_percent(),
        )?;
        let names = PAIRS.map(|(name, _)| name.to_owned());
        let heading = format!("who meets within {LOOKAHEAD} s");
        print_row(out, &heading, &names)?;
        for (name, count) in ROWS {
            self.print_counts(out, name, |counts| count(counts).to_string())?;
        }
        self.print_counts(out, "    median error of the instant, ms", |counts| {
            shown(percentile(&counts.errors, 50))
        })?;
        self.print_counts(out, "    99 % of the errors below, ms", |counts| {
            shown(percentile(&counts.errors, 99))
        })?;
        self.print_counts(out, "    median time of warning, s", |counts| {
            shown(percentile(&counts.warnings, 50))
        })?;
        writeln!(
            out,
            "\na prediction holds for straight flight: another body or a wall that deflects one of the \
             two ends it\n"
        )?;
        print_row(out, "ms per frame", &["median", "99 % below"])?;
        let threads = self.threads;
        let plural = if threads == 1 { "" } else { "s" };
        let monitor = format!("nearmiss: tell all, {threads} thread{plural}");
        for (name, times) in [
            ("rapier: step, 1 thread", &self.physics),
            (&monitor, &self.nearmiss),
        ] {
            print_row(out, name, &median_and_most(times).map(shown))?;
        }
        writeln!(
            out,
            "rapier looks at the contacts of one step, nearmiss at all encounters of the next {LOOKAHEAD} s"
        )
    }

    fn print_counts(
        &self,
        out: &mut impl Write,
        name: &str,
        value: impl Fn(&Counts) -> String,
    ) -> io::Result<()> {
        print_row(out, name, &self.outcome.pairs.each_ref().map(value))
    }

    pub(crate) fn print_json(&self, out: &mut impl Write) -> io::Result<()> {
        let pairs = PAIRS.iter().zip(&self.outcome.pairs);
        let pairs = pairs.map(|(&(_, name), counts)| (name.to_owned(), counts.json()));
        let physics = median_and_most(&self.physics);
        let nearmiss = median_and_most(&self.nearmiss);
        let line = json!({
            "frames": self.arguments.frames,
            "bodies": self.arguments.bodies,
            "boxes": self.arguments.boxes,
            "seed": self.arguments.seed,
            "threads": self.threads,
            "spheres": self.cover.spheres().len(),
            "overshoot_m": self.cover.overshoot(),
            "overshoot_percent": self.cover.overshoot_percent(),
            "wall_contacts": self.outcome.walls,
            "pairs": pairs.collect::<Map<_, _>>(),
            "physics_ms_p50": physics[0],
            "physics_ms_p99": physics[1],
            "nearmiss_ms_p50": nearmiss[0],
            "nearmiss_ms_p99": nearmiss[1],
        });
        writeln!(out, "{line}")
    }
}

impl Counts {
    const fn unpredicted(&self) -> u64 {
        self.free - self.predicted
    }

    fn json(&self) -> Value {
        json!({
            "contacts": self.contacts,
            "free": self.free,
            "predicted": self.predicted,
            "unpredicted": self.unpredicted(),
            "predictions": self.predictions,
            "deflected": self.deflected,
            "ahead": self.ahead,
            "came_true": self.came_true,
            "between_frames": self.between_frames,
            "failed": self.failed,
            "error_ms_p50": percentile(&self.errors, 50),
            "error_ms_p99": percentile(&self.errors, 99),
            "warning_s_p50": percentile(&self.warnings, 50),
        })
    }
}

fn print_row(out: &mut impl Write, name: &str, values: &[impl AsRef<str>]) -> io::Result<()> {
    write!(out, "{name:<37}")?;
    for value in values {
        write!(out, "{:>14}", value.as_ref())?;
    }
    writeln!(out)
}

fn median_and_most(values: &[f64]) -> [Option<f64>; 2] {
    [50, 99].map(|percent| percentile(values, percent))
}

/// Returns the least value that this share of them, in percent, does not exceed.
fn percentile(values: &[f64], percent: usize) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = (sorted.len() * percent).div_ceil(100).max(1) - 1;
    sorted.get(place).copied()
}

fn shown(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.3}"))
}
