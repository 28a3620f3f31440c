//! The thread of a live monitor.

use super::handle::{Counts, Shared};
use super::report::{LiveOptions, Report, ReportKind};
use super::request::{Request, RequestQueue, Ticket};
use super::stopped::{Panicked, Stopped};
use crate::conflict::Conflict;
use crate::error::Error;
use crate::id::BodyId;
use crate::monitor::{Budget, Event, Monitor};
use crate::scene::BodyState;
use crossbeam_channel::{Receiver, RecvError, Sender, TryRecvError, TrySendError, select};
use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

#[derive(Debug)]
pub(super) struct Worker {
    monitor: Monitor,
    requests: Receiver<(Ticket, Request)>,
    reports: Sender<Report>,
    /// Disconnects when the thread is to stop. A message wakes it, to see that requests were stopped.
    stop: Receiver<()>,
    shared: Arc<Shared>,
    options: LiveOptions,
    queue: RequestQueue,
    /// Reports that the reader has no room for.
    outbox: VecDeque<Report>,
    /// Number of reports so far.
    reported: u64,
    events: Vec<Event>,
    /// Catching up was refused: it is not tried again before something is requested.
    stuck: bool,
}

impl Worker {
    pub(super) fn new(
        monitor: Monitor,
        (requests, reports, stop): (Receiver<(Ticket, Request)>, Sender<Report>, Receiver<()>),
        shared: Arc<Shared>,
        options: LiveOptions,
    ) -> Self {
        Self {
            queue: RequestQueue::at(monitor.now(), monitor.lookahead()),
            monitor,
            requests,
            reports,
            stop,
            shared,
            options,
            outbox: VecDeque::new(),
            reported: 0,
            events: Vec::new(),
            stuck: false,
        }
    }

    /// Works until it is stopped or panics. Returns all it had; whoever joins it completes reports and counts.
    pub(super) fn run(mut self) -> Result<Stopped, Box<Panicked>> {
        let mut in_hand = 0;
        let panic = loop {
            if self.receive().is_err() {
                break None;
            }
            let next = self.queue.pop();
            in_hand = u64::from(next.is_some());
            // A panic leaves at worst half-filled buffers, a search and what was read of it to be
            // made anew: all else takes effect at the end of a step, by moves that do not panic.
            let step = catch_unwind(AssertUnwindSafe(|| self.step(next)));
            if let Err(payload) = step {
                break Some(message_of(payload.as_ref()));
            }
            if self.deliver().is_err() {
                break None;
            }
        };
        self.shared.close();
        self.monitor.interrupt = None;
        let mut unapplied = Vec::new();
        unapplied.extend(std::iter::from_fn(|| self.queue.pop()));
        unapplied.extend(self.requests.try_iter());
        self.shared.ended().refused += unapplied.len() as u64;
        let (reports, counts) = (self.outbox.into(), Counts::default());
        let Some(message) = panic else {
            return Ok(Stopped {
                monitor: self.monitor,
                reports,
                unapplied,
                counts,
            });
        };
        // The request that panicked has come to no other end.
        self.shared.ended().refused += in_hand;
        // All that can be derived from the scene is worked out anew.
        let mut monitor = self.monitor;
        let is_whole = monitor.forget_search().is_ok();
        Err(Box::new(Panicked {
            message,
            monitor: is_whole.then(|| Box::new(monitor)),
            reports,
            unapplied,
            counts,
        }))
    }

    /// Takes in what has been sent; waits for something only if there is nothing else to do.
    ///
    /// # Errors
    ///
    /// If the thread is to end.
    fn receive(&mut self) -> Result<(), RecvError> {
        if self.stop.try_recv() == Err(TryRecvError::Disconnected) {
            return Err(RecvError);
        }
        while self.queue.len() == 0 && (self.monitor.is_known() || self.stuck) {
            // In this request: none is added once they are stopped.
            if self.shared.is_closed() && self.requests.is_empty() {
                return Err(RecvError);
            }
            select! {
                recv(self.requests) -> request => match request {
                    Ok((ticket, request)) => self.take(ticket, request),
                    Err(_) => return Err(RecvError),
                },
                recv(self.stop) -> message => message?,
            }
        }
        while self.queue.len() < self.options.requests {
            match self.requests.try_recv() {
                Ok((ticket, request)) => self.take(ticket, request),
                Err(_) => break,
            }
        }
        Ok(())
    }

    fn take(&mut self, ticket: Ticket, request: Request) {
        self.stuck = false;
        let superseded = self.queue.push(ticket, request);
        self.shared.ended().superseded += superseded;
    }

    /// Carries out one request, or catches up if there is none.
    fn step(&mut self, next: Option<(Ticket, Request)>) {
        let Some((ticket, request)) = next else {
            // Time stands still.
            if let Err(error) = self.tick(self.monitor.now()) {
                self.stuck = true;
                self.report(ReportKind::Stuck { error });
            }
            return;
        };
        let outcome = match request {
            Request::Change(command) => {
                let ids = self.monitor.apply_one(command);
                ids.map(|ids| self.applied(ticket, ids))
            }
            Request::Batch(commands) => {
                let ids = self.monitor.apply(commands);
                ids.map(|ids| self.applied(ticket, ids))
            }
            Request::Track(now, states) => self.track(ticket, now, states),
            Request::Clock(now) => {
                let done = self.tick(now);
                self.with_clock(done)
            }
            Request::SkipTo(now) => {
                let done = self.monitor.skip_to(now);
                self.with_clock(done)
            }
            Request::WhatIf(id, plan, level) => {
                let conflicts = self.monitor.what_if(id, &plan, level);
                conflicts.map(|conflicts| Some(self.what_if(ticket, conflicts)))
            }
            Request::WhatIfPlans(plans, level) => {
                let plans = plans.iter().map(|(id, plan)| (*id, plan));
                let conflicts = self.monitor.what_if_plans(plans, level);
                conflicts.map(|conflicts| Some(self.what_if(ticket, conflicts)))
            }
            Request::WhatIfBody(body, level) => {
                let conflicts = self.monitor.what_if_body(&body, level);
                conflicts.map(|conflicts| Some(self.what_if(ticket, conflicts)))
            }
            #[cfg(test)]
            Request::Panic => panic!("requested to"),
        };
        match outcome {
            Ok(report) => {
                self.shared.ended().applied += 1;
                report.into_iter().for_each(|kind| self.report(kind));
            }
            Err(error) => {
                self.shared.ended().refused += 1;
                self.report(ReportKind::Refused { ticket, error });
            }
        }
    }

    /// Returns the outcome of a request that moves the clock.
    fn with_clock(&mut self, done: Result<(), Error>) -> Result<Option<ReportKind>, Error> {
        if done.is_err() {
            self.queue.stay_at(self.monitor.now());
        }
        done.map(|()| None)
    }

    /// Returns the answer to a question.
    const fn what_if(&self, ticket: Ticket, conflicts: Vec<Conflict>) -> ReportKind {
        ReportKind::WhatIf {
            ticket,
            conflicts,
            complete_until: self.monitor.complete_until(),
        }
    }

    /// Reports the plans that were late; returns the report of the bodies that were put in.
    fn applied(&mut self, ticket: Ticket, ids: Vec<BodyId>) -> Option<ReportKind> {
        let plans: Vec<_> = self.monitor.batch.late().collect();
        if !plans.is_empty() {
            self.report(ReportKind::Late { ticket, plans });
        }
        (!ids.is_empty()).then_some(ReportKind::Inserted { ticket, ids })
    }

    /// Lets bodies follow straight motions; returns the report of those that were late.
    fn track(
        &mut self,
        ticket: Ticket,
        now: f64,
        states: Vec<(BodyId, BodyState)>,
    ) -> Result<Option<ReportKind>, Error> {
        self.monitor.track(now, states)?;
        let plans = self.monitor.told.late.clone();
        Ok((!plans.is_empty()).then_some(ReportKind::Late { ticket, plans }))
    }

    fn tick(&mut self, now: f64) -> Result<(), Error> {
        self.events.clear();
        let budget = Budget::Time(self.options.budget);
        self.monitor.advance_within(now, budget, &mut self.events)?;
        let (now, complete_until) = (self.monitor.now(), self.monitor.complete_until());
        let mut events = std::mem::take(&mut self.events);
        for event in events.drain(..) {
            self.report(ReportKind::Event(event));
        }
        self.events = events;
        self.report(ReportKind::Ticked {
            now,
            complete_until,
        });
        self.shared.publish(now, complete_until);
        Ok(())
    }

    fn report(&mut self, kind: ReportKind) {
        let sequence = self.reported;
        self.reported += 1;
        self.outbox.push_back(Report { sequence, kind });
    }

    /// Hands the reports over; waits for the reader where there is no room.
    fn deliver(&mut self) -> Result<(), RecvError> {
        while let Some(report) = self.outbox.pop_front() {
            match self.reports.try_send(report) {
                Ok(()) => {}
                Err(TrySendError::Disconnected(report)) => {
                    self.outbox.push_front(report);
                    return Err(RecvError);
                }
                Err(TrySendError::Full(report)) => {
                    self.outbox.push_front(report);
                    self.wait_for_reader()?;
                }
            }
        }
        Ok(())
    }

    /// Hands one report over as soon as there is room, unless it is woken before.
    fn wait_for_reader(&mut self) -> Result<(), RecvError> {
        let Some(report) = self.outbox.front() else {
            return Ok(());
        };
        select! {
            send(self.reports, report.clone()) -> sent => match sent {
                Ok(()) => {
                    self.outbox.pop_front();
                    Ok(())
                }
                Err(_) => Err(RecvError),
            },
            recv(self.stop) -> message => message,
        }
    }
}

/// Returns the message of a panic.
pub(super) fn message_of(payload: &(dyn Any + Send)) -> String {
    payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned())
}
