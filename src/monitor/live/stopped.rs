//! The end of a live monitor.

use super::handle::Counts;
use super::report::Report;
use super::request::{Request, Ticket};
use crate::monitor::Monitor;
use std::fmt;

/// Everything that a live monitor leaves at its end.
#[derive(Debug)]
#[non_exhaustive]
pub struct Stopped {
    /// Monitor, as the last request left it.
    pub monitor: Monitor,
    /// Reports that no other reader has taken, in order.
    pub reports: Vec<Report>,
    /// Requests that were not applied, in order; counted as refused.
    pub unapplied: Vec<(Ticket, Request)>,
    /// Numbers of requests by their outcome.
    pub counts: Counts,
}

/// The thread panicked.
#[derive(Debug)]
#[non_exhaustive]
pub struct Panicked {
    /// Message of the panic.
    pub message: String,
    /// The monitor as the last whole request left it; none if even that cannot be made of it.
    pub monitor: Option<Box<Monitor>>,
    /// Reports that no other reader has taken, in order.
    pub reports: Vec<Report>,
    /// Requests that were not applied, in order, without the one that panicked; all count as
    /// refused.
    pub unapplied: Vec<(Ticket, Request)>,
    /// Numbers of requests by their outcome.
    pub counts: Counts,
}

impl fmt::Display for Panicked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the monitor's thread panicked: {}", self.message)
    }
}

impl std::error::Error for Panicked {}

impl Panicked {
    /// Returns the end of which only a message is left.
    pub(super) fn lost(message: String) -> Box<Self> {
        Box::new(Self {
            message,
            monitor: None,
            reports: Vec::new(),
            unapplied: Vec::new(),
            counts: Counts::default(),
        })
    }
}
