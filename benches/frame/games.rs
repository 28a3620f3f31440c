//! Games: a world, and those that are told of all its bodies in each frame.

use super::shots::Shots;
use super::world::{MARGIN, MovingBodies, STEP, World};
use nearmiss::glam::DVec3;
use nearmiss::{
    AlertLevel, BodyId, Budget, Event, Monitor, Query, Scene, State, Trajectory, Window,
};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Time ahead of the present frame that is looked at, s.
const LOOKAHEAD: f64 = 2.0;

/// A game that goes on frame by frame.
pub(crate) trait Game {
    /// Lets the world go on by a frame, tells it, and waits for the answer. Returns the time from telling it
    /// until the answer is there; the world's own time is left out.
    fn frame(&mut self) -> Duration;

    /// Returns how many there were of each kind in the last frame.
    fn counts(&self) -> [(u64, &'static str); 2];
}

/// A scene that is updated, and screened.
pub(crate) struct UpdateScreen {
    world: World,
    scene: Scene,
    /// m.
    margin: f64,
    counts: [u64; 2],
}

impl UpdateScreen {
    pub(crate) fn new(bodies: u32) -> Self {
        Self::of(World::new(bodies), MARGIN)
    }

    /// Returns a game with one body in 10^3 m, in which contacts are looked for.
    pub(crate) fn dense(bodies: u32) -> Self {
        Self::of(World::with_spacing(bodies, 10.0), 0.0)
    }

    /// Returns a game with one body in 3^3 m, in which contacts are looked for.
    pub(crate) fn crowd(bodies: u32) -> Self {
        Self::of(World::with_spacing(bodies, 3.0), 0.0)
    }

    /// Returns a game on a plane with one body in 5^2 m, in which contacts are looked for.
    pub(crate) fn flat(bodies: u32) -> Self {
        Self::of(World::flat(bodies, 5.0), 0.0)
    }

    /// Returns a game with one body in 10^3 m, in ten groups far from each other.
    pub(crate) fn islands(bodies: u32) -> Self {
        Self::of(World::islands(bodies, 10.0), 0.0)
    }

    /// Returns a game whose margin (m) is known.
    fn of((world, scene): (World, Scene), margin: f64) -> Self {
        Self {
            world,
            scene,
            margin,
            counts: [0; 2],
        }
    }
}

impl Game for UpdateScreen {
    fn frame(&mut self) -> Duration {
        self.world.step();
        let now = self.world.now();
        let begin = Instant::now();
        let updated = self.scene.update(self.world.states().iter().copied());
        let screening = updated.and_then(|()| {
            let query = Query::new(Window::new(now, now + LOOKAHEAD)?).with_margin(self.margin);
            self.scene.screen(&query)
        });
        let time = begin.elapsed();
        let stats = screening.unwrap_or_else(|error| panic!("{error}")).stats;
        self.counts = [stats.candidates, stats.conflicts];
        time
    }

    fn counts(&self) -> [(u64, &'static str); 2] {
        [
            (self.counts[0], "candidates"),
            (self.counts[1], "conflicts"),
        ]
    }
}

/// The calls by which bodies are told in a frame.
#[derive(Clone, Copy)]
enum Calls {
    /// One, for the frame's instant, with the states then.
    One,
    /// Four, as of an engine that takes so many steps a frame.
    Steps,
    /// Two for the same instant: the second one corrects all positions by a millimetre.
    Again,
    /// One, with the states of an instant 50 ms after the frame, as of a clock that is ahead.
    Ahead,
}

impl Calls {
    /// Returns the instant (s) and the states of each call; none if it is the one plain call.
    fn list(self, now: f64, states: &[(BodyId, State)]) -> Vec<(f64, Vec<(BodyId, State)>)> {
        let moved = |time: f64, aside: f64| {
            let states = states.iter().map(|&(id, state)| {
                let way = (time - state.time) * state.velocity + aside * DVec3::X;
                (id, State::new(time, state.position + way, state.velocity))
            });
            states.collect()
        };
        match self {
            Self::One => Vec::new(),
            Self::Steps => [0.75, 0.5, 0.25, 0.0]
                .map(|back| now - back * STEP)
                .map(|time| (time, moved(time, 0.0)))
                .into(),
            Self::Again => [1e-3, 0.0].map(|aside| (now, moved(now, aside))).into(),
            Self::Ahead => vec![(now, moved(now + 0.05, 0.0))],
        }
    }
}

/// A monitor that tracks all bodies.
pub(crate) struct Told<W> {
    world: W,
    monitor: Monitor,
    budget: Budget,
    /// Frames from one in which the bodies are told to the next one.
    period: u32,
    /// Bodies that are told in all other frames.
    meanwhile: usize,
    /// True if in each frame one half of the bodies is told, in turns.
    is_half: bool,
    calls: Calls,
    /// Questions after each frame.
    questions: usize,
    frames: u32,
    events: Vec<Event>,
}

impl Told<World> {
    pub(crate) fn new(bodies: u32) -> Self {
        Self::of(World::new(bodies), LOOKAHEAD, &[MARGIN])
    }

    /// Returns a game that looks five times as far ahead.
    pub(crate) fn far_ahead(bodies: u32) -> Self {
        Self::of(World::new(bodies), 5.0 * LOOKAHEAD, &[MARGIN])
    }

    /// Returns a game whose bodies all move on together.
    pub(crate) fn convoy(bodies: u32) -> Self {
        Self::of(World::convoy(bodies), LOOKAHEAD, &[MARGIN])
    }

    /// Returns a game with one body in 10^3 m, in which contacts are looked for.
    pub(crate) fn dense(bodies: u32) -> Self {
        Self::of(World::with_spacing(bodies, 10.0), LOOKAHEAD, &[0.0])
    }

    /// Returns a game with one body in 3^3 m, in which contacts are looked for.
    pub(crate) fn crowd(bodies: u32) -> Self {
        Self::of(World::with_spacing(bodies, 3.0), LOOKAHEAD, &[0.0])
    }

    /// Returns a game on a plane with one body in 5^2 m, in which contacts are looked for.
    pub(crate) fn flat(bodies: u32) -> Self {
        Self::of(World::flat(bodies, 5.0), LOOKAHEAD, &[0.0])
    }

    /// Returns a game with one body in 10^3 m, in ten groups far from each other.
    pub(crate) fn islands(bodies: u32) -> Self {
        Self::of(World::islands(bodies, 10.0), LOOKAHEAD, &[0.0])
    }

    /// Returns a game with one body in 10^3 m, which tells of a hundred bodies that they are elsewhere, and of no others.
    pub(crate) fn elsewhere(bodies: u32) -> Self {
        const RESTLESS: usize = 100;
        let world = World::restless(bodies, 10.0, RESTLESS);
        Self {
            period: u32::MAX,
            meanwhile: RESTLESS,
            ..Self::of(world, LOOKAHEAD, &[0.0])
        }
    }

    /// Returns a game whose bodies are told in every other frame.
    pub(crate) fn in_turns(bodies: u32) -> Self {
        Self {
            period: 2,
            ..Self::new(bodies)
        }
    }

    /// Returns a game whose bodies are told in every tenth frame, and twenty of them in each.
    pub(crate) fn seldom(bodies: u32) -> Self {
        Self {
            period: 10,
            meanwhile: 20,
            ..Self::new(bodies)
        }
    }

    /// Returns a game whose bodies are told in every other frame, half of them in each frame.
    pub(crate) fn in_halves(bodies: u32) -> Self {
        Self {
            is_half: true,
            ..Self::new(bodies)
        }
    }

    /// Returns a game that tells all bodies four times a frame.
    pub(crate) fn in_steps(bodies: u32) -> Self {
        Self::with_calls(bodies, Calls::Steps)
    }

    /// Returns a game that tells all bodies twice for the same instant.
    pub(crate) fn again(bodies: u32) -> Self {
        Self::with_calls(bodies, Calls::Again)
    }

    /// Returns a game whose states lie ahead of the frame.
    pub(crate) fn ahead(bodies: u32) -> Self {
        Self::with_calls(bodies, Calls::Ahead)
    }

    fn with_calls(bodies: u32, calls: Calls) -> Self {
        Self {
            calls,
            ..Self::new(bodies)
        }
    }

    /// Returns a game whose lookahead is a frame.
    pub(crate) fn near(bodies: u32) -> Self {
        Self {
            period: u32::MAX,
            ..Self::of(World::new(bodies), STEP, &[MARGIN])
        }
    }

    /// Returns a game half of whose bodies rest.
    pub(crate) fn half_at_rest(bodies: u32) -> Self {
        Self::of(World::half_at_rest(bodies), LOOKAHEAD, &[MARGIN])
    }

    /// Returns a game that asks ten questions after each frame.
    pub(crate) fn with_questions(bodies: u32) -> Self {
        Self {
            questions: 10,
            ..Self::new(bodies)
        }
    }

    /// Returns a game within walls, with two alert levels.
    pub(crate) fn within_walls(bodies: u32) -> Self {
        Self::of(World::with_walls(bodies), LOOKAHEAD, &[0.0, MARGIN])
    }

    /// Returns a game within walls with half of the time for a tick that a tick takes without a budget.
    pub(crate) fn with_half_the_time(bodies: u32) -> Self {
        const FRAMES: usize = 41;
        let mut game = Self::within_walls(bodies);
        let mut times = Vec::new();
        for _ in 0..FRAMES {
            game.frame();
            times.push(game.monitor.stats().total_time);
        }
        times.sort_unstable();
        game.budget = Budget::Time(times[FRAMES / 2] / 2);
        game
    }
}

impl Told<Shots> {
    /// Returns ships whose shots ignore each other.
    pub(crate) fn shots(bodies: u32) -> Self {
        Self::of(Shots::new(bodies, true), LOOKAHEAD, &[0.0])
    }

    /// Returns ships whose shots may meet each other.
    pub(crate) fn shots_without_layers(bodies: u32) -> Self {
        Self::of(Shots::new(bodies, false), LOOKAHEAD, &[0.0])
    }
}

impl<W: MovingBodies> Told<W> {
    /// Returns a game whose lookahead (s) is known.
    fn of((world, scene): (W, Scene), lookahead: f64, margins: &[f64]) -> Self {
        let mut events = Vec::new();
        let levels: Vec<AlertLevel> = margins.iter().copied().map(AlertLevel::at).collect();
        let monitor = Monitor::new(scene, 0.0, lookahead, &levels);
        let monitor = monitor.and_then(|mut monitor| {
            monitor.advance(0.0, &mut events)?;
            Ok(monitor)
        });
        Self {
            world,
            monitor: monitor.unwrap_or_else(|error| panic!("{error}")),
            budget: Budget::Unlimited,
            period: 1,
            meanwhile: 0,
            is_half: false,
            calls: Calls::One,
            questions: 0,
            frames: 0,
            events,
        }
    }
}

impl<W: MovingBodies> Game for Told<W> {
    fn frame(&mut self) -> Duration {
        self.world.step();
        let now = self.world.now();
        self.events.clear();
        let is_told = self.frames.is_multiple_of(self.period);
        self.frames += 1;
        let states = self.world.states();
        let half = states.len() / 2;
        let told = match (is_told, self.is_half, self.frames % 2) {
            (false, ..) => &states[..self.meanwhile],
            (true, false, _) => states,
            (true, true, 0) => &states[..half],
            (true, true, _) => &states[half..],
        };
        let mut calls = self.calls.list(now, told).into_iter();
        let begin = Instant::now();
        let tracked = match calls.len() {
            0 => self.monitor.track(now, told.iter().copied()),
            _ => calls.try_for_each(|(time, states)| self.monitor.track(time, states)),
        };
        let (monitor, events) = (&mut self.monitor, &mut self.events);
        let advanced = tracked.and_then(|()| monitor.advance_within(now, self.budget, events));
        black_box(&self.events);
        for (id, state) in states.iter().step_by(97).take(self.questions) {
            let back = State::new(state.time, state.position, -state.velocity);
            let asked = Trajectory::coasting(back).and_then(|plan| monitor.what_if(*id, &plan, 0));
            black_box(asked.unwrap_or_else(|error| panic!("{error}")));
        }
        let time = begin.elapsed();
        advanced.unwrap_or_else(|error| panic!("{error}"));
        time
    }

    fn counts(&self) -> [(u64, &'static str); 2] {
        let found = if self.budget == Budget::Unlimited {
            (self.monitor.stats().candidates, "candidates")
        } else {
            let known = self.monitor.complete_until() - self.monitor.now();
            let known = Duration::try_from_secs_f64(known).unwrap_or_default();
            let known = u64::try_from(known.as_millis()).unwrap_or(u64::MAX);
            (known, "ms known")
        };
        [found, (self.events.len() as u64, "events")]
    }
}
