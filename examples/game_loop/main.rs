//! A game around a monitor: bodies that change their plans as they fly, and what is predicted.
//!
//! ```text
//! cargo run --release --example game_loop -- [--bodies N] [--replan FRACTION] [--avoid on|off]
//!     [--seed K] [--threads T] [--screenshot FILE.png --seconds S]
//! ```
//!
//! opens a window;
//!
//! ```text
//! cargo run --release --example game_loop -- --headless [--seconds S] [--bodies N]
//!     [--replan FRACTION] [--avoid on|off] [--seed K] [--threads T] [--ships]
//! ```
//!
//! runs the same loop at 60 Hz of simulated time without one, and prints one line of JSON. The bodies are another
//! setting, the yardstick of the monitor: 1,000 spheres of 1 m, farther apart than in the window. With `--ships`
//! they are the window's: ships along their flight, drones and asteroids that spin, each in spheres fitted to the
//! shape that is drawn, over a floor. `unpredicted` then counts the contacts of spheres with each other and with the
//! floor, seen at sampled instants, that no event had predicted; `grounded` counts those
//! with the floor, predicted or not.
//!
//! `fleet` flies over the `floor`, `solids` are the shapes, `steering` steers, `game` is a tick of all under the
//! monitor, `tally` counts, and checks the monitor against the bodies' plain positions, `truth` against their spheres.

mod captions;
mod draw;
mod feed;
mod fleet;
mod floor;
mod game;
mod headless;
mod hover;
mod labels;
mod panel;
mod shapes;
mod solids;
mod steering;
mod tally;
#[path = "../terminal/mod.rs"]
mod terminal;
mod truth;
mod window;

use clap::{Parser, ValueEnum};
use std::error::Error as StdError;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use terminal::{Product, StandardOutput, Threads};

/// Bodies in the window, if no number is given.
const SHIPS: usize = 300;

type Failure = Box<dyn StdError + Send + Sync>;

/// Hundreds to thousands of bodies under a monitor, sixty times a second.
#[derive(Clone, Debug, Parser)]
#[command(name = "game_loop")]
pub(crate) struct Arguments {
    /// Run without a window, as fast as it goes, and print one line of JSON. The bodies are not those of the
    /// window unless --ships is given: spheres of 1 m, farther apart. In the line, `lost` counts overlaps and ends that the
    /// monitor should have told and did not, and `lag_s` is the longest part of the lookahead that was not examined.
    #[arg(long)]
    headless: bool,
    /// With --headless: the window's ships, drones and asteroids, over a floor; counts contacts with the floor
    /// (`grounded`), and contacts that were not predicted (`unpredicted`).
    #[arg(long)]
    ships: bool,
    /// Simulated time, s; of a window, before its picture is taken.
    #[arg(
        long,
        value_parser = terminal::within(0.01..=1e6),
        default_value = "20",
        allow_hyphen_values = true
    )]
    seconds: f64,
    /// Number of bodies; 1,000 if not given, with a window or --ships 300.
    #[arg(long, value_parser = terminal::bodies(), allow_negative_numbers = true)]
    bodies: Option<usize>,
    /// Share of the bodies that get a new plan every tick.
    #[arg(
        long,
        value_parser = terminal::within(0.0..=1.0),
        default_value = "0.01",
        allow_hyphen_values = true
    )]
    replan: f64,
    /// The bodies steer clear of what the monitor predicts, or not.
    #[arg(long, value_enum, default_value_t = Avoid::On)]
    avoid: Avoid,
    /// The same seed gives the same run.
    #[arg(long, value_parser = terminal::whole(0..=u64::MAX), default_value = "1", allow_negative_numbers = true)]
    seed: u64,
    #[command(flatten)]
    threads: Threads,
    /// Write a picture of the window (.png) after `--seconds` of simulated time, and leave.
    #[arg(long, value_parser = parse_png, conflicts_with = "headless")]
    screenshot: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Avoid {
    On,
    Off,
}

/// The name says in which format a picture is written.
fn parse_png(name: &str) -> Result<PathBuf, String> {
    let path = Path::new(name);
    let is_png = |ending: &OsStr| ending.eq_ignore_ascii_case("png");
    if path.extension().is_some_and(is_png) {
        Ok(path.to_owned())
    } else {
        Err("the name of a picture ends in .png".to_owned())
    }
}

fn main() -> ExitCode {
    let arguments = terminal::parse::<Arguments>();
    if arguments.ships && !arguments.headless {
        terminal::refuse::<Arguments>("--ships is for --headless: the window shows them anyway");
    }
    terminal::exit_code(run(arguments))
}

fn run(arguments: Arguments) -> Result<(), Failure> {
    let pool = arguments.threads.pool()?;
    if !arguments.headless {
        if let Some(path) = &arguments.screenshot {
            // The window cannot say so kindly, and only at the end.
            Product::at(path)?;
        }
        // On this thread, which is one of the pool: some systems have windows on the first one only.
        return pool.install(|| window::open(arguments));
    }
    let line = pool.install(|| headless::run(&arguments))?;
    writeln!(StandardOutput::new(), "{line}")?;
    Ok(())
}
