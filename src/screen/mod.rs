//! One-shot screening: a window in, all conflicts out.
//!
//! Slices find candidates, cheap tests leave survivors (a pair and a span each), and the exact
//! solver works on whole spans of the survivors, each once. The solver knows neither the slice nor
//! the thread of a survivor. Hence the bits do not depend on the slicing or the number of threads.
//!
//! Words: [`internals`](crate::internals).

mod crowd;
mod half_spaces;
mod one;
pub mod pair;
mod prepared;
mod solve;
mod survey;

pub(crate) use one::{extremes_of, is_apart};
pub(crate) use pair::push_all_conflicts;
pub(crate) use solve::{PairQuestion, SolveScratch, conflict, describe};

use crate::bounds::{CompactCubic, CubicSource};
use crate::broad_phase::PairFilter;
use crate::conflict::{CertifiedApproach, ClosestApproach, Conflict};
use crate::error::Error;
use crate::id::BodyId;
use crate::parallel;
use crate::query::Query;
use crate::scene::{Body, PairAdmission, Scene};
use crate::search::{BoxedBodies, LimitExceeded, SliceTrials, TimeSlices, WindowSearch, recycled};
use crate::stats::Stats;
use crate::wall_clock::Instant;
use crate::window::Window;
use prepared::{BodiesInPlace, ListedBodies, PlaceAdmission, PreparedScene, SourceList};
use solve::SHARE_OF_SLICES;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// The answer to a [`Query`].
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Screening {
    /// All conflicts, sorted by (enter, a, b).
    pub conflicts: Vec<Conflict>,
    /// The window screened: that of the query, or [`Scene::planned`] if it names none.
    pub window: Window,
    /// Counts and times of the funnel.
    pub stats: Stats,
}

impl Screening {
    /// Returns the conflicts of one body, soonest first. The call goes through all conflicts; for many bodies, make a
    /// [`ConflictIndex`](crate::ConflictIndex).
    pub fn conflicts_of(&self, id: BodyId) -> impl Iterator<Item = &Conflict> {
        self.conflicts
            .iter()
            .filter(move |conflict| conflict.other(id).is_some())
    }
}

impl<'s> IntoIterator for &'s Screening {
    type Item = &'s Conflict;
    type IntoIter = std::slice::Iter<'s, Conflict>;

    fn into_iter(self) -> Self::IntoIter {
        self.conflicts.iter()
    }
}

impl Scene {
    /// Returns all conflicts of the scene within the query's window and margin.
    ///
    /// Runs on the threads of the current rayon pool (feature `parallel`). The bits of the result
    /// do not depend on their number.
    ///
    /// # Errors
    ///
    /// - [`Error::Margin`] if the margin is NaN, infinite or beyond ±1e300.
    /// - [`Error::NoPlan`] if the query names no window and [`planned`](Self::planned) is `None`,
    ///   though there are bodies.
    /// - [`Error::WindowNotClosed`] if the window is open on a side on which a body goes on beyond its knots.
    /// - [`Error::InBody`] with [`Error::OutOfRange`] if an extrapolated cubic leaves the range of
    ///   numbers within the window, or with [`Error::TooFar`].
    /// - [`Error::TooCrowded`] if more spans may hold a conflict than the query has room for.
    #[doc(alias = "conjunction")]
    pub fn screen(&self, query: &Query) -> Result<Screening, Error> {
        self.screen_with_progress(query, |_| ControlFlow::Continue(()))
    }

    /// Returns the answer of [`screen`](Self::screen) and reports its progress. `progress` gets the
    /// share done: time slices up to 0.9, then the pairs solved. Any thread may call it, so values
    /// may come out of order. The last call, with 1, is on this thread.
    ///
    /// `progress` returns [`ControlFlow::Break`] to end the screening, which then has no answer, also at the last call. It
    /// is asked every few milliseconds of work. Exception: where two clusters turn hundreds of times while they are near, and both follow one
    /// cubic meanwhile, that is one step, of some 10 microseconds for each turn.
    ///
    /// ```
    /// use nearmiss::{Error, Query, Scene, Window};
    /// use std::ops::ControlFlow;
    /// use std::time::{Duration, Instant};
    ///
    /// let deadline = Instant::now() + Duration::from_secs(5);
    /// let screening = Scene::new().screen_with_progress(&Query::default(), |share| {
    ///     eprint!("\r{:3.0} %", 100.0 * share);
    ///     if Instant::now() > deadline {
    ///         return ControlFlow::Break(());
    ///     }
    ///     ControlFlow::Continue(())
    /// });
    /// assert!(screening?.conflicts.is_empty());
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`screen`](Self::screen); [`Error::Cancelled`] if `progress` ended it.
    pub fn screen_with_progress(
        &self,
        query: &Query,
        progress: impl Fn(f64) -> ControlFlow<()> + Sync,
    ) -> Result<Screening, Error> {
        self.screen_with_progress_dyn(query, &progress)
    }

    /// Does the work of [`screen_with_progress`](Self::screen_with_progress), compiled once: as a generic function
    /// it would be compiled again for each caller.
    fn screen_with_progress_dyn(
        &self,
        query: &Query,
        progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
    ) -> Result<Screening, Error> {
        let begin = Instant::now();
        let prepared = PreparedScene::new(self, query)?;
        let is_cancelled = AtomicBool::new(false);
        let tell = |share: f64| {
            if progress(share).is_break() {
                is_cancelled.store(true, Ordering::Relaxed);
            }
        };
        let gives_up = || is_cancelled.load(Ordering::Relaxed);
        let filter = PlaceAdmission {
            pairs: PairAdmission::of(self, query.margin(), &gives_up).with_radii(),
            ids: &prepared.ids,
        };
        let done = prepared.screen(&filter, &tell);
        let mut screening = done.map_err(|_| {
            if gives_up() {
                Error::Cancelled
            } else {
                self.too_crowded(query.max_spans(), prepared.asked, query.margin())
            }
        })?;
        screening.stats.bodies = self.len() as u64;
        screening.stats.total_time = begin.elapsed();
        tell(1.0);
        if is_cancelled.into_inner() {
            return Err(Error::Cancelled);
        }
        Ok(screening)
    }

    /// Returns the least separation of two bodies within a window, and its time. `None` if they do not exist at the same
    /// time, or both are half-spaces. Layers and ignored pairs play no part.
    ///
    /// # Errors
    ///
    /// [`Error::UnknownBody`], [`Error::SameBody`]; [`Error::WindowNotClosed`] and
    /// [`Error::InBody`] as for [`screen`](Self::screen).
    #[doc(alias = "tca")]
    #[doc(alias = "cpa")]
    #[doc(alias = "miss distance")]
    pub fn closest_approach(
        &self,
        a: BodyId,
        b: BodyId,
        window: Window,
    ) -> Result<Option<ClosestApproach>, Error> {
        let (a, b) = self.both(a, b, window)?;
        pair::closest_approach(a, b, window)
    }

    /// Returns [`closest_approach`](Self::closest_approach) with a proof, which takes longer: of the
    /// splines, or with [model errors](Body::with_model_error) of the world.
    ///
    /// ```
    /// # use nearmiss::glam::DVec3;
    /// # use nearmiss::{Body, Scene, State, Trajectory, Window};
    /// let mut scene = Scene::new();
    /// let fly = [-9.0, 9.0].map(|t| State::new(t, DVec3::new(t, 3.0, 0.0), DVec3::X));
    /// let a = scene.insert(Body::new(Trajectory::from_states(&fly)?))?;
    /// let b = scene.insert(Body::new(Trajectory::at_rest(DVec3::ZERO)?))?;
    /// let window = Window::new(-9.0, 9.0)?;
    /// let found = scene.certified_closest_approach(a, b, window)?;
    /// assert!(found.is_some_and(|found| {
    ///     (found.approach.separation - 3.0).abs() <= found.error
    ///         && found.error < 1e-13
    ///         && found.time.earliest <= 0.0
    ///         && 0.0 <= found.time.latest
    /// }));
    /// # Ok::<(), nearmiss::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`closest_approach`](Self::closest_approach).
    pub fn certified_closest_approach(
        &self,
        a: BodyId,
        b: BodyId,
        window: Window,
    ) -> Result<Option<CertifiedApproach>, Error> {
        let (a, b) = self.both(a, b, window)?;
        pair::certified_closest_approach(a, b, window)
    }

    /// Returns two different bodies, if they can be followed over a window.
    fn both(&self, a: BodyId, b: BodyId, window: Window) -> Result<(&Body, &Body), Error> {
        self.pair(a, b)?;
        let body = |id| {
            let body = self.body(id).ok_or(Error::UnknownBody { id })?;
            // The module `pair` does not know ids.
            prepared::lone_view(body, window).map_err(|error| error.with_id(id))?;
            Ok(body)
        };
        Ok((body(a)?, body(b)?))
    }

    /// Returns the cheapest expected number of slices of the query's window for a monitor, which examines segments where
    /// they lie.
    pub(crate) fn cheapest_slices(&self, query: &Query) -> Result<u32, Error> {
        let prepared = PreparedScene::new(self, query)?;
        if prepared.ids.len() < 2 {
            return Ok(1);
        }
        let statistics = &prepared.survey.statistics;
        let filter = PlaceAdmission {
            pairs: PairAdmission::of(self, query.margin(), &|| false),
            ids: &prepared.ids,
        };
        let trials = SliceTrials {
            is_in_place: true,
            ..prepared.trials()
        };
        let slices = TimeSlices::choose(prepared.searched(), &prepared.pace, statistics);
        let sources = |places: &[usize]| prepared.sources(places);
        let slices = trials.cheapest(slices, (statistics, &filter), &sources, &|place| {
            prepared.long_arms(place)
        });
        Ok(slices.count())
    }
}

impl PreparedScene<'_> {
    /// Returns slices of the length of least expected cost. They cover the window, and all instants
    /// that may be reported in it. `sources` returns those of the bodies at some places.
    fn slices<'p>(
        &'p self,
        filter: &dyn PairFilter,
        sources: &dyn Fn(&[usize]) -> Vec<CubicSource<'p, CompactCubic>>,
    ) -> TimeSlices<'p> {
        let statistics = &self.survey.statistics;
        let slices = TimeSlices::choose(self.searched(), &self.pace, statistics);
        if let Some(count) = self.query.slices {
            return slices.with_count(f64::from(count.get()));
        }
        self.trials()
            .cheapest(slices, (statistics, filter), sources, &|place| {
                self.long_arms(place)
            })
    }

    fn trials(&self) -> SliceTrials<'_> {
        SliceTrials {
            lifetimes: &self.lifetimes,
            frame: &self.frame,
            limits: self.limits,
            instructions: self.query.instructions,
            pool: self.pool,
            is_in_place: false,
        }
    }

    /// Lists the box sources of all bodies, and returns the slices; computed in parallel if there are many bodies.
    fn lay_out<'p>(
        &'p self,
        filter: &dyn PairFilter,
        sources: &mut SourceList<'p>,
    ) -> TimeSlices<'p> {
        /// Fewer are prepared before another thread wakes up.
        const FEW: usize = 1024;
        if parallel::threads() > 1 && self.ids.len() > FEW {
            let slices = || self.slices(filter, &|places| self.sources(places));
            let list = || self.list_sources(sources);
            return parallel::join(self.ids.len(), FEW, slices, list).0;
        }
        // Then it is cheaper to copy some than to look at their bodies again.
        self.list_sources(sources);
        let some = |places: &[usize]| places.iter().map(|&place| sources[place]).collect();
        self.slices(filter, &some)
    }

    fn screen(
        &self,
        filter: &dyn PairFilter,
        progress: &(impl Fn(f64) + Sync),
    ) -> Result<Screening, LimitExceeded> {
        let screening = Screening {
            conflicts: Vec::new(),
            window: self.asked,
            stats: Stats {
                segments: self.survey.cubics as u64,
                ..Stats::default()
            },
        };
        if self.ids.len() < 2 {
            return Ok(screening);
        }
        if self.is_in_place() {
            let slices = self.slices(filter, &|places| self.sources(places));
            return self.search(&BodiesInPlace(self), &slices, filter, progress, screening);
        }
        let mut memory = self.pool.take();
        let mut sources = recycled(std::mem::take(&mut memory.sources));
        let slices = self.lay_out(filter, &mut sources);
        let bodies = ListedBodies {
            prepared: self,
            sources: &sources,
        };
        let done = self.search(&bodies, &slices, filter, progress, screening);
        memory.sources = recycled(sources);
        done
    }

    /// Finds all conflicts, and completes the answer.
    fn search(
        &self,
        bodies: &(impl BoxedBodies + Copy),
        slices: &TimeSlices<'_>,
        filter: &dyn PairFilter,
        progress: &(impl Fn(f64) + Sync),
        mut screening: Screening,
    ) -> Result<Screening, LimitExceeded> {
        let search = WindowSearch {
            bodies: *bodies,
            lifetimes: &self.lifetimes,
            frame: &self.frame,
            window: self.window,
            margin: self.query.margin(),
            limits: self.limits,
            method: self.query.method,
            instructions: self.query.instructions,
            pool: self.pool,
            threads: parallel::threads(),
        };
        let stats = &mut screening.stats;
        stats.slices = u64::from(slices.count());
        let mut survivors = Vec::new();
        let found = (&mut survivors, &mut *stats);
        let progress_of_slices = |share: f64| progress(SHARE_OF_SLICES * share);
        let slicing = (slices, &self.survey.statistics);
        search.spans(slicing, filter, &progress_of_slices, found)?;
        let begin = Instant::now();
        if !self.half_spaces.is_empty() {
            stats.spans += self.compare_half_spaces(bodies, filter, &mut survivors)?;
        }
        screening.conflicts = self.solve(bodies, &survivors, filter, progress);
        stats.narrow_time += begin.elapsed();
        stats.survivors = survivors.len() as u64;
        stats.conflicts = screening.conflicts.len() as u64;
        Ok(screening)
    }
}

#[cfg(test)]
mod tests {
    use crate::hitbox::Hitbox;
    use crate::layers::Layers;
    use crate::query::Query;
    use crate::scene::{Body, Scene};
    use crate::trajectory::{State, Trajectory};
    use crate::window::Window;
    use glam::{DQuat, DVec3};

    /// Two fleets that fly opposite ways, each 1 m apart. Boxes of some metres overlap nearly all
    /// of their fleet: somewhat shorter slices save nothing, far shorter ones everything.
    #[test]
    fn far_shorter_slices_are_tried_in_a_crowd() {
        let mut scene = Scene::new();
        let hitbox = Hitbox::sphere(0.2);
        for (height, speed) in [(0.0, 100.0), (10.0, -100.0)] {
            let velocity = DVec3::new(speed, speed, 0.0);
            for number in 0..10_000 {
                let from = DVec3::new(f64::from(number % 100), f64::from(number / 100), height);
                let states =
                    [0.0, 60.0].map(|time| State::new(time, from + time * velocity, velocity));
                let (Ok(plan), Ok(hitbox)) = (Trajectory::from_states(&states), &hitbox) else {
                    unreachable!("the states are in order")
                };
                let body = Body::new(plan).with_hitbox(hitbox.clone());
                assert!(scene.insert(body).is_ok());
            }
        }
        let slices = scene.cheapest_slices(&Query::default());
        assert!(slices.is_ok_and(|count| count > 1_000));
    }

    /// A convoy and parked bodies, 10 m apart each, for a day. In any slice the boxes of the convoy overlap each other:
    /// short slices have as many candidates as long ones.
    #[test]
    fn a_convoy_beside_parked_bodies_gets_few_slices() {
        let mut scene = Scene::new();
        for number in 0..400 {
            let place = DVec3::new(f64::from(number % 20), f64::from(number / 20), 0.0) * 10.0;
            let convoy = State::new(0.0, place + 1e4 * DVec3::X, 30.0 * DVec3::X);
            let plans = [Trajectory::at_rest(place), Trajectory::coasting(convoy)];
            let [Ok(parked), Ok(convoy)] = plans else {
                unreachable!("the numbers are finite")
            };
            for plan in [parked, convoy] {
                assert!(scene.insert(Body::new(plan)).is_ok());
            }
        }
        let day = Window::new(0.0, 86_400.0);
        let query = day.map(|day| Query::new(day).with_margin(4.0));
        let slices = query.and_then(|query| scene.cheapest_slices(&query));
        assert!(slices.is_ok_and(|count| count <= 8));
    }

    /// Short flights in one minute of a day, and some bodies at rest all day: no more is compared than in the minute alone.
    #[test]
    fn flights_of_a_minute_in_a_day_are_compared_in_that_minute() {
        let mut scene = Scene::new();
        for number in 0..2_000 {
            let place = DVec3::new(f64::from(number % 50), f64::from(number / 50), 0.0) * 200.0;
            let velocity = DQuat::from_rotation_z(f64::from(number)) * (20.0 * DVec3::X);
            let flown = (0..=6).map(|leg| {
                let time = 10.0 * f64::from(leg);
                State::new(40_000.0 + time, place + time * velocity, velocity)
            });
            let plan = if number % 200 == 0 {
                Trajectory::at_rest(place)
            } else {
                Trajectory::from_states(&flown.collect::<Vec<_>>())
            };
            assert!(plan.is_ok_and(|plan| scene.insert(Body::new(plan)).is_ok()));
        }
        let spans = |start: f64, end: f64| {
            let query = Window::new(start, end).map(|window| Query::new(window).with_margin(10.0));
            query
                .and_then(|query| scene.screen(&query))
                .map_or(0, |screening| screening.stats.spans)
        };
        let (minute, day) = (spans(40_000.0, 40_060.0), spans(0.0, 86_400.0));
        assert!(minute > 100 && day < 3 * minute, "{minute} {day}");
    }

    /// Shots of a few ships, all through one place, which ignore each other: neither slices nor comparisons are spent
    /// on their pairs.
    #[test]
    fn shots_that_ignore_each_other_cost_no_slices() {
        let (mut scene, layers) = (Scene::new(), [Layers::new(1, 3), Layers::new(2, 1)]);
        for number in 0..2_000 {
            let shot = usize::from(number % 100 > 0);
            let turned = DQuat::from_rotation_z(f64::from(number));
            let velocity = turned * DVec3::new(30.0, 0.0, 1.0) * [1.0, 9.0][shot];
            let place = DVec3::Z * 0.01 * f64::from(number);
            let Ok(plan) = Trajectory::coasting(State::new(0.0, place, velocity)) else {
                unreachable!("the numbers are finite")
            };
            let body = Body::new(plan).with_layers(layers[shot]);
            assert!(scene.insert(body).is_ok());
        }
        let query = Window::new(0.0, 2.0).map(Query::new);
        let screening = query.and_then(|query| scene.screen(&query));
        let stats = screening.map(|screening| screening.stats);
        assert!(
            stats
                .as_ref()
                .is_ok_and(|stats| stats.slices <= 4 && stats.candidates < 20_000),
            "{stats:?}"
        );
    }
}
