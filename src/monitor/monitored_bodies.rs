//! Monitored bodies: facts about each body's plan and hitbox, by slot. Plans without end are followed as far as the
//! lookahead reaches, and some way beyond.

use super::grid::Grid;
use crate::bounds::Padding;
use crate::count::short;
use crate::error::Error;
use crate::knots::Knots;
use crate::narrow_phase::BodyView;
use crate::scene::{Body, Scene};
use crate::shape::BodyShape;
use crate::simd::{prefetch, prefetch_first};
use crate::trajectory::{Extension, LastMotion, Outside, StraightMotion, Trajectory};
use crate::window::Window;
use std::ops::Range;
use std::slice::from_ref;

/// The facts about a body's plan and hitbox that are computed once, when they are set.
///
/// The first cache line changes with the plan. The second one is of the hitbox.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct MonitoredBody {
    /// Start of the monitor's window when the plan was set, s.
    begin: f64,
    /// First and last instant of the plan's knots and of the pieces beyond them, s.
    ends: (f64, f64),
    /// Facts about the last of several straight motions.
    last: LastMotion,
    /// Number of the plan's own cubics.
    cubics: u32,
    /// Numbers of the pieces before and after the knots that are followed. They cover the monitor's window from `begin`
    /// on, so that pieces keep their numbers as the window moves.
    beyond: (u32, u32),
    /// True if pieces beyond the knots are followed.
    is_extended: bool,
    /// True if the plan goes on beyond the second of `ends`.
    is_endless: bool,
    /// True if the body has a partner: it may be part of a pair of boxes.
    pub(super) has_partner: bool,
    is_half_space: bool,
    /// The amount by which its boxes exceed the hull of its motion: hitbox and half the margin.
    pub(super) padding: Padding,
}

impl MonitoredBody {
    /// Prepares a plan over `window`, for boxes on a grid.
    pub(super) fn of(
        trajectory: &Trajectory,
        shape: BodyShape<'_>,
        grid: &Grid,
        window: Window,
    ) -> Result<Self, Error> {
        let mut monitored = Self {
            begin: 0.0,
            ends: (0.0, 0.0),
            last: LastMotion::NONE,
            cubics: 0,
            beyond: (0, 0),
            is_extended: false,
            is_endless: false,
            has_partner: true,
            is_half_space: shape.is_half_space(),
            padding: grid.padding(shape),
        };
        monitored.replan(trajectory, window)?;
        Ok(monitored)
    }

    /// Takes another plan of the same body over `window`.
    #[inline]
    pub(super) fn replan(&mut self, trajectory: &Trajectory, window: Window) -> Result<(), Error> {
        (self.beyond, self.is_extended) = ((0, 0), false);
        self.take_knots(trajectory, window);
        self.last = trajectory.last_motion();
        self.follow(trajectory, window.end())
    }

    /// Takes a motion that [replaces](Trajectory::replace_checked) the last one of the plan, and follows it over `window`.
    #[inline]
    pub(super) fn replace(&mut self, trajectory: &Trajectory, last: LastMotion, window: Window) {
        self.take_knots(trajectory, window);
        self.last = last;
        self.is_endless = true;
        self.is_extended = window.end() >= self.ends.1;
        self.beyond = (0, 0);
        if self.is_extended {
            (self.beyond.1, self.ends.1) = trajectory.pieces_after(Self::far_end(window));
        }
    }

    /// Returns the instant up to which a motion that replaces another one is followed if pieces beyond it are: far enough
    /// that bodies which are told again within some lookaheads need no more of them, s.
    fn far_end(window: Window) -> f64 {
        const AHEAD: f64 = 16.0;
        window.end() + AHEAD * (window.end() - window.start())
    }

    /// Takes the facts about a plan between its knots.
    #[inline]
    fn take_knots(&mut self, trajectory: &Trajectory, window: Window) {
        let knots = Knots::of(trajectory.piece_knots());
        self.begin = window.start();
        self.ends = knots.ends();
        self.cubics = short(knots.cubics());
    }

    /// Returns the instant up to which a plan without end is followed, s; infinite for a plan with an end.
    pub(super) const fn until(&self) -> f64 {
        if self.is_endless {
            self.ends.1
        } else {
            f64::INFINITY
        }
    }

    /// Returns true if a motion certainly [replaces](Trajectory::replace_checked) the last one at an instant (s), and is
    /// followed over `window` then.
    #[inline]
    fn is_replaced_by(&self, motion: &StraightMotion, from: f64, window: Window) -> bool {
        let (starts, far) = ((self.ends.0, window.start()), Self::far_end(window));
        self.beyond.0 == 0 && self.last.is_replaced_by(motion, from, starts, far)
    }

    /// Follows a plan beyond its knots up to an instant (s), if its knots do not reach that far; and then far beyond
    /// it, if numbers allow that.
    fn follow(&mut self, trajectory: &Trajectory, end: f64) -> Result<(), Error> {
        /// Windows that are followed ahead: pieces get twice as long from one to the next.
        const AHEAD: f64 = 1024.0;
        let needed = self.extended(trajectory, end)?;
        if let Some(needed) = needed {
            let far = end + AHEAD * (end - self.begin);
            let extension = self.extended(trajectory, far).ok().flatten();
            let extension = extension.unwrap_or(needed);
            self.ends = extension.domain;
            self.beyond = (extension.before, extension.after);
            self.is_extended = true;
        }
        self.is_endless = trajectory.outside_after() != Outside::Absent;
        Ok(())
    }

    fn extended(&self, trajectory: &Trajectory, end: f64) -> Result<Option<Extension>, Error> {
        let Some(mut extension) = self.extension() else {
            return trajectory.extension(Window::new(self.begin, end)?);
        };
        trajectory.lengthen(&mut extension, end)?;
        Ok(Some(extension))
    }

    /// Returns the number of cubics, those beyond the knots included.
    fn all_cubics(&self) -> u32 {
        let (before, after) = self.beyond;
        self.cubics + before + after
    }

    /// Returns the number of pieces before the knots.
    pub(super) const fn before(&self) -> usize {
        self.beyond.0 as usize
    }

    /// Returns the pieces beyond the knots.
    #[inline]
    fn extension(&self) -> Option<Extension> {
        let (before, after) = self.beyond;
        self.is_extended.then_some(Extension {
            before,
            after,
            domain: self.ends,
        })
    }

    /// Returns the plan and the hitbox as the narrow phase takes them.
    #[inline(always)]
    pub(super) fn view<'s>(
        &'s self,
        trajectory: &'s Trajectory,
        shape: BodyShape<'s>,
    ) -> BodyView<'s> {
        BodyView::of_plan(self.knots(trajectory), trajectory, shape)
    }

    /// Returns the knots of the plan.
    #[inline]
    pub(super) fn knots<'s>(&self, trajectory: &'s Trajectory) -> Knots<'s> {
        let knots = Knots::with_ends(trajectory.piece_knots(), self.ends);
        knots.extended(trajectory, self.extension().as_ref())
    }
}

/// The bodies by slot; a slot without a body has none.
#[derive(Debug)]
pub(super) struct MonitoredBodies {
    by_slot: Vec<Option<MonitoredBody>>,
    /// Number of bodies.
    bodies: usize,
    /// Slots of half-spaces, ascending.
    half_spaces: Vec<u32>,
    /// Instant up to which all plans without end are followed, s.
    until: f64,
    /// True if some bodies turn, or turned, and have long arms.
    pub(super) have_long_arms: bool,
}

impl Default for MonitoredBodies {
    fn default() -> Self {
        Self {
            by_slot: Vec::new(),
            bodies: 0,
            half_spaces: Vec::new(),
            until: f64::INFINITY,
            have_long_arms: false,
        }
    }
}

impl MonitoredBodies {
    /// Returns the number of slots: one more than the last one.
    pub(super) fn len(&self) -> usize {
        self.by_slot.len()
    }

    /// Returns the number of bodies. There may be far more slots, if many bodies were removed.
    pub(super) const fn bodies(&self) -> usize {
        self.bodies
    }

    pub(super) fn set(&mut self, slot: u32, monitored: Option<MonitoredBody>) {
        let place = slot as usize;
        if self.by_slot.len() <= place {
            self.by_slot.resize_with(place + 1, || None);
        }
        if let Some(monitored) = &monitored {
            self.until = self.until.min(monitored.until());
            self.have_long_arms |= monitored.padding.has_long_arms();
        }
        let is_half_space = monitored.as_ref().is_some_and(|body| body.is_half_space);
        match self.half_spaces.binary_search(&slot) {
            Ok(found) if !is_half_space => drop(self.half_spaces.remove(found)),
            Err(found) if is_half_space => self.half_spaces.insert(found, slot),
            _ => {}
        }
        self.bodies += usize::from(monitored.is_some());
        let before = std::mem::replace(&mut self.by_slot[place], monitored);
        self.bodies -= usize::from(before.is_some());
    }

    /// Returns the slots of half-spaces, ascending.
    pub(super) fn half_spaces(&self) -> &[u32] {
        &self.half_spaces
    }

    /// Takes another plan of the body in a slot over `window`.
    pub(super) fn replan(
        &mut self,
        slot: u32,
        trajectory: &Trajectory,
        window: Window,
    ) -> Result<(), Error> {
        if let Some(Some(monitored)) = self.by_slot.get_mut(slot as usize) {
            monitored.replan(trajectory, window)?;
            self.until = self.until.min(monitored.until());
        }
        Ok(())
    }

    /// Takes a motion that [replaces](MonitoredBody::replace) the last one of the body in a slot.
    #[inline]
    pub(super) fn replace(
        &mut self,
        slot: u32,
        trajectory: &Trajectory,
        last: LastMotion,
        window: Window,
    ) {
        if let Some(Some(monitored)) = self.by_slot.get_mut(slot as usize) {
            monitored.replace(trajectory, last, window);
            self.until = self.until.min(monitored.until());
        }
    }

    /// Returns true if a motion certainly replaces the last one of the body in a slot: see
    /// [`MonitoredBody::is_replaced_by`].
    #[inline]
    pub(super) fn is_replaced(
        &self,
        slot: u32,
        motion: &StraightMotion,
        from: f64,
        window: Window,
    ) -> bool {
        let monitored = self.by_slot.get(slot as usize).and_then(Option::as_ref);
        monitored.is_some_and(|monitored| monitored.is_replaced_by(motion, from, window))
    }

    /// Takes another padding of the body in a slot.
    pub(super) fn set_padding(&mut self, slot: u32, padding: Padding) {
        if let Some(Some(monitored)) = self.by_slot.get_mut(slot as usize) {
            monitored.padding = padding;
            self.have_long_arms |= padding.has_long_arms();
        }
    }

    /// Returns the facts about all bodies, by slot, and the instant up to which all plans without end are followed, s.
    pub(super) fn by_slot_mut(&mut self) -> (&mut [Option<MonitoredBody>], &mut f64) {
        (&mut self.by_slot, &mut self.until)
    }

    /// Notes if the body in a slot has a partner; returns true if that has changed.
    pub(super) fn set_partner(&mut self, slot: u32, has_partner: bool) -> bool {
        let monitored = self.by_slot.get_mut(slot as usize);
        monitored.and_then(Option::as_mut).is_some_and(|monitored| {
            std::mem::replace(&mut monitored.has_partner, has_partner) != has_partner
        })
    }

    /// Returns the slots of bodies without a partner.
    pub(super) fn without_partner(&self) -> impl Iterator<Item = u32> {
        let by_slot = (0_u32..).zip(&self.by_slot);
        by_slot.filter_map(|(slot, monitored)| {
            let is_alone = monitored.as_ref().is_some_and(|body| !body.has_partner);
            is_alone.then_some(slot)
        })
    }

    /// Returns, for each of some slots, the interval in which its body exists (s), and the number of its cubics. The
    /// interval is empty without a body, or if the body has no partner.
    pub(super) fn present(
        &self,
        slots: Range<usize>,
    ) -> impl ExactSizeIterator<Item = ((f64, f64), u32)> {
        self.by_slot[slots].iter().map(|monitored| {
            let Some(monitored) = monitored else {
                return (Knots::NONE.ends(), 0);
            };
            let life = if monitored.has_partner {
                monitored.ends
            } else {
                Knots::NONE.ends()
            };
            (life, monitored.all_cubics())
        })
    }

    /// Prefetches the facts about the body in a slot.
    pub(super) fn prefetch(&self, slot: u32) {
        if let Some(monitored) = self.by_slot.get(slot as usize) {
            prefetch(from_ref(monitored));
        }
    }

    /// Prefetches the facts about the plan of the body in a slot.
    pub(super) fn prefetch_plan(&self, slot: u32) {
        if let Some(monitored) = self.by_slot.get(slot as usize) {
            prefetch_first(monitored);
        }
    }

    /// Returns the facts about the body in a slot, and the body.
    #[inline]
    pub(super) fn with_body<'s>(
        &'s self,
        scene: &'s Scene,
        slot: u32,
    ) -> Option<(&'s MonitoredBody, &'s Body)> {
        let monitored = self.by_slot.get(slot as usize)?.as_ref()?;
        Some((monitored, &scene.in_slot(slot)?.1.body))
    }

    /// Returns the body in a slot as the narrow phase takes it.
    #[inline(always)]
    pub(super) fn view<'s>(&'s self, scene: &'s Scene, slot: u32) -> Option<BodyView<'s>> {
        let (monitored, body) = self.with_body(scene, slot)?;
        Some(monitored.view(&body.trajectory, body.shape()))
    }

    /// Returns the interval in which the body in a slot exists, as far back as it is known (s); also beyond
    /// the time up to which it is followed, if it goes on there.
    pub(super) fn domain(&self, slot: u32) -> Option<(f64, f64)> {
        let monitored = self.by_slot.get(slot as usize)?.as_ref()?;
        let (start, end) = monitored.ends;
        let is_endless = monitored.is_endless;
        (start <= end).then_some((start, if is_endless { f64::INFINITY } else { end }))
    }

    /// Follows plans that go on beyond their knots up to `end` (s).
    pub(super) fn extend_beyond(&mut self, scene: &Scene, end: f64) -> Result<(), Error> {
        if self.until > end {
            return Ok(());
        }
        let mut until = f64::INFINITY;
        for (monitored, slot) in self.by_slot.iter_mut().zip(0_u32..) {
            let (Some(monitored), Some((id, entry))) = (monitored, scene.in_slot(slot)) else {
                continue;
            };
            let body = &entry.body;
            if monitored.until() <= end {
                let done = monitored.follow(&body.trajectory, end);
                done.map_err(|error| error.in_body(body.tag).with_id(id))?;
            }
            until = until.min(monitored.until());
        }
        self.until = until;
        Ok(())
    }
}
