//! The time that plans cover.

use super::{Body, Scene};
use crate::window::Window;

impl Scene {
    /// Returns the time that plans cover, from the earliest first knot to the latest last one. This
    /// is the window of a [query without one](crate::Query::default). Motion beyond the knots does
    /// not count.
    ///
    /// Bodies [at rest](crate::Trajectory::at_rest) and bodies that [coast](crate::Trajectory::coasting) from a
    /// single state do not count either. The result is `None` if there are no others. A body at rest that is given a plan
    /// keeps its knot at 0 s, which counts then: where times are far from 0, name a window.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Body, Outside, Query, Scene, State, Trajectory, Window};
    ///
    /// let mut scene = Scene::new();
    /// scene.insert(Body::new(Trajectory::at_rest(DVec3::ONE)?))?;
    /// assert_eq!(scene.planned(), None);
    /// let states = [5.0, 9.0].map(|time| State::new(time, time * DVec3::X, DVec3::X));
    /// let plan = Trajectory::from_states(&states)?.with_outside(Outside::Coast);
    /// scene.insert(Body::new(plan))?;
    /// // Both exist at all times; the screening looks at what is planned.
    /// assert_eq!(scene.planned(), Some(Window::new(5.0, 9.0)?));
    /// assert_eq!(scene.screen(&Query::default())?.window, Window::new(5.0, 9.0)?);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    #[must_use]
    pub fn planned(&self) -> Option<Window> {
        planned(self.bodies().map(|(_, body)| body))
    }
}

/// Returns the time that the plans of some bodies cover: see [`Scene::planned`].
pub(crate) fn planned<'b>(bodies: impl Iterator<Item = &'b Body>) -> Option<Window> {
    let planned = bodies.filter_map(|body| match body.trajectory.knots() {
        [first, .., last] => Window::new(*first, *last).ok(),
        _ => None,
    });
    planned.reduce(hull)
}

/// Returns the least window that contains both.
fn hull(one: Window, other: Window) -> Window {
    let (start, end) = (one.start().min(other.start()), one.end().max(other.end()));
    Window::new(start, end).unwrap_or(Window::ALL)
}
