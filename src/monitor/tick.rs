//! A tick: it catches up with the clock, reads what is known, and reports what changed.
//!
//! The clock and the events change at the end, after all that can fail. A tick that fails reports nothing and
//! leaves the clock where it was; what its search has found may stay.

use super::Monitor;
use super::bodies::BodyTable;
use super::budget::{Budget, BudgetMeter, TickWork};
use super::command::CommandBatch;
use super::event::{EndReason, Event};
use super::grid::can_show;
use super::interrupt::Interrupt;
use super::read::{LevelCaches, ReadContext};
use super::reading::WindowEdges;
#[cfg(feature = "recording")]
use super::recording::Record;
use super::tick_context::TickContext;
use crate::error::Error;
use crate::parallel;
use crate::rounding::without_negative_zero;
use crate::scene::{PairAdmission, Scene};
use crate::search::LimitExceeded;
use crate::stats::Stats;
use crate::wall_clock::Instant;
use crate::window::Window;

impl Monitor {
    /// Moves the clock to `now` (s) and appends the events since the last tick to `events`, in their order. The
    /// clock may stand still, or jump. A jump reports all encounters on the way, however long it is. Its cost depends on
    /// these, and on the turns of turning bodies while they are near others; hardly on its length.
    ///
    /// In steady state a tick on one thread allocates nothing: it uses the memory of earlier ones, which holds as much as was
    /// ever needed. Exceptions: a slice of the lookahead in which more pairs of boxes meet than 1,024 and four
    /// times the number of bodies gives their memory back each time; so do pairs of clusters that are solved.
    ///
    /// # Errors
    ///
    /// [`Error::ClockWentBack`], [`Error::Clock`]; [`Error::InBody`] with [`Error::OutOfRange`] or
    /// [`Error::TooFar`] if a plan cannot be followed through the lookahead; [`Error::TooCrowded`] if more lies
    /// ahead, or on the way, than [the limit allows](Self::set_max_spans). The clock stays where it was, and no
    /// event is reported. After `TooCrowded` the next tick looks at everything anew, and comes to the same moment again:
    /// [`skip_to`](Self::skip_to) leaves it behind.
    pub fn advance(&mut self, now: f64, events: &mut Vec<Event>) -> Result<(), Error> {
        self.advance_within(now, Budget::Unlimited, events)
    }

    /// Moves the clock like [`advance`](Self::advance), but within a budget: the near future is examined first.
    /// Nothing is missing before [`complete_until`](Self::complete_until); later ticks continue from there,
    /// also while the clock stands still. In the end they report the clock events that unlimited ticks do.
    /// Exceptions:
    ///
    /// - Bodies are inserted or removed meanwhile, or hitboxes, layers, model errors or ignored pairs change. All of these
    ///   count from `complete_until` on if it is before the clock.
    /// - A plan changes for an instant that is not after the clock, which one of two monitors has reported and the other,
    ///   behind by its budget, has not.
    /// - A plan changes while the monitor is behind: its cubics are cut elsewhere then, and numbers differ by roundings.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::{AlertLevel, Body, Budget, Monitor, Scene, Trajectory};
    /// let mut scene = Scene::new();
    /// for x in 0..2_000 {
    ///     scene.insert(Body::new(Trajectory::at_rest(f64::from(x) * DVec3::X)?))?;
    /// }
    /// let mut monitor = Monitor::new(scene, 0.0, 9.0, &[AlertLevel::at(0.5)])?;
    /// let (mut ticks, mut events) = (0, Vec::new());
    /// while !monitor.is_caught_up() {
    ///     monitor.advance_within(0.0, Budget::Work(1_000), &mut events)?;
    ///     ticks += 1;
    /// }
    /// assert!(ticks > 1);
    /// assert_eq!(monitor.complete_until(), 9.0);
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`advance`](Self::advance).
    pub fn advance_within(
        &mut self,
        now: f64,
        budget: Budget,
        events: &mut Vec<Event>,
    ) -> Result<(), Error> {
        self.advance_by(now, BudgetMeter::start(budget), events)
    }

    /// Moves the clock, and knows everything up to `known` (s) afterwards, as the tick that was recorded did.
    #[cfg(feature = "recording")]
    pub(super) fn advance_to(
        &mut self,
        now: f64,
        known: f64,
        events: &mut Vec<Event>,
    ) -> Result<(), Error> {
        let known = known.clamp(self.reported, (now + self.lookahead).max(self.reported));
        // The recorded ticks had room for all spans. Spans may be found in other ticks here: so no limit counts.
        let limit = std::mem::replace(&mut self.search.max_spans, usize::MAX);
        let done = self.advance_by(now, BudgetMeter::up_to(known), events);
        self.search.max_spans = limit;
        done
    }

    fn advance_by(
        &mut self,
        now: f64,
        meter: BudgetMeter,
        events: &mut Vec<Event>,
    ) -> Result<(), Error> {
        let done = self.tick(now, meter, events);
        #[cfg(feature = "recording")]
        if done.is_err() && self.readings.reads_all() {
            self.write_down(|| Record::Anew);
        }
        done
    }

    fn tick(&mut self, now: f64, meter: BudgetMeter, events: &mut Vec<Event>) -> Result<(), Error> {
        let begin = Instant::now();
        let now = without_negative_zero(now);
        self.check_clock(now)?;
        if now <= self.now && self.has_reported_all() {
            self.stand_still(begin);
            return Ok(());
        }
        let end = now + self.lookahead;
        self.choose_grid(now, meter.is_unlimited() && self.reported >= self.now)?;
        self.search.extend_beyond(&self.scene, end)?;
        let margin = self.search.grid.margin;
        let interrupt = self.interrupt.as_deref();
        let is_interrupted = || interrupt.is_some_and(Interrupt::is_requested);
        let mut work = TickWork {
            admission: PairAdmission::of(&self.scene, margin, &is_interrupted),
            meter,
            stats: Stats {
                bodies: self.scene.len() as u64,
                changed: self.changed_bodies,
                ..Stats::default()
            },
        };
        let (known, ()) = parallel::join(
            self.batch.changed.len(),
            CommandBatch::FEW,
            || self.search.catch_up(self.reported, (now, end), &mut work),
            || self.batch.clear(),
        );
        let TickWork {
            mut stats, meter, ..
        } = work;
        let known = known.and_then(|known| {
            self.read_changed_pairs();
            let begin = Instant::now();
            self.complete_cut_contacts((now, known))?;
            stats.narrow_time += begin.elapsed();
            Ok(known)
        });
        let Ok(known) = known else {
            let limit = self.search.max_spans;
            self.forget_search()?;
            let window = Window::new(self.reported, end)?;
            return Err(self.scene.too_crowded(limit, window, margin));
        };
        // Nothing below can fail.
        self.end_of_removed(self.reported);
        let mut next_id = self.next_id;
        let first = events.len();
        self.read((now, known), &mut next_id, events);
        (self.now, self.reported, self.known) = (now, now.min(known), known);
        self.search.affordable.note(&meter, (now, end), known);
        self.next_id = next_id;
        events.append(&mut self.pending_events);
        self.report_plan_ends(end, events);
        events[first..].sort_unstable_by(Event::order);
        self.changed_bodies = 0;
        stats.conflicts = self.conflicts.iter().map(|level| level.len() as u64).sum();
        stats.total_time = begin.elapsed();
        self.stats = stats;
        #[cfg(feature = "recording")]
        {
            let work = meter.done();
            self.write_down(|| Record::Tick { now, known, work });
        }
        Ok(())
    }

    /// Ends a tick, begun at some time, that has nothing to do.
    fn stand_still(&mut self, begin: Instant) {
        self.stats = Stats {
            bodies: self.scene.len() as u64,
            conflicts: self.stats.conflicts,
            total_time: begin.elapsed(),
            ..Stats::default()
        };
        #[cfg(feature = "recording")]
        {
            let (now, known, work) = (self.now, self.known, 0);
            self.write_down(|| Record::Tick { now, known, work });
        }
    }

    /// Checks that the clock can go on to `now` (s).
    ///
    /// # Errors
    ///
    /// [`Error::ClockWentBack`], [`Error::Clock`].
    pub(super) fn check_clock(&self, now: f64) -> Result<(), Error> {
        if now < self.now {
            return Err(Error::ClockWentBack {
                now: self.now,
                time: now,
            });
        }
        if can_show(now, self.lookahead) {
            Ok(())
        } else {
            Err(Error::Clock { time: now })
        }
    }

    /// Returns true if another tick at the same time would change nothing.
    pub(super) fn has_reported_all(&self) -> bool {
        self.is_caught_up() && self.pending_events.is_empty() && !self.readings.reads_all()
    }

    /// Closes the monitor and returns the scene: each encounter under way ends, each one ahead is
    /// withdrawn.
    ///
    /// A recording under way ends, too. Call `stop_recording` before to know if all of it could be written.
    pub fn close(mut self, events: &mut Vec<Event>) -> Scene {
        self.end_all(events);
        #[cfg(feature = "recording")]
        {
            self.write_down(|| Record::Close);
            // There is nobody left to tell; a replay would say that the end is missing.
            let _ = self.stop_recording();
        }
        self.scene
    }

    /// Ends all encounters, with the monitor.
    pub(super) fn end_all(&mut self, events: &mut Vec<Event>) {
        let first = events.len();
        self.end_of_removed(self.reported);
        events.append(&mut self.pending_events);
        for encounters in &mut self.encounters {
            encounters.end(self.reported, EndReason::MonitorClosed, |_| true, events);
        }
        events[first..].sort_unstable_by(Event::order);
    }
}

impl Monitor {
    /// Reads the pairs that have changed.
    pub(super) fn read_changed_pairs(&mut self) {
        self.search.solved.sort_changed_pairs();
        let context = ReadContext {
            search: &self.search,
            scene: &self.scene,
        };
        self.readings.update(context, &self.levels, self.reported);
        self.search.solved.changed_pairs.clear();
    }

    /// Solves the spans in which the windows of this tick cut a contact for any window, unless they are.
    ///
    /// # Errors
    ///
    /// If there is too little room.
    fn complete_cut_contacts(&mut self, (now, known): (f64, f64)) -> Result<(), LimitExceeded> {
        if !self.search.solved.has_whole_contacts() {
            return Ok(());
        }
        let most = self.search.max_spans;
        for time in [self.reported, now.min(known), known] {
            let LevelCaches {
                conflicts,
                planned,
                lasting,
                ..
            } = &mut self.readings;
            lasting.clear();
            lasting.extend(planned.iter().flat_map(|level| level.lasting_at(time)));
            // Where both margins are nearly the same, a conflict may lie beside each planned encounter by rounding.
            lasting.extend(conflicts.iter().flat_map(|level| level.lasting_at(time)));
            lasting.sort_unstable();
            lasting.dedup();
            let search = &mut self.search;
            lasting.retain(|pair| search.solved.is_incomplete(*pair, time));
            if !lasting.is_empty() {
                let bodies = BodyTable::of(&self.scene, &search.monitored, &search.grid);
                search.solved.complete(lasting, (time, most), &bodies)?;
            }
        }
        if self.search.solved.keep_changed_plateaus() {
            // Windows cut a contact in another way where a distance is constant in some span.
            self.read_changed_pairs();
        }
        Ok(())
    }

    /// Reads the conflicts from now to the end of the known time (s), and the planned encounters from the last
    /// tick's clock on, and updates the tracked encounters.
    pub(super) fn read(
        &mut self,
        (now, known): (f64, f64),
        next_id: &mut u64,
        events: &mut Vec<Event>,
    ) {
        /// Spans of pairs that are sooner read than another thread wakes up.
        const FEW: usize = 1024;
        let context = ReadContext {
            search: &self.search,
            scene: &self.scene,
        };
        let tick = &TickContext {
            now,
            reported: now.min(known),
            before: self.reported,
            known,
            lookahead: self.lookahead,
            revision_threshold: self.revision_threshold,
            solved: &self.search.solved,
            bodies: BodyTable::of(&self.scene, &self.search.monitored, &self.search.grid),
        };
        let LevelCaches {
            conflicts,
            planned,
            scratch: [scratch, other_scratch],
            ..
        } = &mut self.readings;
        let (levels, lists) = (&self.levels, &mut self.conflicts);
        let read_conflicts = || {
            for ((conflicts, list), alert) in conflicts.iter().zip(lists).zip(levels) {
                list.clear();
                if tick.now < tick.known {
                    let window = (tick.now, tick.known);
                    let clipped = |pair, whole: &_| {
                        let solved = context.clipped(pair, whole, (alert.margin, window), scratch);
                        solved.map(|solved| solved.conflict)
                    };
                    conflicts.list(window, clipped, list);
                }
            }
        };
        let encounters = &mut self.encounters;
        let read_encounters = || {
            // Up to an instant that was reached before, nothing new is known.
            if tick.before < tick.known {
                for ((planned, tracker), alert) in planned.iter_mut().zip(encounters).zip(levels) {
                    let edges = WindowEdges {
                        // What the clock has reached must say how close it came.
                        within: (tick.reported, tick.known),
                        around: (tick.before, tick.known),
                    };
                    if planned.lists_all() {
                        tracker.wait_for_all();
                    }
                    planned.list(edges, tracker.waiting(), |pair, whole| {
                        context.planned(pair, whole, alert, tick, other_scratch)
                    });
                    tracker.update(planned.listed(), tick, next_id, events);
                }
            }
        };
        let count = self.search.solved.len();
        parallel::join(count, FEW, read_encounters, read_conflicts);
    }
}
