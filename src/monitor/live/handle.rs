//! The sending side of a live monitor.

#![allow(
    clippy::result_large_err,
    reason = "a request that is not sent is handed back as it is, without an allocation"
)]

use super::request::{Request, Ticket};
use crate::id::BodyId;
use crate::scene::{Body, BodyPlan, BodyState};

use crossbeam_channel::{Sender, TrySendError};
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

/// A request that was not sent, handed back.
#[derive(Clone, Debug, PartialEq)]
pub enum Unsent {
    /// The queue is full: try again later, or drop the request.
    Busy(Request),
    /// The monitor takes no more requests, was shut down, or panicked.
    Closed(Request),
}

impl Unsent {
    /// Returns the request.
    #[must_use]
    pub fn into_request(self) -> Request {
        match self {
            Self::Busy(request) | Self::Closed(request) => request,
        }
    }
}

impl fmt::Display for Unsent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy(_) => write!(f, "the live monitor has as many requests as may wait"),
            Self::Closed(_) => write!(f, "the live monitor takes no more requests"),
        }
    }
}

impl std::error::Error for Unsent {}

/// Numbers of requests by their outcome.
///
/// `sent = applied + superseded + refused + waiting`, and nothing waits after a shutdown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counts {
    /// Number of requests accepted by [`Handle::send`].
    pub sent: u64,
    /// Number of requests that have taken effect.
    pub applied: u64,
    /// Number of requests left out because a later one replaces them.
    pub superseded: u64,
    /// Number of requests refused with an error, or not applied before the shutdown.
    pub refused: u64,
}

/// State shared by the thread and the handles.
#[derive(Debug, Default)]
pub(super) struct Shared {
    now: AtomicU64,
    complete_until: AtomicU64,
    sent: AtomicU64,
    tickets: AtomicU64,
    /// Numbers of requests by how they ended; `sent` lies beside it, so that no sender waits.
    ended: Mutex<Counts>,
    /// Written at the end alone: after it no request slips into a queue nobody reads.
    closed: RwLock<bool>,
}

impl Shared {
    pub(super) fn publish(&self, now: f64, complete_until: f64) {
        self.now.store(now.to_bits(), Ordering::Release);
        self.complete_until
            .store(complete_until.to_bits(), Ordering::Release);
    }

    pub(super) fn ended(&self) -> MutexGuard<'_, Counts> {
        self.ended.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn is_closed(&self) -> bool {
        *self.closed.read().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn close(&self) {
        *self.closed.write().unwrap_or_else(PoisonError::into_inner) = true;
    }
}

/// Sends requests to a live monitor, under the contract written at [`Live`](super::Live). Cheap to
/// clone; usable from any thread.
///
/// No request blocks. What the monitor refuses of a request that was sent comes as
/// [`ReportKind::Refused`](super::ReportKind::Refused), with the error of the monitor's function of the same name.
#[derive(Clone, Debug)]
pub struct Handle {
    requests: Sender<(Ticket, Request)>,
    shared: Arc<Shared>,
}

impl Handle {
    pub(super) fn new(requests: Sender<(Ticket, Request)>, now: f64, complete_until: f64) -> Self {
        let shared = Arc::<Shared>::default();
        shared.publish(now, complete_until);
        Self { requests, shared }
    }

    pub(super) const fn shared(&self) -> &Arc<Shared> {
        &self.shared
    }

    /// Sends one change, a batch, or a clock request.
    ///
    /// # Errors
    ///
    /// [`Unsent`], with the request: [`Busy`](Unsent::Busy) if the queue is full,
    /// [`Closed`](Unsent::Closed) if nobody reads it any more.
    pub fn send(&self, request: impl Into<Request>) -> Result<Ticket, Unsent> {
        let request = request.into();
        let closed = self.shared.closed.read();
        let closed = closed.unwrap_or_else(PoisonError::into_inner);
        if *closed {
            return Err(Unsent::Closed(request));
        }
        // The lock is held: the thread does not empty the queue for the last time before this is in it.
        let ticket = Ticket(self.shared.tickets.fetch_add(1, Ordering::Relaxed));
        // Counted before it can be applied, so that the sum is never short.
        self.shared.sent.fetch_add(1, Ordering::Relaxed);
        self.requests.try_send((ticket, request)).map_err(|error| {
            self.shared.sent.fetch_sub(1, Ordering::Relaxed);
            match error {
                TrySendError::Full((_, request)) => Unsent::Busy(request),
                TrySendError::Disconnected((_, request)) => Unsent::Closed(request),
            }
        })?;
        Ok(ticket)
    }

    /// Lets each of these bodies follow a straight motion from its state, from `now` (s) on: see
    /// [`Monitor::track`](crate::Monitor::track). States that come late are reported as
    /// [`ReportKind::Late`](super::ReportKind::Late).
    ///
    /// A feed that tells all bodies and moves the clock in each frame is carried out frame by frame: nothing in it is
    /// superseded. If the thread cannot keep up, the queue fills, and this returns [`Unsent::Busy`]. Then leave the frame
    /// out: the next one tells where the bodies are by then. Give such a feed a
    /// [queue of few requests](super::LiveOptions::with_requests), as below: by default it fills after 4,096, up to a
    /// minute late, and holds 128 bytes for each state told.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::live::LiveOptions;
    /// # use nearmiss::{AlertLevel, Body, Monitor, Scene, State, Trajectory};
    /// # let mut scene = Scene::new();
    /// # let ship = scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    /// # let monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(2.0)])?;
    /// let live = monitor.spawn(LiveOptions::default().with_requests(4))?;
    /// live.handle().track(0.5, [(ship, State::new(0.5, DVec3::X, DVec3::Y))])?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`send`](Self::send).
    pub fn track<S: Into<BodyState>>(
        &self,
        now: f64,
        states: impl IntoIterator<Item = (BodyId, S)>,
    ) -> Result<Ticket, Unsent> {
        let states = states.into_iter().map(|(id, state)| (id, state.into()));
        self.send(Request::Track(now, states.collect()))
    }

    /// Moves the clock to `now` (s).
    ///
    /// # Errors
    ///
    /// The errors of [`send`](Self::send).
    pub fn advance(&self, now: f64) -> Result<Ticket, Unsent> {
        self.send(Request::Clock(now))
    }

    /// Sets the clock to `now` (s) without looking at the time in between: see
    /// [`Monitor::skip_to`](crate::Monitor::skip_to).
    ///
    /// # Errors
    ///
    /// The errors of [`send`](Self::send).
    pub fn skip_to(&self, now: f64) -> Result<Ticket, Unsent> {
        self.send(Request::SkipTo(now))
    }

    /// Asks which conflicts a body would have, at an alert level, if it followed `plan` from now on: see
    /// [`Monitor::what_if`](crate::Monitor::what_if). The answer is the
    /// [`ReportKind::WhatIf`](super::ReportKind::WhatIf) with this ticket. It is refused with
    /// [`Error::NothingKnown`](crate::Error::NothingKnown) while the monitor is behind its clock.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::live::{LiveOptions, ReportKind};
    /// # use nearmiss::{AlertLevel, Body, Monitor, Scene, State, Trajectory};
    /// # let mut scene = Scene::new();
    /// # let wall = scene.insert(Body::new(Trajectory::at_rest(9.0 * DVec3::X)?))?;
    /// # let ship = scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    /// # let mut monitor = Monitor::new(scene, 0.0, 10.0, &[AlertLevel::at(2.0)])?;
    /// # monitor.advance(0.0, &mut Vec::new())?;
    /// let live = monitor.spawn(LiveOptions::default())?;
    /// let ahead = Trajectory::coasting(State::new(0.0, DVec3::ZERO, DVec3::X))?;
    /// let question = live.handle().what_if(ship, ahead, 0)?;
    /// let answer = live.reports().iter().find_map(|report| match report.kind {
    ///     ReportKind::WhatIf { ticket, conflicts, .. } if ticket == question => Some(conflicts),
    ///     _ => None,
    /// });
    /// // It would run into the wall: within 2 m from 7 s on.
    /// assert!(answer.is_some_and(|found| found[0].a == wall && found[0].enter == 7.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`send`](Self::send).
    pub fn what_if(
        &self,
        id: BodyId,
        plan: impl Into<BodyPlan>,
        level: usize,
    ) -> Result<Ticket, Unsent> {
        self.send(Request::WhatIf(id, plan.into(), level))
    }

    /// Asks which conflicts some bodies would have at an alert level if each followed its plan from now on: see
    /// [`Monitor::what_if_plans`](crate::Monitor::what_if_plans). The answer comes as that of [`what_if`](Self::what_if).
    /// No budget limits its time, in which the monitor does nothing else: ask about some hundred bodies at a time.
    ///
    /// # Errors
    ///
    /// The errors of [`send`](Self::send).
    pub fn what_if_plans(
        &self,
        plans: impl IntoIterator<Item = (BodyId, impl Into<BodyPlan>)>,
        level: usize,
    ) -> Result<Ticket, Unsent> {
        let plans = plans.into_iter().map(|(id, plan)| (id, plan.into()));
        self.send(Request::WhatIfPlans(plans.collect(), level))
    }

    /// Asks which conflicts a body that is not there yet would have at an alert level: see
    /// [`Monitor::what_if_body`](crate::Monitor::what_if_body). The answer comes as that of [`what_if`](Self::what_if).
    ///
    /// # Errors
    ///
    /// The errors of [`send`](Self::send).
    pub fn what_if_body(&self, body: Body, level: usize) -> Result<Ticket, Unsent> {
        self.send(Request::WhatIfBody(Box::new(body), level))
    }

    /// Returns the monitor's clock at its last tick, s. A clock that was [set ahead](Self::skip_to) shows with the next
    /// tick.
    #[must_use]
    pub fn now(&self) -> f64 {
        f64::from_bits(self.shared.now.load(Ordering::Acquire))
    }

    /// Returns the instant up to which nothing was missing at the last tick, s. All events up to the earlier of
    /// this instant and the clock have been reported, or wait to be read. Requests applied since count with the
    /// next tick.
    #[must_use]
    pub fn complete_until(&self) -> f64 {
        f64::from_bits(self.shared.complete_until.load(Ordering::Acquire))
    }

    /// Returns the numbers of requests so far, by their outcome.
    #[must_use]
    pub fn counts(&self) -> Counts {
        // The ends before the beginning: what is added in between makes `sent` larger, not smaller, and
        // an end that is seen was preceded by its beginning.
        let ended = *self.shared.ended();
        Counts {
            sent: self.shared.sent.load(Ordering::Acquire),
            ..ended
        }
    }
}
