//! A body in a scene, with what screenings work out of its motion: once, and kept for the next one.

use super::arena::{ArenaRange, CubicArena};
use super::body::Body;
use crate::bounds::{CompactTrajectory, CompactView, DAabb, Line};
use crate::error::Error;
use crate::trajectory::{Extension, Segment, Trajectory};
use crate::window::Window;
use std::sync::OnceLock;

/// What screening needs to know of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionSummary {
    /// Rough extremes of all segments, m.
    pub(crate) extremes: DAabb,
    /// Sum of the segments' extents: a bound on the way flown, m.
    pub(crate) path: f64,
    /// Drawn on lines that are kept beside it.
    pub(crate) sketch: CompactTrajectory,
}

impl MotionSummary {
    fn of(trajectory: &Trajectory, lines: &mut [Line]) -> Self {
        if let Some((segment, [first, last])) = trajectory.line() {
            let position = segment.origin();
            return Self {
                extremes: DAabb {
                    low: position,
                    high: position,
                },
                path: 2.0 * segment.extent(),
                sketch: CompactTrajectory::of_line((first, last)),
            };
        }
        let (knots, segments) = (trajectory.cuts(), trajectory.cubics());
        let (sketch, extremes) = CompactTrajectory::draw(knots, segments, lines);
        let mut outline = Self {
            extremes,
            path: segments.iter().map(Segment::extent).sum(),
            sketch,
        };
        if segments.is_empty() {
            let position = trajectory
                .position(outline.sketch.ends().0)
                .unwrap_or_default();
            outline.extremes.include(DAabb {
                low: position,
                high: position,
            });
        }
        outline
    }
}

/// Where a body's compact trajectory is drawn.
#[derive(Debug)]
enum Lines {
    /// As it was put into the scene.
    Shared(ArenaRange),
    /// While the scene was being read.
    Own(Vec<Line>),
}

impl Lines {
    /// Outlines a trajectory on lines of its own.
    fn of(trajectory: &Trajectory) -> (MotionSummary, Self) {
        let mut lines = vec![Line::BLANK; lines_for(trajectory)];
        let outline = MotionSummary::of(trajectory, &mut lines);
        (outline, Self::Own(lines))
    }

    /// The same on lines of an arena, in place of those of an outline before.
    fn shared(
        trajectory: &Trajectory,
        before: Option<(MotionSummary, Self)>,
        arena: &mut CubicArena,
    ) -> (MotionSummary, Self) {
        let count = lines_for(trajectory);
        let range = match before {
            Some((_, Self::Shared(range))) => arena.exchange(range, count),
            _ => arena.take(count),
        };
        let outline = MotionSummary::of(trajectory, arena.at_mut(&range));
        (outline, Self::Shared(range))
    }
}

/// Lines that the compact form of a trajectory takes.
fn lines_for(trajectory: &Trajectory) -> usize {
    match trajectory.line() {
        Some(_) => 0,
        None => CompactTrajectory::lines(trajectory.cuts().len(), trajectory.cubics().len()),
    }
}

/// A body, and what was worked out of its motion so far.
#[derive(Debug)]
pub(crate) struct SceneEntry {
    pub(crate) body: Body,
    outline: OnceLock<(MotionSummary, Lines)>,
}

impl SceneEntry {
    /// The body in the scene with this arena.
    pub(super) fn new(body: Body, arena: &mut CubicArena) -> Self {
        let outline = Lines::shared(&body.trajectory, None, arena).into();
        Self { body, outline }
    }

    /// Of the trajectory: worked out now, if it was not yet.
    pub(crate) fn outline(&self) -> &MotionSummary {
        &self.outlined().0
    }

    fn outlined(&self) -> &(MotionSummary, Lines) {
        let trajectory = &self.body.trajectory;
        self.outline.get_or_init(|| Lines::of(trajectory))
    }

    /// The compact trajectory; the arena is that of the scene that the body is in.
    pub(crate) fn drawing<'a>(&'a self, arena: &'a CubicArena) -> CompactView<'a> {
        let (outline, lines) = self.outlined();
        outline.sketch.on(match lines {
            Lines::Shared(range) => arena.at(range),
            Lines::Own(lines) => lines,
        })
    }

    /// Returns the pieces that the body follows beyond its knots over a window; none if that stays within
    /// them.
    ///
    /// # Errors
    ///
    /// [`Error::WindowNotClosed`]; [`Error::InBody`] with those of [`Trajectory::extension`].
    pub(crate) fn extension(&self, window: Window) -> Result<Option<Extension>, Error> {
        let Body {
            trajectory, tag, ..
        } = &self.body;
        if !trajectory.goes_beyond() {
            return Ok(None);
        }
        let followed = trajectory.domain().intersection(window);
        if followed.is_some_and(|followed| !followed.is_closed()) {
            return Err(Error::WindowNotClosed { body: *tag });
        }
        let extension = trajectory.extension(window);
        extension.map_err(|error| error.in_body(*tag))
    }

    /// Gives the body another trajectory, and returns the old one.
    pub(super) fn follow(
        &mut self,
        mut trajectory: Trajectory,
        arena: &mut CubicArena,
    ) -> Trajectory {
        let outline = Lines::shared(&trajectory, self.outline.take(), arena);
        self.swap(&mut trajectory, arena);
        self.outline = outline.into();
        trajectory
    }

    /// The same in place. The outline is left for when it is asked for: a body that is replanned
    /// each tick seldom needs it.
    pub(super) fn swap(&mut self, trajectory: &mut Trajectory, arena: &mut CubicArena) {
        self.forget_outline(arena);
        std::mem::swap(&mut self.body.trajectory, trajectory);
    }

    /// The body alone, which is in the scene no more.
    pub(super) fn leave(mut self, arena: &mut CubicArena) -> Body {
        self.forget_outline(arena);
        self.body
    }

    /// Copies the compact trajectory from the scene's old arena to the new one.
    pub(super) fn move_sketch(&mut self, old: &CubicArena, arena: &mut CubicArena) {
        if let Some((_, Lines::Shared(range))) = self.outline.get_mut() {
            *range = arena.take_copy(old, range);
        }
    }

    fn forget_outline(&mut self, arena: &mut CubicArena) {
        if let Some((_, Lines::Shared(range))) = self.outline.take() {
            arena.give_back(range);
        }
    }

    /// The same body in a copy of its scene.
    pub(super) fn copy(&self, arena: &CubicArena, copy: &mut CubicArena) -> Self {
        let outline = self.outline.get().map(|(outline, lines)| {
            let lines = match lines {
                Lines::Shared(range) => Lines::Shared(copy.take_copy(arena, range)),
                Lines::Own(lines) => Lines::Own(lines.clone()),
            };
            (*outline, lines)
        });
        Self {
            body: self.body.clone(),
            outline: outline.map_or_else(OnceLock::new, OnceLock::from),
        }
    }
}
