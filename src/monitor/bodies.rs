//! The bodies of a monitor in a form for searches, and their boxes.

use super::grid::Grid;
use super::monitored_bodies::MonitoredBodies;
use crate::bounds::{CubicSource, FatLine, Frame, MAX_PLACES, Padding, StraightPieces, tighten};
use crate::broad_phase::BodyBox;
use crate::narrow_phase::BodyView;
use crate::parallel;
use crate::scene::{Scene, SceneEntry};
use crate::search::{
    Bodies, FEW_BOXES, FormInPlace, SLICES_AT_A_TIME, SourcesInPlace, list_present,
};
use crate::shape::BodyShape;
use crate::simd::InstructionSet;
use crate::trajectory::Segment;
use arrayvec::ArrayVec;
use parry3d::bounding_volume::Aabb;
use std::ops::Range;

/// The bodies of a monitor, by slot.
#[derive(Clone, Copy, Debug)]
pub(super) struct BodyTable<'m> {
    pub(super) scene: &'m Scene,
    pub(super) monitored: &'m MonitoredBodies,
    pub(super) grid: &'m Grid,
}

impl Bodies for BodyTable<'_> {
    fn view(&self, body: u32) -> BodyView<'_> {
        self.get(body).unwrap_or(BodyView::NONE)
    }

    fn have_long_arms(&self) -> bool {
        self.monitored.have_long_arms
    }

    fn long_arms(&self, body: u32) -> Option<BodyShape<'_>> {
        let (monitored, body) = self.monitored.with_body(self.scene, body)?;
        monitored.padding.has_long_arms().then(|| body.shape())
    }

    fn fetch(&self, body: u32) {
        self.scene.prefetch(body);
        self.monitored.prefetch(body);
    }
}

impl SourcesInPlace for BodyTable<'_> {
    type Cubic = Segment;

    #[inline(always)]
    fn straight(&self, body: u32, from: f64, frame: &Frame) -> Option<StraightPieces<'_>> {
        let (monitored, body) = self.monitored.with_body(self.scene, body)?;
        if !monitored.has_partner {
            return None;
        }
        let bounds = (&monitored.padding, frame);
        StraightPieces::over(&body.trajectory, monitored.before(), from, bounds)
    }

    /// Without a partner: that of a body that never exists.
    #[inline(always)]
    fn source(&self, body: u32, frame: &Frame) -> CubicSource<'_, Segment> {
        let found = self.monitored.with_body(self.scene, body);
        match found.filter(|(monitored, _)| monitored.has_partner) {
            Some((monitored, body)) => {
                let plan = &body.trajectory;
                let cubics = (monitored.knots(plan), plan.cubics());
                CubicSource::plain(cubics, &monitored.padding, frame)
            }
            None => CubicSource::plain((BodyView::NONE.knots, &[]), &Padding::NONE, frame),
        }
    }

    fn fetch_record(&self, body: u32) {
        self.scene.prefetch_first(body);
        self.monitored.prefetch(body);
    }

    fn fetch_motion(&self, body: u32) {
        if let Some((_, entry)) = self.scene.in_slot(body) {
            entry.body.trajectory.prefetch();
        }
    }
}

impl<'m> BodyTable<'m> {
    /// Returns the bodies of a scene, with boxes on a grid.
    pub(super) const fn of(
        scene: &'m Scene,
        monitored: &'m MonitoredBodies,
        grid: &'m Grid,
    ) -> Self {
        Self {
            scene,
            monitored,
            grid,
        }
    }

    /// Returns the body in a slot.
    pub(super) fn get(&self, slot: u32) -> Option<BodyView<'m>> {
        self.monitored.view(self.scene, slot)
    }

    /// Returns the body in a slot, and true if its plan alone does not tell its [heights](crate::scene::PlaneHeights) above
    /// a half-space's plane up to an instant (s).
    #[inline]
    pub(super) fn entry(&self, slot: u32, until: f64) -> Option<(&'m SceneEntry, bool)> {
        let (monitored, body) = self.monitored.with_body(self.scene, slot)?;
        // Beyond the instant up to which it is followed, a plan may go anywhere.
        let needs_cubics =
            until > monitored.until() || monitored.knots(&body.trajectory).has_unlisted_cubics();
        let (_, entry) = self.scene.in_slot(slot)?;
        Some((entry, needs_cubics))
    }

    /// Returns the bounds of a body at its places in an interval (s), if it teleports in it and each is far closer than the
    /// fat line of the `whole` interval.
    pub(super) fn bounds_by_teleport(
        &self,
        slot: u32,
        (from, to): (f64, f64),
        whole: &FatLine,
    ) -> Option<ArrayVec<(FatLine, Aabb), MAX_PLACES>> {
        let is_far_closer = |radius: f32| 2.0 * radius <= whole.radius;
        let (monitored, body) = self.monitored.with_body(self.scene, slot)?;
        let plan = &body.trajectory;
        if plan.straight_motions().len() < 2 || !is_far_closer(monitored.padding.reach()) {
            return None;
        }
        // Without cubics before its first knot it is nowhere before that. So its box begins there, too.
        let known = from.max(plan.piece_knots()[0]);
        let bounds = (&monitored.padding, &*self.grid.frame);
        let pieces = StraightPieces::over(plan, monitored.before(), known, bounds)?;
        let bounds = pieces.bounds_by_teleport(&self.grid.frame, (from, to));
        let are_close = bounds.iter().all(|(line, _)| is_far_closer(line.radius));
        (are_close && !bounds.is_empty()).then_some(bounds)
    }

    /// Lists those of some slots whose bodies may exist within an interval (s), and have a partner; replaces what the list
    /// held.
    pub(super) fn list_present(
        &self,
        slots: Range<usize>,
        interval: (f64, f64),
        present: &mut Vec<u32>,
    ) {
        let lives = self.monitored.present(slots.clone());
        list_present(lives.map(|(life, _)| life), slots.start, interval, present);
    }

    /// Brings the bounds of a body in an interval (s) closer, if it turns and has long arms.
    #[inline(never)]
    fn tighten(&self, body: u32, interval: (f64, f64), bounds: (&mut FatLine, &mut Aabb)) {
        if let Some(shape) = self.long_arms(body) {
            tighten(shape, interval, &self.grid.frame, bounds);
        }
    }

    /// Calls `visit` with the box and the fat line of each body in each slice in which it exists,
    /// slices numbered from 0; in each slice in the order of `slots`. `ends`: see [`FormInPlace`].
    pub(super) fn boxes(
        &self,
        slots: impl Iterator<Item = u32> + Clone,
        ends: &[f64],
        visit: &mut dyn FnMut(usize, BodyBox, &FatLine),
    ) {
        let instructions = InstructionSet::best();
        instructions.run(FormInPlace {
            instructions,
            frame: &self.grid.frame,
            bodies: self,
            present: slots,
            ends,
            put: |(_, body), slice, (mut fat_line, mut aabb)| {
                if self.monitored.have_long_arms {
                    let interval = (ends[slice], ends[slice + 1]);
                    self.tighten(body, interval, (&mut fat_line, &mut aabb));
                }
                visit(slice, BodyBox { aabb, body }, &fat_line);
            },
        });
    }
}

/// The boxes and fat lines of bodies that have changed, formed for all slices together: each body's
/// segments are read once.
#[derive(Debug, Default)]
pub(super) struct ChangedBounds {
    slots: Vec<u32>,
    /// Boxes and fat lines by batch of bodies and by slice: as many batches as are needed, and unused ones.
    batches: Vec<Vec<Vec<(BodyBox, FatLine)>>>,
}

impl ChangedBounds {
    /// Number of bodies that one thread forms at a time.
    const BATCH: usize = 64;

    /// Forms those of these bodies in all slices.
    pub(super) fn form(&mut self, bodies: &BodyTable<'_>, slots: &[u32], ends: &[f64]) {
        self.slots.clear();
        self.slots.extend_from_slice(slots);
        let count = slots.len().div_ceil(Self::BATCH);
        if self.batches.len() < count {
            self.batches.resize_with(count, Vec::new);
        }
        let few = (slots.len() * (ends.len() - 1), FEW_BOXES);
        parallel::for_each_chunk(&mut self.batches[..count], 1, few, |number, batch| {
            let slots = &slots[number * Self::BATCH..];
            let slots = &slots[..slots.len().min(Self::BATCH)];
            form_batch(bodies, slots, ends, &mut batch[0]);
        });
    }

    /// Returns true if it is about these bodies, in this order.
    pub(super) fn are(&self, slots: &[u32]) -> bool {
        self.slots == slots
    }

    /// Returns the boxes and fat lines in a slice, in the order of the bodies.
    pub(super) fn of(&self, slice: usize) -> impl Iterator<Item = &(BodyBox, FatLine)> {
        let count = self.slots.len().div_ceil(Self::BATCH);
        let batches = self.batches[..count].iter();
        batches.flat_map(move |by_slice| &by_slice[slice])
    }
}

/// Forms the boxes and fat lines of some bodies by slice, in place of those in the lists.
fn form_batch(
    bodies: &BodyTable<'_>,
    slots: &[u32],
    ends: &[f64],
    by_slice: &mut Vec<Vec<(BodyBox, FatLine)>>,
) {
    let slices = ends.len() - 1;
    if by_slice.len() < slices {
        by_slice.resize_with(slices, Vec::new);
    }
    by_slice.iter_mut().for_each(Vec::clear);
    let most = SLICES_AT_A_TIME;
    for first in (0..slices).step_by(most) {
        let ends = &ends[first..=slices.min(first + most)];
        let (slots, by_slice) = (slots.iter().copied(), &mut by_slice[first..]);
        bodies.boxes(slots, ends, &mut |slice, boxed, fat_line| {
            by_slice[slice].push((boxed, *fat_line));
        });
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failure fails the test")]

    use super::*;
    use crate::monitor::{AlertLevel, Monitor};
    use crate::rounding::earliest_exact;
    use crate::scene::Body;
    use crate::trajectory::{State, Trajectory};
    use glam::DVec3;

    /// Each piece costs a span in each pair; a cubic costs more than a straight motion.
    #[test]
    fn a_body_that_is_told_each_tick_has_two_straight_pieces_from_the_clock_on() {
        let state = |now: f64| State::new(now, DVec3::splat(now), now * DVec3::X);
        let mut scene = Scene::new();
        let plan = Trajectory::coasting(state(10.0)).unwrap();
        let ids = [0; 2].map(|_| scene.insert(Body::new(plan.clone())).unwrap());
        let mut monitor = Monitor::new(scene, 10.0, 2.0, &[AlertLevel::at(0.1)]).unwrap();
        for frame in 0..8 {
            let clock = monitor.now();
            let now = 10.0 + f64::from(frame) / 60.0;
            monitor.track(now, ids.map(|id| (id, state(now)))).unwrap();
            let search = &monitor.search;
            let bodies = BodyTable::of(&monitor.scene, &search.monitored, &search.grid);
            for id in ids {
                let moving_frame = &search.grid.frame;
                let is_straight = bodies
                    .straight(id.slot, earliest_exact(clock), moving_frame)
                    .is_some();
                let knots = bodies.get(id.slot).unwrap().knots.own();
                // At first there is the motion that was inserted.
                let is_as_told = is_straight && knots[..2] == [clock, now] && knots.len() == 3;
                assert!(frame < 4 || is_as_told, "{now} {is_straight} {knots:?}");
            }
            monitor.advance(now, &mut Vec::new()).unwrap();
        }
    }
}
