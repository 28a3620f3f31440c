//! Bodies as the outlook sees them, by slot: their plans as far as the lookahead reaches.

use super::calendar::Calendar;
use super::spare::Spare;
use crate::bounds::{Frame, Inflation};
use crate::error::Error;
use crate::hitbox::Hitbox;
use crate::knots::Knots;
use crate::narrow_phase::Party;
use crate::scene::Scene;
use crate::simd::prefetch;
use crate::trajectory::{Outside, Pieces, Trajectory};
use crate::window::Window;
use std::slice::from_ref;

/// What is worked out about a body's plan and hitbox once, when they are set.
#[derive(Debug)]
pub(super) struct Flight {
    pub(super) inflation: Inflation,
    /// Pieces beyond the knots, where the body exists there and the monitor's window reached it so
    /// far. They begin with that window at the time the plan was set, so that their numbers stay as
    /// its end moves on.
    beyond: Option<Pieces>,
    begin: f64,
    /// Of the knots that are laid out.
    ends: (f64, f64),
    /// Up to where a plan without end is laid out, s; infinite for one that has an end.
    until: f64,
    /// The body may be part of a pair.
    pub(super) has_partner: bool,
}

impl Flight {
    /// What a plan means over `window`, for pairs within `margin` (m) in `frame`. Memory comes from
    /// `spare`.
    pub(super) fn of(
        trajectory: &Trajectory,
        hitbox: &Hitbox,
        (margin, frame): (f64, &Frame),
        window: Window,
        spare: &Spare,
    ) -> Result<Self, Error> {
        let mut flight = Self {
            inflation: Inflation::of(hitbox, margin, frame),
            beyond: None,
            begin: window.start(),
            ends: Knots::of(trajectory.knots()).ends(),
            until: f64::INFINITY,
            has_partner: true,
        };
        if trajectory.goes_beyond() {
            flight.lay_out(trajectory, window.end(), spare)?;
        }
        Ok(flight)
    }

    /// Lays out a plan without end up to an instant (s), at least.
    fn lay_out(&mut self, trajectory: &Trajectory, end: f64, spare: &Spare) -> Result<(), Error> {
        if let Some(pieces) = &mut self.beyond {
            trajectory.lengthen(pieces, end)?;
        } else {
            let window = Window::new(self.begin, end)?;
            self.beyond = trajectory.pieces(window, |count| spare.take(count))?;
        }
        let knots = match &self.beyond {
            Some(pieces) => &pieces.knots,
            None => trajectory.knots(),
        };
        self.ends = Knots::of(knots).ends();
        if trajectory.outside_after() != Outside::Absent {
            self.until = self.ends.1;
        }
        Ok(())
    }

    /// The plan and the hitbox it was made of, as the narrow phase takes them.
    pub(super) fn party<'s>(&'s self, trajectory: &'s Trajectory, hitbox: &'s Hitbox) -> Party<'s> {
        let (knots, segments) = match &self.beyond {
            Some(pieces) => (&pieces.knots[..], &pieces.segments[..]),
            None => (trajectory.knots(), trajectory.segments()),
        };
        Party {
            knots: Knots::with_ends(knots, self.ends),
            segments,
            spheres: hitbox.spheres(),
            bounding: hitbox.bounding(),
        }
    }
}

/// By slot; a slot without a body has none.
#[derive(Debug, Default)]
pub(super) struct Flights {
    by_slot: Vec<Option<Flight>>,
    /// Up to where those that exist for ever are laid out.
    laid_out: Calendar,
    /// Of flights that were replaced.
    spare: Spare,
}

impl Flights {
    /// One more than the last slot.
    pub(super) fn len(&self) -> usize {
        self.by_slot.len()
    }

    pub(super) fn set(&mut self, slot: u32, flight: Option<Flight>) {
        let place = slot as usize;
        if self.by_slot.len() <= place {
            self.by_slot.resize_with(place + 1, || None);
        }
        let until = flight.as_ref().map_or(f64::INFINITY, |flight| flight.until);
        self.laid_out.set(slot, until);
        let is_replaced = flight.is_some();
        let before = std::mem::replace(&mut self.by_slot[place], flight);
        // What a body that is gone had is not needed again.
        if let (true, Some(pieces)) = (is_replaced, before.and_then(|before| before.beyond)) {
            self.spare.give_back(pieces);
        }
    }

    /// Notes which bodies may be part of a pair; returns whether that is new of the one in a slot.
    pub(super) fn set_partner(&mut self, slot: u32, has_partner: bool) -> bool {
        let flight = self.by_slot.get_mut(slot as usize);
        flight.and_then(Option::as_mut).is_some_and(|flight| {
            std::mem::replace(&mut flight.has_partner, has_partner) != has_partner
        })
    }

    /// Memory for flights.
    pub(super) const fn spare(&self) -> &Spare {
        &self.spare
    }

    /// Fetches what is known of the body in a slot into the caches.
    pub(super) fn prefetch(&self, slot: u32) {
        if let Some(flight) = self.by_slot.get(slot as usize) {
            prefetch(from_ref(flight));
        }
    }

    /// The body in a slot.
    pub(super) fn get<'s>(
        &'s self,
        scene: &'s Scene,
        slot: u32,
    ) -> Option<(&'s Flight, Party<'s>)> {
        let flight = self.by_slot.get(slot as usize)?.as_ref()?;
        let body = &scene.in_slot(slot)?.1.body;
        Some((flight, flight.party(&body.trajectory, &body.hitbox)))
    }

    pub(super) fn party<'s>(&'s self, scene: &'s Scene, slot: u32) -> Option<Party<'s>> {
        self.get(scene, slot).map(|(_, party)| party)
    }

    /// When the body in a slot exists, as far back as it is known: also beyond what it is laid out
    /// to, where it goes on.
    pub(super) fn domain(&self, scene: &Scene, slot: u32) -> Option<(f64, f64)> {
        let (flight, party) = self.get(scene, slot)?;
        let (start, end) = party.knots.ends();
        let is_endless = flight.until < f64::INFINITY;
        (start <= end).then_some((start, if is_endless { f64::INFINITY } else { end }))
    }

    /// Extends plans that go on beyond their knots so that they reach `end` (s).
    pub(super) fn extend_beyond(&mut self, scene: &Scene, end: f64) -> Result<(), Error> {
        while let Some(slot) = self.laid_out.next(end) {
            let flight = self.by_slot[slot as usize].as_mut();
            let (Some(flight), Some((_, occupant))) = (flight, scene.in_slot(slot)) else {
                continue;
            };
            let body = &occupant.body;
            let done = flight.lay_out(&body.trajectory, end, &self.spare);
            // One that is laid out is not looked at again in this tick, however far it got.
            let least = done.as_ref().map_or(flight.until, |()| end.next_up());
            self.laid_out.set(slot, flight.until.max(least));
            done.map_err(|error| error.in_body(body.tag))?;
        }
        Ok(())
    }
}
