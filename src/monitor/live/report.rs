//! Options and reports of a live monitor.

use super::request::Ticket;
use crate::conflict::Conflict;
use crate::error::Error;
use crate::id::BodyId;
use crate::monitor::Event;
use std::time::Duration;

/// Options of a live monitor. The contract at [`Live`](super::Live) explains queues and budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LiveOptions {
    /// Requests that may wait, 1 to [`MAX`](Self::MAX); 4,096 by default. There is room for all of them from
    /// the beginning, but for what they hold, as the states of [`Handle::track`](super::Handle::track); as many again may
    /// have left the queue and not be applied yet.
    pub requests: usize,
    /// Reports that may wait to be read, 1 to [`MAX`](Self::MAX); 4,096 by default. There is room for all of
    /// them from the beginning; those of the step at hand wait beside them.
    pub reports: usize,
    /// Work between two looks at the requests, wall time; exceeded as
    /// [`Budget::Time`](crate::Budget::Time) says. 10 ms by default.
    pub budget: Duration,
}

impl LiveOptions {
    /// Largest capacity of a queue: some hundred megabytes, without what its requests hold.
    pub const MAX: usize = 1 << 20;

    /// Returns the options with a capacity of the queue of requests.
    #[must_use]
    pub const fn with_requests(mut self, requests: usize) -> Self {
        self.requests = requests;
        self
    }

    /// Returns the options with a capacity of the queue of reports.
    #[must_use]
    pub const fn with_reports(mut self, reports: usize) -> Self {
        self.reports = reports;
        self
    }

    /// Returns the options with a budget.
    #[must_use]
    pub const fn with_budget(mut self, budget: Duration) -> Self {
        self.budget = budget;
        self
    }
}

impl Default for LiveOptions {
    /// Returns 4,096 requests, 4,096 reports, 10 ms.
    fn default() -> Self {
        Self {
            requests: 4_096,
            reports: 4_096,
            budget: Duration::from_millis(10),
        }
    }
}

/// A report of a live monitor, with its number. It cannot be serialised, since [`Error`] cannot; an [`Event`] and a
/// [`Ticket`] can.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// Number of reports before this one. None is missing, and none comes twice.
    pub sequence: u64,
    /// Kind and content.
    pub kind: ReportKind,
}

/// The kind of a report, with its content.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ReportKind {
    /// An event of the monitor.
    Event(Event),
    /// The clock was moved, or more was caught up. All events up to the earlier of `now` and `complete_until` have
    /// come before this.
    Ticked {
        /// The clock, s.
        now: f64,
        /// Instant up to which nothing is missing, s.
        complete_until: f64,
    },
    /// A request put bodies into the scene. This may be read before the call that sent the request has returned.
    Inserted {
        /// The request.
        ticket: Ticket,
        /// The bodies' ids, in the order in which they were given.
        ids: Vec<BodyId>,
    },
    /// Plans of a request, or states told by [`Handle::track`](super::Handle::track), were
    /// [late](crate::Monitor::replan): they are followed from later instants than it says.
    Late {
        /// The request.
        ticket: Ticket,
        /// The bodies, and the instants from which they follow their last plans, s.
        plans: Vec<(BodyId, f64)>,
    },
    /// The answer to [`Handle::what_if`](super::Handle::what_if),
    /// [`Handle::what_if_plans`](super::Handle::what_if_plans) or
    /// [`Handle::what_if_body`](super::Handle::what_if_body), worked out after all requests before it,
    /// and as far as the last tick had looked ahead. [`Refused`](Self::Refused) with
    /// [`Error::NothingKnown`] before the first tick, and while the budget leaves the monitor
    /// behind its clock.
    WhatIf {
        /// The request.
        ticket: Ticket,
        /// Conflicts of the body or bodies, as the methods of [`Monitor`](crate::Monitor) of the same names return them.
        conflicts: Vec<Conflict>,
        /// End of the examined time, s: later conflicts are not listed.
        complete_until: f64,
    },
    /// A request was refused, and changed nothing. (What it had [superseded](super::Request) is gone.)
    Refused {
        /// The request.
        ticket: Ticket,
        /// Reason.
        error: Error,
    },
    /// Catching up failed: for [too little room](Error::TooCrowded), say. The next request is
    /// followed by another attempt.
    Stuck {
        /// Error of the monitor.
        error: Error,
    },
}
