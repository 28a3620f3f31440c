//! What is sent to a live monitor, and how it waits there.

use super::handle::Ticket;
use crate::id::BodyId;
use crate::monitor::Command;
use crate::trajectory::Trajectory;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

/// What is sent to a live monitor.
///
/// A plan replaces an earlier one of the same body altogether if it is
/// [`Command::SetTrajectory`], or if both are [`Command::Replan`] and the later one begins no
/// later than the earlier, at a time at which its plan exists and from which it goes on, as it does
/// from the clock by then (else it may be refused, and the earlier one is needed). It may still be refused for what only the scene knows:
/// that the body is not there at that time, say. Then the earlier one is gone as well: whoever sends plans
/// for later than the body exists should wait for the answer, or send a batch.
#[derive(Clone, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "nearly all orders are changes; a box for each would cost more than the room"
)]
#[non_exhaustive]
pub enum Order {
    /// One change.
    Change(Command),
    /// Several changes that take effect together, or not at all.
    Batch(Vec<Command>),
    /// The clock moves on to this time, s.
    Clock(f64),
    /// What would become of a body, at an alert level, if it followed a plan from now on? Changes nothing;
    /// answered with [`ReportKind::WhatIf`](super::ReportKind::WhatIf). See
    /// [`Monitor::what_if`](crate::Monitor::what_if).
    WhatIf(BodyId, Trajectory, usize),
    /// Panics, to see what becomes of it.
    #[cfg(test)]
    Panic,
}

impl From<Command> for Order {
    fn from(command: Command) -> Self {
        Self::Change(command)
    }
}

impl From<Vec<Command>> for Order {
    fn from(commands: Vec<Command>) -> Self {
        Self::Batch(commands)
    }
}

/// The plan of a body that an order sets.
fn plan_of(order: &Order) -> Option<BodyId> {
    match order {
        Order::Change(
            Command::SetTrajectory(id, _) | Command::Replan(id, ..) | Command::Extend(id, _),
        ) => Some(*id),
        _ => None,
    }
}

/// Whether the later of two plans for one body leaves nothing of the earlier, when the clock (s) has been
/// moved.
fn replaces(later: &Order, earlier: &Order, clock: f64) -> bool {
    match (later, earlier) {
        (Order::Change(Command::SetTrajectory(..)), _) => true,
        (
            Order::Change(Command::Replan(_, from, plan)),
            Order::Change(Command::Replan(_, earlier_from, _)),
        ) => {
            let is_taken = plan.goes_on_from(*from) && plan.goes_on_from(from.max(clock));
            from <= earlier_from && is_taken
        }
        _ => false,
    }
}

/// Orders received and not yet applied, superseded ones taken out.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    /// As the last clock order leaves it, s.
    clock: f64,
    orders: VecDeque<Option<(Ticket, Order)>>,
    /// How many have been taken from the front: the number of the first in `orders`.
    taken: usize,
    /// Numbers of the plans of each body that wait and are not superseded, since the last clock order,
    /// batch or question, in order.
    plans: BTreeMap<BodyId, VecDeque<usize>>,
}

impl Waiting {
    /// None yet, for a monitor whose clock shows this, s.
    pub(super) fn at(clock: f64) -> Self {
        Self {
            clock,
            ..Self::default()
        }
    }

    /// How much room the orders take, superseded ones included.
    pub(super) fn len(&self) -> usize {
        self.orders.len()
    }

    /// How many plans it remembers.
    #[cfg(test)]
    pub(super) fn plans(&self) -> usize {
        self.plans.values().map(VecDeque::len).sum()
    }

    /// Adds an order; returns how many were superseded by it.
    pub(super) fn push(&mut self, ticket: Ticket, order: Order) -> u64 {
        let mut superseded = 0;
        match (&order, plan_of(&order)) {
            (_, Some(body)) => {
                let plans = self.plans.entry(body).or_default();
                // The last first: one that stays may rest on those before it.
                while let Some(&number) = plans.back() {
                    let earlier = &mut self.orders[number - self.taken];
                    let is_replaced =
                        |(_, earlier): &(_, Order)| replaces(&order, earlier, self.clock);
                    if !earlier.as_ref().is_some_and(is_replaced) {
                        break;
                    }
                    *earlier = None;
                    superseded += 1;
                    plans.pop_back();
                }
                plans.push_back(self.taken + self.orders.len());
            }
            (Order::Clock(time), _) => {
                self.clock = *time;
                if let Some(Some((_, Order::Clock(before)))) = self.orders.back()
                    && before <= time
                {
                    self.orders.pop_back();
                    superseded += 1;
                }
                self.plans.clear();
            }
            // What is asked is about all that was ordered before.
            (Order::Batch(_) | Order::WhatIf(..), _) => self.plans.clear(),
            _ => {}
        }
        self.orders.push_back(Some((ticket, order)));
        superseded
    }

    /// The next order.
    pub(super) fn pop(&mut self) -> Option<(Ticket, Order)> {
        while let Some(next) = self.orders.pop_front() {
            let number = self.taken;
            self.taken += 1;
            if let Some((_, order)) = &next {
                self.forget(number, order);
                return next;
            }
        }
        None
    }

    /// An order no longer waits.
    fn forget(&mut self, number: usize, order: &Order) {
        let Some(body) = plan_of(order) else { return };
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
