//! Straight motions of many bodies, told in one call.

use super::Scene;
use super::told_states::ToldStates;
use crate::error::Error;
use crate::id::BodyId;
use crate::orientation::ToldSpin;
use crate::parallel;
use crate::trajectory::{State, StraightMotion, Trajectory};
use glam::{DQuat, DVec3};

/// The state of a body at one instant, as [`Scene::update`] and
/// [`Monitor::track`](crate::Monitor::track) take it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct BodyState {
    /// Time, position and velocity.
    pub state: State,
    /// Rotation and angular velocity at that time; `None` leaves the body's orientation as it is.
    #[cfg_attr(feature = "serde", serde(default))]
    pub spin: Option<Spin>,
}

/// The rotation and the angular velocity of a body at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spin {
    /// Rotation from the body's axes to those of the world: a unit quaternion.
    pub rotation: DQuat,
    /// Angular velocity in the world's axes, rad/s.
    pub angular_velocity: DVec3,
}

impl From<State> for BodyState {
    fn from(state: State) -> Self {
        Self { state, spin: None }
    }
}

impl BodyState {
    /// Returns the state with a rotation and an angular velocity (rad/s, in the world's axes) at
    /// its time: see [`Orientation::spin`](crate::Orientation::spin).
    ///
    /// ```
    /// use nearmiss::glam::{DQuat, DVec3};
    /// use nearmiss::{BodyState, State};
    ///
    /// let state = State::new(0.0, DVec3::ZERO, DVec3::X);
    /// let told = BodyState::from(state).with_spin(DQuat::IDENTITY, DVec3::Z);
    /// assert!(told.spin.is_some_and(|spin| spin.angular_velocity == DVec3::Z));
    /// ```
    #[must_use]
    pub fn with_spin(mut self, rotation: DQuat, angular_velocity: impl Into<DVec3>) -> Self {
        self.spin = Some(Spin {
            rotation,
            angular_velocity: angular_velocity.into(),
        });
        self
    }

    /// Returns the straight motion through a state without spin whose numbers are ordinary ones.
    #[inline(always)]
    pub(crate) fn ordinary_motion(&self) -> Option<StraightMotion> {
        let is_ordinary = self.spin.is_none() && StraightMotion::is_ordinary(&self.state);
        is_ordinary.then(|| StraightMotion::through_ordinary(&self.state))
    }

    /// Returns the spin, checked, if there is one.
    ///
    /// # Errors
    ///
    /// As [`Orientation::spin`](crate::Orientation::spin).
    pub(crate) fn told_spin(&self) -> Result<Option<ToldSpin>, Error> {
        let time = self.state.time;
        let spin = self
            .spin
            .map(|spin| ToldSpin::new(time, spin.rotation, spin.angular_velocity));
        spin.transpose()
    }

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
    /// engine or a network tells of all bodies, each frame. A state with a [spin](BodyState::with_spin)
    /// gives the body the orientation [`Orientation::spin`](crate::Orientation::spin) as well, with the
    /// [tolerance](crate::Orientation::with_tolerance) that the body's own has.
    ///
    /// A body that is left out keeps its plan. The last state of a body that is named twice counts, also one
    /// without a spin. A state replaces the body's trajectory also where both are the same motion: its time is then the
    /// only knot. ([`Monitor::track`](crate::Monitor::track) leaves such a body as it is.)
    ///
    /// In steady state nothing is allocated on one thread: a body that had another trajectory of one state, and another
    /// orientation, takes no memory for the new ones. Several threads share lists that are made anew.
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
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::NotFinite`], [`Error::OutOfRange`],
    /// [`Error::RotationLength`], [`Error::AngularSpeed`] or [`Error::TurningHalfSpace`]. The error of
    /// the first state that is refused; nothing was changed then.
    pub fn update<S: Into<BodyState>>(
        &mut self,
        states: impl IntoIterator<Item = (BodyId, S)>,
    ) -> Result<(), Error> {
        let mut told = std::mem::take(&mut self.told);
        told.clear();
        let mut checked = Ok(());
        for (id, state) in states {
            let told_state: BodyState = state.into();
            if let Some(motion) = told_state.ordinary_motion()
                && self.has(id)
            {
                told.put((id, motion), None);
                continue;
            }
            let taken = self.check_state(id, told_state, &mut told);
            if taken.is_err() {
                checked = taken.map_err(|error| error.with_id(id));
                break;
            }
        }
        if checked.is_ok() {
            let many = Self::FEW.max(self.slots.len() / 2);
            let is_shared = parallel::threads() > 1 && told.ids.len() > many;
            if is_shared {
                self.follow_shared(&told);
            } else {
                self.follow_each(&told);
            }
            for (id, spin) in told.spins() {
                let slot = self.slots.get_mut(id.slot as usize);
                if let Some(entry) = slot.and_then(|slot| slot.entry.as_mut()) {
                    entry.body.orientation.set_spin(spin);
                }
            }
            self.tidy();
        }
        self.told = told;
        checked
    }

    /// So many bodies are told on one thread.
    const FEW: usize = 8_192;

    /// Gives the bodies their motions, in the order in which they were told.
    fn follow_each(&mut self, told: &ToldStates) {
        /// Bodies that are fetched ahead.
        const AHEAD: usize = 8;
        for (place, (id, motion)) in told.ids.iter().zip(&told.motions).enumerate() {
            if let Some(later) = told.ids.get(place + AHEAD) {
                self.prefetch(later.slot);
            }
            // It was found before.
            let slot = self.slots.get_mut(id.slot as usize);
            if let Some(entry) = slot.and_then(|slot| slot.entry.as_mut()) {
                entry.follow_straight(motion, &mut self.arena);
            }
        }
    }

    /// Gives the bodies their motions on several threads, in the order of their slots.
    fn follow_shared(&mut self, told: &ToldStates) {
        /// Slots that one thread goes through together.
        const CHUNK: usize = 1024;
        let motion_of = |slot| told.place(slot).map(|place| &told.motions[place]);
        let slots = self.slots.chunks_mut(CHUNK);
        let mut chunks: Vec<_> = slots.map(|slots| (slots, Vec::new())).collect();
        parallel::for_each(&mut chunks, |number, (slots, others)| {
            for (place, slot) in slots.iter_mut().enumerate() {
                let place = number * CHUNK + place;
                if let (Some(motion), Some(entry)) = (motion_of(place), &mut slot.entry)
                    && !entry.replace_straight(motion)
                {
                    others.push(place);
                }
            }
        });
        // Plans give back their memory, one after another.
        let others: Vec<usize> = chunks.into_iter().flat_map(|(_, others)| others).collect();
        for place in others {
            if let (Some(motion), Some(entry)) = (motion_of(place), &mut self.slots[place].entry) {
                entry.follow_straight(motion, &mut self.arena);
            }
        }
    }

    /// Notes the motion and the spin of a state.
    #[inline(never)]
    fn check_state(
        &self,
        id: BodyId,
        state: BodyState,
        told: &mut ToldStates,
    ) -> Result<(), Error> {
        let body = self.body(id).ok_or(Error::UnknownBody { id })?;
        let in_body = |error: Error| error.in_body(body.tag);
        let motion = state.motion().map_err(in_body)?;
        let spin = state.told_spin().map_err(in_body)?;
        if spin.is_some() && body.hitbox.is_half_space() {
            return Err(in_body(Error::TurningHalfSpace));
        }
        told.put((id, motion), spin);
        Ok(())
    }
}
