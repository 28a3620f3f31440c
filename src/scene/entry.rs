//! A body in a scene, with cached data of its motion.

use super::arena::{ArenaRange, CubicArena};
use super::body::Body;
use crate::bounds::{CacheLine, CompactTrajectory, CompactView, DAabb};
use crate::trajectory::{Segment, StraightMotion, Trajectory};
use std::sync::OnceLock;

/// The cached data of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionSummary {
    /// Approximate extremes of all segments, m.
    pub(crate) extremes: DAabb,
    /// Largest error of a piece's points, m.
    error: f64,
    /// Sum of the segments' extents, m: an estimate of the length of the path.
    pub(crate) path: f64,
    /// Header of the compact trajectory, the copy in f32; its cache lines are stored separately.
    pub(crate) compact: CompactTrajectory,
}

impl MotionSummary {
    fn of(trajectory: &Trajectory, cache_lines: &mut [CacheLine]) -> Self {
        let (knots, segments) = (trajectory.piece_knots(), trajectory.cubics());
        let (compact, extremes, error) = CompactTrajectory::write(knots, segments, cache_lines);
        let mut summary = Self {
            extremes,
            error,
            path: segments.iter().map(Segment::extent).sum(),
            compact,
        };
        if segments.is_empty() {
            let position = trajectory
                .position(summary.compact.ends().0)
                .unwrap_or_default();
            summary.extremes.include(DAabb::of_point(position));
        }
        summary
    }

    /// Returns a box around all segments with their errors, m; to rounding.
    pub(crate) fn around(&self) -> DAabb {
        DAabb {
            low: self.extremes.low - self.error,
            high: self.extremes.high + self.error,
        }
    }
}

/// The storage of a body's compact trajectory.
#[derive(Debug)]
enum CompactStorage {
    /// Cache lines in the scene's arena.
    Shared(ArenaRange),
    /// Allocated on its own, by a read access to the scene.
    Own(Vec<CacheLine>),
}

impl CompactStorage {
    /// Computes the summary of a trajectory on cache lines of its own.
    fn of(trajectory: &Trajectory) -> (MotionSummary, Self) {
        let mut cache_lines = vec![CacheLine::BLANK; cache_lines_for(trajectory)];
        let summary = MotionSummary::of(trajectory, &mut cache_lines);
        (summary, Self::Own(cache_lines))
    }

    /// Computes the summary of a trajectory on cache lines of an arena, in place of a previous one.
    fn shared(
        trajectory: &Trajectory,
        before: Option<ArenaRange>,
        arena: &mut CubicArena,
    ) -> (MotionSummary, Self) {
        let count = cache_lines_for(trajectory);
        let range = match before {
            Some(range) => arena.exchange(range, count),
            None => arena.take(count),
        };
        let summary = MotionSummary::of(trajectory, arena.at_mut(&range));
        (summary, Self::Shared(range))
    }
}

/// Returns the number of cache lines of a trajectory's compact form.
fn cache_lines_for(trajectory: &Trajectory) -> usize {
    CompactTrajectory::cache_lines(trajectory.piece_knots().len(), trajectory.cubics().len())
}

#[derive(Debug)]
pub(crate) struct SceneEntry {
    pub(crate) body: Body,
    /// The summary of a plan, allocated on its own: straight motions need none.
    summary: OnceLock<Box<(MotionSummary, CompactStorage)>>,
}

impl SceneEntry {
    /// Returns the entry of a body in the scene with this arena.
    pub(super) fn new(body: Body, arena: &mut CubicArena) -> Self {
        let mut entry = Self {
            body,
            summary: OnceLock::new(),
        };
        entry.form_summary(None, arena);
        entry
    }

    /// Returns the approximate extremes of all segments, m; of straight motions, the first one's origin.
    pub(crate) fn extremes(&self) -> DAabb {
        match self.body.trajectory.straight_motions().first() {
            Some(motion) => DAabb::of_point(motion.origin()),
            None => self.summary().extremes,
        }
    }

    /// Returns the summary of a plan; computes it if needed.
    pub(crate) fn summary(&self) -> &MotionSummary {
        &self.cached().0
    }

    fn cached(&self) -> &(MotionSummary, CompactStorage) {
        let trajectory = &self.body.trajectory;
        debug_assert!(trajectory.straight_motions().is_empty());
        self.summary
            .get_or_init(|| Box::new(CompactStorage::of(trajectory)))
    }

    /// Returns the compact trajectory; the arena is that of the body's scene.
    pub(crate) fn compact_view<'a>(&'a self, arena: &'a CubicArena) -> CompactView<'a> {
        let (summary, cache_lines) = self.cached();
        summary.compact.on(match cache_lines {
            CompactStorage::Shared(range) => arena.at(range),
            CompactStorage::Own(cache_lines) => cache_lines,
        })
    }

    /// Replaces the trajectory and returns the old one.
    pub(super) fn follow(
        &mut self,
        mut trajectory: Trajectory,
        arena: &mut CubicArena,
    ) -> Trajectory {
        let before = self.summary.take();
        std::mem::swap(&mut self.body.trajectory, &mut trajectory);
        self.form_summary(before, arena);
        trajectory
    }

    /// Computes the summary of a plan, in place of a previous one.
    fn form_summary(
        &mut self,
        before: Option<Box<(MotionSummary, CompactStorage)>>,
        arena: &mut CubicArena,
    ) {
        self.summary = before.map_or_else(OnceLock::new, OnceLock::from);
        let trajectory = &self.body.trajectory;
        if !trajectory.straight_motions().is_empty() {
            self.forget_summary(arena);
        } else if let Some(kept) = self.summary.get_mut() {
            let range = match &mut kept.1 {
                CompactStorage::Shared(range) => Some(std::mem::take(range)),
                CompactStorage::Own(_) => None,
            };
            **kept = CompactStorage::shared(trajectory, range, arena);
        } else {
            self.summary = Box::new(CompactStorage::shared(trajectory, None, arena)).into();
        }
    }

    /// Gives the body a straight motion.
    #[inline]
    pub(super) fn follow_straight(&mut self, motion: &StraightMotion, arena: &mut CubicArena) {
        if !self.replace_straight(motion) {
            self.forget_summary(arena);
            self.body.trajectory = Trajectory::of_straight(*motion);
        }
    }

    /// Gives the body a straight motion if it follows one. Returns false, and does nothing, if it follows a plan.
    #[inline]
    pub(super) fn replace_straight(&mut self, motion: &StraightMotion) -> bool {
        let is_straight = !self.body.trajectory.straight_motions().is_empty();
        if is_straight {
            self.body.trajectory = Trajectory::of_straight(*motion);
        }
        is_straight
    }

    /// Replaces the motion in place: see [`Trajectory::replace`].
    pub(super) fn replace_motion(
        &mut self,
        (from, motion, since): (f64, &StraightMotion, f64),
        arena: &mut CubicArena,
    ) -> &Trajectory {
        self.forget_summary(arena);
        self.body.trajectory.replace(from, motion, since);
        &self.body.trajectory
    }

    /// Swaps the trajectory in place. The summary is computed when needed: a body that is replanned
    /// each tick seldom needs it.
    pub(super) fn swap(&mut self, trajectory: &mut Trajectory, arena: &mut CubicArena) {
        self.forget_summary(arena);
        std::mem::swap(&mut self.body.trajectory, trajectory);
    }

    /// Returns the body alone; it leaves the scene.
    pub(super) fn leave(mut self, arena: &mut CubicArena) -> Body {
        self.forget_summary(arena);
        self.body
    }

    /// Copies the compact trajectory from the scene's old arena to the new one.
    pub(super) fn move_compact(&mut self, old: &CubicArena, arena: &mut CubicArena) {
        if let Some((_, CompactStorage::Shared(range))) =
            self.summary.get_mut().map(|kept| &mut **kept)
        {
            *range = arena.take_copy(old, range);
        }
    }

    fn forget_summary(&mut self, arena: &mut CubicArena) {
        if let Some((_, CompactStorage::Shared(range))) = self.summary.take().map(|kept| *kept) {
            arena.give_back(range);
        }
    }

    /// Returns this entry for a copy of its scene.
    pub(super) fn copy(&self, arena: &CubicArena, copy: &mut CubicArena) -> Self {
        let summary = self.summary.get().map(|kept| {
            let (summary, cache_lines) = &**kept;
            let cache_lines = match cache_lines {
                CompactStorage::Shared(range) => {
                    CompactStorage::Shared(copy.take_copy(arena, range))
                }
                CompactStorage::Own(cache_lines) => CompactStorage::Own(cache_lines.clone()),
            };
            Box::new((*summary, cache_lines))
        });
        Self {
            body: self.body.clone(),
            summary: summary.map_or_else(OnceLock::new, OnceLock::from),
        }
    }
}
