//! Screens a file of states for conflicts:
//!
//! ```text
//! cargo run --release --example screen -- STATES.csv[.gz]
//!     [--radius R] [--hitboxes FILE] [--margin M] [--window A..B] [--outside absent|extrapolate|coast]
//!     [--accuracy exact|certified] [--threads N] [--output OUT.csv] [--stats json]
//! ```
//!
//! `STATES` has the columns `body,t,px,py,pz,vx,vy,vz` in any order, and possibly `radius` (SI units; a body's
//! rows together and in the order of time); other columns are ignored, which standard error says. A row is one line, also
//! where values are in quotation marks. The separator is a comma, a semicolon or a tab. Bodies are whole numbers from 0
//! on, and `07` is 7; if one is not, all are names as they are written, in the order of their first appearance. `-` is
//! standard input; gzip is unpacked.
//!
//! Writes a row for each maximal interval in which two bodies' separation is at most the margin, with the columns
//! `a,b,enter,exit,tca,separation,error,clip,resolved`: the labels of the bodies, of numbers the smaller one first, of
//! names the one that comes first in the file; the first and the last instant, and the time of closest approach (s); the
//! separation then (m); `clip` is 1 if the conflict is cut off at `enter`, by the window or since a body begins, 2 at
//! `exit`, 3 at both, else 0. `error` and `resolved` are empty unless `certified`: half the width of the proven enclosure of
//! the separation (m); and 1, or 0 where f64 cannot tell whether the bodies come within the margin, or whether a gap divides
//! the conflict. `certified` adds six columns that enclose enter, exit and tca. All of this is about the spline through the
//! states; how far the bodies in the world are from it is not part of it.
//!
//! Bad input ends with exit code 1 and one line that says what and where, without output; a wrong command line with
//! exit code 2.

mod hitboxes;
mod notes;
mod read;
#[path = "../terminal/mod.rs"]
mod terminal;
mod write;

use clap::{Parser, ValueEnum};
use hitboxes::Hitboxes;
use nearmiss::{Accuracy, Body, Hitbox, Orientation, Outside, Query, Scene, Window};
use read::{Bodies, FileBody, Labels};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use terminal::{Product, Progress, Threads};
use write::Table;

/// Columns of the output, for the help.
const COLUMNS: &str = "\
Output: a row for each conflict, with the columns
  a, b        the bodies' labels: of numbers the smaller one first, of names the one that comes first in the file
  enter, exit the first and the last instant, s
  tca         the time of closest approach, s
  separation  the separation then, m
  error       with certified: half the width of the proven enclosure of the separation, m
  clip        1 if the conflict is cut off at enter, by the window or since a body begins; 2 at exit; 3 at both; else 0
  resolved    with certified: 1, or 0 where f64 cannot tell whether the bodies come within the margin, or whether a gap
              divides the conflict
With certified, six more columns enclose enter, exit and tca.";

/// Every conflict among the bodies of a file of states.
#[derive(Debug, Parser)]
#[command(name = "screen", after_long_help = COLUMNS)]
struct Arguments {
    /// A table with the columns body,t,px,py,pz,vx,vy,vz, and possibly radius, in any order; SI units; separated
    /// by commas, semicolons or tabs; gzip is unpacked; - is standard input. Bodies are whole numbers (07 is 7) or,
    /// if one is none, names.
    states: PathBuf,
    /// Radius of every body, m; 0 if neither this is given nor the file has a column radius. Refused beside such a column.
    #[arg(
        long = "radius",
        value_parser = parse_radius,
        value_name = "RADIUS",
        allow_hyphen_values = true
    )]
    hitbox: Option<Hitbox>,
    #[arg(long, value_name = "FILE", help = "JSON file of hitboxes; its schema: --help", long_help = hitboxes::HELP)]
    hitboxes: Option<PathBuf>,
    /// A conflict lasts while the separation is at most this, m; may be negative. The separation is the distance of
    /// the bodies' surfaces.
    #[arg(
        long,
        value_parser = terminal::margin,
        default_value = "0",
        allow_hyphen_values = true
    )]
    margin: f64,
    /// Only this time, s: A..B, A.. or ..B.
    #[arg(long, value_parser = parse_window, allow_hyphen_values = true, default_value = "..")]
    window: Window,
    /// Rule for a body before its first and after its last row; extrapolate and coast need a window that is closed on
    /// both sides.
    #[arg(long, value_enum, default_value_t = OutsideRule::Absent)]
    outside: OutsideRule,
    /// Accuracy of the answer: exact (f64, good to a few roundings) or certified (fills error and resolved, and adds
    /// six columns of proven enclosures). Both are of the spline: the cubics through the states.
    #[arg(long, value_parser = parse_accuracy, default_value = "exact")]
    accuracy: Accuracy,
    #[command(flatten)]
    threads: Threads,
    /// File for the conflicts; standard output if not given, or -. A file is replaced when all is
    /// written.
    #[arg(long)]
    output: Option<PathBuf>,
    /// Print how much each stage has left to the next one, and the times, as one line on standard error.
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
enum StatsFormat {
    /// One JSON object on one line.
    Json,
}

impl Arguments {
    /// Returns the file for the conflicts, none if they go to standard output.
    fn output_file(&self) -> Option<&Path> {
        let output = self.output.as_deref();
        output.filter(|output| *output != Path::new("-"))
    }

    /// Checks options that are right one by one, but not together.
    fn check(&self) -> Result<(), String> {
        let rule = self.outside.to_possible_value();
        if let Some(rule) = rule.filter(|_| !matches!(self.outside, OutsideRule::Absent))
            && !self.window.is_closed()
        {
            return Err(format!(
                "--outside {} needs a window that is closed on both sides: --window=A..B",
                rule.get_name()
            ));
        }
        let Some(output) = self.output_file() else {
            return Ok(());
        };
        let hitboxes = self.hitboxes.as_ref();
        for (is_read, of) in [
            (terminal::is_source(&self.states, output), "states"),
            (
                hitboxes.is_some_and(|read| terminal::is_same_file(read, output)),
                "hitboxes",
            ),
        ] {
            if is_read {
                return Err(format!(
                    "--output {} is the file of {of} itself",
                    terminal::name(output)
                ));
            }
        }
        Ok(())
    }
}

fn main() -> ExitCode {
    let arguments = terminal::parse::<Arguments>();
    match arguments.check() {
        Ok(()) => terminal::exit_code(run(&arguments)),
        Err(message) => terminal::refuse::<Arguments>(message),
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let accuracy = arguments.accuracy;
    let output = arguments.output_file().map(Product::at).transpose()?;
    let pool = arguments.threads.pool()?;
    let progress = Progress::new();
    progress.say("reading");
    let Bodies {
        labels,
        bodies,
        unused,
    } = read::bodies(&arguments.states)?;
    let scene = build_scene(arguments, &labels, bodies)?;
    let query = Query::new(arguments.window)
        .with_margin(arguments.margin)
        .with_accuracy(accuracy);
    progress.begin(format!("screening {} bodies", scene.len()));
    let screening = pool
        .install(|| {
            scene.screen_with_progress(&query, |share| {
                progress.show(share);
                ControlFlow::Continue(())
            })
        })
        .map_err(|error| labels.explain(&error))?;
    progress.finish();
    terminal::tell_unused(&unused);
    for note in notes::of(&scene, &query, &screening) {
        terminal::complain(format_args!("note: {note}"));
    }
    let table = Table {
        scene: &scene,
        labels: &labels,
        conflicts: &screening.conflicts,
        accuracy,
    };
    match output {
        None => write::to_standard_output(&table)?,
        Some(product) => product.write(|file| table.write(file))?,
    }
    if let Some(StatsFormat::Json) = arguments.stats {
        let threads = pool.current_num_threads();
        terminal::complain(write::stats_line(&screening.stats, threads));
    }
    Ok(())
}

fn build_scene(
    arguments: &Arguments,
    labels: &Labels,
    bodies: Vec<FileBody>,
) -> Result<Scene, String> {
    let outside = match arguments.outside {
        OutsideRule::Absent => Outside::Absent,
        OutsideRule::Extrapolate => Outside::Extrapolate,
        OutsideRule::Coast => Outside::Coast,
    };
    let hitboxes = arguments.hitboxes.as_deref().map(Hitboxes::read);
    let mut hitboxes = match hitboxes.transpose()? {
        Some(hitboxes) => {
            let tags: Vec<u64> = bodies.iter().map(|body| body.tag).collect();
            hitboxes.by_tag(labels, &tags)?
        }
        None => BTreeMap::new(),
    };
    if arguments.hitbox.is_some() && bodies.iter().any(|body| body.radius.is_some()) {
        return Err(format!(
            "--radius: {} has a column radius; leave one of the two out",
            terminal::name(&arguments.states)
        ));
    }
    let mut scene = Scene::new();
    // Ids in the order of the labels: conflicts then come out with a < b in the file's own terms.
    for body in bodies {
        let tag = body.tag;
        let (hitbox, orientation) = match hitboxes.remove(&tag) {
            Some(own) => own,
            None => (hitbox(arguments, body.radius)?, Orientation::FIXED),
        };
        let body = Body::new(body.trajectory.with_outside(outside))
            .with_hitbox(hitbox)
            .with_orientation(orientation)
            .with_tag(tag);
        let inserted = scene.insert(body);
        inserted.map_err(|error| labels.explain(&error.in_body(tag)))?;
    }
    Ok(scene)
}

/// Returns the hitbox of a body that has this radius in the file.
fn hitbox(arguments: &Arguments, radius: Option<f64>) -> Result<Hitbox, String> {
    match (&arguments.hitbox, radius) {
        (Some(hitbox), _) => Ok(hitbox.clone()),
        (None, Some(radius)) => Hitbox::sphere(radius).map_err(|error| error.to_string()),
        (None, None) => Ok(Hitbox::POINT),
    }
}

fn parse_radius(text: &str) -> Result<Hitbox, String> {
    let radius = terminal::number(text)?;
    let range = format!("{radius:?} m is not a number from 0 to 1e300");
    Hitbox::sphere(radius).map_err(|_| range)
}

fn parse_accuracy(text: &str) -> Result<Accuracy, String> {
    match text {
        "exact" => Ok(Accuracy::Exact),
        "certified" => Ok(Accuracy::Certified),
        "fast" => Err("fast is not offered any more: exact takes the same time".to_owned()),
        _ => Err("expected exact or certified".to_owned()),
    }
}

fn parse_window(text: &str) -> Result<Window, String> {
    if text.contains("...") {
        return Err(
            "a dot too many: write A..B, and a fraction with a digit before its point, like 0.5"
                .to_owned(),
        );
    }
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
                .ok_or_else(|| {
                    let value = terminal::quoted(number.as_bytes());
                    format!("{value} is not a time in seconds; write it like 2.5 or 1e3")
                }),
        }
    };
    Window::new(bound(start, f64::NEG_INFINITY)?, bound(end, f64::INFINITY)?)
        .map_err(|error| error.to_string())
}
