//! A clock, a lookahead, plans that change, and events: never a lost one.
//!
//! A [`Monitor`] owns a [`Scene`]. Between ticks plans change; [`Monitor::advance`] moves the clock
//! and tells what happened. Whenever all is caught up, [`Monitor::conflicts`] is, bit for bit, what
//! [`Scene::screen`] says of the window from now to the end of the lookahead.

mod boxes;
mod budget;
mod command;
mod encounters;
mod event;
mod outlook;
mod read;

pub use budget::Budget;
pub use command::Command;
pub use encounters::LeastChange;
pub use event::{Encounter, EncounterId, EndReason, Event, EventKind};

use crate::bounds::{Extremes, Frame};
use crate::broad_phase::{PairFilter, Sweep};
use crate::conflict::Conflict;
use crate::error::{Error, LARGEST_MAGNITUDE};
use crate::hitbox::Hitbox;
use crate::id::BodyId;
use crate::layers::Layers;
use crate::narrow_phase::Contact;
use crate::scene::{Body, Scene};
use crate::screen::conflict;
use crate::stats::Stats;
use crate::trajectory::{Outside, Trajectory};
use crate::window::Window;
use budget::Meter;
use command::Outcome;
use encounters::{Encounters, Plain, Tick};
use outlook::{Flight, Outlook};
use std::time::Instant;

/// A margin that is watched, and when to let go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlertLevel {
    /// An encounter begins when the separation falls to this, m.
    pub margin: f64,
    /// It ends when the separation exceeds this, m; at least the margin. More than the margin is
    /// hysteresis: an encounter that hovers at its margin does not flicker.
    pub release: f64,
}

impl AlertLevel {
    /// A level that lets go where it begins.
    #[must_use]
    pub const fn at(margin: f64) -> Self {
        Self {
            margin,
            release: margin,
        }
    }
}

/// Watches a scene as time passes and plans change.
///
/// ```
/// use nearmiss::glam::DVec3;
/// use nearmiss::{AlertLevel, Body, EventKind, Monitor, Scene, State, Trajectory};
///
/// let fly = |from: DVec3, velocity: DVec3| {
///     let states = [0.0, 20.0].map(|t| State::new(t, from + velocity * t, velocity));
///     Trajectory::from_states(&states)
/// };
/// let mut monitor = Monitor::new(Scene::new(), 0.0, 10.0, &[AlertLevel::at(2.0)])?;
/// monitor.insert(Body::new(fly(DVec3::ZERO, DVec3::X)?))?;
/// monitor.insert(Body::new(fly(DVec3::new(10.0, 1.0, 0.0), -DVec3::X)?))?;
/// let mut events = Vec::new();
/// monitor.advance(0.0, &mut events)?;
/// assert!(matches!(events[0].kind, EventKind::Predicted(_)));
/// monitor.advance(5.0, &mut events)?;
/// assert!(matches!(events.last().unwrap().kind, EventKind::Began(_)));
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Debug)]
pub struct Monitor {
    scene: Scene,
    outlook: Outlook<Sweep>,
    levels: Vec<AlertLevel>,
    encounters: Vec<Encounters>,
    conflicts: Vec<Vec<Conflict>>,
    now: f64,
    lookahead: f64,
    /// Up to where clock events have been told.
    told: f64,
    /// Up to where all is known.
    known: f64,
    history: f64,
    least_change: LeastChange,
    next_id: u64,
    /// Events of changes since the last tick.
    waiting: Vec<Event>,
    /// By slot: whether the end of the present plan has been told.
    end_told: Vec<bool>,
    stats: Stats,
    changed_bodies: u64,
    plain: Vec<Plain>,
    contacts: Vec<Contact>,
    released: Vec<Contact>,
    passed: Vec<Contact>,
}

/// Layers and ignored pairs, by slot.
struct Admission<'s>(&'s Scene);

impl PairFilter for Admission<'_> {
    fn admits(&self, a: u32, b: u32) -> bool {
        self.0.admits(a, b)
    }
}

impl Monitor {
    /// Slices that the lookahead is cut into: the boxes of more slices are tighter, and each
    /// changed plan is compared in every one of them.
    const SLICES_AHEAD: f64 = 4.0;

    /// A monitor of `scene` whose clock shows `now` (s) and that looks `lookahead` seconds ahead.
    /// Levels are numbered as given; usually the widest comes first.
    ///
    /// # Errors
    ///
    /// [`Error::Lookahead`], [`Error::AlertLevel`]; [`Error::InBody`] if a plan leaves the range of
    /// numbers within the lookahead.
    pub fn new(
        scene: Scene,
        now: f64,
        lookahead: f64,
        levels: &[AlertLevel],
    ) -> Result<Self, Error> {
        let usable = |value: f64| value.is_finite() && value.abs() < LARGEST_MAGNITUDE;
        if !usable(now) {
            return Err(Error::Lookahead { value: now });
        }
        // Slices must be told apart on the clock.
        let length = lookahead / Self::SLICES_AHEAD;
        let resolution = 4.0 * f64::EPSILON * now.abs();
        if !usable(lookahead) || length <= resolution || length < f64::MIN_POSITIVE {
            return Err(Error::Lookahead { value: lookahead });
        }
        let bad = |(_, level): &(usize, &AlertLevel)| {
            !(usable(level.margin) && usable(level.release) && level.release >= level.margin)
        };
        if let Some((level, alert)) = levels.iter().enumerate().find(bad) {
            return Err(Error::AlertLevel {
                level,
                margin: alert.margin,
                release: alert.release,
            });
        }
        let widest = levels.iter().map(|level| level.release);
        let widest = widest.reduce(f64::max).ok_or(Error::AlertLevel {
            level: 0,
            margin: f64::NAN,
            release: f64::NAN,
        })?;
        let mut extremes = Extremes::NOTHING;
        for (_, occupant) in scene.occupants() {
            extremes.include(occupant.outline.extremes);
        }
        let mut monitor = Self {
            outlook: Outlook::new(widest, Frame::around(extremes, widest.abs()), now, length),
            levels: levels.to_vec(),
            encounters: (0..levels.len()).map(Encounters::of_level).collect(),
            conflicts: vec![Vec::new(); levels.len()],
            now,
            lookahead,
            told: now,
            known: now,
            history: 0.0,
            least_change: LeastChange::default(),
            next_id: 0,
            waiting: Vec::new(),
            end_told: Vec::new(),
            stats: Stats::default(),
            changed_bodies: 0,
            plain: Vec::new(),
            contacts: Vec::new(),
            released: Vec::new(),
            passed: Vec::new(),
            scene: Scene::new(),
        };
        for (id, body) in scene.bodies() {
            let flight = monitor.flight(body)?;
            monitor.place(id.slot, Some(flight));
        }
        monitor.scene = scene;
        Ok(monitor)
    }

    /// Tells revisions only if numbers differ from those last sent by more than this.
    pub fn set_least_change(&mut self, least_change: LeastChange) {
        self.least_change = least_change;
    }

    /// Keeps plans this many seconds back when bodies are replanned (0 at first).
    pub fn set_history(&mut self, history: f64) {
        self.history = history.max(0.0);
    }

    /// The bodies and their plans.
    #[must_use]
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The clock, s.
    #[must_use]
    pub const fn now(&self) -> f64 {
        self.now
    }

    /// Before this instant nothing is missing, s. The end of the lookahead unless a budget ran out.
    #[must_use]
    pub const fn certified_until(&self) -> f64 {
        self.known
    }

    /// All conflicts of a level from now to [`certified_until`](Self::certified_until), as of the
    /// last tick, sorted by (enter, a, b). None for a level that does not exist.
    #[must_use]
    pub fn conflicts(&self, level: usize) -> &[Conflict] {
        self.conflicts.get(level).map_or(&[], Vec::as_slice)
    }

    /// The conflicts of one body at a level, soonest first.
    pub fn conflicts_of(&self, id: BodyId, level: usize) -> impl Iterator<Item = &Conflict> {
        let concerns = move |conflict: &&Conflict| conflict.a == id || conflict.b == id;
        self.conflicts(level).iter().filter(concerns)
    }

    /// The soonest conflict of one body at a level.
    #[must_use]
    pub fn next_conflict(&self, id: BodyId, level: usize) -> Option<&Conflict> {
        self.conflicts_of(id, level).next()
    }

    /// Encounters under way and ahead, level by level.
    pub fn encounters(&self) -> impl Iterator<Item = &Encounter> {
        self.encounters.iter().flat_map(Encounters::iter)
    }

    /// What the last tick did.
    #[must_use]
    pub const fn stats(&self) -> &Stats {
        &self.stats
    }

    /// Adds a body.
    ///
    /// # Errors
    ///
    /// [`Error::InBody`] if its plan leaves the range of numbers; [`Error::SceneFull`].
    pub fn insert(&mut self, body: Body) -> Result<BodyId, Error> {
        let flight = self.flight(&body)?;
        let id = self.scene.insert(body)?;
        self.place(id.slot, Some(flight));
        Ok(id)
    }

    /// Takes a body out. Its encounters end, or are withdrawn, at the present clock.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`].
    pub fn remove(&mut self, id: BodyId) -> Result<Body, Error> {
        let body = self.scene.remove(id)?;
        self.place(id.slot, None);
        for encounters in &mut self.encounters {
            let gone = |encounter: &Encounter| encounter.a == id || encounter.b == id;
            encounters.end(self.now, EndReason::BodyRemoved, gone, &mut self.waiting);
        }
        Ok(body)
    }

    /// Replaces a body's trajectory as a whole, the past included.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::InBody`].
    pub fn set_trajectory(&mut self, id: BodyId, trajectory: Trajectory) -> Result<(), Error> {
        self.apply([Command::SetTrajectory(id, trajectory)])
            .map(drop)
    }

    /// Replaces a body's hitbox.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::InBody`].
    pub fn set_hitbox(&mut self, id: BodyId, hitbox: Hitbox) -> Result<(), Error> {
        self.apply([Command::SetHitbox(id, hitbox)]).map(drop)
    }

    /// Replaces a body's layers.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::InBody`].
    pub fn set_layers(&mut self, id: BodyId, layers: Layers) -> Result<(), Error> {
        self.apply([Command::SetLayers(id, layers)]).map(drop)
    }

    /// From `from` (s) on the body follows `plan`; what it has flown until then stays. See
    /// [`Trajectory::spliced`].
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`]; [`Error::InBody`] with [`Error::NoPlanAt`] or
    /// [`Error::OutOfRange`].
    pub fn replan(&mut self, id: BodyId, from: f64, plan: Trajectory) -> Result<(), Error> {
        self.apply([Command::Replan(id, from, plan)]).map(drop)
    }

    /// Appends `plan` to the body's plan, from its last knot on.
    ///
    /// # Errors
    ///
    /// As [`replan`](Self::replan).
    pub fn extend(&mut self, id: BodyId, plan: Trajectory) -> Result<(), Error> {
        self.apply([Command::Extend(id, plan)]).map(drop)
    }

    /// Several changes that take effect together, or, if one is refused, not at all. Returns the
    /// ids of the inserted bodies, in order.
    ///
    /// # Errors
    ///
    /// That of the first command that is refused; nothing was changed then.
    pub fn apply(
        &mut self,
        commands: impl IntoIterator<Item = Command>,
    ) -> Result<Vec<BodyId>, Error> {
        let outcome = Outcome::of(&self.scene, commands, self.told - self.history)?;
        let mut flights = Vec::with_capacity(outcome.changed.len());
        for body in outcome.changed.values() {
            flights.push(body.as_ref().map(|body| self.flight(body)).transpose()?);
        }
        for body in &outcome.inserted {
            self.flight(body)?;
        }
        // Nothing below is refused: the scene has room for 2^32 bodies, and all ids were found.
        for ((id, body), flight) in outcome.changed.into_iter().zip(flights) {
            match body {
                Some(body) => {
                    self.scene.replace(id, body)?;
                    self.place(id.slot, flight);
                }
                None => drop(self.remove(id)?),
            }
        }
        outcome
            .inserted
            .into_iter()
            .map(|body| self.insert(body))
            .collect()
    }

    /// Leaves a pair out; its encounters end with [`EndReason::PlanChanged`] at the next tick.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`].
    pub fn ignore_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.scene.ignore_pair(a, b)?;
        self.outlook.forget(a.slot);
        Ok(())
    }

    /// Watches a pair again.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`].
    pub fn heed_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.scene.heed_pair(a, b)?;
        self.outlook.forget(a.slot);
        Ok(())
    }

    /// Which conflicts at a level the body would have from now to
    /// [`certified_until`](Self::certified_until) if it followed `plan` from now on. Changes
    /// nothing.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::InBody`]; [`Error::AlertLevel`] if there is no such level.
    pub fn what_if(
        &self,
        id: BodyId,
        plan: &Trajectory,
        level: usize,
    ) -> Result<Vec<Conflict>, Error> {
        let body = self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        let alert = self.levels.get(level).ok_or(Error::AlertLevel {
            level,
            margin: f64::NAN,
            release: f64::NAN,
        })?;
        let would = Body {
            trajectory: plan.clone(),
            ..body.clone()
        };
        let flight = self.flight(&would)?;
        let window = (self.now, self.known);
        let filter = Admission(&self.scene);
        let mut conflicts = Vec::new();
        self.outlook.contacts_with(
            id.slot,
            &flight,
            alert.margin,
            window,
            &filter,
            |other, clip, theirs, contact| {
                let Some((other, _)) = self.scene.in_slot(other) else {
                    return;
                };
                let own = flight.party();
                conflicts.push(if id.slot < other.slot {
                    conflict(contact, (id, other), (&own, theirs), clip)
                } else {
                    conflict(contact, (other, id), (theirs, &own), clip)
                });
            },
        );
        conflicts.sort_unstable_by(Conflict::order);
        Ok(conflicts)
    }

    /// Moves the clock to `now` (s) and appends what happened to `events`, in their order. The
    /// clock may stand still, or jump.
    ///
    /// # Errors
    ///
    /// [`Error::ClockWentBack`]; [`Error::InBody`] if an extrapolated plan leaves the range of
    /// numbers. The clock stays where it was.
    pub fn advance(&mut self, now: f64, events: &mut Vec<Event>) -> Result<(), Error> {
        self.advance_within(now, Budget::Unlimited, events)
    }

    /// The same within a budget, soonest first. When it is spent,
    /// [`certified_until`](Self::certified_until) says up to when nothing is missing; what happens
    /// later waits for later ticks.
    ///
    /// # Errors
    ///
    /// As [`advance`](Self::advance).
    pub fn advance_within(
        &mut self,
        now: f64,
        budget: Budget,
        events: &mut Vec<Event>,
    ) -> Result<(), Error> {
        let begin = Instant::now();
        if now.is_nan() || now < self.now || now >= LARGEST_MAGNITUDE {
            return Err(Error::ClockWentBack {
                now: self.now,
                time: now,
            });
        }
        let end = now + self.lookahead;
        self.outlook.extend_beyond(end).map_err(|(slot, error)| {
            let tag = self.scene.in_slot(slot).map_or(0, |(_, o)| o.body.tag);
            error.in_body(tag)
        })?;
        let mut meter = Meter::start(budget);
        self.stats = Stats {
            bodies: self.scene.len() as u64,
            changed: std::mem::take(&mut self.changed_bodies),
            ..Stats::default()
        };
        self.known = self.outlook.catch_up(
            (self.told, end),
            &Admission(&self.scene),
            &mut meter,
            &mut self.stats,
        );
        self.now = now;
        let first = events.len();
        events.append(&mut self.waiting);
        let tick = Tick {
            now,
            told: now.min(self.known),
            before: self.told,
            known: self.known,
            least_change: self.least_change,
        };
        for level in 0..self.levels.len() {
            self.read_conflicts(level);
            self.read_plain(level, &tick);
            self.encounters[level].update(&self.plain, &tick, &mut self.next_id, events);
        }
        self.told = tick.told;
        self.tell_plan_ends(end, events);
        events[first..].sort_unstable_by(Event::order);
        self.stats.conflicts = self.conflicts.iter().map(|level| level.len() as u64).sum();
        self.stats.total_time = begin.elapsed();
        Ok(())
    }

    /// Ends everything: each encounter under way ends, each ahead is withdrawn. Gives back the
    /// scene.
    pub fn close(mut self, events: &mut Vec<Event>) -> Scene {
        let first = events.len();
        events.append(&mut self.waiting);
        for encounters in &mut self.encounters {
            encounters.end(self.now, EndReason::MonitorClosed, |_| true, events);
        }
        events[first..].sort_unstable_by(Event::order);
        self.scene
    }

    fn flight(&self, body: &Body) -> Result<Flight, Error> {
        let end = self.outlook.laid_out(self.now + self.lookahead);
        let window = Window::new(self.told, end)?;
        self.outlook
            .prepare(
                &body.trajectory,
                body.hitbox.spheres(),
                body.hitbox.bounding(),
                window,
            )
            .map_err(|error| error.in_body(body.tag))
    }

    fn place(&mut self, slot: u32, flight: Option<Flight>) {
        self.changed_bodies += 1;
        self.outlook.set(slot, flight);
        let place = slot as usize;
        if self.end_told.len() <= place {
            self.end_told.resize(place + 1, false);
        }
        self.end_told[place] = false;
    }

    /// Tells each plan that ends within the lookahead, once.
    fn tell_plan_ends(&mut self, end: f64, events: &mut Vec<Event>) {
        for (id, occupant) in self.scene.occupants() {
            let trajectory = &occupant.body.trajectory;
            let Some(&last) = trajectory.knots().last() else {
                continue;
            };
            let told = &mut self.end_told[id.slot as usize];
            if !*told && trajectory.outside() == Outside::Absent && last <= end {
                *told = true;
                events.push(Event {
                    time: last,
                    kind: EventKind::PlanEnds(id),
                });
            }
        }
    }
}
