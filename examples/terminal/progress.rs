//! The progress of long work, on standard error if that is a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// A line that says what is being done, with a bar where it is known how far that is. It vanishes at the end.
#[derive(Debug)]
pub(crate) struct Progress(ProgressBar);

impl Progress {
    const STEPS: u64 = 100;

    pub(crate) fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner();
        bar.enable_steady_tick(Duration::from_millis(120));
        Self(bar)
    }

    /// Shows the work in progress, without a share of it.
    pub(crate) fn say(&self, what: &'static str) {
        self.0.set_message(what);
    }

    /// Shows the work from now on, with a bar.
    pub(crate) fn begin(&self, what: String) {
        let template = "{spinner} {msg} {wide_bar} {percent} % {elapsed_precise}";
        let style = ProgressStyle::with_template(template);
        self.0
            .set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        self.0.set_length(Self::STEPS);
        self.0.reset_elapsed();
        self.0.set_message(what);
    }

    /// Shows the share of the work that is done, 0 to 1; threads may tell it in any order.
    pub(crate) fn show(&self, share: f64) {
        // Rounded down: 100 % is when all is done.
        let done = (1..=Self::STEPS).take_while(|&step| share * 100.0 >= step as f64);
        self.0.set_position(done.count() as u64);
    }

    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}
