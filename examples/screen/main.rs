//! Screens a file of states for conflicts:
//!
//! ```text
//! cargo run --release --example screen -- STATES.csv[.gz]
//!     [--radius R] [--margin M] [--window A..B] [--outside absent|extrapolate|coast]
//!     [--accuracy fast|exact|certified] [--threads N] [--output OUT.csv] [--stats json]
//! ```
//!
//! `STATES` has the header `body,t,px,py,pz,vx,vy,vz` (SI units; a body's rows together and in the
//! order of time). Writes one row for each maximal interval in which two bodies' separation is at
//! most the margin. Bad input: exit code 1, one line that says what and where, no output.

mod read;
mod write;

use clap::{Parser, ValueEnum};
use indicatif::ProgressBar;
use nearmiss::{Accuracy, Body, Hitbox, Outside, Query, Scene, Screening, Window};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use write::Table;

/// Every conflict among the bodies of a file of states.
#[derive(Debug, Parser)]
#[command(name = "screen")]
struct Arguments {
    /// Header body,t,px,py,pz,vx,vy,vz; SI units; `.gz` is unpacked.
    states: PathBuf,
    /// Radius of every body, m.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    radius: f64,
    /// A conflict lasts while the separation is at most this, m; may be negative.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    margin: f64,
    /// Only this time, s: A..B, A.. or ..B.
    #[arg(long, value_parser = parse_window, allow_hyphen_values = true, default_value = "..")]
    window: Window,
    /// What a body does before its first and after its last row.
    #[arg(long, value_enum, default_value_t = OutsideRule::Absent)]
    outside: OutsideRule,
    /// How exact the answer is.
    #[arg(long, value_enum, default_value_t = AccuracyName::Exact)]
    accuracy: AccuracyName,
    /// Threads to run on; all cores if not given.
    #[arg(long)]
    threads: Option<usize>,
    /// Where to write the conflicts; standard output if not given.
    #[arg(long)]
    output: Option<PathBuf>,
    /// Print the funnel and the stage times as one line on standard error.
    #[arg(long, value_enum)]
    stats: Option<StatsFormat>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum OutsideRule {
    /// It does not exist there.
    Absent,
    /// The first and last cubic go on.
    Extrapolate,
    /// It keeps its velocity.
    Coast,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AccuracyName {
    /// f32: reports too much rather than too little.
    Fast,
    /// f64, good to a few roundings.
    Exact,
    /// With proven enclosures, in six more columns.
    Certified,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum StatsFormat {
    /// One JSON object on one line.
    Json,
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version go to standard output and are no failure.
            let failed = error.use_stderr();
            print_or_ignore(&error);
            return if failed {
                ExitCode::FAILURE
            } else {
                ExitCode::SUCCESS
            };
        }
    };
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// A closed pipe is no reason to fail twice.
fn print_or_ignore(error: &clap::Error) {
    let _ = error.print();
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let accuracy = match arguments.accuracy {
        AccuracyName::Exact => Accuracy::Exact,
        AccuracyName::Certified => Accuracy::Certified,
        AccuracyName::Fast => Accuracy::Fast,
    };
    // This thread is one of them: it is about to read the file, and its caches will know it.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.unwrap_or(0))
        .use_current_thread()
        .build()
        .map_err(|error| format!("--threads: {error}"))?;
    let progress = spinner();
    progress.set_message("reading");
    let scene = build_scene(arguments)?;
    let query = Query::new(arguments.window)
        .with_margin(arguments.margin)
        .map_err(|error| error.to_string())?
        .with_accuracy(accuracy);
    progress.set_message(format!("screening {} bodies", scene.len()));
    let screening = pool
        .install(|| scene.screen(&query))
        .map_err(|error| error.to_string())?;
    progress.finish_and_clear();
    let table = Table {
        scene: &scene,
        conflicts: &screening.conflicts,
        accuracy,
    };
    report(arguments, &table, &screening, pool.current_num_threads())
}

fn build_scene(arguments: &Arguments) -> Result<Scene, String> {
    let hitbox = Hitbox::sphere(arguments.radius).map_err(|error| format!("--radius: {error}"))?;
    let outside = match arguments.outside {
        OutsideRule::Absent => Outside::Absent,
        OutsideRule::Extrapolate => Outside::Extrapolate,
        OutsideRule::Coast => Outside::Coast,
    };
    let mut bodies = read::trajectories(&arguments.states)?;
    // Ids in the order of the labels: conflicts then come out with a < b in the file's own terms.
    bodies.sort_by_key(|&(label, _)| label);
    let mut scene = Scene::new();
    for (label, trajectory) in bodies {
        let body = Body::new(trajectory.with_outside(outside))
            .with_hitbox(hitbox.clone())
            .with_tag(label);
        scene.insert(body).map_err(|error| error.to_string())?;
    }
    Ok(scene)
}

fn report(
    arguments: &Arguments,
    table: &Table<'_>,
    screening: &Screening,
    threads: usize,
) -> Result<(), String> {
    match &arguments.output {
        None => write::to_standard_output(table)?,
        Some(path) => write::to_file(path, table)?,
    }
    if let Some(StatsFormat::Json) = arguments.stats {
        eprintln!("{}", write::stats_line(&screening.stats, threads));
    }
    Ok(())
}

/// Shown only on a terminal, and only if the work takes long enough to be seen.
fn spinner() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(120));
    spinner
}

fn parse_window(text: &str) -> Result<Window, String> {
    let (start, end) = text
        .split_once("..")
        .ok_or("expected A..B, A.. or ..B (seconds)")?;
    let bound = |text: &str, open: f64| -> Result<f64, String> {
        match text.trim() {
            "" => Ok(open),
            number => number
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite())
                .ok_or(format!("\"{number}\" is not a time in seconds")),
        }
    };
    Window::new(bound(start, f64::NEG_INFINITY)?, bound(end, f64::INFINITY)?)
        .map_err(|error| error.to_string())
}
