//! A clock that is set ahead: the time in between is not looked at.

use super::Monitor;
use super::event::EndReason;
use super::grid::{Grid, GridReview};
#[cfg(feature = "recording")]
use super::recording::Record;
use crate::error::Error;
use crate::rounding::{earliest_exact, without_negative_zero};

impl Monitor {
    /// Sets the clock to `now` (s) without looking at the time since the last tick: for a game that loads another level,
    /// and for a moment in which [more bodies meet](Error::TooCrowded) than there is room for.
    ///
    /// [`advance`](Self::advance) reports all encounters on its way. This reports none of them. Each encounter that had begun ends
    /// with [`EndReason::ClockSet`] at the instant up to which events were reported, and each one ahead is withdrawn.
    /// The next tick reports these events, and looks at all bodies like the first one of a new monitor: what is under way
    /// at `now` begins then, with another id. Until that tick there are no [`conflicts`](Self::conflicts).
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{AlertLevel, Body, Error, Monitor, Scene, State, Trajectory};
    ///
    /// // A thousand fragments fly off from one point.
    /// let mut scene = Scene::new();
    /// for number in 0..1_000 {
    ///     let (sin, cos) = f64::from(number).sin_cos();
    ///     let state = State::new(0.0, DVec3::ZERO, DVec3::new(cos, sin, 0.0));
    ///     scene.insert(Body::new(Trajectory::coasting(state)?))?;
    /// }
    /// let mut monitor = Monitor::new(scene, 0.0, 5.0, &[AlertLevel::at(1e-6)])?;
    /// monitor.set_max_spans(100_000);
    /// let mut events = Vec::new();
    /// let refused = monitor.advance(0.5, &mut events);
    /// assert!(matches!(refused, Err(Error::TooCrowded { .. })));
    /// // However far it goes, it would have to report the beginning.
    /// monitor.skip_to(0.5)?;
    /// monitor.advance(0.5, &mut events)?;
    /// assert!(monitor.is_caught_up());
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::ClockWentBack`], [`Error::Clock`]; [`Error::InBody`] with [`Error::OutOfRange`] or
    /// [`Error::TooFar`] if a plan cannot be followed through the lookahead. Then the clock stays where it was.
    pub fn skip_to(&mut self, now: f64) -> Result<(), Error> {
        let now = without_negative_zero(now);
        self.check_clock(now)?;
        let (margin, lookahead) = (self.search.grid.margin, (now, self.lookahead));
        let mut grid = Grid::for_scene(&self.scene, margin, lookahead, now)?;
        // All instants that may be reported as `now` lie in the first slice: the one before it, in which there may be a
        // crowd, is not searched.
        grid.origin = earliest_exact(now).next_down();
        let before = (self.now, self.reported, self.known);
        (self.now, self.reported, self.known) = (now, now, now);
        if let Err(error) = self.renew(self.search.emptied(grid)) {
            (self.now, self.reported, self.known) = before;
            return Err(error);
        }
        self.grid_review = GridReview::after_comparison(self.scene.len(), now);
        let (_, reported, _) = before;
        self.end_of_removed(reported);
        for encounters in &mut self.encounters {
            let events = &mut self.pending_events;
            encounters.end(reported, EndReason::ClockSet, |_| true, events);
        }
        self.conflicts.iter_mut().for_each(Vec::clear);
        #[cfg(feature = "recording")]
        self.write_down(|| Record::SkipTo(now));
        Ok(())
    }
}
