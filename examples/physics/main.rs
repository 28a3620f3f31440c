//! A physics engine with a monitor beside it, which says who will meet within the next two seconds:
//!
//! ```text
//! cargo run --release --example physics -- [--frames N] [--bodies N] [--boxes N] [--seed K]
//!     [--threads T] [--json]
//! ```
//!
//! rapier moves balls and boxes that bounce elastically between walls. Each frame the monitor is told
//! all states in one call, and its predictions are compared with the contacts that rapier has.
//!
//! A plan of the monitor is straight flight at a constant angular velocity. So a prediction holds until
//! one of the two bodies is deflected: another body or a wall changed its velocity or angular velocity,
//! or pushed it. Only predictions that no deflection precedes are judged.
//!
//! With `--json` the last line of standard output is one object: the options, `spheres`,
//! `overshoot_m` and `overshoot_percent` of a box's cover, `wall_contacts`, times per frame
//! (`physics_ms_p50`, `physics_ms_p99`, `nearmiss_ms_p50`, `nearmiss_ms_p99`), and in `pairs` the
//! counts of `ball_ball`, `ball_box` and `box_box`. The cover is larger than the box by up to the
//! overshoot. So contacts of boxes are predicted early, and some that do not come.
//!
//! `world` is rapier, `watch` the monitor, `tally` compares, `report` prints.

mod report;
mod tally;
#[path = "../terminal/mod.rs"]
mod terminal;
mod watch;
mod world;

use clap::Parser;
use report::Report;
use std::error::Error as StdError;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tally::Tally;
use terminal::{Progress, StandardOutput, Threads};
use watch::Watch;
use world::World;

/// Most balls, and most boxes: a million balls take 4.4 GB.
const MAX_BODIES: usize = 1_000_000;

type Failure = Box<dyn StdError + Send + Sync>;

/// Balls and boxes that bounce, and a monitor that predicts their contacts.
#[derive(Clone, Copy, Debug, Parser)]
#[command(name = "physics")]
struct Arguments {
    /// Frames of 1/60 s.
    #[arg(
        long,
        value_parser = terminal::whole(1..=1_000_000_u32),
        default_value_t = 600,
        allow_negative_numbers = true
    )]
    frames: u32,
    /// Number of balls, up to a million.
    #[arg(
        long,
        value_parser = terminal::whole(1..=MAX_BODIES),
        default_value = "2000",
        allow_negative_numbers = true
    )]
    bodies: usize,
    /// Number of boxes beside the balls, up to a million.
    #[arg(
        long,
        value_parser = terminal::whole(0..=MAX_BODIES),
        default_value = "200",
        allow_negative_numbers = true
    )]
    boxes: usize,
    /// The same seed gives the same run.
    #[arg(long, value_parser = terminal::whole(0..=u64::MAX), default_value = "1", allow_negative_numbers = true)]
    seed: u64,
    #[command(flatten)]
    threads: Threads,
    /// Ends with one line of JSON.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    terminal::exit_code(run(&terminal::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pool = arguments.threads.pool()?;
    let report = pool.install(|| play(arguments))?;
    let mut out = StandardOutput::new();
    report.print(&mut out)?;
    if arguments.json {
        report.print_json(&mut out)?;
    }
    Ok(())
}

/// Moves the world frame by frame, and compares what is predicted with what happens.
fn play(arguments: &Arguments) -> Result<Report, Failure> {
    let progress = Progress::new();
    progress.say("making the world");
    let mut world = World::new(arguments.bodies, arguments.boxes, arguments.seed);
    let mut states = world.states();
    let mut watch = Watch::new(&states)?;
    let mut tally = Tally::new(&states);
    let (mut physics, mut nearmiss) = (Vec::new(), Vec::new());
    progress.begin(format!("moving {} bodies", states.len()));
    for frame in 0..arguments.frames {
        let begin = Instant::now();
        let events = watch.tell(frame, &states)?;
        nearmiss.push(milliseconds(begin.elapsed()));
        tally.read(frame, &states, events);

        let begin = Instant::now();
        let contacts = world.step();
        physics.push(milliseconds(begin.elapsed()));
        tally.compare(frame, &contacts);
        states = world.states();
        progress.show(f64::from(frame + 1) / f64::from(arguments.frames));
    }
    progress.finish();
    Ok(Report {
        arguments: *arguments,
        threads: rayon::current_num_threads(),
        cover: watch.cover,
        outcome: tally.finish(),
        physics,
        nearmiss,
    })
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
