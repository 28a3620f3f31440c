//! Contacts that solved pairs of spheres prove, of two bodies over a part of a span.

use super::shares::{MOST_HALVINGS, Shares, WHOLE};
use crate::rounding::{earliest_exact, latest_exact};
use crate::spans::Span;
use arrayvec::ArrayVec;

/// A contact of a solved pair of spheres: the bodies are within the margin from `enter` to `exit`
/// (s), with a least separation of at most `separation` (m).
#[derive(Clone, Copy, Debug)]
pub(in crate::narrow_phase) struct ProvenContact {
    pub(in crate::narrow_phase) enter: f64,
    pub(in crate::narrow_phase) exit: f64,
    pub(in crate::narrow_phase) separation: f64,
}

impl ProvenContact {
    /// Adds another contact if both overlap or touch; else returns false.
    fn joins(&mut self, other: &Self) -> bool {
        let meets = self.enter <= other.exit && other.enter <= self.exit;
        if meets {
            self.enter = self.enter.min(other.enter);
            self.exit = self.exit.max(other.exit);
            self.separation = self.separation.min(other.separation);
        }
        meets
    }
}

/// A part of an interval, with a bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundStep {
    /// End, as a share of the interval.
    pub(super) end: f64,
    /// Separation that a pair of spheres must reach to matter, m. Below all numbers if none matters.
    pub(super) bound: f64,
}

/// Largest number of steps: two for each of the shortest intervals, or some for each contact.
pub(super) const MOST_STEPS: usize = 2 << MOST_HALVINGS;
const _: () = assert!(MOST_STEPS >= ProvenContacts::MAX_STEPS);

/// The steps of an interval, in time order.
pub(super) type BoundSteps = ArrayVec<BoundStep, MOST_STEPS>;

/// The contacts proven so far over a part of a span, for a margin and a window.
#[derive(Debug)]
pub(super) struct ProvenContacts {
    /// Apart from each other, in time order.
    contacts: ArrayVec<ProvenContact, { Self::MAX }>,
    part: Span,
    stretch: Shares,
    margin: f64,
    window: (f64, f64),
}

impl ProvenContacts {
    /// Largest number of contacts. What more there are is not known: more pairs are solved then.
    const MAX: usize = 4;
    /// Largest number of steps that are listed.
    pub(super) const MAX_STEPS: usize = 2 * Self::MAX + 3;
    /// Share of the part that is more than the rounding of shares.
    const SHARE: f64 = 1e-12;

    pub(super) fn new(part: Span, (margin, window): (f64, (f64, f64))) -> Self {
        Self {
            contacts: ArrayVec::new(),
            part,
            stretch: WHOLE,
            margin,
            window,
        }
    }

    /// Restricts the bounds to a stretch of the part.
    pub(super) const fn restrict(&mut self, stretch: Shares) {
        self.stretch = stretch;
    }

    /// Adds the contacts of a pair of spheres. Another pair may be the nearest one in them if its separation is at most `slack`
    /// greater, m.
    pub(super) fn learn(&mut self, found: &[ProvenContact], slack: f64) {
        for contact in found {
            let mut contact = *contact;
            contact.separation += slack;
            self.contacts.retain(|known| !contact.joins(known));
            if !self.contacts.is_full() {
                let is_before = |known: &&ProvenContact| known.exit < contact.enter;
                let place = self.contacts.iter().take_while(is_before).count();
                self.contacts.insert(place, contact);
            }
        }
    }

    /// Appends the steps of an interval (shares of the stretch) to an empty list. Reported instants are rounded: another
    /// pair matters if it is within the margin until shortly after a contact begins, or from shortly before it ends.
    pub(super) fn list_bounds(&self, (start, end): (f64, f64), steps: &mut BoundSteps) {
        let (from, to) = self.stretch;
        let [start, end] = [start, end].map(|share| from + share * (to - from));
        let Span {
            start: first,
            end: last,
            ..
        } = self.part;
        let length = last - first;
        let share = |time: f64, more: f64, otherwise: f64| {
            if length > 0.0 && length < f64::INFINITY {
                ((time - first) / length + more - start) / (end - start)
            } else {
                otherwise
            }
        };
        let before = |time: f64| share(earliest_exact(time), -Self::SHARE, 0.0);
        let after = |time: f64| share(latest_exact(time), Self::SHARE, 1.0);
        let mut push = |end: f64, bound: f64| {
            let end = end.min(1.0);
            if end > steps.last().map_or(0.0, |before| before.end) {
                steps.push(BoundStep { end, bound });
            }
        };
        let (from, to) = (self.window.0.max(first), self.window.1.min(last));
        if from > first {
            push(before(from), f64::NEG_INFINITY);
        }
        let until = if to < last { after(to) } else { 1.0 };
        for contact in &self.contacts {
            if contact.enter > from {
                push(after(contact.enter), self.margin);
            }
            let exit = if contact.exit < to {
                before(contact.exit)
            } else {
                until
            };
            push(exit, self.margin.min(contact.separation));
        }
        push(until, self.margin);
        push(1.0, f64::NEG_INFINITY);
    }
}
