//! Standard output and standard error of the examples.

use super::escape::escaped;
use std::fmt::Display;
use std::io::{Error, ErrorKind, Result, Stdout, Write};
use std::process::ExitCode;

/// Standard output for as long as someone reads it. One who has seen enough (`| head`) ends what is
/// said, not what is done.
#[derive(Debug)]
pub(crate) struct StandardOutput(Stdout);

impl StandardOutput {
    pub(crate) fn new() -> Self {
        Self(std::io::stdout())
    }
}

impl Write for StandardOutput {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        forgive(self.0.write(bytes), bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        forgive(self.0.flush(), ())
    }
}

fn forgive<T>(result: Result<T>, otherwise: T) -> Result<T> {
    match result {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(otherwise),
        // An interrupted call is made again by whoever made it.
        Err(error) if error.kind() != ErrorKind::Interrupted => {
            let message = format!("standard output: {error}");
            Err(Error::new(error.kind(), message))
        }
        result => result,
    }
}

/// A line on standard error, with escapes for what is not printed. If that is closed too there is nobody left to tell.
pub(crate) fn complain(line: impl Display) {
    let line = escaped(line.to_string().as_bytes());
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Returns the exit code of a run; a failure is told in one line.
pub(crate) fn exit_code(result: std::result::Result<(), impl Display>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            complain(format_args!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}

/// Says which columns of a file are not used.
pub(crate) fn tell_unused(columns: &[String]) {
    if !columns.is_empty() {
        complain(format_args!("not used: column {}", columns.join(", ")));
    }
}
