//! Straight motions of many bodies, told in one call.

use super::Scene;
use crate::error::Error;
use crate::id::BodyId;
use crate::trajectory::{State, StraightMotion, Trajectory};

/// The state of a body at one instant, as [`Scene::update`] and
/// [`Monitor::track`](crate::Monitor::track) take it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BodyState {
    /// Time, position and velocity.
    pub state: State,
}

impl From<State> for BodyState {
    fn from(state: State) -> Self {
        Self { state }
    }
}

impl BodyState {
    /// Returns the straight motion through the state.
    ///
    /// # Errors
    ///
    /// As [`Trajectory::coasting`].
    pub(crate) fn motion(&self) -> Result<StraightMotion, Error> {
        Trajectory::coasting_motion(&self.state)
    }
}

impl Scene {
    /// Gives each of these bodies the trajectory [`Trajectory::coasting`] from its state: what a physics
    /// engine or a network tells of all bodies, each frame.
    ///
    /// A body that is left out keeps its course. Of a body that is named twice the last state counts. A body
    /// that had another trajectory of one state takes no memory for the new one.
    ///
    /// ```
    /// use nearmiss::glam::DVec3;
    /// use nearmiss::{Body, Query, Scene, State, Trajectory, Window};
    ///
    /// let mut scene = Scene::new();
    /// let ids: Vec<_> = [0.0, 30.0]
    ///     .into_iter()
    ///     .map(|x| scene.insert(Body::new(Trajectory::at_rest(x * DVec3::X)?)))
    ///     .collect::<Result<_, _>>()?;
    /// // Frame by frame: where they are, and how they move.
    /// let now = 7.0;
    /// let velocities = [4.0 * DVec3::X, DVec3::ZERO];
    /// scene.update(ids.iter().zip([0.0, 30.0]).zip(velocities).map(|((&id, x), velocity)| {
    ///     (id, State::new(now, x * DVec3::X, velocity))
    /// }))?;
    /// let query = Query::new(Window::new(now, now + 10.0)?).with_margin(2.0);
    /// assert_eq!(scene.screen(&query)?.conflicts[0].enter, 14.0);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::NotFinite`] or [`Error::OutOfRange`]. The error of
    /// the first state that is refused; nothing was changed then.
    pub fn update<S: Into<BodyState>>(
        &mut self,
        states: impl IntoIterator<Item = (BodyId, S)>,
    ) -> Result<(), Error> {
        let mut told = std::mem::take(&mut self.told);
        told.clear();
        let mut checked = Ok(());
        for (id, state) in states {
            let body = self.body(id).ok_or(Error::UnknownBody { id });
            let motion = |tag| {
                let motion = state.into().motion();
                motion.map_err(|error: Error| error.in_body(tag))
            };
            match body.and_then(|body| motion(body.tag)) {
                Ok(motion) => told.push((id, motion)),
                Err(error) => {
                    checked = Err(error);
                    break;
                }
            }
        }
        if checked.is_ok() {
            /// Bodies that are fetched ahead.
            const AHEAD: usize = 8;
            for (place, (id, motion)) in told.iter().enumerate() {
                if let Some((later, _)) = told.get(place + AHEAD) {
                    self.prefetch(later.slot);
                }
                let (entry, arena) = self.entry_mut(*id)?;
                entry.follow_straight(motion, arena);
            }
            self.tidy();
        }
        self.told = told;
        checked
    }
}
