//! Options of command lines. Values out of range are refused by clap: exit code 2.
//!
//! Options that take fractions allow all values with a hyphen: clap does not take `-1e-3` for a
//! negative number.

use super::number::shortest;
use super::speech::complain;
use clap::error::{ContextKind, ErrorKind};
use clap::{Args, CommandFactory, Parser};
use nearmiss::{Error, MAX_MAGNITUDE};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// More threads than any machine has cores help nobody, and far more than that cannot be started.
const MAX_THREADS: usize = 1_024;

/// More bodies do not fit into memory.
const MAX_BODIES: usize = 100_000_000;

/// The number of threads of an example.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Threads {
    /// Threads to run on; all cores if not given, or 0.
    #[arg(
        long,
        value_parser = whole(0..=MAX_THREADS),
        default_value = "0",
        allow_negative_numbers = true
    )]
    threads: usize,
}

impl Threads {
    /// These threads, the caller's among them: what it has read lies in its caches. An error says
    /// which option asked for them.
    pub(crate) fn pool(self) -> Result<ThreadPool, String> {
        ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .use_current_thread()
            .build()
            .map_err(|error| format!("--threads: {error}"))
    }
}

/// A number of bodies in a scene that is made up.
pub(crate) fn bodies() -> impl Fn(&str) -> Result<usize, String> + Clone + Send + Sync + 'static {
    whole(1..=MAX_BODIES)
}

/// A whole number in this range.
pub(crate) fn whole<T>(
    range: RangeInclusive<T>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: TryFrom<i128> + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text| {
        let number: i128 = text
            .parse()
            .map_err(|_| "not a whole number; write it like 12")?;
        let within = T::try_from(number)
            .ok()
            .filter(|number| range.contains(number));
        within.ok_or_else(|| {
            let (least, most) = (range.start(), range.end());
            format!("{number} is not in {least}..={most}")
        })
    }
}

/// A finite number in this range.
pub(crate) fn within(
    range: RangeInclusive<f64>,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| {
        let number = number(text)?;
        let (least, most) = (range.start(), range.end());
        if range.contains(&number) {
            Ok(number)
        } else {
            let [number, least, most] = [number, *least, *most].map(shortest);
            Err(format!("{number} is not in {least}..={most}"))
        }
    }
}

/// A margin that a query takes, m.
pub(crate) fn margin(text: &str) -> Result<f64, String> {
    let margin = number(text)?;
    if margin.abs() <= MAX_MAGNITUDE {
        Ok(margin)
    } else {
        Err(Error::Margin { margin }.to_string())
    }
}

pub(crate) fn number(text: &str) -> Result<f64, String> {
    let number = text.parse();
    number.map_err(|_| "not a number; write it like 2.5 or 1e3".to_owned())
}

/// The command line. Ends the process as clap does if it is wrong, or asks for help.
pub(crate) fn parse<A: Parser>() -> A {
    A::try_parse().unwrap_or_else(|mut error| {
        if error.kind() == ErrorKind::UnknownArgument {
            // To pass an option as the name of a file.
            error.remove(ContextKind::Suggested);
        }
        end(&error)
    })
}

/// Ends the process as clap does, over what clap cannot know: options that do not go together.
pub(crate) fn refuse<A: CommandFactory>(message: impl Display) -> ! {
    end(&A::command().error(ErrorKind::ArgumentConflict, message))
}

fn end(error: &clap::Error) -> ! {
    if !error.use_stderr() {
        error.exit();
    }
    // It repeats what was given.
    error.to_string().lines().for_each(complain);
    std::process::exit(error.exit_code())
}
