//! A game around a monitor: bodies that change their plans as they fly, and what is predicted.
//!
//! ```text
//! cargo run --release --example game_loop -- [--bodies N] [--replan FRACTION] [--avoid on|off]
//!     [--seed K] [--screenshot FILE.png --seconds S]
//! ```
//!
//! opens a window;
//!
//! ```text
//! cargo run --release --example game_loop -- --headless [--seconds S] [--bodies N]
//!     [--replan FRACTION] [--avoid on|off] [--seed K] [--threads T]
//! ```
//!
//! runs the same loop at 60 Hz of simulated time without one, and prints one line of JSON.
//! `fleet` flies, `steering` steers, `game` is a tick of both under the monitor, `tally` counts,
//! and checks the monitor against the bodies' plain positions.

mod draw;
mod fleet;
mod game;
mod headless;
mod panel;
mod shapes;
mod steering;
mod tally;
mod window;

use clap::{Parser, ValueEnum};
use std::error::Error as StdError;
use std::path::PathBuf;
use std::process::ExitCode;

/// Hundreds to thousands of bodies under a monitor, sixty times a second.
#[derive(Clone, Debug, Parser)]
#[command(name = "game_loop")]
pub(crate) struct Arguments {
    /// Run without a window, as fast as it goes, and print one line of JSON.
    #[arg(long)]
    headless: bool,
    /// Simulated time, s.
    #[arg(long, default_value_t = 20.0)]
    seconds: f64,
    /// How many bodies; 1,000 if not given, with a window 300.
    #[arg(long)]
    bodies: Option<usize>,
    /// Share of the bodies that get a new plan every tick.
    #[arg(long, default_value_t = 0.01)]
    replan: f64,
    /// Whether the bodies steer clear of what the monitor predicts.
    #[arg(long, value_enum, default_value_t = Avoid::On)]
    avoid: Avoid,
    /// The same seed gives the same run.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads to run on; all cores if not given.
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Write a picture of the window after `--seconds` of simulated time, and leave.
    #[arg(long)]
    screenshot: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Avoid {
    On,
    Off,
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: Arguments) -> Result<(), Box<dyn StdError + Send + Sync>> {
    if !(0.0..=1.0).contains(&arguments.replan) {
        let share = arguments.replan;
        return Err(format!("--replan {share} is not a share between 0 and 1").into());
    }
    if !arguments.headless {
        return window::open(arguments);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build()?;
    println!("{}", pool.install(|| headless::run(&arguments))?);
    Ok(())
}
