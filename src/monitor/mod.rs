//! A clock, a lookahead, plans that change, and events. [`Monitor`] has the guarantees.
//!
//! Words that are used beyond one file are defined in [`internals`](crate::internals).

mod alert_level;
mod bodies;
mod boxes;
mod budget;
mod change;
mod command;
mod due_times;
mod encounters;
mod event;
mod grid;
mod half_spaces;
mod interrupt;
#[cfg(feature = "live")]
pub(crate) mod live;
mod lookahead;
mod monitored_bodies;
mod pending_change;
mod plan_ends;
mod read;
mod reading;
mod recent_changes;
#[cfg(feature = "recording")]
pub(crate) mod recording;
mod renew;
mod restore;
mod revision_threshold;
mod search_from_nothing;
mod sent_numbers;
mod skip;
mod slice;
mod slot_set;
mod snapshot;
mod solved_conflict;
mod solved_spans;
mod sorted_slab;
mod tick;
mod tick_context;
mod told_motions;
mod track;
mod what_if;

pub use alert_level::AlertLevel;
pub use budget::Budget;
pub use command::Command;
pub use event::{Encounter, EncounterId, EndReason, Event, EventKind};
pub use revision_threshold::RevisionThreshold;
pub use snapshot::Snapshot;

use crate::conflict::Conflict;
use crate::error::{Error, MAX_MAGNITUDE};
use crate::id::BodyId;
use crate::rounding::without_negative_zero;
use crate::scene::Scene;
use crate::stats::Stats;
use command::CommandBatch;
use due_times::DueTimes;
use encounters::EncounterTracker;
use grid::{Grid, GridReview, can_tell_apart};
use interrupt::Interrupt;
use lookahead::LookaheadSearch;
use read::LevelCaches;
#[cfg(feature = "recording")]
use recording::Record;
use slot_set::SlotSet;
use std::sync::Arc;
use told_motions::ToldMotions;

/// Watches a scene as time passes and plans change: a clock, a lookahead, and events. No event is
/// lost, however far the clock jumps. With a budget, events may come in later ticks.
///
/// A monitor owns its [`Scene`]. Between ticks plans change; a tick ([`advance`](Self::advance))
/// moves the clock and reports what happened.
///
/// - After a tick that [has caught up](Self::is_caught_up), [`conflicts`](Self::conflicts) is, bit for bit, what
///   [`Scene::screen`] says with the level's margin of the window from now to the end of the
///   lookahead; else, of the window from now to [`complete_until`](Self::complete_until), and nothing if that is not
///   after now.
/// - Every encounter that began has exactly one end, at the latest at [`close`](Self::close).
///   [`EventKind`] has the order of events.
/// - A change between two ticks counts from the clock of the tick before, if it has no time of its own: a body that is
///   [inserted](Self::insert) exists from then on as its plan says, one that is [removed](Self::remove) is gone from then
///   on, and so with whole trajectories and orientations, hitboxes, layers, model errors and ignored pairs. So make such
///   changes after the tick at whose clock they count.
/// - Exception: a [budget](Self::advance_within) may leave the monitor behind its clock. Such a change then counts from
///   [`complete_until`](Self::complete_until) on, up to which all was reported. A plan still counts from its own instant
///   on, but not before that.
///
/// # Order of a frame
///
/// Tell, advance, then insert and remove. Removing and inserting before the tick misses what a removed body met since the
/// last tick, and reports what an inserted one would have met on a way that it did not fly.
///
/// ```
/// # use nearmiss::{AlertLevel, Body, EventKind, Monitor, Scene, State, Trajectory};
/// # let mut monitor = Monitor::new(Scene::new(), 0.0, 2.0, &[AlertLevel::at(1.0)])?;
/// # let still = |x: f64| Ok::<_, nearmiss::Error>(Body::new(Trajectory::at_rest([x, 0.0, 0.0])?));
/// # let coasting = |state| Ok::<_, nearmiss::Error>(Body::new(Trajectory::coasting(state)?));
/// # let target = monitor.insert(still(10.0)?)?;
/// # let ship = monitor.insert(coasting(State::new(0.0, [0.0; 3], [0.0; 3]))?)?;
/// # let old = monitor.insert(coasting(State::new(0.0, [8.5, 0.0, 0.0], [60.0, 0.0, 0.0]))?)?;
/// # let mut events = Vec::new();
/// # monitor.advance(0.0, &mut events)?;
/// # events.clear();
/// # let now = 1.0 / 60.0;
/// # let moved = State::new(now, [9.2, -2.0, 0.0], [0.0; 3]);
/// # let fired = State::new(now, [9.2, 9.0, 0.0], [0.0, 600.0, 0.0]);
/// monitor.track(now, [(ship, moved)])?; // where bodies are now
/// monitor.advance(now, &mut events)?; // what happened up to now
/// let shot = monitor.insert(coasting(fired)?)?; // appears now
/// monitor.remove(old)?; // disappears now
/// assert!(events.iter().any(|event| matches!(event.kind, EventKind::Began(it) if it.b == old)));
/// # monitor.advance(2.0 * now, &mut events)?;
/// # assert!(events.iter().all(|event| event.kind.encounter().is_none_or(|it| it.b != shot)));
/// # Ok::<(), nearmiss::Error>(())
/// ```
///
/// # Cost
///
/// A tick works on changed plans, on the time that comes into the lookahead, and on encounters that an
/// edge of the lookahead, or the clock, cuts off. An encounter under way costs about a microsecond a tick,
/// and a tenth of one at each level for each of its spans in the lookahead. (A span is a cubic of one body with a
/// cubic of the other. Two clusters have one for each pair of spheres that is solved.) Of bodies that rest without turning, it
/// costs a twentieth of that. If one of its bodies changes, it is solved again: two or three microseconds in a tick for two
/// balls, and as much as a screening of the pair for two clusters. The tick in which the clock, or the end of the
/// lookahead, first cuts the contact of two clusters takes two to eight times a screening of the pair. Where most
/// bodies are within the margin of many others all the time, screening anew may be cheaper.
///
/// The lookahead is cut into up to 2,048 slices that suit the scene. Ticks without a budget check now
/// and then whether they still do. If other slices suit it far better, such a tick takes as long as the
/// first one.
///
/// A tick before which many bodies change, as they did before one of the last ticks, screens its lookahead as a
/// whole, or as much of it as a [budget](Budget) allows. Many are so many that this takes less time than comparing
/// them with the kept boxes of all bodies: about one in sixteen of balls that are told each frame, 2 s ahead; up to three
/// quarters where a screening of the lookahead takes many slices, or plans have many cubics in it. The last ticks are
/// some thirty before which any body changed, for these balls, and three to ten for many cubics; a tick before which
/// none did counts a sixteenth. Those before which some did screen as well; with a budget, if it suffices for all of the
/// lookahead. A later one takes longer, once: it forms the boxes of all bodies, and changed ones are compared with these from
/// then on.
///
/// # Threads
///
/// Batches and ticks share their work among the threads of the current rayon pool (feature `parallel`), with
/// the same answers on any number of them. Little work stays on the caller's thread: up to 1,024 changes, and
/// up to 4,096 boxes, one for each changed body in each slice. A program that wants no other thread at
/// all makes the caller's the only one of the pool:
///
/// ```standalone_crate
/// let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
/// pool.use_current_thread().build_global()?;
/// # Ok::<(), rayon::ThreadPoolBuildError>(())
/// ```
///
/// # Memory
///
/// A monitor takes the memory of its [`Scene`] and, from the first tick on, about 1,100 bytes a body. That
/// was measured from 10,000 to 400,000 bodies with few conflicts; it is more where bodies pass through many
/// slices. The spans, conflicts and encounters of the lookahead come on top. A body that is replanned no
/// longer needs the scene's copy of its segments in f32. That memory goes back to the system when other
/// bodies are inserted or removed, or when all have been replanned.
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
/// assert!(matches!(events.last().map(|event| event.kind), Some(EventKind::Began(_))));
/// # Ok::<(), nearmiss::Error>(())
/// ```
#[derive(Debug)]
pub struct Monitor {
    scene: Scene,
    search: LookaheadSearch,
    levels: Vec<AlertLevel>,
    encounters: Vec<EncounterTracker>,
    conflicts: Vec<Vec<Conflict>>,
    now: f64,
    lookahead: f64,
    /// Instant up to which the last tick reported events, s: the clock, unless a budget ran out before.
    reported: f64,
    /// End of the known time at the last tick, s: up to there all spans were found and solved.
    known: f64,
    /// Time for which plans are kept after they were followed, s.
    history: f64,
    revision_threshold: RevisionThreshold,
    next_id: u64,
    /// Events of removals: the next tick reports them.
    pending_events: Vec<Event>,
    /// Slots of bodies that were removed since the last tick, and whose encounters have not ended yet.
    removed: SlotSet,
    /// Ends of plans that are still to be reported.
    plan_ends: DueTimes,
    stats: Stats,
    /// Number of changes of bodies since the last tick.
    changed_bodies: u64,
    /// The last comparison of the grid, the slices and the frame of boxes, with the scene.
    grid_review: GridReview,
    /// The last batch of changes: the next tick drops what it has replaced.
    batch: CommandBatch,
    /// Memory of [`track`](Self::track).
    told: ToldMotions,
    /// Conflicts, and encounters by the plans as they are, as the last tick read them from the solved spans.
    readings: LevelCaches,
    interrupt: Option<Arc<Interrupt>>,
    #[cfg(feature = "recording")]
    recorder: Option<recording::RecordWriter>,
}

impl Monitor {
    /// Room for spans that may hold an encounter, if [nothing else is said](Self::set_max_spans): 2^20.
    /// They take up to 4 GiB with one alert level, and 2.5 GiB more with each further one.
    pub const MAX_SPANS: usize = 1 << 20;

    /// Returns a monitor of `scene` whose clock shows `now` (s) and that looks `lookahead` seconds ahead.
    /// The lookahead is above 0 and at most 1e300, and not lost in the rounding of `now`. Levels are
    /// numbered as given, from 0; they may come in any order. Lookahead and levels cannot change: for others, [`close`](Self::close) the monitor and make another one.
    ///
    /// # Errors
    ///
    /// [`Error::Clock`], [`Error::Lookahead`], [`Error::NoAlertLevel`], [`Error::AlertLevel`];
    /// [`Error::InBody`] with [`Error::OutOfRange`] or [`Error::TooFar`] if a plan cannot be followed
    /// through the lookahead.
    pub fn new(
        scene: Scene,
        now: f64,
        lookahead: f64,
        levels: &[AlertLevel],
    ) -> Result<Self, Error> {
        let now = without_negative_zero(now);
        let usable = |value: f64| value.abs() <= MAX_MAGNITUDE;
        if !usable(now) {
            return Err(Error::Clock { time: now });
        }
        let length = lookahead / Grid::FEWEST;
        if !usable(lookahead) || !can_tell_apart(now, length) || length < f64::MIN_POSITIVE {
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
        let widest = widest.reduce(f64::max).ok_or(Error::NoAlertLevel)?;
        let grid = Grid::for_scene(&scene, widest, (now, lookahead), now)?;
        let mut monitor = Self {
            search: LookaheadSearch::new(grid, AlertLevel::margins(levels), Self::MAX_SPANS),
            levels: levels.to_vec(),
            encounters: (0..levels.len()).map(EncounterTracker::of_level).collect(),
            conflicts: vec![Vec::new(); levels.len()],
            now,
            lookahead,
            reported: now,
            known: now,
            history: 0.0,
            revision_threshold: RevisionThreshold::default(),
            next_id: 0,
            pending_events: Vec::new(),
            removed: SlotSet::default(),
            plan_ends: DueTimes::default(),
            stats: Stats::default(),
            changed_bodies: 0,
            grid_review: GridReview::after_comparison(scene.len(), now),
            batch: CommandBatch::default(),
            told: ToldMotions::default(),
            readings: LevelCaches::of_levels(levels.len()),
            interrupt: None,
            #[cfg(feature = "recording")]
            recorder: None,
            scene,
        };
        monitor.prepare_all_bodies()?;
        monitor.watch_plan_ends();
        Ok(monitor)
    }

    /// Sets the largest change of an encounter's numbers that is not reported, measured from those of
    /// its first event or its last [`Revised`](EventKind::Revised). The nearest point and the end of an encounter are
    /// reported whatever the threshold, once they come into the examined time: see [`RevisionThreshold`].
    ///
    /// # Errors
    ///
    /// [`Error::Setting`] if one is negative or NaN.
    pub fn set_revision_threshold(
        &mut self,
        revision_threshold: RevisionThreshold,
    ) -> Result<(), Error> {
        check_revision_threshold(revision_threshold)?;
        #[cfg(feature = "recording")]
        self.write_down(|| Record::RevisionThreshold(revision_threshold));
        self.revision_threshold = revision_threshold;
        // All are read again, so that changes below an earlier threshold are reported.
        for planned in &mut self.readings.planned {
            planned.list_all();
        }
        Ok(())
    }

    /// Returns the largest change that is not reported.
    #[must_use]
    pub const fn revision_threshold(&self) -> RevisionThreshold {
        self.revision_threshold
    }

    /// Keeps plans and orientations this many seconds back, from the clock of the last tick, when bodies are
    /// [replanned](Self::replan), [extended](Self::extend), [told](Self::track) or [oriented](Self::orient); 0 at first,
    /// and infinity keeps all. It changes no event but for roundings: a late plan may be followed from an earlier instant.
    /// Older cubics are forgotten then, but for the one that holds at that instant. Kept ones are copied with each such call,
    /// a tenth of a microsecond a knot. Ticks examine the kept time of replanned bodies anew: where 50 of 2,000 bodies are
    /// replanned each tick, ticks take 1.5 times as long.
    ///
    /// # Errors
    ///
    /// [`Error::Setting`] if it is negative or NaN.
    pub fn set_history(&mut self, history: f64) -> Result<(), Error> {
        check_setting("history", history)?;
        self.history = history;
        #[cfg(feature = "recording")]
        self.write_down(|| Record::History(history));
        Ok(())
    }

    /// Returns the time for which plans are kept after they were followed, s.
    #[must_use]
    pub const fn history(&self) -> f64 {
        self.history
    }

    /// Sets the limit of spans that may hold an encounter; [`MAX_SPANS`](Self::MAX_SPANS) by default. A span
    /// counts if its bodies come within the largest release margin in the lookahead: a common interval of a
    /// cubic of one body with a cubic of another. Two clusters count once for each pair of spheres that is solved:
    /// more are once the clock, or the end of the lookahead, cuts their contact. Spans in
    /// the time that the clock passes over in the tick count as well. Each slice of time has room for eight times
    /// as many spans that cheap tests cannot rule out, and for as many pairs whose boxes meet as the limit says,
    /// but at least 2^22. If all bodies are in one place, all pairs count: a tick then ends with
    /// [`Error::TooCrowded`] instead of filling the memory.
    ///
    /// The tick after such an error searches the whole lookahead again. Before it, remove bodies, ignore pairs, use
    /// layers, or raise the limit. If a jump of the clock passes over too many encounters, move the clock in
    /// several shorter steps.
    pub fn set_max_spans(&mut self, limit: usize) {
        self.search.max_spans = limit;
        #[cfg(feature = "recording")]
        self.write_down(|| Record::MaxSpans(limit));
    }

    /// Returns the limit of spans that may hold an encounter.
    #[must_use]
    pub const fn max_spans(&self) -> usize {
        self.search.max_spans
    }

    /// Returns the lookahead: the time ahead of the clock that is examined, s.
    #[must_use]
    pub const fn lookahead(&self) -> f64 {
        self.lookahead
    }

    /// Returns the alert levels, in the order of their numbers.
    #[must_use]
    pub fn levels(&self) -> &[AlertLevel] {
        &self.levels
    }

    /// Returns the bodies and their plans.
    #[must_use]
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the clock, s.
    #[must_use]
    pub const fn now(&self) -> f64 {
        self.now
    }

    /// Returns the instant up to which the last tick has found everything, s: the end of the lookahead,
    /// unless a budget ran out.
    #[must_use]
    pub const fn complete_until(&self) -> f64 {
        self.known
    }

    /// Returns true if all of the lookahead is known, with all changes. After a change it is false until a tick has looked
    /// at it.
    #[must_use]
    pub fn is_caught_up(&self) -> bool {
        !self.search.has_changed() && self.is_known()
    }

    /// Returns true if all of the lookahead was known at the last tick.
    fn is_known(&self) -> bool {
        self.known >= self.now + self.lookahead
    }

    /// Returns all conflicts of a level from now to [`complete_until`](Self::complete_until), as of the last tick,
    /// sorted by (enter, a, b); also those of bodies that were removed since. The list is empty while nothing after
    /// now is known, as before the first tick: that does not mean that there are no conflicts. A conflict under way
    /// comes first: its enter is the clock, and it is clipped there. [`encounters`](Self::encounters) has when it
    /// began.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownAlertLevel`].
    pub fn conflicts(&self, level: usize) -> Result<&[Conflict], Error> {
        let conflicts = self.conflicts.get(level).map(Vec::as_slice);
        conflicts.ok_or(Error::UnknownAlertLevel { level })
    }

    /// Returns the conflicts of one body at a level, soonest first, as of the last tick: a body that was inserted since
    /// has none yet. None are found before the first tick, and while a budget leaves the monitor behind its clock. The
    /// call goes through all conflicts of the level; for many bodies, make a
    /// [`ConflictIndex`](crate::ConflictIndex).
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::UnknownAlertLevel`].
    pub fn conflicts_of(
        &self,
        id: BodyId,
        level: usize,
    ) -> Result<impl Iterator<Item = &Conflict>, Error> {
        self.scene.body(id).ok_or(Error::UnknownBody { id })?;
        let all = self.conflicts(level)?.iter();
        Ok(all.filter(move |conflict| conflict.other(id).is_some()))
    }

    /// Returns the soonest conflict of one body at a level, perhaps one that is under way; as of the last tick. `None`
    /// says that there is none up to [`complete_until`](Self::complete_until): nothing is known before the first
    /// tick, and while a budget leaves the monitor behind its clock.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::UnknownAlertLevel`].
    pub fn next_conflict(&self, id: BodyId, level: usize) -> Result<Option<&Conflict>, Error> {
        Ok(self.conflicts_of(id, level)?.next())
    }

    /// Returns encounters under way and ahead, level by level; as of the last tick, without those of bodies that
    /// were removed since.
    pub fn encounters(&self) -> impl Iterator<Item = &Encounter> {
        let all = self.encounters.iter().flat_map(EncounterTracker::iter);
        let is_there = |id| self.scene.has(id);
        all.filter(move |encounter| is_there(encounter.a) && is_there(encounter.b))
    }

    /// Returns the counts and times of the last tick.
    #[must_use]
    pub const fn stats(&self) -> &Stats {
        &self.stats
    }
}

fn check_revision_threshold(threshold: RevisionThreshold) -> Result<(), Error> {
    let RevisionThreshold { time, separation } = threshold;
    check_setting("revision threshold, time", time)?;
    check_setting("revision threshold, separation", separation)
}

fn check_setting(setting: &'static str, value: f64) -> Result<(), Error> {
    if value >= 0.0 {
        Ok(())
    } else {
        Err(Error::Setting { setting, value })
    }
}
