//! A game around a monitor: bodies that change their plans as they fly, and what is predicted.
//!
//! ```text
//! cargo run --release --example game_loop -- --headless [--seconds S] [--bodies N]
//!     [--replan FRACTION] [--avoid on|off] [--seed K] [--threads T]
//! ```
//!
//! prints one line of JSON. `fleet` flies and steers, `headless` runs it at 60 Hz of simulated
//! time, `tally` counts, and checks the monitor against the bodies' plain positions.

mod fleet;
mod headless;
mod steering;
mod tally;

use clap::{Parser, ValueEnum};
use std::error::Error as StdError;

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
    /// How many bodies.
    #[arg(long, default_value_t = 1_000)]
    bodies: usize,
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
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Avoid {
    On,
    Off,
}

fn main() -> Result<(), Box<dyn StdError + Send + Sync>> {
    let arguments = Arguments::parse();
    if !arguments.headless {
        return Err("this build has no window: run it with --headless".into());
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build()?;
    println!("{}", pool.install(|| headless::run(&arguments))?);
    Ok(())
}
