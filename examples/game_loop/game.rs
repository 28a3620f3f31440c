//! One tick of the game, with a window or without.

use crate::Failure;
use crate::fleet::{Fleet, Setting};
use crate::tally::Tally;
use nearmiss::{Error, Event};
use std::time::{Duration, Instant};

/// The fleet, what it is told, and how it lives.
#[derive(Debug)]
pub(crate) struct Game {
    pub(crate) fleet: Fleet,
    pub(crate) tally: Tally,
    /// Of the last tick.
    pub(crate) events: Vec<Event>,
    /// Share of the bodies that get a new plan every tick.
    pub(crate) replan: f64,
    /// True if the monitor is asked about plans before they are flown.
    pub(crate) avoids: bool,
    pub(crate) replans: usize,
}

impl Game {
    /// At time 0; what lies ahead then is known.
    pub(crate) fn new(setting: Setting, bodies: usize, seed: u64) -> Result<Self, Failure> {
        let mut game = Self {
            fleet: Fleet::new(setting, bodies, seed)?,
            tally: Tally::default(),
            events: Vec::new(),
            replan: 0.0,
            avoids: false,
            replans: 0,
        };
        game.fleet.monitor.advance(0.0, &mut game.events)?;
        game.tally.read(setting.contact, &game.events);
        Ok(game)
    }

    /// Makes new plans, hands them over and moves the clock. Returns the time from handing over
    /// until the events were there.
    pub(crate) fn tick(&mut self, now: f64) -> Result<Duration, Error> {
        let fleet = &mut self.fleet;
        let mut plans = fleet.whims(self.replan)?;
        for id in Fleet::running_out(&self.events) {
            if plans.iter().all(|&(planned, _)| planned != id) {
                plans.extend(fleet.fresh_plan(id)?);
            }
        }
        if self.avoids {
            plans = fleet.steer(plans)?;
        }
        self.replans += plans.len();
        let commands = fleet.commands(plans);
        self.events.clear();
        let begin = Instant::now();
        fleet.monitor.apply(commands)?;
        fleet.monitor.advance(now, &mut self.events)?;
        let took = begin.elapsed();
        self.tally.read(fleet.setting.contact, &self.events);
        Ok(took)
    }
}
