//! A body in a scene, with what screenings work out of its motion: once, and kept for the next one.

use super::Body;
use crate::bounds::{Extremes, Sketch};
use crate::error::Error;
use crate::trajectory::{Outside, Pieces, Scope, Segment, Trajectory};
use crate::window::Window;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// What screening needs to know of a motion.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// Rough extremes of all segments, m.
    pub(crate) extremes: Extremes,
    /// Sum of the segments' extents: a bound on the way flown, m.
    pub(crate) path: f64,
    pub(crate) sketch: Sketch,
}

impl Outline {
    const NONE: Self = Self {
        extremes: Extremes::NOTHING,
        path: 0.0,
        sketch: Sketch::EMPTY,
    };

    fn of(trajectory: &Trajectory) -> Self {
        let mut outline = Self::NONE;
        outline.follow(trajectory);
        outline
    }

    /// The outline of another trajectory, in this one's memory.
    fn follow(&mut self, trajectory: &Trajectory) {
        self.draw(trajectory.knots(), trajectory.segments());
        if trajectory.segments().is_empty() {
            let position = trajectory
                .position(self.sketch.knots().ends().0)
                .unwrap_or_default();
            self.extremes.include(Extremes {
                low: position,
                high: position,
            });
        }
    }

    fn draw(&mut self, knots: &[f64], segments: &[Segment]) {
        self.extremes = self.sketch.redraw(knots, segments);
        self.path = segments.iter().map(Segment::extent).sum();
    }
}

/// A motion that goes on beyond its knots, over windows that reach there.
#[derive(Debug)]
pub(crate) struct Beyond {
    /// Which windows.
    scope: Scope,
    /// Of all the pieces.
    pub(crate) outline: Outline,
    pub(crate) pieces: Pieces,
    /// The ways beyond the knots.
    pub(crate) ways: Vec<Way>,
}

/// One piece of a motion, roughly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// First and last instant, s.
    pub(crate) ends: (f64, f64),
    /// From one end to the other, m.
    pub(crate) length: f64,
}

impl Beyond {
    fn of(pieces: Pieces) -> Self {
        let ways = pieces.beyond().map(|(segment, ends)| {
            let [from, to] = [ends.0, ends.1].map(|time| segment.motion_at(time).0);
            let length = from.distance(to);
            Way { ends, length }
        });
        let ways = ways.collect();
        let mut outline = Outline::NONE;
        outline.draw(&pieces.knots, &pieces.segments);
        Self {
            scope: pieces.scope(),
            outline,
            pieces,
            ways,
        }
    }
}

/// A body, and what was worked out of its motion so far.
#[derive(Debug)]
pub(crate) struct Occupant {
    pub(crate) body: Body,
    outline: OnceLock<Outline>,
    /// As far as the last screening reached.
    beyond: Mutex<Option<Arc<Beyond>>>,
}

impl Occupant {
    pub(super) fn new(body: Body) -> Self {
        let outline = Outline::of(&body.trajectory).into();
        Self {
            body,
            outline,
            beyond: Mutex::default(),
        }
    }

    /// Of the trajectory: worked out now, if it was not yet.
    pub(crate) fn outline(&self) -> &Outline {
        let trajectory = &self.body.trajectory;
        self.outline.get_or_init(|| Outline::of(trajectory))
    }

    /// What the body follows over a window; none if that stays within its knots. How far that is
    /// laid out depends on the window alone, not on what was asked before.
    ///
    /// # Errors
    ///
    /// [`Error::WindowNotClosed`]; [`Error::InBody`] with those of [`Trajectory::pieces`].
    pub(crate) fn beyond(&self, window: Window) -> Result<Option<Arc<Beyond>>, Error> {
        let Body {
            trajectory, tag, ..
        } = &self.body;
        if trajectory.outside() == Outside::Absent {
            return Ok(None);
        }
        if !window.is_closed() {
            return Err(Error::WindowNotClosed { body: *tag });
        }
        let mut kept = self.beyond.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(beyond) = &*kept
            && beyond.scope.holds(window)
        {
            return Ok(Some(Arc::clone(beyond)));
        }
        let pieces = trajectory.pieces(window);
        let Some(pieces) = pieces.map_err(|error| error.in_body(*tag))? else {
            return Ok(None);
        };
        let beyond = Arc::new(Beyond::of(pieces));
        *kept = Some(Arc::clone(&beyond));
        Ok(Some(beyond))
    }

    /// Gives the body another trajectory, whose outline is drawn in the old one's memory; returns
    /// the old one.
    pub(super) fn follow(&mut self, mut trajectory: Trajectory) -> Trajectory {
        let mut outline = self.outline.take().unwrap_or(Outline::NONE);
        outline.follow(&trajectory);
        self.swap(&mut trajectory);
        self.outline = outline.into();
        trajectory
    }

    /// The same in place. The outline is left for when it is asked for: a body that is replanned
    /// each tick seldom needs it.
    pub(super) fn swap(&mut self, trajectory: &mut Trajectory) {
        self.outline = OnceLock::new();
        let beyond = self.beyond.get_mut();
        *beyond.unwrap_or_else(PoisonError::into_inner) = None;
        std::mem::swap(&mut self.body.trajectory, trajectory);
    }
}

impl Clone for Occupant {
    /// What is beyond the knots is shared: it is never changed, only replaced.
    fn clone(&self) -> Self {
        let beyond = self.beyond.lock().unwrap_or_else(PoisonError::into_inner);
        Self {
            body: self.body.clone(),
            outline: self.outline.clone(),
            beyond: Mutex::new(beyond.clone()),
        }
    }
}
