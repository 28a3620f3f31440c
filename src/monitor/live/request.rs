//! Requests to a live monitor, and the queue in which they wait.

use crate::id::BodyId;
use crate::monitor::Command;
use crate::monitor::grid::can_show;
use crate::scene::{Body, BodyPlan, BodyState};

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

/// Names one request: reports about it carry the same ticket.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ticket(pub(super) u64);

/// A request to a live monitor.
///
/// A plan replaces an earlier one of the same body altogether if it is
/// [`Command::SetTrajectory`], or if both are [`Command::Replan`] and the later one begins no
/// later than the earlier. Its plan must exist at that time and go on from there, and from the clock by then: otherwise it
/// may be refused, and the earlier one is kept. An earlier plan with an orientation is kept, too, unless the later one has
/// an orientation that leaves nothing of it, not even its tolerance. It may still be refused for a reason that only the scene knows: the body
/// is not there at that time, say. Then the earlier one is gone as well. A sender of plans for later than the body exists
/// should wait for the answer, or send a batch.
#[derive(Clone, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "nearly all requests are changes; a box for each would cost more than the room"
)]
#[non_exhaustive]
pub enum Request {
    /// A change.
    Change(Command),
    /// Several changes that take effect together, or not at all.
    Batch(Vec<Command>),
    /// Lets these bodies follow straight motions from their states, from a time (s) on: see
    /// [`Monitor::track`](crate::Monitor::track).
    Track(f64, Vec<(BodyId, BodyState)>),
    /// The clock moves on to this time, s.
    Clock(f64),
    /// The clock is set to this time (s), and the time in between is not looked at: see
    /// [`Monitor::skip_to`](crate::Monitor::skip_to).
    SkipTo(f64),
    /// Asks for the conflicts of a body, at an alert level, if it followed a plan from now on.
    /// Changes nothing. The answer is a [`ReportKind::WhatIf`](super::ReportKind::WhatIf). See
    /// [`Monitor::what_if`](crate::Monitor::what_if).
    WhatIf(BodyId, BodyPlan, usize),
    /// Asks for the conflicts of some bodies, at an alert level, if each followed its plan from now on.
    /// Changes nothing. The answer is a [`ReportKind::WhatIf`](super::ReportKind::WhatIf). See
    /// [`Monitor::what_if_plans`](crate::Monitor::what_if_plans).
    WhatIfPlans(Vec<(BodyId, BodyPlan)>, usize),
    /// Asks for the conflicts, at an alert level, of a body that is not there yet. Changes nothing. The
    /// answer is a [`ReportKind::WhatIf`](super::ReportKind::WhatIf). See
    /// [`Monitor::what_if_body`](crate::Monitor::what_if_body).
    WhatIfBody(Box<Body>, usize),
    /// Panics, to see what becomes of it.
    #[cfg(test)]
    Panic,
}

impl From<Command> for Request {
    fn from(command: Command) -> Self {
        Self::Change(command)
    }
}

impl From<Vec<Command>> for Request {
    fn from(commands: Vec<Command>) -> Self {
        Self::Batch(commands)
    }
}

/// Returns the body whose plan a request sets.
fn plan_of(request: &Request) -> Option<BodyId> {
    match request {
        Request::Change(
            Command::SetTrajectory(id, _) | Command::Replan(id, ..) | Command::Extend(id, _),
        ) => Some(*id),
        _ => None,
    }
}

/// Returns true if the later of two plans for one body replaces the earlier altogether, at a clock
/// (s).
fn replaces(later: &Request, earlier: &Request, clock: f64) -> bool {
    match (later, earlier) {
        (
            Request::Change(Command::SetTrajectory(..)),
            Request::Change(Command::Replan(_, _, earlier) | Command::Extend(_, earlier)),
        ) => earlier.orientation.is_none() && earlier.model_error.is_none(),
        (Request::Change(Command::SetTrajectory(..)), _) => true,
        (
            Request::Change(Command::Replan(_, from, plan)),
            Request::Change(Command::Replan(_, earlier_from, earlier)),
        ) => {
            let moves = &plan.trajectory;
            let is_taken = moves.goes_on_from(*from) && moves.goes_on_from(from.max(clock));
            let has_error = plan.model_error.is_some() || earlier.model_error.is_none();
            from <= earlier_from && is_taken && has_error && turns_instead(plan, earlier)
        }
        _ => false,
    }
}

/// Returns true if nothing is left of the orientation in an earlier plan once a later one, which begins no later, is
/// followed.
fn turns_instead(later: &BodyPlan, earlier: &BodyPlan) -> bool {
    match (&later.orientation, &earlier.orientation) {
        (_, None) => true,
        (None, Some(_)) => false,
        // A tolerance stays with those that have none, and ends with an orientation that is fixed.
        (Some(later), Some(earlier)) => {
            later.tolerance().is_some() || (earlier.tolerance().is_none() && !earlier.is_fixed())
        }
    }
}

/// Requests received and not yet applied, superseded ones taken out.
#[derive(Debug, Default)]
pub(super) struct RequestQueue {
    /// Latest of the monitor's clock and the clock requests that wait or were carried out, s. Where such a request
    /// is refused, the clock is no later.
    clock: f64,
    /// Lookahead of the monitor, s.
    lookahead: f64,
    requests: VecDeque<Option<(Ticket, Request)>>,
    /// Number of requests taken from the front: the number of the first in `requests`.
    taken: usize,
    /// Numbers of the plans of each body that wait and are not superseded, since the last clock request,
    /// batch or question, in order.
    plans: BTreeMap<BodyId, VecDeque<usize>>,
}

impl RequestQueue {
    /// Returns an empty queue for a monitor with this clock and this lookahead, s.
    pub(super) fn at(clock: f64, lookahead: f64) -> Self {
        Self {
            clock,
            lookahead,
            ..Self::default()
        }
    }

    /// Returns the room that the requests take, superseded ones included.
    pub(super) fn len(&self) -> usize {
        self.requests.len()
    }

    /// Returns the number of remembered plans.
    #[cfg(test)]
    pub(super) fn plans(&self) -> usize {
        self.plans.values().map(VecDeque::len).sum()
    }

    /// Adds a request; returns how many were superseded by it.
    pub(super) fn push(&mut self, ticket: Ticket, request: Request) -> u64 {
        let mut superseded = 0;
        match (&request, plan_of(&request)) {
            (_, Some(body)) => {
                let plans = self.plans.entry(body).or_default();
                // The last first: one that stays may rest on those before it.
                while let Some(&number) = plans.back() {
                    let earlier = &mut self.requests[number - self.taken];
                    let is_replaced =
                        |(_, earlier): &(_, Request)| replaces(&request, earlier, self.clock);
                    if !earlier.as_ref().is_some_and(is_replaced) {
                        break;
                    }
                    *earlier = None;
                    superseded += 1;
                    plans.pop_back();
                }
                plans.push_back(self.taken + self.requests.len());
            }
            // It will be refused: those that wait stay.
            (Request::Clock(time), _) if !can_show(*time, self.lookahead) => self.plans.clear(),
            (Request::Clock(time), _) => {
                // A clock that goes back is refused.
                self.clock = self.clock.max(*time);
                if let Some(Some((_, Request::Clock(before)))) = self.requests.back()
                    && before <= time
                {
                    self.requests.pop_back();
                    superseded += 1;
                }
                self.plans.clear();
            }
            (Request::SkipTo(time), _) => {
                if can_show(*time, self.lookahead) {
                    self.clock = self.clock.max(*time);
                }
                self.plans.clear();
            }
            // What is asked is about all that was requested before.
            (
                Request::Batch(_)
                | Request::Track(..)
                | Request::WhatIf(..)
                | Request::WhatIfPlans(..)
                | Request::WhatIfBody(..),
                _,
            ) => self.plans.clear(),
            _ => {}
        }
        self.requests.push_back(Some((ticket, request)));
        superseded
    }

    /// Forgets a clock request that was taken out and refused; the monitor's clock still shows this, s.
    pub(super) fn stay_at(&mut self, clock: f64) {
        let waiting = self.requests.iter().flatten();
        let clocks = waiting.filter_map(|(_, request)| match request {
            Request::Clock(time) | Request::SkipTo(time) => {
                Some(*time).filter(|&time| can_show(time, self.lookahead))
            }
            _ => None,
        });
        self.clock = clocks.fold(clock, f64::max);
    }

    /// Takes out the next request.
    pub(super) fn pop(&mut self) -> Option<(Ticket, Request)> {
        while let Some(next) = self.requests.pop_front() {
            let number = self.taken;
            self.taken += 1;
            if let Some((_, request)) = &next {
                self.forget(number, request);
                return next;
            }
        }
        None
    }

    /// Forgets a request that no longer waits.
    fn forget(&mut self, number: usize, request: &Request) {
        let Some(body) = plan_of(request) else { return };
        if let Entry::Occupied(mut plans) = self.plans.entry(body) {
            if plans.get().front() == Some(&number) {
                plans.get_mut().pop_front();
            }
            if plans.get().is_empty() {
                plans.remove();
            }
        }
    }
}
